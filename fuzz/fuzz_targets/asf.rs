//! ASF: any bytes are read or refused.
#![no_main]

use kineme_formats::asf;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = asf::parse("fuzz.asf", bytes);
});
