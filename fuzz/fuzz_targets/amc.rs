//! AMC: any bytes are read or refused, of a skeleton of three joints.
#![no_main]

use std::sync::LazyLock;

use kineme_formats::{amc, asf};
use libfuzzer_sys::fuzz_target;

static SKELETON: LazyLock<asf::Skeleton> = LazyLock::new(|| {
    let text = ":bonedata\nbegin\nname thigh\ndirection 0 -1 0\nlength 7\naxis 0 0 20 XYZ\ndof rx ry rz\nend\n\
                begin\nname shank\ndirection 0 -1 0\nlength 7\naxis 0 0 20 XYZ\ndof rx\nend\n\
                :hierarchy\nbegin\nroot thigh\nthigh shank\nend\n";
    asf::parse("fuzz.asf", text.as_bytes()).expect("a sound skeleton")
});

fuzz_target!(|bytes: &[u8]| {
    if let Ok(recording) = amc::parse("fuzz.amc", bytes, &SKELETON, None) {
        let _ = recording.placements(recording.frames() - 1);
    }
});
