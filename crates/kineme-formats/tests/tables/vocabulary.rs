use kineme_formats::Place;
use kineme_formats::vocabulary::{
    BehaviorMeta, ExemplarFrames, ExemplarMeta, PrimitiveMeta, TransitionMeta, VocabularyFile,
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
    }
}

fn frames(n: usize, seed: f64) -> ExemplarFrames {
    ExemplarFrames {
        poses: (0..3 * n).map(|i| (seed + i as f64).sin()).collect(),
        root: (0..n)
            .map(|i| [i as f64 / 3.0, -0.0, 0.95, 1e-300])
            .collect(),
    }
}

/// Two primitives with three exemplars of a body with three coordinates.
pub fn example() -> VocabularyFile {
    let primitive = |name: &str, coherence, exemplars| PrimitiveMeta {
        name: name.to_string(),
        members: 7,
        coherence,
        exemplars,
    };
    let unknown_source = ExemplarMeta {
        blake3: None,
        ..exemplar("b.bvh", 0.1)
    };
    VocabularyFile {
        meta: VocabularyMeta {
            program: "kineme 0.1.0".to_string(),
            body: "ares".to_string(),
            coordinates: ["neck_x", "neck_y", "left_elbow"]
                .map(String::from)
                .to_vec(),
            primitives: vec![
                primitive(
                    "group-01",
                    Some(0.1 + 0.7),
                    vec![
                        exemplar("set.zip/a.bvh", 0.0),
                        exemplar("set.zip/a.bvh", 1.0 / 3.0),
                    ],
                ),
                primitive("wave / \"out\"", None, vec![unknown_source]),
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
        },
        exemplars: vec![frames(4, 0.0), frames(1, 0.5), frames(2, 7.0)],
    }
}

#[test]
fn a_vocabulary_survives_bit_for_bit() {
    let file = example();
    let bytes = file.write("v.kineme").unwrap();
    let back = VocabularyFile::parse("v.kineme", &bytes).unwrap();
    assert_eq!(back, file);
    assert!(back.exemplars[0].root[0][1].is_sign_negative());
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
            |v| v.exemplars[1] = frames(0, 0.0),
            "exemplar 1 with 0 numbers",
        ),
        (
            "not finite",
            |v| v.exemplars[2].root[0][3] = f64::NAN,
            "exemplar 2",
        ),
        (
            "coherence",
            |v| v.meta.primitives[0].coherence = Some(f64::NAN),
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
    let bytes = example().write("v.kineme").unwrap();
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
fn damaged_files_are_refused() {
    let good = example().write("v.kineme").unwrap();
    let mut flipped = good.clone();
    *flipped.last_mut().unwrap() ^= 1;
    let mut huge = good.clone();
    huge[6] = 0xff;
    let cases: &[(&str, Vec<u8>, &str)] = &[
        ("empty", Vec::new(), "header"),
        ("cut", good[..good.len() - 1].to_vec(), "incomplete"),
        ("cut header", good[..40].to_vec(), "header"),
        ("huge header", huge, "header"),
        ("longer", [good.as_slice(), b"x"].concat(), "incomplete"),
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
            rewritten("\\\"version\\\":1", "\\\"version\\\":2"),
            "format version 2",
        ),
        ("no version", rewritten("\\\"version\\\":1,", ""), "version"),
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

/// Two primitives of Adonis with numbers that rounding would show.
fn vocabulary() -> kineme::Vocabulary {
    use kineme::{Behavior, Exemplar, Motion, Primitive, Provenance, Root, Transitions};

    let body = std::sync::Arc::new(kineme::adonis().unwrap());
    let exemplar = |name: &str, frames: usize| {
        let roots = (0..frames).map(|f| Root {
            position: [f as f64 / 3.0, -0.0, 1e-300].into(),
            yaw: 7.0 / 9.0,
        });
        let poses = (0..20 * frames).map(|i| (i as f64).sin()).collect();
        let body = std::sync::Arc::clone(&body);
        Exemplar {
            motion: Motion::new(name, body, 1.0 / 0.0333333, poses, roots.collect()).unwrap(),
            provenance: Provenance {
                motion: name.to_string(),
                start_secs: 0.1,
                end_secs: 0.1 + 0.2,
                blake3: (frames > 1).then(|| "0f".repeat(32)),
            },
        }
    };
    let primitive = |name: &str, coherence, exemplars: Vec<Exemplar>| Primitive {
        name: name.to_string(),
        members: exemplars.len() + 3,
        exemplars,
        coherence,
    };
    let (out, back) = ("out", "back");
    kineme::Vocabulary::new(
        std::sync::Arc::clone(&body),
        vec![
            primitive(
                out,
                Some(0.1 + 0.7),
                vec![exemplar("a.bvh", 4), exemplar("b.bvh", 1)],
            ),
            primitive(back, None, vec![exemplar("set.zip/a.bvh", 2)]),
        ],
        vec![Behavior {
            name: "wave".to_string(),
            primitives: vec![out.to_string(), back.to_string()],
        }],
        Transitions {
            counts: vec![0, 5, 2, u32::MAX],
            n: 2,
        },
    )
    .unwrap()
}

#[test]
fn the_librarys_vocabulary_comes_back_bit_for_bit() {
    let vocabulary = vocabulary();
    let bytes = kineme_formats::vocabulary::write(&vocabulary, "v").unwrap();
    let back = kineme_formats::vocabulary::read("v", &bytes).unwrap();
    assert_eq!(back, vocabulary);
    let bits = |v: &kineme::Vocabulary| -> Vec<u64> {
        let motions = v.primitives().iter().flat_map(|p| &p.exemplars);
        motions
            .flat_map(|e| {
                e.motion
                    .poses()
                    .iter()
                    .chain(e.motion.root(0).position.iter())
            })
            .map(|x| x.to_bits())
            .collect()
    };
    assert_eq!(bits(&back), bits(&vocabulary));
    assert_eq!(
        kineme_formats::vocabulary::write(&back, "v").unwrap(),
        bytes
    );
}

#[test]
fn vocabularies_of_unknown_bodies_are_refused() {
    let error = kineme_formats::vocabulary::read("v", &example().write("v").unwrap());
    refused(
        "coordinates",
        &error.unwrap_err(),
        Place::File,
        "3 coordinates",
    );
    let mut stranger = example();
    stranger.meta.body = "atlas".to_string();
    let error = kineme_formats::vocabulary::read("v", &stranger.write("v").unwrap());
    refused("body", &error.unwrap_err(), Place::File, "`atlas`");
}
