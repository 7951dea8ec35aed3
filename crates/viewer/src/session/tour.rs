//! The four labs: the order of their scenes, and a guided tour through them.

use sim_core::{Collision, DVec3, Method};

use super::Session;

/// A part of the course.
pub struct Lab {
    /// Its subject.
    pub title: &'static str,
    /// The gallery scenes of the lab, in the order of a first visit.
    pub scenes: &'static [&'static str],
    /// What to observe.
    pub stops: &'static [Stop],
}

/// A stop of the tour: something to observe in a scene.
pub struct Stop {
    /// Its title.
    pub title: &'static str,
    /// The scene of the gallery.
    pub scene: &'static str,
    /// What to watch.
    pub watch: &'static str,
    /// What to try.
    pub attempts: &'static [Attempt],
    /// A question that observation answers.
    pub question: &'static str,
    /// Its answer.
    pub answer: &'static str,
}

/// A way to run the scene of a stop.
pub struct Attempt {
    /// A description.
    pub title: &'static str,
    set_up: fn(&mut Session),
}

/// The number of steps to just before the cube hits the cow at 60 Hz.
const BEFORE_THE_COW: u32 = 44;
/// A sphere around the point of impact on the cow, m.
const BETWEEN_THE_EYES: (DVec3, f64) = (DVec3::new(-1.4, 1.2, 0.0), 1.0);
/// A sphere around the cow, and a position of the cube inside her bounding box but outside the cow, m.
const COW: (DVec3, f64) = (DVec3::new(-0.1, 1.1, 0.0), 1.6);
const OVER_HER_BACK: DVec3 = DVec3::new(0.35, 1.85, 0.0);
/// A sphere around the plate and both positions where the bullet may be, m.
const PAST_THE_PLATE: (DVec3, f64) = (DVec3::new(7.5, 0.0, 0.0), 9.5);

