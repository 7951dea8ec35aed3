//! Problems with known solutions, as first-order systems.

/// Pleiades: seven bodies of mass 1 to 7 in a plane under their own gravitation with `G = 1`
/// (Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. II.10, p. 245).
pub mod pleiades {
    /// Numbers of a state: x, y, x', y' of seven bodies each.
    pub const N: usize = 28;

    /// The state at t = 0.
    pub const START: [f64; N] = [
        3.0, 3.0, -1.0, -3.0, 2.0, -2.0, 2.0, //
        3.0, -3.0, 2.0, 0.0, 0.0, -4.0, 4.0, //
        0.0, 0.0, 0.0, 0.0, 0.0, 1.75, -1.5, //
        0.0, 0.0, 0.0, -1.25, 1.0, 0.0, 0.0,
    ];

    /// Positions at t = 3 to the digits printed in the book's test set.
    pub const END: [f64; 14] = [
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

    /// The derivative of a state.
    pub fn slope(y: &[f64; N], dy: &mut [f64; N]) {
        let (position, velocity) = y.split_at(14);
        let (x, z) = position.split_at(7);
        let (motion, pull) = dy.split_at_mut(14);
        motion.copy_from_slice(velocity);
        pull.fill(0.0);
        for i in 0..7 {
            for j in 0..i {
                let (dx, dz) = (x[j] - x[i], z[j] - z[i]);
                let squared = dx * dx + dz * dz;
                let inverse = 1.0 / (squared * squared.sqrt());
                let (first, second) = ((j + 1) as f64 * inverse, (i + 1) as f64 * inverse);
                pull[i] += first * dx;
                pull[7 + i] += first * dz;
                pull[j] -= second * dx;
                pull[7 + j] -= second * dz;
            }
        }
    }
}

/// A planet around a sun with `G M = 1` and half axis 1, from its perihelion: one orbit takes 2π.
pub mod kepler {
    /// The state x, y, x', y' there.
    pub fn start(eccentricity: f64) -> [f64; 4] {
        let e = eccentricity;
        [1.0 - e, 0.0, 0.0, ((1.0 + e) / (1.0 - e)).sqrt()]
    }
}
