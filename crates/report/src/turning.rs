//! Bodies that turn: free flight, flips, first contacts and levers, each error with its cost.

use cases::Verdict;
use cases::problems::Effort;
use cases::scenes::{Scene, Who};
use cases::turning::ENGINES;
use cases::turning::contacts::{CONTACTS, Contact, Found, Seeker};
use cases::turning::levers::{LEVERS, Lever};
use cases::turning::racket::{self, Flips};
use cases::turning::tumbling::{TUMBLERS, Tumble, Tumbler};
use sim_core::{METHODS, Method};

use crate::scope::Scope;
use crate::stopwatch;

pub(crate) struct Turning {
    pub(crate) tumbles: Vec<Tumbles>,
    pub(crate) rackets: Vec<RacketRun>,
    pub(crate) contacts: Vec<Contacts>,
    pub(crate) levers: Vec<Levers>,
}

/// All runs with a body in free flight.
pub(crate) struct Tumbles {
    pub(crate) tumbler: &'static Tumbler,
    /// How long each run is, s of motion.
    pub(crate) time: u32,
    pub(crate) runs: Vec<TumbleRun>,
}

pub(crate) struct TumbleRun {
    pub(crate) who: Who,
    /// Steps a second.
    pub(crate) rate: u32,
    pub(crate) found: Tumble,
    /// Of one step, s.
    pub(crate) seconds: f64,
}

/// A run of the tennis racket.
pub(crate) struct RacketRun {
    /// How far from the middle axis it starts.
    pub(crate) start: f64,
    pub(crate) who: Who,
    /// Steps a second.
    pub(crate) rate: u32,
    pub(crate) flips: Flips,
    /// Of one step, s.
    pub(crate) seconds: f64,
}

/// All answers to a question of when two meshes meet.
pub(crate) struct Contacts {
    pub(crate) contact: &'static Contact,
    pub(crate) runs: Vec<ContactRun>,
}

pub(crate) struct ContactRun {
    pub(crate) who: Seeker,
    /// rad/s
    pub(crate) spin: f64,
    /// s; `None` where they do not meet.
    pub(crate) exact: Option<f64>,
    pub(crate) found: Found,
    pub(crate) verdict: Verdict,
    /// Of one answer, s.
    pub(crate) seconds: f64,
}

/// All runs with a force at a point.
pub(crate) struct Levers {
    pub(crate) lever: &'static Lever,
    pub(crate) runs: Vec<LeverRun>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Puller {
    Method(&'static Method),
    Rapier,
}

pub(crate) struct LeverRun {
    pub(crate) who: Puller,
    pub(crate) effort: Effort,
    /// m, or why there is none.
    pub(crate) error: Result<f64, String>,
    /// Of the whole run, s.
    pub(crate) seconds: f64,
}

impl Puller {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Puller::Method(method) => method.name,
            Puller::Rapier => Who::Rapier.name(),
        }
    }

    /// The methods, then Rapier.
    pub(crate) fn all() -> impl Iterator<Item = Puller> {
        METHODS
            .into_iter()
            .map(Puller::Method)
            .chain([Puller::Rapier])
    }
}

impl ContactRun {
    /// How late the answer is, s, below 0 if it is early; `None` where there is no such time.
    pub(crate) fn late(&self) -> Option<f64> {
        Some(self.found.time? - self.exact?)
    }
}

const RATES: [u32; 6] = [30, 60, 120, 240, 480, 960];

pub(crate) fn measure(scope: Scope) -> Turning {
    Turning {
        tumbles: TUMBLERS.iter().map(|it| tumbles(it, scope)).collect(),
        rackets: rackets(scope),
        contacts: CONTACTS.iter().map(|it| contacts(it, scope)).collect(),
        levers: LEVERS.iter().map(|it| levers(it, scope)).collect(),
    }
}

/// Time of a step, s: median over runs at which nothing looks.
fn step_seconds(who: Who, scene: &Scene, scope: Scope) -> f64 {
    const STEPS: u32 = 1000;
    let runs = (0..scope.repeats()).map(|_| {
        let mut engine = who.start(scene);
        // To warm up; what fails is told by where it leaves the bodies.
        let _ = engine.step();
        let ((), seconds) = stopwatch::timed(|| {
            for _ in 0..STEPS {
                let _ = engine.step();
            }
        });
        seconds / f64::from(STEPS)
    });
    stopwatch::middle(&mut runs.collect::<Vec<f64>>())
}

