//! The cow as data: rounded cones and ellipsoids, blended in order.
//!
//! The model stands on the plane y = 0 with y up, faces -x and mirrors itself
//! in z = 0; only the parts on the side of positive z and those in the middle
//! are listed. Lengths are in metres, after a dairy cow of about 1.4 m at the
//! withers.

use crate::sdf::{Shape, smooth_difference, smooth_union};
use glam::{Mat3, Vec3};

/// Whether a part is put on or cut off.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Join {
    Add,
    Cut,
}

/// One step of the composition.
#[derive(Clone, Copy, Debug)]
struct Part {
    shape: Shape,
    join: Join,
    /// Radius of the blend with everything before it.
    blend: f32,
}

/// No part blends wider than this, m.
const WIDEST_BLEND: f32 = 0.12;

/// The cow's implicit surface.
#[derive(Clone, Debug)]
pub struct Model {
    parts: Vec<Part>,
}

impl Model {
    /// The whole cow.
    pub fn cow() -> Self {
        let mut cow = Self::plain_cow();
        cow.eyes_and_nostrils();
        cow.teats();
        cow
    }

    /// The cow without the details that are smaller than some 5 cm.
    pub fn plain_cow() -> Self {
        let mut cow = Self { parts: Vec::new() };
        cow.trunk();
        cow.neck();
        cow.head();
        cow.horn_and_ear();
        cow.foreleg();
        cow.hind_leg();
        cow.udder();
        cow.tail();
        cow.ground();
        cow
    }

    /// Signed distance from `p` to the cow, m, negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        let half = Vec3::new(p.x, p.y, p.z.abs());
        self.parts.iter().fold(f32::MAX, |d, part| {
            let other = part.shape.distance(half);
            match part.join {
                Join::Add => smooth_union(d, other, part.blend),
                Join::Cut => smooth_difference(d, other, part.blend),
            }
        })
    }

    /// A cow of only the parts that shape the surface within `reach`, m, of `p`.
    pub fn near(&self, p: Vec3, reach: f32) -> Self {
        let half = Vec3::new(p.x, p.y, p.z.abs());
        // Where the surface passes, it feels parts within the widest blend; on
        // the way there the cow's and the part's distance change by `reach`.
        // Both count twice, since blends add up and the distances to ellipsoids
        // change faster than the position.
        let limit = self.distance(p).abs() + 4.0 * reach + 2.0 * WIDEST_BLEND;
        let close = |part: &&Part| part.shape.distance(half) <= limit;
        Self {
            parts: self.parts.iter().filter(close).copied().collect(),
        }
    }
}

/// The parts, one a line.
#[rustfmt::skip]
impl Model {
    fn trunk(&mut self) {
        // Rib cage, paunch, chest and brisket.
        self.ball(0.10, [-0.12, 1.00, 0.0], [0.66, 0.40, 0.30]);
        self.ball(0.12, [0.14, 0.93, 0.0], [0.52, 0.34, 0.37]);
        self.ball(0.12, [-0.50, 0.98, 0.0], [0.26, 0.36, 0.22]);
        self.ball(0.08, [-0.68, 0.86, 0.0], [0.14, 0.16, 0.12]);
        // Withers, spine and loin, for a straight, bony top line.
        self.ball(0.08, [-0.45, 1.30, 0.0], [0.17, 0.13, 0.07]);
        self.cone(0.10, [-0.46, 1.36, 0.0], 0.05, [0.50, 1.37, 0.0], 0.045);
        self.cone(0.10, [0.50, 1.37, 0.0], 0.045, [0.86, 1.35, 0.0], 0.045);
        self.ball(0.08, [0.36, 1.23, 0.0], [0.36, 0.15, 0.24]);
        // Rump between the hook bones and the pin bones.
        self.ball(0.10, [0.64, 1.15, 0.0], [0.29, 0.26, 0.24]);
        self.cone(0.09, [0.50, 1.31, 0.12], 0.065, [0.53, 1.31, 0.225], 0.042);
        self.cone(0.09, [0.54, 1.27, 0.18], 0.07, [0.88, 1.26, 0.10], 0.055);
        // Shoulder blade, down and forward from the withers, and the upper arm.
        self.tilted(0.06, [-0.52, 1.10, 0.155], [0.29, 0.13, 0.085], [-0.35, -1.0, 0.1], [0.0, 0.0, 1.0]);
        self.cone(0.06, [-0.65, 0.97, 0.14], 0.07, [-0.46, 0.80, 0.18], 0.095);
    }

