use kineme_formats::Place;
use kineme_formats::vocabulary::{
    BehaviorMeta, CalibratedMeta, CalibrationMeta, ErrorMeta, ExemplarMeta, ExemplarTensors,
    FitMeta, FitTensors, GroupMeta, KernelMeta, MethodMeta, ParameterMeta, PrimitiveMeta,
    PrincipalTensors, SourceMeta, TailMeta, TransitionMeta, TrialMeta, VocabularyFile,
    VocabularyMeta,
};

use crate::refused;

fn exemplar(motion: &str, start: f64) -> ExemplarMeta {
    ExemplarMeta {
        motion: motion.to_string(),
        start_secs: start,
        end_secs: start + 0.7,
        rate_hz: 60.0,
        blake3: Some("0af1".repeat(16)),
        adverbs: Some(vec![0.1 + 0.2, -0.0]),
        used: [0.0, 4.0 / 3.0],
        shift: 0.25,
    }
}

fn movement(n: usize, seed: f64) -> ExemplarTensors {
    ExemplarTensors {
        poses: (0..3 * n).map(|i| (seed + i as f64).sin()).collect(),
        root: (0..n)
            .map(|i| [i as f64 / 3.0, -0.0, 0.95, 1e-300])
            .collect(),
        warp: vec![0.0, 1.0 / 3.0, 1.0],
    }
}

fn fit(source: SourceMeta, parameters: &[&str]) -> FitMeta {
    let method = MethodMeta::Cardinal {
        kernel: KernelMeta::Wendland { support: 0.1 + 0.7 },
        tail: TailMeta::LeastSquares,
        nugget: 1e-3,
    };
    FitMeta {
        cyclic: false,
        knots: 64,
        parameters: parameters
            .iter()
            .map(|name| ParameterMeta {
                name: name.to_string(),
                low: -1.0 / 7.0,
                high: 2.0,
            })
            .collect(),
        source,
        method,
        trials: vec![TrialMeta {
            method,
            parameters: 2,
            error_m: 0.1 + 0.2,
        }],
        error: Some(ErrorMeta {
            joint_rad: 0.1,
            wrist_m: 0.2,
            nearest_m: 0.3,
            mean_m: 1e-300,
        }),
        notes: vec!["\"so\"".to_string()],
    }
}

/// So many numbers of each primitive of the example.
fn calibration(recogniser: &str, numbers: usize) -> CalibrationMeta {
    let calibrated = |name: &str| CalibratedMeta {
        name: name.to_string(),
        numbers: [0.1 + 0.2, -0.0, 1e-300][..numbers].to_vec(),
    };
    CalibrationMeta {
        recogniser: recogniser.to_string(),
        primitives: ["group-01", "wave / \"out\""].map(calibrated).to_vec(),
        shared: vec![1.0 / 3.0, -0.0],
    }
}

/// Two primitives with three exemplars of a body with three coordinates: one of two adverbs, one of no parameters.
pub fn example() -> VocabularyFile {
    let primitive = |name: &str, group, fit, exemplars| PrimitiveMeta {
        name: name.to_string(),
        group,
        fit,
        exemplars,
    };
    let group = GroupMeta {
        members: 7,
        coherence: Some(0.1 + 0.7),
    };
    let unknown_source = ExemplarMeta {
        blake3: None,
        adverbs: None,
        ..exemplar("b.bvh", 0.1)
    };
    let tensors = |points: &[f64], principal| FitTensors {
        points: points.to_vec(),
        reference: vec![0.5, -0.0, 1.0 / 3.0, 2.0],
        principal,
    };
    VocabularyFile {
        meta: VocabularyMeta {
            program: "kineme 0.1.0".to_string(),
            body: "ares".to_string(),
            coordinates: ["neck_x", "neck_y", "left_elbow"]
                .map(String::from)
                .to_vec(),
            landmarks: 2,
            primitives: vec![
                primitive(
                    "group-01",
                    Some(group),
                    fit(SourceMeta::Adverbs, &["height", "side"]),
                    vec![
                        exemplar("set.zip/a.bvh", 0.0),
                        exemplar("set.zip/a.bvh", 1.0 / 3.0),
                    ],
                ),
                primitive(
                    "wave / \"out\"",
                    None,
                    FitMeta {
                        method: MethodMeta::Shepard { power: 2.0 },
                        error: None,
                        ..fit(SourceMeta::Principal, &[])
                    },
                    vec![unknown_source],
                ),
            ],
            behaviors: vec![BehaviorMeta {
                name: "behavior-01".to_string(),
                groups: vec!["group-01".to_string(), "wave / \"out\"".to_string()],
            }],
            transitions: vec![TransitionMeta {
                from: "group-01".to_string(),
                to: "wave / \"out\"".to_string(),
                count: 4,
            }],
            calibrations: vec![calibration("filter", 2), calibration("voter", 0)],
        },
        exemplars: vec![movement(4, 0.0), movement(1, 0.5), movement(2, 7.0)],
        fits: vec![
            tensors(&[0.0, 1.0, 1.0 / 3.0, -0.0], None),
            tensors(
                &[],
                Some(PrincipalTensors {
                    mean: vec![1.0, 2.0, 3.0],
                    directions: Vec::new(),
                }),
            ),
        ],
    }
}

