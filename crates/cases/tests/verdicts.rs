//! Every verdict is the one that is expected: of methods on hard cases, of engines on scenes.

use cases::hard_cases::attempt_all;
use cases::scenes::{COLLISIONS, Family, RESTING, Who};

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
