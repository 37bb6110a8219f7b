//! The baselines on choreographed motion.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use kineme::choreography::{Key, perform};
use kineme::evaluation::{
    Constant, Features, NearestDtw, NearestDtwSettings, NearestPosture, NearestPostureSettings,
};
use kineme::primitive::{Observation, Observations, Recogniser, readings};
use kineme::{Motion, Primitive, Role, Skeleton, Transitions, Vocabulary, adonis, ares};

use crate::learned;

static BODY: LazyLock<Arc<Skeleton>> = LazyLock::new(|| Arc::new(adonis().expect("adonis")));

/// An arm that is raised to `height` (degrees) and lowered, or sideways.
fn swing(arm: Role, height: f64, sideways: bool, secs: f64, rate_hz: f64) -> Motion {
    let key = |time: f64, angle: f64| {
        let angles = match sideways {
            true => vec![0.0, angle],
            false => vec![angle],
        };
        Key {
            time,
            angles: BTreeMap::from([(arm, angles)]),
        }
    };
    let keys = [key(0.0, 5.0), key(0.5 * secs, height), key(secs, 5.0)];
    perform("swing", &keys, &BODY, rate_hz).expect("a motion")
}

/// Arm, whether sideways, and how many exemplars; in the order of the vocabulary.
const CLASSES: [(&str, Role, bool, usize); 3] = [
    ("right", Role::RightUpperArm, false, 3),
    ("left", Role::LeftUpperArm, false, 4),
    ("aside", Role::RightUpperArm, true, 3),
];

fn primitive((name, arm, sideways, count): (&str, Role, bool, usize)) -> Primitive {
    let variation = |k: usize| {
        let k = k as f64;
        swing(arm, 60.0 + 15.0 * k, sideways, 1.2 + 0.1 * k, 60.0)
    };
    learned(name, (0..count).map(variation))
}

fn of_body(primitives: Vec<Primitive>) -> Vocabulary {
    let transitions = Transitions::none(primitives.len());
    Vocabulary::new(Arc::clone(&BODY), primitives, vec![], transitions).expect("a vocabulary")
}

fn vocabulary(order: [usize; 3]) -> Vocabulary {
    of_body(order.map(|i| primitive(CLASSES[i])).to_vec())
}

static VOCABULARY: LazyLock<Vocabulary> = LazyLock::new(|| vocabulary([0, 1, 2]));

fn hands() -> Features {
    Features::Effectors(vec!["left_hand".into(), "right_hand".into()])
}

/// All that look at the motion.
fn looking(vocabulary: &Vocabulary) -> Vec<(&'static str, Box<dyn Recogniser + '_>)> {
    let dtw = |features| NearestDtwSettings {
        features,
        ..NearestDtwSettings::default()
    };
    let posture = NearestPostureSettings::default();
    let shape = NearestDtwSettings {
        shape: 0.5,
        ..NearestDtwSettings::default()
    };
    vec![
        (
            "shape",
            Box::new(NearestDtw::new(vocabulary, &shape).expect("dtw")),
        ),
        (
            "dtw",
            Box::new(NearestDtw::new(vocabulary, &dtw(Features::Landmarks)).expect("dtw")),
        ),
        (
            "hands",
            Box::new(NearestDtw::new(vocabulary, &dtw(hands())).expect("dtw")),
        ),
        (
            "posture",
            Box::new(NearestPosture::new(vocabulary, &posture).expect("postures")),
        ),
    ]
}

fn seen(motion: Motion) -> Observations {
    Observations::complete(motion)
}

#[test]
fn unseen_variations_are_recognised_at_any_rate() {
    for (name, recogniser) in looking(&VOCABULARY) {
        for (i, (_, arm, sideways, _)) in CLASSES.into_iter().enumerate() {
            for (height, secs, rate) in [(68.0, 1.3, 60.0), (80.0, 1.6, 30.0), (64.0, 0.9, 120.0)] {
                let motion = swing(arm, height, sideways, secs, rate);
                let told = recogniser
                    .recognise(&seen(motion.clone()))
                    .expect("an answer");
                let case = format!("{name}, class {i} at {height}: {told:?}");
                assert_eq!(told.posterior.best(), Some(i), "{case}");
                let sum: f64 = told.posterior.primitives.iter().sum();
                assert!((sum - 1.0).abs() < 1e-12, "{case}");
                assert_eq!((told.posterior.rest, told.posterior.none), (0.0, 0.0));
                assert_eq!(told.spans.len(), 1);
                assert_eq!(told.spans[0].end_secs, motion.duration_secs());
                let dims = VOCABULARY.primitives()[i].parameters().dims();
                assert_eq!(told.parameters.len(), dims, "{case}");
            }
        }
    }
}

