//! Runs scenes of the gallery and compares the hashes of their states with those of a table, on any machine
//! that this is compiled for: `cargo run --release -p scene --example pinned_hashes -- tests/hashes.txt`.
//!
//! A line of the table is the name of a scene, how collisions are found, and the hash after 600 steps.

use std::process::ExitCode;

use scene::Scene;
use sim_core::Collision;

const STEPS: u32 = 600;

fn hash(name: &str, mode: &str) -> Result<String, Box<dyn std::error::Error>> {
    let mut scene = Scene::load(name)?;
    scene.collision = match mode {
        "continuous" => Collision::Continuous,
        "bvh" => Collision::Bvh,
        "naive" => Collision::Naive,
        _ => return Err(format!("{mode} is no way to find collisions").into()),
    };
    let mut world = scene.world()?;
    for _ in 0..STEPS {
        world.step()?;
    }
    Ok(format!("{:016x}", world.state_hash()))
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give the table of hashes")?;
    let table = std::fs::read_to_string(path)?;
    let (mut right, mut wrong) = (0, 0);
    for line in table.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, mode, expected] = words[..] else {
            return Err(format!("{line:?} is not a scene, a mode and a hash").into());
        };
        let found = hash(name, mode)?;
        if found == expected {
            right += 1;
        } else {
            wrong += 1;
            println!("{name} {mode}: {found}, not {expected}");
        }
    }
    println!(
        "{right} states are the pinned ones on {}, {wrong} are not",
        std::env::consts::ARCH
    );
    Ok(if wrong == 0 && right > 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
