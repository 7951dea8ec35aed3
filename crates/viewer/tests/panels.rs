//! The panels, driven as a person would drive them: by what stands on them, and by keys.

use std::path::Path;
use std::time::Duration;

use egui::accesskit::Role;
use egui::{Key, Modifiers, TextureId, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use scene::Scene;
use sim_core::{Collision, Method};
use viewer::session::{LABS, Session, State, stop_count};
use viewer::ui::Ui;
use viewer::words::Language;

/// A window of a size on a session, without a picture in it.
fn window(session: Session, size: [f32; 2]) -> Harness<'static, (Ui, Session)> {
    Harness::builder()
        .with_size(Vec2::from(size))
        .with_context_setup(viewer::ui::apply_style)
        .with_max_steps(60)
        .build_ui_state(
            |root, (ui, session): &mut (Ui, Session)| {
                ui.show(root, session, TextureId::default());
            },
            (Ui::default(), session),
        )
}

/// All texts that stand in the window now.
fn texts(window: &Harness<'_, (Ui, Session)>) -> Vec<String> {
    let nodes = window.root().children_recursive();
    let texts = nodes.flat_map(|node| [node.accesskit_node().label(), node.value()]);
    texts.flatten().collect()
}

/// Whether the system has a font with Chinese characters; where it has none, the window speaks English.
fn has_chinese(window: &mut Harness<'_, (Ui, Session)>) -> bool {
    window.run();
    let has = window.query_by_label("中文").is_some();
    if !has {
        assert!(
            std::env::var_os("CI").is_none(),
            "install a font such as fonts-noto-cjk"
        );
        eprintln!("not tested: no font has Chinese characters");
    }
    has
}

/// Whether a text stands in the window.
fn stands(window: &Harness<'_, (Ui, Session)>, text: &str) -> bool {
    window.query_all_by_label(text).next().is_some()
}

fn opened(name: &str) -> Harness<'static, (Ui, Session)> {
    let scene = Scene::load(name).expect("in the gallery");
    let session = Session::new(scene).expect("a world");
    window(session, [1360.0, 1500.0])
}

/// Lets physics go on for a time, s, in frames of a sixtieth.
fn go_on(window: &mut Harness<'_, (Ui, Session)>, time: f64) {
    for _ in 0..(60.0 * time) as u32 {
        let (_, session) = window.state_mut();
        if let Some(job) = session.due(Duration::from_secs_f64(1.0 / 60.0)) {
            session.accept(job.run(|| Duration::ZERO));
        }
        while let Some(job) = session.variants_due() {
            session.accept_variants(job.run(|| Duration::ZERO));
        }
    }
    window.run();
}

fn click(window: &mut Harness<'_, (Ui, Session)>, label: &str) {
    {
        let mut named = window.query_all_by_label(label);
        // Not what only says the same.
        let button = named.find(|node| node.accesskit_node().role() != Role::Label);
        button.expect(label).click();
    }
    window.run();
}

#[test]
fn the_bar_starts_steps_resets_and_takes_back() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    assert_eq!(window.state().1.state(), State::Running);
    go_on(&mut window, 0.5);
    click(&mut window, "⏸ Pause");
    let steps = window.state().1.world().steps();
    assert!(steps > 20);
    click(&mut window, "⏩ Step");
    go_on(&mut window, 0.1);
    assert_eq!(window.state().1.world().steps(), steps + 1);
    click(&mut window, "⟲ Reset");
    assert_eq!(window.state().1.state(), State::Layout);
    click(&mut window, "floor");
    assert_eq!(window.state().1.world().len(), 3);
    click(&mut window, "⮪");
    assert_eq!(window.state().1.world().len(), 2);
    click(&mut window, "⮫");
    assert_eq!(window.state().1.world().len(), 3);
}

