//! What comes from outside and means no good: text that would act on a terminal, files that are no
//! files, disks that are full.

use std::fs;
use std::path::Path;

use scene::{Scene, SceneError, mesh_file, shown};

const HOSTILE: &str = "\\u001b]0;x\\u0007\\n\\u202Eforged\\u009b2J";

fn refusal(text: &str) -> String {
    let error = Scene::parse(text, Path::new("bad.toml")).expect_err(text);
    error.to_string()
}

fn fit_to_be_shown(text: &str) {
    assert!(!text.contains(shown::is_unsafe), "{text}");
    assert!(text.len() <= 1000, "{} bytes", text.len());
}

/// Scenes with a word of the caller's in each place that a message may repeat.
fn scenes_with(word: &str) -> Vec<String> {
    let body = format!("rate = 60\n[[body]]\nname = \"{word}\"\n");
    let ball = "rate = 60\n[[body]]\nname = 'a'\nsphere = 1\n";
    vec![
        format!("{body}sphere = -1\n"),
        format!("{body}sphere = 1\n[[body]]\nname = \"{word}\"\nsphere = 1\n"),
        format!("{body}mesh = \"cube.obj\"\nscale = 1e39\n"),
        format!("{body}mesh = \"{word}.obj\"\n"),
        format!("{body}mesh = \"{word}\"\n"),
        format!("rate = 60\nmethod = \"{word}\"\n"),
        format!("rate = 60\ncollision = \"{word}\"\n"),
        format!("rate = 60\n\"{word}\" = 1\n"),
        format!("rate = 60\n\"{word}\" = 1\n\"{word}\" = 1\n"),
        format!("rate = \"{word}\"\n"),
        format!("{ball}colour = \"{word}\"\n"),
        format!("{ball}\"{word}\" = 1\n"),
        format!("{ball}[[force]]\nkind = \"{word}\"\n"),
        format!("{ball}[[force]]\nkind = 'spring'\nbodies = ['a', \"{word}\"]\nstiffness = 1\n"),
        format!("{ball}[[force]]\nkind = 'gravity'\nacceleration = [0, 0, 0]\n\"{word}\" = 1\n"),
    ]
}

#[test]
fn no_word_of_a_scene_acts_or_fills_the_screen() {
    for word in [HOSTILE.to_owned(), "x".repeat(1_000_000)] {
        for text in scenes_with(&word) {
            let message = refusal(&text);
            fit_to_be_shown(&message);
            assert!(message.starts_with("bad.toml:"), "{message}");
        }
    }
}

#[test]
fn no_path_acts_or_fills_the_screen() {
    for word in ["\u{1b}]0;x\u{7}\n\u{202e}".to_owned(), "x".repeat(100_000)] {
        for path in [
            word.clone(),
            format!("{word}.toml"),
            format!("/{word}/x.toml"),
        ] {
            fit_to_be_shown(&Scene::load(&path).expect_err("no scene").to_string());
        }
        for ending in ["", "obj", "dae", "stl", "ply", "glb"] {
            let path = format!("{word}.{ending}");
            let error = mesh_file::load(Path::new(&path)).expect_err("no mesh");
            fit_to_be_shown(&error.to_string());
        }
    }
}

#[test]
fn no_word_of_a_mesh_file_acts_or_fills_the_screen() {
    let dae = |inside: &str| format!("<COLLADA>{inside}</COLLADA>");
    for word in ["\u{9b}0m\u{202e}\u{7f}".to_owned(), "x".repeat(1_000_000)] {
        for (ending, text) in [
            ("obj", format!("v 0 0 {word}\n")),
            ("obj", format!("v 0 0 0\nf 1 1 {word}\n")),
            ("obj", format!("v \0 {word} 0\n")),
            ("dae", format!("<{word}/>")),
            ("dae", format!("<a id='{word}'/>")),
            (
                "dae",
                dae(&format!("<asset><up_axis>{word}</up_axis></asset>")),
            ),
            (
                "dae",
                dae(&format!("<asset><unit meter='{word}'/></asset>")),
            ),
            (
                "dae",
                dae(&format!(
                    "<scene><instance_visual_scene url='{word}'/></scene>"
                )),
            ),
            (
                "dae",
                dae(&format!(
                    "<scene><instance_visual_scene url='#{word}'/></scene>"
                )),
            ),
            (
                "dae",
                format!("<?xml version='1.0' encoding='{word}'?><a/>"),
            ),
            ("stl", format!("solid\nouter loop\nvertex 0 0 {word}\n")),
            ("stl", format!("solid\n{word} loop\n")),
            ("ply", format!("ply\n{word}\n")),
            (
                "ply",
                format!(
                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                     property float z\nend_header\n0 0 {word}\n"
                ),
            ),
        ] {
            let path = format!("bad.{ending}");
            let path = Path::new(&path);
            let format = mesh_file::Format::of(path).expect("a format");
            let error = mesh_file::read(format, path, text.as_bytes()).expect_err("no mesh");
            fit_to_be_shown(&error.to_string());
        }
    }
}

