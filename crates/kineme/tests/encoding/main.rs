//! Trajectory encoding: its laws, on movements made by hand.

mod calibrated;
mod outlines;
mod performed;
mod vocabulary;

use std::collections::BTreeMap;
use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::perception::encoding::{
    Confidence, EffectorPaths, Encoder, Encoding, EncodingMethod, EncodingSettings, Extent,
    Matching, Rejection,
};
use kineme::primitive::{Observations, Posterior, Recogniser, readings};
use kineme::{
    Exemplar, Format, Modelling, Observed, Primitive, RecordedJoint, Recording, Role, Source,
    Transitions, Vocabulary,
};
use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use vocabulary::{NAMES, changed, joined, made, paths, vocabulary, vocabulary_of};

fn encoder(settings: &EncodingSettings) -> Encoder<'static> {
    Encoder::new(vocabulary(), settings).expect("an encoder")
}

fn label(encoding: &Encoding) -> Option<&'static str> {
    encoding.label().map(|k| NAMES[k])
}

fn check_posterior(posterior: &Posterior) {
    let all = posterior
        .primitives
        .iter()
        .chain([&posterior.rest, &posterior.none]);
    assert!(
        all.clone().all(|p| (0.0..=1.0 + 1e-12).contains(p)),
        "{posterior:?}"
    );
    assert!((all.sum::<f64>() - 1.0).abs() < 1e-9, "{posterior:?}");
}

fn check_spans(encoding: &Encoding, secs: f64) {
    let mut at = 0.0;
    for span in &encoding.spans {
        assert!((span.start_secs - at).abs() < 1e-9, "{:?}", encoding.spans);
        assert!((0.0..=1.0).contains(&span.similarity));
        at = span.end_secs;
    }
    assert!((at - secs).abs() < 1e-9, "{:?}", encoding.spans);
}

/// Heights between those of the exemplars.
const BETWEEN: [f64; 3] = [0.15, 0.5, 0.85];

#[test]
fn what_a_primitive_makes_is_that_primitive_from_beginning_to_end() {
    let encoder = encoder(&EncodingSettings::default());
    for name in NAMES {
        for height in BETWEEN {
            let seen = paths(&made(name, height));
            let encoding = encoder.encode(name, &seen).expect("an encoding");
            check_posterior(&encoding.posterior);
            check_spans(&encoding, seen.duration_secs());
            assert_eq!(label(&encoding), Some(name), "{height}: {encoding:?}");
            for span in &encoding.spans {
                assert_eq!(span.primitive.map(|k| NAMES[k]), Some(name), "{height}");
                assert!(span.margin > 0.0);
            }
            let rmse = encoding.rmse_m.expect("a distance");
            assert!(rmse < 0.08, "{name} {height}: {rmse} m");
        }
    }
}

#[test]
fn hands_that_a_turning_trunk_carries_are_met_as_near_as_others() {
    let body = vocabulary::body();
    let key = |time: f64, turn: f64| Key {
        time,
        angles: BTreeMap::from([
            (Role::Chest, vec![0.0, 0.0, turn]),
            (Role::RightUpperArm, vec![70.0, 5.0, 0.0]),
            (Role::LeftUpperArm, vec![70.0, 5.0, 0.0]),
        ]),
    };
    let twist = |deg: f64| {
        let keys = [key(0.0, 0.0), key(0.4, deg), key(0.8, 0.0)];
        perform("twist", &keys, body, 60.0).expect("a motion")
    };
    let exemplars = [-40.0, -30.0].map(|deg| Exemplar::whole(twist(deg), Some(vec![deg])));
    let twists = Primitive::learn("twist", exemplars.into(), &Modelling::default());
    let twists = twists.expect("a primitive");
    let primitives = vec![twists, vocabulary().primitives()[0].clone()];
    let none = Transitions::none(2);
    let both = Vocabulary::new(Arc::clone(body), primitives, Vec::new(), none).expect("both");
    let encoder = Encoder::new(&both, &EncodingSettings::default()).expect("an encoder");
    let seen = paths(&twist(-40.0));
    let encoding = encoder.encode("twist", &seen).expect("an encoding");
    assert_eq!(encoding.label(), Some(0), "{encoding:?}");
    let rmse = encoding.rmse_m.expect("a distance");
    assert!(rmse < 0.02, "{rmse} m");
}

