use kineme::math::rotation::Axis;
use kineme_formats::Place;
use kineme_formats::tables::msr::{LINE_ORDER, parse, sniff};
use nalgebra::Vector3;

use crate::{point, refused, refuses, warns};

/// Two frames; in the second the head was not seen and the left hand is a guess.
fn example() -> String {
    let mut text = String::new();
    for frame in 0..2 {
        for line in 0..20 {
            text += &match (frame, line) {
                (1, 19) => "0.000000 0.000000 0.000000 0.000000\n".to_string(),
                (1, 11) => "0.5 0.6 0.7 0.000000\n".to_string(),
                _ => format!("{line}.5 {frame}.25 2.0 1.000000\n"),
            };
        }
    }
    text
}

#[test]
fn a_frame_is_twenty_lines_in_the_publishers_order() {
    let r = parse("a.txt", example().as_bytes(), None).unwrap();
    assert_eq!((r.frames(), r.rate_hz(), r.dof()), (2, 15.0, 60));
    assert_eq!((r.source().up, r.source().unit_metres), (Axis::Y, 1.0));
    assert!(warns(&r, "15 Hz assumed") && warns(&r, "1 of 40 points missing"));
    for (line, joint) in LINE_ORDER.iter().enumerate() {
        let expected = Vector3::new(2.0, line as f64 + 0.5, 0.25);
        assert_eq!(point(&r, 0, joint), Some(expected), "{joint}");
    }
    assert_eq!(point(&r, 1, "head"), None);
    assert_eq!(point(&r, 1, "left_hand"), Some(Vector3::new(0.7, 0.5, 0.6)));
    assert_eq!(
        parse("a.txt", example().as_bytes(), Some(20.0))
            .unwrap()
            .rate_hz(),
        20.0
    );
}

#[test]
fn damaged_text_is_refused_with_the_line() {
    let good = example();
    let cut: String = good.lines().take(33).map(|l| format!("{l}\n")).collect();
    let word = good.replace("12.5 0.25 2.0", "12.5 x 2.0");
    let five = good.replace("12.5 0.25 2.0", "12.5 0.25 2.0 9");
    let infinite = good.replace("12.5 0.25 2.0", "12.5 1e999 2.0");
    refuses(
        &[
            ("empty", "", Place::Line(1), "0 lines of frame 1"),
            ("cut", &cut, Place::Line(33), "13 lines of frame 2"),
            ("word", &word, Place::Line(13), "`x`"),
            ("five numbers", &five, Place::Line(13), "5 numbers"),
            ("infinite", &infinite, Place::Line(13), "`1e999`"),
        ],
        |bytes| parse("a.txt", bytes, None),
    );
    let error = parse("a.txt", b"1 2 3 1\n\xff", None).unwrap_err();
    refused("no text", &error, Place::Byte(8), "no text");
}

#[test]
fn the_text_is_known_by_its_first_twenty_lines() {
    let good = example();
    let at = |n: usize| good.as_bytes()[..n].to_vec();
    let cases = [
        ("whole", at(good.len()), true),
        ("cut in a line", at(good.len() - 3), true),
        ("too short", at(200), false),
        (
            "three numbers",
            good.replace(" 1.000000", "").into_bytes(),
            false,
        ),
        (
            "no confidence",
            good.replace(" 1.000000", " 7").into_bytes(),
            false,
        ),
        ("prose", b"Twenty lines a frame\n".repeat(30), false),
    ];
    for (what, bytes, expected) in cases {
        assert_eq!(sniff(&bytes), expected, "{what}");
    }
}
