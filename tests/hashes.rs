//! The gallery, step by step, bit for bit: every scene ends in the state whose hash is recorded in `hashes.txt`.
//!
//! A change that preserves all results does not change that file. A change of results changes it, visibly for
//! reviewers. To print it again: `COWBELL_PRINT_HASHES=1 cargo test --test hashes -- --nocapture`.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Instant;

use scene::SCENES;
use sim_core::Collision;

const STEPS: u32 = 600;

/// The collision modes, by their names in the table.
const MODES: [(&str, Collision); 3] = [
    ("continuous", Collision::Continuous),
    ("bvh", Collision::Bvh),
    ("naive", Collision::Naive),
];

/// The runs left out, with reasons. The continuous mode of every scene is run.
const LEFT_OUT: [(&str, &str, &str); 3] = [
    (
        "herd",
        "naive",
        "cows against cows take minutes; the BVH has the same answers",
    ),
    ("bin", "naive", "the same"),
    ("cows-turning", "naive", "the same"),
];

const PINNED: &str = include_str!("hashes.txt");

#[test]
fn every_scene_ends_in_the_pinned_state() {
    let mut table = String::new();
    let pinned: BTreeMap<(&str, &str), &str> = PINNED
        .lines()
        .map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [scene, mode, hash] = words[..] else {
                panic!("{line:?} is not a scene, a mode and a hash");
            };
            ((scene, mode), hash)
        })
        .collect();
    let mut wrong = Vec::new();
    let mut found: BTreeMap<(&str, &str), String> = BTreeMap::new();
    let mut known = pinned.len();
    for entry in SCENES {
        for (mode, collision) in MODES {
            let is_left_out = |left: &&(&str, &str, &str)| (left.0, left.1) == (entry.name, mode);
            if let Some((.., why)) = LEFT_OUT.iter().find(is_left_out) {
                println!("{} {mode} is left out: {why}", entry.name);
                continue;
            }
            eprintln!("{} {mode}", entry.name);
            let mut scene = entry.scene().expect("a gallery scene");
            scene.collision = collision;
            let mut world = scene.world().expect("a world");
            let start = Instant::now();
            for _ in 0..STEPS {
                world
                    .step()
                    .unwrap_or_else(|error| panic!("{}: {error}", entry.name));
            }
            let seconds = start.elapsed().as_secs_f64();
            let hash = format!("{:016x}", world.state_hash());
            let _ = writeln!(table, "{} {mode} {hash}", entry.name);
            if seconds > 1.0 {
                println!("{} {mode}: {seconds:.1} s", entry.name);
            }
            match pinned.get(&(entry.name, mode)) {
                Some(&expected) => {
                    known -= 1;
                    if expected != hash {
                        wrong.push(format!("{} {mode}: {hash}, not {expected}", entry.name));
                    }
                }
                None => wrong.push(format!("{} {mode}: {hash} is not in the table", entry.name)),
            }
            found.insert((entry.name, mode), hash);
        }
    }
    // Independent of the recorded hashes: the naive search and the BVH give the same answers.
    for (&(scene, mode), hash) in &found {
        if mode == "naive" {
            assert_eq!(Some(hash), found.get(&(scene, "bvh")), "{scene}");
        }
    }
    if std::env::var_os("COWBELL_PRINT_HASHES").is_some() {
        println!("{table}");
        return;
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(known, 0, "lines of the table that no scene has");
}