#[test]
fn days_of_paths_are_refused_at_once() {
    let encoder = encoder(&EncodingSettings::default());
    let short = paths(&made("hook", 0.5));
    let points = (0..short.frames()).flat_map(|f| short.at(f).to_vec());
    let slow = EffectorPaths::new(1e-3, short.effectors().to_vec(), points.collect());
    let refused = encoder.encode("slow", &slow.expect("paths"));
    let why = refused
        .expect_err("a day has too many instants")
        .to_string();
    assert!(why.contains("1000000 instants"), "{why}");
}

#[test]
fn the_size_of_the_observed_body_does_not_matter() {
    let encoder = encoder(&EncodingSettings::default());
    for name in NAMES {
        let seen = paths(&made(name, 0.5));
        let own = encoder.encode(name, &seen).expect("an encoding");
        for scale in [0.7, 1.4] {
            let other = changed(&seen, |_, _, p| Some(scale * p));
            let other = encoder.encode(name, &other).expect("an encoding");
            assert_eq!(other.label(), own.label());
            let pairs = own
                .posterior
                .primitives
                .iter()
                .zip(&other.posterior.primitives);
            for (a, b) in pairs {
                assert!((a - b).abs() < 1e-3, "{name} {scale}: {a} {b}");
            }
        }
    }
    // A known reach: the same as the body's own, scaled along with the points.
    let reach = encoder.body_reach_m();
    for scale in [0.7, 1.0, 1.4] {
        let settings = EncodingSettings {
            reach_m: Some(scale * reach),
            ..EncodingSettings::default()
        };
        let encoder = self::encoder(&settings);
        let seen = changed(&paths(&made("hook", 0.5)), |_, _, p| Some(scale * p));
        let encoding = encoder.encode("hook", &seen).expect("an encoding");
        assert_eq!(label(&encoding), Some("hook"));
        assert!(encoding.rmse_m.expect("a distance") < 0.08);
    }
}

#[test]
fn a_random_walk_is_none_of_the_primitives() {
    let encoder = encoder(&EncodingSettings::default());
    for seed in 0..5 {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut at = [Vector3::new(0.2, 0.2, -0.3), Vector3::new(0.2, -0.2, -0.3)];
        let mut points = Vec::new();
        for _ in 0..90 {
            for p in &mut at {
                let step = Vector3::from_fn(|_, _| random.random_range(-0.09..0.09));
                *p = (*p + step).cap_magnitude(0.6);
                points.push(Some(*p));
            }
        }
        let effectors = EncodingSettings::default().effectors;
        let walk = EffectorPaths::new(60.0, effectors, points).expect("paths");
        let encoding = encoder.encode("walk", &walk).expect("an encoding");
        check_posterior(&encoding.posterior);
        assert_eq!(label(&encoding), None, "{seed}: {:?}", encoding.posterior);
        assert!(encoding.spans.iter().all(|s| s.primitive.is_none()));
    }
}

#[test]
fn standing_still_is_rest_and_seeing_nothing_is_nothing() {
    let encoder = encoder(&EncodingSettings::default());
    let moving = paths(&made("reach", 0.5));
    let start = moving.at(0).to_vec();
    let still = changed(&moving, |_, e, _| start[e]);
    let encoding = encoder.encode("still", &still).expect("an encoding");
    assert_eq!(encoding.posterior.rest, 1.0);
    assert_eq!(label(&encoding), None);
    let blind = changed(&moving, |_, _, _| None);
    let encoding = encoder.encode("blind", &blind).expect("an encoding");
    assert_eq!((encoding.posterior.none, encoding.rmse_m), (1.0, None));
    check_posterior(&encoding.posterior);
    let single = EffectorPaths::new(60.0, moving.effectors().to_vec(), start).expect("paths");
    let encoding = encoder.encode("single", &single).expect("an encoding");
    check_posterior(&encoding.posterior);
    assert_eq!(label(&encoding), None);
}

#[test]
fn missing_points_are_missing_and_not_zero() {
    let encoder = encoder(&EncodingSettings::default());
    for name in NAMES {
        let seen = paths(&made(name, 0.5));
        let gappy = changed(&seen, |f, e, p| {
            (f % 17 > 4 || e == 1 && f % 3 == 0).then_some(p)
        });
        let encoding = encoder.encode(name, &gappy).expect("an encoding");
        assert_eq!(label(&encoding), Some(name), "{:?}", encoding.posterior);
    }
}

