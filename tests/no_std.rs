//! The probe of `probe/` runs without the standard library, and has the same hash with it.

extern crate alloc;

#[path = "../probe/src/motion.rs"]
mod motion;

#[test]
fn the_probe_has_the_hash_that_it_has_everywhere() {
    let hash = motion::hash().expect("steps");
    assert_eq!(hash, motion::EXPECTED, "{hash:#018x}");
}
