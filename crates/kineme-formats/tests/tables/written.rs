use std::collections::BTreeMap;

use kineme::Role;
use kineme::math::rotation::Axis;
use kineme_formats::Place::{File, Line};
use kineme_formats::{marks, profile, script};

use crate::refuses;

const MARKS: &str = "\
file,start,end,recording
set.zip/inner/a.bvh,0.5,1.25,session-1
\"b, second.bvh\",0,0.9,
";

#[test]
fn marks_are_spans_in_the_order_of_the_rows() {
    let found = marks::parse("m.csv", MARKS.as_bytes()).unwrap();
    let rows: Vec<_> = found
        .iter()
        .map(|m| {
            (
                m.file.as_str(),
                m.start,
                m.end,
                m.recording.as_deref(),
                m.line,
            )
        })
        .collect();
    assert_eq!(
        rows,
        [
            ("set.zip/inner/a.bvh", 0.5, 1.25, Some("session-1"), 2),
            ("b, second.bvh", 0.0, 0.9, None, 3)
        ]
    );
}

#[test]
fn lines_are_those_of_an_editor() {
    let cases = [
        ("unix", "file,start,end\na,0,1\nb,0,1\n", [2, 3]),
        ("windows", "file,start,end\r\na,0,1\r\nb,0,1\r\n", [2, 3]),
        (
            "blank lines",
            "\nfile,start,end\n\n\na,0,1\n\nb,0,1",
            [5, 7],
        ),
        (
            "blank windows",
            "file,start,end\r\n\r\na,0,1\r\n\r\n\r\nb,0,1\r\n",
            [3, 6],
        ),
        (
            "quoted newline",
            "file,start,end\n\"a\nx\",0,1\nb,0,1\n",
            [2, 4],
        ),
    ];
    for (what, text, lines) in cases {
        let found = marks::parse("m.csv", text.as_bytes()).unwrap();
        let found: Vec<_> = found.iter().map(|m| m.line).collect();
        assert_eq!(found, lines, "{what}");
    }
}

#[test]
fn damaged_marks_are_refused_with_the_line() {
    refuses(
        &[
            ("empty", "", File, "nothing"),
            ("no rows", "file,start,end\n", File, "no mark"),
            ("no end", "file,start\na,0\n", Line(1), "`file,start`"),
            (
                "typo",
                "file,start,end,recroding\na,0,1,b\n",
                Line(1),
                "`recroding`",
            ),
            (
                "backwards",
                "file,start,end\na,0,1\na,2,1\n",
                Line(3),
                "end 1 not after start 2",
            ),
            ("negative", "file,start,end\na,-1,1\n", Line(2), "start -1"),
            ("no file", "file,start,end\n,0,1\n", Line(2), "no file"),
            ("no start", "file,start,end\na,,1\n", Line(2), "no start"),
            ("word", "file,start,end\na,0,end\n", Line(2), "`end`"),
        ],
        |bytes| marks::parse("m.csv", bytes),
    );
}

const PROFILE: &str = r#"
name = "my-robot"
up = "y"
unit_metres = 0.01
[roles]
hips = "Hips"
left_upper_arm = ["left_shoulder_pitch_joint", "left_shoulder_roll_joint", "left_shoulder_yaw_joint"]
"#;

#[test]
fn a_profile_maps_roles_to_joints() {
    let p = profile::parse("p.toml", PROFILE.as_bytes()).unwrap();
    assert_eq!(
        (p.name.as_str(), p.up, p.unit_metres),
        ("my-robot", Some(Axis::Y), Some(0.01))
    );
    assert_eq!(p.roles[&Role::Hips], ["Hips"]);
    assert_eq!(p.roles[&Role::LeftUpperArm].len(), 3);
    let short = profile::parse("p.toml", b"name = 'r'\nroles = { head = 'H' }").unwrap();
    assert_eq!((short.up, short.unit_metres), (None, None));
}

#[test]
fn damaged_profiles_are_refused_with_the_line() {
    let with = |from: &str, to: &str| {
        assert!(PROFILE.contains(from), "{from}");
        PROFILE.replace(from, to)
    };
    refuses(
        &[
            ("empty", "", Line(1), "no `name`"),
            ("no TOML", &with("hips = ", "hips "), Line(6), "key"),
            ("no roles", "name = 'a'", Line(1), "no `roles`"),
            ("empty roles", "name = 'a'\nroles = {}", Line(2), "no role"),
            (
                "typo",
                &with("unit_metres", "unit_meters"),
                Line(4),
                "`unit_meters`",
            ),
            (
                "no role",
                &with("hips", "hip"),
                Line(6),
                "unknown role `hip`",
            ),
            ("up x", &with("\"y\"", "\"x\""), Line(3), "`x`"),
            ("up 1", &with("\"y\"", "1"), Line(3), "type integer"),
            ("no unit", &with("0.01", "0"), Line(4), "0"),
            ("infinite", &with("0.01", "inf"), Line(4), "`inf`"),
            ("number", &with("\"Hips\"", "3.5"), Line(6), "type float"),
            (
                "list of numbers",
                &with("\"Hips\"", "[3]"),
                Line(6),
                "type integer",
            ),
            ("no joint", &with("\"Hips\"", "[]"), Line(6), "no joint"),
            ("blank", &with("\"Hips\"", "' '"), Line(6), "empty"),
            (
                "shared",
                &with("\"Hips\"", "'left_shoulder_roll_joint'"),
                Line(7),
                "`hips` has too",
            ),
        ],
        |bytes| profile::parse("p.toml", bytes),
    );
}

