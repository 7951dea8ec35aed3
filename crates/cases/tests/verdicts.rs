//! Every verdict is the one that is expected: of methods on hard cases, of engines on scenes.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cases::scenes::{COLLISIONS, Family, RESTING, Who};
use cases::{CASES, Case};
use sim_core::Method;

/// All cases by all methods, two at once; each is judged, and takes some seconds.
#[test]
fn hard_cases_end_as_their_rows_say() {
    let tasks: Vec<(&'static Case, Option<&'static Method>)> = CASES
        .iter()
        .flat_map(|case| case.methods().map(move |method| (case, method)))
        .collect();
    let (next, wrong) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some(&(case, method)) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) {
            let clock = Instant::now();
            let outcome = case.attempt(method);
            let (finding, name) = (&outcome.finding, method.map_or("any", |m| m.name));
            let text = format!(
                "case {}, {}, {name}: {}, expected {}: {:?} of {:?}, {}",
                case.number,
                case.title,
                finding.verdict.name(),
                case.expected(method).name(),
                finding.figure,
                finding.tolerance,
                finding.why
            );
            println!("{:6.2} s  {text}", clock.elapsed().as_secs_f64());
            if !outcome.is_expected() {
                wrong.lock().expect("no panic").push(text);
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        work();
    });
    let wrong = wrong.into_inner().expect("no panic");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// At the usual rate and at a slow one.
fn assert_families(families: &[Family], engines: impl Fn(Who) -> bool) {
    let mut wrong = Vec::new();
    for family in families {
        for &speed in family.speeds {
            for rate in [30, 60] {
                let known = (family.make)(speed).at_rate(rate);
                for &who in Who::ALL.iter().filter(|&&who| engines(who)) {
                    let run = known.run(who);
                    let text = format!("{}, {speed} m/s, {rate} Hz, {who:?}: {run:?}", family.name);
                    println!("{text}");
                    if family.verdict(&run) != family.expected(who) {
                        wrong.push(text);
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_meets_ends_where_it_must() {
    assert_families(&COLLISIONS, |_| true);
}

#[test]
fn what_lies_and_slides_ends_where_it_must() {
    assert_families(&RESTING, Who::has_contacts);
}
