//! Turning bodies: drawn as they are, kept, edited and replayed.

use super::*;
use crate::session::{Record, verify};
use sim_core::DQuat;

/// A flat box that spins about its intermediate axis, and beside it a cow whose origin is not its centre of mass.
fn turning() -> Session {
    let text = "rate = 60
        [[body]]
        name = 'box'
        mesh = 'cube.obj'
        scale = [1, 0.2, 0.5]
        turns = true
        spin = [0.001, 0, 5]
        [[body]]
        name = 'cow'
        mesh = 'cow.obj'
        position = [5, 1, 0]
        rotation = [0, 90, 0]
        turns = true
        spin = [0, 0, 2]
    ";
    let scene = Scene::parse(text, Path::new("turning.toml")).expect("the text is a scene");
    Session::new(scene).expect("the scene makes a world")
}

fn gallery(name: &str) -> Session {
    Session::new(Scene::load(name).expect("a gallery scene")).expect("a world")
}

fn poses(session: &Session) -> Vec<(DVec3, DQuat)> {
    let world = session.world();
    (0..world.len())
        .map(|i| (world.origin(i), world.rotation(i)))
        .collect()
}

fn go_on(session: &mut Session, frames: u32) {
    for _ in 0..frames {
        advance(session, FRAME, free());
    }
}

#[test]
fn bodies_are_drawn_as_they_are_turned_and_states_keep_it() {
    let mut session = turning();
    let start = poses(&session);
    let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-9, "{a} is not {b}");
    session.start();
    go_on(&mut session, 30);
    session.display.between = false;
    let now = poses(&session);
    assert!(now[0].1.angle_between(start[0].1) > 0.1);
    let picture = session.picture();
    for (model, &(place, rotation)) in picture.models.iter().zip(&now) {
        near(model.position, place);
        assert!(model.rotation.angle_between(rotation) < 1e-7);
    }
    // Its box is the bounding box of its rotated corners.
    let bounds = session.bounds(0);
    let mesh = session.world().mesh(0).expect("a mesh").clone();
    let corners = mesh.vertices().iter().map(|v| now[0].1 * v.as_dvec3());
    near(corners.fold(DVec3::ZERO, DVec3::max), bounds.half);
    // A ray meets the rotated surface: along the long axis, just inside its end.
    let end = now[0].0 + now[0].1 * DVec3::new(0.499, 0.0, 0.0);
    let hit = session.hit(end + 9.0 * DVec3::Z, DVec3::NEG_Z);
    assert_eq!(hit.map(|(_, i)| i), Some(0));
    session.go_to(0);
    assert_eq!(poses(&session), start);
}

#[test]
fn turning_is_switched_and_set() {
    let mut session = turning();
    session.select(Some(1));
    session.set_position(DVec3::new(6.0, 1.0, 0.0));
    assert!(
        session
            .world()
            .origin(1)
            .distance(DVec3::new(6.0, 1.0, 0.0))
            < 1e-12
    );
    session.set_mass(3.0);
    session.set_immovable(true);
    assert!(!session.world().kind(1).is_movable());
    session.set_immovable(false);
    assert_eq!(session.world().mass(1), 3.0);
    session.set_turns(false);
    assert!(!session.world().turns(1));
    session.set_turns(true);
    session.set_spin(DVec3::new(0.0, 3.0, 0.0));
    assert!(session.world().spin(1).distance(DVec3::new(0.0, 3.0, 0.0)) < 1e-12);
    let turn = session.scene().bodies[1].turn.expect("it turns");
    assert_eq!(turn.spin, DVec3::new(0.0, 3.0, 0.0));
    session.reset();
    assert!(session.world().spin(1).distance(turn.spin) < 1e-12);
}

#[test]
fn a_spin_that_is_set_is_recorded() {
    let mut session = turning();
    session.select(Some(0));
    session.start();
    go_on(&mut session, 10);
    session.set_spin(DVec3::new(1.0, 2.0, 3.0));
    go_on(&mut session, 10);
    let path = std::env::temp_dir().join(format!("cowbell-spin-{}.run", std::process::id()));
    let text = session.record().text_at(&path).expect("it has a text");
    std::fs::write(&path, text).expect("written");
    let record = Record::read(&path);
    std::fs::remove_file(&path).expect("removed");
    let record = record.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(record.inputs, session.record().inputs);
    let verdict = verify(record, |_| true).expect("it runs");
    assert_eq!(verdict.divergence, None);
}

#[test]
fn discrete_modes_turn_too() {
    let mut session = turning();
    session.set_collision(Collision::Bvh);
    session.start();
    go_on(&mut session, 3);
    assert_eq!(session.state(), State::Running);
    assert_eq!(complaint(&mut session, "step"), None);
    assert!(session.world().rotation(0).angle_between(DQuat::IDENTITY) > 0.1);
}

/// Two cubes, one of them spinning, that collide off centre, and a cube that falls on a corner.
fn meeting() -> Session {
    let text = "rate = 7
        [[body]]
        name = 'left'
        mesh = 'cube.obj'
        position = [-1.5, 5.4, 0]
        velocity = [2, 0, 0]
        turns = true
        spin = [0, 0, 2]
        [[body]]
        name = 'right'
        mesh = 'cube.obj'
        position = [0, 5, 0]
        turns = true
        [[body]]
        name = 'falling'
        mesh = 'cube.obj'
        rotation = [45, 0, 0]
        position = [20, 2, 0]
        velocity = [0, -1, 0]
        turns = true
        spin = [0, 0, 1]
        [[body]]
        name = 'floor'
        half-space = [0, 1, 0]
    ";
    let scene = Scene::parse(text, Path::new("meeting.toml")).expect("the text is a scene");
    Session::new(scene).expect("the scene makes a world")
}

