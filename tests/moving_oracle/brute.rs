//! First times of contact of two meshes, from all features of all pairs of triangles.

use kit::rational::Q;
use sim_core::{DVec3, Mesh};

pub(crate) fn placed(mesh: &Mesh, offset: DVec3) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles().len())
        .map(|i| mesh.corners(i).map(|v| v.as_dvec3() + offset))
        .collect()
}

/// First times over all features of all pairs of triangles.
#[derive(Default)]
pub(crate) struct First {
    /// The first contact of all features.
    pub(crate) impact: Option<Q>,
    /// The first contact of features with a plane that the motion crosses.
    pub(crate) across: Option<Q>,
    /// The first contact, without edges that meet at an end.
    pub(crate) inside: Option<Q>,
    /// The first contact, without vertices at the border of a face: it always blocks.
    pub(crate) sure: Option<Q>,
}

pub(crate) fn brute_force(first: &Mesh, second: &Mesh, offset: DVec3, motion: DVec3) -> First {
    let (first, second) = (placed(first, DVec3::ZERO), placed(second, offset));
    let mut found = First::default();
    let sooner = |known: &mut Option<Q>, time: &Q| {
        if known.as_ref().is_none_or(|known| time < known) {
            *known = Some(time.clone());
        }
    };
    let mut note = |time: Option<Q>, u, v, ends: &[Option<Q>], is_edges: bool| {
        let Some(time) = time else { return };
        sooner(&mut found.impact, &time);
        if super::is_across(u, v, motion) {
            sooner(&mut found.across, &time);
            let is_on_border = ends.contains(&Some(time.clone()));
            if !(is_edges && is_on_border) {
                sooner(&mut found.inside, &time);
            }
            if !is_on_border {
                sooner(&mut found.sure, &time);
            }
        }
    };
    let border = |p, motion, t: &[DVec3; 3]| {
        [0, 1, 2].map(|k| super::point_meets_edge(p, motion, [t[k], t[(k + 1) % 3]]))
    };
    for s in &first {
        for t in &second {
            for i in 0..3 {
                let time = super::point_meets_triangle(t[i], motion, *s);
                let at = border(t[i], motion, s);
                note(time, [s[0], s[1]], [s[0], s[2]], &at, false);
                let time = super::point_meets_triangle(s[i], -motion, *t);
                let at = border(s[i], -motion, t);
                note(time, [t[0], t[1]], [t[0], t[2]], &at, false);
                for j in 0..3 {
                    let (s, t) = ([s[i], s[(i + 1) % 3]], [t[j], t[(j + 1) % 3]]);
                    let ends = [
                        super::point_meets_edge(t[0], motion, s),
                        super::point_meets_edge(t[1], motion, s),
                        super::point_meets_edge(s[0], -motion, t),
                        super::point_meets_edge(s[1], -motion, t),
                    ];
                    note(super::edge_meets_edge(s, t, motion), s, t, &ends, true);
                }
            }
        }
    }
    found
}
