//! An external method and two external forces, as a user of the library writes them: in a file of their own, without
//! changes to sim-core.

use sim_core::{
    Body, BodyLaw, BodyMotion, DVec3, Failure, Force, Law, Method, PairLaw, PairMotion, Settings,
    Step, Stepper, System, World,
};

/// Heun's method: the mean of the slopes at both ends of a forward Euler step.
static HEUN: Method = Method {
    name: "heun",
    title: "Heun",
    order: 2,
    stability: "unstable at every step without damping, but slowly",
    source: "Heun 1900",
    symplectic: false,
    reversible: false,
    adaptive: false,
    fall: None,
    step: heun,
};

fn heun(system: &dyn System, s: Step<'_>) -> Result<(), Failure> {
    let [start, end] = s.scratch.columns(s.position.len());
    system.accelerations(s.time, s.position, s.velocity, start);
    for (i, a) in start.iter().enumerate() {
        s.new_position[i] = s.position[i] + s.dt * s.velocity[i];
        s.new_velocity[i] = s.velocity[i] + s.dt * *a;
    }
    system.accelerations(s.time + s.dt, s.new_position, s.new_velocity, end);
    for (i, (a, b)) in start.iter().zip(end.iter()).enumerate() {
        let mean = 0.5 * (s.velocity[i] + s.new_velocity[i]);
        s.new_position[i] = s.position[i] + s.dt * mean;
        s.new_velocity[i] = s.velocity[i] + 0.5 * s.dt * (*a + *b);
    }
    Ok(())
}

/// A magnetic field along z on a charge of 1: `F = b v × z`.
#[derive(Debug)]
struct Magnet(f64);

impl BodyLaw for Magnet {
    fn force(&self, at: &BodyMotion) -> DVec3 {
        self.0 * at.velocity.cross(DVec3::Z)
    }
}

/// A thread between two bodies that pulls if it is longer than a metre.
#[derive(Debug)]
struct Thread(f64);

impl PairLaw for Thread {
    fn force(&self, at: &PairMotion) -> DVec3 {
        let length = at.position.length();
        self.0 * (length - 1.0).max(0.0) / length * at.position
    }
}

fn world(method: &'static Method, dt: f64, force: Force) -> World {
    let settings = Settings {
        dt,
        method,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    for x in [1.0, 3.0] {
        world
            .add(Body {
                position: x * DVec3::X,
                velocity: DVec3::Y,
                force: 0.1 * DVec3::X,
                ..Body::default()
            })
            .expect("a body");
    }
    world.add_force(force).expect("a force");
    world
}

#[test]
fn a_method_of_ones_own_runs_in_a_world_with_its_order() {
    let end = |method, steps: u32| {
        let force = Force::Body {
            body: Some(0),
            law: Law::new(Magnet(2.0)),
        };
        let mut world = world(method, 1.0 / f64::from(steps), force);
        for _ in 0..steps {
            world.step().expect("a step");
        }
        world.position(0)
    };
    let exact = end(Method::named("dop853").expect("a method"), 1);
    let error = |steps| (end(&HEUN, steps) - exact).length();
    let order = (error(256) / error(512)).log2();
    assert!((order - 2.0).abs() < 0.05, "{order}");
    // Body 1 is free: a parabola, for which Heun's method is exact.
    let force = Force::Body {
        body: Some(0),
        law: Law::new(Magnet(2.0)),
    };
    let mut world = world(&HEUN, 0.1, force);
    for _ in 0..10 {
        world.step().expect("a step");
    }
    assert!((world.position(1) - DVec3::new(3.05, 1.0, 0.0)).length() < 1e-14);
}

#[test]
fn a_law_of_ones_own_works_with_implicit_methods_without_jacobians() {
    let force = Force::Pair {
        bodies: Some([0, 1]),
        law: Law::of_pair(Thread(1e4)),
    };
    let mut world = world(
        Method::named("backward-euler").expect("a method"),
        1.0 / 60.0,
        force,
    );
    for _ in 0..600 {
        world.step().expect("a step");
    }
    let length = (world.position(1) - world.position(0)).length();
    assert!(length < 1.01, "{length}");
    assert!((world.momentum().y - 2.0).abs() < 1e-9);
}

#[test]
fn a_stepper_and_the_stability_limit_take_any_method() {
    struct Damped;
    impl System for Damped {
        fn len(&self) -> usize {
            1
        }
        fn accelerations(&self, _: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
            a[0] = -x[0] - 0.5 * v[0];
        }
    }
    let mut stepper = Stepper::new(&HEUN, &[DVec3::X], &[DVec3::ZERO]);
    for _ in 0..4000 {
        stepper.step(&Damped, 0.01).expect("a step");
    }
    assert!(stepper.position()[0].length() < 1e-4);
    // Heun's polynomial 1 + z + z²/2 leaves the unit circle at z = -2 on the real axis.
    assert!((HEUN.stable_dt(0.0, 5.0) - 0.4).abs() < 1e-6);
    assert_eq!(HEUN.stable_dt(1.0, 0.0), 0.0);
}