#[test]
fn every_key_does_what_it_says() {
    let mut window = opened("cube-cow");
    window.run();
    let press = |window: &mut Harness<'_, (Ui, Session)>, key| {
        window.key_press(key);
        window.run();
    };
    press(&mut window, Key::Space);
    assert_eq!(window.state().1.state(), State::Running);
    press(&mut window, Key::Space);
    assert_eq!(window.state().1.state(), State::Paused);
    press(&mut window, Key::R);
    press(&mut window, Key::PageDown);
    go_on(&mut window, 0.1);
    assert_eq!(window.state().1.world().steps(), 5);
    press(&mut window, Key::ArrowLeft);
    assert_eq!(window.state().1.world().steps(), 4);
    press(&mut window, Key::V);
    assert!(window.state().1.is_following());
    press(&mut window, Key::Home);
    assert!(!window.state().1.is_following());
    press(&mut window, Key::B);
    assert!(window.state().1.display.bvh.shown);
    assert!(window.query_by_label("PNG").is_some());
    press(&mut window, Key::G);
    assert!(window.query_by_label("PNG").is_none(), "plots are hidden");
    press(&mut window, Key::H);
    assert!(window.query_by_label("Keys and mouse").is_some());
    window.state_mut().1.reset();
    window.state_mut().1.select(Some(0));
    press(&mut window, Key::Delete);
    assert_eq!(window.state().1.world().len(), 1);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run();
    assert_eq!(window.state().1.world().len(), 2);
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    window.run();
    assert_eq!(window.state().1.world().len(), 1);
}

#[test]
fn a_comparison_is_chosen_run_and_given_up() {
    let mut window = opened("five-hertz");
    window.run();
    click(&mut window, "Compare…");
    click(&mut window, "The four methods of the course");
    assert_eq!(window.state().1.variants().iter().len(), 4);
    click(&mut window, "▶ Start");
    go_on(&mut window, 4.1);
    click(&mut window, "⏸ Pause");
    let names = ["⏺ Backward Euler", "⏺ Classical RK4", "⏺ Exact"];
    for name in names {
        assert!(window.query_by_label(name).is_some(), "{name}");
    }
    for plot in ["Momentum", "Step cost", "Contacts", "Speed against error"] {
        click(&mut window, plot);
    }
    click(&mut window, "Compare nothing");
    assert!(window.state().1.variants().is_empty());
}

#[test]
fn edits_are_asked_for_before_they_are_lost() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "sphere");
    window
        .state_mut()
        .1
        .leave(viewer::session::Leaving::Open("parabola".into()));
    window.run();
    assert!(
        window
            .query_by_label("Save the edits of cube-cow?")
            .is_some()
    );
    window.key_press(Key::Space);
    window.run();
    assert_eq!(
        window.state().1.state(),
        State::Layout,
        "keys wait for the answer"
    );
    click(&mut window, "Cancel");
    assert_eq!(window.state().1.world().len(), 3);
    window
        .state_mut()
        .1
        .leave(viewer::session::Leaving::Open("parabola".into()));
    window.run();
    click(&mut window, "Do not save");
    assert_eq!(window.state().1.scene().name, "parabola");
}

#[test]
fn nothing_breaks_in_windows_of_any_size() {
    let sizes = [
        [1360.0, 880.0],
        [900.0, 600.0],
        [300.0, 200.0],
        [60.0, 40.0],
    ];
    for name in ["cube-cow", "stiff-spring", "closing-walls", "drag"] {
        for size in sizes {
            let scene = Scene::load(name).expect("in the gallery");
            let mut session = Session::new(scene).expect("a world");
            session.select(Some(0));
            session.compare.on = true;
            window(session, size).run();
        }
    }
}

