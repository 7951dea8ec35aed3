//! The panels, driven as a person would drive them: by what stands on them, and by keys.

mod editing;
mod finding;
mod looking;
mod running;
mod words;

use std::time::Duration;

use egui::accesskit::Role;
use egui::{TextureId, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use scene::Scene;
use viewer::session::Session;
use viewer::ui::Ui;

/// The panels and what they show.
pub(crate) type Window<'a> = Harness<'a, (Ui, Session)>;

/// A window of a size on a session, without a picture in it.
pub(crate) fn window(session: Session, size: [f32; 2]) -> Window<'static> {
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
pub(crate) fn texts(window: &Window<'_>) -> Vec<String> {
    let nodes = window.root().children_recursive();
    let texts = nodes.flat_map(|node| [node.accesskit_node().label(), node.value()]);
    texts.flatten().collect()
}

/// Whether the system has a font with Chinese characters; where it has none, the window speaks English.
pub(crate) fn has_chinese(window: &mut Window<'_>) -> bool {
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
pub(crate) fn stands(window: &Window<'_>, text: &str) -> bool {
    window.query_all_by_label(text).next().is_some()
}

pub(crate) fn opened(name: &str) -> Window<'static> {
    let scene = Scene::load(name).expect("in the gallery");
    let session = Session::new(scene).expect("a world");
    window(session, [1360.0, 1500.0])
}

/// Lets physics go on for a time, s, in frames of a sixtieth.
pub(crate) fn go_on(window: &mut Window<'_>, time: f64) {
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

pub(crate) fn click(window: &mut Window<'_>, label: &str) {
    {
        let mut named = window.query_all_by_label(label);
        // Not what only says the same.
        let button = named.find(|node| node.accesskit_node().role() != Role::Label);
        button.expect(label).click();
    }
    window.run();
}
