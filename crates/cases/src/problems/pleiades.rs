//! Seven stars in a plane.

use sim_core::{Body, DMat3, DVec3, Force, Jacobians, Settings, System, World, WorldError};

use super::{Card, FirstOrder, Problem};
use crate::worlds;

/// Masses 1 to 7 under mutual gravitation with `G = 1`; state: all x, all y, all x', all y'.
#[derive(Clone, Debug)]
pub(crate) struct Pleiades;

const STARS: usize = 7;
const N: usize = 4 * STARS;

/// Initial positions and velocities of each star.
const START: [[f64; 4]; STARS] = [
    [3.0, 3.0, 0.0, 0.0],
    [3.0, -3.0, 0.0, 0.0],
    [-1.0, 2.0, 0.0, 0.0],
    [-3.0, 0.0, 0.0, -1.25],
    [2.0, 0.0, 0.0, 1.0],
    [-2.0, -4.0, 1.75, 0.0],
    [2.0, 4.0, -1.5, 0.0],
];

/// All x, then all y, at t = 3, to the digits printed in the book's test set.
pub const END: [f64; 2 * STARS] = [
    0.3706139143970502,
    3.237284092057233,
    -3.222559032418324,
    0.659709145577531,
    0.3425581707156584,
    1.562172101400631,
    -0.7003092922212495,
    -3.943437585517392,
    -3.27138097397255,
    5.225081843456543,
    -2.59061243497747,
    1.198213693392275,
    -0.2429682344935824,
    1.09144924042898,
];

pub(crate) fn problem() -> Problem<Pleiades, N> {
    Problem {
        card: Card {
            name: "pleiades",
            title: "Pleiades, T = 3",
            about: "Seven bodies of mass 1 to 7 in a plane, G = 1, with close encounters, for \
                    3 s. End: as printed for the test set (Hairer, Nørsett, Wanner 1993, Solving \
                    Ordinary Differential Equations I, sec. II.10).",
            error: "position",
            time: 3.0,
            steps: [64, 64 << 15],
            frames: 1,
            is_stiff: false,
        },
        equations: Pleiades,
        position: START.map(|[x, y, ..]| DVec3::new(x, y, 0.0)).to_vec(),
        velocity: START.map(|[.., x, y]| DVec3::new(x, y, 0.0)).to_vec(),
        exact: END.to_vec(),
        scale: 1.0,
    }
}

/// The same problem in a world, under gravitation.
pub fn world(settings: Settings) -> Result<World, WorldError> {
    let stars = START.into_iter().enumerate().map(|(i, [x, y, u, v])| Body {
        position: DVec3::new(x, y, 0.0),
        velocity: DVec3::new(u, v, 0.0),
        mass: mass(i),
        ..Body::default()
    });
    worlds::under(settings, stars, &[Force::Gravitation { constant: 1.0 }])
}

fn mass(star: usize) -> f64 {
    (star + 1) as f64
}

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..STARS).flat_map(|i| (0..i).map(move |j| (i, j)))
}

/// The derivative of the attraction `d/|d|³` with respect to `d`.
fn slope_of_pull(d: DVec3) -> DMat3 {
    let squared = d.length_squared();
    let outer = DMat3::from_cols(d.x * d, d.y * d, d.z * d) * (3.0 / squared);
    (DMat3::IDENTITY - outer) * (1.0 / (squared * squared.sqrt()))
}

impl System for Pleiades {
    fn len(&self) -> usize {
        STARS
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, x: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        a.fill(DVec3::ZERO);
        for (i, j) in pairs() {
            let d = x[j] - x[i];
            let squared = d.length_squared();
            let pull = d / (squared * squared.sqrt());
            a[i] += mass(j) * pull;
            a[j] -= mass(i) * pull;
        }
    }

    fn apply_jacobian(
        &self,
        _: f64,
        (x, _): (&[DVec3], &[DVec3]),
        (dx, _): (&[DVec3], &[DVec3]),
        da: &mut [DVec3],
    ) {
        da.fill(DVec3::ZERO);
        for (i, j) in pairs() {
            let change = slope_of_pull(x[j] - x[i]) * (dx[j] - dx[i]);
            da[i] += mass(j) * change;
            da[j] -= mass(i) * change;
        }
    }

    fn jacobians(&self, _: f64, x: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out.fill(Jacobians::ZERO);
        for (i, j) in pairs() {
            let slope = slope_of_pull(x[j] - x[i]);
            out[i].position -= slope * mass(j);
            out[j].position -= slope * mass(i);
        }
    }
}

impl FirstOrder<N> for Pleiades {
    fn slope(&self, y: &[f64; N], dy: &mut [f64; N]) {
        let (position, velocity) = y.split_at(2 * STARS);
        let (x, z) = position.split_at(STARS);
        let (motion, pull) = dy.split_at_mut(2 * STARS);
        motion.copy_from_slice(velocity);
        pull.fill(0.0);
        for (i, j) in pairs() {
            let (dx, dz) = (x[j] - x[i], z[j] - z[i]);
            let squared = dx * dx + dz * dz;
            let inverse = 1.0 / (squared * squared.sqrt());
            let (first, second) = (mass(j) * inverse, mass(i) * inverse);
            pull[i] += first * dx;
            pull[STARS + i] += first * dz;
            pull[j] -= second * dx;
            pull[STARS + j] -= second * dz;
        }
    }

    fn slope_along(&self, y: &[f64; N], d: &[f64; N], out: &mut [f64; N]) {
        let star = |s: &[f64; N], i: usize| DVec3::new(s[i], s[STARS + i], 0.0);
        let (motion, pull) = out.split_at_mut(2 * STARS);
        motion.copy_from_slice(&d[2 * STARS..]);
        pull.fill(0.0);
        for (i, j) in pairs() {
            let change = slope_of_pull(star(y, j) - star(y, i)) * (star(d, j) - star(d, i));
            pull[i] += mass(j) * change.x;
            pull[STARS + i] += mass(j) * change.y;
            pull[j] -= mass(i) * change.x;
            pull[STARS + j] -= mass(i) * change.y;
        }
    }

    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; N] {
        let mut state = [0.0; N];
        for i in 0..STARS {
            state[i] = x[i].x;
            state[STARS + i] = x[i].y;
            state[2 * STARS + i] = v[i].x;
            state[3 * STARS + i] = v[i].y;
        }
        state
    }
}
