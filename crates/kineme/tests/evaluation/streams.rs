//! Answers to every frame: cases counted by hand.

use kineme::evaluation::{Stream, StreamScores, StreamSettings, stream_scores};
use kineme::primitive::{Posterior, Reading};

/// Labels of frames: a dot for none, letters for primitives.
fn labels(text: &str) -> Vec<Option<usize>> {
    let label = |b: u8| b.is_ascii_lowercase().then(|| usize::from(b - b'a'));
    text.bytes().map(label).collect()
}

/// Streams at 10 Hz, one a pair of truth and answers.
fn judged(pairs: &[(&str, &str)], margin_secs: f64) -> StreamScores {
    let stream = |(truth, answers): &(&str, &str)| {
        Stream::new(10.0, labels(truth), labels(answers)).expect("a stream")
    };
    let streams: Vec<Stream> = pairs.iter().map(stream).collect();
    stream_scores(&streams, &StreamSettings { margin_secs }).expect("scores")
}

#[test]
fn spans_delays_and_alarms_are_counted_by_hand() {
    // Truth, answers, margin; then spans, missed, median and p90 of the delay (seconds), false alarms.
    for (truth, answers, margin, spans, missed, delays, alarms) in [
        (
            "..aaaa..bb..",
            "..aaaa..bb..",
            0.0,
            2,
            0,
            Some((0.0, 0.0)),
            0,
        ),
        (
            "..aaaa..bb..",
            "....aa...b..",
            0.0,
            2,
            0,
            Some((0.15, 0.19)),
            0,
        ),
        ("..aaaa..bb..", "............", 0.0, 2, 2, None, 0),
        (
            "..aaaa..bb..",
            ".....a......",
            0.0,
            2,
            1,
            Some((0.3, 0.3)),
            0,
        ),
        // One that lingers, and one that comes early: alarms unless within the margin.
        (
            "..aaaa..bb..",
            "..aaaaa.bb..",
            0.0,
            2,
            0,
            Some((0.0, 0.0)),
            1,
        ),
        (
            "..aaaa..bb..",
            "..aaaaa.bb..",
            0.1,
            2,
            0,
            Some((0.0, 0.0)),
            0,
        ),
        (
            "..aaaa..bb..",
            "..aaaaaabb..",
            0.1,
            2,
            0,
            Some((0.0, 0.0)),
            1,
        ),
        (
            "..aaaa..bb..",
            ".aaaaa..bb..",
            0.0,
            2,
            0,
            Some((0.0, 0.0)),
            1,
        ),
        // Another primitive inside a true span is an alarm; each run counts once.
        (
            "..aaaa..bb..",
            "..abba..bb.c",
            0.1,
            2,
            0,
            Some((0.0, 0.0)),
            2,
        ),
        ("............", "bbb..ccaa..b", 0.1, 0, 0, None, 4),
        // A steady answer that is right once is wrong on both sides.
        (
            "....aaaa....",
            "aaaaaaaaaaaa",
            0.0,
            1,
            0,
            Some((0.0, 0.0)),
            2,
        ),
        // Spans of two primitives that touch.
        ("aaabbb", "aaaabb", 0.0, 2, 0, Some((0.05, 0.09)), 1),
    ] {
        let found = judged(&[(truth, answers)], margin);
        let case = format!("{truth} {answers} {margin}: {found:?}");
        assert_eq!(
            (found.spans, found.missed, found.false_alarms),
            (spans, missed, alarms),
            "{case}"
        );
        let onset = found.onset.map(|d| (d.median_secs, d.p90_secs));
        let near = match (onset, delays) {
            (Some(f), Some(w)) => (f.0 - w.0).abs() < 1e-12 && (f.1 - w.1).abs() < 1e-12,
            (f, w) => f == w,
        };
        assert!(near, "{case}");
        assert!((found.minutes - truth.len() as f64 / 600.0).abs() < 1e-12);
    }
}

#[test]
fn frames_are_balanced_over_the_classes_that_are_present() {
    let found = judged(&[("aa......", "a......b")], 0.0);
    assert!((found.balanced_accuracy - (0.5 + 5.0 / 6.0) / 2.0).abs() < 1e-12);
    // Recordings count together, not one by one.
    let found = judged(&[("aaaa", "aaaa"), ("aa..", "....")], 0.0);
    assert!((found.balanced_accuracy - (4.0 / 6.0 + 1.0) / 2.0).abs() < 1e-12);
    let alarms = judged(
        &[
            ("............", "a.b......a.."),
            ("............", "............"),
        ],
        0.0,
    );
    assert!((alarms.false_alarms_a_minute() - 3.0 / 0.04).abs() < 1e-9);
}

#[test]
fn readings_answer_what_is_more_probable_than_rest_and_none() {
    let reading = |p: [f64; 2], rest: f64, none: f64| Reading {
        posterior: Posterior {
            primitives: p.to_vec(),
            rest,
            none,
        },
        place: None,
        novelty: 0.0,
    };
    let readings = [
        reading([0.6, 0.2], 0.1, 0.1),
        reading([0.1, 0.3], 0.4, 0.2),
        reading([0.1, 0.4], 0.1, 0.4),
        reading([0.1, 0.5], 0.2, 0.2),
    ];
    let told = Stream::of_readings(10.0, labels("a..b"), &readings).expect("a stream");
    assert_eq!(
        told,
        Stream::new(10.0, labels("a..b"), labels("a..b")).expect("a stream")
    );
}

#[test]
fn streams_that_are_none_are_refused() {
    for (rate, truth, answers) in [
        (10.0, "", ""),
        (10.0, "aa", "a"),
        (0.0, "aa", "aa"),
        (f64::NAN, "aa", "aa"),
    ] {
        let refused = Stream::new(rate, labels(truth), labels(answers));
        assert!(refused.is_err(), "{rate} {truth} {answers}");
    }
    let stream = Stream::new(10.0, labels("a"), labels("a")).expect("a stream");
    for margin_secs in [-1.0, f64::NAN, f64::INFINITY] {
        let settings = StreamSettings { margin_secs };
        assert!(stream_scores(std::slice::from_ref(&stream), &settings).is_err());
    }
    assert!(stream_scores(&[], &StreamSettings::default()).is_err());
}
