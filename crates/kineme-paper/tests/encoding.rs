//! The encoding test's own rules: whose movement, which set, which strokes.

use kineme::perception::encoding::{EffectorPaths, EncodingSettings};
use kineme_paper::encoding_test::{
    Answer, Costs, Movement, Question, RISING, coordinate, enlarged, knuckled, limit, strokes,
    tally, vocabulary,
};
use nalgebra::Vector3;

const RATE_HZ: f64 = 50.0;

fn question(number: usize, truth: Option<usize>) -> Question {
    Question {
        kind: "made up".into(),
        truth,
        number,
    }
}

/// Both hands: the right hangs, is raised, goes from side to side with an amplitude (metres), and is lowered; the left
/// does the same in the mirror, so many times as large.
fn waving(amplitude: f64, left: f64) -> EffectorPaths {
    let names = ["left_hand", "right_hand"].map(String::from).to_vec();
    let hand = |k: usize| -> (f64, f64) {
        let t = k as f64 / RATE_HZ;
        let up = (t / 0.5).min((4.5 - t) / 0.5).clamp(0.0, 1.0);
        let side = if (0.5..4.0).contains(&t) {
            amplitude * (std::f64::consts::TAU * (t - 0.5)).sin()
        } else {
            0.0
        };
        (up, side)
    };
    let points = (0..226)
        .flat_map(|k| {
            let (up, side) = hand(k);
            let place = |share: f64, y: f64| {
                Vector3::new(0.1, y + share * side * y.signum(), -0.6 + share * 0.8 * up)
            };
            [Some(place(left, 0.25)), Some(place(1.0, -0.25))]
        })
        .collect();
    EffectorPaths::new(RATE_HZ, names, points).expect("paths")
}

#[test]
fn the_hands_that_move_are_judged_and_the_left_one_in_the_mirror() {
    for (left, hands) in [(0.0, 1), (0.1, 1), (1.0, 2)] {
        let movement = Movement::of_paths(&waving(0.2, left)).expect("a movement");
        assert_eq!(movement.hands.len(), hands, "{left}");
    }
    let both = Movement::of_paths(&waving(0.2, 1.0)).expect("a movement");
    assert_eq!(both.hands[0], both.hands[1], "mirror images of one another");
    let right = Movement::of_paths(&waving(0.2, 0.0)).expect("a movement");
    let mirrored = waving(0.2, 0.0).mirrored().expect("the mirror");
    let left = Movement::of_paths(&mirrored).expect("a movement");
    assert_eq!(left, right, "left-handed or right-handed is the same");
    let secs = right.hands[0].away.duration_secs();
    assert!(
        (3.0..4.4).contains(&secs),
        "without way there and back: {secs}"
    );
    // Three waves and a half: from a quarter of the first one to a quarter before the end of the last.
    let secs = right.hands[0].performed.duration_secs();
    assert!((2.9..3.1).contains(&secs), "from turn to turn: {secs}");
    let raised = Movement::of_paths(&waving(0.0, 0.0)).expect("a movement");
    assert_eq!(raised.hands[0].performed, raised.hands[0].away);
}

#[test]
fn between_two_turning_points_there_is_a_way() {
    for step in 0..60 {
        let paths = waving(0.0025 * f64::from(step), 0.0);
        let (path, reach) = (paths.smoothed(1), paths.reach_m().expect("a reach"));
        let points = paths.turning_points(1, paths.away(1));
        assert!(!points.is_empty(), "step {step}: raised and lowered");
        for pair in points.windows(2) {
            let between = &path[pair[0]..=pair[1]];
            let off = |p: &Vector3<f64>| {
                let ends = [between[0], between[between.len() - 1]];
                ends.map(|e| (p - e).norm()).into_iter().fold(0.0, f64::max)
            };
            let way = between.iter().map(off).fold(0.0, f64::max) / reach;
            assert!(way >= 0.08, "step {step}, {pair:?}: {way} of the reach");
        }
    }
}

#[test]
fn strokes_go_from_turning_point_to_turning_point() {
    type Strokes<'a> = &'a [(usize, usize, bool)];
    let cases: [(&[f64], Strokes); 5] = [
        (&[], &[]),
        (&[0.0, 0.1, 0.05, 0.12], &[]),
        (&[0.0, 0.2, 0.4, 0.35, 0.6], &[(0, 4, true)]),
        (&[0.1, 0.0, 0.3, 0.0], &[(1, 2, true), (2, 3, false)]),
        (&[0.5, 0.6, 0.1, 0.15, 0.4], &[(1, 2, false), (2, 4, true)]),
    ];
    for (values, wanted) in cases {
        assert_eq!(strokes(values), wanted, "{values:?}");
    }
}

