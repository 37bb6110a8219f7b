//! Motions of a body: validity, parts of them, other rates, paths of effectors.

use std::sync::Arc;

use kineme::{Motion, Root, Skeleton, adonis};
use nalgebra::Vector3;

fn body() -> Arc<Skeleton> {
    Arc::new(adonis().expect("a body"))
}

/// Every coordinate and the root grow linearly with time: 1, 2, 3, ... a second.
fn ramp(frames: usize, rate_hz: f64) -> Motion {
    let body = body();
    let at = |f: usize, i: usize| f as f64 / rate_hz * 0.1 * (i + 1) as f64;
    let poses = (0..frames)
        .flat_map(|f| (0..20).map(move |i| at(f, i)))
        .collect();
    let roots = (0..frames)
        .map(|f| Root {
            position: Vector3::new(at(f, 9), 0.0, 1.0),
            yaw: at(f, 99),
        })
        .collect();
    Motion::new("ramp", body, rate_hz, poses, roots).expect("a motion")
}

#[test]
fn a_motion_that_exists_is_valid() {
    let make = |rate: f64, poses: Vec<f64>, yaws: Vec<f64>| {
        let roots = yaws
            .iter()
            .map(|&yaw| Root {
                yaw,
                ..Root::ORIGIN
            })
            .collect();
        Motion::new("m", body(), rate, poses, roots)
    };
    assert!(make(30.0, vec![0.0; 40], vec![0.0; 2]).is_ok());
    for (what, found) in [
        ("no frames", make(30.0, vec![], vec![])),
        (
            "a coordinate short",
            make(30.0, vec![0.0; 39], vec![0.0; 2]),
        ),
        ("a root short", make(30.0, vec![0.0; 40], vec![0.0])),
        ("no rate", make(0.0, vec![0.0; 20], vec![0.0])),
        (
            "no number for a rate",
            make(f64::NAN, vec![0.0; 20], vec![0.0]),
        ),
        ("no number", make(30.0, vec![f64::NAN; 20], vec![0.0])),
        (
            "an endless yaw",
            make(30.0, vec![0.0; 20], vec![f64::INFINITY]),
        ),
    ] {
        assert!(found.is_err_and(|e| e.is_invalid()), "{what}");
    }
}

#[test]
fn a_slice_is_the_same_frames() {
    let motion = ramp(10, 30.0);
    let part = motion.slice(3..7).expect("a part");
    assert_eq!(part.frames(), 4);
    for f in 0..4 {
        assert_eq!(part.pose(f), motion.pose(f + 3));
        assert_eq!(part.root(f), motion.root(f + 3));
    }
    let backward = std::ops::Range { start: 5, end: 2 };
    for range in [3..3, 5..11, backward] {
        assert!(
            motion.slice(range.clone()).is_err_and(|e| e.is_invalid()),
            "{range:?}"
        );
    }
}

#[test]
fn resampling_keeps_time_and_what_is_linear_in_it() {
    let motion = ramp(61, 30.0);
    for rate in [30.0, 60.0, 24.0, 7.0, 100.0, 1.0, 0.1] {
        let other = motion.resampled(rate).expect("a motion");
        let last = (other.frames() - 1) as f64 / rate;
        assert!(
            last <= 2.0 + 1e-9 && last > 2.0 - 1.0 / rate - 1e-9,
            "{rate} Hz ends at {last}"
        );
        for f in 0..other.frames() {
            let t = f as f64 / rate;
            for (i, v) in other.pose(f).iter().enumerate() {
                assert!(
                    (v - t * 0.1 * (i + 1) as f64).abs() < 1e-9,
                    "{rate} Hz, frame {f}"
                );
            }
            assert!(
                (other.root(f).yaw - 10.0 * t).abs() < 1e-9,
                "yaw is not wrapped"
            );
        }
    }
    assert!(
        motion.resampled(30.0).is_ok_and(|same| same == motion),
        "its own rate changes nothing"
    );
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            motion.resampled(rate).is_err_and(|e| e.is_invalid()),
            "{rate}"
        );
    }
}