    fn neck(&mut self) {
        self.squeezed(0.10, [-0.50, 1.15, 0.0], 0.25, [-0.95, 1.37, 0.0], 0.135, 0.72);
        // Dewlap, from the throat to the brisket.
        self.squeezed(0.05, [-1.00, 1.20, 0.0], 0.05, [-0.85, 0.95, 0.0], 0.075, 0.38);
        self.squeezed(0.05, [-0.85, 0.95, 0.0], 0.075, [-0.70, 0.78, 0.0], 0.075, 0.38);
    }

    fn head(&mut self) {
        let along = [-0.74, -0.67, 0.0];
        let side = [0.0, 0.0, 1.0];
        // Cranium, poll, bridge of the nose, jaw and cheeks.
        self.ball(0.05, [-1.03, 1.40, 0.0], [0.125, 0.11, 0.115]);
        self.ball(0.04, [-0.985, 1.48, 0.0], [0.055, 0.045, 0.08]);
        self.squeezed(0.04, [-1.05, 1.40, 0.0], 0.105, [-1.31, 1.175, 0.0], 0.075, 0.92);
        self.squeezed(0.04, [-1.00, 1.30, 0.0], 0.09, [-1.27, 1.115, 0.0], 0.055, 0.85);
        self.tilted(0.04, [-1.04, 1.32, 0.065], [0.125, 0.09, 0.042], along, side);
        // Brow, chin and muzzle; the mouth is the crease between the two.
        self.tilted(0.03, [-1.07, 1.43, 0.09], [0.06, 0.03, 0.032], along, side);
        self.tilted(0.05, [-1.285, 1.083, 0.0], [0.10, 0.045, 0.082], along, side);
        self.tilted(0.028, [-1.342, 1.147, 0.0], [0.088, 0.088, 0.108], along, side);
    }

    fn eyes_and_nostrils(&mut self) {
        self.ball(0.010, [-1.11, 1.385, 0.097], [0.032, 0.032, 0.032]);
        let along = [-0.74, -0.67, 0.0];
        let side = [0.0, 0.0, 1.0];
        self.cut(0.012, [-1.420, 1.150, 0.050], [0.022, 0.028, 0.018], along, side);
    }

    fn horn_and_ear(&mut self) {
        self.curve(0.012, [[-0.985, 1.485, 0.06], [-0.96, 1.52, 0.20], [-1.03, 1.57, 0.26], [-1.09, 1.69, 0.20]], [0.036, 0.011]);
        let along = [0.15, -0.22, 1.0];
        let thick = [-0.8, -0.5, 0.0];
        self.tilted(0.02, [-0.965, 1.395, 0.215], [0.13, 0.062, 0.021], along, thick);
        self.cut(0.015, [-0.985, 1.380, 0.23], [0.085, 0.036, 0.016], along, thick);
    }

    fn foreleg(&mut self) {
        self.cone(0.10, [-0.47, 0.84, 0.17], 0.10, [-0.485, 0.44, 0.17], 0.056);
        self.ball(0.03, [-0.490, 0.43, 0.17], [0.055, 0.08, 0.053]);
        self.cone(0.03, [-0.485, 0.40, 0.17], 0.046, [-0.475, 0.17, 0.17], 0.041);
        self.foot([-0.475, 0.15, 0.17]);
    }

    fn hind_leg(&mut self) {
        // From the hook bone down to thigh, stifle, gaskin, the tendon behind it and the hock.
        self.cone(0.10, [0.55, 1.26, 0.165], 0.07, [0.52, 0.98, 0.16], 0.11);
        self.ball(0.08, [0.66, 1.00, 0.15], [0.23, 0.30, 0.125]);
        self.cone(0.08, [0.51, 1.02, 0.15], 0.13, [0.46, 0.82, 0.19], 0.09);
        self.cone(0.06, [0.52, 0.84, 0.18], 0.12, [0.79, 0.53, 0.18], 0.055);
        self.cone(0.05, [0.70, 0.86, 0.165], 0.10, [0.80, 0.60, 0.18], 0.05);
        self.cone(0.08, [0.78, 1.12, 0.12], 0.10, [0.835, 0.57, 0.18], 0.036);
        self.ball(0.03, [0.81, 0.52, 0.18], [0.056, 0.07, 0.05]);
        self.cone(0.03, [0.805, 0.48, 0.18], 0.048, [0.765, 0.17, 0.18], 0.043);
        self.foot([0.762, 0.15, 0.18]);
    }

    /// Fetlock at `at`, pastern and the two claws of a hoof, down to below the ground.
    fn foot(&mut self, at: [f32; 3]) {
        let [x, _, z] = at;
        self.ball(0.02, at, [0.050, 0.055, 0.048]);
        self.cone(0.015, at, 0.044, [x - 0.04, 0.08, z], 0.047);
        for side in [-0.031, 0.031] {
            let (heel, toe) = ([x - 0.03, 0.04, z + side], [x - 0.12, 0.012, z + side]);
            self.cone(0.016, heel, 0.046, toe, 0.025);
        }
    }

