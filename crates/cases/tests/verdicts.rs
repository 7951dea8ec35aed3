//! Every verdict is the one that is expected: of methods on hard cases, of engines on scenes.

use cases::Verdict;
use cases::hard_cases::attempt_all;
use cases::scenes::{COLLISIONS, Family, RESTING, Who};
use cases::turning::contacts::{CONTACTS, Seeker};
use cases::turning::tumbling::TUMBLERS;
use cases::turning::{ENGINES, racket};

#[test]
fn hard_cases_end_as_their_rows_say() {
    let mut wrong = Vec::new();
    for outcome in attempt_all() {
        let (case, finding) = (outcome.case, &outcome.finding);
        let text = format!(
            "case {}, {}, {}: {}, expected {}: {:?} of {:?}, {}",
            case.number,
            case.title,
            outcome.method.map_or("any", |method| method.name),
            finding.verdict.name(),
            case.expected(outcome.method).name(),
            finding.figure,
            finding.tolerance,
            finding.why
        );
        println!("{text}");
        if !outcome.is_expected() {
            wrong.push(text);
        }
    }
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

#[test]
fn what_turns_freely_ends_as_its_row_says() {
    let mut wrong = Vec::new();
    for tumbler in &TUMBLERS {
        for rate in [30, 60] {
            for &who in ENGINES {
                let run = tumbler.run(who, rate, 60 * rate);
                let text = format!("{}, {rate} Hz, {who:?}: {run:?}", tumbler.name);
                println!("{text}");
                if tumbler.verdict(&run) != tumbler.expected(who) {
                    wrong.push(text);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_racket_turns_over_in_time() {
    for start in racket::STARTS {
        for rate in [30, 60] {
            let flips = racket::run(Who::Continuous, start, rate);
            assert_eq!(flips.times.len(), racket::FLIPS, "{start} {rate}");
            for flip in 0..racket::FLIPS {
                let error = flips.error(start, flip).expect("a flip");
                println!("{start}, {rate} Hz, flip {flip}: {error:e}");
                assert!(error < 1e-8, "{start}, {rate} Hz, flip {flip}: {error:e}");
            }
        }
    }
}

#[test]
fn first_contacts_are_found_as_their_rows_say() {
    let mut wrong = Vec::new();
    for contact in &CONTACTS {
        // Nobody else's verdict is claimed; parry takes minutes over cows where it is not optimised.
        for &seeker in contact.passed_by.iter().chain(contact.failed_by) {
            let mut failed = false;
            for &spin in contact.spins {
                let meeting = (contact.make)(spin);
                let Some(search) = seeker.prepare(&meeting) else {
                    continue;
                };
                let (exact, found) = (meeting.exact(), search());
                let verdict = contact.verdict(exact, &found);
                let text = format!(
                    "{}, {spin} rad/s, {seeker:?}: {found:?}, exact {exact:?}",
                    contact.name
                );
                println!("{} {text}", verdict.name());
                failed |= verdict == Verdict::Fail;
                // Never late, as far as the truth is known: it has rounding too.
                let late = exact
                    .zip(found.time)
                    .map_or(0.0, |(exact, time)| time - exact);
                if seeker == Seeker::Ours && late > 1e-14 {
                    wrong.push(format!("late by {late:e} s: {text}"));
                }
            }
            let must_pass = contact.passed_by.contains(&seeker);
            let must_fail = contact.failed_by.contains(&seeker);
            if must_pass && failed || must_fail && !failed {
                wrong.push(format!("{}: {seeker:?}", contact.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
