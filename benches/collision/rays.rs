//! Rays against the cow: time, and rays that leak through edges and corners.

use std::cell::OnceCell;
use std::time::Duration;

use bvh::bvh::Bvh as BvhTree;
use bvh::ray::Ray as BvhRay;
use criterion::Criterion;
use glam::Vec3A;
use kit::random::Random;
use nalgebra::{Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::triangle::Triangle;
use parry3d::math::Vector;
use parry3d::query::{Ray as ParryRay, RayCast};
use sim_core::collide::predicates::segment_meets_triangle;
use sim_core::{DVec3, Mesh, Vec3};

use crate::Scope;
use crate::build::{BvhTriangle, bvh_triangles, obvhs_triangles};
use crate::meshes::{Shape, Solid, Solids};
use crate::sweep::{median, sweep};
use crate::table::{Table, three_digits};

/// A ray with f32 coordinates, so that every peer gets the same one.
#[derive(Clone, Copy)]
struct Ray {
    origin: Vec3,
    direction: Vec3,
}

/// The ray casters.
#[derive(Clone, Copy)]
enum Caster {
    Ours,
    Parry,
    Obvhs,
    Bvh,
}

const CASTERS: [(&str, Caster); 4] = [
    ("ours", Caster::Ours),
    ("parry", Caster::Parry),
    ("obvhs medium", Caster::Obvhs),
    ("bvh", Caster::Bvh),
];

/// The mesh in the form of each peer.
struct Peers<'a> {
    solid: &'a Solid,
    obvhs: CwBvh,
    /// In the order of the tree's leaves.
    obvhs_triangles: Vec<Triangle>,
    bvh: BvhTree<f32, 3>,
    bvh_triangles: Vec<BvhTriangle>,
}

impl<'a> Peers<'a> {
    fn of(solid: &'a Solid) -> Peers<'a> {
        let triangles = obvhs_triangles(&solid.mesh);
        let obvhs = build_cwbvh_from_tris(
            &triangles,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let mut bvh_triangles = bvh_triangles(&solid.mesh);
        Peers {
            solid,
            obvhs_triangles: obvhs
                .primitive_indices
                .iter()
                .map(|&i| triangles[i as usize])
                .collect(),
            obvhs,
            bvh: BvhTree::build(&mut bvh_triangles[..]),
            bvh_triangles,
        }
    }

    /// The ray parameter of the nearest hit, in lengths of the direction.
    fn cast(&self, caster: Caster, ray: &Ray) -> Option<f64> {
        match caster {
            Caster::Ours => {
                let hit = self
                    .solid
                    .bvh
                    .ray(ray.origin.as_dvec3(), ray.direction.as_dvec3());
                hit.map(|hit| hit.t)
            }
            Caster::Parry => {
                let vector = |v: Vec3| Vector::from_array(v.to_array());
                let ray = ParryRay::new(vector(ray.origin), vector(ray.direction));
                self.solid
                    .parry
                    .cast_local_ray(&ray, f32::MAX, false)
                    .map(f64::from)
            }
            Caster::Obvhs => {
                let ray = ObvhsRay::new_inf(Vec3A::from(ray.origin), Vec3A::from(ray.direction));
                let mut hit = RayHit::none();
                self.obvhs.ray_traverse(ray, &mut hit, |ray, id| {
                    self.obvhs_triangles[id].intersect(ray)
                });
                hit.t.is_finite().then_some(f64::from(hit.t))
            }
            Caster::Bvh => {
                let direction = Vector3::from(ray.direction.to_array());
                // This peer normalizes the direction.
                let unit = 1.0 / f64::from(direction.norm());
                let ray = BvhRay::new(Point3::from(ray.origin.to_array()), direction);
                let hits = self
                    .bvh
                    .traverse_iterator(&ray, &self.bvh_triangles)
                    .map(|triangle| {
                        // Its test culls back faces.
                        let [a, b, c] = &triangle.corners;
                        let front = ray.intersects_triangle(a, b, c).distance;
                        front.min(ray.intersects_triangle(a, c, b).distance)
                    });
                let nearest = hits.fold(f32::INFINITY, f32::min);
                nearest.is_finite().then_some(f64::from(nearest) * unit)
            }
        }
    }
}

/// The nearest hit by exact tests of every triangle.
fn truth(mesh: &Mesh, ray: &Ray) -> Option<f64> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let hits = (0..mesh.triangles().len()).filter_map(|face| {
        let [a, b, c] = mesh.corners(face).map(|v| v.as_dvec3());
        // The segment extends beyond the mesh: the meshes are a few metres wide, and directions reach across.
        segment_meets_triangle(origin, origin + 4.0 * direction, [a, b, c]).then(|| {
            let normal = (b - a).cross(c - a);
            (a - origin).dot(normal) / direction.dot(normal)
        })
    });
    hits.min_by(f64::total_cmp)
}

/// From points around towards points in the box: some hit, some miss.
fn around(mesh: &Mesh, count: usize) -> Vec<Ray> {
    let mut random = Random::splitmix(2);
    let mut point = || random.vector();
    let half = mesh.bounds().half_extent();
    let rays = (0..count).map(|_| {
        let origin = (point().normalize() * 3.0).as_vec3();
        let target = (point() * half).as_vec3();
        Ray {
            origin,
            direction: target - origin,
        }
    });
    rays.collect()
}

/// A point in the cow's belly with generic coordinates.
const INSIDE: Vec3 = Vec3::new(0.031, 0.017, 0.023);

/// Rays from inside towards corners and middles of edges; in a closed mesh each of them hits.
fn at_features(mesh: &Mesh, most: usize) -> [Vec<Ray>; 2] {
    let from_inside = |target: Vec3| Ray {
        origin: INSIDE,
        direction: target - INSIDE,
    };
    let every = |count: usize| count.div_ceil(most);
    let corners = mesh.vertices().iter().step_by(every(mesh.vertices().len()));
    let edges = mesh.edges().iter().step_by(every(mesh.edges().len()));
    let middle = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|v| mesh.vertices()[v as usize]);
        a.midpoint(b)
    };
    [
        corners.map(|&v| from_inside(v)).collect(),
        edges.map(|edge| from_inside(middle(edge))).collect(),
    ]
}