#[test]
fn a_mesh_that_cannot_be_made_is_told_with_its_line() {
    for (scale, why) in [
        ("1e39", "beyond"),
        ("1e300", "beyond"),
        ("1e-60", "nothing is left"),
    ] {
        let text = format!("rate = 60\n[[body]]\nname = 'a'\nmesh = 'cube.obj'\nscale = {scale}\n");
        let message = refusal(&text);
        assert!(
            message.starts_with("bad.toml:5: body `a`, scale: "),
            "{message}"
        );
        assert!(
            message.contains(why) && message.contains(scale),
            "{message}"
        );
    }
}

#[test]
fn what_a_world_would_refuse_is_told_with_its_line() {
    let group = |i: usize| {
        format!("[[body]]\nname = 'b{i}'\nsphere = 0\ngroups = ['g{i}']\nposition = [{i}, 0, 0]\n")
    };
    let groups: String = (0..33).map(group).collect();
    let ball = "[[body]]\nname = 'a'\nsphere = 1e30\nmass = 1e60\n";
    for (text, expected) in [
        (groups, ":163: body `b32`, groups: more than 32 groups"),
        (
            format!(
                "{ball}velocity = [1e100, 0, 0]\ncopies = 9\nspeed = 1e100\ninside = [[0, 0, 0], [1e31, 1e31, 1e31]]\n"
            ),
            ":8: body `a`, speed: must be so",
        ),
        (
            format!("{ball}turns = true\nspin = [1, 2, 3]\n"),
            ":7: body `a`, spin: the angular momentum must be",
        ),
        (
            format!("{ball}copies = nan\n"),
            ":6: body `a`, copies: invalid type: floating point `NaN`, expected a whole number from 0",
        ),
        (
            format!("{ball}friction = 1e400\n"),
            ":6: body `a`, friction: floating-point number overflowed: give one within ±1e100",
        ),
    ] {
        let message = refusal(&format!("rate = 60\n{text}"));
        assert!(message.contains(expected), "{message}");
        fit_to_be_shown(&message);
    }
}

#[test]
fn a_key_given_twice_is_named() {
    let message = refusal("rate = 60\nrate = 50\n");
    assert!(
        message.contains(":2: ") && message.contains("`rate`"),
        "{message}"
    );
}

#[test]
fn a_spring_has_two_bodies() {
    let bodies = "rate = 60\n[[body]]\nname = 'a'\nsphere = 0\n[[body]]\nname = 'b'\nsphere = 0\n\
                  position = [1, 0, 0]\n[[force]]\nkind = 'spring'\nstiffness = 1\nbodies = ";
    for (names, count) in [("['a']", 1), ("['a', 'b', 'c']", 3), ("[]", 0)] {
        let message = refusal(&format!("{bodies}{names}\n"));
        let expected =
            format!(":12: force 1, bodies: must be the names of two bodies, has {count}");
        assert!(message.contains(&expected), "{message}");
    }
    assert!(Scene::parse(&format!("{bodies}['a', 'b']\n"), Path::new("good.toml")).is_ok());
}

#[test]
fn a_scene_that_is_not_utf8_is_told_with_its_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("other.toml");
    let utf16 = "rate = 60\n".encode_utf16();
    for (bytes, line) in [
        (b"rate = 60\n\n# \xe4\n".to_vec(), 3),
        (b"rate = 60\n# \0\n".to_vec(), 2),
        (utf16.clone().flat_map(u16::to_le_bytes).collect(), 1),
        (utf16.flat_map(u16::to_be_bytes).collect(), 1),
    ] {
        fs::write(&path, bytes).expect("a file");
        let message = Scene::load(&path).expect_err("not UTF-8").to_string();
        let place = format!("other.toml:{line}: ");
        assert!(
            message.contains(&place) && message.contains("save as UTF-8"),
            "{message}"
        );
    }
}

