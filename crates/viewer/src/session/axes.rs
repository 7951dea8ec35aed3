//! The places of numbers on the axes, from which lengths in the picture can be read.

use sim_core::DVec3;

use super::Session;

/// The count of numbers on each axis, and the distance of the first from the origin in distances of the camera, before
/// rounding.
const NUMBERS: u32 = 5;
const SPACING: f64 = 0.11;

/// The numbers and the letter of one axis.
pub struct AxisMarks {
    /// Its name.
    pub letter: &'static str,
    /// The position of the letter, m: near the origin, which is more often in view than the far end.
    pub place: DVec3,
    /// sRGB.
    pub colour: [f32; 3],
    /// Points on the axis, m, and the coordinate of each.
    pub marks: Vec<(DVec3, f64)>,
}

impl Session {
    /// The numbers on the three axes, at round distances that suit the view.
    pub fn axis_marks(&self) -> [AxisMarks; 3] {
        let step = round(SPACING * self.camera.distance);
        let axes = [
            ("x", DVec3::X, [0.72, 0.06, 0.06]),
            ("y", DVec3::Y, [0.05, 0.42, 0.12]),
            ("z", DVec3::Z, [0.04, 0.16, 0.72]),
        ];
        axes.map(|(letter, along, colour)| AxisMarks {
            letter,
            place: 0.5 * step * along,
            colour,
            marks: (1..=NUMBERS)
                .map(|n| f64::from(n) * step)
                .map(|value| (value * along, value))
                .collect(),
        })
    }
}

/// The least of 1, 2 and 5 times a power of ten that is not less than `length`.
fn round(length: f64) -> f64 {
    let power = 10_f64.powf(length.log10().floor());
    let times = [1.0, 2.0, 5.0].into_iter();
    let least = times.map(|n| n * power).find(|value| *value >= length);
    least.unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn marks_are_at_round_numbers() {
        for (length, round_up) in [
            (0.88, 1.0),
            (1.0, 1.0),
            (1.1, 2.0),
            (30.0, 50.0),
            (0.07, 0.1),
        ] {
            assert!(
                (round(length) - round_up).abs() < 1e-12 * round_up,
                "{length}"
            );
        }
    }
}
