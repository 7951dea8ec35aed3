//! Case 8: whole steps from frames of any length.

use std::time::Duration;

use sim_core::FixedStep;

use super::{Finding, Tried};

const FRAMES: u32 = 1_000_000;

pub(super) fn test() -> Tried {
    let mut wrong = 0;
    let mut words = Vec::new();
    let frames: [(&str, &dyn Fn(u32) -> Duration); 3] = [
        ("sixtieths", &|_| Duration::from_nanos(16_666_667)),
        // Multiples of the golden ratio are evenly distributed over 0 to 0.1 s.
        ("of 0 to 0.1 s", &|i| {
            Duration::from_nanos(u64::from(i) * 61_803_399 % 100_000_000)
        }),
        ("of a nanosecond", &|_| Duration::from_nanos(1)),
    ];
    for (name, frame) in frames {
        let (taken, exact) = count(frame);
        wrong += u32::from(taken != exact);
        words.push(format!("{taken} steps in {FRAMES} frames {name}"));
    }
    let (reported, taken) = stall();
    wrong += u32::from(reported < Duration::from_millis(9_700) || taken > 15);
    words.push(format!(
        "of a stall of 10 s {taken} steps are taken and {:.2} s reported lost",
        reported.as_secs_f64()
    ));
    let refused = [0.0, -1.0, f64::NAN, f64::INFINITY];
    let refused = refused.map(|dt| FixedStep::new(dt, Duration::from_secs(1)).is_err());
    wrong += refused
        .iter()
        .map(|&is_refused| u32::from(!is_refused))
        .sum::<u32>();
    words.push("dt of 0, -1, NaN and ∞ refused".into());
    Ok(Finding::within(f64::from(wrong), 0.0, words.join("; ")))
}

/// The number of steps at 60 Hz, and the exact number by integer arithmetic.
fn count(frame: &dyn Fn(u32) -> Duration) -> (u64, u64) {
    let dt = 1.0 / 60.0;
    let Ok(mut clock) = FixedStep::new(dt, Duration::from_secs(1)) else {
        return (0, 1);
    };
    let (mut taken, mut total) = (0, 0u128);
    for i in 0..FRAMES {
        let elapsed = frame(i);
        clock.advance(elapsed);
        total += elapsed.as_nanos();
        while clock.take() {
            taken += 1;
        }
    }
    // dt = mantissa / 2^58 s, exactly: 1/60 is between 2^-6 and 2^-5.
    let mantissa = (dt * 2f64.powi(58)) as u128;
    let exact = (total << 58) / (mantissa * 1_000_000_000);
    (taken, exact as u64)
}

/// The time reported as dropped and the steps taken after a frame of 10 s, of which a quarter of a second is allowed.
fn stall() -> (Duration, u32) {
    let Ok(mut clock) = FixedStep::new(1.0 / 60.0, Duration::from_millis(250)) else {
        return (Duration::ZERO, 0);
    };
    let lost = clock.advance(Duration::from_secs(10));
    let mut taken = 0;
    while clock.take() {
        taken += 1;
    }
    (lost, taken)
}
