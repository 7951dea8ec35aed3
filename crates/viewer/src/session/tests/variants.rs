//! Variants of the run.

use sim_core::Settings;

use super::*;
use crate::session::{PRESETS, Variant};

/// Steps the variants to the time of the run.
fn catch_up(session: &mut Session) {
    while let Some(job) = session.variants_due() {
        session.accept_variants(job.run(free()));
    }
    assert!(!session.awaits_variants());
}

fn run(session: &mut Session, time: f64) {
    session.start();
    while session.world().time() < time - 1e-9 {
        advance(session, FRAME, free());
    }
    session.pause();
    catch_up(session);
}

fn five_hertz() -> Session {
    Session::new(Scene::load("five-hertz").expect("in the gallery")).expect("a world")
}

/// The final x coordinate of a variant's first body.
fn landing(variant: &Variant) -> f64 {
    variant.last_places()[0].x
}

#[test]
fn the_four_methods_of_the_course_land_where_they_should() {
    let mut session = five_hertz();
    let own = *session.world().settings();
    session.compare_with((PRESETS[0].settings)(&own));
    // The run itself uses forward Euler.
    assert_eq!(
        session.variants().iter().len(),
        4,
        "three others and the exact one"
    );
    run(&mut session, 4.0);
    let (name, names) = session.variant_names();
    assert_eq!(name, "Forward Euler");
    assert_eq!(
        names,
        [
            "Backward Euler",
            "Symplectic Euler",
            "Classical RK4",
            "Exact"
        ]
    );
    // All are at x = 4 m after 4 s; only their heights differ.
    let errors: Vec<f64> = session
        .variants()
        .iter()
        .map(|v| {
            v.record()
                .last()
                .and_then(|s| s.sample.error)
                .unwrap_or(f64::NAN)
        })
        .collect();
    let own = session.path_error().expect("known");
    assert!((own - 0.4).abs() < 1e-9, "{own}");
    assert!(
        (errors[0] - 0.4).abs() < 1e-9 && (errors[1] - 0.4).abs() < 1e-9,
        "{errors:?}"
    );
    assert!(errors[2] < 1e-12 && errors[3] == 0.0, "{errors:?}");
    assert!((landing(session.variants().iter().last().expect("exact")) - 4.0).abs() < 1e-12);
}

#[test]
fn variants_begin_anew_with_the_record_and_follow_it() {
    let mut session = five_hertz();
    let own = *session.world().settings();
    session.compare_with([
        Settings { dt: 0.05, ..own },
        own,
        Settings { dt: 0.05, ..own },
    ]);
    assert_eq!(
        session.compared().len(),
        1,
        "equal ones once, and not the run's own"
    );
    run(&mut session, 2.0);
    let times: Vec<f64> = session.variants().iter().map(Variant::time).collect();
    assert!(
        times.iter().all(|time| (time - 2.0).abs() < 1e-9),
        "{times:?}"
    );
    session.reset();
    assert!(session.variants().iter().all(|v| v.record().len() == 1));
    session.select(Some(0));
    session.set_velocity(DVec3::X);
    run(&mut session, 1.0);
    let exact = session.variants().iter().last().expect("exact");
    assert!((landing(exact) + 3.0).abs() < 1e-12, "it knows of the edit");
    session.open("spring");
    assert!(session.variants().is_empty());
}

#[test]
fn results_of_before_a_reset_are_not_taken_in() {
    let mut session = five_hertz();
    let own = *session.world().settings();
    session.compare_with([Settings { dt: 0.05, ..own }]);
    session.step_once();
    advance(&mut session, FRAME, free());
    let job = session.variants_due().expect("behind");
    assert!(session.variants_due().is_none(), "one at a time");
    session.reset();
    session.accept_variants(job.run(free()));
    assert!(session.variants().iter().all(|v| v.record().len() == 1));
}

#[test]
fn one_that_blows_up_says_so_and_the_others_go_on() {
    let scene = Scene::load("stiff-spring").expect("in the gallery");
    let mut session = Session::new(scene).expect("a world");
    let own = *session.world().settings();
    let euler = Settings {
        method: METHODS[0],
        ..own
    };
    session.compare_with([
        euler,
        Settings {
            method: METHODS[3],
            dt: 1e-4,
            ..own
        },
    ]);
    run(&mut session, 1.0);
    let variants: Vec<&Variant> = session.variants().iter().collect();
    let failure = variants[0].failure.as_deref().unwrap_or_default();
    assert!(failure.contains("cube"), "{failure}");
    assert!(variants[1].failure.is_none() && variants[1].time() > 0.99);
    assert!(variants[1].worst.is_some_and(|worst| worst < 1e-3));
}

#[test]
fn ghosts_are_where_the_variants_were() {
    let mut session = five_hertz();
    let own = *session.world().settings();
    session.compare_with([Settings { dt: 0.1, ..own }]);
    run(&mut session, 2.0);
    session.go_to(0);
    assert!(
        session.picture().ghosts.is_empty(),
        "all are where the body is"
    );
    session.go_to(5);
    let picture = session.picture();
    assert_eq!(picture.ghosts.len(), 2);
    assert!((picture.ghosts[1].position - DVec3::new(-2.0, 1.5, 0.0)).length() < 1e-12);
    assert!(!picture.lines.is_empty());
}
