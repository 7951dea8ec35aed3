//! Scenes of bodies that lie or slide, whose ends are known, and a heap.

use sim_core::DVec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// What is behind a plane, immovable, with its normal.
    Wall(DVec3),
    Ball(f64),
    /// Half of a side.
    Cube(f64),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) form: Form,
    pub(super) position: DVec3,
    pub(super) velocity: DVec3,
}

/// Bodies of 1 kg that keep nothing of the speed at which they meet; walls come first.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    pub(super) items: Vec<Item>,
    pub(super) gravity: DVec3,
    pub(super) friction: f64,
    /// s
    pub(super) duration: f64,
    pub(super) goal: Goal,
}

/// What counts as the error.
#[derive(Clone, Debug)]
pub(super) enum Goal {
    /// How far bodies are from where they should end, over a way, m.
    Places { at: Vec<DVec3>, way: f64 },
    /// How far contacts are closed ahead of their time, or bodies are in each other, m.
    Heap,
}

impl Goal {
    pub(super) fn unit(&self) -> &'static str {
        match self {
            Goal::Places { way: 1.0, .. } | Goal::Heap => "error, m",
            Goal::Places { .. } => "error of the end, of the way",
        }
    }
}

/// Positions and velocities of all items.
#[derive(Clone, Debug)]
pub(super) struct End(pub(super) Vec<(DVec3, DVec3)>);

impl Scene {
    pub(super) fn steps(&self, rate: u32) -> u32 {
        (self.duration * f64::from(rate)).round() as u32
    }

    fn movable(&self) -> impl Iterator<Item = usize> {
        let is_wall = |item: &Item| matches!(item.form, Form::Wall(_));
        let walls = self.items.iter().filter(|item| is_wall(item)).count();
        walls..self.items.len()
    }

    pub(super) fn energy(&self, end: &End) -> f64 {
        let of = |i: usize| {
            let (at, velocity) = end.0[i];
            0.5 * velocity.length_squared() - self.gravity.dot(at)
        };
        self.movable().map(of).sum()
    }

    /// How far the worst body is from its place.
    pub(super) fn farthest(&self, end: &End, places: &[DVec3]) -> f64 {
        let off = self
            .movable()
            .zip(places)
            .map(|(i, &place)| (end.0[i].0 - place).length());
        off.fold(0.0, f64::max)
    }

    /// How deep the worst body is in another one, m.
    pub(super) fn overlap(&self, end: &End) -> f64 {
        let mut deepest: f64 = 0.0;
        for j in self.movable() {
            let at = end.0[j].0;
            for i in 0..j {
                let offset = at - end.0[i].0;
                let depth = match (self.items[i].form, self.items[j].form) {
                    (Form::Wall(normal), Form::Ball(half) | Form::Cube(half)) => {
                        half - normal.dot(at - self.items[i].position)
                    }
                    (Form::Ball(one), Form::Ball(other)) => one + other - offset.length(),
                    (Form::Cube(one), Form::Cube(other)) => {
                        (one + other - offset.abs()).min_element()
                    }
                    (one, other) => unreachable!("{one:?} upon {other:?}"),
                };
                deepest = deepest.max(depth);
            }
        }
        deepest
    }
}

const G: f64 = 9.81;
const HALF: f64 = 0.25;
/// As far above what it lies on as bodies in contact are, m.
const HOVER: f64 = 1e-12;
const FRICTION: f64 = 0.4;

pub(super) fn all() -> Vec<Scene> {
    vec![slide(), landing(), slope(), hold(), stack(), heap()]
}

fn floor() -> Item {
    still(Form::Wall(DVec3::Y), DVec3::ZERO)
}

fn still(form: Form, position: DVec3) -> Item {
    Item {
        form,
        position,
        velocity: DVec3::ZERO,
    }
}

/// A cube on a floor, under gravity that is turned by the angle of a slope, in which x is downhill.
fn on_a_floor(height: f64, speed: f64, slope: (f64, f64), friction: f64, duration: f64) -> Scene {
    let position = (HALF + height) * DVec3::Y;
    Scene {
        name: "",
        title: "",
        about: "",
        items: vec![
            floor(),
            Item {
                velocity: speed * DVec3::X,
                ..still(Form::Cube(HALF), position)
            },
        ],
        gravity: G * DVec3::new(slope.0, -slope.1, 0.0),
        friction,
        duration,
        goal: Goal::Heap,
    }
}

