//! Following, the home view, and bodies out of view.

use super::*;

#[test]
fn the_camera_goes_along_and_comes_home() {
    let mut session = session();
    let home = session.camera;
    session.select(Some(0));
    session.follow(true);
    session.start();
    for _ in 0..30 {
        advance(&mut session, FRAME, free());
        session.picture();
    }
    session.pause();
    session.picture();
    let went = session.shown_position(0) - DVec3::new(-3.0, 0.0, 0.0);
    assert!(went.x > 0.5);
    assert!((session.camera.target - home.target - went).length() < 1e-9);
    session.go_home();
    assert!(session.camera == home && !session.is_following());
}

#[test]
fn what_has_left_the_view_is_pointed_out() {
    let mut session = session();
    assert!(session.out_of_view(1.5).is_empty());
    session.select(Some(0));
    session.set_position(DVec3::new(500.0, 0.0, 0.0));
    let out = session.out_of_view(1.5);
    assert!(
        matches!(out[..], [out] if out.body == 0 && out.towards[0] > 1.0),
        "{out:?}"
    );
    // Behind the eye.
    let eye = session.camera.eye();
    let behind = eye - 5.0 * session.camera.forward() + session.camera.axes()[0];
    session.set_position(behind);
    let out = session.out_of_view(1.5);
    assert!(matches!(out[..], [out] if out.towards[0] > 0.0), "{out:?}");
}

#[test]
fn a_body_hides_what_is_behind_it_and_nothing_else() {
    let mut session = session();
    for parallel in [false, true] {
        session.camera.parallel = parallel;
        // The target is a cube of edge 1 m at the origin.
        let forward = session.camera.forward();
        for (point, hidden) in [
            (2.0 * forward, true),
            (-2.0 * forward, false),
            (DVec3::new(0.0, 3.0, 0.0), false),
        ] {
            let [x, y] = session.camera.project(point, 1.5).expect("it is seen");
            let ray = session.camera.ray(x, y, 1.5);
            assert_eq!(session.hides(point, ray), hidden, "{point}, {parallel}");
        }
    }
}

#[test]
fn the_arrow_of_an_impact_is_on_what_moves() {
    let text = "rate = 60\n[[body]]\nname = \"ball\"\nsphere = 0.5\nposition = [0, 1, 0]\nvelocity = [0, -5, 0]\n\
                [[body]]\nname = \"floor\"\nhalf-space = [0, 1, 0]";
    let scene = Scene::parse(text, Path::new("f.toml")).expect("a scene");
    let mut session = Session::new(scene).expect("a world");
    for _ in 0..7 {
        session.step_once();
        advance(&mut session, FRAME, free());
    }
    assert_eq!(session.world().impacts(), 1);
    let marks = session.picture().marks;
    assert!(
        !marks.is_empty() && marks.iter().all(|line| line.to.y >= -1e-9),
        "{marks:?}"
    );
}

#[test]
fn sides_look_along_the_axes() {
    use crate::session::Side;
    let mut session = session();
    for (side, forward, right) in [
        (Side::Front, DVec3::NEG_Z, DVec3::X),
        (Side::Right, DVec3::NEG_X, DVec3::NEG_Z),
        (Side::Top, DVec3::NEG_Y, DVec3::X),
    ] {
        session.look_from(side);
        assert!(
            (session.camera.forward() - forward).length() < 1e-12,
            "{side:?}"
        );
        assert!(
            (session.camera.axes()[0] - right).length() < 1e-12,
            "{side:?}"
        );
    }
}
