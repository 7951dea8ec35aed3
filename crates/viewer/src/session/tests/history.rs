//! Undo, redo, and the question before edits are lost.

use std::path::PathBuf;

use super::*;
use crate::session::Leaving;
use crate::words::Language;
use scene::SceneShape;

const LONG: Duration = Duration::from_secs(1);

fn edited() -> Session {
    let mut session = session();
    session.select(Some(0));
    for mass in [2.0, 3.0, 4.0] {
        // A drag: changes in quick succession.
        session.set_mass(mass);
        session.settle(FRAME);
    }
    session.settle(LONG);
    session.set_velocity(DVec3::Y);
    session.settle(LONG);
    session
}

#[test]
fn edits_are_taken_back_and_done_again_one_by_one() {
    let mut session = edited();
    let state = |session: &Session| (session.world().mass(0), session.world().velocity(0));
    let begin = (1.0, DVec3::new(2.0, 0.0, 0.0));
    assert_eq!(state(&session), (4.0, DVec3::Y));
    session.undo();
    assert_eq!(state(&session), (4.0, begin.1));
    session.undo();
    assert_eq!(state(&session), begin, "a drag is one edit");
    assert!(!session.can_undo() && session.can_redo());
    session.undo();
    assert_eq!(state(&session), begin);
    session.redo();
    session.redo();
    assert_eq!(state(&session), (4.0, DVec3::Y));
    assert!(!session.can_redo());
    session.undo();
    session.set_restitution(0.5);
    assert!(
        !session.can_redo(),
        "another edit leaves nothing to do again"
    );
    session.undo();
    assert_eq!(
        session.world().restitution(0),
        1.0,
        "one under way is taken back too"
    );
}

#[test]
fn bodies_forces_and_settings_come_back() {
    let mut session = session();
    let before = session.scene().clone();
    session.add("ball", scene::SceneShape::Sphere { radius: 0.5 });
    session.settle(LONG);
    session.set_rate(240.0);
    session.settle(LONG);
    session.select(Some(0));
    session.delete_selected();
    session.settle(LONG);
    session.add_force(sim_core::Force::Gravity {
        acceleration: -DVec3::Y,
    });
    session.settle(LONG);
    session.start();
    advance(&mut session, FRAME, free());
    for _ in 0..4 {
        session.undo();
    }
    assert_eq!(*session.scene(), before);
    assert_eq!(session.world().len(), 2);
    assert_eq!(session.world().settings().dt, before.dt);
    assert_eq!(
        (session.state(), session.world().steps()),
        (State::Layout, 0)
    );
    session.start();
    advance(&mut session, Duration::from_millis(100), free());
    assert_eq!(session.world().steps(), 6, "the clock has the old step");
}

