//! Jacobi's elliptic functions, and the free rotation of a body in terms of them.

use std::f64::consts::FRAC_PI_2;

use sim_core::DVec3;

/// The complete integral `K(m)` as a function of `1 - m`, which keeps its accuracy if `m` is near 1.
pub fn complete(one_minus_m: f64) -> f64 {
    let (mut a, mut b) = (1.0, one_minus_m.sqrt());
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// `sn, cn, dn` of `u` and the parameter `m`, given as `1 - m`, by descending Landen transformations
/// (Abramowitz, Stegun, 16.4).
pub fn functions(u: f64, one_minus_m: f64) -> [f64; 3] {
    let (mut a, mut b) = (1.0, one_minus_m.sqrt());
    let mut ratios = Vec::new();
    while (a - b).abs() > 1e-15 * a {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        ratios.push(c / a);
    }
    let mut angle = 2_f64.powi(ratios.len() as i32) * a * u;
    for ratio in ratios.iter().rev() {
        angle = 0.5 * (angle + (ratio * angle.sin()).asin());
    }
    let (sn, cn) = angle.sin_cos();
    // 1 - m sn² = cn² + (1 - m) sn², a sum of positive terms.
    [sn, cn, (cn * cn + one_minus_m * sn * sn).sqrt()]
}

/// The angular velocity, in its own frame, of a freely rotating body with moments in ascending order. It starts from
/// `(0, b, c)`, both positive, with more energy than on the separatrix towards the third axis.
pub struct Racket {
    amplitude: DVec3,
    rate: f64,
    one_minus_m: f64,
}

impl Racket {
    /// The rotation for the moments and the initial second and third component.
    pub fn new(moments: DVec3, b: f64, c: f64) -> Racket {
        let [i, j, k] = moments.to_array();
        // L² - 2 E I₁ and 2 E I₃ - L², as sums of positive terms.
        let low = j * (j - i) * b * b + k * (k - i) * c * c;
        let high = j * (k - j) * b * b;
        let above = k * (k - i) * (k - j) * c * c;
        Racket {
            amplitude: DVec3::new(
                (high / (i * (k - i))).sqrt(),
                (high / (j * (k - j))).sqrt(),
                (low / (k * (k - i))).sqrt(),
            ),
            rate: ((k - j) * low / (i * j * k)).sqrt(),
            // 1 - (I₂ - I₁) high / ((I₃ - I₂) low)
            one_minus_m: above / ((k - j) * low),
        }
    }

    /// Half the time in which the second component changes its sign twice, s.
    pub fn flip(&self) -> f64 {
        2.0 * complete(self.one_minus_m) / self.rate
    }

    /// The angular velocity after a time, s.
    pub fn at(&self, t: f64) -> DVec3 {
        let quarter = complete(self.one_minus_m);
        let [sn, cn, dn] = functions(quarter + self.rate * t, self.one_minus_m);
        self.amplitude * DVec3::new(cn, sn, dn)
    }
}
