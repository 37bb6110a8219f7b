//! Tables as Parquet: what CSV says, in numbers.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use kineme::{Recording, Skeleton, body};
use kineme_formats::detect::{Kind, by_columns, detect, parse};
use kineme_formats::input::{Inputs, ReadOptions};
use kineme_formats::tables::angles::{self, AngleTable};
use kineme_formats::tables::observed::{self, ObservedRows};
use kineme_formats::tables::{body_angles, positions};
use kineme_formats::{FormatError, Place};
use parquet::data_type::Int64Type;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use proptest::prelude::*;

use crate::body_angles::motion;
use crate::refused;

const FIXED: &str = "time,root_x,root_y,root_z,root_yaw";

/// A file that another program wrote, made by `pyarrow/make.py`.
fn foreign(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables/pyarrow");
    std::fs::read(folder.join(format!("{name}.parquet"))).expect("a fixture")
}

/// The kind of a file by its end.
fn kind(bytes: &[u8]) -> Option<Kind> {
    by_columns(|most| Some(bytes[bytes.len().saturating_sub(most)..].to_vec()))
}

/// Equal to the last bit, a missing value to a missing one.
fn bits(table: &AngleTable) -> Vec<Vec<Option<u64>>> {
    let bits = |values: &[Option<f64>]| values.iter().map(|v| v.map(f64::to_bits)).collect();
    let times: Vec<_> = table.times.iter().copied().map(Some).collect();
    let root = table.root.iter().map(|r| bits(r));
    let columns = table.columns.iter().map(|(_, values)| bits(values));
    [bits(&times)]
        .into_iter()
        .chain(root)
        .chain(columns)
        .collect()
}

/// Any finite number, or none.
fn cell() -> impl Strategy<Value = Option<f64>> {
    prop::option::weighted(0.8, any::<f64>().prop_filter("finite", |v| v.is_finite()))
}