#[test]
fn exemplars_are_not_novel_and_strangers_are() {
    let twist = {
        let key = |time: f64, turn: f64| Key {
            time,
            angles: BTreeMap::from([
                (Role::Chest, vec![20.0, 0.0, turn]),
                (Role::LeftLowerArm, vec![100.0]),
                (Role::RightLowerArm, vec![100.0]),
            ]),
        };
        let keys = [key(0.0, -30.0), key(0.7, 30.0), key(1.4, -30.0)];
        perform("twist", &keys, &BODY, 60.0).expect("a motion")
    };
    for (name, recogniser) in looking(&VOCABULARY) {
        let novelty = |motion: &Motion| {
            let told = recogniser
                .recognise(&seen(motion.clone()))
                .expect("an answer");
            (told.novelty, told.parameters)
        };
        for primitive in VOCABULARY.primitives() {
            for (e, exemplar) in primitive.exemplars().iter().enumerate() {
                let (own, parameters) = novelty(&exemplar.motion);
                assert!(own < 1e-3, "{name}: an exemplar is {own} novel");
                if name == "dtw" {
                    assert_eq!(parameters, primitive.point(e));
                }
            }
        }
        let (strange, _) = novelty(&twist);
        assert!(strange > 2.0, "{name}: a stranger is {strange} novel");
        let near = seen(swing(Role::RightUpperArm, 68.0, false, 1.2, 60.0));
        let (near, _) = novelty(near.motion());
        assert!(near < 1.5, "{name}: a variation is {near} novel");
    }
}

#[test]
fn the_order_of_the_vocabulary_is_irrelevant() {
    let order = [2, 0, 1];
    let other = vocabulary(order);
    let motion = seen(swing(Role::LeftUpperArm, 71.0, false, 1.4, 60.0));
    for ((name, one), (_, two)) in looking(&VOCABULARY).into_iter().zip(looking(&other)) {
        let (one, two) = (one.recognise(&motion), two.recognise(&motion));
        let (one, two) = (one.expect("an answer"), two.expect("an answer"));
        for (to, from) in order.into_iter().enumerate() {
            let (p, q) = (one.posterior.primitives[from], two.posterior.primitives[to]);
            assert!((p - q).abs() < 1e-5, "{name}: {p} and {q}");
        }
    }
}

#[test]
fn a_stream_is_recognised_while_it_moves() {
    let motion = swing(Role::LeftUpperArm, 75.0, false, 1.4, 60.0);
    for (name, recogniser) in looking(&VOCABULARY) {
        let told = readings(&*recogniser, &seen(motion.clone())).expect("readings");
        assert_eq!(told.len(), motion.frames());
        for (f, reading) in told.iter().enumerate() {
            let sum: f64 = reading.posterior.primitives.iter().sum();
            assert!((sum - 1.0).abs() < 1e-12 && reading.place.is_none());
            if (0.4..1.0).contains(&(f as f64 / 60.0)) {
                assert_eq!(reading.posterior.best(), Some(1), "{name}, frame {f}");
            }
        }
        // What was answered does not depend on what comes later.
        let half = seen(motion.slice(0..motion.frames() / 2).expect("a half"));
        let early = readings(&*recogniser, &half).expect("readings");
        assert_eq!(early[..], told[..early.len()], "{name}");
    }
}

#[test]
fn a_window_tells_the_way_up_from_the_way_down() {
    let half = |up: bool, height: f64| {
        let motion = swing(Role::RightUpperArm, height, false, 2.0, 60.0);
        let frames = if up { 0..61 } else { 60..121 };
        motion.slice(frames).expect("a half")
    };
    let way = |name: &str, up: bool| learned(name, [60.0, 80.0].map(|h| half(up, h)).into_iter());
    let vocabulary = of_body(vec![way("up", true), way("down", false)]);
    let motion = seen(swing(Role::RightUpperArm, 70.0, false, 2.0, 60.0));
    // However few windows it may keep, and however coarse they are.
    for (most_windows, window_samples) in [(1000, 16), (8, 16), (1000, 8)] {
        let settings = NearestDtwSettings {
            most_windows,
            window_samples,
            window_secs: 0.5,
            ..NearestDtwSettings::default()
        };
        let nearest = NearestDtw::new(&vocabulary, &settings).expect("dtw");
        let told = readings(&nearest, &motion).expect("readings");
        // The same postures on the way up and on the way down.
        for (f, wanted) in [(30, 0), (45, 0), (90, 1), (105, 1)] {
            let case = format!("{most_windows} windows of {window_samples}, frame {f}");
            assert_eq!(told[f].posterior.best(), Some(wanted), "{case}");
        }
        // At 60 Hz, one answer in six is new.
        let changes = told.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(changes <= 121 / 6, "{changes} answers");
    }
}

