//! Vocabularies of primitives that were really learned: what is read is what was written, to the last bit.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

use kineme::choreography::{Key, perform};
use kineme::primitive::{Calibration, Group, Interpolation, Parameterisation};
use kineme::{
    Behavior, Exemplar, Modelling, Motion, Primitive, Provenance, Role, Root, Skeleton,
    Transitions, Vocabulary,
};
use kineme_formats::Place;
use kineme_formats::vocabulary::{MethodMeta, SourceMeta, VocabularyFile, read, write};
use proptest::prelude::*;

use crate::refused;
use crate::vocabulary::example;

fn exemplar(motion: Motion, adverbs: Option<Vec<f64>>) -> Exemplar {
    Exemplar {
        provenance: Provenance {
            motion: motion.name().to_string(),
            start_secs: 0.1,
            end_secs: 0.1 + motion.duration_secs(),
            blake3: adverbs.is_some().then(|| "0f".repeat(32)),
        },
        motion,
        adverbs,
    }
}

/// A reach with the right arm, out and back; `height` and `side` in [0, 1].
fn reach(body: &Arc<Skeleton>, height: f64, side: f64) -> Motion {
    let key = |time: f64, arm: [f64; 3], elbow: f64| Key {
        time: time * (0.8 + 0.2 * height),
        angles: BTreeMap::from([
            (Role::RightUpperArm, arm.to_vec()),
            (Role::RightLowerArm, vec![elbow]),
        ]),
    };
    let out = [40.0 + 70.0 * height, 5.0 + 20.0 * side, 20.0 * side];
    let keys = [
        key(0.0, [15.0, 8.0, 0.0], 100.0),
        key(0.5, out, 15.0),
        key(1.0, [15.0, 8.0, 0.0], 100.0),
    ];
    perform("reach.toml", &keys, body, 1.0 / 0.0333333).unwrap()
}

/// One turn of both arms, as in walking.
fn cycle(body: &Arc<Skeleton>, size: f64) -> Motion {
    const FRAMES: usize = 41;
    let roots = (0..FRAMES).map(|f| Root {
        position: [f as f64 / 30.0, -0.0, 0.95].into(),
        yaw: 1e-300,
    });
    let dof = body.dof();
    let pose = |f: usize| {
        let phase = TAU * f as f64 / (FRAMES - 1) as f64;
        (0..dof).map(move |i| size * (phase + i as f64).sin())
    };
    let poses = (0..FRAMES).flat_map(pose).collect();
    Motion::new("walk", Arc::clone(body), 30.0, poses, roots.collect()).unwrap()
}

fn learned(name: &str, exemplars: Vec<Exemplar>, modelling: Modelling) -> Primitive {
    Primitive::learn(name, exemplars, &modelling).unwrap()
}

