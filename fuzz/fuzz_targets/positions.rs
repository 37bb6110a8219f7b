//! Position tables: any bytes are read or refused.
#![no_main]

use kineme_formats::detect::{Kind, parse};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(recording) = parse(Kind::Positions, "fuzz.csv", bytes, None, None) {
        let _ = recording.placements(recording.frames() - 1);
    }
});
