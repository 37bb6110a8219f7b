//! Plans of behaviours: any bytes are read or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kineme_formats::plan::parse("fuzz", bytes);
});
