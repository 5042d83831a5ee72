//! The property stands at [`etendue_tests::fuzz::scene`].
#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| etendue_tests::fuzz::scene(bytes));
