use kineme_formats::Place::{File, Line};
use kineme_formats::manifest::parse;

use crate::refuses;

const EXAMPLE: &str = "\
file,label,start,end,rate,p1,p2
takes/jabs.bvh,jab,0.5,1.25,,0.9,-0.2
takes/jabs.bvh,jab,1.6,2.3,,0,1e-3
\"set.zip/inner/b, second.amc\",wave,,,120,,
takes/swim.bvh,,,,,,
";

#[test]
fn a_manifest_is_labelled_motions_in_the_order_of_the_rows() {
    let found = parse("m.csv", EXAMPLE.as_bytes()).unwrap();
    let rows: Vec<_> = found
        .iter()
        .map(|r| {
            (
                r.file.as_str(),
                r.label.as_deref(),
                r.span_secs,
                r.rate_hz,
                r.line,
            )
        })
        .collect();
    assert_eq!(
        rows,
        [
            ("takes/jabs.bvh", Some("jab"), Some((0.5, 1.25)), None, 2),
            ("takes/jabs.bvh", Some("jab"), Some((1.6, 2.3)), None, 3),
            (
                "set.zip/inner/b, second.amc",
                Some("wave"),
                None,
                Some(120.0),
                4
            ),
            ("takes/swim.bvh", None, None, None, 5),
        ]
    );
    let parameters: Vec<_> = found.iter().map(|r| r.parameters.as_slice()).collect();
    assert_eq!(parameters, [&[0.9, -0.2][..], &[0.0, 1e-3], &[], &[]]);
}

#[test]
fn columns_that_say_nothing_may_be_left_out() {
    let short: &[(&str, &str)] = &[
        ("two columns", "file,label\na,wave\n"),
        ("another order", "label,p1,file\nwave,,a\n"),
        (
            "windows and a byte order mark",
            "\u{feff}file,label\r\n\r\na,wave\r\n",
        ),
        ("spaces", " file , label \n a , wave \n"),
        (
            "missing numbers",
            "file,label,start,end,rate,p1\na,wave,nan,NaN,,nan\n",
        ),
    ];
    for (what, text) in short {
        let rows = parse("m.csv", text.as_bytes()).unwrap_or_else(|e| panic!("{what}: {e}"));
        let [row] = rows.as_slice() else {
            panic!("{what}: {} rows", rows.len());
        };
        assert_eq!(
            (row.file.as_str(), row.label.as_deref()),
            ("a", Some("wave")),
            "{what}"
        );
        assert_eq!((row.span_secs, row.rate_hz), (None, None), "{what}");
        assert!(row.parameters.is_empty(), "{what}");
    }
}

#[test]
fn labels_may_have_different_numbers_of_parameters() {
    let text = "file,label,p1,p2\na,jab,1,2\nb,wave,3,\nc,rest,,\nd,wave,4,\ne,jab,5,6\n";
    let found = parse("m.csv", text.as_bytes()).unwrap();
    let parameters: Vec<_> = found.iter().map(|r| r.parameters.as_slice()).collect();
    assert_eq!(
        parameters,
        [&[1.0, 2.0][..], &[3.0], &[], &[4.0], &[5.0, 6.0]]
    );
}

