//! Every text in both languages.

use std::path::Path;

use egui::{Key, Modifiers};
use scene::{Scene, mesh_file};
use viewer::session::Session;
use viewer::words::Language;

use crate::{Window, click, go_on, has_chinese, opened, texts, window};

/// What is the same in every language: names, and what scenes of the gallery call their bodies.
const COMMON: [&str; 53] = [
    "BVH", "RK4", "CSV", "PNG", "Hz", "Verlet", "Blanes", "Moan", "Kahan", "Li", "Radau", "IIA",
    "Dormand", "Prince", "English", "Ctrl", "Shift", "Alt", "Esc", "Del", "PgDn", "Home", "kg",
    "ms", "mm", "toml", "cow", "cube", "cube-cow", "obj", "Page", "Down", "left", "plate",
    "bullet", "right", "light", "heavy", "sphere", "kin", "pot", "cos", "sin", "mu", "dt", "dx",
    "inf", "cm", "kB", "rad", "racket", "Cowbell", "Apache",
];

/// The words of a text that are of no language but English.
fn english(text: &str) -> Vec<&str> {
    // So egui calls parts of its own for assistive technology, in English only.
    let of_egui = text.starts_with("Resize ") || ["Close window", "Color"].contains(&text);
    let is_colour = text.starts_with('#');
    if of_egui || is_colour {
        return Vec::new();
    }
    let words = text.split(|c: char| !c.is_ascii_alphabetic());
    let words = words.filter(|word| word.len() > 1 && word.chars().any(|c| c.is_ascii_lowercase()));
    words.filter(|word| !COMMON.contains(word)).collect()
}

#[test]
fn every_panel_is_chinese_when_chinese_is_chosen() {
    let mut left = std::collections::BTreeSet::new();
    let mut look = |window: &Window<'_>| {
        let texts = texts(window).into_iter();
        left.extend(texts.filter(|text| !english(text).is_empty()));
    };
    for name in ["cube-cow", "bullet", "two-cubes", "tennis-racket"] {
        let scene = Scene::load(name).expect("in the gallery");
        // High enough for the whole panel.
        let mut window = window(Session::new(scene).expect("a world"), [1360.0, 2500.0]);
        if !has_chinese(&mut window) {
            return;
        }
        window.state_mut().0.set_language(Language::Chinese);
        let session = &mut window.state_mut().1;
        session.select(Some(0));
        session.compare.on = true;
        session.display.bvh.shown = true;
        session.display.descent = Some(0);
        window.run();
        look(&window);
        // With boxes that meet, pair by pair.
        window.key_press(Key::K);
        window.run();
        look(&window);
        click(&mut window, "▶ 开始");
        go_on(&mut window, 1.0);
        click(&mut window, "比较…");
        click(&mut window, "课程的四种方法");
        go_on(&mut window, 0.2);
        window.key_press(Key::H);
        window.key_press_modifiers(Modifiers::COMMAND, Key::T);
        window.run();
        look(&window);
        for key in [Key::G, Key::P] {
            window.key_press_modifiers(Modifiers::COMMAND, key);
            window.run();
            look(&window);
        }
    }
    assert!(left.is_empty(), "{left:#?}");
}

#[test]
fn no_panel_is_chinese_when_english_is_chosen() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(0));
    window.run();
    for text in texts(&window) {
        let foreign = text.chars().any(|c| ('\u{4e00}'..='\u{9fff}').contains(&c));
        assert!(!foreign || text == "中文", "{text}");
    }
}

/// Names of parts of the window, of fonts, files and subjects of messages: nothing that is shown.
const UNSEEN: &[&str] = &[
    "notices",
    "bar",
    "name",
    "field",
    "compare",
    "toml",
    "run",
    "dock",
    "figures",
    "csv",
    "png",
    "export",
    "refused number",
    "add force",
    "gallery",
    "../../../../assets/pictures/",
    ".png",
    "all keys",
    "keys",
    "number",
    "panel",
    "palette",
    "time of the plots",
    "precision",
    "question",
    "dialog",
    "recent",
    "cube.obj",
    "cow.obj",
    "integrator",
    "zh-Hans",
    "time",
    "tour",
    "answer",
    "presets",
    "variant method",
    "variant collision",
    "variants",
    "handle",
    "open",
    "language",
];

