//! Explicit Runge-Kutta solvers of `y' = f(t, y)` that choose their steps.
//!
//! [`Dopri5`] and [`Dop853`] are one [`Solver`] with two embedded pairs. Step control follows
//! Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. II.4: a step is
//! accepted if its error, estimated with a second method and divided by the tolerance, is at most
//! 1, and the length of the next step keeps the error at most 1.

mod dop853;
mod dop853_table;
mod dopri5;

use core::mem::swap;

pub use dop853::Dop853Stages;
pub use dopri5::Dopri5Stages;

/// Dormand and Prince's method of order 5, error estimate of order 4, dense output of order 4.
///
/// ```
/// use sim_core::{Dopri5, Tolerance};
///
/// let oscillator = |_t, y: &[f64; 2], dy: &mut [f64; 2]| *dy = [y[1], -y[0]];
/// let mut solver = Dopri5::new(oscillator, 0.0, [1.0, 0.0], Tolerance::of(1e-9));
/// solver.advance(10.0)?;
/// assert!((solver.state()[0] - 10f64.cos()).abs() < 1e-7);
/// # Ok::<(), sim_core::SolveError>(())
/// ```
pub type Dopri5<Y, F> = Solver<Dopri5Stages<Y>, Y, F>;

/// Dormand and Prince's method of order 8, error estimates of orders 5 and 3, dense output of
/// order 7. Used as [`Dopri5`] is.
pub type Dop853<Y, F> = Solver<Dop853Stages<Y>, Y, F>;

/// A state of numbers: an array, a `Vec`, or a slice borrowed from one.
pub trait State: AsRef<[f64]> + AsMut<[f64]> {}

impl<Y: AsRef<[f64]> + AsMut<[f64]>> State for Y {}

/// The error that a solver may make in a step, for each component: `absolute + relative · |y|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative to the component.
    pub relative: f64,
    /// In the component's own unit.
    pub absolute: f64,
}

impl Tolerance {
    /// The same tolerance for both.
    pub fn of(both: f64) -> Tolerance {
        Tolerance {
            relative: both,
            absolute: both,
        }
    }
}

/// The reason why a solver stopped before its end.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// The tolerance asks for steps that are below the rounding of `time`, or the solution is not finite.
    #[error("at t = {time} the step fell to {step}")]
    StepTooSmall {
        /// The time at which the solver stopped.
        time: f64,
        /// The step that was tried last.
        step: f64,
    },
    /// The solver has tried the allowed number of steps.
    #[error("at t = {time} after {steps} steps")]
    TooManySteps {
        /// The time at which the solver stopped.
        time: f64,
        /// Steps tried.
        steps: u64,
    },
}

/// An embedded pair of methods with its stages.
pub trait Pair<Y: State> {
    /// Exponents of the step control: of this step's error, and of the last one's.
    const CONTROL: [f64; 2];
    /// Least and greatest factor from one step to the next.
    const FACTORS: [f64; 2];
    /// The order for which the first step is estimated.
    const ORDER: f64;

    /// Empty stages, each made by a call of `room`.
    fn with_room(room: &mut dyn FnMut() -> Y) -> Self;

    /// The slope at the start of a step, and a column that is unused before the stages are computed.
    fn slope(&mut self) -> (&mut Y, &mut Y);

