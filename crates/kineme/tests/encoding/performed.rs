//! Which part of paths is a movement, and what sets of primitives cost it.

use kineme::perception::encoding::{EffectorPaths, Encoder, EncodingSettings};
use nalgebra::Vector3;

use super::vocabulary::{made, paths, vocabulary};

/// One hand at 50 Hz, its height (metres from between the shoulders) and how far left it is over time, seconds.
fn hand(secs: f64, place: impl Fn(f64) -> (f64, f64)) -> EffectorPaths {
    let points = (0..=(secs * 50.0) as usize).map(|k| {
        let (height, left) = place(k as f64 / 50.0);
        Some(Vector3::new(0.1, left, height))
    });
    EffectorPaths::new(50.0, vec!["right_hand".into()], points.collect()).expect("paths")
}

#[test]
fn the_way_there_and_back_is_no_part_of_a_movement() {
    let ramp = |t: f64| -0.7 + 0.9 * (t / 0.5).min((4.0 - t) / 0.5).clamp(0.0, 1.0);
    // Hangs at both ends, at the beginning alone, nowhere.
    let cases = [
        (hand(4.0, |t| (ramp(t), -0.3)), [0.2..0.5, 3.5..3.8]),
        (hand(2.0, |t| (ramp(t), -0.3)), [0.2..0.5, 1.99..2.03]),
        (
            hand(2.0, |t| (0.2 * t.sin(), -0.3)),
            [-0.01..0.01, 1.99..2.03],
        ),
    ];
    for (paths, [start, end]) in cases {
        let span = paths.performed(0);
        let secs = [span.start, span.end].map(|f| f as f64 / 50.0);
        assert!(
            start.contains(&secs[0]) && end.contains(&secs[1]),
            "{secs:?}"
        );
        // Larger people, the same frames.
        let points = (0..paths.frames()).map(|f| paths.at(f)[0].map(|p| 1.5 * p));
        let large = EffectorPaths::new(50.0, vec!["right_hand".into()], points.collect());
        assert_eq!(large.expect("paths").performed(0), span);
    }
    // Of nothing but up and down, the upper part is left; of a hand that never moves, two frames at least.
    let up = hand(1.0, |t| {
        (-0.7 + 1.4 * (std::f64::consts::PI * t).sin(), -0.3)
    });
    let span = up.performed(0);
    assert!(
        span.start > 5 && span.end < 46 && span.contains(&25),
        "{span:?}"
    );
    for paths in [hand(0.02, |_| (-0.7, 0.0)), hand(1.0, |_| (-0.7, 0.0))] {
        assert!(paths.performed(0).len() >= 2);
    }
    let nothing = EffectorPaths::new(50.0, vec!["right_hand".into()], vec![None; 9]);
    assert_eq!(nothing.expect("paths").performed(0), 0..9);
}

#[test]
fn twice_mirrored_is_the_same_and_once_is_the_other_hand() {
    let seen = paths(&made("reach", 0.5));
    let mirrored = seen.mirrored().expect("the mirror");
    assert_eq!(mirrored.mirrored().expect("the mirror"), seen);
    assert_eq!(
        (seen.moving(), mirrored.moving()),
        (vec![false, true], vec![true, false])
    );
    let hand = |p: &EffectorPaths, name| p.only(&[name]).expect("a hand").lengths_m()[0];
    let gap = hand(&seen, "right_hand") - hand(&mirrored, "left_hand");
    assert!(gap.abs() < 1e-12);
    assert!(seen.only(&["tail"]).is_err());
    assert!(
        hand_only(&seen).mirrored().is_err(),
        "it lacks the other hand"
    );
    let length = seen.frames();
    assert_eq!(seen.slice(3..length).expect("a part").at(0), seen.at(3));
    for wrong in [0..length + 1, 4..4] {
        assert!(seen.slice(wrong).is_err());
    }
}

fn hand_only(paths: &EffectorPaths) -> EffectorPaths {
    paths.only(&["right_hand"]).expect("a hand")
}

#[test]
fn its_own_primitive_explains_a_movement_at_the_lowest_cost() {
    let encoder = Encoder::new(vocabulary(), &EncodingSettings::default()).expect("an encoder");
    for (own, name) in super::NAMES.into_iter().enumerate() {
        let seen = paths(&made(name, 0.5));
        let costs: Vec<f64> = (0..4)
            .map(|k| encoder.explained(&seen, &[k]).expect("explained").cost)
            .collect();
        for (other, cost) in costs.iter().enumerate() {
            assert!(other == own || *cost > costs[own], "{name}: {costs:?}");
        }
        // With more to choose from nothing costs more, and the decisions are its own.
        let all = encoder.explained(&seen, &[0, 1, 2, 3]).expect("explained");
        assert!(all.cost <= costs[own] + 1e-9, "{} {costs:?}", all.cost);
        assert!(
            all.decisions.iter().all(|d| *d == Some(own)),
            "{name}: {all:?}"
        );
    }
    let seen = paths(&made("hook", 0.5));
    assert!(encoder.explained(&seen, &[]).is_err());
    assert!(encoder.explained(&seen, &[9]).is_err());
    let instant = seen.slice(0..1).expect("a frame");
    assert!(encoder.explained(&instant, &[0]).is_err(), "no decision");
}