#[test]
fn names_cannot_reorder_or_act() {
    let hostile = "a\u{202e}b\u{1b}[31m";
    let text = format!(
        "title = {hostile:?}\nabout = {hostile:?}\nrate = 60\n[[body]]\nname = {hostile:?}\nmesh = \"cube.obj\"\n\
         [[body]]\nname = \"other\"\nmesh = \"cube.obj\"\nposition = [0.5, 0, 0]\n\
         [[force]]\nkind = \"anchor\"\nbody = {hostile:?}\nanchor = [0, 0, 0]\nstiffness = 1\n"
    );
    let text = text
        .replace("\\u{202e}", "\\u202e")
        .replace("\\u{1b}", "\\u001b");
    let scene = Scene::parse(&text, Path::new("h.toml")).expect("a scene");
    assert_eq!(scene.bodies[0].name, hostile);
    let mut session = Session::new(scene).expect("a world");
    session.select(Some(0));
    session.compare.on = true;
    let mut window = window(session, [1360.0, 2500.0]);
    window.run();
    let mut seen = 0;
    for node in window.root().children_recursive() {
        let texts = [node.accesskit_node().label(), node.value()];
        for text in texts.into_iter().flatten() {
            assert!(!text.contains(['\u{202e}', '\u{1b}']), "{text:?}");
            seen += usize::from(text.contains("a\\u{202e}b"));
        }
    }
    assert!(seen >= 4, "{seen}");
}

#[test]
fn what_went_wrong_is_set_right_by_a_button() {
    let mut window = opened("bullet");
    window.run();
    window.state_mut().1.set_collision(Collision::Bvh);
    click(&mut window, "▶ Start");
    go_on(&mut window, 0.5);
    click(&mut window, "⏸ Pause");
    click(&mut window, "Reset, and look within the step");
    let session = &window.state().1;
    assert_eq!(session.world().settings().collision, Collision::Continuous);
    assert_eq!(session.state(), State::Layout);

    let mut window = opened("stiff-spring");
    window.run();
    let explicit = Method::named("forward-euler").expect("it is in the table");
    window.state_mut().1.set_method(explicit);
    click(&mut window, "▶ Start");
    go_on(&mut window, 10.0);
    assert_eq!(window.state().1.state(), State::Paused, "it has blown up");
    let before = window.state().1.world().settings().dt;
    click(&mut window, "Reset, and step at 1,000 Hz");
    let after = window.state().1.world().settings().dt;
    assert!(after < before && (after - 1e-3).abs() < 1e-15, "{after}");
}

#[test]
fn keys_go_from_impact_to_impact_and_draw_the_picture() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    go_on(&mut window, 1.5);
    click(&mut window, "⏸ Pause");
    for key in [Key::U, Key::I] {
        window
            .state_mut()
            .1
            .go_to(if key == Key::U { usize::MAX } else { 0 });
        window.key_press(key);
        window.run();
        let session = &window.state().1;
        let impact = session.playback().impact_times().next().expect("one");
        assert!((session.shown_time() - impact).abs() < 1e-9, "{key:?}");
    }
    assert!(window.query_by_label_contains("within a step").is_some());
    window.key_press(Key::F12);
    window.run();
    let session = &mut window.state_mut().1;
    let still = session.shooting_due().expect("a picture is wanted");
    assert_eq!(still.pictures.len(), 1);
    assert!(
        still.size[0] > 300 && still.size[1] > 100,
        "{:?}",
        still.size
    );
    session.accept_shooting(Ok(None));
}

#[test]
fn a_film_is_made_of_what_is_kept_and_can_be_given_up() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "GIF");
    assert!(
        window.state_mut().1.shooting_due().is_none(),
        "nothing has run"
    );
    window.state_mut().1.notices().clear();
    click(&mut window, "▶ Start");
    go_on(&mut window, 1.0);
    click(&mut window, "GIF");
    let (_, session) = window.state_mut();
    let time = session.shown_time();
    let film = session.shooting_due().expect("a film is wanted");
    assert!(
        (24..=26).contains(&film.pictures.len()),
        "{}",
        film.pictures.len()
    );
    assert_eq!(film.size[0], 720);
    assert!(
        (session.shown_time() - time).abs() < 1e-9,
        "it is looked at as before"
    );
    click(&mut window, "✖");
    assert!(film.reel.is_cancelled());
    window.state_mut().1.accept_shooting(Ok(None));
    // A stretch of it: from a state that is marked, which is unmarked alike.
    let (_, session) = window.state_mut();
    let middle = session.playback().nearest(0.5);
    session.begin_film_at(middle);
    session.shoot_film([720, 450]);
    let stretch = session.shooting_due().expect("a film is wanted");
    let count = stretch.pictures.len();
    assert!((11..=14).contains(&count), "{count}");
    session.accept_shooting(Ok(None));
    session.begin_film_at(middle);
    assert_eq!(session.film_start(), None);
    session.shoot_film([720, 450]);
    let film = session.shooting_due().expect("a film is wanted");
    assert!(film.pictures.len() > 20);
    window.state_mut().1.accept_shooting(Ok(None));
    window.run();
    assert!(window.query_by_label("Save run").is_some());
}

