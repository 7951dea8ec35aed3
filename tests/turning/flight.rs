//! Free flight and flight under a constant torque, against numbers from closed forms, with 17 digits each.

use kit::elliptic::Racket;
use kit::{bodies, random::Random, shapes, worlds};
use sim_core::rotation::{Flight, FlightError, spin};
use sim_core::{DQuat, DVec3, Turn};

/// The rotation and the angular velocity in the body frame after a time, in one flight.
fn flown(moments: DVec3, start: DVec3, t: f64) -> (DQuat, DVec3) {
    let flight =
        Flight::new(moments, DQuat::IDENTITY, moments * start, DVec3::ZERO, t).expect("a flight");
    let pose = flight.at(t);
    assert_eq!(pose.momentum, moments * start);
    assert!((pose.rotation.length() - 1.0).abs() < 4e-16);
    (pose.rotation, pose.rotation.inverse() * pose.spin)
}

/// The distance of two rotations, each of which has two quaternions.
fn apart(a: DQuat, [w, x, y, z]: [f64; 4]) -> f64 {
    let b = DQuat::from_xyzw(x, y, z, w);
    (a - b).length().min((a + b).length())
}

#[test]
fn a_cube_turns_evenly() {
    let start = DVec3::new(0.3, -1.7, 0.9);
    let moments = DVec3::splat(1.0 / 6.0);
    let (rotation, _) = flown(moments, start, 10.0);
    let exact = [
        -0.952_582_422_186_293_8,
        -0.046_889_545_179_754_374,
        0.265_707_422_685_274_8,
        -0.140_668_635_539_263_12,
    ];
    assert!(apart(rotation, exact) < 1e-15, "{}", apart(rotation, exact));
    // In steps, the angular momentum and thus the spin stay constant bit for bit.
    let momentum = moments * start;
    let mut rotation = DQuat::IDENTITY;
    for _ in 0..600 {
        let flight =
            Flight::new(moments, rotation, momentum, DVec3::ZERO, 1.0 / 60.0).expect("a flight");
        let pose = flight.at(1.0 / 60.0);
        assert_eq!(pose.momentum, momentum);
        rotation = pose.rotation;
    }
    assert!(apart(rotation, exact) < 1e-14);
}

#[test]
fn two_equal_moments_precess() {
    let moments = DVec3::new(2.0, 2.0, 1.0);
    let start = DVec3::new(0.3, 0.0, 5.0);
    let exact = [
        0.999_061_925_816_623_1,
        0.002_770_635_725_467_47,
        0.000_184_159_285_515_399_96,
        -0.043_215_252_476_580_513,
    ];
    // About each of the axes, and by the series, which has no special case for it.
    let (rotation, _) = flown(moments, start, 10.0);
    assert!(apart(rotation, exact) < 2e-14);
    let cycle = |v: DVec3| DVec3::new(v.z, v.x, v.y);
    let (rotation, _) = flown(cycle(moments), cycle(start), 10.0);
    let [w, x, y, z] = exact;
    assert!(apart(rotation, [w, z, x, y]) < 2e-14);
    let nearly = moments * DVec3::new(1.0 + f64::EPSILON, 1.0, 1.0);
    let (rotation, _) = flown(nearly, start, 10.0);
    assert!(apart(rotation, exact) < 1e-13, "{}", apart(rotation, exact));
}

#[test]
fn a_plate_wobbles_twice_as_fast_as_it_turns() {
    // Its axis is 5 degrees from the angular momentum, and precesses about it at 2 ω₃ / cos 5°.
    let moments = DVec3::new(1.0, 1.0, 2.0);
    let tilt = 5_f64.to_radians();
    let start = DVec3::new(2.0 * 10.0 * tilt.tan(), 0.0, 10.0);
    let rate = 20.076_396_750_866_948;
    let period = std::f64::consts::TAU / rate;
    for turns in [1.0, 7.0] {
        let (rotation, _) = flown(moments, start, turns * period);
        let axis = rotation * DVec3::Z;
        assert!((axis - DVec3::Z).length() < 1e-14 * turns, "{axis}");
    }
    let (rotation, _) = flown(moments, start, 0.5 * period);
    assert!(((rotation * DVec3::Z).angle_between(DVec3::Z) - 2.0 * tilt).abs() < 1e-14);
}

const RACKET: DVec3 = DVec3::new(1.0, 2.0, 3.0);

