//! Pulling and throwing.

use sim_core::DVec3;

use super::{FRAME, Scene, Session, advance, free};

fn session(name: &str) -> Session {
    let scene = Scene::load(name).expect("in the gallery");
    Session::new(scene).expect("a world")
}

fn run(session: &mut Session, time: f64) {
    for _ in 0..(time / FRAME.as_secs_f64()) as usize {
        advance(session, FRAME, free());
    }
}

#[test]
fn a_body_is_pulled_thrown_and_put_back() {
    let mut session = session("two-cubes");
    let body = 0;
    let middle = session.world().position(body);
    let towards = |session: &Session, place: DVec3| {
        let eye = session.camera.eye();
        (eye, (place - eye).normalize())
    };
    let (eye, direction) = towards(&session, middle);
    assert!(!session.take_hold(eye, direction), "physics does not run");
    session.start();
    assert!(session.take_hold(eye, direction));
    assert_eq!(session.world().forces().len(), 1);
    let up = middle + 2.0 * session.camera.axes()[1];
    let (eye, direction) = towards(&session, up);
    session.pull(eye, direction);
    run(&mut session, 1.5);
    let now = session.world().position(body);
    let aside = (now - eye).reject_from_normalized(direction).length();
    assert!(aside < 0.8, "{aside} m from where it is pulled to");
    let (eye, direction) = towards(&session, up + DVec3::new(0.0, 3.0, 0.0));
    session.pull(eye, direction);
    run(&mut session, 0.1);
    session.let_go();
    assert!(session.world().forces().is_empty());
    let speed = session.world().velocity(body).length();
    assert!(speed > 1.0, "thrown with {speed} m/s");
    session.reset();
    assert_eq!(session.world().position(body), middle);
    assert!(!session.is_changed());
}

#[test]
fn what_is_held_is_let_go_by_a_reset_and_what_is_immovable_is_not_held() {
    let mut session = session("bullet");
    session.start();
    let plate = session.world().position(1);
    let eye = session.camera.eye();
    assert!(!session.take_hold(eye, (plate - eye).normalize()));
    let mut session = self::session("two-cubes");
    session.start();
    let eye = session.camera.eye();
    let direction = (session.world().position(0) - eye).normalize();
    assert!(session.take_hold(eye, direction));
    session.reset();
    assert!(!session.is_pulling());
    assert!(session.world().forces().is_empty());
    session.pull(eye, direction);
    session.let_go();
    assert!(session.world().forces().is_empty());
}
