//! A fixed number of runs of the cases that `fuzz/` tries without end: known inputs, and mutations of them by a fixed
//! seed.
//! `COWBELL_FUZZ_RUNS` sets the number of runs of each case (of `values` and `turning` a fifth), `COWBELL_FUZZ_SEED`
//! the seed, and `COWBELL_FUZZ_CASE` selects a single case.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use kit::cases::CASES;
use kit::random::Random;

const RUNS: u64 = 2_000;

fn setting(name: &str, usual: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.map_or(usual, |text| text.parse().expect("a number"))
}

/// The corpus of a case and the inputs that have broken it; empty if there are none.
fn corpus(case: &str) -> Vec<Vec<u8>> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = match case {
        "scene" => "assets/scenes".to_owned(),
        case => format!("fuzz/corpus/{case}"),
    };
    let mut inputs = Vec::new();
    for folder in [folder, format!("fuzz/found/{case}")] {
        let Ok(files) = fs::read_dir(root.join(folder)) else {
            continue;
        };
        let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a file").path()).collect();
        paths.sort();
        inputs.extend(paths.iter().map(|path| fs::read(path).expect("a file")));
    }
    if inputs.is_empty() {
        inputs.push(Vec::new());
    }
    inputs
}

/// Random mutations of an input, with pieces of another one.
fn mutate(random: &mut Random, from: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = from.to_vec();
    for _ in 0..1 + random.below(6) {
        let place = random.below(bytes.len() + 1);
        let end = (place + random.below(12)).min(bytes.len());
        match random.below(6) {
            0 => drop(bytes.drain(place..end)),
            1 => {
                let piece = bytes[place..end].to_vec();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, piece);
            }
            2 => {
                let start = random.below(other.len() + 1);
                let stop = (start + random.below(24)).min(other.len());
                bytes.splice(place..place, other[start..stop].iter().copied());
            }
            3 => {
                if let Some(byte) = bytes.get_mut(place) {
                    *byte ^= 1 << random.below(8);
                }
            }
            4 => bytes.truncate(place.max(1)),
            _ => {
                let count = 1 + random.below(8);
                let fresh: Vec<u8> = (0..count).map(|_| random.bits() as u8).collect();
                bytes.splice(place..end, fresh);
            }
        }
    }
    bytes.truncate(20_000);
    bytes
}

/// Random bytes, for cases that interpret them as numbers.
fn fresh(random: &mut Random) -> Vec<u8> {
    (0..24 + random.below(160))
        .map(|_| random.bits() as u8)
        .collect()
}

#[test]
fn nothing_that_is_tried_breaks_what_must_hold() {
    let runs = setting("COWBELL_FUZZ_RUNS", RUNS);
    let seed = setting("COWBELL_FUZZ_SEED", 1);
    let only = std::env::var("COWBELL_FUZZ_CASE").ok();
    let mut broken = Vec::new();
    for (name, case) in CASES {
        if only.as_deref().is_some_and(|only| only != name) {
            continue;
        }
        let corpus = corpus(name);
        let mut random = Random::scrambled(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let known = corpus.len() as u64;
        // Some cases make worlds and step them in every mode; a run of some of the others can take a second.
        let runs = match name {
            "values" | "turning" => runs / 5,
            _ => runs,
        };
        let reads_numbers = ["values", "pair", "sweep", "step", "turning"].contains(&name);
        for run in 0..runs.max(known) {
            let input = match corpus.get(run as usize) {
                Some(input) => input.clone(),
                None if reads_numbers && (run % 2 == 0 || corpus.iter().all(Vec::is_empty)) => {
                    fresh(&mut random)
                }
                None => {
                    let from = &corpus[random.below(corpus.len())];
                    let other = &corpus[random.below(corpus.len())];
                    mutate(&mut random, from, other)
                }
            };
            if catch_unwind(AssertUnwindSafe(|| case(&input))).is_err() {
                let path = std::env::temp_dir().join(format!("cowbell-fuzz-{name}-{seed}-{run}"));
                fs::write(&path, &input).expect("a file");
                broken.push(path);
            }
        }
        println!("{name}: {} runs", runs.max(known));
    }
    assert!(broken.is_empty(), "inputs that break it: {broken:#?}");
}
