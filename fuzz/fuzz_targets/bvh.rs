//! BVH: any bytes are read or refused, and what is read can be written and read again.
#![no_main]

use kineme_formats::bvh;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(recording) = bvh::parse("fuzz.bvh", bytes) {
        let mut text = Vec::new();
        // Numbers near the largest there are may overflow between metres and the file's unit.
        if bvh::write(&recording, &mut text).is_ok()
            && let Ok(again) = bvh::parse("fuzz.bvh", &text)
        {
            assert_eq!(again.frames(), recording.frames());
            assert_eq!(again.joints().len(), recording.joints().len());
        }
    }
});
