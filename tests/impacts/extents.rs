//! Bodies that are long along one axis: the time of an impact along another axis is as exact as for short ones.

use kit::bodies::{ball, immovable, mesh_body};
use kit::meshes::{cube, cuboid};
use kit::random::Random;
use kit::worlds::{precise, world_of};
use sim_core::{DVec3, METHODS, Settings, Vec3, World};

use crate::worlds::{DT, ULP, run};

/// A bullet that flies towards a plate.
#[derive(Debug)]
struct Shot {
    /// Axis of the motion.
    axis: usize,
    /// Half extents of the plate, m.
    half: Vec3,
    /// The distance of the bullet's centre from the plate's, m, and its speed, m/s.
    distance: f64,
    speed: f64,
    /// Acceleration of the bullet along the plate, m/s².
    along: f64,
}

impl Shot {
    /// Along two axes the plate has any size from 1e-30 to 1e30 m.
    fn random(random: &mut Random) -> Shot {
        let axis = (3.0 * random.unit()) as usize;
        let mut half = Vec3::ZERO;
        for k in 0..3 {
            half[k] = 10_f64.powf(60.0 * random.unit() - 30.0) as f32;
        }
        half[axis] = 10_f64.powf(3.0 * random.unit() - 4.0) as f32;
        Shot {
            axis,
            half,
            distance: 2.0 + 8.0 * random.unit(),
            speed: 10_f64.powf(4.0 * random.unit()),
            along: 0.0,
        }
    }

    fn world(&self, settings: Settings) -> World {
        let unit = DVec3::AXES[self.axis];
        let plate = mesh_body(&cuboid(self.half), self.distance * unit, DVec3::ZERO);
        let mut bullet = mesh_body(&cube(0.5), DVec3::ZERO, self.speed * unit);
        bullet.force = self.along * DVec3::AXES[(self.axis + 1) % 3];
        world_of(settings, &[bullet, immovable(plate)])
    }

    /// The delay of the first impact, s, and the delay allowed.
    fn error(&self, world: &mut World) -> (f64, f64) {
        let gap = self.distance - 0.5 - f64::from(self.half[self.axis]);
        let exact = gap / self.speed;
        let steps = (exact / world.settings().dt) as u64 + 2;
        let impacts = run(world, steps);
        let time = impacts.first().map_or(f64::INFINITY, |impact| impact.time);
        // Some units in the last place of the time, and of a step.
        (time - exact, 64.0 * ULP * (exact + DT))
    }
}

#[test]
fn a_plate_that_is_long_another_way_is_hit_in_time() {
    let mut random = Random::linear(16);
    let mut wrong = Vec::new();
    for _ in 0..400 {
        let shot = Shot::random(&mut random);
        let (error, most) = shot.error(&mut shot.world(precise(DT)));
        if error.is_nan() || error.abs() > most {
            wrong.push(format!("{error:e} s, more than {most:e}: {shot:?}"));
        }
    }
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
}

/// On a trajectory that curves along the plate; the search follows it in chords.
#[test]
fn a_plate_is_hit_in_time_on_a_way_that_bends() {
    let mut random = Random::linear(3);
    let mut wrong = Vec::new();
    for method in METHODS.into_iter().filter(|method| method.order > 1) {
        for _ in 0..20 {
            let mut shot = Shot::random(&mut random);
            shot.along = 9.81;
            let side = (shot.axis + 1) % 3;
            // So long that the bullet does not fall past it.
            shot.half[side] = 1e3;
            let other = (shot.axis + 2) % 3;
            shot.half[other] = shot.half[other].clamp(1e-9, 1e9);
            let settings = Settings {
                method,
                ..precise(DT)
            };
            let (error, most) = shot.error(&mut shot.world(settings));
            if error.is_nan() || error.abs() > most {
                wrong.push(format!("{}: {error:e} s, {most:e}: {shot:?}", method.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
}

/// Between two plates, one of them long, as between two short ones.
#[test]
fn a_bullet_goes_to_and_fro_between_plates_of_any_length() {
    for length in [3.0, 1e9, 1e15, 1e17, 1e30] {
        let plate = |x: f64, length: f64| {
            let half = Vec3::new(0.0005, 1.5, 0.5 * length as f32);
            immovable(mesh_body(&cuboid(half), x * DVec3::X, DVec3::ZERO))
        };
        let bullet = mesh_body(&cube(0.25), DVec3::ZERO, 1000.0 * DVec3::X);
        let bodies = [plate(-5.0, length), plate(5.0, 3.0), bullet];
        let mut world = world_of(precise(DT), &bodies);
        let impacts = run(&mut world, 60);
        // 9.499 m back and forth in a second.
        assert_eq!(impacts.len(), 105, "{length:e}");
        let last = impacts.last().expect("impacts");
        let room = 9.5 - 2.0 * f64::from(0.0005_f32);
        let exact = (0.5 * room + 104.0 * room) / 1000.0;
        let error = last.time - exact;
        assert!(error.abs() < 1e-12, "{length:e}: {error:e} s");
    }
}

/// Two balls, one of them as large as a planet, meet at the exact time.
#[test]
fn a_small_ball_hits_a_large_one_in_time() {
    for radius in [1.0, 1e3, 1e6, 1e9] {
        let large = immovable(ball(radius, (radius + 2.0) * DVec3::X, DVec3::ZERO));
        let small = ball(0.5, DVec3::ZERO, 100.0 * DVec3::X);
        let mut world = world_of(precise(DT), &[large, small]);
        let impacts = run(&mut world, 2);
        let error = impacts[0].time - 0.015;
        assert!(
            error.abs() <= 64.0 * ULP * radius / 100.0,
            "{radius}: {error:e}"
        );
    }
}
