//! Formats numbers for users.

/// About four significant digits, with an exponent if that is shorter. Small and large values have about the same
/// width, so that the columns of a changing figure stay in place.
pub fn figure(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{value:.2e}")
    } else if size < 10.0 {
        format!("{value:.4}")
    } else if size < 1000.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.0}")
    }
}

/// Two significant digits, for narrow tables.
pub fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if !(1e-2..1e3).contains(&size) {
        format!("{value:.1e}")
    } else if size < 10.0 {
        format!("{value:.2}")
    } else if size < 100.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}

/// A value, or 0 if it is only rounding error relative to another value of its kind.
pub fn beside(value: f64, other: f64) -> f64 {
    if value.abs() > 1e-13 * other.abs() {
        value
    } else {
        0.0
    }
}

/// A duration in seconds, with a suitable unit.
pub fn seconds(value: f64) -> String {
    if value == 0.0 {
        "0 s".to_owned()
    } else if value < 1e-6 {
        format!("{:.1} ns", value * 1e9)
    } else if value < 1e-3 {
        format!("{:.1} µs", value * 1e6)
    } else if value < 1.0 {
        format!("{:.1} ms", value * 1e3)
    } else {
        format!("{value:.2} s")
    }
}

/// A length in metres, or in millimetres if it is short.
pub fn length(value: f64) -> String {
    if value == 0.0 || value.abs() >= 0.1 {
        format!("{} m", short(value))
    } else {
        format!("{} mm", short(1000.0 * value))
    }
}

/// A number without the digits that are rounding errors.
pub fn tidy(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// A whole number, in groups of three digits.
pub fn count(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Bytes, with two digits or more, in a suitable unit.
pub fn bytes(count: usize) -> String {
    let size = count as f64;
    match size {
        ..1e3 => format!("{count} B"),
        ..1e6 => format!("{:.0} kB", size / 1e3),
        ..1e9 => format!("{:.1} MB", size / 1e6),
        _ => format!("{:.1} GB", size / 1e9),
    }
}

/// An energy, J. It may be infinite, for example if a body is at a centre of attraction.
pub fn energy(value: f64) -> String {
    if value.is_finite() {
        format!("{} J", figure(value))
    } else {
        "unbounded".to_owned()
    }
}

/// An error: 0, or its sign and two or three digits.
pub fn error(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if !(0.095..995.0).contains(&size) {
        format!("{value:+.1e}")
    } else if size < 9.95 {
        format!("{value:+.1}")
    } else {
        format!("{value:+.0}")
    }
}

#[cfg(test)]
mod tests {
    use super::{beside, count, energy, error, figure, seconds};

    #[test]
    fn figures_stay_short() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1.0000"),
            (-12.345, "-12.35"),
            (123456.0, "123456"),
            (1e-9, "1.00e-9"),
            (-2.5e300, "-2.50e300"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ];
        for (value, text) in cases {
            assert_eq!(figure(value), text);
        }
    }

    #[test]
    fn seconds_choose_their_unit() {
        assert_eq!(seconds(12.34e-6), "12.3 µs");
        assert_eq!(seconds(0.0167), "16.7 ms");
        assert_eq!(seconds(2.0), "2.00 s");
        assert_eq!(seconds(0.0), "0 s");
        assert_eq!(seconds(7.04e-9), "7.0 ns");
    }

    #[test]
    fn rounding_beside_something_large_is_0() {
        assert_eq!(beside(9.44e-16, 4.42), 0.0);
        assert_eq!(beside(-1e-9, 4.42), -1e-9);
        assert_eq!(beside(2.9e-40, 0.0), 2.9e-40);
    }

    #[test]
    fn counts_are_grouped_and_energies_are_numbers() {
        let cases = [
            (0.0, "0"),
            (999.0, "999"),
            (1e3, "1,000"),
            (1234567.0, "1,234,567"),
        ];
        for (value, text) in cases {
            assert_eq!(count(value), text);
        }
        assert_eq!(energy(-2.5), "-2.5000 J");
        assert_eq!(energy(f64::NEG_INFINITY), "unbounded");
        assert_eq!(energy(f64::NAN), "unbounded");
    }

    #[test]
    fn errors_keep_their_sign() {
        assert_eq!(error(0.0), "0");
        assert_eq!(error(1.23e-16), "+1.2e-16");
        assert_eq!(error(-0.5), "-0.5");
        assert_eq!(error(-9.43), "-9.4");
        assert_eq!(error(0.02), "+2.0e-2");
        assert_eq!(error(123.4), "+123");
        assert_eq!(error(-1254.0), "-1.3e3");
    }
}