#[test]
fn a_joint_that_is_missing_stays_where_it_was() {
    let motion = swing(Role::RightUpperArm, 75.0, false, 1.4, 60.0);
    let joints = BODY.joints().len();
    let gone = BODY.joints_of(Role::RightUpperArm)[0];
    let mut flags = vec![false; motion.frames() * joints];
    for f in (1..motion.frames()).step_by(2) {
        flags[f * joints + gone] = true;
    }
    // The values at missing joints are arbitrary.
    let mut poses = motion.poses().to_vec();
    for f in (1..motion.frames()).step_by(2) {
        for c in BODY.coordinates(gone) {
            poses[f * BODY.dof() + c] = 9.0;
        }
    }
    let broken = Motion::new(
        "broken",
        Arc::clone(&BODY),
        60.0,
        poses,
        motion.roots().to_vec(),
    );
    let broken = Observations::with_missing(broken.expect("a motion"), flags).expect("flags");
    for (name, recogniser) in looking(&VOCABULARY) {
        let told = recogniser.recognise(&broken).expect("an answer");
        let whole = recogniser
            .recognise(&seen(motion.clone()))
            .expect("an answer");
        assert_eq!(told.posterior.best(), Some(0), "{name}");
        assert!(
            (told.novelty - whole.novelty).abs() < 0.5,
            "{name}: {} {}",
            told.novelty,
            whole.novelty
        );
    }
}

#[test]
fn the_constant_answer_is_the_commonest() {
    let constant = Constant::new(&VOCABULARY).expect("a constant");
    let motion = seen(swing(Role::RightUpperArm, 75.0, true, 1.4, 60.0));
    let told = constant.recognise(&motion).expect("an answer");
    assert_eq!(told.posterior.best(), Some(1));
    assert_eq!(told.posterior.primitives, [0.3, 0.4, 0.3]);
    let stream = readings(&constant, &motion).expect("readings");
    assert!(stream.iter().all(|r| r.posterior == told.posterior));
}

#[test]
fn what_cannot_be_heard_is_refused() {
    let other = Arc::new(ares().expect("ares"));
    let keys = [0.0, 1.0].map(|time| Key {
        time,
        angles: BTreeMap::new(),
    });
    let stranger = seen(perform("stranger", &keys, &other, 60.0).expect("a motion"));
    let motion = seen(swing(Role::RightUpperArm, 75.0, false, 1.4, 60.0));
    let mut all = looking(&VOCABULARY);
    all.push((
        "constant",
        Box::new(Constant::new(&VOCABULARY).expect("a constant")),
    ));
    for (name, recogniser) in all {
        assert!(recogniser.recognise(&stranger).is_err(), "{name}");
        let mut listener = recogniser.listen();
        assert!(
            listener.hear(&stranger.at(0)).is_err(),
            "{name}: another body"
        );
        assert!(listener.hear(&motion.at(3)).is_ok(), "{name}");
        assert!(
            listener.hear(&motion.at(3)).is_err(),
            "{name}: no time has passed"
        );
        let flags = Observation {
            missing: &[true],
            ..motion.at(4)
        };
        assert!(
            listener.hear(&flags).is_err(),
            "{name}: flags of another body"
        );
    }
    let empty = Vocabulary::new(Arc::clone(&BODY), vec![], vec![], Transitions::none(0));
    let empty = empty.expect("a vocabulary");
    assert!(Constant::new(&empty).is_err_and(|e| e.is_unsupported()));
    let default = NearestDtwSettings::default();
    for settings in [
        NearestDtwSettings {
            samples: 1,
            ..default.clone()
        },
        NearestDtwSettings {
            shape: 1.5,
            ..default.clone()
        },
        NearestDtwSettings {
            band: 0.0,
            ..default.clone()
        },
        NearestDtwSettings {
            temperature: f64::NAN,
            ..default.clone()
        },
        NearestDtwSettings {
            features: Features::Effectors(vec![]),
            ..default.clone()
        },
        NearestDtwSettings {
            features: Features::Effectors(vec!["tail".into()]),
            ..default
        },
    ] {
        assert!(
            NearestDtw::new(&VOCABULARY, &settings).is_err(),
            "{settings:?}"
        );
    }
}
