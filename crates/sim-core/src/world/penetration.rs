//! The depth of overlapping bodies, and the shortest translation that separates them.
//!
//! For spheres and half-spaces the least translation that separates a pair has a closed form. For other pairs it is
//! searched. The length is doubled or halved until, by the exact test, one of many directions separates the pair at
//! this length and none at half of it. The lengths along these directions are bisected. The surface that touches at
//! the end of the best translation gives the next direction, as long as this makes the translation shorter.

use alloc::vec::Vec;
use glam::DVec3;

use super::{World, layout::Layout};
use crate::{
    Shape,
    collide::{Form, ball_meets, first_contact, parting_normals, reach, snap, stay_in_each_other},
};

/// The number of bisections of the length that separates a pair along a direction: 12 correct digits.
const HALVINGS: usize = 40;
/// The most rounds in which the surface that touches gives the next direction; for faces one round is enough.
const TURNS: usize = 16;
/// Bodies placed flush may overlap by this many roundings of f32 vertices,
const FLUSH_ROUNDINGS: f64 = 4.0;
/// and by this many gaps of bodies in contact.
const FLUSH_GAPS: f64 = 16.0;

/// Two bodies that overlap more deeply than by rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// The bodies, the lower index first.
    pub bodies: (usize, usize),
    /// Unit vector: the direction of the shortest known translation that moves the second body out of the first. The
    /// first body moves out in the opposite direction.
    pub normal: DVec3,
    /// The length of that translation, m: after it the bodies touch.
    ///
    /// A mesh is a surface, open or closed, so the translation may lead into the space that it encloses.
    pub depth: f64,
    /// Whether no shorter translation separates the bodies, except for rounding.
    ///
    /// This is known for spheres and half-spaces; for a sphere and a mesh if no edge or second face blocks the
    /// translation; and for two boxes of which neither fits into the other. Otherwise `depth` is an upper bound: the
    /// length of the shortest translation along the normals of up to 32 faces that meet, the line of the centres, and
    /// the 26 directions to the faces, edges and corners of a cube, improved by the surfaces that touch on the way.
    /// If one of two bodies turns, the directions are the line of the centres and 26 such directions in the world and
    /// in the frame of each turning body.
    pub is_least: bool,
}

/// A translation that ends an overlap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Penetration {
    /// The direction in which the second body moves.
    pub(super) normal: DVec3,
    /// The length of the translation, m.
    pub(super) depth: f64,
    pub(super) is_least: bool,
}

impl World {
    /// The pairs of overlapping bodies of which one is movable, in order: those that were placed
    /// in overlap and have not parted since.
    ///
    /// No initial placement is refused. Overlapping bodies get no deeper and gain no energy. If one of them turns,
    /// they pass through each other until they are apart. Two immovable bodies never touch each other. A mesh is a
    /// surface, so a body wholly inside a closed mesh does not overlap it. [`World::separate`] moves overlapping
    /// bodies apart.
    ///
    /// An overlap less deep than [`World::flush`] counts as a contact. Depths are measured at the current positions
    /// of the bodies, which takes some hundred exact tests for a pair of meshes.
    pub fn overlaps(&self) -> Vec<Overlap> {
        let layout = self.layout();
        let mut last: Option<((usize, usize), Option<Overlap>)> = None;
        let pairs = self.overlapping().iter();
        let overlaps = pairs.filter_map(|&(i, j)| {
            let same = last.filter(|&((k, l), _)| {
                layout.are_copies((i, j), (k, l))
                    && layout.is_held_in_overlap(i, j) == layout.is_held_in_overlap(k, l)
            });
            let found = same.map_or_else(|| self.overlap(i, j), |(_, found)| found);
            last = Some(((i, j), found));
            let bodies = (i, j);
            found.map(|found| Overlap { bodies, ..found })
        });
        overlaps.collect()
    }

    /// The overlap of two bodies, the lower index first, if it is one of [`World::overlaps`].
    pub fn overlap(&self, i: usize, j: usize) -> Option<Overlap> {
        self.overlapping().binary_search(&(i, j)).ok()?;
        let layout = self.layout();
        let offset = layout.at[j] - layout.at[i];
        if !layout.is_held_in_overlap(i, j) && layout.place_apart((i, j), offset).is_some() {
            return None;
        }
        let found = layout.penetration(i, j, offset);
        if self.bodies.pair_tumbles(i, j) && found.depth <= layout.flush(i, j) {
            return None;
        }
        Some(Overlap {
            bodies: (i, j),
            normal: found.normal,
            depth: found.depth,
            is_least: found.is_least,
        })
    }