fn tumbles(tumbler: &'static Tumbler, scope: Scope) -> Tumbles {
    let time = scope.tumbling_time();
    let runs = RATES.into_iter().flat_map(|rate| {
        ENGINES.iter().map(move |&who| TumbleRun {
            who,
            rate,
            found: tumbler.run(who, rate, time * rate),
            seconds: step_seconds(who, &tumbler.scene(rate), scope),
        })
    });
    Tumbles {
        tumbler,
        time,
        runs: runs.collect(),
    }
}

fn rackets(scope: Scope) -> Vec<RacketRun> {
    let runs = racket::STARTS.into_iter().flat_map(|start| {
        RATES.into_iter().flat_map(move |rate| {
            ENGINES.iter().map(move |&who| RacketRun {
                start,
                who,
                rate,
                flips: racket::run(who, start, rate),
                seconds: step_seconds(who, &racket::scene(start, rate), scope),
            })
        })
    });
    runs.collect()
}

fn contacts(contact: &'static Contact, scope: Scope) -> Contacts {
    let mut runs = Vec::new();
    for &spin in contact.spins {
        let meeting = (contact.make)(spin);
        let triangles = meeting
            .things
            .each_ref()
            .map(|it| it.mesh.triangles().len());
        let is_dear = triangles.iter().all(|&n| n > MANY);
        let exact = meeting.exact();
        for &who in Seeker::ALL {
            if scope == Scope::Quick && is_dear && who != Seeker::Ours {
                continue;
            }
            let Some(search) = who.prepare(&meeting) else {
                continue;
            };
            let (found, rough) = stopwatch::timed(&search);
            // One that takes seconds is asked once.
            let seconds = match rough > scope.dearest_run() {
                true => rough,
                false => stopwatch::median(scope.repeats(), &search),
            };
            runs.push(ContactRun {
                who,
                spin,
                exact,
                found,
                verdict: contact.verdict(exact, &found),
                seconds,
            });
        }
    }
    Contacts { contact, runs }
}

/// Triangles of meshes about which a quick report does not ask parry, which takes seconds for an answer.
const MANY: usize = 1000;

/// Fewest and most steps of a run of a lever.
const STEPS: [u64; 2] = [16, 16_384];

/// An error below which more steps may not help any more, m.
const ROUNDING: f64 = 1e-9;

fn levers(lever: &'static Lever, scope: Scope) -> Levers {
    let exact = lever.exact();
    let run = |who: Puller, effort: Effort| match (who, effort) {
        (Puller::Method(method), _) => lever.after(method, effort).map_err(|e| e.to_string()),
        (Puller::Rapier, Effort::Steps(steps)) => Ok(lever.after_by_rapier(steps)),
        (Puller::Rapier, Effort::Tolerance(_)) => Err("it takes steps of one length".into()),
    };
    let mut runs = Vec::new();
    for who in Puller::all() {
        let efforts: Vec<Effort> = match who {
            Puller::Method(method) if method.adaptive => scope
                .tolerance_exponents()
                .map(|n| Effort::Tolerance(10_f64.powi(-n)))
                .collect(),
            _ => std::iter::successors(Some(STEPS[0]), |n| Some(n * scope.lever_factor()))
                .take_while(|&n| n <= STEPS[1])
                .map(Effort::Steps)
                .collect(),
        };
        let mut last = f64::INFINITY;
        for effort in efforts {
            let (end, rough) = stopwatch::timed(|| run(who, effort));
            let error = end.and_then(|end| match (end - exact).length() {
                error if error < 1.0 => Ok(error),
                error => Err(format!("nothing of the answer is left: {error:.1e} m")),
            });
            let seconds = match error {
                Ok(_) => stopwatch::median(scope.repeats(), || run(who, effort)),
                Err(_) => rough,
            };
            let now = *error.as_ref().unwrap_or(&f64::INFINITY);
            runs.push(LeverRun {
                who,
                effort,
                error,
                seconds,
            });
            // What blows up may take long, and shorter steps help it.
            if now.is_finite()
                && (rough > scope.dearest_run() || now < ROUNDING && now > 0.7 * last)
            {
                break;
            }
            last = now;
        }
    }
    Levers { lever, runs }
}