#[test]
fn a_scene_file_has_a_greatest_size() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("large.toml");
    // A file with a hole: nothing of it is on the disk.
    let file = fs::File::create(&path).expect("a file");
    file.set_len(1 << 32).expect("a length");
    let error = Scene::load(&path).expect_err("too large");
    assert!(matches!(error, SceneError::TooLarge { .. }), "{error}");
}

#[cfg(unix)]
mod unix {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::process::Command;

    use super::*;

    #[test]
    fn pipes_and_devices_are_neither_scenes_nor_meshes() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for ending in ["toml", "obj", "dae", "stl", "ply"] {
            let pipe = at(&format!("pipe.{ending}"));
            let made = Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
            assert!(made.success());
            let device = at(&format!("device.{ending}"));
            symlink("/dev/zero", &device).expect("a link");
            for path in [pipe, device] {
                let message = match ending {
                    "toml" => Scene::load(&path).expect_err("no file").to_string(),
                    _ => mesh_file::load(&path).expect_err("no file").to_string(),
                };
                assert!(message.contains("not a regular file"), "{message}");
            }
        }
    }

    /// Some of them, such as `/proc/kmsg`, end only when the machine does.
    #[cfg(target_os = "linux")]
    #[test]
    fn files_that_the_kernel_makes_up_are_empty() {
        let folder = tempfile::tempdir().expect("a folder");
        for (ending, why) in [("toml", "the step is missing"), ("stl", "has 0 bytes")] {
            let link = folder.path().join(format!("link.{ending}"));
            symlink("/proc/self/status", &link).expect("a link");
            let message = match ending {
                "toml" => Scene::load(&link).expect_err("empty").to_string(),
                _ => mesh_file::load(&link).expect_err("empty").to_string(),
            };
            assert!(message.contains(why), "{message}");
        }
    }

    #[test]
    fn a_path_is_bytes_and_meshes_may_lie_anywhere() {
        let folder = tempfile::tempdir().expect("a folder");
        let inner = folder.path().join(OsStr::from_bytes(b"in\xfc"));
        fs::create_dir(&inner).expect("a folder");
        let path = inner.join(OsStr::from_bytes(b"w\xfcrfel.toml"));
        let cube = mesh_file::BUILTIN_MESHES[0].bytes;
        fs::write(folder.path().join("up.obj"), cube).expect("a mesh");
        symlink(folder.path().join("up.obj"), inner.join("link.obj")).expect("a link");
        let absolute = folder.path().join("up.obj");
        for mesh in ["../up.obj", "link.obj", absolute.to_str().expect("text")] {
            let text = format!("rate = 60\n[[body]]\nname = 'a'\nmesh = '{mesh}'\n");
            fs::write(&path, text).expect("a scene");
            Scene::load(&path)
                .expect("a scene")
                .world()
                .expect("a world");
        }
    }

    #[test]
    fn a_full_disk_is_an_error() {
        let scene = Scene::load("parabola").expect("a gallery scene");
        let error = scene.save(Path::new("/dev/full")).expect_err("no room");
        assert!(matches!(error, SceneError::Write { .. }), "{error}");
    }

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, link) = (
            folder.path().join("a.toml"),
            folder.path().join("link.toml"),
        );
        let scene = Scene::load("parabola").expect("a gallery scene");
        fs::write(&path, "old").expect("a file");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("permissions");
        symlink("a.toml", &link).expect("a link");
        scene.save(&link).expect("saved");
        assert_eq!(fs::read_to_string(&path).expect("text"), scene.to_toml());
        let mode = fs::metadata(&path).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        assert!(fs::symlink_metadata(&link).expect("a link").is_symlink());
        let names = fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(names, 2, "nothing is left beside");
        // Where nothing can be made beside it, the old file stays.
        let error = scene.save(&folder.path().join("no-folder/x.toml"));
        assert!(error.is_err());
    }
}