pub(crate) fn bench(c: &mut Criterion, solids: &Solids, scope: Scope) -> Table {
    let mut table = Table::new(
        "Rays against the cow: nearest hit, and misses where a ray cannot miss",
        &[
            "cow",
            "method",
            "ns a ray",
            "to ours",
            "wrong",
            "through corners",
            "through edges",
        ],
    );
    for shape in [6_000, 100_000].map(Shape::Cow) {
        if shape.triangles() > scope.largest {
            continue;
        }
        let prepared = OnceCell::new();
        let solid = OnceCell::new();
        let prepare = || {
            prepared.get_or_init(|| {
                let solid = solid.get_or_init(|| solids.get(shape));
                let rays = around(&solid.mesh, 2 * scope.directions);
                let truths: Vec<_> = rays.iter().map(|ray| truth(&solid.mesh, ray)).collect();
                assert!(is_inside(&solid.mesh), "the point is in the cow");
                (
                    Peers::of(solid),
                    rays,
                    truths,
                    at_features(&solid.mesh, 20_000),
                )
            })
        };
        let mut group = c.benchmark_group(format!("rays/{}", shape.name()));
        let mut ours = None;
        for (method, caster) in CASTERS {
            let run = |ray: &Ray| prepare().0.cast(caster, ray);
            let Some(swept) = sweep(&mut group, method, || prepare().1.clone(), run) else {
                continue;
            };
            let (_, rays, truths, features) = prepare();
            let right = |found: Option<f64>, truth: Option<f64>| match (found, truth) {
                (Some(found), Some(truth)) => (found - truth).abs() <= 1e-4 * truth,
                (found, truth) => found.is_none() == truth.is_none(),
            };
            let wrong = rays
                .iter()
                .zip(truths)
                .filter(|(ray, truth)| !right(run(ray), **truth));
            let slipped = |rays: &Vec<Ray>| {
                let slipped = rays.iter().filter(|ray| run(ray).is_none()).count();
                format!("{slipped}/{}", rays.len())
            };
            let time = median(swept.times);
            let ours = *ours.get_or_insert(time);
            table.rows.push(vec![
                shape.name(),
                method.into(),
                three_digits(time * 1e9),
                format!("x{}", three_digits(time / ours)),
                format!("{}/{}", wrong.count(), rays.len()),
                slipped(&features[0]),
                slipped(&features[1]),
            ]);
        }
        group.finish();
    }
    table
}

/// Whether that point is inside: a ray that meets no corner or edge crosses an odd number of faces.
fn is_inside(mesh: &Mesh) -> bool {
    let far = DVec3::new(31.0, 17.0, 7.0);
    let crossed = (0..mesh.triangles().len()).filter(|&face| {
        let corners = mesh.corners(face).map(|v| v.as_dvec3());
        segment_meets_triangle(INSIDE.as_dvec3(), far, corners)
    });
    crossed.count() % 2 == 1
}
