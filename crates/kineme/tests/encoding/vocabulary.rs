//! Four movements made by hand on Adonis, each at four heights.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use kineme::choreography::{Key, perform};
use kineme::perception::encoding::{EffectorPaths, EncodingSettings};
use kineme::{
    Exemplar, Modelling, Motion, Primitive, Role, Skeleton, Transitions, Vocabulary, adonis,
};
use nalgebra::Vector3;

use Role::{LeftLowerArm, LeftUpperArm, RightLowerArm, RightUpperArm};

fn key(time: f64, angles: &[(Role, &[f64])]) -> Key {
    Key {
        time,
        angles: angles
            .iter()
            .map(|(r, a)| (*r, a.to_vec()))
            .collect::<BTreeMap<_, _>>(),
    }
}

pub const NAMES: [&str; 4] = ["reach", "raise", "hook", "spread"];

/// The keys of a movement at a height in [0, 1].
pub fn keys(name: &str, height: f64) -> Vec<Key> {
    let rest: [(Role, &[f64]); 4] = [
        (RightUpperArm, &[10.0, 8.0, 0.0]),
        (RightLowerArm, &[40.0]),
        (LeftUpperArm, &[10.0, 8.0, 0.0]),
        (LeftLowerArm, &[40.0]),
    ];
    let (upper, lower) = (60.0 + 40.0 * height, 30.0 + 60.0 * height);
    let middle: Vec<(Role, Vec<f64>)> = match name {
        "reach" => vec![
            (RightUpperArm, vec![upper, 5.0, 0.0]),
            (RightLowerArm, vec![5.0]),
        ],
        "raise" => vec![
            (LeftUpperArm, vec![20.0, upper, 0.0]),
            (LeftLowerArm, vec![10.0]),
        ],
        "hook" => vec![
            (RightUpperArm, vec![40.0, lower, 40.0]),
            (RightLowerArm, vec![110.0]),
        ],
        _ => vec![
            (RightUpperArm, vec![20.0, lower, 0.0]),
            (LeftUpperArm, vec![20.0, lower, 0.0]),
            (RightLowerArm, vec![15.0]),
            (LeftLowerArm, vec![15.0]),
        ],
    };
    let middle: Vec<(Role, &[f64])> = middle.iter().map(|(r, a)| (*r, a.as_slice())).collect();
    vec![key(0.0, &rest), key(0.6, &middle), key(1.3, &rest)]
}

pub fn body() -> &'static Arc<Skeleton> {
    static BODY: OnceLock<Arc<Skeleton>> = OnceLock::new();
    BODY.get_or_init(|| Arc::new(adonis().expect("a body")))
}

/// A movement at a height.
pub fn made(name: &str, height: f64) -> Motion {
    perform(name, &keys(name, height), body(), 60.0).expect("a motion")
}

/// The vocabulary of these movements, in this order.
pub fn vocabulary_of(names: &[&str]) -> Vocabulary {
    let primitives: Vec<Primitive> = names
        .iter()
        .map(|name| {
            let exemplars = [0.0, 0.3, 0.7, 1.0]
                .map(|height| Exemplar::whole(made(name, height), Some(vec![height])));
            Primitive::learn(name, exemplars.into(), &Modelling::default()).expect("a primitive")
        })
        .collect();
    let none = Transitions::none(primitives.len());
    Vocabulary::new(Arc::clone(body()), primitives, Vec::new(), none).expect("a vocabulary")
}

pub fn vocabulary() -> &'static Vocabulary {
    static VOCABULARY: OnceLock<Vocabulary> = OnceLock::new();
    VOCABULARY.get_or_init(|| vocabulary_of(&NAMES))
}

/// The paths of a motion's hands.
pub fn paths(motion: &Motion) -> EffectorPaths {
    let s = EncodingSettings::default();
    EffectorPaths::of_motion(motion, &s.effectors, s.heading_secs).expect("paths")
}

/// The same paths with every point changed.
pub fn changed(
    paths: &EffectorPaths,
    change: impl Fn(usize, usize, Vector3<f64>) -> Option<Vector3<f64>>,
) -> EffectorPaths {
    let points = (0..paths.frames()).flat_map(|f| {
        let change = &change;
        let points = paths.at(f).iter().enumerate();
        points
            .map(move |(e, p)| change(f, e, (*p)?))
            .collect::<Vec<_>>()
    });
    EffectorPaths::new(
        paths.rate_hz(),
        paths.effectors().to_vec(),
        points.collect(),
    )
    .expect("paths")
}

/// One motion after the other.
pub fn joined(motions: &[Motion]) -> Motion {
    let poses = motions.iter().flat_map(|m| m.poses().to_vec()).collect();
    let roots = motions.iter().flat_map(|m| m.roots().to_vec()).collect();
    Motion::new("joined", Arc::clone(body()), 60.0, poses, roots).expect("a motion")
}