/// The four labs of the course, and the scenes beyond them.
pub static LABS: [Lab; 5] = [
    Lab {
        title: "1 Forward Euler",
        scenes: &["parabola", "spring"],
        stops: &[
            Stop {
                title: "A throw that goes too far",
                scene: "parabola",
                watch: "The cube should be back at the height of its start after 6 s, 12 m further on. \
                        The ghosts are RK4 and the exact solution, which are at the same place. Watch how \
                        the cube leaves them, and the plot of the path error.",
                attempts: &[
                    Attempt {
                        title: "60 steps a second",
                        set_up: |session| beside_exact(session, 60.0),
                    },
                    Attempt {
                        title: "6 steps a second",
                        set_up: |session| beside_exact(session, 6.0),
                    },
                    Attempt {
                        title: "600 steps a second",
                        set_up: |session| beside_exact(session, 600.0),
                    },
                ],
                question: "How does the error at the end change when there are ten times as many steps?",
                answer: "It is a tenth: the error of forward Euler is proportional to dt, for its order is \
                         1. The velocity that it goes on with is that at the beginning of each step, which \
                         lags behind by half a step on average; so it lands a whole step too late.",
            },
            Stop {
                title: "Energy from nothing",
                scene: "spring",
                watch: "A cube swings on a spring without friction: its energy should stay. Watch the plot \
                        of the energy, and how wide it swings.",
                attempts: &[
                    Attempt {
                        title: "Forward Euler",
                        set_up: |session| {
                            step_by(session, "forward-euler");
                            session.start();
                        },
                    },
                    Attempt {
                        title: "Forward Euler at 1000 Hz",
                        set_up: |session| {
                            step_by(session, "forward-euler");
                            session.set_rate(1000.0);
                            session.start();
                        },
                    },
                ],
                question: "Why does forward Euler gain energy?",
                answer: "It goes along the tangent of where a step begins. The motion of an oscillator is a \
                         circle in position and velocity, and a tangent leads out of every circle: the \
                         amplitude grows by √(1 + ω² dt²) a step, whatever dt is.",
            },
        ],
    },
    Lab {
        title: "2 Better methods",
        scenes: &[
            "five-hertz",
            "oscillator",
            "stiff-spring",
            "drag",
            "kepler",
            "pleiades",
        ],
        stops: &[
            Stop {
                title: "Five steps a second",
                scene: "five-hertz",
                watch: "The throw should land at x = 4 after 4 s. Each ghost is a method of the course, with \
                        steps of 0.2 s. Watch where each is at the height of its start again.",
                attempts: &[
                    Attempt {
                        title: "The four methods of the course",
                        set_up: |session| compare(session, 0),
                    },
                    Attempt {
                        title: "This method at five rates",
                        set_up: |session| compare(session, 1),
                    },
                ],
                question: "Why does forward Euler land at 4.4, and RK4 at 4?",
                answer: "Forward Euler falls one step too late: it is in the air for 4.2 s at 2 m/s. \
                         Backward and symplectic Euler fall one step too early. RK4 is of order 4, so it \
                         has paths that are polynomials up to degree 4 exactly, and a throw is of degree 2.",
            },
            Stop {
                title: "A thousand turns",
                scene: "oscillator",
                watch: "An oscillator with thirty steps a turn. Watch the energy of each method: which grows, \
                        which falls, which swings about its start.",
                attempts: &[Attempt {
                    title: "The four methods of the course, fast",
                    set_up: |session| {
                        session.set_speed(5.0);
                        compare(session, 0);
                    },
                }],
                question: "RK4 is far more exact in one turn. Which method would you take for a year of turns?",
                answer: "Symplectic Euler, or one of higher order that is symplectic too: its energy swings but \
                         does not drift. What RK4 loses in a turn is little, but it loses it in every turn.",
            },
            Stop {
                title: "A stiff spring",
                scene: "stiff-spring",
                watch: "A strong damped spring. Backward Euler finds the rest at 60 Hz. Forward Euler blows \
                        up: the message says how short a step would do, and has a button that sets it.",
                attempts: &[
                    Attempt {
                        title: "Backward Euler",
                        set_up: |session| {
                            step_by(session, "backward-euler");
                            session.start();
                        },
                    },
                    Attempt {
                        title: "Forward Euler",
                        set_up: |session| {
                            step_by(session, "forward-euler");
                            session.start();
                        },
                    },
                ],
                question: "Why is a long step no trouble for backward Euler?",
                answer: "It asks for the force at the end of the step, so it never goes past the rest: a step \
                         divides the deviation by a number above 1. Forward Euler multiplies it by 1 - λ dt, \
                         which is beyond -1 where dt is above 2/λ.",
            },
            Stop {
                title: "An orbit that should close",
                scene: "kepler",
                watch: "The planet goes round on an ellipse. Watch the trail: forward Euler spirals outwards, \
                        symplectic Euler turns the ellipse, RK4 hardly does either at this rate.",
                attempts: &[Attempt {
                    title: "The four methods of the course",
                    set_up: |session| compare(session, 0),
                }],
                question: "Where on its way does a method err most?",
                answer: "Near the sun, where the planet is fastest and the force changes most within a step. \
                         Methods that control their error take shorter steps there.",
            },
        ],
    },
    Lab {
        title: "3 Collisions, the naive way",
        scenes: &[
            "two-cubes",
            "cube-cow",
            "bullet",
            "bounce",
            "cradle",
            "galperin",
            "closing-walls",
        ],
        stops: &[
            Stop {
                title: "Which edge met which face",
                scene: "cube-cow",
                watch: "The cube is just in front of the cow. Go on step by step (right arrow): the orange dot \
                        is the contact, the thin line its normal, the arrow the impulse. Violet is what of \
                        each body touches.",
                attempts: &[
                    Attempt {
                        title: "Naive, held before the impact",
                        set_up: |session| {
                            look_at(session, BETWEEN_THE_EYES);
                            session.set_collision(Collision::Naive);
                            (0..BEFORE_THE_COW).for_each(|_| session.step_once());
                        },
                    },
                    Attempt {
                        title: "Continuous, in slow motion",
                        set_up: |session| {
                            look_at(session, BETWEEN_THE_EYES);
                            session.set_collision(Collision::Continuous);
                            session.set_speed(0.1);
                            session.start();
                        },
                    },
                ],
                question: "How many edges does the naive way test with how many triangles?",
                answer: "The 18 edges of the cube with the 6,000 triangles of the cow, and the 9,000 edges of \
                         the cow with the 12 triangles of the cube: 216,000 tests, in every step in which the \
                         boxes around the two meet.",
            },
            Stop {
                title: "Momentum and energy",
                scene: "two-cubes",
                watch: "Equal masses that meet head on exchange their velocities. Watch the plots: the momentum \
                        stays at all times, and the energy as the impacts are elastic.",
                attempts: &[
                    Attempt {
                        title: "Elastic",
                        set_up: Session::start,
                    },
                    Attempt {
                        title: "Half of the speed is left",
                        set_up: |session| {
                            for body in 0..session.world().len() {
                                session.select(Some(body));
                                session.set_restitution(0.5);
                            }
                            session.select(None);
                            session.start();
                        },
                    },
                ],
                question: "What is kept whatever the restitution is?",
                answer: "The momentum: the impulse acts on both, with opposite directions. The energy is kept \
                         at restitution 1 only.",
            },
            Stop {
                title: "The bullet that goes through",
                scene: "bullet",
                watch: "The cube flies 16.7 m in a step, and the plates are 1 mm thick. The red ghosts are the \
                        two places in which it was looked for, the lines the room between that nobody looked \
                        at.",
                attempts: &[
                    Attempt {
                        title: "BVH: at the end of each step",
                        set_up: |session| {
                            look_at(session, PAST_THE_PLATE);
                            session.set_collision(Collision::Bvh);
                            session.step_once();
                        },
                    },
                    Attempt {
                        title: "Continuous: within the step",
                        set_up: |session| {
                            session.set_collision(Collision::Continuous);
                            session.set_speed(0.001);
                            session.start();
                        },
                    },
                ],
                question: "Would a shorter step help?",
                answer: "Only one shorter than the cube and the plate together are thick: 0.5 ms here. It has to \
                         get shorter with every metre a second. The continuous test looks for the time of the \
                         impact instead.",
            },
        ],
    },
    Lab {
        title: "4 Collisions through a BVH",
        scenes: &["u-channel", "hundred-cubes", "herd"],
        stops: &[
            Stop {
                title: "Boxes in boxes",
                scene: "cube-cow",
                watch: "Each box holds a part of the cow, and the boxes below it the parts of that. Go through \
                        the depths with [ and ].",
                attempts: &[
                    Attempt {
                        title: "Boxes of depth 2",
                        set_up: |session| show_boxes(session, 2),
                    },
                    Attempt {
                        title: "Boxes of depth 5",
                        set_up: |session| show_boxes(session, 5),
                    },
                ],
                question: "What does a box tell of the triangles in it?",
                answer: "If something does not meet the box it meets none of them, and all are left out at the \
                         cost of one comparison.",
            },
            Stop {
                title: "Why the BVH wins",
                scene: "cube-cow",
                watch: "The cube is over the cow's back, in the box around her. Look at Naive against BVH at the \
                        end of the panel: tests, boxes and time of one answer, both ways. The boxes in orange are \
                        those that meet; go down level by level with N, or pair by pair with K.",
                attempts: &[Attempt {
                    title: "Measure, and show the descent",
                    set_up: |session| {
                        session.select(Some(1));
                        session.set_position(OVER_HER_BACK);
                        session.select(None);
                        session.compare.on = true;
                        session.display.descent = Some(0);
                        look_at(session, COW);
                    },
                }],
                question: "How do both ways grow with the number of triangles?",
                answer: "The naive way with the product of both meshes. The BVH goes down only where boxes of both \
                         meet: a few boxes a level, and the levels grow with the logarithm.",
            },
            Stop {
                title: "A crowd",
                scene: "hundred-cubes",
                watch: "A hundred cubes that meet elastically: 50 J at all times, however often they collide. \
                        Watch the cost of a step.",
                attempts: &[
                    Attempt {
                        title: "Continuous",
                        set_up: Session::start,
                    },
                    Attempt {
                        title: "Discrete against continuous",
                        set_up: |session| compare(session, 2),
                    },
                ],
                question: "A hundred bodies are 4,950 pairs. Why does a step not test each?",
                answer: "Most boxes around bodies are apart. They are put in order along axes first, and only \
                         pairs whose boxes meet within the step are looked at.",
            },
        ],
    },
    Lab {
        title: "Beyond: bodies that turn",
        scenes: &["tennis-racket", "cubes-turning"],
        stops: &[
            Stop {
                title: "A racket that flips over",
                scene: "tennis-racket",
                watch: "The box turns about the middle one of its three axes. The green arrow is its angular \
                        velocity ω, the dark red one its angular momentum L. Nothing acts on it, so L stays. \
                        Watch after some seconds how ω leaves it, and the box flips over.",
                attempts: &[
                    Attempt {
                        title: "About the middle axis",
                        set_up: Session::start,
                    },
                    Attempt {
                        title: "About the long axis",
                        set_up: |session| spin(session, DVec3::new(5.0, 0.001, 0.0)),
                    },
                    Attempt {
                        title: "About the short axis",
                        set_up: |session| spin(session, DVec3::new(0.001, 5.0, 0.0)),
                    },
                ],
                question: "Why does turning about the middle axis not last?",
                answer: "Energy and angular momentum both stay. About the axes of the greatest and of the least \
                         moment of inertia no other turning near by has the same two, so a small push stays \
                         small. About the middle one there is, and it leads away, round to the other side, and \
                         back.",
            },
            Stop {
                title: "Half of the energy turns",
                scene: "cubes-turning",
                watch: "A hundred cubes fly about and do not turn at first. Impacts are off centre, and make them \
                        turn. Watch in the plot of the energy what is in turning, and the total.",
                attempts: &[Attempt {
                    title: "Let them meet",
                    set_up: Session::start,
                }],
                question: "Why is it half of the energy in the end, and not all or a tenth?",
                answer: "A cube has three directions to move along and three axes to turn about. Impacts share the \
                         energy among all six, on average alike: half is in moving, half in turning.",
            },
        ],
    },
];