#[test]
fn damaged_manifests_are_refused_with_the_line() {
    let with = |from: &str, to: &str| {
        assert!(EXAMPLE.contains(from), "{from}");
        EXAMPLE.replacen(from, to, 1)
    };
    refuses(
        &[
            ("empty", "", File, "nothing"),
            ("no rows", "file,label\n", File, "no motion"),
            (
                "no file column",
                "label,start,end\na,0,1\n",
                Line(1),
                "no column `file`",
            ),
            ("no label column", "file\na\n", Line(1), "no column `label`"),
            (
                "no header",
                "a.bvh,wave\nb.bvh,wave\n",
                Line(1),
                "column `a.bvh`",
            ),
            (
                "typo below a blank line",
                "\nfile,lable\na,b\n",
                Line(2),
                "column `lable`",
            ),
            ("twice", &with("p2", "p1"), Line(1), "column `p1` twice"),
            ("gap", &with("p1,p2", "p1,p3"), Line(1), "column `p3`"),
            ("order", &with("p1,p2", "p2,p1"), Line(1), "column `p2`"),
            ("from 0", &with("p1,p2", "p0,p1"), Line(1), "column `p0`"),
            ("padded", &with("p1,p2", "p01,p02"), Line(1), "column `p01`"),
            (
                "named",
                &with("p1,p2", "p:height,p:side"),
                Line(1),
                "column `p:height`",
            ),
            ("upper case", "File,label\na,b\n", Line(1), "column `File`"),
            (
                "without a name",
                "file,label,\na,b,\n",
                Line(1),
                "column ``",
            ),
            (
                "start alone",
                "file,label,start\na,b,0\n",
                Line(1),
                "`start` without `end`",
            ),
            (
                "end alone",
                "file,label,end\na,b,0\n",
                Line(1),
                "`end` without `start`",
            ),
            ("no file", &with("takes/swim.bvh", " "), Line(5), "no file"),
            ("no end", &with("0.5,1.25", "0.5,"), Line(2), "no end"),
            ("no start", &with("0.5,1.25", ",1.25"), Line(2), "no start"),
            (
                "backwards",
                &with("0.5,1.25", "1.25,0.5"),
                Line(2),
                "end 0.5 not after start 1.25",
            ),
            (
                "no length",
                &with("0.5,1.25", "0.5,0.5"),
                Line(2),
                "end 0.5 not after",
            ),
            (
                "negative",
                &with("0.5,1.25", "-0.5,1.25"),
                Line(2),
                "start -0.5",
            ),
            ("word", &with("0.5,1.25", "begin,1.25"), Line(2), "`begin`"),
            ("rate 0", &with("120", "0"), Line(4), "rate 0"),
            ("rate below 0", &with("120", "-25"), Line(4), "rate -25"),
            ("infinite rate", &with("120", "inf"), Line(4), "`inf`"),
            (
                "rates differ",
                &with("1.6,2.3,", "1.6,2.3,60"),
                Line(3),
                "rate 60 of `takes/jabs.bvh`",
            ),
            (
                "rate lost",
                "file,label,rate\na,b,30\na,b,\n",
                Line(3),
                "no rate of `a`",
            ),
            ("infinite", &with("0.9", "1e999"), Line(2), "`1e999`"),
            ("parameter word", &with("0.9", "high"), Line(2), "`high`"),
            (
                "parameter gap",
                &with("0.9,", ","),
                Line(2),
                "p2 without p1",
            ),
            (
                "parameter lost",
                &with("0,1e-3", "0,"),
                Line(3),
                "1 parameters of `jab`",
            ),
            (
                "parameter gained",
                "file,label,p1,p2\na,jab,1,\nb,jab,1,2\n",
                Line(3),
                "2 parameters of `jab`",
            ),
            (
                "parameters lost",
                &with("0,1e-3", ","),
                Line(3),
                "0 parameters of `jab`",
            ),
            (
                "parameter of a negative",
                &with("swim.bvh,,,,,,", "swim.bvh,,,,,1,"),
                Line(5),
                "p1 without a label",
            ),
            (
                "cells",
                &with("swim.bvh,,,,,,", "swim.bvh,,,,,,,"),
                Line(5),
                "8 cells",
            ),
            (
                "few cells",
                &with("swim.bvh,,,,,,", "swim.bvh,"),
                Line(5),
                "2 cells",
            ),
        ],
        |bytes| parse("m.csv", bytes),
    );
}

#[test]
fn hostile_manifests_are_refused() {
    let many: String = (1..=50_000).map(|i| format!(",p{i}")).collect();
    let wide = format!("file,label{many}\na,b\n");
    let open_quote = format!("file,label\n\"{}", "a,b\n".repeat(100_000));
    let endless = format!("file,label\na,b,{}\n", "9".repeat(1_000_000));
    refuses(
        &[
            ("wide", &wide, Line(2), "2 cells"),
            ("open quote", &open_quote, Line(2), "1 cells"),
            ("endless", &endless, Line(2), "3 cells"),
            ("NUL", "file,label\0\na,b\n", Line(1), "column"),
        ],
        |bytes| parse("m.csv", bytes),
    );
    let latin = parse("m.csv", b"file,label\nb\xfccken.bvh,wave\n").unwrap_err();
    crate::refused("Latin-1", &latin, Line(2), "no text");
}