/// The literals of a source file, without those of its tests, with `{}` for each part that is filled in.
fn literals(source: &str) -> Vec<String> {
    let source = source.split("#[cfg(test)]").next().unwrap_or_default();
    let mut literals = Vec::new();
    for line in source.lines() {
        assert!(
            !line.contains("r#\""),
            "a raw string is not understood here: {line}"
        );
    }
    let code: String = source
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .map(|line| format!("{line}\n"))
        .collect();
    let mut rest = code.as_str();
    while let Some(start) = rest.find('"') {
        // The character '"'.
        if rest[..start].ends_with('\'') && rest[start + 1..].starts_with('\'') {
            rest = &rest[start + 1..];
            continue;
        }
        let mut text = String::new();
        let mut braces = 0;
        let mut end = rest.len();
        let mut chars = rest[start + 1..].char_indices();
        while let Some((at, c)) = chars.next() {
            match c {
                '"' => {
                    end = start + at + 2;
                    break;
                }
                '\\' => match chars.next() {
                    Some((_, 'n')) => text.push('\n'),
                    // The line goes on after the spaces of the next one.
                    Some((_, '\n')) => {
                        while chars.as_str().starts_with(' ') {
                            chars.next();
                        }
                    }
                    Some((_, other)) => text.push(other),
                    None => {}
                },
                '{' => {
                    braces += 1;
                    text.push('{');
                }
                '}' => {
                    braces -= 1;
                    text.push('}');
                }
                _ if braces > 0 => {}
                _ => text.push(c),
            }
        }
        literals.push(text);
        rest = &rest[end..];
    }
    literals
}

#[test]
fn every_text_in_the_sources_of_the_panels_is_in_the_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/ui");
    let scene_names: Vec<&str> = scene::SCENES.iter().map(|entry| entry.name).collect();
    let method_names: Vec<&str> = sim_core::METHODS.iter().map(|method| method.name).collect();
    let mut seen = 0;
    let mut missing = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the panels") {
        let path = entry.expect("a file").path();
        let source = std::fs::read_to_string(&path).expect("its text");
        for text in literals(&source) {
            let unseen = UNSEEN.contains(&text.as_str())
                || scene_names.contains(&text.as_str())
                || method_names.contains(&text.as_str());
            if unseen || english(&text).is_empty() {
                continue;
            }
            seen += 1;
            if Language::Chinese.translated(&text).is_none() {
                missing.push(format!("{}: {text}", path.display()));
            }
        }
    }
    assert!(seen > 250, "{seen} texts");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn every_hint_is_said_in_the_language_of_the_window() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/ui");
    let mut unsaid = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the panels") {
        let path = entry.expect("a file").path();
        let source = std::fs::read_to_string(&path).expect("its text");
        let hints = source.split("hover_text(").skip(1).map(str::trim_start);
        let bare = hints.filter(|hint| hint.starts_with('"'));
        unsaid.extend(bare.map(|hint| format!("{}: {:.60}", path.display(), hint)));
    }
    assert!(unsaid.is_empty(), "{}", unsaid.join("\n"));
}

#[test]
fn every_message_of_the_session_is_in_the_table() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = vec![source.join("app.rs")];
    for folder in ["session", "session/record"] {
        let entries = std::fs::read_dir(source.join(folder)).expect("the session");
        files.extend(entries.map(|entry| entry.expect("a file").path()));
    }
    let mut seen = 0;
    let mut missing = Vec::new();
    for path in files {
        // The texts of the tour are tried with the other tables.
        if path.is_dir() || path.ends_with("tests.rs") || path.ends_with("tour.rs") {
            continue;
        }
        let source = std::fs::read_to_string(&path).expect("its text");
        for text in literals(&source) {
            let is_message = text.contains(' ')
                && text.ends_with('.')
                && text.starts_with(|c: char| c.is_uppercase());
            seen += usize::from(is_message);
            if is_message && Language::Chinese.translated(&text).is_none() {
                missing.push(format!("{}: {text}", path.display()));
            }
        }
    }
    assert!(seen > 25, "{seen} messages");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn every_refusal_of_the_library_is_in_the_table() {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sim-core/src");
    let mut seen = 0;
    let mut missing = Vec::new();
    for file in [
        "world/error.rs",
        "mesh/error.rs",
        "force.rs",
        "inertia/mod.rs",
        "rotation/flight.rs",
    ] {
        let source = std::fs::read_to_string(library.join(file)).expect("its text");
        for attribute in source.split("#[error(").skip(1) {
            let attribute = attribute.split(")]").next().unwrap_or_default();
            let text = literals(attribute).remove(0);
            // What is filled in at the end may be nothing.
            let forms = [text.as_str(), text.trim_end_matches("{}")];
            let known = forms
                .iter()
                .any(|text| Language::Chinese.translated(text).is_some());
            seen += 1;
            if !known {
                missing.push(format!("{file}: {text}"));
            }
        }
    }
    assert!(seen > 30, "{seen} refusals");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Parts that messages are put together from, and what only programmers see.
const UNSEEN_OF_FILES: &[&str] = &[
    "{}{}: {}{}",
    "scene `{}`: {}{}",
    "body `{}`, {}: ",
    "body `{}`: ",
    "number {}",
    "force {}",
    "force {}, {}",
    "<{} id=\"{}\">",
    "<{}> in <{} id=\"{}\">",
    "> or <",
    " or ",
    "; a body that nothing moves is `immovable = true`",
    "must be from 1e-3 to 1e9 Hz",
    "must be from 1e-9 to 1e3 s",
    "{}, is {}",
    "duplicate key",
    " `{}`: give it once",
    "floating-point number overflowed",
    ": give one within ±1e100",
    "expected usize",
    "expected u64",
    "expected a whole number from 0",
    "rate = 60",
    "Wavefront OBJ",
    "a built-in mesh is valid",
    "strings, numbers and arrays of them have a TOML form",
];

/// The source files in a folder and those below it.
fn sources(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("a file").path());
    let of = |path: std::path::PathBuf| match path.is_dir() {
        true => sources(&path),
        false => vec![path],
    };
    paths.flat_map(of).collect()
}