/// The heading of scenes that belong to no lab.
pub const BEYOND: &str = "Beyond the labs";

/// A stop of the tour by its number, counted through all labs.
pub fn stop(number: usize) -> Option<(&'static Lab, &'static Stop)> {
    LABS.iter()
        .flat_map(|lab| lab.stops.iter().map(move |stop| (lab, stop)))
        .nth(number)
}

/// The number of stops.
pub fn stop_count() -> usize {
    LABS.iter().map(|lab| lab.stops.len()).sum()
}

impl Session {
    /// Opens the scene of a stop and sets it up; the previous scene is discarded.
    pub(super) fn set_up(&mut self, number: usize, attempt: usize) {
        let Some((_, stop)) = stop(number) else {
            return;
        };
        self.open(stop.scene);
        self.set_speed(1.0);
        self.compare.on = false;
        (self.display.descent, self.display.pair) = (None, None);
        self.display.bvh.shown = false;
        if let Some(attempt) = stop.attempts.get(attempt) {
            (attempt.set_up)(self);
        }
        // The settings of the tour are not edits by the user.
        self.begin_history();
    }
}

fn step_by(session: &mut Session, name: &str) {
    if let Some(method) = Method::named(name) {
        session.set_method(method);
    }
}

/// Changes the spin of the first body.
fn spin(session: &mut Session, spin: DVec3) {
    session.select(Some(0));
    session.set_spin(spin);
    session.select(None);
    session.start();
}

fn beside_exact(session: &mut Session, rate: f64) {
    step_by(session, "forward-euler");
    session.set_rate(rate);
    let mut other = *session.world().settings();
    if let Some(method) = Method::named("rk4") {
        other.method = method;
    }
    session.compare_with([other]);
    session.start();
}

fn compare(session: &mut Session, preset: usize) {
    let own = *session.world().settings();
    if let Some(preset) = super::PRESETS.get(preset) {
        session.compare_with((preset.settings)(&own));
    }
    session.start();
}

fn look_at(session: &mut Session, (centre, radius): (DVec3, f64)) {
    session.camera.frame(centre, radius);
    session.opening.settle();
}

fn show_boxes(session: &mut Session, depth: usize) {
    look_at(session, COW);
    session.display.bvh.shown = true;
    session.display.bvh.every_depth = false;
    session.display.bvh.every_body = true;
    session.display.bvh.depth = depth;
}
