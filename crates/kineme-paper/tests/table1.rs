//! Table I and the encoding test: what the rows are made of, on little of it.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use kineme::control::{KinematicRobot, Robot};
use kineme::perception::{Filter, FilterSettings};
use kineme::primitive::{Observations, Posterior, readings};
use kineme::{Motion, Role, Root, Vocabulary};
use kineme_paper::choreographies::{SCRIPTS, choreography};
use kineme_paper::encoding_test::{Answer, Question, RESEMBLING, SETS, wilson};
use kineme_paper::table1::{
    Altered, Clip, Counts, Decisions, MEASURES, Measure, Mode, MovementSettings, Row, Showing,
    Tally, animations, drawn, garwood, hybrids, movements, plan, recorded, reversed, shows,
};
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn boxing() -> &'static Vocabulary {
    static MADE: OnceLock<Vocabulary> = OnceLock::new();
    MADE.get_or_init(|| {
        let (name, text) = SCRIPTS[0];
        let body = Arc::new(kineme::ares().expect("Ares"));
        choreography(name, text, &body).expect("the boxer")
    })
}

fn drawing() -> Box<dyn Robot> {
    Box::new(KinematicRobot::new(Arc::clone(boxing().body())))
}

const LITTLE: MovementSettings = MovementSettings {
    clips: 2,
    movements: 4,
    seed: 7,
};

fn moved() -> &'static Vec<Clip> {
    static MADE: OnceLock<Vec<Clip>> = OnceLock::new();
    MADE.get_or_init(|| movements(boxing(), &LITTLE, &|| Ok(drawing())).expect("movements"))
}

#[test]
fn parameters_of_exemplars_are_never_drawn() {
    let mut random = Pcg64::seed_from_u64(1);
    for primitive in boxing().primitives() {
        for _ in 0..200 {
            let p = drawn(primitive, &mut random);
            for e in 0..primitive.exemplars().len() {
                let gaps = primitive.point(e).iter().zip(&p);
                let far = gaps.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(far >= 0.05, "{} at {p:?}", primitive.name());
            }
        }
    }
    let plan = plan(boxing(), 30, &mut random).expect("a plan");
    plan.check(boxing(), None).expect("a plan that can be done");
    assert!(
        plan.behaviors.iter().any(|b| b.priority == 1),
        "interruptions"
    );
}

#[test]
fn a_frame_belongs_to_the_behavior_that_was_joined() {
    for clip in moved() {
        let frames = clip.truth.len();
        assert_eq!(frames, clip.motion().frames());
        // Standing, and the way to the guard, are nobody's; so is the end.
        assert_eq!(clip.truth[0], None);
        assert_eq!(clip.truth[frames - 1], None);
        let shown = clip.truth.iter().filter(|t| t.is_some()).count();
        assert!(shown > frames / 4 && shown < frames, "{shown} of {frames}");
        // What a kinematic body shows then is on the primitive's manifold: beyond the neutral pose at least.
        let neutral = clip.motion().skeleton().neutral();
        for (f, truth) in clip.truth.iter().enumerate() {
            let gap = clip.motion().pose(f).iter().zip(&neutral);
            let gap = gap.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(truth.is_none() || gap > 0.5, "{} at {f}", clip.name);
        }
    }
}

#[test]
fn the_same_seed_makes_the_same_set() {
    let again = movements(boxing(), &LITTLE, &|| Ok(drawing())).expect("movements");
    for (a, b) in moved().iter().zip(&again) {
        assert_eq!(a.motion().poses(), b.motion().poses());
        assert_eq!(a.truth, b.truth);
    }
    let other = MovementSettings { seed: 8, ..LITTLE };
    let other = movements(boxing(), &other, &|| Ok(drawing())).expect("movements");
    assert_ne!(moved()[0].motion().poses(), other[0].motion().poses());
}

#[test]
fn animations_are_more_than_fifty_and_none_of_the_behaviors() {
    let all = animations(boxing().body()).expect("animations");
    assert!(all.len() > 50);
    assert!(all.iter().all(|c| c.motion().rate_hz() == 120.0));
    assert!(all.iter().flat_map(|c| &c.truth).all(Option::is_none));
}

#[test]
fn joints_where_no_exemplar_has_them_are_an_unknown_movement_and_no_broken_sensors() {
    let filter = Filter::new(boxing(), &FilterSettings::default()).expect("a filter");
    let all = animations(boxing().body()).expect("animations");
    for name in ["scratch-head", "shrug"] {
        let clip = all.iter().find(|c| c.name.contains(name)).expect(name);
        for reading in readings(&filter, &clip.seen).expect("readings") {
            let greatest = reading.posterior.primitives.into_iter().fold(0.0, f64::max);
            assert!(greatest < 0.5, "{name}: {greatest}");
        }
    }
}