#[test]
fn bodies_are_drawn_as_they_are_turned_when_they_touch() {
    use crate::session::Part;
    let mut session = meeting();
    session.start();
    go_on(&mut session, 150);
    session.go_to(0);
    let (mut of_cubes, mut on_floor) = (0, 0);
    for _ in 0..2 {
        session.go_to_impact(true);
        assert!(session.is_between(), "no state is at the impact");
        let seen = session.shown_time();
        let kept = session.playback().past().last().expect("a state");
        let same = |impact: &&sim_core::Impact| (impact.time - seen).abs() < 1e-9;
        let impact = kept.impacts.iter().find(same).expect("one then").clone();
        let picture = session.picture();
        // The distances of a cube's corners, as drawn, from the plane of the contact.
        let corners = |body: usize| {
            let model = &picture.models[body];
            let corners = model.mesh.vertices().iter();
            let placed = |v: &sim_core::Vec3| model.position + model.rotation * v.as_dvec3();
            corners.map(placed).collect::<Vec<_>>()
        };
        let reach = |body: usize, along: DVec3| {
            let heights = corners(body).into_iter().map(|v| v.dot(along));
            heights.fold(f64::NEG_INFINITY, f64::max)
        };
        let (i, j) = impact.bodies;
        let (plane, parts) = (impact.point.dot(impact.normal), session.touching(&impact));
        if j == 3 || i == 3 {
            on_floor += 1;
            let down = reach(2, DVec3::NEG_Y);
            assert!(down.abs() < 1e-6, "{down}");
            let part = parts[usize::from(j == 2)];
            let is_corner = matches!(part, Some(Part::Corner(_)) | Some(Part::Edge(_)));
            assert!(is_corner, "{parts:?}");
        } else {
            of_cubes += 1;
            // An edge has met the middle of a face, whose normal is the direction of the impulse.
            assert!(
                (impact.normal - DVec3::X).length() < 1e-9,
                "{}",
                impact.normal
            );
            // Both reach the plane of the contact, and neither crosses it.
            let (first, second) = (reach(i, impact.normal), -reach(j, -impact.normal));
            assert!((first - plane).abs() < 1e-6, "{first} of {plane}");
            assert!((second - plane).abs() < 1e-6, "{second} of {plane}");
        }
    }
    assert_eq!((of_cubes, on_floor), (1, 1));
}

#[test]
fn arrows_of_turning_are_shown_whatever_scene_was_open_before() {
    let mut session = gallery("cube-cow");
    session.open("tennis-racket");
    assert_eq!(session.picture().arrows.len(), 2);
    session.open("cubes-turning");
    assert_eq!(session.picture().arrows.len(), 0, "a hundred would be many");
}

#[test]
fn arrows_show_how_bodies_turn_to_a_scale_that_is_told() {
    let mut session = gallery("tennis-racket");
    let momentum = session.world().angular_momentum(0);
    let spin = session.world().spin(0);
    let picture = session.picture();
    let [first, second] = picture.arrows[..] else {
        panic!("{} arrows", picture.arrows.len());
    };
    let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-9, "{a} is not {b}");
    near(first.to - first.from, momentum);
    near(second.to - second.from, 0.1 * spin);
    let told: Vec<_> = session
        .scales()
        .into_iter()
        .map(|s| (s.name, s.text))
        .collect();
    assert_eq!(
        told,
        [
            ("angular velocity", "1 m: 10 rad/s".to_owned()),
            ("angular momentum", "1 m: 1 kg m²/s".to_owned()),
        ]
    );
    // In flight the angular momentum stays constant while the box flips, and the angular velocity does not.
    session.start();
    let mut most: f64 = 0.0;
    for _ in 0..600 {
        advance(&mut session, FRAME, free());
        let [later, other] = session.picture().arrows[..] else {
            panic!("both are there");
        };
        near(later.from, first.from);
        near(later.to, first.to);
        most = most.max(other.to.distance(second.to));
    }
    assert!(most > 0.1, "{most}");
    session.display.spins = false;
    assert!(session.picture().arrows.is_empty() && session.scales().is_empty());
    session.select(Some(0));
    assert_eq!(session.picture().arrows.len(), 2, "of the selected body");
    // In a crowd, arrows are shown only on request.
    assert!(gallery("cubes-turning").picture().arrows.is_empty());
}

#[test]
fn angular_momentum_is_noted_and_stays() {
    let mut session = meeting();
    let free = session.world().angular_momentum_about(DVec3::ZERO);
    session.start();
    go_on(&mut session, 60);
    let all: Vec<DVec3> = session
        .playback()
        .samples()
        .map(|s| s.angular_momentum)
        .collect();
    assert!(all.len() > 5 && all[0] == free);
    let of_cubes = session.world().impacts() == 1;
    assert!(of_cubes, "{} impacts", session.world().impacts());
    for now in all {
        assert!(
            now.distance(free) < 1e-9 * free.length(),
            "{now} is not {free}"
        );
    }
}