#[test]
fn every_refusal_of_a_file_is_in_the_table() {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scene/src");
    let mut seen = 0;
    let mut missing = Vec::new();
    for path in sources(&library) {
        let source = std::fs::read_to_string(&path).expect("its text");
        for text in literals(&source) {
            // The path is a text of its own.
            let what = text.strip_prefix("{}: ").unwrap_or(&text);
            let is_seen = text.contains(' ')
                && !english(&text).is_empty()
                && !UNSEEN_OF_FILES.contains(&text.as_str());
            seen += usize::from(is_seen);
            let forms = [text.as_str(), what];
            let mut known = forms.iter().map(|text| Language::Chinese.translated(text));
            if is_seen && known.all(|known| known.is_none()) {
                missing.push(format!("{}: {text}", path.display()));
            }
        }
    }
    assert!(seen > 120, "{seen} refusals");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn a_refusal_of_a_file_is_told_with_its_place() {
    let body = "[[body]]\nname = 'a'\nmesh = 'cube.obj'\n";
    let scene = |text: &str| {
        let parsed = Scene::parse(text, Path::new("s/a.toml"));
        parsed.map_or_else(|error| error.to_string(), |_| text.to_owned())
    };
    let mesh = |name: &str, text: &str| {
        let path = Path::new(name);
        let format = mesh_file::Format::of(path).expect("a format");
        let read = mesh_file::read(format, path, text.as_bytes());
        read.map_or_else(|error| error.to_string(), |_| text.to_owned())
    };
    for (refusal, told) in [
        (
            scene(""),
            "s/a.toml：缺少步长：请在物体之前给出 `rate = 60` (Hz) 或 `dt = 0.2` (s)",
        ),
        (
            scene("rate = 0"),
            "s/a.toml:1：rate：必须在 1e-3 与 1e9 Hz 之间，现在是 0",
        ),
        (
            scene(&format!("rate = 60\n{body}mass = -1")),
            "s/a.toml:5：物体 `a`，mass：必须是大于 0 的质量，以 kg 计（从 1e-100 到 1e100），现在是 -1",
        ),
        (
            scene(&format!("rate = 60\n{body}mass = inf")),
            "s/a.toml:5：物体 `a`，mass：必须是大于 0 的质量，以 kg 计（从 1e-100 到 1e100），现在是 inf；不受任何作用的物体是 `immovable = true`",
        ),
        (
            scene(&format!("rate = 60\n{body}mass = 'x'")),
            "s/a.toml:5：物体 `a`，mass：类型不对：这里是字符串 \"x\"，应为一个数",
        ),
        (
            scene(&format!("rate = 60\n{body}scale = 1e-60")),
            "s/a.toml:5：物体 `a`，scale：是 [1e-60, 1e-60, 1e-60]：网格会什么也不剩；请给出更接近 1 的数",
        ),
        (
            scene(
                "rate = 60\n[[force]]\nkind = 'push'\nbody = 'b'\npoint = [0,0,0]\nforce = [0,0,0]",
            ),
            "s/a.toml:4：力 1，body：没有物体 `b`",
        ),
        (
            mesh("a.obj", "v 0 0 0\nv 0 x 0"),
            "a.obj:2：顶点的 y 是 `x`：必须是小于 3.4e38 的有限数",
        ),
        (
            mesh("a.obj", "v 0 0 0\nf 1 2 3"),
            "a.obj:2：一个面使用顶点 3，但顶点是 1 到 1，或从最后一个往回的 -1 到 -1",
        ),
        (
            mesh("a.obj", "v 0 0 0\nf 1 1 1"),
            "a.obj：网格没有面积大于零的三角形：至少需要一个",
        ),
        (
            mesh("b.PLY", "ply\nformat ascii 2.0\n"),
            "b.PLY:2：版本是 `2.0`：只知道 1.0",
        ),
        (
            mesh("c.stl", "solid\nvertex 0 0 0\n"),
            "c.stl:2：`vertex` 所在之处应为 `facet`、`outer loop`、`endfacet` 或 `endsolid`",
        ),
        (
            mesh("d.dae", "<COLLADA version='3.0'/>"),
            "d.dae:1：<COLLADA>：版本是 `3.0`：只知道 1.4 和 1.5",
        ),
    ] {
        let said = Language::Chinese.translated(&refusal);
        assert_eq!(said.as_deref(), Some(told), "{refusal}");
    }
}
