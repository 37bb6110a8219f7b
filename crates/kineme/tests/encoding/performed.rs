//! Which part of paths is a movement, and what sets of primitives cost it.

use kineme::perception::encoding::{EffectorPaths, Encoder, EncodingSettings};
use nalgebra::{UnitQuaternion, Vector3};

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

/// Raised within half a second, from side to side `waves` times, and lowered again; metres.
fn raised(waves: f64, amplitude: f64) -> EffectorPaths {
    hand(4.0, |t| {
        let up = (t / 0.5).min((4.0 - t) / 0.5).clamp(0.0, 1.0);
        let share = ((t - 1.0) / 2.0).clamp(0.0, 1.0);
        let side = amplitude * (std::f64::consts::TAU * waves * share).sin();
        (-0.7 + 0.9 * up, side - 0.3)
    })
}

#[test]
fn who_goes_to_and_fro_is_between_the_first_and_the_last_turning_point() {
    // A wave turns twice.
    for (waves, amplitude, turns) in [(2.0, 0.2, 4), (3.0, 0.1, 6)] {
        let paths = raised(waves, amplitude);
        let points = paths.turning_points(0, paths.away(0));
        assert_eq!(points.len(), turns, "{points:?}");
        let span = paths.to_and_fro(0).expect("to and fro");
        assert_eq!((span.start, span.end - 1), (points[0], points[turns - 1]));
        assert_eq!(paths.performed(0), span);
        // A quarter of the first wave, and of the last one.
        let quarter = 0.5 / waves;
        let secs = [span.start, span.end].map(|f| f as f64 / 50.0);
        assert!((secs[0] - 1.0 - quarter).abs() < 0.06, "{secs:?}");
        assert!((secs[1] - 3.0 + quarter).abs() < 0.06, "{secs:?}");
    }
    // A hand that is held, and one that trembles, turns back once: to go down again.
    for paths in [raised(0.0, 0.0), raised(3.0, 0.015)] {
        let points = paths.turning_points(0, paths.away(0));
        assert!(points.len() < 2, "{points:?}");
        assert_eq!(paths.to_and_fro(0), None);
        assert_eq!(paths.performed(0), paths.away(0));
    }
}

#[test]
fn turning_points_are_the_same_in_every_direction_size_and_order_of_time() {
    let seen = raised(2.5, 0.2);
    let all = 0..seen.frames();
    let points = seen.turning_points(0, all.clone());
    assert_eq!(points.len(), 5);
    let made = |place: &dyn Fn(usize) -> Vector3<f64>| {
        let points = all.clone().map(|f| Some(place(f))).collect();
        EffectorPaths::new(50.0, vec!["right_hand".into()], points).expect("paths")
    };
    let at = |f: usize| seen.at(f)[0].expect("seen");
    let turn = UnitQuaternion::from_euler_angles(0.4, -1.0, 2.0);
    let turned = made(&|f| 1.4 * (turn * at(f)));
    assert_eq!(turned.turning_points(0, all.clone()), points);
    let last = seen.frames() - 1;
    let back = made(&|f| at(last - f)).turning_points(0, all.clone());
    for (there, back) in points.iter().zip(back.iter().rev()) {
        assert!(there.abs_diff(last - back) <= 1, "{points:?} {back:?}");
    }
    let nothing = EffectorPaths::new(50.0, vec!["right_hand".into()], vec![None; 9]);
    let nothing = nothing.expect("paths");
    assert!(nothing.turning_points(0, 0..9).is_empty());
}

#[test]
fn the_more_moves_the_more_there_is_to_say() {
    let settings = EncodingSettings {
        effectors: vec!["right_hand".into()],
        ..EncodingSettings::default()
    };
    let encoder = Encoder::new(vocabulary(), &settings).expect("an encoder");
    let held = |paths: &EffectorPaths| encoder.held(paths).expect("a cost");
    let still = hand(2.0, |_| (0.4, -0.3));
    let [small, large] = [0.1, 0.2].map(|amplitude| raised(2.0, amplitude).slice(50..150));
    let costs = [still, small.expect("a part"), large.expect("a part")].map(|p| held(&p));
    assert!(costs[0].abs() < 1e-9, "{costs:?}");
    assert!(costs[0] < costs[1] && costs[1] < costs[2], "{costs:?}");
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
