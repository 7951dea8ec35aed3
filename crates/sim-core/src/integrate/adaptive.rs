//! A solver with error control within one `dt`.
//!
//! Each `dt` is a separate problem, and begins with an attempt to cover it in one step. Only the motion passes from one
//! `dt` to the next, so that bodies may be moved in between.

use bytemuck::{cast_slice, cast_slice_mut};
use core::slice;
use glam::DVec3;

use super::{Failure, Step, System};
use crate::ode::{Embedded, Solver, State, Tolerance};

/// The most steps tried within one `dt`.
pub(crate) const MOST_STEPS: u32 = 100_000;

/// Columns of the scratch: the state, both ends of a step, one more, and up to 16 stages.
const COLUMNS: usize = 20;

/// One step of `dt`. A single body is stepped in an array, several bodies in columns of the scratch.
pub(super) fn step<E: Embedded>(system: &dyn System, s: Step<'_>) -> Result<(), Failure> {
    let n = s.position.len();
    // Relative to the start of the step, so that times keep all their digits.
    let span = [s.dt, s.tolerance];
    let failure = |body| Failure::TooManySteps {
        body,
        steps: MOST_STEPS,
    };
    if n == 1 {
        let (x, v) = (s.position[0], s.velocity[0]);
        let mut y = [x.x, x.y, x.z, v.x, v.y, v.z];
        let f = |t, y: &[f64; 6], dy: &mut [f64; 6]| {
            let mut a = DVec3::ZERO;
            let x = DVec3::new(y[0], y[1], y[2]);
            let v = DVec3::new(y[3], y[4], y[5]);
            system.accelerations(
                s.time + t,
                slice::from_ref(&x),
                slice::from_ref(&v),
                slice::from_mut(&mut a),
            );
            *dy = [v.x, v.y, v.z, a.x, a.y, a.z];
        };
        let mut watch = s.watch;
        let stops = |time: f64, before: &[f64; 6], after: &[f64; 6]| {
            let place = |y: &[f64; 6]| DVec3::new(y[0], y[1], y[2]);
            let watch = watch.as_mut();
            watch.is_some_and(|watch| watch.stops(time, &[place(before)], &[place(after)]))
        };
        let (tried, done) = solve::<E, [f64; 6]>(f, &mut y, span, &mut || [0.0; 6], stops);
        s.scratch.tried += tried;
        let [x, y, z, u, v, w] = y;
        s.new_position[0] = DVec3::new(x, y, z);
        s.new_velocity[0] = DVec3::new(u, v, w);
        return done.map_err(|()| failure(0));
    }
    // Positions first, then velocities.
    let mut columns = s.scratch.columns::<COLUMNS>(2 * n).into_iter();
    let mut room = || cast_slice_mut(columns.next().unwrap_or_default());
    let mut y: &mut [f64] = room();
    y[..3 * n].copy_from_slice(cast_slice(s.position));
    y[3 * n..].copy_from_slice(cast_slice(s.velocity));
    let f = |t, y: &&mut [f64], dy: &mut &mut [f64]| {
        let (x, v) = y.split_at(3 * n);
        let (dx, dv) = dy.split_at_mut(3 * n);
        dx.copy_from_slice(v);
        system.accelerations(s.time + t, cast_slice(x), cast_slice(v), cast_slice_mut(dv));
    };
    let mut watch = s.watch;
    let stops = |time: f64, before: &&mut [f64], after: &&mut [f64]| {
        let (before, after) = (cast_slice(&before[..3 * n]), cast_slice(&after[..3 * n]));
        let watch = watch.as_mut();
        watch.is_some_and(|watch| watch.stops(time, before, after))
    };
    let (tried, done) = solve::<E, &mut [f64]>(f, &mut y, span, &mut room, stops);
    let (x, v) = y.split_at(3 * n);
    s.new_position.copy_from_slice(cast_slice(x));
    s.new_velocity.copy_from_slice(cast_slice(v));
    drop(columns);
    s.scratch.tried += tried * n as u64;
    done.map_err(|()| {
        // The body that moved farthest is the one that needs the shortest steps.
        let moved = |i: usize| (s.new_position[i] - s.position[i]).length_squared();
        failure((0..n).fold(0, |most, i| if moved(i) > moved(most) { i } else { most }))
    })
}

/// Solves from `y` to the end of the step, or to the time at which it is stopped, and leaves the state in `y`. Returns
/// the number of steps tried.
fn solve<E: Embedded, Y: State>(
    f: impl FnMut(f64, &Y, &mut Y),
    y: &mut Y,
    [dt, tolerance]: [f64; 2],
    room: &mut dyn FnMut() -> Y,
    mut stops: impl FnMut(f64, &Y, &Y) -> bool,
) -> (u64, Result<(), ()>) {
    let mut start = room();
    start.as_mut().copy_from_slice(y.as_ref());
    let mut solver =
        Solver::<E::Stages<Y>, Y, _>::with_room(f, 0.0, start, Tolerance::of(tolerance), room);
    solver.most_steps = u64::from(MOST_STEPS);
    solver.try_step(dt);
    let mut done = solver.step(dt);
    while done.is_ok()
        && solver.time() != dt
        && !stops(solver.time(), solver.state_before(), solver.state())
    {
        done = solver.step(dt);
    }
    y.as_mut().copy_from_slice(solver.state().as_ref());
    (solver.steps() + solver.rejected(), done.map_err(|_| ()))
}