    /// The depth, m, along a normal, or along up to three at once, up to which overlapping bodies count as touching.
    /// It is the sum of two parts. One is four times the rounding of the `f32` of their vertices, radii and distances
    /// from their origins together. The other is 16 of the gaps at which bodies in contact are kept, 1024 units in
    /// the last place of their coordinates.
    ///
    /// Computed positions of bodies that are meant to lie flush, on a slope or by turned meshes, have errors of this
    /// size. At its start the next step moves such bodies apart, and then they touch.
    pub fn flush(&self, i: usize, j: usize) -> f64 {
        self.layout().flush(i, j)
    }
}

impl Layout<'_> {
    /// The depth up to which two overlapping bodies count as touching ([`World::flush`]), m.
    pub(super) fn flush(&self, i: usize, j: usize) -> f64 {
        let sizes = self.bodies.extent(i).farthest + self.bodies.extent(j).farthest;
        FLUSH_ROUNDINGS * f64::from(f32::EPSILON) * sizes + FLUSH_GAPS * self.hover_gap(i, j)
    }

    /// Whether two pairs have the same shapes in the same positions, and so the same depth.
    pub(super) fn are_copies(&self, (i, j): (usize, usize), (k, l): (usize, usize)) -> bool {
        let is_copy = |body: usize, other: usize| {
            let is_there = |at: &[DVec3]| at[body] == at[other];
            self.bodies.share_shape(body, other)
                && is_there(self.at)
                && is_there(&self.before.position)
        };
        let is_same = is_copy(i, k) && is_copy(j, l);
        is_same && !self.bodies.pair_tumbles(i, j) && !self.bodies.pair_tumbles(k, l)
    }

    fn is_held_in_overlap(&self, i: usize, j: usize) -> bool {
        let mut contacts = self.contacts.of_pair(i, j);
        contacts.any(|contact| contact.is_overlap)
    }

    /// The shortest known translation that separates two bodies that meet; the second one is at `offset` from the
    /// first.
    pub(super) fn penetration(&self, i: usize, j: usize, offset: DVec3) -> Penetration {
        self.bodies.need_bvh(i);
        self.bodies.need_bvh(j);
        if self.bodies.pair_tumbles(i, j) {
            return self.turning_penetration(i, j, offset);
        }
        let Some((first, second)) = self.bodies.forms(i, j) else {
            return self.unknown_penetration(i, j);
        };
        if let Some(exact) = in_closed_form(first, second, offset) {
            return exact;
        }
        if let Some(exact) = self.out_of_box((i, j), offset) {
            return exact;
        }
        let directions = self.ways_out(i, j, offset);
        let Some((normal, depth)) = self.shortest_out((i, j), offset, &directions) else {
            return self.unknown_penetration(i, j);
        };
        let (normal, depth) = self.turned_out((i, j), offset, (normal, depth));
        Penetration {
            normal,
            depth,
            is_least: is_least(first, second, offset, depth),
        }
    }

    /// Whether two bodies that meet certainly do so at all offsets no farther than `by`, m, from this one.
    pub(super) fn is_surely_deeper(&self, (i, j): (usize, usize), offset: DVec3, by: f64) -> bool {
        let Some((first, second)) = self.bodies.forms(i, j) else {
            return false;
        };
        let exact = in_closed_form(first, second, offset);
        if let Some(exact) = exact.or_else(|| self.out_of_box((i, j), offset)) {
            // Twice as far, to cover rounding.
            return exact.depth > 2.0 * by;
        }
        match (first, second) {
            (Form::Mesh(first), Form::Mesh(second)) => {
                stay_in_each_other(first, second, offset, by)
            }
            (Form::Mesh(mesh), Form::Sphere(radius)) => ball_meets(mesh, offset, radius - 2.0 * by),
            (Form::Sphere(radius), Form::Mesh(mesh)) => {
                ball_meets(mesh, -offset, radius - 2.0 * by)
            }
            // These have a closed form, unless they have no depth.
            (Form::Sphere(_), Form::Sphere(_))
            | (Form::HalfSpace(_), _)
            | (_, Form::HalfSpace(_)) => false,
        }
    }

    /// The same for two bodies of which one turns, at their current rotations.
    fn turning_penetration(&self, i: usize, j: usize, offset: DVec3) -> Penetration {
        let out_of = |normal: DVec3, body: usize, place: DVec3| {
            let depth = self.reach_against(body, normal)? - normal.dot(place);
            Some((normal, depth.max(0.0)))
        };
        let plane = match (self.bodies.shape(i), self.bodies.shape(j)) {
            (Some(&Shape::HalfSpace { normal }), _) => out_of(normal, j, offset),
            (_, Some(&Shape::HalfSpace { normal })) => {
                let out = out_of(normal, i, -offset);
                out.map(|(normal, depth)| (-normal, depth))
            }
            _ => None,
        };
        let is_least = plane.is_some();
        let found = plane.or_else(|| {
            let directions = self.ways_out(i, j, offset);
            self.shortest_out((i, j), offset, &directions)
        });
        match found {
            Some((normal, depth)) => Penetration {
                normal,
                depth,
                is_least,
            },
            None => self.unknown_penetration(i, j),
        }
    }

    fn unknown_penetration(&self, i: usize, j: usize) -> Penetration {
        Penetration {
            normal: self.apart_along(i, j),
            depth: self.farthest_out(i, j),
            is_least: false,
        }
    }

    /// A length greater than any translation that a pair needs to be separated, m.
    fn farthest_out(&self, i: usize, j: usize) -> f64 {
        4.0 * (self.bodies.extent(i).farthest + self.bodies.extent(j).farthest)
    }

    /// Unit vectors along which the second of two bodies may leave the first.
    pub(super) fn ways_out(&self, i: usize, j: usize, offset: DVec3) -> Vec<DVec3> {
        let forms = self.bodies.forms(i, j);
        let surfaces = forms.map_or_else(Vec::new, |(a, b)| parting_normals(a, b, offset));
        let mut ways: Vec<DVec3> = alloc::vec![self.apart_along(i, j)];
        let both = surfaces.iter().flat_map(|&normal| [normal, -normal]);
        let known = self.contacts.of_pair(i, j).filter(|known| known.is_overlap);
        let turning = [i, j].into_iter().filter(|&body| self.bodies.tumbles(body));
        let turned = turning.flat_map(|body| {
            let rotation = self.rotation(body);
            compass().map(move |way| rotation * way)
        });
        for way in known
            .map(|known| known.normal)
            .chain(both)
            .chain(compass())
            .chain(turned)
        {
            if !ways.contains(&way) {
                ways.push(way);
            }
        }
        ways
    }

    /// The shortest separating translation along one of some directions. It first finds a length at which a direction
    /// separates the pair, while none does at half of it.
    fn shortest_out(
        &self,
        (i, j): (usize, usize),
        offset: DVec3,
        directions: &[DVec3],
    ) -> Option<(DVec3, f64)> {
        let is_apart = |by: DVec3| !self.meet(i, j, offset + by);
        let some_part = |far: f64| directions.iter().any(|&way| is_apart(far * way));
        let (least, most) = (self.hover_gap(i, j), self.farthest_out(i, j));
        // A pair held in overlap is about as deep as it was at the start.
        let known = self.overlaps.depth_at_start((i, j));
        let known = known.map(|depth| 0.125 * depth);
        // Otherwise begin at a depth that counts as deep: where surfaces nearly coincide, each exact test takes
        // longest.
        let size = |body: usize| self.bodies.extent(body).farthest;
        let deep = || (0.25 * size(i).min(size(j))).max(self.flush(i, j));
        let mut far = known.unwrap_or_else(deep).max(least);
        if some_part(far) {
            while far > least && some_part(0.5 * far) {
                far *= 0.5;
            }
        } else {
            while far <= most && !some_part(far) {
                far *= 2.0;
            }
        }
        let mut best: Option<(DVec3, f64)> = None;
        for &way in directions {
            let reach = best.map_or(far, |(_, depth)| depth);
            if is_apart(reach * way) {
                let depth = halved(0.5 * far, reach, |length| is_apart(length * way));
                if best.is_none_or(|(_, least)| depth < least) {
                    best = Some((way, depth));
                }
            }
        }
        best
    }

    /// A separating translation that becomes no shorter along the normal of the surface that touches at its end.
    fn turned_out(
        &self,
        (i, j): (usize, usize),
        offset: DVec3,
        mut best: (DVec3, f64),
    ) -> (DVec3, f64) {
        let Some((first, second)) = self.bodies.forms(i, j) else {
            return best;
        };
        let is_apart = |by: DVec3| !self.bodies.meet_built(i, j, offset + by);
        let hover = self.hover_gap(i, j);
        for _ in 0..TURNS {
            let (normal, depth) = best;
            let apart = offset + (depth + hover) * normal;
            let back = -(2.0 * hover + depth) * normal;
            let Some(touch) = first_contact(first, second, snap(apart), snap(back)) else {
                break;
            };
            let along = normal.dot(touch.normal) * depth;
            // Just beyond the plane of this surface.
            let reach = along * (1.0 + 1e-12) + hover;
            if reach >= depth || !is_apart(reach * touch.normal) {
                break;
            }
            let shortest = halved(0.5 * along, reach, |length| is_apart(length * touch.normal));
            best = (touch.normal, shortest);
        }
        best
    }

    /// The shortest separating translation of two boxes along the axes, of which neither fits into the other: past a
    /// face. Of equal ones, the one that leads most along the line of the centres.
    fn out_of_box(&self, (i, j): (usize, usize), offset: DVec3) -> Option<Penetration> {
        let ends = |body: usize| Some(self.bodies.bvh(body)?.cuboid()?.ends);
        let ([low, high], [other_low, other_high]) = (ends(i)?, ends(j)?);
        let (size, other) = (high - low, other_high - other_low);
        if !(size.cmpge(other).any() && other.cmpge(size).any()) {
            return None;
        }
        let (up, down) = (high - (other_low + offset), (other_high + offset) - low);
        let along = self.apart_along(i, j);
        let ways = DVec3::AXES.into_iter().flat_map(|axis| {
            let of = |normal: DVec3, depth: DVec3| (normal, depth.dot(axis).max(0.0));
            [of(axis, up), of(-axis, down)]
        });
        let least = ways.min_by(|(a, first), (b, second)| {
            let by_way = b.dot(along).total_cmp(&a.dot(along));
            first.total_cmp(second).then(by_way)
        });
        least.map(|(normal, depth)| Penetration {
            normal,
            depth,
            is_least: true,
        })
    }
}

