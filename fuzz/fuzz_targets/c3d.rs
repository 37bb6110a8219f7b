//! C3D: any bytes are read or refused, and joints are told of whatever markers are read.
#![no_main]

use kineme_formats::c3d::joint_centres;
use kineme_formats::detect::{Kind, parse};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(recording) = parse(Kind::C3d, "fuzz.c3d", bytes, None, None) {
        let _ = recording.placements(recording.frames() - 1);
        let _ = joint_centres(&recording, None);
    }
});