#[test]
fn a_racket_turns_over() {
    let (rotation, own) = flown(RACKET, DVec3::new(0.0, 1.0, 0.01), 5.0);
    let exact = DVec3::new(
        -0.153_937_569_508_545_7,
        0.988_080_576_012_807_6,
        0.089_436_710_036_014_36,
    );
    // The initial rounding error grows as exp(p t), p = 0.577.
    assert!((own.abs() - exact.abs()).length() < 2e-14, "{own}");
    let turned = [
        -0.799_050_815_645_447_5,
        0.024_817_870_785_836_612,
        0.595_969_199_966_331_9,
        0.075_647_736_235_084_63,
    ];
    assert!(
        apart(rotation, turned) < 2e-14,
        "{rotation} {}",
        apart(rotation, turned)
    );
    let (_, own) = flown(RACKET, DVec3::new(0.0, 1.0, 0.01), 10.0);
    let exact = DVec3::new(
        -0.947_392_709_739_121_3,
        -0.320_073_512_701_637,
        0.547_068_839_808_067_5,
    );
    assert!((own - exact).length() < 1e-12, "{own}");
}

#[test]
fn a_racket_turns_over_when_the_elliptic_integral_says() {
    let known = [
        (0.1, 10.821_061_172_271_293, 1e-12),
        (0.01, 18.851_035_793_687_3, 1e-12),
        (0.001, 26.828_560_929_188_666, 1e-11),
        (1e-6, 50.757_744_671_380_36, 1e-8),
    ];
    for (small, flip, bar) in known {
        let racket = Racket::new(RACKET, 1.0, small);
        assert!(
            (racket.flip() / flip - 1.0).abs() < 4e-15,
            "{small}: {}",
            racket.flip()
        );
        // The component about the intermediate axis is 0 in the middle of a flip.
        let start = DVec3::new(0.0, 1.0, small);
        let (_, half) = flown(RACKET, start, 0.5 * flip);
        let slope = racket.at(0.5 * flip + 1e-3).y - racket.at(0.5 * flip - 1e-3).y;
        let late = half.y / (slope / 2e-3);
        assert!(late.abs() < bar * flip, "{small}: {late:e}");
    }
}

#[test]
fn flight_is_that_of_elliptic_functions() {
    let mut random = Random::splitmix(7);
    for case in 0..200 {
        let mut moments = [0.0; 3].map(|_: f64| random.from(0.4, 1.0)).map(f64::abs);
        moments.sort_by(f64::total_cmp);
        let moments = DVec3::from_array(moments);
        let (b, c) = (random.from(0.1, 9.0), random.from(0.1, 9.0));
        let racket = Racket::new(moments, b, c);
        let t = random.from(0.0, 3.0);
        let (_, own) = flown(moments, DVec3::new(0.0, b, c), t);
        let exact = racket.at(t);
        let off = DVec3::new(
            own.x.abs() - exact.x.abs(),
            own.y - exact.y,
            own.z - exact.z,
        );
        assert!(
            off.length() < 2e-12 * (b + c),
            "{case}: {moments} {b} {c} {t}: {off}"
        );
    }
}

#[test]
fn after_a_period_the_spin_is_back_and_the_body_has_turned_about_its_momentum() {
    let start = DVec3::new(0.0, 1.0, 0.01);
    let period = 37.702_071_587_374_6;
    let (rotation, own) = flown(RACKET, start, period);
    assert!((own - start).length() < 1e-11, "{own}");
    let angle = -2.088_477_928_083_870_4;
    let axis = (RACKET * start).normalize() * (0.5_f64 * angle).sin();
    let exact = [(0.5_f64 * angle).cos(), axis.x, axis.y, axis.z];
    assert!(apart(rotation, exact) < 1e-11, "{}", apart(rotation, exact));
}

#[test]
fn the_separatrix_is_followed() {
    let p = 1.0 / 3_f64.sqrt();
    for t in [1.0_f64, 5.0] {
        let (rotation, own) = flown(RACKET, DVec3::new(1.0, 0.0, p), t);
        let sech = 1.0 / (p * t).cosh();
        let exact = DVec3::new(sech, (p * t).tanh(), sech * p);
        // The rounding error of 1/√3 at the start grows as exp(p t), and so do those of the path.
        assert!((own - exact).length() < 4e-14, "{t}: {}", own - exact);
        if t == 5.0 {
            let turned = [
                -0.597_152_616_128_104_8,
                -0.239_482_390_378_068_5,
                0.398_968_549_109_240_96,
                0.653_361_335_381_757_9,
            ];
            assert!(
                apart(rotation, turned) < 4e-14,
                "{}",
                apart(rotation, turned)
            );
        }
    }
}