#[test]
fn the_cost_of_phases_is_measured_while_it_is_plotted() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    go_on(&mut window, 0.1);
    let phases = |window: &Harness<'_, (Ui, Session)>| {
        let samples = window.state().1.playback().samples();
        samples.filter(|sample| sample.phases.is_some()).count()
    };
    assert_eq!(phases(&window), 0, "nobody looks");
    click(&mut window, "Step cost");
    go_on(&mut window, 0.5);
    assert!(phases(&window) >= 29);
    for part in ["integrate", "broad", "narrow", "response", "step"] {
        assert!(window.query_by_label(part).is_some(), "{part}");
    }
    click(&mut window, "Step cost");
    let known = phases(&window);
    go_on(&mut window, 0.1);
    assert_eq!(phases(&window), known);
}

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
    let mut look = |window: &Harness<'_, (Ui, Session)>| {
        let texts = texts(window).into_iter();
        left.extend(texts.filter(|text| !english(text).is_empty()));
    };
    for name in ["cube-cow", "bullet", "two-cubes", "tennis-racket"] {
        let mut window = opened(name);
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
fn the_gallery_finds_a_scene_and_opens_it() {
    let mut window = opened("cube-cow");
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::G);
    window.run();
    assert!(stands(&window, "Kepler's ellipse"));
    window.get_by_label("Search the gallery").focus();
    window.run();
    window
        .get_by_label("Search the gallery")
        .type_text("pi collisions");
    window.run();
    assert!(!stands(&window, "Kepler's ellipse"));
    click(&mut window, "Pi by collisions");
    assert_eq!(window.state().1.scene().name, "galperin");
}

#[test]
fn the_palette_finds_a_command_and_does_it() {
    let mut window = opened("cube-cow");
    window.run();
    let search = |window: &mut Harness<'_, (Ui, Session)>, words: &str| {
        window.key_press_modifiers(Modifiers::COMMAND, Key::P);
        window.run();
        window.get_by_label("Search the commands").type_text(words);
        window.run();
        window.key_press(Key::Enter);
        window.run();
    };
    search(&mut window, "integrator backward");
    assert_eq!(
        window.state().1.world().settings().method.name,
        "backward-euler"
    );
    search(&mut window, "wireframe");
    assert!(window.state().1.display.wireframe);
    search(&mut window, "look from the top");
    assert!(window.state().1.camera.pitch > 1.5);
    for (command, told) in [
        ("last impact", "No earlier impact is kept."),
        ("next impact", "No later impact is kept."),
    ] {
        search(&mut window, command);
        assert!(stands(&window, told), "{command}");
    }
    if !has_chinese(&mut window) {
        return;
    }
    search(&mut window, "中文");
    assert!(window.query_by_label("▶ 开始").is_some());
}

