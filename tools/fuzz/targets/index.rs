#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| nerf_oracle_fuzz::readers::index(bytes));