#[test]
fn a_million_steps_keep_energy_and_momentum() {
    let dt = 1.0 / 60.0;
    for start in [DVec3::new(0.0, 1.0, 0.01), DVec3::new(3.0, 4.0, 5.0)] {
        let momentum = RACKET * start;
        let energy = |rotation: DQuat| 0.5 * momentum.dot(spin(RACKET, rotation, momentum));
        let mut rotation = DQuat::IDENTITY;
        let first = energy(rotation);
        let mut worst: f64 = 0.0;
        for _ in 0..1_000_000 {
            let flight =
                Flight::new(RACKET, rotation, momentum, DVec3::ZERO, dt).expect("a flight");
            let pose = flight.at(dt);
            assert_eq!(pose.momentum, momentum);
            rotation = pose.rotation;
            worst = worst.max((energy(rotation) / first - 1.0).abs());
        }
        println!("{start}: {worst:e}");
        assert!(worst < 1e-13, "{start}: {worst:e}");
    }
}

fn random_start(random: &mut Random) -> (DVec3, DQuat, DVec3) {
    // Valid moments of a body, as sums of squares.
    let spread = DVec3::new(
        random.from(0.01, 1.0),
        random.from(0.01, 1.0),
        random.from(0.01, 1.0),
    );
    let moments = DVec3::splat(spread.element_sum()) - spread;
    let turn = DQuat::from_scaled_axis(3.0 * random.vector());
    (moments, turn, moments * random.vector() * 10.0)
}

#[test]
fn frames_time_and_scale_are_no_matter() {
    let mut random = Random::splitmix(3);
    for case in 0..300 {
        let (moments, rotation, momentum) = random_start(&mut random);
        let torque = if case % 2 == 0 {
            DVec3::ZERO
        } else {
            5.0 * random.vector()
        };
        let t = random.from(0.01, 1.0);
        let end = Flight::new(moments, rotation, momentum, torque, t)
            .expect("a flight")
            .at(t);
        // The whole flight is rotated.
        let turn = DQuat::from_scaled_axis(3.0 * random.vector());
        let turned = Flight::new(moments, turn * rotation, turn * momentum, turn * torque, t)
            .expect("a flight")
            .at(t);
        assert!(
            (turned.rotation - turn * end.rotation).length() < 2e-13,
            "{case}"
        );
        assert!((turned.spin - turn * end.spin).length() < 1e-12, "{case}");
        // Backwards in time, in both ways.
        let back = Flight::new(moments, end.rotation, end.momentum, torque, -t)
            .expect("a flight")
            .at(-t);
        assert!((back.rotation - rotation).length() < 2e-13, "{case}");
        let back = Flight::new(moments, end.rotation, -end.momentum, torque, t)
            .expect("a flight")
            .at(t);
        assert!((back.rotation - rotation).length() < 2e-13, "{case}");
        // Lengths scaled by 2^k, times by 2^j: equal bit for bit.
        for (k, j) in [(40, 0), (-30, 0), (0, 12), (7, -10)] {
            let (size, pace) = (2_f64.powi(2 * k), 2_f64.powi(j));
            let flight = Flight::new(
                size * moments,
                rotation,
                size / pace * momentum,
                size / (pace * pace) * torque,
                pace * t,
            )
            .expect("a flight");
            let scaled = flight.at(pace * t);
            // √a scales as a rate only if powers are even.
            if j % 2 == 0 {
                assert_eq!(scaled.rotation, end.rotation, "{case}: {k} {j}");
                assert_eq!(scaled.spin * pace, end.spin, "{case}: {k} {j}");
            }
        }
    }
}

