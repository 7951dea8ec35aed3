//! Tunnelling, which the discrete modes do not see.

use super::*;
use crate::session::Remedy;

fn bullet(shape: &str, plate: &str, collision: &str) -> Session {
    let text = format!(
        "rate = 60\ncollision = \"{collision}\"\n[[body]]\nname = \"bullet\"\n{shape}\nvelocity = [1000, 0, 0]\n\
         [[body]]\nname = \"plate\"\n{plate}\nposition = [8, 0, 0]\nimmovable = true"
    );
    let scene = Scene::parse(&text, Path::new("b.toml")).expect("a scene");
    let mut session = Session::new(scene).expect("a world");
    for _ in 0..3 {
        session.step_once();
        advance(&mut session, FRAME, free());
    }
    session
}

#[test]
fn a_pass_between_two_steps_is_told_and_drawn_for_every_shape() {
    let (cube, ball) = ("mesh = \"cube.obj\"\nscale = 0.5", "sphere = 0.25");
    let thin = "mesh = \"cube.obj\"\nscale = [0.001, 3, 3]";
    // `gap` is the distance from the bullet's front to the front of its target, m.
    for (shape, plate, thickness, gap) in [
        (cube, thin, "1.00 mm", 8.0 - 0.25 - 0.0005),
        (ball, thin, "1.00 mm", 8.0 - 0.25 - 0.0005),
        (cube, "sphere = 0.2", "0.40 m", 8.0 - 0.25 - 0.2),
        (ball, "sphere = 0.2", "0.40 m", 8.0 - 0.25 - 0.2),
    ] {
        for how in ["bvh", "naive"] {
            let mut session = bullet(shape, plate, how);
            let times: Vec<f64> = session.playback().missed_times().collect();
            let exact = gap / 1000.0;
            assert!(
                matches!(times[..], [time] if (time - exact).abs() < 1e-9),
                "{shape}, {plate}: {times:?} instead of {exact}"
            );
            let text = complaint(&mut session, "missed").expect("it is told");
            let told = "bullet passed through plate at t = 0.007";
            assert!(text.starts_with(told) && text.contains(thickness), "{text}");
            let notice = session
                .notices()
                .iter()
                .find(|notice| notice.about == "missed");
            let remedy = notice.and_then(|notice| notice.remedy);
            assert_eq!(remedy, Some(Remedy::Collision(Collision::Continuous)));
            session.go_to_impact(false);
            assert!((session.shown_time() - exact).abs() < 1e-9);
            session.go_to(1);
            let picture = session.picture();
            assert_eq!(picture.ghosts.len(), 3, "before, at, and after");
            assert!(!picture.marks.is_empty());
        }
        let session = bullet(shape, plate, "continuous");
        assert_eq!(session.playback().missed_times().count(), 0);
        assert!(session.world().impacts() > 0);
    }
}

#[test]
fn what_is_found_or_only_passes_by_is_not_missed() {
    // Slow enough to be found at the end of a step.
    let mut session = session();
    session.set_collision(Collision::Bvh);
    session.start();
    for _ in 0..120 {
        advance(&mut session, FRAME, free());
    }
    assert!(session.world().impacts() > 0);
    assert_eq!(session.playback().missed_times().count(), 0);
    let aside = "mesh = \"cube.obj\"\nscale = [0.001, 3, 3]\nrotation = [0, 0, 0]";
    let by = bullet("mesh = \"cube.obj\"\nposition = [0, 9, 0]", aside, "bvh");
    assert_eq!(by.playback().missed_times().count(), 0);
}
