#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drop(umbmark_fuzz::robots(bytes)));