#[test]
fn half_of_each_set_goes_the_way_its_coordinate_rises() {
    let body = std::sync::Arc::new(kineme::ares().expect("ares"));
    let (all, sets) = vocabulary(&body).expect("a vocabulary");
    let heading_secs = EncodingSettings::default().heading_secs;
    for (set, rising) in RISING.iter().enumerate() {
        let places = (0..sets.len()).filter(|p| sets[*p] == set);
        let own: Vec<_> = places.map(|p| &all.primitives()[p]).collect();
        assert_eq!(own.len(), 2 * rising.len(), "set {set}");
        for primitive in own {
            let rises = rising.contains(&primitive.name());
            for e in primitive.exemplars() {
                let hand = ["right_hand".into()];
                let paths = EffectorPaths::of_motion(&e.motion, &hand, heading_secs);
                let along = coordinate(&paths.expect("paths"), set);
                let gone = along[along.len() - 1] - along[0];
                assert_eq!(gone > 0.0, rises, "{}: {gone}", primitive.name());
            }
        }
    }
}

#[test]
fn decisions_count_inside_a_stroke_while_the_hand_goes_on() {
    // Up for a second, still for a second, down for a second: 0.6 m each way.
    let height = |k: usize| {
        let t = k as f64 / RATE_HZ;
        0.6 * t.min(1.0).min(3.0 - t) - 0.3
    };
    let points = (0..=150).map(|k| Some(Vector3::new(0.6, 0.0, height(k))));
    let paths = EffectorPaths::new(RATE_HZ, vec!["right_hand".into()], points.collect());
    let paths = paths.expect("paths");
    let taken = [
        (0.2, 0.4, Some(0)),
        (0.4, 0.6, Some(1)),
        (1.4, 1.6, Some(1)),
        (2.4, 2.6, Some(1)),
        (2.6, 2.8, None),
    ];
    assert_eq!(tally(&paths, 0, &[0], &taken), [[1, 1], [0, 1]]);
    assert_eq!(tally(&paths, 0, &[1], &taken), [[1, 1], [1, 0]]);
}

#[test]
fn the_cheapest_set_is_answered_up_to_a_limit_of_the_tuning_half() {
    let costs = |sets, unsaid| Costs { sets, unsaid };
    let told = costs([0.4, 0.2, 0.2, 0.9], 0.2);
    let answer = Answer::cheapest(&question(1, Some(1)), Some(&told), 0.3);
    assert_eq!((answer.set(), answer.is_right()), (Some(1), true));
    let answer = Answer::cheapest(&question(1, Some(1)), Some(&told), 0.1);
    assert_eq!((answer.set(), answer.leading), (None, 1));
    assert!(Answer::cheapest(&question(0, None), None, 9.0).is_right());
    // Only motions of the tuning half that resemble a set have a say.
    let asked = |number, truth, unsaid| (question(number, truth), Some(costs([0.1; 4], unsaid)));
    let half = [
        asked(0, Some(0), 0.3),
        asked(1, Some(0), 4.0),
        asked(2, None, 4.0),
    ];
    assert!((limit(&half) - 0.3).abs() < 1e-12);
}

#[test]
fn small_movements_are_enlarged_about_their_middle_and_large_ones_left_alone() {
    let hand = waving(0.2, 0.0).only(&["right_hand"]).expect("a hand");
    let waves = hand.slice(30..190).expect("a part");
    let middle = |paths: &EffectorPaths| {
        let places = || (0..paths.frames()).filter_map(|f| paths.at(f)[0]);
        let mean = places().sum::<Vector3<f64>>() / places().count() as f64;
        let first = places().next().expect("a place");
        let far = places().map(|p| (p - first).norm()).fold(0.0, f64::max);
        (mean, far)
    };
    let (mean, far) = middle(&waves);
    let large = enlarged(&waves, 2.0 * far).expect("enlarged");
    assert!((middle(&large).0 - mean).norm() < 1e-9);
    assert!((middle(&large).1 - 2.0 * far).abs() < 1e-9);
    assert_eq!(enlarged(&waves, 0.5 * far).expect("as it was"), waves);
    let still = waves.slice(0..1).expect("a frame");
    assert_eq!(enlarged(&still, 1.0).expect("as it was"), still);
}

#[test]
fn turning_the_wrist_moves_a_hand_where_its_fingers_begin() {
    let body = kineme::ares().expect("a body");
    let knuckled = knuckled(&body).expect("a body");
    let hand = body.effector("right_hand").expect("a hand");
    let joint = body.effectors()[hand].joint;
    let mut turned = body.neutral();
    turned[body.coordinates(joint).start] += 0.5;
    let moved = |body: &kineme::skeleton::Skeleton, e: usize| {
        let root = kineme::skeleton::Root::ORIGIN;
        let [a, b] = [body.neutral(), turned.clone()].map(|p| body.effector_positions(&p, &root));
        (a[e] - b[e]).norm()
    };
    assert!(moved(&body, hand) < 1e-9, "the wrist's centre");
    assert!(moved(&knuckled, hand) > 0.02, "the base of the fingers");
    let foot = body.effector("right_foot").expect("a foot");
    assert_eq!(body.effectors()[foot], knuckled.effectors()[foot]);
}