/// The least length from `low` to `high` at which a condition holds, by bisection; the condition holds at `high`.
fn halved(mut low: f64, mut high: f64, is_so: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match is_so(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    high
}

/// Directions to the faces, edges and corners of a cube.
pub(super) fn compass() -> impl Iterator<Item = DVec3> {
    let ends = [0.0, 1.0, -1.0];
    let all = ends.into_iter().flat_map(move |x| {
        let plane = ends.into_iter().flat_map(move |y| ends.map(|z| (y, z)));
        plane.map(move |(y, z)| DVec3::new(x, y, z))
    });
    all.filter_map(DVec3::try_normalize)
}

/// The shortest separating translation of spheres and half-spaces.
fn in_closed_form(first: Form<'_>, second: Form<'_>, offset: DVec3) -> Option<Penetration> {
    let least = |normal: DVec3, depth: f64| {
        Some(Penetration {
            normal,
            depth: depth.max(0.0),
            is_least: true,
        })
    };
    match (first, second) {
        (Form::HalfSpace(normal), other) => {
            least(normal, reach(other, normal).0 - normal.dot(offset))
        }
        (Form::Sphere(one), Form::Sphere(other)) => {
            let normal = offset.try_normalize().unwrap_or(DVec3::X);
            least(normal, one + other - offset.length())
        }
        (_, Form::HalfSpace(_)) => {
            let turned = in_closed_form(second, first, -offset)?;
            least(-turned.normal, turned.depth)
        }
        (Form::Mesh(_), Form::Mesh(_) | Form::Sphere(_)) | (Form::Sphere(_), Form::Mesh(_)) => None,
    }
}

/// Whether no shorter translation moves a sphere out of a mesh: the distance of its centre from the surface is less
/// than the radius by `depth`, and a translation increases this distance by at most its length.
fn is_least(first: Form<'_>, second: Form<'_>, offset: DVec3, depth: f64) -> bool {
    let (mesh, centre, radius) = match (first, second) {
        (Form::Mesh(mesh), Form::Sphere(radius)) => (mesh, offset, radius),
        (Form::Sphere(radius), Form::Mesh(mesh)) => (mesh, -offset, radius),
        (Form::Mesh(_), Form::Mesh(_))
        | (Form::Sphere(_), Form::Sphere(_))
        | (Form::HalfSpace(_), _)
        | (_, Form::HalfSpace(_)) => return false,
    };
    let left = radius - depth + 1e-9 * radius;
    left >= 0.0 && ball_meets(mesh, centre, left)
}
