//! `jbf_properties::film` on the fuzzer's bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| jbf_properties::film(data));
