//! Readers against the positions and counts of other people's libraries.

mod common;

use std::collections::BTreeMap;

use common::{bytes, data, number, oracle, points};
use kineme_formats::bvh;

#[test]
fn bvh_positions_are_those_of_other_libraries() {
    let Some(data) = data() else { return };
    let plausible: BTreeMap<String, String> = oracle(&data, "fk_bvh_files.csv")
        .into_iter()
        .filter(|row| row["plausible"] == "yes")
        .map(|row| (row["file"].clone(), row["conventions"].clone()))
        .collect();
    let mut by_file: BTreeMap<String, Vec<_>> = BTreeMap::new();
    for row in oracle(&data, "fk_bvh.csv") {
        if plausible.get(&row["file"]) == Some(&row["conventions"]) {
            by_file.entry(row["file"].clone()).or_default().push(row);
        }
    }
    assert_eq!(by_file.len(), plausible.len());
    for (file, rows) in by_file {
        let recording = bvh::parse(&file, &bytes(&data, &file)).expect("a motion");
        println!("{file} {:?}", recording.source().warnings);
        let (mut far, mut largest) = (0.0f64, 0.0f64);
        let mut frames = BTreeMap::new();
        for row in rows {
            let frame = number(&row, "frame") as usize;
            let points = frames
                .entry(frame)
                .or_insert_with(|| points(&recording, frame));
            let found = points[&row["name"]];
            for (axis, column) in ["x", "y", "z"].iter().enumerate() {
                let value = number(&row, column);
                largest = largest.max(value.abs());
                far = far.max((found[axis] - value).abs());
            }
        }
        assert!(far <= 1e-7 * largest, "{file}: {far:e} of {largest}");
    }
}
