use kineme_formats::Place;
use kineme_formats::tables::angles::{AngleRows, AngleTable, parse, sniff};

use crate::{refused, refuses};

const EXAMPLE: &str = "\
time,root_x,root_y,root_z,root_yaw,left_elbow,neck_x,neck_y,neck_z
0,0,0,0.95,0,1.2,0.1,0,-0.2
0.02,0.01,0,0.95,,1.25,,0.01,NaN
";

#[test]
fn an_angle_table_is_names_and_numbers() {
    let table = parse("a.csv", EXAMPLE.as_bytes()).unwrap();
    assert_eq!(table.times, [0.0, 0.02]);
    assert_eq!(table.root[1], [Some(0.01), Some(0.0), Some(0.95), None]);
    let names: Vec<_> = table.columns.iter().map(|(n, _)| n.as_str()).collect();
    assert_eq!(names, ["left_elbow", "neck_x", "neck_y", "neck_z"]);
    assert_eq!(table.columns[0].1, [Some(1.2), Some(1.25)]);
    assert_eq!(table.columns[3].1, [Some(-0.2), None]);
    let written = String::from_utf8(table.write("a.csv").unwrap()).unwrap();
    assert_eq!(written, EXAMPLE.replace("NaN", ""));
}

#[test]
fn rows_of_a_stream_come_one_by_one() {
    // The third row is damaged: the two before it are had all the same.
    let text = format!("{EXAMPLE}0.04,1\n");
    let mut rows = AngleRows::open("-", text.as_bytes()).unwrap();
    assert_eq!(rows.columns().len(), 4);
    assert_eq!(rows.next().unwrap().unwrap().angles[0], Some(1.2));
    assert_eq!(rows.next().unwrap().unwrap().time, 0.02);
    refused(
        "row",
        &rows.next().unwrap().unwrap_err(),
        Place::Line(4),
        "2 cells",
    );
}

#[test]
fn every_number_survives_writing_and_reading() {
    let values = [
        0.0,
        -0.0,
        0.1,
        1.0 / 3.0,
        -1e-300,
        5e-324,
        1e300,
        f64::MAX,
        1e16,
        9_007_199_254_740_993.0,
        1e-5,
        9.999_999e-6,
        std::f64::consts::PI,
    ];
    let table = AngleTable {
        times: (0..values.len()).map(|i| i as f64 / 30.0).collect(),
        root: values
            .iter()
            .map(|v| [Some(*v), None, Some(-v), Some(0.5)])
            .collect(),
        columns: vec![
            (
                "a, with comma".to_string(),
                values.iter().copied().map(Some).collect(),
            ),
            ("b".to_string(), vec![None; values.len()]),
        ],
    };
    let back = parse("a.csv", &table.write("a.csv").unwrap()).unwrap();
    assert_eq!(back, table);
    let bits =
        |t: &AngleTable| -> Vec<_> { t.columns[0].1.iter().map(|v| v.map(f64::to_bits)).collect() };
    assert_eq!(bits(&back), bits(&table));
}

#[test]
fn damaged_tables_are_refused_with_the_line() {
    let header = "time,root_x,root_y,root_z,root_yaw,a";
    let with = |rest: &str| format!("{header}\n{rest}");
    let line = Place::Line;
    refuses(
        &[
            ("empty", "", Place::File, "nothing"),
            (
                "no header",
                "0,1,2,3,4,5\n",
                line(1),
                "`0` in place of `time`",
            ),
            ("short", "time,root_x\n", line(1), "no column `root_y`"),
            (
                "nameless",
                "time,root_x,root_y,root_z,root_yaw,\n",
                line(1),
                "without a name",
            ),
            ("twice", &format!("{header},a\n"), line(1), "`a` twice"),
            ("no row", header, Place::File, "no row"),
            ("word", &with("0,0,0,0,0,0\n1,0,0,0,0,z\n"), line(3), "`z`"),
            ("no time", &with(",0,0,0,0,0\n"), line(2), "no time"),
            (
                "time back",
                &with("1,0,0,0,0,0\n0,0,0,0,0,0\n"),
                line(3),
                "0 after 1",
            ),
        ],
        |bytes| parse("a.csv", bytes),
    );
}

#[test]
fn what_would_not_read_back_is_not_written() {
    let good = parse("a.csv", EXAMPLE.as_bytes()).unwrap();
    type Damage = fn(&mut AngleTable);
    let cases: &[(&str, Damage, Place, &str)] = &[
        (
            "no row",
            |t| *t = AngleTable::default(),
            Place::File,
            "no row",
        ),
        (
            "short column",
            |t| t.columns[0].1.truncate(1),
            Place::File,
            "1 values",
        ),
        (
            "short root",
            |t| t.root.truncate(1),
            Place::File,
            "1 placements",
        ),
        ("no name", |t| t.columns[0].0.clear(), Place::Line(1), "``"),
        (
            "spaces",
            |t| t.columns[0].0.push(' '),
            Place::Line(1),
            "`left_elbow `",
        ),
        (
            "fixed name",
            |t| t.columns[0].0 = "time".to_string(),
            Place::Line(1),
            "`time`",
        ),
        (
            "time back",
            |t| t.times[1] = 0.0,
            Place::Line(3),
            "0 after 0",
        ),
        (
            "not finite",
            |t| t.columns[2].1[1] = Some(f64::NAN),
            Place::Line(3),
            "NaN",
        ),
    ];
    for (what, damage, place, word) in cases {
        let mut table = good.clone();
        damage(&mut table);
        refused(what, &table.write("a.csv").unwrap_err(), *place, word);
    }
}

#[test]
fn the_header_is_known() {
    assert!(sniff(EXAMPLE.as_bytes()));
    assert!(!sniff(b"time,root_x,root_y,root_z,head_x"));
}