#[test]
fn a_vocabulary_survives_bit_for_bit() {
    let file = example();
    let bytes = file.write("v.kineme").unwrap();
    let back = VocabularyFile::parse("v.kineme", &bytes).unwrap();
    assert_eq!(back, file);
    assert!(back.exemplars[0].root[0][1].is_sign_negative());
    assert!(back.fits[0].points[3].is_sign_negative());
    let adverbs = back.meta.primitives[0].exemplars[0].adverbs.as_ref();
    assert!(adverbs.unwrap()[1].is_sign_negative());
    assert!(back.meta.calibrations[0].primitives[1].numbers[1].is_sign_negative());
    assert_eq!(back.write("v.kineme").unwrap(), bytes);
    assert_eq!(file.write("other").unwrap(), bytes);
}

#[test]
fn invalid_vocabularies_are_not_written() {
    type Damage = fn(&mut VocabularyFile);
    let cases: &[(&str, Damage, &str)] = &[
        ("no body", |v| v.meta.body.clear(), "the body"),
        (
            "no coordinate",
            |v| v.meta.coordinates.clear(),
            "no coordinates",
        ),
        (
            "coordinate twice",
            |v| v.meta.coordinates[1] = "neck_x".to_string(),
            "`neck_x` twice",
        ),
        (
            "coordinate lost",
            |v| drop(v.meta.coordinates.pop()),
            "12 numbers for 4 frames",
        ),
        (
            "no primitive",
            |v| v.meta.primitives.clear(),
            "no primitives",
        ),
        (
            "name twice",
            |v| v.meta.primitives[1].name = "group-01".to_string(),
            "`group-01` twice",
        ),
        (
            "no exemplar",
            |v| v.meta.primitives[1].exemplars.clear(),
            "no exemplar",
        ),
        (
            "exemplar lost",
            |v| drop(v.exemplars.pop()),
            "movements of 2",
        ),
        (
            "no frame",
            |v| v.exemplars[1] = movement(0, 0.0),
            "exemplar 1 with 0 numbers",
        ),
        (
            "not finite",
            |v| v.exemplars[2].root[0][3] = f64::NAN,
            "exemplar 2",
        ),
        (
            "coherence",
            |v| v.meta.primitives[0].group.as_mut().unwrap().coherence = Some(f64::NAN),
            "coherence",
        ),
        (
            "span",
            |v| v.meta.primitives[0].exemplars[1].end_secs = 0.0,
            "span",
        ),
        (
            "rate",
            |v| v.meta.primitives[0].exemplars[1].rate_hz = 0.0,
            "0 Hz",
        ),
        (
            "motion",
            |v| v.meta.primitives[0].exemplars[1].motion.clear(),
            "a source motion",
        ),
        (
            "hash",
            |v| v.meta.primitives[0].exemplars[1].blake3 = Some("AB".to_string()),
            "blake3",
        ),
        ("no landmarks", |v| v.meta.landmarks = 0, "no landmarks"),
        ("fit lost", |v| drop(v.fits.pop()), "fits of 1"),
        (
            "warp not finite",
            |v| v.exemplars[0].warp[1] = f64::NAN,
            "exemplar 0",
        ),
        (
            "part used",
            |v| v.meta.primitives[0].exemplars[0].used[1] = f64::INFINITY,
            "frames 0 to inf",
        ),
        (
            "no part",
            |v| v.meta.primitives[0].exemplars[0].used[1] = 0.5,
            "frames 0 to 0.5",
        ),
        (
            "adverb",
            |v| v.meta.primitives[0].exemplars[0].adverbs = Some(vec![f64::NAN]),
            "adverbs",
        ),
        (
            "parameter",
            |v| v.meta.primitives[0].fit.parameters[1].high = f64::INFINITY,
            "parameters",
        ),
        (
            "parameter lost",
            |v| drop(v.meta.primitives[0].fit.parameters.pop()),
            "4 parameters of primitive `group-01`",
        ),
        (
            "point",
            |v| v.fits[0].points[0] = f64::NAN,
            "parameters of primitive",
        ),
        (
            "reference cut",
            |v| v.fits[0].reference.truncate(3),
            "3 reference numbers",
        ),
        (
            "reference",
            |v| v.fits[1].reference[0] = f64::NAN,
            "reference of primitive",
        ),
        (
            "method",
            |v| v.meta.primitives[1].fit.method = MethodMeta::Shepard { power: f64::NAN },
            "method",
        ),
        (
            "trial",
            |v| v.meta.primitives[0].fit.trials[0].error_m = f64::INFINITY,
            "trials",
        ),
        (
            "error",
            |v| v.meta.primitives[0].fit.error.as_mut().unwrap().wrist_m = f64::NAN,
            "error",
        ),
        (
            "no transform",
            |v| v.fits[1].principal = None,
            "no transform",
        ),
        (
            "a transform",
            |v| v.meta.primitives[1].fit.source = SourceMeta::Adverbs,
            "a transform",
        ),
        (
            "direction",
            |v| v.fits[1].principal.as_mut().unwrap().directions.push(1.0),
            "1 direction numbers",
        ),
        (
            "mean",
            |v| v.fits[1].principal.as_mut().unwrap().mean[0] = f64::NAN,
            "principal coordinates",
        ),
        (
            "group",
            |v| v.meta.behaviors[0].groups[0] = "x".to_string(),
            "`x` in behavior",
        ),
        (
            "group twice",
            |v| {
                let again = BehaviorMeta {
                    name: "behavior-02".to_string(),
                    ..v.meta.behaviors[0].clone()
                };
                v.meta.behaviors.push(again);
            },
            "`group-01` twice",
        ),
        (
            "transition",
            |v| v.meta.transitions[0].to = "x".to_string(),
            "from `group-01` to `x`",
        ),
        (
            "transition never seen",
            |v| v.meta.transitions[0].count = 0,
            "0 times",
        ),
        (
            "transition twice",
            |v| v.meta.transitions.extend_from_within(..),
            "4 times",
        ),
        (
            "recogniser without a name",
            |v| v.meta.calibrations[0].recogniser.clear(),
            "calibrated recognisers without a name",
        ),
        (
            "recogniser twice",
            |v| v.meta.calibrations.extend_from_within(..1),
            "`filter` twice",
        ),
        (
            "calibration of a stranger",
            |v| v.meta.calibrations[0].primitives[1].name = "x".to_string(),
            "other primitives in the calibration of `filter`",
        ),
        (
            "calibration in another order",
            |v| v.meta.calibrations[1].primitives.reverse(),
            "other primitives in the calibration of `voter`",
        ),
        (
            "calibration of some",
            |v| drop(v.meta.calibrations[0].primitives.pop()),
            "other primitives",
        ),
        (
            "calibration of one twice",
            |v| v.meta.calibrations[0].primitives.extend_from_within(1..),
            "other primitives",
        ),
        (
            "calibration of unequal numbers",
            |v| v.meta.calibrations[0].primitives[1].numbers.truncate(1),
            "unequal numbers",
        ),
        (
            "calibration that is not finite",
            |v| v.meta.calibrations[0].primitives[1].numbers[0] = f64::NAN,
            "calibration of `filter` with a number that is not finite",
        ),
        (
            "shared number that is not finite",
            |v| v.meta.calibrations[1].shared[0] = f64::INFINITY,
            "calibration of `voter` with a number that is not finite",
        ),
    ];
    for (what, damage, word) in cases {
        let mut file = example();
        damage(&mut file);
        refused(
            what,
            &file.write("v.kineme").unwrap_err(),
            Place::File,
            word,
        );
    }
}

