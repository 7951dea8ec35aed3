//! Bodies that are set up in overlap.

use super::*;

/// A ball that overlaps a floor, a second ball that overlaps the first, and one apart from them.
fn session() -> Session {
    let text = "rate = 60
        [[body]]
        name = 'floor'
        half-space = [0, 1, 0]
        immovable = true
        [[body]]
        name = 'low'
        sphere = 0.5
        position = [0, 0.25, 0]
        velocity = [0, 0, 1]
        [[body]]
        name = 'high'
        sphere = 0.5
        position = [0, 1.0, 0]
        [[body]]
        name = 'other'
        sphere = 0.5
        position = [5, 5, 0]
    ";
    let scene = Scene::parse(text, Path::new("overlap.toml")).expect("the text is a scene");
    Session::new(scene).expect("the scene makes a world")
}

fn told(session: &mut Session) -> Vec<((usize, usize), f64)> {
    let overlaps = session.overlaps().iter();
    overlaps
        .map(|overlap| (overlap.bodies, overlap.depth))
        .collect()
}

#[test]
fn overlaps_are_told_and_marked_as_they_are_now() {
    let mut session = session();
    assert_eq!(told(&mut session), [((0, 1), 0.25), ((1, 2), 0.25)]);
    // Boxes around the two balls, and none around the floor.
    assert_eq!(session.picture().marks.len(), 24);
    session.select(Some(2));
    session.set_position(DVec3::new(0.0, 1.125, 0.0));
    assert_eq!(told(&mut session), [((0, 1), 0.25), ((1, 2), 0.125)]);
    session.set_shape(scene::SceneShape::Sphere { radius: 0.5625 });
    assert_eq!(told(&mut session)[1].1, 0.1875);
    session.set_position(DVec3::new(9.0, 9.0, 0.0));
    assert_eq!(told(&mut session), [((0, 1), 0.25)]);
    session.select(Some(1));
    session.set_position(DVec3::new(9.0, 0.5, 0.0));
    assert_eq!(told(&mut session), []);
    assert!(session.picture().marks.is_empty());
}

#[test]
fn separating_changes_the_set_up_and_later_only_the_world() {
    let mut session = session();
    let velocity = session.world().velocity(1);
    session.separate();
    assert_eq!(told(&mut session), []);
    assert_eq!(session.world().velocity(1), velocity);
    let set_up = |session: &Session| [1, 2, 3].map(|i| session.scene().bodies[i].position);
    let places = set_up(&session);
    assert!((places[0].y - 0.5).abs() < 1e-11 && (places[1].y - 1.5).abs() < 1e-11);
    assert_eq!(places[2], DVec3::new(5.0, 5.0, 0.0));
    assert_eq!(positions(&session)[1..], places);
    let notice = session
        .notices()
        .iter()
        .last()
        .map(|notice| notice.text.clone());
    assert_eq!(notice.as_deref(), Some("Moved 2 bodies out of each other."));
    // The same for positions set while physics is paused.
    session.select(Some(2));
    session.set_position(DVec3::new(0.0, 1.25, 0.0));
    session.step_once();
    advance(&mut session, FRAME, free());
    assert_eq!(told(&mut session).len(), 1);
    session.separate();
    assert_eq!(told(&mut session), []);
    assert_eq!(set_up(&session)[1], DVec3::new(0.0, 1.25, 0.0));
    session.reset();
    assert_eq!(told(&mut session).len(), 1);
}

#[test]
fn what_cannot_be_separated_is_told_by_name() {
    let mut session = session();
    session.add(
        "ceiling",
        scene::SceneShape::HalfSpace {
            normal: DVec3::NEG_Y,
        },
    );
    session.set_position(DVec3::new(0.0, 0.75, 0.0));
    session.set_immovable(true);
    let before = positions(&session);
    session.separate();
    let text = complaint(&mut session, "separate").expect("it is refused");
    assert!(
        text.contains("does not fit between the half-spaces floor, ceiling"),
        "{text}"
    );
    assert_eq!(positions(&session), before);
}
