//! Bodies that are added, changed and removed; collision filters; and worlds that are written and read.

mod filters;
mod hostile;
mod kinds;
mod removal;
mod snapshot;
mod waking;

use scene::Scene;
use sim_core::{Collision, World};

const MODES: [Collision; 3] = [Collision::Continuous, Collision::Bvh, Collision::Naive];

/// Scenes for which the naive search takes minutes; the BVH gives the same answers.
const SLOW: [&str; 3] = ["herd", "bin", "cows-turning"];

/// Every scene of the gallery in every mode.
fn gallery() -> impl Iterator<Item = (Scene, Collision)> {
    scene::SCENES.iter().flat_map(|entry| {
        let scene = entry.scene().expect("a gallery scene");
        let is_fast = |mode: &Collision| *mode != Collision::Naive || !SLOW.contains(&entry.name);
        MODES
            .into_iter()
            .filter(is_fast)
            .map(move |mode| (scene.clone(), mode))
    })
}

fn world_of(scene: &Scene, collision: Collision) -> World {
    let scene = Scene {
        collision,
        ..scene.clone()
    };
    scene.world().expect("a world")
}
