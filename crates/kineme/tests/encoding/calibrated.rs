//! What recognisers learn of a vocabulary is kept with it, and an edit keeps what did not change.

use kineme::perception::calibrated;
use kineme::perception::encoding::{Encoder, EncodingSettings, Extent};
use kineme::primitive::Calibration;
use kineme::{Modelling, Primitive, Transitions, Vocabulary};

use crate::vocabulary::{NAMES, made, paths, vocabulary, vocabulary_of};

/// Numbers that no fit gives: 1000 and more. The first that the whole has is its edition, and stays.
fn hand_made(vocabulary: &Vocabulary, of: &Calibration) -> Calibration {
    let number = |p: usize, i: usize| 1000.0 + (10 * p + i) as f64;
    let length = |p: usize| of.primitives[p].len();
    let primitives = 0..vocabulary.primitives().len();
    let mut shared: Vec<f64> = (0..of.shared.len()).map(|i| number(100, i)).collect();
    shared[0] = of.shared[0];
    Calibration {
        recogniser: of.recogniser.clone(),
        primitives: primitives
            .map(|p| (0..length(p)).map(|i| number(p, i)).collect())
            .collect(),
        shared,
    }
}

/// The vocabulary of the four movements, calibrated by hand.
fn before() -> Vocabulary {
    let fitted = calibrated(vocabulary().clone(), None).expect("a calibrated vocabulary");
    assert!(!fitted.calibrations().is_empty());
    let by_hand = fitted.calibrations().to_vec();
    let by_hand = by_hand.iter().map(|c| hand_made(&fitted, c));
    by_hand.fold(vocabulary().clone(), |v, c| {
        v.calibrated(c).expect("finite numbers")
    })
}

fn of(primitives: Vec<Primitive>) -> Vocabulary {
    let none = Transitions::none(primitives.len());
    let body = vocabulary().body();
    Vocabulary::new(body.clone(), primitives, Vec::new(), none).expect("a vocabulary")
}

#[test]
fn an_encoder_is_the_same_with_and_without_what_is_kept() {
    let kept = calibrated(vocabulary().clone(), None).expect("a calibrated vocabulary");
    let stream = EncodingSettings {
        extent: Extent::Stream,
        reach_m: Some(0.7),
        ..EncodingSettings::default()
    };
    for settings in [EncodingSettings::default(), stream] {
        let fresh = Encoder::new(vocabulary(), &settings).expect("an encoder");
        let other = Encoder::new(&kept, &settings).expect("an encoder");
        assert_eq!(other.rejection(), fresh.rejection());
        let seen = paths(&made("raise", 0.4));
        assert_eq!(other.encode("a", &seen), fresh.encode("a", &seen));
    }
}

#[test]
fn what_is_kept_serves_the_settings_it_was_fitted_to() {
    let kept = before();
    let default = EncodingSettings::default;
    let cases = [
        (default(), true),
        (
            EncodingSettings {
                switch_cost: 0.7,
                ..default()
            },
            true,
        ),
        (
            EncodingSettings {
                decision_secs: 0.3,
                ..default()
            },
            false,
        ),
        (
            EncodingSettings {
                effectors: vec!["right_hand".into()],
                ..default()
            },
            false,
        ),
    ];
    for (settings, serves) in cases {
        let encoder = Encoder::new(&kept, &settings).expect("an encoder");
        assert_eq!(
            encoder.rejection().limits[0] == 1000.0,
            serves,
            "{settings:?}"
        );
    }
}