    /// Computes the stages of a step of length `h` and writes its end. Returns evaluations of `f`.
    fn stages(&mut self, f: &mut impl FnMut(f64, &Y, &mut Y), at: Start<'_, Y>, end: &mut Y)
    -> u64;

    /// The estimated error of the step, in units of the tolerance.
    fn error(&self, at: Start<'_, Y>, end: &Y, tolerance: Tolerance) -> f64;

    /// Completes an accepted step with the slope at its end. Returns evaluations of `f`.
    fn finish(&mut self, f: &mut impl FnMut(f64, &Y, &mut Y), time: f64, end: &Y) -> u64;

    /// Makes the slope at the end of a step the slope at the start of the next.
    fn shift(&mut self);

    /// Computes the data for dense output, beside the stages. Returns evaluations of `f`.
    fn prepare_dense(
        &mut self,
        f: &mut impl FnMut(f64, &Y, &mut Y),
        at: Start<'_, Y>,
        end: &Y,
        room: &mut Y,
    ) -> u64;

    /// Component `i` at the fraction `theta` of the step, once dense output is prepared.
    fn dense(&self, i: usize, theta: f64, at: Start<'_, Y>, end: &Y) -> f64;
}

/// A pair for any type of state.
pub trait Embedded {
    /// The stages for one type of state.
    type Stages<Y: State>: Pair<Y>;
}

/// Names the pair of [`Dopri5`].
#[derive(Clone, Copy, Debug)]
pub struct DormandPrince5;

impl Embedded for DormandPrince5 {
    type Stages<Y: State> = Dopri5Stages<Y>;
}

/// Names the pair of [`Dop853`].
#[derive(Clone, Copy, Debug)]
pub struct DormandPrince8;

impl Embedded for DormandPrince8 {
    type Stages<Y: State> = Dop853Stages<Y>;
}

/// The start and length of a step.
#[derive(Debug)]
pub struct Start<'a, Y> {
    /// Time.
    pub t: f64,
    /// Length; negative to go backwards.
    pub h: f64,
    /// State.
    pub y: &'a Y,
}

impl<Y> Clone for Start<'_, Y> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Y> Copy for Start<'_, Y> {}

/// A solution of `y' = f(t, y)` in progress.
#[derive(Clone, Debug)]
pub struct Solver<P, Y, F> {
    f: F,
    tolerance: Tolerance,
    /// The most steps that may be tried in all; initially a billion.
    pub most_steps: u64,
    /// Time at the start and the end of the last step.
    from: f64,
    time: f64,
    /// Length of the next step; 0 before the first.
    next: f64,
    start: Y,
    end: Y,
    room: Y,
    pair: P,
    log2_last_error: f64,
    rejected_last: bool,
    stage: Stage,
    steps: u64,
    rejected: u64,
    evaluations: u64,
}

/// The contents of the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// `end` has the state; there is no slope.
    Fresh,
    /// The columns have a step from `start` to `end`.
    Stepped,
    /// They also have the data for dense output.
    Dense,
}

impl<P: Pair<Y>, Y: State + Clone, F: FnMut(f64, &Y, &mut Y)> Solver<P, Y, F> {
    /// A solution that starts at `y` at time `t`.
    pub fn new(f: F, t: f64, y: Y, tolerance: Tolerance) -> Self {
        let room = y.clone();
        Solver::with_room(f, t, y, tolerance, &mut || room.clone())
    }
}

impl<P: Pair<Y>, Y: State, F: FnMut(f64, &Y, &mut Y)> Solver<P, Y, F> {
    /// The same, with columns of `y`'s length made by `room`; their contents do not matter.
    pub fn with_room(
        f: F,
        t: f64,
        y: Y,
        tolerance: Tolerance,
        room: &mut dyn FnMut() -> Y,
    ) -> Self {
        Solver {
            f,
            tolerance,
            most_steps: 1_000_000_000,
            from: t,
            time: t,
            next: 0.0,
            start: room(),
            end: y,
            room: room(),
            pair: P::with_room(room),
            log2_last_error: LOG2_LEAST_ERROR,
            rejected_last: false,
            stage: Stage::Fresh,
            steps: 0,
            rejected: 0,
            evaluations: 0,
        }
    }

    /// Sets the length of the next step, which the step control would choose otherwise.
    pub fn try_step(&mut self, length: f64) {
        self.next = length;
    }

    /// Advances to `end`, exactly.
    pub fn advance(&mut self, end: f64) -> Result<(), SolveError> {
        while self.time != end {
            self.step(end)?;
        }
        Ok(())
    }

