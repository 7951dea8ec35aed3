//! Scenes of resting or sliding bodies with known final states, and a heap.

use sim_core::DVec3;

use super::{Family, Form, GRAVITY, Goal, HALF, Item, Known, Scene, Who};

/// The initial gap below a body, equal to that of bodies in contact, m.
const HOVER: f64 = 1e-12;
const FRICTION: f64 = 0.4;

/// Scenes that test friction and contacts in the continuous mode; restitution is 0.
pub static RESTING: [Family; 6] = [
    Family {
        name: "slide",
        title: "A block that slides to rest",
        about: "A cube that lies on a floor slides with 3 m/s against friction of 0.4, and stops after v²/(2 mu g) = 1.147 m; its end after 1.5 s.",
        speeds: &[0.0],
        make: |_| slide(),
        tolerance: 1e-11,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "landing",
        title: "A block that lands and slides to rest",
        about: "The same, thrown from 0.1 m above the floor: where it lands, friction takes mu times the impulse, and the rest slides to its end.",
        speeds: &[0.0],
        make: |_| landing(),
        tolerance: 1e-11,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "slope",
        title: "A block that slides down a slope",
        about: "A cube at rest on a slope of 3 in 4, with friction of 0.5: after 2 s it is at g (sin a - mu cos a) t²/2 = 3.924 m.",
        speeds: &[0.0],
        make: |_| slope(),
        tolerance: 1e-11,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "hold",
        title: "A block that a slope holds",
        about: "The same with friction of 0.76, where 0.75 is enough: it stays where it is. How far it has crept after 10 s.",
        speeds: &[0.0],
        make: |_| hold(),
        tolerance: 1e-11,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "stack",
        title: "A stack of ten",
        about: "Ten cubes fall on each other, 1 cm each, and stand. How far the worst of them is from where the one below ends, after 10 s: what has sunk in or crept.",
        speeds: &[0.0],
        make: |_| stack(),
        tolerance: 1e-11,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "heap",
        title: "A heap of 27 balls",
        about: "Balls fall into a bin of 1.8 m and come together, in 3 s. The continuous mode solves such heaps at once: its error is how far a contact is closed ahead of its time, and nothing overlaps; Rapier's is how deep balls are in each other.",
        speeds: &[0.0],
        make: |_| heap(),
        tolerance: 1e-11,
        passed_by: &[Who::Continuous],
    },
];

fn floor() -> Item {
    Item::resting(Form::Wall(DVec3::Y), DVec3::ZERO)
}

fn known(items: Vec<Item>, friction: f64, duration: f64, goal: Goal) -> Known {
    Known {
        scene: Scene {
            restitution: 0.0,
            friction,
            may_sleep: true,
            ..Scene::falling(items)
        },
        duration,
        impact: None,
        goal,
    }
}

/// A cube on a floor that stops at a position along x.
fn on_a_floor(
    height: f64,
    speed: f64,
    friction: f64,
    duration: f64,
    (x, way): (f64, f64),
) -> Known {
    let cube = Item {
        velocity: speed * DVec3::X,
        ..Item::resting(Form::Cube(HALF), (HALF + height) * DVec3::Y)
    };
    let goal = Goal::Places {
        at: vec![DVec3::new(x, HALF, 0.0)],
        way,
    };
    known(vec![floor(), cube], friction, duration, goal)
}

/// Sine and cosine of a slope of 3 in 4.
const STEEP: (f64, f64) = (0.6, 0.8);

/// A cube initially at rest on a slope: gravity is rotated by its angle, and x points downhill.
fn on_a_slope(friction: f64, duration: f64, end: (f64, f64)) -> Known {
    let mut known = on_a_floor(HOVER, 0.0, friction, duration, end);
    known.scene.gravity = GRAVITY * DVec3::new(STEEP.0, -STEEP.1, 0.0);
    known
}

/// The sliding distance on a floor, m.
pub fn sliding_way(speed: f64, friction: f64) -> f64 {
    speed * speed / (2.0 * friction * GRAVITY)
}

/// The distance that a body slides after it lands on a floor from a height: the impact reduces the horizontal momentum
/// by mu times its vertical impulse.
pub fn landing_way(height: f64, speed: f64, friction: f64) -> f64 {
    let falling = (2.0 * height / GRAVITY).sqrt();
    let left = speed - friction * GRAVITY * falling;
    speed * falling + sliding_way(left, friction)
}

fn slide() -> Known {
    let way = sliding_way(3.0, FRICTION);
    on_a_floor(HOVER, 3.0, FRICTION, 1.5, (way, way))
}

fn landing() -> Known {
    let height = 0.1;
    let way = landing_way(height, 3.0, FRICTION);
    on_a_floor(height, 3.0, FRICTION, 1.5, (way, way))
}

fn slope() -> Known {
    let way = 0.5 * GRAVITY * (STEEP.0 - 0.5 * STEEP.1) * 4.0;
    on_a_slope(0.5, 2.0, (way, way))
}

fn hold() -> Known {
    on_a_slope(0.76, 10.0, (0.0, 1.0))
}

fn stack() -> Known {
    let place = |level: u32| (HALF + 2.0 * HALF * f64::from(level)) * DVec3::Y;
    let cubes = (0..10).map(|level| {
        let above = 0.01 * f64::from(level + 1);
        Item::resting(Form::Cube(HALF), place(level) + above * DVec3::Y)
    });
    let items = [floor()].into_iter().chain(cubes).collect();
    let at = (0..10).map(place).collect();
    known(items, FRICTION, 10.0, Goal::Places { at, way: 1.0 })
}

fn heap() -> Known {
    let wall = |normal: DVec3| Item::resting(Form::Wall(normal), -0.9 * normal);
    let walls = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(wall);
    let balls = (0..27_u32).map(|i| {
        let cell = [i % 3, i / 9, i / 3 % 3].map(|c| 0.6 * f64::from(c));
        // No body is exactly above another one.
        let shake = [1, 2, 3].map(|k| 0.02 * (f64::from(i * k) * 2.4).sin());
        let at = DVec3::from_array(cell) + DVec3::from_array(shake);
        Item::resting(Form::Ball(HALF), at + DVec3::new(-0.6, 0.3, -0.6))
    });
    let items = [floor()].into_iter().chain(walls).chain(balls).collect();
    known(items, FRICTION, 3.0, Goal::Heap)
}