#[test]
fn resampling_takes_the_short_way_between_two_names_of_a_rotation() {
    let body = body();
    let waist = body.joint("waist").expect("a joint");
    let at = body.coordinates(waist);
    let axis = Vector3::new(0.0, 0.6, 0.8);
    // 200 degrees and its other name just beyond: -158.
    let (a, b) = (200f64.to_radians(), -158f64.to_radians());
    let mut poses = vec![0.0; 40];
    for (k, angle) in [a, b].into_iter().enumerate() {
        poses[20 * k + at.start..20 * k + at.end].copy_from_slice((axis * angle).as_slice());
    }
    let motion =
        Motion::new("m", body.clone(), 10.0, poses, vec![Root::ORIGIN; 2]).expect("a motion");
    let found = motion.resampled(40.0).expect("a motion");
    let start = body.rotation(waist, &found.pose(0)[at.clone()]);
    for f in 0..found.frames() {
        let turned = body
            .rotation(waist, &found.pose(f)[at.clone()])
            .angle_to(&start);
        assert!(
            (turned - 0.5f64.to_radians() * f as f64).abs() < 1e-9,
            "frame {f}: {turned}"
        );
    }
}

#[test]
fn effectors_move_as_the_frames_say() {
    let motion = ramp(5, 30.0);
    let (track, joints) = (motion.effectors(), motion.joints());
    assert_eq!(
        track.names(),
        ["left_hand", "right_hand", "left_foot", "right_foot", "head"]
    );
    assert_eq!((track.frames(), joints.frames()), (5, 5));
    let wrist = motion.skeleton().joint("left_wrist").expect("a joint");
    for f in 0..5 {
        let frames = motion.frames_at(f);
        assert_eq!(track.at(f)[0], frames[wrist].position);
        assert_eq!(joints.at(f)[wrist], frames[wrist].position);
    }
    assert_eq!(track.path(0).nth(3), Some(track.at(3)[0]));
}

#[test]
fn duration_runs_from_the_first_frame_to_the_last() {
    for (frames, rate, secs) in [(1, 30.0, 0.0), (61, 30.0, 2.0), (2, 4.0, 0.25)] {
        assert_eq!(ramp(frames, rate).duration_secs(), secs, "{frames} frames");
    }
    assert!(ramp(2, 1e-9).resampled(1000.0).is_err(), "too many frames");
}

#[test]
fn travel_is_told_as_the_body_faced_on_its_way() {
    // Round a circle of 2 m to the left, wherever it lies; and straight to the right, facing forward.
    let step = |k: usize| 0.01 * k as f64;
    let led = |root: &dyn Fn(f64) -> Root| {
        let roots = (0..=100).map(|k| root(step(k))).collect();
        let motion = Motion::new("led", body(), 30.0, vec![0.0; 101 * 20], roots);
        motion.expect("a motion").travelled()
    };
    for (from, x) in [(0.0, 0.0), (2.5, 7.0), (-9.0, -1.0)] {
        let round = led(&|angle| Root {
            position: Vector3::new(
                x + 2.0 * (from + angle).sin(),
                -2.0 * (from + angle).cos(),
                1.0,
            ),
            yaw: from + angle,
        });
        assert_eq!(round[0], [0.0; 3]);
        for (k, [forward, left, turn]) in round.into_iter().enumerate() {
            let angle = step(k);
            assert!((forward - 2.0 * angle).abs() < 1e-4, "{k}: {forward}");
            assert!(left.abs() < 1e-9 && (turn - angle).abs() < 1e-9, "{k}");
        }
    }
    let aside = led(&|d| Root {
        position: Vector3::new(0.0, -d, 1.0),
        yaw: 0.0,
    });
    assert!((aside[100][1] + 1.0).abs() < 1e-9 && aside[100][0] == 0.0);
}