#[test]
fn the_tour_goes_through_all_labs_and_sets_up_what_it_says() {
    let mut window = opened("cube-cow");
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::T);
    window.run();
    let mut stops = 0;
    for lab in &LABS {
        for stop in lab.stops {
            stops += 1;
            assert!(
                window.query_by_label(stop.watch).is_some(),
                "{}",
                stop.title
            );
            for attempt in stop.attempts {
                click(&mut window, attempt.title);
                let session = &window.state().1;
                assert_eq!(session.scene().name, stop.scene);
                assert!(!session.is_changed(), "{}: nothing to lose", attempt.title);
            }
            assert!(window.query_by_label(stop.answer).is_none());
            click(&mut window, "Answer");
            assert!(
                window.query_by_label(stop.answer).is_some(),
                "{}",
                stop.title
            );
            if stops < stop_count() {
                click(&mut window, "Next ▶");
            }
        }
    }
    assert_eq!(stops, stop_count());
}

#[test]
fn the_descent_is_gone_through_pair_by_pair() {
    let mut window = opened("cube-cow");
    let session = &mut window.state_mut().1;
    session.select(Some(1));
    // Into the cow.
    let place = session.world().position(0) + sim_core::DVec3::new(0.0, 0.5, 0.0);
    session.set_position(place);
    window.run();
    let pairs = window.state_mut().1.pairs();
    for n in 1..=3 {
        window.key_press(Key::K);
        window.run();
        let told = format!(
            "Pair {n} of {}: ",
            viewer::number::count(pairs.len() as f64)
        );
        assert!(window.query_by_label_contains(&told).is_some(), "{told}");
        assert_eq!(window.state().1.display.pair, Some(n - 1));
    }
    window.key_press(Key::J);
    window.run();
    assert_eq!(window.state().1.display.pair, Some(1));
    // Level by level again.
    window.key_press(Key::N);
    window.run();
    assert_eq!(window.state().1.display.pair, None);
    assert!(window.query_by_label_contains("Level 1 of ").is_some());
}

#[test]
fn keys_fly_while_the_right_button_is_held() {
    let mut window = opened("cube-cow");
    window.run();
    let at = egui::pos2(500.0, 300.0);
    let button = |pressed| egui::Event::PointerButton {
        pos: at,
        button: egui::PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let before = window.state().1.camera;
    window.hover_at(at);
    window.event(button(true));
    window.step();
    window.key_down(Key::W);
    window.step();
    window.step();
    let (after, wireframe) = (window.state().1.camera, window.state().1.display.wireframe);
    assert!((after.eye() - before.eye()).dot(before.forward()) > 0.0);
    assert!(!wireframe, "W is a key of its own only without the button");
    window.key_up(Key::W);
    window.event(button(false));
    window.run();
    window.key_press(Key::W);
    window.run();
    assert!(window.state().1.display.wireframe);
}

#[test]
fn the_panel_is_as_wide_whatever_stands_in_it() {
    let place = |method: &'static Method| {
        let scene = Scene::load("spring").expect("in the gallery");
        let mut session = Session::new(scene).expect("a world");
        session.set_method(method);
        let mut window = window(session, [1360.0, 880.0]);
        window.run();
        window.get_by_label("New").rect().left()
    };
    let all: Vec<f32> = sim_core::METHODS
        .iter()
        .map(|method| place(method))
        .collect();
    assert!(all.iter().all(|left| *left == all[0]), "{all:?}");
}

#[test]
fn views_and_marks_are_switched_by_key_and_panel() {
    let mut window = opened("cube-cow");
    window.run();
    for (key, on) in [
        (
            Key::O,
            (|s: &Session| s.camera.parallel) as fn(&Session) -> bool,
        ),
        (Key::W, |s| s.display.wireframe),
        (Key::M, |s| s.display.names),
    ] {
        assert!(!on(&window.state().1));
        window.key_press(key);
        window.run();
        assert!(on(&window.state().1), "{key:?}");
    }
    for (label, on) in [
        (
            "Parallel",
            (|s: &Session| s.camera.parallel) as fn(&Session) -> bool,
        ),
        ("Edges", |s| s.display.wireframe),
        ("Names", |s| s.display.names),
        ("Numbers", |s| s.display.numbers),
    ] {
        assert!(on(&window.state().1), "{label}");
        click(&mut window, label);
        assert!(!on(&window.state().1), "{label}");
    }
    click(&mut window, "Top");
    assert!(window.state().1.camera.pitch > 1.5);
    for key in [Key::Questionmark, Key::F1] {
        window.key_press(key);
        window.run();
        assert!(window.query_by_label("Keys and mouse").is_some());
        window.key_press(Key::H);
        window.run();
        assert!(window.query_by_label("Keys and mouse").is_none());
    }
}