/// The container with its header rewritten.
fn rewritten(from: &str, to: &str) -> Vec<u8> {
    rewritten_of(&example().write("v.kineme").unwrap(), from, to)
}

fn rewritten_of(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let length = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    let header = std::str::from_utf8(&bytes[8..8 + length]).unwrap();
    assert!(header.contains(from), "{from} in {header}");
    let header = header.replacen(from, to, 1);
    let mut out = (header.len() as u64).to_le_bytes().to_vec();
    out.extend_from_slice(header.as_bytes());
    out.extend_from_slice(&bytes[8 + length..]);
    out
}

#[test]
fn a_file_of_version_2_has_no_calibrations() {
    let mut uncalibrated = example();
    uncalibrated.meta.calibrations.clear();
    let bytes = uncalibrated.write("v.kineme").unwrap();
    let bytes = rewritten_of(&bytes, ",\\\"calibrations\\\":[]", "");
    let old = rewritten_of(&bytes, "\\\"version\\\":3", "\\\"version\\\":2");
    let back = VocabularyFile::parse("v.kineme", &old).unwrap();
    assert_eq!(back, uncalibrated);
}

#[test]
fn damaged_files_are_refused() {
    let good = example().write("v.kineme").unwrap();
    let mut flipped = good.clone();
    *flipped.last_mut().unwrap() ^= 1;
    let mut huge = good.clone();
    huge[6] = 0xff;
    let cases: &[(&str, Vec<u8>, &str)] = &[
        ("empty", Vec::new(), "an empty file"),
        ("cut", good[..good.len() - 1].to_vec(), "another length"),
        ("cut header", good[..40].to_vec(), "cut off"),
        ("huge header", huge, "another kind of file"),
        ("longer", [good.as_slice(), b"x"].concat(), "another length"),
        ("one bit", flipped, "BLAKE3"),
        (
            "no JSON",
            rewritten("__metadata__", "__metadata\u{1}"),
            "JSON",
        ),
        (
            "no document",
            rewritten("\"kineme\":", "\"kinema\":"),
            "no document",
        ),
        (
            "newer",
            rewritten("\\\"version\\\":3", "\\\"version\\\":4"),
            "format version 4",
        ),
        (
            "older",
            rewritten("\\\"version\\\":3", "\\\"version\\\":1"),
            "format version 1",
        ),
        ("no version", rewritten("\\\"version\\\":3,", ""), "version"),
        ("degrees", rewritten("\\\"rad\\\"", "\\\"deg\\\""), "units"),
        (
            "new field",
            rewritten("\\\"body\\\"", "\\\"bdy\\\""),
            "unknown field `bdy`",
        ),
        (
            "tensor name",
            rewritten("exemplar-000001/root", "exemplar-000009/root"),
            "no tensor",
        ),
        (
            "fit's tensor name",
            rewritten("primitive-000001/mean", "primitive-000001/moan"),
            "no tensor",
        ),
        (
            "method",
            rewritten("\\\"shepard\\\"", "\\\"sheperd\\\""),
            "unknown variant `sheperd`",
        ),
        (
            "parameters without points",
            rewritten(
                "points\":{\"dtype\":\"F64\",\"shape\":[2,2]",
                "points\":{\"dtype\":\"F64\",\"shape\":[4,1]",
            ),
            "F64 [4, 1]",
        ),
        (
            "transform without tensors",
            rewritten("\\\"adverbs\\\",", "\\\"principal\\\","),
            "15 tensors",
        ),
        (
            "rank",
            rewritten("\"shape\":[3]", "\"shape\":[3,1]"),
            "F64 [3, 1]",
        ),
        ("shape", rewritten("[4,3]", "[3,4]"), "F64 [3, 4]"),
        ("type", rewritten("F64", "I64"), "I64"),
        (
            "overflow",
            rewritten("[4,3]", "[9223372036854775807,3]"),
            "overflow",
        ),
        ("coordinate", rewritten("\\\"neck_y\\\",", ""), "F64 [4, 3]"),
        (
            "primitive",
            rewritten("group-01", "group-02"),
            "`group-01` in behavior",
        ),
        (
            "calibration's field",
            rewritten("\\\"recogniser\\\"", "\\\"recognizer\\\""),
            "unknown field `recognizer`",
        ),
        (
            "calibration of no number",
            rewritten("\\\"shared\\\":[0.3", "\\\"shared\\\":[null,0.3"),
            "null",
        ),
        (
            "infinite",
            rewritten("60.0", "1e999"),
            "number out of range",
        ),
    ];
    for (what, bytes, word) in cases {
        let error = VocabularyFile::parse("v.kineme", bytes).expect_err(what);
        refused(what, &error, Place::File, word);
    }
}
