//! Vocabulary files: any bytes are read or refused, and what is read is written alike.
#![no_main]

use kineme_formats::vocabulary::{VocabularyFile, read, write};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = VocabularyFile::parse("fuzz", bytes) {
        let again = file.write("fuzz").expect("what was read is valid");
        assert_eq!(VocabularyFile::parse("fuzz", &again).as_ref(), Ok(&file));
    }
    if let Ok(vocabulary) = read("fuzz", bytes) {
        write(&vocabulary, "fuzz").expect("what was read is valid");
    }
});