#[test]
fn what_is_preferred_comes_back() {
    let mut window = opened("cube-cow");
    if !has_chinese(&mut window) {
        return;
    }
    click(&mut window, "中文");
    window.key_press(Key::G);
    window.key_press(Key::O);
    window.run();
    click(&mut window, "☀");
    let (ui, session) = window.state();
    let preferred = ui.preferences(&window.ctx, session);
    assert_eq!(preferred.language, Language::Chinese);
    assert!(preferred.light && preferred.parallel && !preferred.plots);
    let mut again = opened("bullet");
    let context = again.ctx.clone();
    let (ui, session) = again.state_mut();
    ui.prefer(&context, session, &preferred);
    again.run();
    let (ui, session) = again.state();
    assert_eq!(ui.preferences(&again.ctx, session), preferred);
    assert!(again.query_by_label("▶ 开始").is_some());
    assert!(again.query_by_label("PNG").is_none());
}

#[test]
fn a_body_is_renamed_hidden_and_a_scene_begun() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(1));
    window.run();
    click(&mut window, "Shown");
    let session = &mut window.state_mut().1;
    assert!(session.is_hidden(1));
    assert_eq!(session.picture().models.len(), 1);
    session.rename_selected("dice");
    assert!(session.is_hidden(1), "under its new name");
    session.rename_selected("cow");
    assert_eq!(session.scene().bodies[1].name, "dice");
    assert!(session.notices().iter().any(|notice| notice.error));
    session.rename_selected("  ");
    assert_eq!(session.scene().bodies[1].name, "dice");
    window.run();
    click(&mut window, "New");
    click(&mut window, "Do not save");
    assert!(window.state().1.world().is_empty());
    click(&mut window, "cow");
    assert_eq!(window.state().1.world().len(), 1);
}

#[test]
fn handles_move_turn_and_stretch_the_selected_body() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(1));
    window.run();
    let drag = |window: &mut Harness<'_, (Ui, Session)>, label: &str, by: Vec2| {
        let at = window.get_by_label(label).rect().center();
        window.drag_at(at);
        window.run();
        for part in [0.5, 1.0] {
            window.hover_at(at + part * by);
            window.run();
        }
        window.drop_at(at + by);
        window.run();
    };
    let before = window.state().1.world().position(1);
    drag(&mut window, "Move along y", Vec2::new(0.0, -60.0));
    let moved = window.state().1.world().position(1) - before;
    assert!(
        moved.y > 0.05 && moved.x == 0.0 && moved.z == 0.0,
        "{moved}"
    );
    assert_eq!(window.state().1.scene().bodies[1].position, before + moved);
    let body = |window: &Harness<'_, (Ui, Session)>| window.state().1.scene().bodies[1].clone();
    let before = body(&window);
    click(&mut window, "Turn");
    drag(&mut window, "Turn about y", Vec2::new(0.0, -60.0));
    let after = body(&window);
    assert!(
        (after.rotation - before.rotation).y > 5.0,
        "{}",
        after.rotation
    );
    click(&mut window, "Stretch");
    drag(&mut window, "Stretch along y", Vec2::new(0.0, -60.0));
    let after = body(&window);
    assert!(after.scale.y > 1.2 * before.scale.y && after.scale.x == before.scale.x);
    window.key_press(Key::Space);
    window.run();
    assert!(
        !stands(&window, "Stretch along y"),
        "none while physics runs"
    );
    window.key_press(Key::R);
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run();
    assert!(
        body(&window).scale.y < 1.1 * before.scale.y,
        "it is taken back"
    );
}
