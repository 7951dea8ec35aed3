//! Ctrl-C in each command: it ends with the exit code of that, tells what it reached, and leaves whole files or none.

#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;

mod kit;

use kit::{cowbell, file};

/// What comes of a command that is interrupted after some seconds.
fn interrupted(arguments: &[&str], seconds: f64) -> Output {
    let mut command = cowbell(arguments);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(Duration::from_secs_f64(seconds));
    let id = child.id().to_string();
    let killed = Command::new("kill").args(["-INT", &id]).status();
    assert!(killed.expect("kill").success());
    child.wait_with_output().expect("it ends")
}

/// What it has printed, which must have been cut short by the signal and by nothing else.
fn text_of(output: &Output) -> String {
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(130), "{complaint}");
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// What the program says of itself: drivers write there too.
fn own_words(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let own = text.lines().filter(|line| line.starts_with("cowbell: "));
    own.collect::<Vec<_>>().join("\n")
}

/// An empty folder of a test's own.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("cowbell-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&path).expect("a folder");
    path
}

/// The names in a folder, which goes.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the folder");
    let names = entries.map(|entry| entry.expect("a name").file_name());
    let names = names
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    std::fs::remove_dir_all(folder).expect("it is there");
    names
}

#[test]
fn a_run_tells_its_state() {
    let output = interrupted(
        &[
            "run",
            "parabola",
            "--json",
            "--steps",
            "1000000000000000000",
        ],
        2.0,
    );
    let state: Value = serde_json::from_str(&text_of(&output)).expect("JSON");
    assert!(state["steps"].as_u64().is_some_and(|steps| steps > 0));
    let told = own_words(&output);
    assert!(told.starts_with("cowbell: interrupted after "), "{told}");
}

#[test]
fn a_comparison_tells_how_far_its_runs_came() {
    let arguments = ["compare", "parabola", "--json", "--time", "1e9"];
    let output = interrupted(&arguments, 2.0);
    let runs: Value = serde_json::from_str(&text_of(&output)).expect("JSON");
    assert!(
        runs[0]["time"].as_f64().is_some_and(|time| time > 0.0),
        "{runs}"
    );
}

#[test]
fn a_soak_tells_what_it_saw() {
    let output = interrupted(&["soak", "parabola", "--minutes", "60"], 2.0);
    let text = text_of(&output);
    assert_eq!(text.lines().count(), 2, "{text}");
}

#[test]
fn a_replay_tells_how_many_states_were_the_same() {
    let folder = folder("interrupted-replay");
    let path = folder.join("a.run");
    let path = path.to_string_lossy();
    // As long as a run that takes more than twice the time, of steps that take long, so that little is to be read.
    let steps = ["--steps", "4000000"];
    let run = [&["run", "cubes-turning", "--record", &path][..], &steps].concat();
    text_of(&interrupted(&run, 5.0));
    let output = interrupted(&["replay", "--verify", &path], 2.0);
    let text = text_of(&output);
    assert!(text.contains("every state the same"), "{text}");
    let told = own_words(&output);
    assert!(told.starts_with("cowbell: interrupted after "), "{told}");
    assert_eq!(names_in(&folder), ["a.run"]);
}

/// Whether pictures can be drawn here; where they must be, that is not asked.
fn draws() -> bool {
    let path = folder("interrupted-trial");
    let picture = path.join("a.png");
    let picture = picture.to_string_lossy().into_owned();
    let drawn = kit::answer(&["shot", "parabola", "-o", &picture, "--size", "8x8"]);
    names_in(&path);
    let draws = drawn.status.success();
    assert!(
        draws || std::env::var_os("CI").is_none(),
        "nothing draws here"
    );
    draws
}

#[test]
fn pictures_are_of_what_was_reached() {
    if !draws() {
        println!("skipped: no graphics adapter");
        return;
    }
    let many = "1000000000000000";
    let size = ["--size", "64x48"];
    for (name, arguments) in [
        ("a.png", &["shot", "parabola", "--step", many][..]),
        ("b.gif", &["gif", "parabola", "--from", many, "--fps", "50"]),
        (
            "c.gif",
            &["gif", "cubes-turning", "--time", "59", "--fps", "50"],
        ),
    ] {
        let folder = folder(name);
        let path = folder.join(name);
        let path_text = path.to_string_lossy().into_owned();
        let output = interrupted(&[arguments, &["-o", &path_text], &size].concat(), 3.0);
        assert!(text_of(&output).contains(name), "{name}");
        let told = own_words(&output);
        assert!(
            told.starts_with("cowbell: interrupted after "),
            "{name}: {told}"
        );
        let bytes = std::fs::read(&path).expect("a picture");
        let whole = match name.ends_with("gif") {
            true => bytes.starts_with(b"GIF89a") && bytes.ends_with(b";"),
            false => bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xae\x42\x60\x82"),
        };
        assert!(whole, "{name}: {} bytes", bytes.len());
        assert_eq!(names_in(&folder), [name]);
    }
}

/// While a file is read nothing is reached, and nothing has to be waited for.
#[test]
fn what_is_still_being_read_is_left_at_once() {
    let lines = |n: u32| format!("v {n} 0 0\nv {n} 1 0\nv {n} 0 1\nf -1 -2 -3\n");
    let mesh = file(
        "interrupted.obj",
        &(0..400_000).map(lines).collect::<String>(),
    );
    let mesh_text = mesh.to_string_lossy().into_owned();
    let folder = folder("interrupted-reading");
    let picture = folder.join("a.png").to_string_lossy().into_owned();
    for arguments in [
        &["check", &mesh_text][..],
        &["run", &mesh_text],
        &["shot", &mesh_text, "-o", &picture],
    ] {
        let output = interrupted(arguments, 0.3);
        assert_eq!(text_of(&output), "", "{arguments:?}");
        assert_eq!(own_words(&output), "", "{arguments:?}");
    }
    std::fs::remove_file(&mesh).expect("it is there");
    assert!(names_in(&folder).is_empty());
}
