use kineme::math::rotation::Axis;
use kineme_formats::Place;
use kineme_formats::tables::positions::{parse, sniff};
use nalgebra::Vector3;

use crate::{point, refuses, warns};

const EXAMPLE: &str = "\
frame,head_x,head_y,head_z,hip_center_x,hip_center_y,hip_center_z,left_hand_x,left_hand_y,left_hand_z
0,0.1,1.7,2.5,0.1,1.0,2.5,-0.4,1.1,2.4
1,0.1,1.7,2.5,0.1,1.0,2.5,,,
2,0.1,1.7,2.5,0.1,1.0,2.5,NaN,1.3,2.4
";

#[test]
fn a_table_is_turned_to_z_up_and_its_gaps_are_missing() {
    let r = parse("a.csv", EXAMPLE.as_bytes(), None).unwrap();
    assert_eq!((r.frames(), r.rate_hz(), r.dof()), (3, 30.0, 9));
    assert_eq!(r.source().up, Axis::Y);
    assert_eq!(point(&r, 0, "head"), Some(Vector3::new(2.5, 0.1, 1.7)));
    assert_eq!(
        point(&r, 0, "left_hand"),
        Some(Vector3::new(2.4, -0.4, 1.1))
    );
    assert_eq!(point(&r, 1, "left_hand"), None);
    assert_eq!(point(&r, 2, "left_hand"), None);
    for words in ["30 Hz assumed", "up axis: y", "2 of 9 points missing"] {
        assert!(warns(&r, words), "{words}: {:?}", r.source().warnings);
    }
}

#[test]
fn kinect_joints_get_their_nearest_present_parent_and_others_none() {
    let r = parse("a.csv", EXAMPLE.as_bytes(), None).unwrap();
    let tree: Vec<_> = r
        .joints()
        .iter()
        .map(|j| (j.name.as_str(), j.parent))
        .collect();
    assert_eq!(
        tree,
        [
            ("hip_center", None),
            ("head", Some(0)),
            ("left_hand", Some(0))
        ]
    );
    let sdk = EXAMPLE
        .replace("hip_center", "HipCenter")
        .replace("left_hand", "HandLeft");
    let r = parse("a.csv", sdk.as_bytes(), None).unwrap();
    assert_eq!(r.joints()[2].name, "HandLeft");
    assert_eq!(r.joints()[2].parent, Some(0));
    let other = EXAMPLE.replace("left_hand", "tail");
    let r = parse("a.csv", other.as_bytes(), None).unwrap();
    let names: Vec<_> = r.joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["head", "hip_center", "tail"]);
    assert!(r.joints().iter().all(|j| j.parent.is_none()));
}

/// `rows` of a table of one joint; rate, and frames with a `.` where nothing was seen.
fn timing(first: &str, rows: &[f64], given: Option<f64>) -> (f64, String) {
    let mut text = format!("{first},a_x,a_y,a_z\n");
    for t in rows {
        text += &format!("{t},1,2,3\n");
    }
    let r = parse("a.csv", text.as_bytes(), given).unwrap();
    let seen = (0..r.frames())
        .map(|f| {
            if point(&r, f, "a").is_some() {
                'x'
            } else {
                '.'
            }
        })
        .collect();
    (r.rate_hz(), seen)
}

#[test]
fn rates_and_gaps_follow_the_time_base() {
    type Case<'a> = (&'a str, &'a [f64], Option<f64>, f64, &'a str);
    let cases: &[Case<'_>] = &[
        ("time", &[0.0, 0.02, 0.04], Some(7.0), 50.0, "xxx"),
        ("time", &[5.0, 5.033, 5.067, 5.1], None, 30.0, "xxxx"),
        ("time", &[0.0, 0.1, 0.2, 0.5, 0.6], None, 10.0, "xxx..xx"),
        ("frame", &[0.0, 1.0, 2.0], None, 30.0, "xxx"),
        ("frame", &[1.0, 2.0, 4.0, 5.0], Some(60.0), 60.0, "xx.xx"),
        ("frame", &[0.0, 4.0, 8.0], Some(120.0), 30.0, "xxx"),
        ("time", &[3.0], Some(25.0), 25.0, "x"),
    ];
    for (first, rows, given, rate, seen) in cases {
        let (found, frames) = timing(first, rows, *given);
        assert!(
            (found - rate).abs() < 1e-9 * rate,
            "{first} {rows:?}: {found} Hz"
        );
        assert_eq!(frames, *seen, "{first} {rows:?}");
    }
}

#[test]
fn uneven_times_are_told() {
    let text = "time,a_x,a_y,a_z\n0,1,2,3\n0.1,1,2,3\n0.24,1,2,3\n0.3,1,2,3\n0.4,1,2,3\n";
    let r = parse("a.csv", text.as_bytes(), None).unwrap();
    assert!(
        warns(&r, "40.0 ms off an even 10.000 Hz"),
        "{:?}",
        r.source().warnings
    );
}