#[test]
fn an_edit_keeps_the_numbers_of_what_did_not_change() {
    let before = before();
    let all = before.primitives();
    let renamed = all[2].clone().renamed("jab");
    let changed = {
        let exemplars = all[1].exemplars()[..3].to_vec();
        Primitive::learn(NAMES[1], exemplars, &Modelling::default()).expect("a primitive")
    };
    let copy = |i: usize| all[i].clone();
    // The primitives after the edit, and where each was before; `None` where it changed.
    let cases = [
        (
            "nothing",
            before.primitives().to_vec(),
            vec![Some(0), Some(1), Some(2), Some(3)],
        ),
        (
            "renamed",
            vec![copy(0), copy(1), renamed, copy(3)],
            vec![Some(0), Some(1), Some(2), Some(3)],
        ),
        (
            "names change places",
            vec![
                all[0].clone().renamed(NAMES[1]),
                all[1].clone().renamed(NAMES[0]),
                copy(2),
                copy(3),
            ],
            vec![Some(0), Some(1), Some(2), Some(3)],
        ),
        (
            "order",
            vec![copy(3), copy(0), copy(1), copy(2)],
            vec![Some(3), Some(0), Some(1), Some(2)],
        ),
        (
            "removed",
            vec![copy(0), copy(2), copy(3)],
            vec![Some(0), Some(2), Some(3)],
        ),
        (
            "changed",
            vec![copy(0), changed, copy(2), copy(3)],
            vec![Some(0), None, Some(2), Some(3)],
        ),
    ];
    for (what, primitives, places) in cases {
        let stayed = places.iter().copied().eq((0..all.len()).map(Some));
        let after = calibrated(of(primitives), Some(&before)).expect(what);
        assert_eq!(after.calibrations().len(), before.calibrations().len());
        for (now, then) in after.calibrations().iter().zip(before.calibrations()) {
            let what = format!("{what}: {}", now.recogniser);
            for (numbers, place) in now.primitives.iter().zip(&places) {
                match place {
                    Some(place) => assert_eq!(*numbers, then.primitives[*place], "{what}"),
                    None => assert!(numbers.iter().all(|v| *v < 1000.0), "{what}: {numbers:?}"),
                }
            }
            assert_eq!(now.shared == then.shared, stayed, "{what}");
        }
    }
}

#[test]
fn what_was_never_calibrated_is_fitted_whole() {
    let known = calibrated(vocabulary().clone(), None).expect("a calibrated vocabulary");
    let again = calibrated(vocabulary().clone(), Some(vocabulary()));
    assert_eq!(again.as_ref(), Ok(&known));
    let empty = of(Vec::new());
    assert_eq!(calibrated(empty.clone(), None), Ok(empty));
}

#[test]
fn calibration_is_the_same_on_one_thread_and_on_two() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        pool.install(|| calibrated(vocabulary_of(&NAMES), None))
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn a_calibration_of_another_kind_is_refused_by_the_encoder() {
    let kept = before();
    let good = kept.calibration("encoder").expect("a calibration").clone();
    let rows = |numbers: &[f64]| vec![numbers.to_vec(); NAMES.len()];
    let wrong = [
        Calibration {
            primitives: rows(&[1.0, 2.0]),
            ..good.clone()
        },
        Calibration {
            primitives: rows(&[-1.0]),
            ..good.clone()
        },
        Calibration {
            shared: Vec::new(),
            ..good
        },
    ];
    for wrong in wrong {
        let vocabulary = vocabulary()
            .clone()
            .calibrated(wrong)
            .expect("finite numbers");
        assert!(Encoder::new(&vocabulary, &EncodingSettings::default()).is_err());
        // To calibrate it again is the way out.
        let again = calibrated(of(vocabulary.primitives()[1..].to_vec()), Some(&vocabulary));
        let again = again.expect("a calibrated vocabulary");
        assert!(Encoder::new(&again, &EncodingSettings::default()).is_ok());
    }
}

#[test]
fn what_an_earlier_encoder_kept_is_fitted_anew() {
    let mut old = before().calibration("encoder").expect("kept").clone();
    // It began with the limit.
    old.shared.remove(0);
    let old = vocabulary()
        .clone()
        .calibrated(old)
        .expect("finite numbers");
    let settings = EncodingSettings::default();
    let fresh = Encoder::new(vocabulary(), &settings).expect("an encoder");
    let other = Encoder::new(&old, &settings).expect("an encoder");
    assert_eq!(other.rejection(), fresh.rejection());
    let again = calibrated(old.clone(), Some(&old)).expect("a calibrated vocabulary");
    let known = calibrated(vocabulary().clone(), None).expect("a calibrated vocabulary");
    assert_eq!(again.calibration("encoder"), known.calibration("encoder"));
}