    /// Advances by one step, at most to `end`.
    pub fn step(&mut self, end: f64) -> Result<(), SolveError> {
        self.begin(end);
        let planned = self.next;
        loop {
            let rest = end - self.time;
            // If the rest after a step would be tiny, the step goes to the end.
            let last = 1.01 * self.next.abs() >= rest.abs();
            let h = if last { rest } else { self.next };
            self.check_step(h)?;
            let at = Start {
                t: self.time,
                h,
                y: &self.start,
            };
            self.evaluations += self.pair.stages(&mut self.f, at, &mut self.end);
            let error = self.pair.error(at, &self.end, self.tolerance);
            if error <= 1.0 {
                self.accept(h, error, if last { end } else { self.time + h });
                if last && !self.rejected_last {
                    // The end has shortened this step, but the next one need not be short.
                    self.next = longer(self.next, planned);
                }
                self.rejected_last = false;
                return Ok(());
            }
            self.rejected += 1;
            self.rejected_last = true;
            let [exponent, _] = P::CONTROL;
            let [least, _] = P::FACTORS;
            let change = match error.is_finite() {
                true => SAFETY * power_of_2(-exponent * rough_log2(error)),
                false => least,
            };
            self.next = h * factor::<P, Y>(change).min(SAFETY);
        }
    }

    /// Time reached.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// State before the last step.
    pub(crate) fn state_before(&self) -> &Y {
        &self.start
    }

    /// State at the time reached.
    pub fn state(&self) -> &Y {
        &self.end
    }

    /// Steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Steps that were rejected.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Calls of `f`.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Writes the state at a time within the last step. The first call in a step may evaluate `f`.
    pub fn at(&mut self, t: f64, y: &mut Y) {
        if self.stage == Stage::Fresh {
            y.as_mut().copy_from_slice(self.end.as_ref());
            return;
        }
        let h = self.time - self.from;
        let at = Start {
            t: self.from,
            h,
            y: &self.start,
        };
        if self.stage == Stage::Stepped {
            self.evaluations += self
                .pair
                .prepare_dense(&mut self.f, at, &self.end, &mut self.room);
            self.stage = Stage::Dense;
        }
        let theta = (t - self.from) / h;
        for (i, y) in y.as_mut().iter_mut().enumerate() {
            *y = self.pair.dense(i, theta, at, &self.end);
        }
    }

    /// Makes the end of the last step the start of the next.
    fn begin(&mut self, end: f64) {
        swap(&mut self.start, &mut self.end);
        if self.stage == Stage::Fresh {
            (self.f)(self.time, &self.start, self.pair.slope().0);
            self.evaluations += 1;
            if self.next == 0.0 {
                self.next = self.first_step(end - self.time);
            }
        } else {
            self.pair.shift();
        }
        self.next = libm::copysign(self.next, end - self.time);
    }

    fn accept(&mut self, h: f64, error: f64, time: f64) {
        let [exponent, memory] = P::CONTROL;
        let log2_error = rough_log2(error);
        let change = power_of_2(memory * self.log2_last_error - exponent * log2_error);
        let change = factor::<P, Y>(SAFETY * change);
        // After a rejected step the next one is not longer.
        self.next = h * if self.rejected_last {
            change.min(1.0)
        } else {
            change
        };
        self.log2_last_error = log2_error.max(LOG2_LEAST_ERROR);
        self.evaluations += self.pair.finish(&mut self.f, time, &self.end);
        (self.from, self.time) = (self.time, time);
        self.stage = Stage::Stepped;
        self.steps += 1;
    }

    fn check_step(&mut self, h: f64) -> Result<(), SolveError> {
        let time = self.time;
        let steps = self.steps + self.rejected;
        let failure = if steps >= self.most_steps {
            SolveError::TooManySteps { time, steps }
        } else if h == 0.0 || h.is_nan() || 0.1 * h.abs() <= f64::EPSILON * time.abs() {
            SolveError::StepTooSmall { time, step: h }
        } else {
            return Ok(());
        };
        // Back to the state before this step, but without the last step's data for dense output.
        swap(&mut self.start, &mut self.end);
        self.stage = Stage::Fresh;
        Err(failure)
    }

