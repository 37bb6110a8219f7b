//! Robots in URDF: any bytes are read or refused.
#![no_main]

use kineme_formats::{FormatError, Place, robot};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let alone = |file: &str| Err(FormatError::new(file, Place::File, "nothing", "a file"));
    // The root element tells a URDF; what is between its tags is all that is left to chance.
    let text = [b"<robot name='r'>", bytes, b"</robot>"].concat();
    let _ = robot::parse("fuzz", &text, &alone, None);
});