#[test]
fn a_flight_is_the_same_in_one_step_in_many_and_within() {
    let mut random = Random::splitmix(5);
    for case in 0..100 {
        let (moments, rotation, momentum) = random_start(&mut random);
        let torque = [DVec3::ZERO, 20.0 * random.vector()][case % 2];
        let whole = Flight::new(moments, rotation, momentum, torque, 1.0).expect("a flight");
        let (mut turned, mut now) = (rotation, momentum);
        for step in 0..64 {
            let t = f64::from(step) / 64.0;
            let within = whole.at(t);
            let off = (within.rotation - turned).length();
            assert!(off < 1e-13, "{case}: {step} {off:e}");
            let flight = Flight::new(moments, turned, now, torque, 1.0 / 64.0).expect("a flight");
            let pose = flight.at(1.0 / 64.0);
            (turned, now) = (pose.rotation, pose.momentum);
        }
        // Under a torque the change of energy is its work, summed by Simpson's rule.
        let energy = |t: f64| 0.5 * whole.at(t).momentum.dot(whole.at(t).spin);
        let power = |t: f64| torque.dot(whole.at(t).spin);
        let steps = 4000;
        let at = |i: i32| f64::from(i) / f64::from(2 * steps);
        let work: f64 = (0..steps)
            .map(|i| power(at(2 * i)) + 4.0 * power(at(2 * i + 1)) + power(at(2 * i + 2)))
            .sum::<f64>()
            / f64::from(6 * steps);
        assert!(
            (energy(1.0) - energy(0.0) - work).abs() < 1e-11 * (1.0 + energy(1.0)),
            "{case}"
        );
    }
}

#[test]
fn a_hundred_turns_in_a_step_are_a_hundred_turns() {
    let turns = 2.0 * std::f64::consts::PI * 100.25;
    let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    for moments in [
        DVec3::ONE,
        DVec3::new(1.0, 1.0, 0.5),
        DVec3::new(1.0, 0.6, 1.3),
    ] {
        let (rotation, _) = flown(moments, turns * DVec3::Z, 1.0);
        assert!(apart(rotation, [quarter.w, quarter.x, quarter.y, quarter.z]) < 2e-13);
    }
    // For a tumbling body, compared with steps that are ten thousand times shorter.
    let moments = DVec3::new(0.4, 0.7, 0.9);
    let start = DVec3::new(200.0, 500.0, -300.0);
    let (rotation, _) = flown(moments, start, 1.0);
    let mut turned = DQuat::IDENTITY;
    for _ in 0..10_000 {
        let flight =
            Flight::new(moments, turned, moments * start, DVec3::ZERO, 1e-4).expect("a flight");
        turned = flight.at(1e-4).rotation;
    }
    let off = (rotation - turned)
        .length()
        .min((rotation + turned).length());
    assert!(off < 1e-10, "{off:e}");
}

#[test]
fn derivatives_stay_within_their_bounds() {
    let mut random = Random::splitmix(11);
    for case in 0..500 {
        let (mut moments, rotation, momentum) = random_start(&mut random);
        match case % 5 {
            1 => moments = DVec3::splat(moments.x),
            2 => moments.y = moments.x,
            // A plate and a needle are the limits of valid moments.
            3 => moments.z = moments.x + moments.y,
            4 => moments = DVec3::new(1e-6, 1.0, 1.0 + 1e-6 * random.unit()),
            _ => (),
        }
        let pull = 3.0 * moments.min_element() * random.vector();
        let torque = [DVec3::ZERO, pull][case / 5 % 2];
        let slow = rotation * (moments * random.vector());
        let momentum = if case % 5 == 4 { slow } else { momentum };
        let t = 0.3;
        let flight = Flight::new(moments, rotation, momentum, torque, t).expect("a flight");
        let bounds = flight.bounds(&flight.at(0.0), t);
        let h = 1e-4 * t;
        // The effect of the rounding of a rotation on the spin, divided by the time between two of them.
        let noise = 1e-15 * momentum.length() / moments.min_element() / h;
        for i in 0..50 {
            let now = t * (0.01 + 0.98 * f64::from(i) / 50.0);
            let pose = flight.at(now);
            assert!(pose.spin.length() <= bounds.spin, "{case}");
            let arm = random.direction();
            let second = |pose: sim_core::rotation::Pose| {
                pose.acceleration.cross(pose.rotation * arm)
                    + pose.spin.cross(pose.spin.cross(pose.rotation * arm))
            };
            assert!(second(pose).length() <= bounds.second, "{case}");
            let third = (second(flight.at(now + h)) - second(flight.at(now - h))) / (2.0 * h);
            assert!(
                third.length() <= bounds.third * (1.0 + 1e-4) + noise * (1.0 + bounds.spin),
                "{case}: {third}"
            );
            // The reported spin is the derivative of the rotation.
            let slope = (flight.at(now + h).spin - flight.at(now - h).spin) / (2.0 * h);
            let off = (slope - pose.acceleration).length();
            assert!(off <= 1e-2 * h * bounds.third + noise, "{case}: {off}");
        }
    }
}

