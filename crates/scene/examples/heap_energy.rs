//! By how much heaps gain energy in a step at most, and how far ahead of their time contacts are closed, at
//! several rates: `cargo run --release -p scene --example heap_energy`.

use std::error::Error;

use scene::Scene;
use sim_core::{Settings, World};

/// Time that is simulated, s.
const DURATION: f64 = 4.0;

fn main() -> Result<(), Box<dyn Error>> {
    println!("scene   friction  rate, Hz  energy, J  greatest gain, J  closed ahead, m");
    for name in ["herd", "wall", "funnel", "bin"] {
        for friction in [0.0, 0.4] {
            for rate in [60.0, 120.0, 240.0, 480.0, 960.0] {
                run(name, friction, rate)?;
            }
        }
    }
    Ok(())
}

fn run(name: &str, friction: f64, rate: f64) -> Result<(), Box<dyn Error>> {
    let mut world = Scene::load(name)?.world()?;
    let settings = Settings {
        dt: 1.0 / rate,
        ..*world.settings()
    };
    world.set_settings(settings)?;
    for body in 0..world.len() {
        world.set_friction(body, friction)?;
    }
    let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
    let start = energy(&world);
    let (mut before, mut gain, mut ahead) = (start, 0.0_f64, 0.0_f64);
    for _ in 0..(DURATION * rate) as u32 {
        world.step()?;
        let now = energy(&world);
        gain = gain.max(now - before);
        ahead = ahead.max(world.bundled().distance);
        before = now;
    }
    println!("{name:8}{friction:8}{rate:10}{start:11.1}{gain:18.1e}{ahead:17.1e}");
    Ok(())
}