#[test]
fn exactly_what_is_to_be_altered_is() {
    let body = boxing().body();
    let clip = &animations(body).expect("animations")[0];
    let hands = [
        Role::LeftHand,
        Role::LeftFingers,
        Role::RightHand,
        Role::RightFingers,
    ];
    let hands: Vec<usize> = hands.iter().flat_map(|r| body.joints_of(*r)).collect();
    let guard = &boxing().primitives()[0];
    let guard = guard.pose(&guard.middle(), 0.0).expect("the guard");
    for altered in [Altered::Nothing, Altered::Hands, Altered::Unmoved] {
        let joints = altered.joints(boxing()).expect("joints");
        let seen = altered.of(clip, boxing()).expect("altered");
        let arm = body.joints_of(Role::LeftUpperArm)[0];
        let leg = body.joints_of(Role::LeftUpperLeg)[0];
        assert!(!joints.contains(&arm));
        assert_eq!(joints.contains(&leg), altered == Altered::Unmoved);
        assert_eq!(
            hands.iter().all(|j| joints.contains(j)),
            altered != Altered::Nothing
        );
        if altered == Altered::Hands {
            assert_eq!(joints.len(), hands.len());
        }
        for f in [0, clip.motion().frames() - 1] {
            for j in 0..body.joints().len() {
                let at = body.coordinates(j);
                let wanted = match joints.contains(&j) {
                    true => &guard[at.clone()],
                    false => &clip.motion().pose(f)[at.clone()],
                };
                assert_eq!(&seen.motion().pose(f)[at], wanted);
            }
        }
    }
}

/// A clip of Ares at rest with this truth.
fn resting(truth: &[Option<usize>]) -> Clip {
    let body = boxing().body();
    let poses = body.neutral().repeat(truth.len());
    let roots = vec![Root::ORIGIN; truth.len()];
    let motion = Motion::new("rest", Arc::clone(body), 4.0, poses, roots).expect("a motion");
    Clip {
        name: "rest".into(),
        seen: Observations::complete(motion),
        truth: truth.to_vec(),
    }
}

#[test]
fn the_three_poolings_of_a_small_example() {
    // Two behaviours, four frames: the second is affirmed beside the first, then in its place, then where nothing is.
    let clip = resting(&[Some(0), Some(0), None, None]);
    let decisions = Decisions {
        affirmed: [[true, true], [false, true], [false, true], [false, false]].concat(),
        probable: Some(vec![0.5; 8]),
    };
    let tally = Tally::of(&clip, &decisions, 2).expect("counted");
    let first = Counts {
        hits: 1,
        false_alarms: 0,
        misses: 1,
        rejections: 2,
    };
    let second = Counts {
        hits: 0,
        false_alarms: 3,
        misses: 0,
        rejections: 1,
    };
    let any = Counts {
        hits: 2,
        false_alarms: 1,
        misses: 0,
        rejections: 1,
    };
    assert_eq!(
        (tally.classes.as_slice(), tally.any),
        ([first, second].as_slice(), any)
    );
    assert_eq!(
        (tally.all_right, tally.alarms, tally.spans, tally.missed),
        (1, 1, 1, 0)
    );
    let row = Row::of("made up", Mode::FILTER, Altered::Nothing, &[tally]).expect("a row");
    for (measure, wanted) in [
        (Measure::Accuracy, Some(0.5)),
        (Measure::AccuracyAny, Some(0.75)),
        (Measure::AccuracyEvery, Some(0.25)),
        (Measure::Never, Some(0.75)),
        (Measure::NeverAny, Some(0.5)),
        (Measure::Balanced, Some(0.75)),
        (Measure::Precision, Some(0.25)),
        (Measure::Recall, Some(0.5)),
        (Measure::F1, Some(1.0 / 3.0)),
        (Measure::MeanPrecision, Some(0.5)),
        (Measure::RecallAny, Some(1.0)),
        (Measure::LogLoss, Some(2.0_f64.ln())),
    ] {
        let found = row.measure(measure).map(|e| e.value);
        let near = found
            .zip(wanted)
            .is_some_and(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near, "{measure:?}: {found:?}, not {wanted:?}");
    }
    // One alarm in a second.
    assert_eq!(row.alarms_an_hour()[0], 3600.0);
    assert_eq!(row.measures.len(), MEASURES.len());
}

#[test]
fn always_denying_is_right_as_often_as_nothing_is_shown() {
    for truth in [vec![None; 5], vec![Some(1), None, None, Some(0)]] {
        let clip = resting(&truth);
        let decisions = Mode::Never.decide(None, 5, &clip.seen).expect("denied");
        let tally = Tally::of(&clip, &decisions, 5).expect("counted");
        let row = Row::of("made up", Mode::Never, Altered::Nothing, &[tally]).expect("a row");
        let value = |m| row.measure(m).map(|e| e.value);
        assert_eq!(value(Measure::Accuracy), value(Measure::Never));
        assert_eq!(value(Measure::AccuracyAny), value(Measure::NeverAny));
        let shown = truth.iter().flatten().count() as f64;
        let wanted = 1.0 - shown / (5.0 * truth.len() as f64);
        assert!((value(Measure::Accuracy).expect("a share") - wanted).abs() < 1e-12);
        assert_eq!(value(Measure::Recall).is_none(), shown == 0.0);
    }
}

