//! The picture between two states.

use super::*;

fn at_impact() -> Session {
    let mut session = session();
    session.set_rate(7.0);
    session.start();
    for _ in 0..100 {
        advance(&mut session, FRAME, free());
    }
    session
}

#[test]
fn bodies_are_drawn_at_their_impact_at_its_time() {
    let mut session = at_impact();
    // The gap of 2 m closes at 2 m/s. No state is at 1 s, and linear interpolation would place the bodies apart.
    session.go_to_time(1.0);
    assert_eq!(session.state(), State::Paused);
    assert!((session.shown_time() - 1.0).abs() < 1e-9);
    let picture = session.picture();
    let [mover, target] = [&picture.models[0], &picture.models[1]];
    assert!((mover.position.x + 1.0).abs() < 1e-6, "{}", mover.position);
    assert!(target.position.length() < 1e-6);
    // A little later they separate, each with its own velocity: 2 (1 - 3) / (1 + 3) and 2 2 / (1 + 3) m/s.
    session.go_to_time(1.0 + 0.01);
    let later = session.picture();
    assert!((later.models[0].position.x + 1.0 + 0.01).abs() < 1e-6);
    assert!((later.models[1].position.x - 0.01).abs() < 1e-6);
}

#[test]
fn an_impact_is_marked_from_its_time_on_with_what_touches() {
    let mut session = at_impact();
    session.go_to_time(0.99);
    assert!(session.picture().marks.is_empty(), "it is yet to come");
    session.go_to_time(1.0);
    let picture = session.picture();
    assert!(!picture.marks.is_empty());
    assert!(session.display.impacts);
    let impact = session.world().last_impact().expect("one").clone();
    let parts = session.touching(&impact);
    assert!(parts.iter().all(Option::is_some), "{parts:?}");
    session.display.impacts = false;
    assert!(session.picture().marks.is_empty());
}

#[test]
fn what_touches_is_known_of_meshes_against_anything() {
    use crate::session::Part;
    // A cube falls on a floor with a face or a corner first, and a ball on the middle of a cube's face.
    let turned = "rotation = [45, 0, 35.26439]";
    for (shape, other, wanted) in [
        ("mesh = \"cube.obj\"", "half-space = [0, 1, 0]", None),
        (turned, "half-space = [0, 1, 0]", Some("corner")),
        ("sphere = 0.5", "mesh = \"cube.obj\"", Some("ball")),
    ] {
        let shape = match shape == turned {
            true => format!("mesh = \"cube.obj\"\n{turned}"),
            false => shape.to_owned(),
        };
        let text = format!(
            "rate = 60\n[[body]]\nname = \"upper\"\n{shape}\nposition = [0.13, 2, 0.21]\nvelocity = [0, -3, 0]\n\
             [[body]]\nname = \"lower\"\n{other}\nimmovable = true"
        );
        let text = text.replace(
            "half-space = [0, 1, 0]\nimmovable = true",
            "half-space = [0, 1, 0]",
        );
        let scene =
            Scene::parse(&text, Path::new("t.toml")).unwrap_or_else(|e| panic!("{e}: {text}"));
        let mut session = Session::new(scene).expect("a world");
        session.start();
        for _ in 0..60 {
            advance(&mut session, FRAME, free());
        }
        let impact = session.world().last_impact().expect("it has hit").clone();
        session.go_to_time(impact.time);
        session.picture();
        let [upper, lower] = session.touching(&impact);
        match wanted {
            None => assert!(upper.is_some(), "a cube has parts"),
            Some("corner") => assert!(matches!(upper, Some(Part::Corner(_))), "{upper:?}"),
            Some(_) => assert!(
                matches!((upper, lower), (None, Some(Part::Face(_)))),
                "{upper:?} {lower:?}"
            ),
        }
    }
}

#[test]
fn slow_motion_holds_and_goes_on_where_it_is() {
    let mut session = at_impact();
    session.set_speed(0.01);
    session.go_to_time(0.97);
    session.start();
    let step = session.world().steps();
    assert!(
        (session.shown_time() - 0.97).abs() < 1e-6,
        "{}",
        session.shown_time()
    );
    advance(&mut session, Duration::from_millis(100), free());
    assert!(
        (session.shown_time() - 0.971).abs() < 1e-6,
        "{}",
        session.shown_time()
    );
    assert_eq!(session.world().steps(), step, "no step is due yet");
    session.pause();
    assert!((session.shown_time() - 0.971).abs() < 1e-6);
    // A step goes to the next whole state.
    session.step_once();
    advance(&mut session, FRAME, free());
    assert_eq!(session.world().steps(), step + 1);
    assert!(!session.is_between());
}

#[test]
fn nothing_is_shown_before_the_start() {
    let mut session = session();
    session.set_speed(0.01);
    session.start();
    for _ in 0..200 {
        let before = session.shown_time();
        advance(&mut session, FRAME, free());
        assert!(session.shown_time() >= before && before >= 0.0, "{before}");
    }
    assert!(session.world().steps() > 0);
}

#[test]
fn impacts_are_gone_to_one_after_the_other() {
    let mut session = at_impact();
    session.go_to(0);
    session.go_to_impact(true);
    assert!((session.shown_time() - 1.0).abs() < 1e-9);
    session.go_to_impact(true);
    assert!(
        (session.shown_time() - 1.0).abs() < 1e-9,
        "there is no other"
    );
    let told = session
        .notices()
        .iter()
        .any(|notice| notice.about == "impact");
    assert!(told);
    session.go_to(usize::MAX);
    session.go_to_impact(false);
    assert!((session.shown_time() - 1.0).abs() < 1e-9);
}

#[test]
fn states_alone_are_drawn_where_that_is_wished() {
    let mut session = at_impact();
    session.display.between = false;
    advance(&mut session, Duration::from_millis(50), free());
    assert_eq!(session.shown_time(), session.world().time());
    let drawn = session.picture().models[0].position;
    assert_eq!(drawn, session.world().position(0));
}