/// A primitive of every kind of fit.
pub fn vocabulary() -> Vocabulary {
    let body = Arc::new(kineme::adonis().unwrap());
    let grid = |said: bool| -> Vec<Exemplar> {
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.4, 0.7]];
        let adverbs = |at: [f64; 2]| said.then(|| vec![at[0] / 3.0, -at[1]]);
        let motions = corners.map(|at| exemplar(reach(&body, at[0], at[1]), adverbs(at)));
        motions.into()
    };
    let plain = Modelling::default;
    let primitives = vec![
        learned(
            "adverbs",
            grid(true),
            Modelling {
                adverbs: vec!["height".into(), "side".into()],
                interpolation: Interpolation::VerbsAndAdverbs,
                ..plain()
            },
        ),
        learned("principal", grid(false), plain()).of_group(Group {
            members: 9,
            coherence: Some(0.1 + 0.7),
        }),
        learned(
            "effector",
            grid(false),
            Modelling {
                parameterisation: Parameterisation::Effector("right_hand".into()),
                interpolation: Interpolation::Shepard,
                ..plain()
            },
        ),
        learned(
            "single",
            vec![exemplar(reach(&body, 0.3, 0.1), None)],
            plain(),
        ),
        learned(
            "cycle",
            vec![
                exemplar(cycle(&body, 0.2), None),
                exemplar(cycle(&body, 0.3), None),
            ],
            Modelling {
                cyclic: Some(true),
                ..plain()
            },
        ),
    ];
    let behaviors = vec![Behavior {
        name: "wave".to_string(),
        primitives: vec!["adverbs".to_string(), "single".to_string()],
    }];
    let n = primitives.len();
    let mut counts = vec![0; n * n];
    (counts[1], counts[n], counts[n * n - 1]) = (5, 2, u32::MAX);
    let vocabulary = Vocabulary::new(body, primitives, behaviors, Transitions { counts, n });
    let calibration = |recogniser: &str, shared: &[f64]| Calibration {
        recogniser: recogniser.into(),
        primitives: (0..n).map(|p| vec![p as f64 / 3.0, -0.0]).collect(),
        shared: shared.to_vec(),
    };
    let vocabulary = vocabulary.unwrap();
    let vocabulary = vocabulary.calibrated(calibration("voter", &[1e-300, 0.1 + 0.2]));
    vocabulary
        .unwrap()
        .calibrated(calibration("filter", &[]))
        .unwrap()
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn a_vocabulary_comes_back_bit_for_bit() {
    let vocabulary = vocabulary();
    let bytes = write(&vocabulary, "v").unwrap();
    let back = read("v", &bytes).unwrap();
    assert_eq!(back, vocabulary);
    for (a, b) in vocabulary.calibrations().iter().zip(back.calibrations()) {
        assert_eq!(bits(&a.primitives.concat()), bits(&b.primitives.concat()));
        assert_eq!(bits(&a.shared), bits(&b.shared));
    }
    assert_eq!(back.calibrations().len(), 2);
    assert_eq!(write(&back, "v").unwrap(), bytes);
    for (p, q) in vocabulary.primitives().iter().zip(back.primitives()) {
        let name = p.name();
        for (a, b) in p.exemplars().iter().zip(q.exemplars()) {
            assert_eq!(bits(a.motion.poses()), bits(b.motion.poses()), "{name}");
            assert_eq!(a.motion.roots(), b.motion.roots(), "{name}");
        }
        let (a, b) = (p.fitted(), q.fitted());
        assert_eq!(bits(&a.points), bits(&b.points), "{name}");
        assert_eq!(bits(&a.reference), bits(&b.reference), "{name}");
        for (a, b) in a.warps.iter().zip(&b.warps) {
            assert_eq!(bits(a.places()), bits(b.places()), "{name}");
            assert_eq!(a.is_closed(), name == "cycle", "{name}");
        }
    }
}

#[test]
fn what_is_read_moves_alike() {
    let vocabulary = vocabulary();
    let back = read("v", &write(&vocabulary, "v").unwrap()).unwrap();
    for (p, q) in vocabulary.primitives().iter().zip(back.primitives()) {
        let name = p.name();
        assert_eq!(p.interpolator(), q.interpolator(), "{name}");
        for share in [0.0, 0.3, 1.1] {
            let at = vec![share; p.parameters().dims()];
            let courses = (p.at(&at).unwrap(), q.at(&at).unwrap());
            assert_eq!(
                courses.0.duration_secs().to_bits(),
                courses.1.duration_secs().to_bits(),
                "{name}"
            );
            for phase in [0.0, 0.37, 1.0] {
                let poses = (courses.0.pose(phase), courses.1.pose(phase));
                assert_eq!(bits(&poses.0), bits(&poses.1), "{name} at {share}, {phase}");
            }
        }
    }
    let (p, q) = (&vocabulary.primitives()[1], &back.primitives()[1]);
    let motion = &p.exemplars()[4].motion;
    let found = (p.parameters_of(motion), q.parameters_of(motion));
    assert_eq!(bits(&found.0.unwrap()), bits(&found.1.unwrap()));
}

#[test]
fn files_that_fit_no_body_are_refused() {
    let error = read("v", &example().write("v").unwrap()).unwrap_err();
    refused("coordinates", &error, Place::File, "3 coordinates");
    let mut stranger = example();
    stranger.meta.body = "atlas".to_string();
    let error = read("v", &stranger.write("v").unwrap()).unwrap_err();
    refused("body", &error, Place::File, "`atlas`");
}

