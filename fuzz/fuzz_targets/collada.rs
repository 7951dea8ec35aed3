#![no_main]

#[path = "../../tests/fuzz/cases.rs"]
mod cases;
#[path = "../../tests/oracle/mod.rs"]
mod oracle;
#[path = "../../tests/rational/mod.rs"]
mod rational;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::try_case("collada", bytes));
