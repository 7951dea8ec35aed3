//! The scenes that come with the program.

use std::path::Path;

use crate::SceneError;
use crate::scene::Scene;
use crate::scene_file::{self, MeshSource};

/// The gallery, in the order of a first visit. The first is the default.
pub static SCENES: &[GalleryScene] = &[
    GalleryScene {
        name: "cube-cow",
        text: include_str!("../assets/scenes/cube-cow.toml"),
    },
    GalleryScene {
        name: "parabola",
        text: include_str!("../assets/scenes/parabola.toml"),
    },
    GalleryScene {
        name: "five-hertz",
        text: include_str!("../assets/scenes/five-hertz.toml"),
    },
    GalleryScene {
        name: "two-cubes",
        text: include_str!("../assets/scenes/two-cubes.toml"),
    },
    GalleryScene {
        name: "bounce",
        text: include_str!("../assets/scenes/bounce.toml"),
    },
    GalleryScene {
        name: "bullet",
        text: include_str!("../assets/scenes/bullet.toml"),
    },
    GalleryScene {
        name: "cradle",
        text: include_str!("../assets/scenes/cradle.toml"),
    },
    GalleryScene {
        name: "galperin",
        text: include_str!("../assets/scenes/galperin.toml"),
    },
    GalleryScene {
        name: "closing-walls",
        text: include_str!("../assets/scenes/closing-walls.toml"),
    },
    GalleryScene {
        name: "u-channel",
        text: include_str!("../assets/scenes/u-channel.toml"),
    },
    GalleryScene {
        name: "hundred-cubes",
        text: include_str!("../assets/scenes/hundred-cubes.toml"),
    },
    GalleryScene {
        name: "herd",
        text: include_str!("../assets/scenes/herd.toml"),
    },
    GalleryScene {
        name: "stack",
        text: include_str!("../assets/scenes/stack.toml"),
    },
    GalleryScene {
        name: "slope",
        text: include_str!("../assets/scenes/slope.toml"),
    },
    GalleryScene {
        name: "dominoes",
        text: include_str!("../assets/scenes/dominoes.toml"),
    },
    GalleryScene {
        name: "conveyor",
        text: include_str!("../assets/scenes/conveyor.toml"),
    },
    GalleryScene {
        name: "wall",
        text: include_str!("../assets/scenes/wall.toml"),
    },
    GalleryScene {
        name: "funnel",
        text: include_str!("../assets/scenes/funnel.toml"),
    },
    GalleryScene {
        name: "bin",
        text: include_str!("../assets/scenes/bin.toml"),
    },
    GalleryScene {
        name: "spring",
        text: include_str!("../assets/scenes/spring.toml"),
    },
    GalleryScene {
        name: "stiff-spring",
        text: include_str!("../assets/scenes/stiff-spring.toml"),
    },
    GalleryScene {
        name: "oscillator",
        text: include_str!("../assets/scenes/oscillator.toml"),
    },
    GalleryScene {
        name: "drag",
        text: include_str!("../assets/scenes/drag.toml"),
    },
    GalleryScene {
        name: "kepler",
        text: include_str!("../assets/scenes/kepler.toml"),
    },
    GalleryScene {
        name: "pleiades",
        text: include_str!("../assets/scenes/pleiades.toml"),
    },
    GalleryScene {
        name: "tennis-racket",
        text: include_str!("../assets/scenes/tennis-racket.toml"),
    },
    GalleryScene {
        name: "cubes-turning",
        text: include_str!("../assets/scenes/cubes-turning.toml"),
    },
    GalleryScene {
        name: "wobbling-plate",
        text: include_str!("../assets/scenes/wobbling-plate.toml"),
    },
    GalleryScene {
        name: "cube-cow-spin",
        text: include_str!("../assets/scenes/cube-cow-spin.toml"),
    },
    GalleryScene {
        name: "cows-turning",
        text: include_str!("../assets/scenes/cows-turning.toml"),
    },
    GalleryScene {
        name: "nut-on-bolt",
        text: include_str!("../assets/scenes/nut-on-bolt.toml"),
    },
    GalleryScene {
        name: "top",
        text: include_str!("../assets/scenes/top.toml"),
    },
    GalleryScene {
        name: "chain",
        text: include_str!("../assets/scenes/chain.toml"),
    },
];

/// A scene of the gallery.
#[derive(Debug)]
pub struct GalleryScene {
    /// Name for [`Scene::load`], such as `cube-cow`.
    pub name: &'static str,
    /// The scene file.
    pub text: &'static str,
}

impl GalleryScene {
    /// The title, from the scene file.
    pub fn title(&self) -> &'static str {
        self.quoted("title").unwrap_or(self.name)
    }

    /// The description, from the scene file.
    pub fn about(&self) -> &'static str {
        self.quoted("about").unwrap_or_default()
    }

    fn quoted(&self, field: &str) -> Option<&'static str> {
        let mut lines = self.text.lines();
        let line = lines.find(|line| line.starts_with(field))?;
        line.split('"').nth(1)
    }

    /// Loads the scene; it has built-in meshes only, so no file is opened.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        scene_file::parse(self.text, Path::new(self.name), MeshSource::builtin_only())
    }
}