#[test]
fn intervals_of_counts_are_the_published_ones() {
    // Garwood's table; Wilson of 95 in 100.
    for (count, low, high) in [(0, 0.0, 3.689), (1, 0.025, 5.572), (10, 4.795, 18.390)] {
        let (found_low, found_high) = garwood(count);
        assert!(
            (found_low - low).abs() < 1e-3 && (found_high - high).abs() < 1e-3,
            "{count}"
        );
    }
    let (low, high) = wilson(95, 100);
    assert!(
        (low - 0.8882).abs() < 1e-3 && (high - 0.9785).abs() < 1e-3,
        "{low} {high}"
    );
}

#[test]
fn backward_twice_is_forward_and_hybrids_have_two_executions() {
    let clip = &moved()[0];
    let back = reversed(clip).expect("backward");
    assert!(back.truth.iter().all(Option::is_none));
    let last = clip.motion().frames() - 1;
    assert_eq!(back.motion().pose(0), clip.motion().pose(last));
    let again = reversed(&back).expect("forward");
    assert_eq!(again.motion().poses(), clip.motion().poses());
    let made = hybrids(boxing(), 1, 3).expect("hybrids");
    assert_eq!(made.len(), boxing().primitives().len());
    assert!(made.iter().flat_map(|c| &c.truth).all(Option::is_none));
}

#[test]
fn labels_say_what_leaves_the_third_set() {
    for (label, wanted) in [
        ("punch", Some(Showing::Striking)),
        ("side-boxing", Some(Showing::Striking)),
        ("martial-arts", Some(Showing::Striking)),
        ("high-arm-wave", Some(Showing::Waving)),
        ("tennis-swing", None),
        ("kick", None),
        ("hammer", None),
    ] {
        assert_eq!(shows(label), wanted, "{label}");
    }
}

/// The corpus, where it is.
fn corpus() -> Option<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = match std::env::var_os("KINEME_DATA") {
        Some(data) => PathBuf::from(data),
        None => root.join("../shared/data"),
    };
    let corpus = data.join("mocap");
    let found = corpus.join("index.csv").is_file();
    if !found {
        eprintln!("skipped: no motion capture at KINEME_DATA or ../shared/data");
    }
    found.then_some(corpus)
}

#[test]
fn the_third_set_is_of_negatives_and_names_what_left() {
    let Some(corpus) = corpus() else { return };
    let captured = recorded(&corpus, boxing().body(), 97).expect("recordings");
    assert!(captured.negatives.len() > 5 && !captured.left.is_empty());
    assert!(
        captured
            .negatives
            .iter()
            .all(|c| c.truth.iter().all(Option::is_none))
    );
    for word in ["punch", "boxing", "wave"] {
        assert!(
            captured.negatives.iter().all(|c| !c.name.contains(word)),
            "{word}"
        );
    }
    let mode = Mode::Frame { n: 1, stride: 1 };
    let recogniser = mode.over(boxing()).expect("a recogniser");
    let clip = &captured.negatives[0];
    let decisions = mode
        .decide(recogniser.as_deref(), 5, &clip.seen)
        .expect("decided");
    assert_eq!(decisions.affirmed.len(), 5 * clip.truth.len());
}

#[test]
fn sets_of_primitives_are_answered_by_what_their_primitives_share() {
    let sets = [0, 0, 1, 1, 2, 2, 3, 3];
    let posterior = |primitives: [f64; 8], none: f64| Posterior {
        primitives: primitives.to_vec(),
        rest: 0.0,
        none,
    };
    // No primitive is likelier than none, the set of two is.
    let split = posterior([0.0, 0.0, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0], 0.4);
    let question = |truth| Question {
        kind: "k".into(),
        truth,
        number: 0,
    };
    let answer = Answer::of(&question(Some(1)), &split, &sets);
    assert!(answer.is_right() && answer.set() == Some(1));
    let unknown = posterior([0.0, 0.0, 0.2, 0.1, 0.0, 0.0, 0.0, 0.0], 0.7);
    let answer = Answer::of(&question(None), &unknown, &sets);
    assert_eq!(
        (answer.set(), answer.leading, answer.refused),
        (None, 1, true)
    );
    for (set, name) in SETS.iter().enumerate() {
        assert!(
            RESEMBLING.iter().any(|(.., truth)| *truth == Some(set)),
            "{}",
            name
        );
    }
}
