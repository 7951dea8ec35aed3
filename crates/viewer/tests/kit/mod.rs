//! The program as a process, for the tests of it.

// Each test uses a part of these.
#![allow(dead_code, reason = "each file of tests uses some of it")]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

pub(crate) fn cowbell(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cowbell"));
    command.args(arguments).stdin(Stdio::null());
    command
}

pub(crate) fn answer(arguments: &[&str]) -> Output {
    cowbell(arguments).output().expect("the program starts")
}

/// Runs a command that must fail with `code`; its one line on stderr.
pub(crate) fn refusal(mut command: Command, code: i32) -> String {
    let output = command.output().expect("the program starts");
    let text = String::from_utf8(output.stderr).expect("messages are UTF-8");
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert!(output.stdout.is_empty());
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("cowbell: "), "{text}");
    assert!(!text.contains("panicked"), "{text}");
    text
}

/// A file in the folder for temporary files; `name` keeps tests apart.
pub(crate) fn file(name: &str, text: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("cowbell-{}-{name}", std::process::id()));
    fs::write(&path, text).expect("a file can be written");
    path
}

/// Characters that act on a terminal, in one word of a scene or of an argument.
pub(crate) const ACTING: &str = "a\u{1b}]0;x\u{7}\u{9b}\u{202e}";

pub(crate) fn nothing_acts(output: &Output) {
    for bytes in [&output.stdout, &output.stderr] {
        let text = String::from_utf8(bytes.clone()).expect("text");
        let acts = |c: char| c != '\n' && scene::shown::is_unsafe(c);
        assert!(!text.contains(acts), "{text:?}");
    }
}