#[test]
fn up_is_the_body_s_long_axis() {
    let table = |head: &str, foot: &str| {
        format!("time,Head_x,Head_y,Head_z,LeftFoot_x,LeftFoot_y,LeftFoot_z\n0,{head},{foot}\n")
    };
    let cases = [
        ("y up", table("0,1.6,0.1", "0,0,0"), Axis::Y, "up axis: y"),
        ("z up", table("0.1,0.2,1.6", "0,0,0"), Axis::Z, "up axis: z"),
        (
            "y down",
            table("0,-1.6,0.1", "0,0,0"),
            Axis::Y,
            "upside down",
        ),
        (
            "lying",
            table("1.6,0.0,0.3", "0,0,0"),
            Axis::Z,
            "the body lies",
        ),
        (
            "centimetres",
            table("0,160,0.1", "0,0,0"),
            Axis::Y,
            "in metres?",
        ),
        (
            "no body",
            "time,a_x,a_y,a_z\n0,0,9,0\n".to_string(),
            Axis::Z,
            "z assumed",
        ),
    ];
    for (what, text, up, words) in cases {
        let r = parse("a.csv", text.as_bytes(), None).unwrap();
        assert_eq!(r.source().up, up, "{what}");
        assert!(warns(&r, words), "{what}: {:?}", r.source().warnings);
    }
}

#[test]
fn other_columns_are_ignored_and_told_and_order_is_free() {
    let text = "\u{feff}Time,visible,a_z,a_x,a_y\r\n0,yes,3,1,2\r\n\r\n0.5,no,6,4,5\r\n";
    let r = parse("a.csv", text.as_bytes(), None).unwrap();
    assert_eq!((r.frames(), r.rate_hz()), (2, 2.0));
    assert_eq!(point(&r, 1, "a"), Some(Vector3::new(4.0, 5.0, 6.0)));
    assert!(warns(&r, "`visible`"));
}

#[test]
fn damaged_tables_are_refused_with_the_line() {
    let header = Place::Line(1);
    refuses(
        &[
            ("empty", "", Place::File, "nothing"),
            ("no header", "1,2,3,4\n", header, "`1` first"),
            ("no joint", "frame,a,b\n1,2,3\n", header, "no joint"),
            ("lost axis", "frame,a_x,a_y\n1,2,3\n", header, "`a`"),
            ("twice", "frame,a_x,a_y,a_z,a_x\n", header, "`a_x` twice"),
            ("twice, case", "frame,a_x,a_y,a_z,a_X\n", header, "`a_X`"),
            ("no row", "frame,a_x,a_y,a_z\n", Place::File, "no row"),
            (
                "word",
                "frame,a_x,a_y,a_z\n0,1,2,3\n1,1,two,3\n",
                Place::Line(3),
                "`two`",
            ),
            (
                "infinite",
                "frame,a_x,a_y,a_z\n0,1,inf,3\n",
                Place::Line(2),
                "`inf`",
            ),
            (
                "short row",
                "frame,a_x,a_y,a_z\n0,1,2,3\n1,2\n",
                Place::Line(3),
                "2 cells",
            ),
            (
                "no frame",
                "frame,a_x,a_y,a_z\n,1,2,3\n",
                Place::Line(2),
                "no frame",
            ),
            (
                "time back",
                "time,a_x,a_y,a_z\n1,1,2,3\n1,1,2,3\n",
                Place::Line(3),
                "1 after 1",
            ),
            (
                "crlf, blank",
                "frame,a_x,a_y,a_z\r\n0,1,2,3\r\n\r\n1,x,2,3\r\n",
                Place::Line(4),
                "`x`",
            ),
            (
                "chasm",
                "frame,a_x,a_y,a_z\n0,1,2,3\n1,1,2,3\n9e9,1,2,3\n",
                Place::File,
                "gaps",
            ),
            (
                "no text",
                "frame,a_x,a_y,a_z\n0,1,2,\u{7f}\n",
                Place::Line(2),
                "\u{7f}",
            ),
        ],
        |bytes| parse("a.csv", bytes, None),
    );
}

#[test]
fn the_header_tells_positions_from_angles() {
    let cases = [
        ("frame,head_x,head_y,head_z,neck_x", true),
        ("\u{feff}time,\"a_x\",a_y,a_z\r\n", true),
        ("time,root_x,root_y,root_z,root_yaw,elbow", false),
        ("frame,a_x,b_y,c_z", false),
        ("file,start,end", false),
        ("time", false),
        ("", false),
    ];
    for (header, positions) in cases {
        assert_eq!(sniff(header.as_bytes()), positions, "{header}");
    }
}
