//! Dormand and Prince's method of order 8 with Hairer's error estimate and dense output.
//!
//! Sources stand beside the coefficients in `dop853_table.rs`.

use super::dop853_table::{
    A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A14, A15, A16, B, C, D4, D5, D6, D7, E3, E5,
};
use super::{Pair, Start, State, Tolerance, combine, sum};

/// Slopes of the twelve stages, the slope at the end, and three for dense output.
#[derive(Clone, Debug)]
pub struct Dop853Stages<Y>([Y; 16]);

impl<Y: State> Pair<Y> for Dop853Stages<Y> {
    const CONTROL: [f64; 2] = [1.0 / 8.0, 0.0];
    const FACTORS: [f64; 2] = [0.333, 6.0];
    const ORDER: f64 = 8.0;

    fn with_room(room: &mut dyn FnMut() -> Y) -> Self {
        Dop853Stages(core::array::from_fn(|_| room()))
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
        f(at.t + C[5] * at.h, end, &mut k[5]);
        combine(at, k, A7, end);
        f(at.t + C[6] * at.h, end, &mut k[6]);
        combine(at, k, A8, end);
        f(at.t + C[7] * at.h, end, &mut k[7]);
        combine(at, k, A9, end);
        f(at.t + C[8] * at.h, end, &mut k[8]);
        combine(at, k, A10, end);
        f(at.t + C[9] * at.h, end, &mut k[9]);
        combine(at, k, A11, end);
        f(at.t + C[10] * at.h, end, &mut k[10]);
        combine(at, k, A12, end);
        f(at.t + C[11] * at.h, end, &mut k[11]);
        combine(at, k, B, end);
        11
    }

    /// Combines both estimates: `|h| e5² / √(e5² + e3²/100)` (sec. II.10, eq. 10.17).
    #[inline]
    fn error(&self, at: Start<'_, Y>, end: &Y, tolerance: Tolerance) -> f64 {
        let (y, end) = (at.y.as_ref(), end.as_ref());
        let (mut fifth, mut third) = (0.0, 0.0);
        for i in 0..end.len() {
            let size = y[i].abs().max(end[i].abs());
            let weight = 1.0 / (tolerance.absolute + tolerance.relative * size);
            let (e5, e3) = (weight * sum(&self.0, E5, i), weight * sum(&self.0, E3, i));
            fifth += e5 * e5;
            third += e3 * e3;
        }
        let both = fifth + 0.01 * third;
        if both <= 0.0 {
            return 0.0;
        }
        at.h.abs() * fifth / libm::sqrt(both * end.len() as f64)
    }

    #[inline]
    fn finish(&mut self, f: &mut impl FnMut(f64, &Y, &mut Y), time: f64, end: &Y) -> u64 {
        f(time, end, &mut self.0[12]);
        1
    }

    fn shift(&mut self) {
        self.0.swap(0, 12);
    }

    fn prepare_dense(
        &mut self,
        f: &mut impl FnMut(f64, &Y, &mut Y),
        at: Start<'_, Y>,
        _: &Y,
        room: &mut Y,
    ) -> u64 {
        let k = &mut self.0;
        combine(at, k, A14, room);
        f(at.t + C[13] * at.h, room, &mut k[13]);
        combine(at, k, A15, room);
        f(at.t + C[14] * at.h, room, &mut k[14]);
        combine(at, k, A16, room);
        f(at.t + C[15] * at.h, room, &mut k[15]);
        3
    }

    fn dense(&self, i: usize, theta: f64, at: Start<'_, Y>, end: &Y) -> f64 {
        let slope = |stage: usize| at.h * self.0[stage].as_ref()[i];
        let start = at.y.as_ref()[i];
        let change = end.as_ref()[i] - start;
        let bend = slope(0) - change;
        let back = change - slope(12) - bend;
        let d4 = at.h * sum(&self.0, D4, i);
        let d5 = at.h * sum(&self.0, D5, i);
        let d6 = at.h * sum(&self.0, D6, i);
        let d7 = at.h * sum(&self.0, D7, i);
        let other = 1.0 - theta;
        let inner = d4 + theta * (d5 + other * (d6 + theta * d7));
        start + theta * (change + other * (bend + theta * (back + other * inner)))
    }
}