    /// A first step from the size of the first two derivatives, at most `rest` (sec. II.4, p. 169).
    fn first_step(&mut self, rest: f64) -> f64 {
        let (n, y) = (self.start.as_ref().len(), self.start.as_ref());
        let weight = |i: usize| self.tolerance.absolute + self.tolerance.relative * y[i].abs();
        let (slope, moved) = self.pair.slope();
        let slope = slope.as_ref();
        let total = |of: &dyn Fn(usize) -> f64| -> f64 {
            (0..n)
                .map(|i| (of(i) / weight(i)) * (of(i) / weight(i)))
                .sum()
        };
        let (size, speed) = (total(&|i| y[i]), total(&|i| slope[i]));
        let guess = if size < 1e-10 || speed < 1e-10 {
            1e-6
        } else {
            0.01 * libm::sqrt(size / speed)
        };
        let h = libm::copysign(guess.min(rest.abs()), rest);
        let trial = self.room.as_mut().iter_mut();
        for (trial, (y, slope)) in trial.zip(y.iter().zip(slope)) {
            *trial = y + h * slope;
        }
        (self.f)(self.time + h, &self.room, moved);
        self.evaluations += 1;
        let moved = moved.as_ref();
        let change = total(&|i| moved[i] - slope[i]);
        let rate = libm::sqrt(speed).max(libm::sqrt(change) / h.abs());
        let step = if rate <= 1e-15 {
            (1e-3 * h.abs()).max(1e-6)
        } else {
            libm::pow(0.01 / rate, 1.0 / P::ORDER)
        };
        step.min(100.0 * h.abs()).min(rest.abs())
    }
}

/// A safety factor, because the error may be larger than estimated.
const SAFETY: f64 = 0.9;

/// The logarithm of 1e-4; smaller errors count as that in the control of the next step.
const LOG2_LEAST_ERROR: f64 = -13.287712379549449;

/// The logarithm to about six digits, which are enough for the length of a step, at a quarter of the cost of an exact
/// one. It uses `2 artanh((m - 1)/(m + 1))` for the mantissa `m` in `[√½, √2)`. Very low for 0.
fn rough_log2(x: f64) -> f64 {
    const HALF_ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    let shifted = x.to_bits().wrapping_sub(HALF_ROOT) as i64 >> 52;
    let m = f64::from_bits(x.to_bits().wrapping_sub((shifted as u64) << 52));
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let series = 1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0));
    shifted as f64 + 2.0 * core::f64::consts::LOG2_E * s * series
}

/// `2^x` to about five digits; `x` is clamped to ±1000.
fn power_of_2(x: f64) -> f64 {
    let x = x.clamp(-1000.0, 1000.0);
    let whole = libm::rint(x);
    let t = (x - whole) * core::f64::consts::LN_2;
    let square = t * t;
    let rest = (1.0 / 24.0 + t * (1.0 / 120.0)) * square;
    let series = (1.0 + t) + square * ((0.5 + t * (1.0 / 6.0)) + rest);
    series * f64::from_bits(((whole as i64 + 1023) as u64) << 52)
}

fn longer(a: f64, b: f64) -> f64 {
    if a.abs() > b.abs() { a } else { b }
}

/// The factor from one step to the next, clamped to its bounds; the least one for NaN.
fn factor<P: Pair<Y>, Y: State>(change: f64) -> f64 {
    let [least, greatest] = P::FACTORS;
    change.max(least).min(greatest)
}

/// One row of a tableau: stages and their weights, without the zeros.
type Row<const N: usize> = [(usize, f64); N];

/// `out = y + h Σ weight · stage`
#[inline(always)]
fn combine<Y: State, const N: usize>(at: Start<'_, Y>, k: &[Y], row: Row<N>, out: &mut Y) {
    let out = out.as_mut();
    let n = out.len();
    let y = &at.y.as_ref()[..n];
    let mut terms = [(&[][..], 0.0); N];
    for (term, (stage, weight)) in terms.iter_mut().zip(row) {
        *term = (&k[stage].as_ref()[..n], at.h * weight);
    }
    for i in 0..n {
        let mut sum = y[i];
        for (slope, weight) in terms {
            sum += weight * slope[i];
        }
        out[i] = sum;
    }
}

/// `Σ weight · stage` of component `i`.
#[inline(always)]
fn sum<Y: State, const N: usize>(k: &[Y], row: Row<N>, i: usize) -> f64 {
    let mut sum = 0.0;
    for (stage, weight) in row {
        sum += weight * k[stage].as_ref()[i];
    }
    sum
}
