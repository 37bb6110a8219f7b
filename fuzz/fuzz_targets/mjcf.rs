//! Robots in MJCF: any bytes are read or refused.
#![no_main]

use kineme_formats::{FormatError, Place, robot};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let alone = |file: &str| Err(FormatError::new(file, Place::File, "nothing", "a file"));
    let _ = robot::parse("fuzz", bytes, &alone, None);
});
