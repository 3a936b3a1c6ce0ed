#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    umbmark_fuzz::datasets(bytes);
});