fn ends_at(x: f64, way: f64) -> Goal {
    Goal::Places {
        at: vec![DVec3::new(x, HALF, 0.0)],
        way,
    }
}

const LEVEL: (f64, f64) = (0.0, 1.0);
/// Sine and cosine of a slope of 3 in 4.
const STEEP: (f64, f64) = (0.6, 0.8);

fn slide() -> Scene {
    let way = 9.0 / (2.0 * FRICTION * G);
    Scene {
        name: "slide",
        title: "A block that slides to rest",
        about: "A cube that lies on a floor slides with 3 m/s against friction of 0.4, and stops after v²/(2 mu g) = 1.147 m; its end after 1.5 s.",
        goal: ends_at(way, way),
        ..on_a_floor(HOVER, 3.0, LEVEL, FRICTION, 1.5)
    }
}

fn landing() -> Scene {
    let height = 0.1;
    let falling = (2.0_f64 * height / G).sqrt();
    // The impact takes mu times what it gives upwards.
    let after = 3.0 - FRICTION * G * falling;
    let way = 3.0 * falling + after * after / (2.0 * FRICTION * G);
    Scene {
        name: "landing",
        title: "A block that lands and slides to rest",
        about: "The same, thrown from 0.1 m above the floor: where it lands, friction takes mu times the impulse, and the rest slides to its end.",
        goal: ends_at(way, way),
        ..on_a_floor(height, 3.0, LEVEL, FRICTION, 1.5)
    }
}

fn slope() -> Scene {
    let way = 0.5 * G * (STEEP.0 - 0.5 * STEEP.1) * 4.0;
    Scene {
        name: "slope",
        title: "A block that slides down a slope",
        about: "A cube at rest on a slope of 3 in 4, with friction of 0.5: after 2 s it is at g (sin a - mu cos a) t²/2 = 3.924 m.",
        goal: ends_at(way, way),
        ..on_a_floor(HOVER, 0.0, STEEP, 0.5, 2.0)
    }
}

fn hold() -> Scene {
    Scene {
        name: "hold",
        title: "A block that a slope holds",
        about: "The same with friction of 0.76, where 0.75 is enough: it stays where it is. How far it has crept after 10 s.",
        goal: ends_at(0.0, 1.0),
        ..on_a_floor(HOVER, 0.0, STEEP, 0.76, 10.0)
    }
}

fn stack() -> Scene {
    let place = |level: u32| (HALF + 2.0 * HALF * f64::from(level)) * DVec3::Y;
    let cubes = (0..10).map(|level| {
        let above = 0.01 * f64::from(level + 1);
        still(Form::Cube(HALF), place(level) + above * DVec3::Y)
    });
    Scene {
        name: "stack",
        title: "A stack of ten",
        about: "Ten cubes fall on each other, 1 cm each, and stand. How far the worst of them is from where the one below ends, after 10 s: what has sunk in or crept.",
        items: [floor()].into_iter().chain(cubes).collect(),
        gravity: G * DVec3::NEG_Y,
        friction: FRICTION,
        duration: 10.0,
        goal: Goal::Places {
            at: (0..10).map(place).collect(),
            way: 1.0,
        },
    }
}

fn heap() -> Scene {
    let wall = |normal: DVec3| still(Form::Wall(normal), -0.9 * normal);
    let walls = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(wall);
    let balls = (0..27_u32).map(|i| {
        let cell = [i % 3, i / 9, i / 3 % 3].map(|c| 0.6 * f64::from(c));
        // None is right above another one.
        let shake = [1, 2, 3].map(|k| 0.02 * (f64::from(i * k) * 2.4).sin());
        let at = DVec3::from_array(cell) + DVec3::from_array(shake);
        still(Form::Ball(HALF), at + DVec3::new(-0.6, 0.3, -0.6))
    });
    Scene {
        name: "heap",
        title: "A heap of 27 balls",
        about: "Balls fall into a bin of 1.8 m and come together, in 3 s. The continuous mode solves such heaps at once: its error is how far a contact is closed ahead of its time, and nothing overlaps; Rapier's is how deep balls are in each other.",
        items: [floor()].into_iter().chain(walls).chain(balls).collect(),
        gravity: G * DVec3::NEG_Y,
        friction: FRICTION,
        duration: 3.0,
        goal: Goal::Heap,
    }
}