/// The flight of a rapidly tumbling body is computed in parts of forty radians, which changes neither its state at the
/// end of a step nor its impacts. Beyond ten thousand radians a step is refused.
#[test]
fn a_body_that_tumbles_fast_may_have_many_impacts_in_a_step() {
    let half = DVec3::new(0.1, 0.2, 0.3);
    let mut body = bodies::at(&shapes::cuboid(half.as_vec3().to_array()), DVec3::ZERO);
    body.velocity = 100.0 * DVec3::X;
    let spin = 5e4 * DVec3::new(0.3, 1.0, 0.2);
    body.turn = Some(Turn {
        spin,
        ..Turn::default()
    });
    let wall = |normal: DVec3| bodies::wall(normal, -0.4 * normal, DVec3::ZERO);
    let mut world = worlds::world([wall(DVec3::X), wall(-DVec3::X), body]);
    let energy = world.kinetic_energy();
    for _ in 0..3 {
        worlds::step(&mut world, 1);
        assert_eq!(world.meeting(), []);
    }
    let count = world.impacts();
    assert!(count > 50, "{count}");
    let off = world.kinetic_energy() / energy - 1.0;
    assert!(off.abs() < 1e-12, "{off:e}");

    let mut free = bodies::at(&shapes::cuboid(half.as_vec3().to_array()), DVec3::ZERO);
    free.turn = Some(Turn {
        spin,
        ..Turn::default()
    });
    let mut world = worlds::world([free.clone()]);
    let (inertia, dt) = (*world.inertia(0).unwrap(), world.settings().dt);
    let momentum = world.angular_momentum(0);
    let whole = Flight::new(inertia.moments(), inertia.axes(), momentum, DVec3::ZERO, dt);
    worlds::step(&mut world, 1);
    let expected = whole.unwrap().rotation_at(dt) * inertia.axes().inverse();
    let off = (world.rotation(0).inverse() * expected).xyz().length();
    assert!(
        off < 1e-9,
        "after {:.0} rad off by {off:e}",
        spin.length() * dt
    );

    free.turn.as_mut().unwrap().spin *= 1e4;
    let mut world = worlds::world([free]);
    let error = world.step().unwrap_err().to_string();
    assert!(error.contains("tumbles more than"), "{error}");
}

#[test]
fn what_cannot_be_followed_is_an_error() {
    let new = |momentum: DVec3, torque: DVec3, duration: f64| {
        Flight::new(RACKET, DQuat::IDENTITY, momentum, torque, duration).map(|_| ())
    };
    let tumbles = DVec3::new(1.0, 2.0, 3.5);
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(
            new(bad * DVec3::X, DVec3::ZERO, 1.0),
            Err(FlightError::NotFinite)
        );
        assert_eq!(
            new(tumbles, bad * DVec3::X, 1.0),
            Err(FlightError::NotFinite)
        );
        assert_eq!(new(tumbles, DVec3::ZERO, bad), Err(FlightError::NotFinite));
    }
    let (duration, torque) = (1e9, 1e9 * DVec3::Y);
    assert_eq!(
        new(tumbles, DVec3::ZERO, duration),
        Err(FlightError::TooFar { duration })
    );
    assert_eq!(
        new(tumbles, torque, duration),
        Err(FlightError::TooFar { duration })
    );
    // About a principal axis it may rotate any number of times.
    assert_eq!(new(tumbles.x * DVec3::X, DVec3::ZERO, duration), Ok(()));
    assert!(new(1e-300 * tumbles, 1e-300 * torque, 1.0).is_ok());
}

#[test]
fn a_flight_is_the_same_at_every_speed() {
    let moments = DVec3::new(1.0, 2.0, 2.5);
    let start = DVec3::new(0.1, 1.5, -0.4);
    let torque = DVec3::new(0.2, 0.1, -0.3);
    for by in [1e-60_f64, 1e-30, 1e12, 1e40, 1e70].map(|by| by.log2().round().exp2()) {
        for torque in [DVec3::ZERO, torque] {
            let flight = |by: f64| {
                let (momentum, torque) = (moments * start * by, torque * by * by);
                Flight::new(moments, DQuat::IDENTITY, momentum, torque, 10.0 / by)
                    .expect("a flight")
            };
            // By a power of two, which changes no digit.
            let (slow, fast) = (flight(1.0), flight(by));
            for t in [0.1, 5.0, 10.0] {
                assert_eq!(slow.rotation_at(t), fast.rotation_at(t / by), "{by} {t}");
            }
        }
    }
}
