//! Where the data is, and small helpers.
#![allow(dead_code, reason = "every test file uses its part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kineme::Recording;
use nalgebra::Vector3;

/// The data folder, or `None` after saying that the test is skipped.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("KINEME_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    if folder.join("mocap").is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: no data at {} (set KINEME_DATA)", folder.display());
    None
}

/// A table beside the data, as rows of name to text.
pub fn oracle(data: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let path = data.join("../oracles").join(name);
    let mut reader = csv::Reader::from_path(&path).expect("an oracle table");
    reader
        .deserialize()
        .map(|row| row.expect("a row"))
        .collect()
}

/// The bytes of `archive/inner/file` as the oracles name it.
pub fn bytes(data: &Path, file: &str) -> Vec<u8> {
    use std::io::Read;
    let (archive, _) = file.split_once('/').expect("archive/file");
    let path = data.join("mocap").join(format!("{archive}.zip"));
    let mut zip = zip::ZipArchive::new(std::fs::File::open(path).expect("archive")).expect("zip");
    let inner = (0..zip.len())
        .map(|i| zip.by_index(i).expect("entry").name().to_owned())
        .find(|name| name == file || format!("{archive}/{name}") == file)
        .unwrap_or_else(|| panic!("no {file}"));
    let mut bytes = Vec::new();
    zip.by_name(&inner)
        .expect("entry")
        .read_to_end(&mut bytes)
        .expect("bytes");
    bytes
}

/// A number of a table's cell.
pub fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column]
        .parse()
        .unwrap_or_else(|_| panic!("{column} {:?}", row[column]))
}

/// Points of a frame in the file's own axes and units, by name: joints, and tips as `<joint>_End`.
pub fn points(recording: &Recording, frame: usize) -> BTreeMap<String, Vector3<f64>> {
    let mut points = BTreeMap::new();
    for (joint, placed) in recording.joints().iter().zip(recording.placements(frame)) {
        let place = placed.position.expect("a position");
        points.insert(joint.name.clone(), recording.source().to_native(place));
        if let (Some(tip), Some(turn)) = (joint.tip, placed.rotation) {
            points.insert(
                format!("{}_End", joint.name),
                recording.source().to_native(place + turn * tip),
            );
        }
    }
    points
}