#[test]
fn movements_that_follow_one_another_are_told_apart_and_joined_without_a_jump() {
    let settings = EncodingSettings {
        extent: Extent::Stream,
        ..EncodingSettings::default()
    };
    let encoder = encoder(&settings);
    let order = ["reach", "raise", "hook", "reach", "spread"];
    let motion = joined(&order.map(|name| made(name, 0.5)));
    let seen = paths(&motion);
    let encoding = encoder.encode("joined", &seen).expect("an encoding");
    check_posterior(&encoding.posterior);
    check_spans(&encoding, seen.duration_secs());
    let long = encoding
        .spans
        .iter()
        .filter(|s| s.end_secs - s.start_secs > 0.5);
    let told: Vec<_> = long.filter_map(|s| s.primitive).map(|k| NAMES[k]).collect();
    assert_eq!(told, order, "{:?}", encoding.spans);
    // Half a radian a frame would be 15 rad/s; the exemplars' own movement is below that.
    let made = &encoding.motion;
    for f in 1..made.frames() {
        let pairs = made.pose(f).iter().zip(made.pose(f - 1));
        let jump = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(jump < 0.35, "frame {f}: {jump} rad");
    }
    assert!(
        encoding.rmse_m.expect("a distance") < 0.1,
        "{:?}",
        encoding.rmse_m
    );
}

#[test]
fn unknown_movements_are_followed_by_the_effectors() {
    let encoder = encoder(&EncodingSettings::default());
    // Both hands draw circles before the chest.
    let effectors = EncodingSettings::default().effectors;
    let points = (0..120).flat_map(|f| {
        let (s, c) = (f as f64 * 0.21).sin_cos();
        [0.2, -0.2].map(|y| Some(Vector3::new(0.3 + 0.12 * c, y + 0.12 * s, -0.1 - 0.1 * s)))
    });
    let circles = EffectorPaths::new(60.0, effectors, points.collect()).expect("paths");
    let encoding = encoder.encode("circles", &circles).expect("an encoding");
    assert_eq!(label(&encoding), None, "{:?}", encoding.posterior);
    let rmse = encoding.rmse_m.expect("a distance");
    assert!(rmse < 0.12, "{rmse} m");
}

#[test]
fn the_order_of_the_vocabulary_and_the_number_of_threads_are_irrelevant() {
    let other = ["hook", "spread", "reach", "raise"];
    let turned = vocabulary_of(&other);
    let settings = EncodingSettings::default();
    let turned = Encoder::new(&turned, &settings).expect("an encoder");
    let encoder = encoder(&settings);
    for name in NAMES {
        let seen = paths(&made(name, 0.4));
        let a = encoder.encode(name, &seen).expect("an encoding");
        let b = turned.encode(name, &seen).expect("an encoding");
        for (k, name) in NAMES.iter().enumerate() {
            let there = other.iter().position(|n| n == name).expect("a name");
            let gap = a.posterior.primitives[k] - b.posterior.primitives[there];
            assert!(gap.abs() < 1e-6, "{name}: {gap}");
        }
        assert_eq!(a.motion.poses(), b.motion.poses());
        let again = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let encoder = Encoder::new(vocabulary(), &settings).expect("an encoder");
                encoder.encode(name, &seen).expect("an encoding")
            })
        };
        assert_eq!(again(1), again(3));
    }
}

#[test]
fn a_recording_needs_no_elbows() {
    let encoder = encoder(&EncodingSettings::default());
    let names = [
        "left_shoulder",
        "right_shoulder",
        "left_wrist",
        "right_wrist",
        "hip_center",
    ];
    let joints = names.map(|name| RecordedJoint {
        name: name.into(),
        parent: None,
        offset: Vector3::zeros(),
        tip: None,
        order: None,
        dof: 3,
    });
    for name in NAMES {
        let motion = made(name, 0.5);
        let at = [
            "left_shoulder",
            "right_shoulder",
            "left_wrist",
            "right_wrist",
            "pelvis",
        ]
        .map(|n| motion.skeleton().joint(n).expect("a joint"));
        // Another place, another heading, another size; one frame without its shoulders.
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.1);
        let points = (0..motion.frames()).flat_map(|f| {
            let frames = motion.frames_at(f);
            at.map(|j| {
                let p = turn * frames[j].position * 1.2 + Vector3::new(2.0, -1.0, 0.3);
                (f != 9).then_some(p)
            })
        });
        let recording = Recording::new(
            name,
            Source {
                format: Format::PositionTable,
                up: kineme::math::rotation::Axis::Z,
                unit_metres: 1.0,
                warnings: Vec::new(),
            },
            joints.to_vec(),
            60.0,
            Observed::Positions(points.collect()),
        )
        .expect("a recording");
        let s = encoder.settings();
        let seen = EffectorPaths::of_recording(&recording, None, &s.effectors, s.heading_secs);
        let seen = seen.expect("paths");
        assert_eq!(seen.at(9), [None, None]);
        let encoding = encoder.encode(name, &seen).expect("an encoding");
        assert_eq!(label(&encoding), Some(name), "{:?}", encoding.posterior);
        let feet = ["left_foot".to_owned()];
        let refused = EffectorPaths::of_recording(&recording, None, &feet, 0.0);
        assert!(
            refused
                .expect_err("no feet")
                .to_string()
                .contains("left_foot")
        );
    }
}

