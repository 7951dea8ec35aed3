#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| kit::cases::try_case("turning", bytes));