#[test]
fn edits_are_not_lost_without_a_question() {
    let mut untouched = session();
    untouched.leave(Leaving::Open(PathBuf::from("parabola")));
    assert_eq!(untouched.scene().name, "parabola");
    untouched.leave(Leaving::Close);
    assert!(untouched.is_closing());

    let mut session = edited();
    assert!(session.is_changed());
    session.leave(Leaving::Open(PathBuf::from("parabola")));
    assert!(session.leaving().is_some() && session.scene().name != "parabola");
    session.stay();
    assert_eq!((session.leaving(), session.world().mass(0)), (None, 4.0));
    session.leave(Leaving::Close);
    assert!(!session.is_closing());
    session.leave_unsaved();
    assert!(session.is_closing());

    let folder = std::env::temp_dir().join(format!("cowbell-history-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    let mut session = edited();
    session.save(&folder.join("mine.toml"), false);
    assert!(!session.is_changed());
    session.set_velocity(DVec3::X);
    assert!(session.is_changed(), "at once, not only when it is done");
    session.leave(Leaving::Open(PathBuf::from("parabola")));
    session.save_and_leave();
    assert_eq!(session.scene().name, "parabola");
    session.open(folder.join("mine.toml"));
    assert_eq!(session.world().velocity(0), DVec3::X);
    session.set_mass(9.0);
    session.undo();
    assert!(!session.is_changed(), "back at what was saved");
    std::fs::remove_dir_all(&folder).expect("the folder is still there");
}

#[test]
fn a_file_that_has_changed_is_read_again_but_not_over_edits() {
    let folder = std::env::temp_dir().join(format!("cowbell-reread-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("cubes.toml");
    let text = "title = \"t\"\nrate = 60\n[[body]]\nname = \"a\"\nmesh = \"cube.obj\"\n";
    std::fs::write(&path, text).expect("written");
    let mut session = session();
    session.open(&path);
    session.reread();
    assert_eq!(session.notices().iter().count(), 0, "nothing has changed");
    std::fs::write(&path, text.replace("60", "50")).expect("written");
    session.reread();
    assert_eq!(session.scene().dt, 1.0 / 50.0);
    assert!(!session.is_changed());
    std::fs::write(&path, "rate = ").expect("written");
    session.reread();
    assert_eq!(
        session.scene().dt,
        1.0 / 50.0,
        "a wrong file changes nothing"
    );
    assert!(session.notices().iter().any(|notice| notice.error));
    session.select(Some(0));
    session.set_mass(2.0);
    std::fs::write(&path, text).expect("written");
    session.reread();
    assert_eq!(session.world().mass(0), 2.0, "edits are kept");
    assert!(session.notices().iter().any(|notice| notice.error));
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn what_was_saved_here_is_not_read_again() {
    let folder = std::env::temp_dir().join(format!("cowbell-own-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let mesh = folder.join("flat.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    let mut session = session();
    session.take_in(&mesh);
    session.settle(Duration::from_secs(1));
    session.add("ball", SceneShape::Sphere { radius: 0.5 });
    session.settle(Duration::from_secs(1));
    session.save(&folder.join("mine.toml"), false);
    assert_eq!(session.scene().name, "mine");
    session.step_once();
    advance(&mut session, FRAME, free());
    session.save_own();
    session.reread();
    assert_eq!(session.world().steps(), 1, "the run goes on");
    session.undo();
    assert_eq!(session.world().len(), 3, "edits can be taken back");
    assert_eq!(session.scene().name, "mine");
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_scene_outlives_its_files() {
    let folder = std::env::temp_dir().join(format!("cowbell-gone-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let (path, mesh) = (folder.join("mine.toml"), folder.join("cow.obj"));
    let cube = |size: f64| {
        let corners = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        let corners =
            corners.map(|[x, y, z]| format!("v {} {} {}\n", size * x, size * y, size * z));
        corners.concat() + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    };
    std::fs::write(&mesh, cube(1.0)).expect("written");
    let text = "rate = 60\n[[body]]\nname = 'a'\nmesh = 'cow.obj'\n";
    std::fs::write(&path, text).expect("written");
    let mut session = session();
    session.open(&path);
    let files: Vec<_> = session.files().map(Path::to_path_buf).collect();
    assert_eq!(files, [path.clone(), mesh.clone()]);
    let told = |session: &mut Session, what: &str| {
        let text = session
            .notices()
            .iter()
            .find(|notice| notice.about == "file");
        let text = text.map(|notice| notice.text.clone()).unwrap_or_default();
        assert!(text.contains(what), "{text}, not {what}");
        assert!(
            text.is_empty() || Language::Chinese.translated(&text).is_some(),
            "{text}"
        );
    };
    let triangles = |session: &Session| {
        let mesh = session.scene().bodies[0].mesh().expect("a mesh").mesh();
        mesh.triangles().len()
    };

    // No file has the scene now, so the user is asked before leaving it.
    std::fs::remove_file(&path).expect("it was there");
    session.reread();
    told(&mut session, "mine.toml is gone.");
    assert!(session.is_changed());
    session.leave(Leaving::Close);
    assert!(!session.is_closing());
    session.stay();
    std::fs::write(&path, text).expect("written");
    session.reread();
    told(&mut session, "");
    assert!(!session.is_changed(), "it is back");

    // If the file comes back with other contents, it is read again, because there were no edits.
    std::fs::remove_file(&path).expect("it was there");
    session.reread();
    std::fs::write(&path, text.replace("60", "50")).expect("written");
    session.reread();
    told(&mut session, "was read again");
    assert_eq!(session.scene().dt, 1.0 / 50.0);

    // The built-in mesh of that name does not replace a deleted file.
    std::fs::remove_file(&mesh).expect("it was there");
    session.reread();
    told(&mut session, "cow.obj is gone.");
    assert_eq!(triangles(&session), 4);
    session.save_own();
    told(&mut session, "cow.obj is gone.");
    std::fs::write(&mesh, cube(2.0)).expect("written");
    session.reread();
    told(&mut session, "was read again");
    assert_eq!(
        session.scene().bodies[0]
            .mesh()
            .expect("a mesh")
            .mesh()
            .bounds()
            .max
            .x,
        2.0
    );

    // After it is saved to the same path, a file has it again.
    std::fs::remove_file(&path).expect("it was there");
    session.reread();
    session.save_own();
    assert!(!session.is_changed());
    assert!(Scene::load(&path).is_ok());
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_scene_that_came_from_a_file_is_saved_to_it() {
    let name = format!("cowbell-own-{}.toml", std::process::id());
    let path = std::env::temp_dir().join(name);
    let text = "rate = 60\n[[body]]\nname = \"cube\"\nmesh = \"cube.obj\"\n";
    std::fs::write(&path, text).expect("a file can be written");
    let scene = Scene::load(&path).expect("a scene");
    let mut session = Session::of_file(scene, &path).expect("a world");
    session.select(Some(0));
    session.set_mass(7.0);
    session.settle(LONG);
    session.save_own();
    let saved = Scene::load(&path).expect("a scene");
    assert_eq!(saved.bodies[0].mass, 7.0);
    assert!(!session.is_changed());
    std::fs::remove_file(&path).expect("it is there");
    let gallery = Scene::load("spring").expect("in the gallery");
    let session = Session::of_file(gallery, Path::new("spring")).expect("a world");
    assert_eq!(session.file(), None, "it comes with the program");
}