fn table() -> impl Strategy<Value = AngleTable> {
    (1..60usize, 0..5usize).prop_flat_map(|(rows, columns)| {
        let root = prop::collection::vec(prop::array::uniform4(cell()), rows);
        let cells = prop::collection::vec(prop::collection::vec(cell(), rows), columns);
        (0.001..1.0, root, cells).prop_map(|(step, root, cells)| AngleTable {
            times: (0..root.len()).map(|i| step * i as f64 - 3.0).collect(),
            root,
            columns: cells
                .into_iter()
                .enumerate()
                .map(|(i, c)| (format!("j{i}"), c))
                .collect(),
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn a_table_comes_back_bit_for_bit_from_the_same_bytes(table in table()) {
        let bytes = table.write_parquet("t").unwrap();
        prop_assert_eq!(&bytes, &table.write_parquet("t").unwrap());
        let back = angles::parse("t", &bytes).unwrap();
        prop_assert_eq!(bits(&back), bits(&table));
        prop_assert_eq!(back, angles::parse("t", &table.write("t").unwrap()).unwrap());
    }
}

#[test]
fn long_tables_come_back_too() {
    // More than a page of rows, and of bytes.
    let rows = 200_000;
    let wave = |f: f64| {
        (0..rows)
            .map(|i| (i % 7 > 0).then_some((f * i as f64).sin()))
            .collect()
    };
    let table = AngleTable {
        times: (0..rows).map(|i| i as f64 / 120.0).collect(),
        root: vec![[None, Some(0.0), Some(0.95), None]; rows],
        columns: vec![("a".into(), wave(0.01)), ("b".into(), vec![None; rows])],
    };
    let bytes = table.write_parquet("t").unwrap();
    assert_eq!(bits(&angles::parse("t", &bytes).unwrap()), bits(&table));
}

#[test]
fn what_does_not_move_takes_no_room_and_is_read_however_little_moves() {
    let (rows, still) = (20_000, [-0.0, 1e-310, 0.1]);
    let table = |columns: usize| AngleTable {
        times: (0..rows).map(|i| i as f64 / 120.0).collect(),
        root: vec![[Some(0.0); 4]; rows],
        columns: (0..columns)
            .map(|i| (format!("j{i}"), vec![Some(still[i % 3]); rows]))
            .collect(),
    };
    for (columns, most) in [(130, 40 * 1024), (2000, usize::MAX)] {
        let table = table(columns);
        let bytes = table.write_parquet("t").unwrap();
        assert!(bytes.len() - 8 * rows < most, "{} bytes", bytes.len());
        assert_eq!(bits(&angles::parse("t", &bytes).unwrap()), bits(&table));
    }
    // A body at rest for three minutes.
    let mut rest = body_angles::table(&motion("ares", 1));
    rest.times = (0..20_000).map(|i| i as f64 / 120.0).collect();
    rest.root = vec![rest.root[0]; 20_000];
    for (_, values) in &mut rest.columns {
        *values = vec![values[0]; 20_000];
    }
    let bytes = rest.write_parquet("t").unwrap();
    let recording = parse(Kind::Angles, "t", &bytes, None, None).unwrap();
    assert_eq!(recording.frames(), 20_000);
}

/// A Parquet file reads as the CSV does, whoever asks.
fn alike(what: &str, csv: &[u8], bytes: &[u8]) {
    let by_content = detect("m.csv", csv);
    assert_eq!(kind(bytes), by_content, "{what}");
    let Some(kind) = by_content else {
        panic!("{what}: no kind")
    };
    let read = |kind, bytes| parse(kind, "m", bytes, None, None);
    let recording = read(kind, csv).unwrap();
    assert_eq!(read(kind, bytes).unwrap(), recording, "{what}");
    assert_eq!(read(Kind::Parquet, bytes).unwrap(), recording, "{what}");
    if kind != Kind::Angles {
        return;
    }
    for name in ["ares", "adonis"] {
        let body = Arc::new(body(name).unwrap());
        let seen = |bytes| observed::parse("m", bytes, &body).unwrap();
        assert_eq!(seen(bytes), seen(csv), "{what} of {name}");
        if seen(csv).is_some() {
            assert_eq!(
                streamed(bytes, &body),
                streamed(csv, &body),
                "{what} of {name}"
            );
        }
    }
}

/// What a stream of a table tells, row by row.
fn streamed(bytes: &[u8], body: &Arc<Skeleton>) -> Vec<String> {
    let mut rows = ObservedRows::open("-", bytes, body).unwrap();
    let mut told = vec![format!("{:?}", rows.unseen())];
    while let Some(row) = rows.next_row().unwrap() {
        let joints = (row.pose, row.missing, row.root.map(|r| (r.position, r.yaw)));
        told.push(format!("{} {joints:?}", row.secs));
    }
    told
}

#[test]
fn parquet_and_csv_of_a_motion_read_alike() {
    for name in ["ares", "adonis"] {
        let table = body_angles::table(&motion(name, 60));
        let mut gaps = table.clone();
        gaps.columns
            .retain(|(column, _)| !column.starts_with("left_elbow"));
        gaps.columns[3].1[20..40].fill(None);
        gaps.columns[4].1.fill(None);
        gaps.root[7][1] = None;
        for row in [50, 51] {
            gaps.times.remove(row);
            gaps.root.remove(row);
            gaps.columns.iter_mut().for_each(|(_, values)| {
                values.remove(row);
            });
        }
        for (what, table) in [("whole", table), ("with gaps", gaps)] {
            let (csv, bytes) = (table.write("m").unwrap(), table.write_parquet("m").unwrap());
            alike(&format!("{name} {what}"), &csv, &bytes);
        }
    }
}

#[test]
fn parquet_and_csv_of_positions_read_alike() {
    let text = "frame,head_x,head_y,head_z,foot_x,foot_y,foot_z\n0,.1,.2,1.7,.1,.2,-0\n1,,,,.1,.25,0.125\n";
    let seen = positions::parse("m", text.as_bytes(), None).unwrap();
    let whole = Recording::from_motion(&motion("ares", 30));
    use kineme_formats::positions::{Frame, write, write_parquet};
    for (what, recording) in [("gaps", &seen), ("a body", &whole)] {
        for frame in [Frame::Metres, Frame::Native] {
            let mut csv = Vec::new();
            write(recording, frame, &mut csv).unwrap();
            alike(what, &csv, &write_parquet(recording, frame).unwrap());
        }
    }
}

#[test]
fn what_others_wrote_is_read() {
    let secs: Vec<f64> = (0..6).map(|i| i as f64 / 100.0).collect();
    let root = |t: &f64| [Some(1.5 * t), Some(0.0), Some(0.95), Some(-t)];
    let some = |values: &[f64]| -> Vec<Option<f64>> {
        values.iter().map(|v| (!v.is_nan()).then_some(*v)).collect()
    };
    let gap = f64::NAN;
    let wanted = AngleTable {
        root: secs.iter().map(root).collect(),
        columns: vec![
            (
                "left_elbow".into(),
                some(&[0.125, gap, 0.375, 0.5, gap, 0.75]),
            ),
            ("neck_x".into(), some(&[gap, 0.25, 0.25, 0.25, 0.25, 0.25])),
        ],
        times: secs,
    };
    for name in ["snappy", "pages_v2", "split"] {
        let bytes = foreign(name);
        assert_eq!(kind(&bytes), Some(Kind::Angles), "{name}");
        assert_eq!(
            bits(&angles::parse(name, &bytes).unwrap()),
            bits(&wanted),
            "{name}"
        );
    }
    let mut nothing = wanted.clone();
    nothing.columns = vec![("left_elbow".into(), vec![None; 6])];
    let read = angles::parse("nothing", &foreign("nothing")).unwrap();
    assert_eq!(bits(&read), bits(&nothing));
    let mut narrow = wanted.clone();
    let cells = narrow.root.iter_mut().flatten().flatten();
    cells.for_each(|v| *v = f64::from(*v as f32));
    let floats = angles::parse("floats", &foreign("floats")).unwrap();
    assert_eq!(bits(&floats), bits(&narrow));

    for (name, frames, words) in [
        ("frames", 6, "no time base"),
        ("pandas", 6, "`__index_level_0__` is an index"),
    ] {
        let bytes = foreign(name);
        assert_eq!(kind(&bytes), Some(Kind::Positions), "{name}");
        let recording = positions::parse(name, &bytes, None).unwrap();
        assert!(crate::warns(&recording, words), "{name}");
        assert_eq!(recording.frames(), frames, "{name}");
        let head = crate::point(&recording, 5, "head").unwrap();
        assert!((head.x - 0.075).abs() < 1e-12, "{name}: {head}");
        assert_eq!(
            crate::point(&recording, 3, "head").is_none(),
            name == "pandas",
            "{name}"
        );
    }
}

#[test]
fn what_is_no_table_of_numbers_is_refused_by_column_and_row() {
    let row = Place::Row(2);
    for (name, place, words) in [
        ("texts", Place::File, "column `left_elbow` with texts"),
        (
            "lists",
            Place::File,
            "column `left_elbow` with columns in it",
        ),
        ("stamps", Place::File, "column `time` with dates"),
        ("infinite", row, "inf in column `neck_x`"),
        ("zstd", Place::File, "ZSTD compression"),
        ("delta", Place::File, "DELTA_BINARY_PACKED, where"),
        ("others", Place::File, "`frame`, `head_x`, `label`"),
    ] {
        let found = kind(&foreign(name)).unwrap_or(Kind::Parquet);
        let error = parse(found, name, &foreign(name), None, None).unwrap_err();
        refused(name, &error, place, words);
    }
    // Time and axes are judged as in CSV.
    let table = |times: &[f64]| AngleTable {
        times: times.to_vec(),
        root: vec![[None; 4]; times.len()],
        columns: vec![("skul_x".into(), vec![None; times.len()])],
    };
    let bytes = table(&[0.0, 1.0]).write_parquet("t").unwrap();
    let error = parse(Kind::Angles, "t", &bytes, None, None).unwrap_err();
    refused("a strange column", &error, Place::File, "`skul_x`");
    let error = table(&[0.0, 1.0, 0.5]).write_parquet("t").unwrap_err();
    refused("time", &error, Place::Line(4), "0.5 after 1");
}

#[test]
fn in_folders_and_archives_tables_of_motion_are_found_and_others_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let angles = foreign("snappy");
    let cut = &angles[..angles.len() - 1];
    // Longer than what is looked at first, and so is its footer.
    let names = (0..900).map(|i| format!("a_joint_of_a_body_of_very_many_joints_{i}"));
    let columns = names.map(|name| (name, vec![Some(0.5); 20]));
    let large = AngleTable {
        times: (0..20).map(f64::from).collect(),
        root: vec![[None; 4]; 20],
        columns: columns.collect(),
    };
    let large = large.write_parquet("large").unwrap();
    let files = [
        ("angles.parquet", &angles[..]),
        ("cut.parquet", cut),
        ("frames.pq", &foreign("frames")),
        ("large.parquet", &large),
        ("others.parquet", &foreign("others")),
    ];
    let zip = std::fs::File::create(at("set.zip")).unwrap();
    let mut zip = zip::ZipWriter::new(zip);
    for (name, bytes) in files {
        std::fs::write(at(name), bytes).unwrap();
        zip.start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
    let inputs = Inputs::resolve(&[folder.path()], &ReadOptions::default()).unwrap();
    assert_eq!(inputs.ignored, 2, "others.parquet, here and in the archive");
    let four = [
        "angles.parquet",
        "cut.parquet",
        "frames.pq",
        "large.parquet",
    ];
    let packed = four.map(|name| format!("set.zip/{name}"));
    let kinds = [Kind::Angles, Kind::Parquet, Kind::Positions, Kind::Angles];
    let wanted = four
        .map(str::to_owned)
        .into_iter()
        .chain(packed)
        .zip(kinds.into_iter().cycle());
    let found = inputs.entries.iter().map(|entry| {
        let name = entry
            .name()
            .strip_prefix(&folder.path().display().to_string());
        (
            name.unwrap_or_default()[1..].to_owned(),
            entry.kind().unwrap(),
        )
    });
    assert_eq!(found.collect::<Vec<_>>(), wanted.collect::<Vec<_>>());
    for entry in &inputs.entries {
        let (name, read) = (entry.name(), entry.read());
        match name.rsplit('/').next() {
            Some("cut.parquet") => assert!(read.unwrap_err().found.contains("cut off"), "{name}"),
            Some("large.parquet") => {
                assert!(read.unwrap_err().found.contains("joints_0`"), "{name}")
            }
            _ => drop(read.unwrap()),
        }
    }
    let given = Inputs::resolve(&[at("others.parquet")], &ReadOptions::default()).unwrap();
    let error = given.entries[0].read().unwrap_err();
    assert!(
        error.found.contains("`frame`, `head_x`, `label`"),
        "{error}"
    );
    assert!(error.expected.contains("root_yaw"), "{error}");
}

/// A file of this footer.
fn of_footer(footer: &[u8]) -> Vec<u8> {
    let length = (footer.len() as u32).to_le_bytes();
    [b"PAR1", footer, &length, b"PAR1"].concat()
}

#[test]
fn claims_that_a_file_cannot_keep_are_refused_before_memory_is_taken_for_them() {
    // Thrift: fields as type and step, lists as their size and type, 2^31 - 1 of anything.
    const HUGE: [u8; 5] = [0xff, 0xff, 0xff, 0xff, 0x07];
    let version = [0x15, 0x02];
    let root = |children: &[u8]| [&[0x48, 1, b'm', 0x15], children, &[0]].concat();
    let column = |name: u8| [&[0x15, 10, 0x25, 0, 0x18, 1, name, 0][..]].concat();
    let flat = [&[0x19, 0x2c][..], &root(&[2]), &column(b'a')].concat();
    let deep = [0x48, 1, b'd', 0x15, 2, 0].repeat(300_000);
    let cases = [
        ("elements", [&version[..], &[0x19, 0xfc], &HUGE].concat()),
        (
            "children",
            [
                &version[..],
                &[0x19, 0x2c],
                &root(&[0xfe, 0xff, 0xff, 0xff, 0x0f]),
                &column(b'a'),
                &[0],
            ]
            .concat(),
        ),
        (
            "groups",
            [&version[..], &flat, &[0x16, 0, 0x19, 0xfc], &HUGE].concat(),
        ),
        (
            "depth",
            [
                &version[..],
                &[0x19, 0xfc, 0xe0, 0xa7, 0x12],
                &deep,
                &[0x16, 0, 0x19, 0x0c, 0],
            ]
            .concat(),
        ),
    ];
    for (what, footer) in cases {
        let bytes = of_footer(&footer);
        assert_eq!(detect("a.csv", &bytes), Some(Kind::Parquet), "{what}");
        let _ = kind(&bytes);
        for error in [
            angles::parse("a", &bytes).map(drop),
            positions::parse("a", &bytes, None).map(drop),
        ] {
            let error = error.unwrap_err();
            assert!(
                error.found.contains("damaged") || error.found.contains("columns in it"),
                "{what}: {error}"
            );
        }
    }
    // Rows that are all alike are written once, whatever their number.
    let error = angles::parse("a", &repeated(2_000_000)).unwrap_err();
    assert!(error.found.contains("5 columns of 2000000 rows"), "{error}");
    // The same with fewer is a table of which the time does not rise.
    let error = angles::parse("a", &repeated(10_000)).unwrap_err();
    refused("few", &error, Place::Row(2), "time 0 after 0");
}

/// A small file of five columns of many zeros, made by the library.
fn repeated(rows: usize) -> Vec<u8> {
    let columns: String = FIXED
        .split(',')
        .map(|c| format!("required int64 {c}; "))
        .collect();
    let schema = parse_message_type(&format!("message m {{ {columns} }}")).unwrap();
    let limits = WriterProperties::builder().set_data_page_row_count_limit(rows);
    let mut bytes = Vec::new();
    let file = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(limits.build()));
    let mut file = file.unwrap();
    let mut group = file.next_row_group().unwrap();
    while let Some(mut column) = group.next_column().unwrap() {
        let zeros = vec![0; rows];
        column
            .typed::<Int64Type>()
            .write_batch(&zeros, None, None)
            .unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    file.close().unwrap();
    bytes
}

/// Whole files, written in many ways.
fn whole_files() -> Vec<Vec<u8>> {
    let mut files: Vec<Vec<u8>> = [
        "snappy", "pages_v2", "split", "floats", "frames", "delta", "pandas", "lists",
    ]
    .map(foreign)
    .into();
    files.push(
        body_angles::table(&motion("adonis", 20))
            .write_parquet("t")
            .unwrap(),
    );
    files.push(repeated(100));
    files
}

/// Reads bytes in every way. They may be refused, but not by the last resort: a library that panics.
fn read_by_all(bytes: &[u8]) {
    let _ = kind(bytes);
    let told = |error: FormatError| assert!(!error.found.contains("make no sense"), "{error}");
    let _ = angles::parse("a", bytes).map_err(told);
    let _ = positions::parse("a", bytes, None).map_err(told);
    let _ = parse(Kind::Parquet, "a", bytes, None, None).map_err(told);
}

#[test]
fn files_cut_off_anywhere_are_refused() {
    for (at, bytes) in whole_files().iter().enumerate() {
        for length in 0..bytes.len() {
            let cut = &bytes[..length];
            assert!(angles::parse("a", cut).is_err(), "{at} cut to {length}");
            if length >= 4 {
                assert_eq!(kind(cut), Some(Kind::Parquet), "{at} cut to {length}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_read_or_refused(
        which in 0..10usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4u8), 1..6),
    ) {
        thread_local!(static WHOLE: Vec<Vec<u8>> = whole_files());
        let mut bytes = WHOLE.with(|files| files[which].clone());
        for (index, byte, edit) in edits {
            let at = index.index(bytes.len());
            match edit {
                0 => bytes[at] = byte,
                1 => bytes[at] ^= 1 << (byte % 8),
                2 => bytes[at] = 0xff,
                _ => bytes[at] = 0,
            }
        }
        read_by_all(&bytes);
    }
}
