//! Parquet tables: any bytes are read or refused, and what is read is written alike.
#![no_main]

use kineme_formats::detect::{Kind, by_columns, parse};
use kineme_formats::tables::angles;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // Without it the bytes are a table of text, which has a target of its own.
    let bytes = [b"PAR1", bytes].concat();
    let _ = by_columns(|most| Some(bytes[bytes.len().saturating_sub(most)..].to_vec()));
    let _ = parse(Kind::Positions, "fuzz", &bytes, None, None);
    if let Ok(table) = angles::parse("fuzz", &bytes) {
        let again = table.write_parquet("fuzz").expect("what was read is valid");
        assert_eq!(angles::parse("fuzz", &again).as_ref(), Ok(&table));
    }
});
