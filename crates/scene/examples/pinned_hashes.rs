//! Runs scenes of the gallery and compares the hashes of their states with those of a table, on any machine
//! that this is compiled for: `cargo run --release -p scene --example pinned_hashes -- tests/hashes.txt`.
//!
//! A line of the table is the name of a scene, how collisions are found, and the hash after 600 steps.

use std::error::Error;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use scene::Scene;
use sim_core::Collision;

const STEPS: u32 = 600;

fn hash(name: &str, mode: &str) -> Result<String, Box<dyn Error>> {
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

/// Whether the state of a line of the table is the pinned one.
fn is_pinned(line: &str) -> Result<bool, Box<dyn Error>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [name, mode, expected] = words[..] else {
        return Err(format!("{line:?} is not a scene, a mode and a hash").into());
    };
    let found = hash(name, mode)?;
    if found != expected {
        println!("{name} {mode}: {found}, not {expected}");
    }
    Ok(found == expected)
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("give the table of hashes")?;
    let table = std::fs::read_to_string(path)?;
    let lines: Vec<&str> = table.lines().collect();
    let (next, wrong) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || {
        while let Some(line) = lines.get(next.fetch_add(1, Relaxed)) {
            match is_pinned(line) {
                Ok(true) => continue,
                Ok(false) => {}
                Err(error) => println!("{line}: {error}"),
            }
            wrong.fetch_add(1, Relaxed);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let (wrong, arch) = (wrong.into_inner(), std::env::consts::ARCH);
    println!(
        "{} states are the pinned ones on {arch}, {wrong} are not",
        lines.len() - wrong
    );
    let is_right = wrong == 0 && !lines.is_empty();
    Ok(if is_right {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
