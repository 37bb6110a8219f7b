//! Movements played slower or faster than anybody was seen to do them, and movements of no known kind.

use std::collections::BTreeMap;
use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::perception::{Filter, FilterSettings, calibrated};
use kineme::primitive::{Observations, Recogniser};
use kineme::{Motion, Role, Root, Skeleton, Transitions, Vocabulary, adonis};

use crate::learned;

/// How often the arm goes up and down again, in the same time.
const SWINGS: [usize; 3] = [1, 2, 3];

/// An arm is swung so many times.
fn swung(body: &Arc<Skeleton>, swings: usize, height: f64, secs: f64) -> Motion {
    let key = |k: usize| Key {
        time: secs * k as f64 / (2 * swings) as f64,
        angles: BTreeMap::from([(
            Role::RightUpperArm,
            vec![if k % 2 == 1 { height } else { 5.0 }],
        )]),
    };
    let keys: Vec<Key> = (0..=2 * swings).map(key).collect();
    perform("swung", &keys, body, 60.0).expect("a motion")
}

fn vocabulary(body: &Arc<Skeleton>) -> Vocabulary {
    let primitives = SWINGS.map(|swings| {
        let of = |k: f64| swung(body, swings, 50.0 + 10.0 * k, 2.0 + 0.1 * k);
        learned(
            &format!("{swings} swings"),
            (0..4).map(|k| of(f64::from(k))),
        )
    });
    let (primitives, none) = (primitives.to_vec(), Transitions::none(SWINGS.len()));
    let vocabulary = Vocabulary::new(Arc::clone(body), primitives, vec![], none).expect("three");
    let learned = Filter::calibration(&vocabulary, &[None, None, None]).expect("learned");
    vocabulary.calibrated(learned).expect("calibrated")
}

#[test]
fn a_clip_played_at_half_or_double_speed_keeps_its_name() {
    let body = Arc::new(adonis().expect("a body"));
    let vocabulary = vocabulary(&body);
    let filter = Filter::new(&vocabulary, &FilterSettings::default()).expect("a filter");
    for (k, swings) in SWINGS.into_iter().enumerate() {
        for pace in [0.5, 1.0, 2.0] {
            let seen = Observations::complete(swung(&body, swings, 65.0, 2.15 / pace));
            let told = filter.recognise(&seen).expect("an answer");
            let p = &told.posterior.primitives;
            assert!(
                (0..SWINGS.len()).all(|other| other == k || p[k] > p[other]),
                "{swings} at {pace}: {p:?}"
            );
        }
    }
}

#[test]
fn what_is_none_of_the_primitives_still_has_a_likeliest_one() {
    let body = Arc::new(adonis().expect("a body"));
    let vocabulary = vocabulary(&body);
    let filter = Filter::new(&vocabulary, &FilterSettings::default()).expect("a filter");
    let flung = |f: usize| -> Vec<f64> {
        let angle = if f % 20 < 10 { 2.5 } else { -2.5 };
        vec![angle; body.dof()]
    };
    let poses: Vec<f64> = (0..120).flat_map(flung).collect();
    let roots = vec![Root::ORIGIN; 120];
    let motion = Motion::new("flung", Arc::clone(&body), 60.0, poses, roots).expect("a motion");
    let told = filter.recognise(&Observations::complete(motion));
    let p = told.expect("an answer").posterior;
    assert!(p.none > 0.99 && p.none < 1.0, "{p:?}");
    assert!(p.primitives.iter().any(|&v| v > 0.0), "{p:?}");
    let sum = p.none + p.rest + p.primitives.iter().sum::<f64>();
    assert!((sum - 1.0).abs() < 1e-9, "{p:?}");
}

#[test]
fn what_an_earlier_build_kept_is_learned_anew() {
    let body = Arc::new(adonis().expect("a body"));
    let vocabulary = vocabulary(&body);
    let learned = vocabulary.calibration("filter").expect("learned").clone();
    let mut old = learned.clone();
    old.shared[0] -= 1.0;
    old.primitives = vec![vec![1.0]; SWINGS.len()];
    let before = vocabulary.clone().calibrated(old).expect("as it was kept");
    let now = calibrated(before.clone(), Some(&before)).expect("calibrated");
    assert_eq!(now.calibration("filter"), Some(&learned));
}