#[test]
fn a_recogniser_answers_wholes_and_streams() {
    let encoder = encoder(&EncodingSettings::default());
    for (k, name) in NAMES.into_iter().enumerate() {
        let seen = Observations::complete(made(name, 0.5));
        let whole = encoder.recognise(&seen).expect("an answer");
        check_posterior(&whole.posterior);
        assert_eq!(whole.posterior.best(), Some(k));
        assert_eq!(whole.parameters.len(), 1);
        assert!(
            (whole.parameters[0] - 0.5).abs() < 0.35,
            "{:?}",
            whole.parameters
        );
        assert!(whole.novelty < 1.0);
        let answers = readings(&encoder, &seen).expect("answers");
        assert_eq!(answers.len(), seen.motion().frames());
        for reading in &answers {
            check_posterior(&reading.posterior);
        }
        // The movement is told by its middle; phase is that of a horizon ago.
        let late = &answers[answers.len() * 3 / 4];
        assert_eq!(late.posterior.best(), Some(k), "{name}: {late:?}");
        let place = late.place.as_ref().expect("a place");
        assert!((0.2..0.9).contains(&place.phase), "{place:?}");
        // What was answered before does not depend on what came later.
        let part = seen.motion().slice(0..40).expect("a part");
        let early = readings(&encoder, &Observations::complete(part)).expect("answers");
        assert_eq!(early[..], answers[..40]);
    }
    let other = kineme::ares().expect("a body");
    let pose = other.neutral();
    let root = vec![kineme::Root::ORIGIN];
    let other = kineme::Motion::new("other", other.into(), 60.0, pose, root).expect("a motion");
    assert!(encoder.recognise(&Observations::complete(other)).is_err());
}

#[test]
fn the_papers_method_gives_everything_to_somebody() {
    for matching in [
        Matching::Position,
        Matching::Displacement,
        Matching::Velocity,
        Matching::Warped,
    ] {
        let settings = EncodingSettings {
            method: EncodingMethod::Paper,
            matching,
            ..EncodingSettings::default()
        };
        let encoder = encoder(&settings);
        for name in ["reach", "raise"] {
            let seen = paths(&made(name, 0.5));
            let encoding = encoder.encode(name, &seen).expect("an encoding");
            check_posterior(&encoding.posterior);
            check_spans(&encoding, seen.duration_secs());
            assert_eq!(
                (encoding.posterior.none, encoding.posterior.rest),
                (0.0, 0.0)
            );
            assert!(encoding.spans.iter().all(|s| s.primitive.is_some()));
            let made = &encoding.motion;
            for f in 1..made.frames() {
                let pairs = made.pose(f).iter().zip(made.pose(f - 1));
                let jump = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(jump < 0.6, "{matching:?} frame {f}: {jump} rad");
            }
            // Even what nobody knows.
            let noise = changed(&seen, |f, e, p| {
                Some(p + Vector3::new((f * 7 % 5) as f64, (e * 3 + f % 3) as f64, 0.0) * 0.05)
            });
            let encoding = encoder.encode(name, &noise).expect("an encoding");
            assert!(encoding.label().is_some());
        }
    }
}

