//! Movements played slower or faster than anybody was seen to do them.

use std::collections::BTreeMap;
use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::perception::{Filter, FilterSettings};
use kineme::primitive::{Interpolation, Observations, Recogniser};
use kineme::{
    Exemplar, Modelling, Motion, Primitive, Provenance, Role, Skeleton, Transitions, Vocabulary,
    adonis,
};

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
    let exemplar = |motion: Motion| Exemplar {
        provenance: Provenance {
            motion: "swung".into(),
            start_secs: 0.0,
            end_secs: motion.duration_secs(),
            blake3: None,
        },
        motion,
        adverbs: None,
    };
    let modelling = Modelling {
        interpolation: Interpolation::Shepard,
        ..Modelling::default()
    };
    let primitives = SWINGS.map(|swings| {
        let of = |k: f64| exemplar(swung(body, swings, 50.0 + 10.0 * k, 2.0 + 0.1 * k));
        let exemplars = (0..4).map(|k| of(f64::from(k))).collect();
        Primitive::learn(&format!("{swings} swings"), exemplars, &modelling).expect("a primitive")
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
