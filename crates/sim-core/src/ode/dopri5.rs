//! Dormand and Prince's pair of orders 5 and 4.
//!
//! Coefficients: Dormand, Prince 1980, "A family of embedded Runge-Kutta formulae", J. Comput.
//! Appl. Math. 6, p. 19; dense output: Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential
//! Equations I, sec. II.6, eq. 6.12.

use super::{Pair, Row, Start, State, Tolerance, combine, sum};

/// Slopes of the seven stages; the last one is the slope at the end.
#[derive(Clone, Debug)]
pub struct Dopri5Stages<Y>([Y; 7]);

const C: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

const A2: Row<1> = [(0, 1.0 / 5.0)];
const A3: Row<2> = [(0, 3.0 / 40.0), (1, 9.0 / 40.0)];
const A4: Row<3> = [(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)];
const A5: Row<4> = [
    (0, 19372.0 / 6561.0),
    (1, -25360.0 / 2187.0),
    (2, 64448.0 / 6561.0),
    (3, -212.0 / 729.0),
];
const A6: Row<5> = [
    (0, 9017.0 / 3168.0),
    (1, -355.0 / 33.0),
    (2, 46732.0 / 5247.0),
    (3, 49.0 / 176.0),
    (4, -5103.0 / 18656.0),
];

/// Weights of the step.
const B: Row<5> = [
    (0, 35.0 / 384.0),
    (2, 500.0 / 1113.0),
    (3, 125.0 / 192.0),
    (4, -2187.0 / 6784.0),
    (5, 11.0 / 84.0),
];

/// Difference of the weights of both methods.
const E: Row<6> = [
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339200.0),
    (5, 22.0 / 525.0),
    (6, -1.0 / 40.0),
];

const DENSE: Row<6> = [
    (0, -12715105075.0 / 11282082432.0),
    (2, 87487479700.0 / 32700410799.0),
    (3, -10690763975.0 / 1880347072.0),
    (4, 701980252875.0 / 199316789632.0),
    (5, -1453857185.0 / 822651844.0),
    (6, 69997945.0 / 29380423.0),
];

impl<Y: State> Pair<Y> for Dopri5Stages<Y> {
    const CONTROL: [f64; 2] = [0.2 - 0.75 * 0.04, 0.04];
    const FACTORS: [f64; 2] = [0.2, 10.0];
    const ORDER: f64 = 5.0;

    fn with_room(room: &mut dyn FnMut() -> Y) -> Self {
        Dopri5Stages(core::array::from_fn(|_| room()))
    }

    fn slope(&mut self) -> (&mut Y, &mut Y) {
        let [slope, free, ..] = &mut self.0;
        (slope, free)
    }

    #[inline]
    fn stages(
        &mut self,
        f: &mut impl FnMut(f64, &Y, &mut Y),
        at: Start<'_, Y>,
        end: &mut Y,
    ) -> u64 {
        let k = &mut self.0;
        combine(at, k, A2, end);
        f(at.t + C[1] * at.h, end, &mut k[1]);
        combine(at, k, A3, end);
        f(at.t + C[2] * at.h, end, &mut k[2]);
        combine(at, k, A4, end);
        f(at.t + C[3] * at.h, end, &mut k[3]);
        combine(at, k, A5, end);
        f(at.t + C[4] * at.h, end, &mut k[4]);
        combine(at, k, A6, end);
        f(at.t + at.h, end, &mut k[5]);
        combine(at, k, B, end);
        f(at.t + at.h, end, &mut k[6]);
        6
    }

    #[inline]
    fn error(&self, at: Start<'_, Y>, end: &Y, tolerance: Tolerance) -> f64 {
        let (y, end) = (at.y.as_ref(), end.as_ref());
        let mut squares = 0.0;
        for i in 0..end.len() {
            let size = y[i].abs().max(end[i].abs());
            let weight = tolerance.absolute + tolerance.relative * size;
            let error = at.h * sum(&self.0, E, i) / weight;
            squares += error * error;
        }
        libm::sqrt(squares / end.len() as f64)
    }

    fn finish(&mut self, _: &mut impl FnMut(f64, &Y, &mut Y), _: f64, _: &Y) -> u64 {
        0
    }

    fn shift(&mut self) {
        self.0.swap(0, 6);
    }

    fn prepare_dense(
        &mut self,
        _: &mut impl FnMut(f64, &Y, &mut Y),
        _: Start<'_, Y>,
        _: &Y,
        _: &mut Y,
    ) -> u64 {
        0
    }

    fn dense(&self, i: usize, theta: f64, at: Start<'_, Y>, end: &Y) -> f64 {
        let slope = |stage: usize| at.h * self.0[stage].as_ref()[i];
        let start = at.y.as_ref()[i];
        let change = end.as_ref()[i] - start;
        let bend = slope(0) - change;
        let back = change - slope(6) - bend;
        let rest = at.h * sum(&self.0, DENSE, i);
        let other = 1.0 - theta;
        start + theta * (change + other * (bend + theta * (back + other * rest)))
    }
}
