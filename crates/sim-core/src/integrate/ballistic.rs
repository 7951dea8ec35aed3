//! Bodies under a constant acceleration, whatever the method.

use bytemuck::cast_slice;
use glam::DVec3;

/// Steps each body as any method does that is exact for its own order, `x + dt v + fall dt² a`
/// and `v + dt a`, and tells whether every component is within ±`largest`.
///
/// One pass over the columns: 72 bytes read and 48 written a body. With `fall` 0, 1/2, 1 the
/// rounding is that of forward Euler, of the midpoint's, of symplectic Euler's own formula.
pub(crate) fn step(
    (x, v): (&[DVec3], &[DVec3]),
    a: &[DVec3],
    (x1, v1): (&mut [DVec3], &mut [DVec3]),
    (dt, fall): (f64, f64),
    largest: f64,
) -> bool {
    let [x, v, a]: [&[f64]; 3] = [x, v, a].map(cast_slice);
    let [x1, v1]: [&mut [f64]; 2] = [x1, v1].map(bytemuck::cast_slice_mut);
    let n = x.len();
    let (v, a, x1, v1) = (&v[..n], &a[..n], &mut x1[..n], &mut v1[..n]);
    let part = fall * dt;
    let mut within = true;
    for i in 0..n {
        let moved = x[i] + dt * (v[i] + part * a[i]);
        let faster = v[i] + dt * a[i];
        // NaN is not below anything.
        within &= (moved.abs() <= largest) & (faster.abs() <= largest);
        x1[i] = moved;
        v1[i] = faster;
    }
    within
}