    fn udder(&mut self) {
        self.ball(0.06, [0.54, 0.72, 0.0], [0.22, 0.16, 0.15]);
        self.ball(0.04, [0.45, 0.65, 0.075], [0.11, 0.11, 0.075]);
        self.ball(0.04, [0.63, 0.645, 0.075], [0.12, 0.12, 0.08]);
    }

    fn teats(&mut self) {
        self.cone(0.015, [0.44, 0.555, 0.08], 0.022, [0.437, 0.490, 0.085], 0.016);
        self.cone(0.015, [0.625, 0.54, 0.078], 0.022, [0.625, 0.475, 0.082], 0.016);
    }

    fn tail(&mut self) {
        self.curve(0.05, [[0.86, 1.36, 0.0], [1.06, 1.38, 0.0], [0.95, 1.00, 0.0], [0.975, 0.66, 0.0]], [0.045, 0.022]);
        self.ball(0.03, [0.973, 0.53, 0.0], [0.05, 0.18, 0.048]);
    }

    /// Cuts the hooves flat.
    fn ground(&mut self) {
        self.push(Join::Cut, 0.006, Shape::Below { y: 0.0 });
    }
}

/// The ways to put parts on or cut them off.
impl Model {
    /// Cones along a Bézier curve, the radius going evenly from the first to
    /// the second of `radii`.
    fn curve(&mut self, blend: f32, control: [[f32; 3]; 4], radii: [f32; 2]) {
        let knots = bezier(control);
        let pieces = knots.len() as f32 - 1.0;
        let radius = |i: usize| radii[0] + (radii[1] - radii[0]) * i as f32 / pieces;
        for (i, k) in knots.windows(2).enumerate() {
            // Blended widely, the joints would swell.
            let blend = if i < 2 { blend } else { 0.003 };
            self.cone(blend, k[0].into(), radius(i), k[1].into(), radius(i + 1));
        }
    }

    fn cone(&mut self, blend: f32, a: [f32; 3], ra: f32, b: [f32; 3], rb: f32) {
        self.squeezed(blend, a, ra, b, rb, 1.0);
    }

    fn squeezed(&mut self, blend: f32, a: [f32; 3], ra: f32, b: [f32; 3], rb: f32, squeeze: f32) {
        let shape = round_cone(a.into(), ra, b.into(), rb, squeeze);
        self.push(Join::Add, blend, shape);
    }

    fn ball(&mut self, blend: f32, centre: [f32; 3], radii: [f32; 3]) {
        self.tilted(blend, centre, radii, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    }

    /// An ellipsoid with its first axis along `first` and its third towards `third`.
    fn tilted(
        &mut self,
        blend: f32,
        centre: [f32; 3],
        radii: [f32; 3],
        first: [f32; 3],
        third: [f32; 3],
    ) {
        let shape = ellipsoid(centre, radii, first, third);
        self.push(Join::Add, blend, shape);
    }

    fn cut(
        &mut self,
        blend: f32,
        centre: [f32; 3],
        radii: [f32; 3],
        first: [f32; 3],
        third: [f32; 3],
    ) {
        let shape = ellipsoid(centre, radii, first, third);
        self.push(Join::Cut, blend, shape);
    }

    fn push(&mut self, join: Join, blend: f32, shape: Shape) {
        self.parts.push(Part { shape, join, blend });
    }
}

fn round_cone(a: Vec3, ra: f32, b: Vec3, rb: f32, squeeze: f32) -> Shape {
    Shape::RoundCone {
        a,
        ra,
        b,
        rb,
        squeeze,
    }
}

fn ellipsoid(centre: [f32; 3], radii: [f32; 3], first: [f32; 3], third: [f32; 3]) -> Shape {
    let first = Vec3::from(first).normalize();
    let second = Vec3::from(third).cross(first).normalize();
    let third = first.cross(second);
    Shape::Ellipsoid {
        centre: centre.into(),
        radii: radii.into(),
        to_local: Mat3::from_cols(first, second, third).transpose(),
    }
}

/// Seven points along a cubic Bézier curve, by de Casteljau's construction.
fn bezier(control: [[f32; 3]; 4]) -> [Vec3; 7] {
    let [a, b, c, d] = control.map(Vec3::from);
    std::array::from_fn(|i| {
        let t = i as f32 / 6.0;
        let (ab, bc, cd) = (a.lerp(b, t), b.lerp(c, t), c.lerp(d, t));
        ab.lerp(bc, t).lerp(bc.lerp(cd, t), t)
    })
}