#[test]
fn a_rejection_is_plain_numbers_that_serve_again() {
    let settings = EncodingSettings::default();
    let encoder = encoder(&settings);
    let kept: Rejection = encoder.rejection().clone();
    assert_eq!(kept.limits.len(), NAMES.len());
    let again = Encoder::with_rejection(vocabulary(), &settings, kept.clone()).expect("an encoder");
    let seen = paths(&made("hook", 0.2));
    assert_eq!(again.encode("a", &seen), encoder.encode("a", &seen));
    let short = Rejection {
        limits: vec![1.0],
        ..kept.clone()
    };
    let broken = Rejection {
        bias: f64::NAN,
        ..kept.clone()
    };
    let unsure = Rejection {
        confidence: Confidence {
            spread: -0.1,
            ..kept.confidence
        },
        ..kept
    };
    for wrong in [short, broken, unsure] {
        assert!(Encoder::with_rejection(vocabulary(), &settings, wrong).is_err());
    }
}

#[test]
fn a_clip_of_one_part_is_as_sure_of_it_as_of_the_whole() {
    let settings = EncodingSettings::default();
    let fitted = encoder(&settings);
    let encoding = |confidence| {
        let rejection = Rejection {
            confidence,
            ..fitted.rejection().clone()
        };
        let encoder = Encoder::with_rejection(vocabulary(), &settings, rejection);
        let encoder = encoder.expect("an encoder");
        encoder
            .encode("hook", &paths(&made("hook", 0.3)))
            .expect("an encoding")
    };
    let [sure, modest] = [0.01, 0.05].map(|temperature| {
        encoding(Confidence {
            temperature,
            spread: 0.5,
        })
    });
    let known = |e: &Encoding| {
        let (k, none) = (e.label().expect("a label"), e.posterior.none);
        let [only] = e.spans.as_slice() else {
            panic!("one part: {:?}", e.spans);
        };
        let share = e.posterior.primitives[k] / (1.0 - none);
        assert!((only.confidence - share).abs() < 1e-9, "{e:?}");
        share
    };
    assert!(known(&sure) > known(&modest));
    // How sure the choice is, is no matter of whether it is any of them.
    assert_eq!(modest.posterior.none, sure.posterior.none);
    assert_eq!(modest.label(), sure.label());
}

#[test]
fn a_vocabulary_of_one_knows_its_own() {
    let alone = vocabulary_of(&["reach"]);
    let encoder = Encoder::new(&alone, &EncodingSettings::default()).expect("an encoder");
    let own = encoder
        .encode("own", &paths(&made("reach", 0.5)))
        .expect("an encoding");
    assert_eq!(own.label(), Some(0));
    let other = encoder
        .encode("other", &paths(&made("spread", 0.5)))
        .expect("an encoding");
    assert_eq!(other.label(), None, "{:?}", other.posterior);
}

#[test]
fn what_cannot_be_is_refused() {
    let good = EncodingSettings::default;
    let wrong = [
        EncodingSettings {
            effectors: vec![],
            ..good()
        },
        EncodingSettings {
            effectors: vec!["tail".into()],
            ..good()
        },
        EncodingSettings {
            decision_secs: 0.0,
            ..good()
        },
        EncodingSettings {
            decision_secs: f64::NAN,
            ..good()
        },
        EncodingSettings {
            horizon_secs: 100.0,
            ..good()
        },
        EncodingSettings {
            horizon_secs: f64::NAN,
            ..good()
        },
        EncodingSettings {
            rates: vec![],
            ..good()
        },
        EncodingSettings {
            rates: vec![1e9],
            ..good()
        },
        EncodingSettings {
            temperature: 0.0,
            ..good()
        },
        EncodingSettings {
            switch_cost: -1.0,
            ..good()
        },
        EncodingSettings {
            reach_m: Some(0.0),
            ..good()
        },
        EncodingSettings { beam: 0, ..good() },
    ];
    for settings in wrong {
        assert!(
            Encoder::new(vocabulary(), &settings).is_err(),
            "{settings:?}"
        );
    }
    let encoder = encoder(&good());
    let feet = EffectorPaths::new(30.0, vec!["left_foot".into()], vec![None; 9]).expect("paths");
    assert!(encoder.encode("feet", &feet).is_err());
    let name = || vec!["left_hand".to_owned()];
    assert!(EffectorPaths::new(0.0, name(), vec![None]).is_err());
    assert!(EffectorPaths::new(30.0, name(), vec![]).is_err());
    assert!(EffectorPaths::new(30.0, vec![], vec![None]).is_err());
    let nan = Some(Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(EffectorPaths::new(30.0, name(), vec![nan]).is_err());
}
