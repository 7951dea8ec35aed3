//! Principal axes of a symmetric 3×3 matrix.

use glam::{DMat3, DQuat, DVec3};

/// The most rounds, in each of which every pair of axes is rotated once. The error squares in each round, so five are
/// enough.
const ROUNDS: usize = 12;

/// Eigenvalues of a symmetric matrix, and the rotation from coordinate axes to eigenvectors, by Jacobi's rotations. The
/// matrix has the diagonal `values` and the off-diagonal entries `yz, zx, xy`.
///
/// Off-diagonal entries of at most `noise` count as zero, and values that differ by no more count as equal: axes that
/// only rounding would choose stay those of the coordinates.
pub(super) fn diagonalised(
    mut values: [f64; 3],
    mut beside: [f64; 3],
    noise: f64,
) -> (DVec3, DQuat) {
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..ROUNDS {
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let entry = core::mem::take(&mut beside[k]);
            if entry.abs() <= noise {
                continue;
            }
            // The smaller of the angles that make the entry zero (Golub, Van Loan, sec. 8.5).
            let slope = (values[j] - values[i]) / (2.0 * entry);
            let tangent = 1.0_f64.copysign(slope) / (slope.abs() + libm::hypot(slope, 1.0));
            let cosine = 1.0 / libm::hypot(tangent, 1.0);
            let sine = tangent * cosine;
            values[i] -= tangent * entry;
            values[j] += tangent * entry;
            let (ik, jk) = (beside[j], beside[i]);
            beside[j] = cosine * ik - sine * jk;
            beside[i] = sine * ik + cosine * jk;
            let (a, b) = (axes[i], axes[j]);
            axes[i] = cosine * a - sine * b;
            axes[j] = sine * a + cosine * b;
        }
    }
    let equal = |a: f64, b: f64| (a - b).abs() <= noise;
    let [x, y, z] = values;
    values = match (equal(x, y), equal(y, z), equal(z, x)) {
        (true, true, true) => [(x + y + z) / 3.0; 3],
        (true, ..) => [0.5 * (x + y), 0.5 * (x + y), z],
        (_, true, _) => [x, 0.5 * (y + z), 0.5 * (y + z)],
        (.., true) => [0.5 * (z + x), y, 0.5 * (z + x)],
        _ => values,
    };
    let [x, y, z] = axes;
    let rotation = DQuat::from_mat3(&DMat3::from_cols(x, y, z)).normalize();
    (DVec3::from_array(values), rotation)
}
