//! The program as a process among others: closed pipes, terminals, limits, and no display.

use std::fs;
use std::io::Read;
use std::process::{Command, Stdio};

mod kit;

use kit::{ACTING, answer, cowbell, file, nothing_acts, refusal};

#[test]
fn closed_stdout_is_no_failure() {
    for arguments in [
        &["run", "cube-cow", "--steps", "1"][..],
        &["run", "cube-cow", "--steps", "1", "--json"],
        &["--help"],
        &["--version"],
    ] {
        let mut child = cowbell(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(child.stdout.take());
        let mut complaint = String::new();
        if let Some(mut stderr) = child.stderr.take() {
            stderr.read_to_string(&mut complaint).expect("text");
        }
        let status = child.wait().expect("the program ends");
        assert_eq!(status.code(), Some(0), "{arguments:?}: {complaint}");
        assert_eq!(complaint, "");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_says_so() {
    let displays: [&[(&str, &str)]; 4] = [
        &[],
        &[("DISPLAY", ":4242")],
        &[("WAYLAND_DISPLAY", "nowhere")],
        &[("DISPLAY", "no.such.host:0")],
    ];
    for display in displays {
        let mut command = cowbell(&[]);
        command
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .envs(display.iter().copied());
        let text = refusal(command, 3);
        assert!(text.contains("cowbell run cube-cow"), "{text}");
    }
}

#[test]
fn names_and_arguments_do_not_act_on_the_terminal() {
    let name = ACTING
        .replace('\u{1b}', "\\u001b")
        .replace('\u{7}', "\\u0007");
    for name in [name, "x".repeat(65_536)] {
        let text = format!(
            "rate = 60\ntitle = \"{name}\"\n[[body]]\nname = \"{name}\"\nsphere = 1\nvelocity = [9, 0, 0]\n\
             [[body]]\nname = 'b'\nsphere = 1\nposition = [2.1, 0, 0]\n"
        );
        let path = file("acts.toml", &text);
        let path_text = path.to_string_lossy();
        for json in [&["--json"][..], &[]] {
            let output = answer(&[&["run", &path_text, "--steps", "9"][..], json].concat());
            assert_eq!(output.status.code(), Some(0));
            nothing_acts(&output);
        }
        fs::remove_file(path).expect("the file is removed");
    }
    for word in [ACTING.to_owned(), "x".repeat(100_000)] {
        for arguments in [
            &["run", &word][..],
            &["run", "cube-cow", "--method", &word],
            &["run", "cube-cow", "--steps", &word],
            &["check", &word],
            &[&word, &word],
            &["shot", "cube-cow", "--select", &word, "-o", "x.png"],
        ] {
            let text = refusal(cowbell(arguments), 2);
            assert!(text.len() <= 1024, "{} bytes", text.len());
            nothing_acts(&answer(arguments));
        }
    }
}

/// A file that may not grow is an error, as a full disk is: the program does not die of it.
#[cfg(unix)]
#[test]
fn a_limit_on_files_is_an_error_in_words() {
    let path = std::env::temp_dir().join(format!("cowbell-limit-{}", std::process::id()));
    let script = "ulimit -f 0; exec \"$0\" run parabola --steps 1 --json > \"$1\"";
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_cowbell")])
        .arg(&path)
        .output()
        .expect("a shell");
    let _ = std::fs::remove_file(&path);
    let text = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.starts_with("cowbell: cannot write the result: "),
        "{text}"
    );
}