const SCRIPT: &str = r#"body = "ares"
[[exemplar]]
primitive = "jab"
parameters = { height = 0.5, side = 0.0 }
keys = [
  { time = 0.00, right_upper_arm = [20, 10, 0], right_lower_arm = [110] },
  { time = 0.28, right_upper_arm = [85, 5, -10], right_lower_arm = [5], chest = [0, 0, 25] },
  { time = 0.60, right_upper_arm = [20, 10, 0], right_lower_arm = [110], chest = [0, 0, 0] },
]
[[animation]]            # a motion that is no primitive: a negative
name = "swat-bees"
keys = [ { time = 0.0 }, { time = 0.4, left_upper_arm = [120, 40, 0] }, { time = 0.9 } ]
"#;

#[test]
fn a_script_is_exemplars_and_animations_of_key_postures() {
    let s = script::parse("s.toml", SCRIPT.as_bytes()).unwrap();
    assert_eq!(s.body, "ares");
    let jab = &s.exemplars[0];
    assert_eq!(jab.primitive, "jab");
    let parameters = [("height".to_string(), 0.5), ("side".to_string(), 0.0)];
    assert_eq!(jab.parameters, BTreeMap::from(parameters));
    assert_eq!(jab.keys[1].time, 0.28);
    assert_eq!(jab.keys[1].angles[&Role::RightUpperArm], [85.0, 5.0, -10.0]);
    assert_eq!(jab.keys[1].angles[&Role::RightLowerArm], [5.0]);
    assert_eq!(
        (s.animations[0].name.as_str(), s.animations[0].keys.len()),
        ("swat-bees", 3)
    );
    assert!(s.animations[0].keys[0].angles.is_empty());
}

#[test]
fn damaged_scripts_are_refused_with_the_line() {
    let with = |from: &str, to: &str| {
        assert!(SCRIPT.contains(from), "{from}");
        SCRIPT.replace(from, to)
    };
    let again = |from: &str, to: &str| {
        let start = SCRIPT.find("[[exemplar]]").unwrap();
        let end = SCRIPT.find("[[animation]]").unwrap();
        SCRIPT.to_string() + &SCRIPT[start..end].replace(from, to)
    };
    let animation = SCRIPT[SCRIPT.find("[[animation]]").unwrap()..].to_string();
    refuses(
        &[
            ("no body", "[[exemplar]]\n", Line(1), "no `body`"),
            ("nothing", "body = 'ares'", Line(1), "at least one"),
            (
                "typo",
                &with("[[animation]]", "[[animations]]"),
                Line(10),
                "`animations`",
            ),
            (
                "typo inside",
                &with("parameters", "parameter"),
                Line(4),
                "`parameter`",
            ),
            (
                "no primitive",
                &with("primitive = \"jab\"\n", ""),
                Line(2),
                "no `primitive`",
            ),
            (
                "no keys",
                "body = 'a'\n[[animation]]\nname = 'b'",
                Line(2),
                "no `keys`",
            ),
            (
                "one table",
                "body = 'a'\n[animation]\nname = 'b'",
                Line(2),
                "type table",
            ),
            ("body 3", &with("\"ares\"", "3"), Line(1), "type integer"),
            ("blank", &with("\"jab\"", "\"\""), Line(3), "empty"),
            (
                "word",
                &with("height = 0.5", "height = 'low'"),
                Line(4),
                "type string",
            ),
            (
                "no parameter",
                &with("height = 0.5", "height = nan"),
                Line(4),
                "`nan`",
            ),
            (
                "no role",
                &with("chest = [0, 0, 25]", "chst = [0, 0, 25]"),
                Line(7),
                "`chst`",
            ),
            ("no time", &with("time = 0.28, ", ""), Line(7), "no `time`"),
            ("no list", &with("= [5]", "= 5"), Line(7), "type integer"),
            (
                "two angles",
                &with("[85, 5, -10]", "[85, 5]"),
                Line(7),
                "2 angles",
            ),
            (
                "time back",
                &with("time = 0.60", "time = 0.28"),
                Line(8),
                "times rise",
            ),
            (
                "in a year",
                &with("time = 0.60", "time = 3e7"),
                Line(8),
                "within 3600 s",
            ),
            (
                "before 0",
                &with("time = 0.00", "time = -1"),
                Line(6),
                "not negative",
            ),
            (
                "one key",
                &with(
                    "{ time = 0.4, left_upper_arm = [120, 40, 0] }, { time = 0.9 }",
                    "",
                ),
                Line(10),
                "at least two",
            ),
            (
                "key 3",
                &with("{ time = 0.0 }", "3"),
                Line(12),
                "type integer",
            ),
            (
                "parameters differ",
                &again("side", "reach"),
                Line(13),
                "[height, side] and [height, reach]",
            ),
            (
                "animation twice",
                &format!("{SCRIPT}{animation}"),
                Line(13),
                "second animation",
            ),
            (
                "key twice",
                &with("body = \"ares\"", "body = \"ares\"\nbody = \"a\""),
                Line(2),
                "duplicate",
            ),
            (
                "huge integer",
                &with("height = 0.5", "height = 99999999999999999999"),
                Line(4),
                "9999",
            ),
        ],
        |bytes| script::parse("s.toml", bytes),
    );
    assert_eq!(
        script::parse("s.toml", again("0.5", "0.9").as_bytes())
            .unwrap()
            .exemplars
            .len(),
        2
    );
}