#[test]
fn fits_that_are_no_primitive_are_refused() {
    type Damage = fn(&mut VocabularyFile);
    // The first primitive has five exemplars.
    let cases: &[(&str, Damage, &str)] = &[
        (
            "landmarks",
            |f| f.meta.landmarks = 1,
            "1 numbers of landmarks",
        ),
        ("warp back", |f| f.exemplars[0].warp[1] = 0.0, "warp"),
        ("warp short", |f| f.exemplars[0].warp.truncate(1), "warp"),
        (
            "warp end",
            |f| *f.exemplars[0].warp.last_mut().unwrap() = 0.9,
            "warp",
        ),
        (
            "part beyond the end",
            |f| f.meta.primitives[0].exemplars[2].used[1] += 1e3,
            "frames",
        ),
        (
            "part before the start",
            |f| f.meta.primitives[0].exemplars[2].used[0] = -1.0,
            "frames -1",
        ),
        (
            "no knots",
            |f| f.meta.primitives[0].fit.knots = 1,
            "1 knots",
        ),
        (
            "all the knots",
            |f| f.meta.primitives[0].fit.knots = u64::MAX,
            "knots",
        ),
        ("no reference", |f| f.fits[0].reference.clear(), "reference"),
        (
            "no range",
            |f| {
                let axis = &mut f.meta.primitives[0].fit.parameters[0];
                axis.high = axis.low;
            },
            "`height`",
        ),
        (
            "parameter twice",
            |f| f.meta.primitives[0].fit.parameters[1].name = "height".into(),
            "`height`",
        ),
        (
            "effector's coordinate",
            |f| {
                f.meta.primitives[2].fit.source = SourceMeta::Effector {
                    name: "right_hand".into(),
                    coordinates: vec![3; f.meta.primitives[2].fit.parameters.len()],
                }
            },
            "transform",
        ),
        (
            "shape of another body",
            |f| {
                let dims = f.meta.primitives[1].fit.parameters.len();
                let principal = f.fits[1].principal.as_mut().unwrap();
                principal.mean.truncate(1);
                principal.directions.truncate(dims);
            },
            "principal directions",
        ),
        (
            "power",
            |f| f.meta.primitives[2].fit.method = MethodMeta::Shepard { power: -1.0 },
            "power",
        ),
    ];
    let whole = whole();
    assert!(!whole.meta.primitives[1].fit.parameters.is_empty());
    for (what, damage, word) in cases {
        let mut file = whole.clone();
        damage(&mut file);
        let bytes = file.write("v").unwrap_or_else(|e| panic!("{what}: {e}"));
        match read("v", &bytes) {
            Ok(_) => panic!("{what}: read"),
            Err(error) => refused(what, &error, Place::File, word),
        }
    }
}

/// The whole file, made once.
fn whole() -> VocabularyFile {
    static FILE: OnceLock<VocabularyFile> = OnceLock::new();
    FILE.get_or_init(|| VocabularyFile::parse("v", &write(&vocabulary(), "v").unwrap()).unwrap())
        .clone()
}

/// Numbers that the checks of single numbers let pass.
const EXTREMES: [f64; 9] = [0.0, -0.0, 1.0, -1.0, 1e308, -1e308, 5e-324, 1e-160, 0.5];

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// A checksum keeps accidents out, not malice: numbers that make no sense are refused or moved by, without panic.
    #[test]
    fn extreme_numbers_are_read_or_refused(
        edits in prop::collection::vec(
            (0..8usize, any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..EXTREMES.len()),
            1..4,
        ),
    ) {
        let mut file = whole();
        for (what, which, at, value) in edits {
            let exemplar = which.index(file.exemplars.len());
            let primitive = which.index(file.fits.len());
            let fit = &mut file.meta.primitives[primitive].fit;
            let numbers = match what {
                0 => &mut file.exemplars[exemplar].poses,
                1 => {
                    file.exemplars[exemplar].root[0][at.index(4)] = EXTREMES[value];
                    continue;
                }
                2 => &mut file.exemplars[exemplar].warp,
                3 => &mut file.fits[primitive].points,
                4 => &mut file.fits[primitive].reference,
                5 => {
                    fit.method = MethodMeta::Shepard { power: EXTREMES[value] };
                    continue;
                }
                6 => {
                    fit.cyclic = !fit.cyclic;
                    continue;
                }
                _ => {
                    let exemplars = &mut file.meta.primitives[primitive].exemplars;
                    let used = &mut exemplars[0].used;
                    used[at.index(2)] = EXTREMES[value];
                    continue;
                }
            };
            if !numbers.is_empty() {
                let at = at.index(numbers.len());
                numbers[at] = EXTREMES[value];
            }
        }
        let Ok(bytes) = file.write("v") else {
            return Ok(());
        };
        if let Ok(vocabulary) = read("v", &bytes) {
            assert_eq!(write(&vocabulary, "v").unwrap(), bytes);
            for primitive in vocabulary.primitives() {
                let course = primitive.at(&primitive.middle());
                if let Ok(course) = course {
                    let _ = (course.pose(0.3), course.sample(1.0), course.duration_secs());
                    let _ = course.phase_at(0.1);
                }
                let _ = primitive.parameters_of(&primitive.exemplars()[0].motion);
            }
        }
    }
}
