//! Whole clips of people are told by their chains and by their outlines, streams by chains alone.

use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::perception::encoding::{EffectorPaths, Encoder, EncodingSettings, Extent};
use kineme::{Exemplar, Modelling, Motion, Primitive, Transitions, Vocabulary};

use crate::vocabulary::{body, changed, keys, paths};

/// A reach out and back of 2 s, whose far point is at a share of it.
fn reach(height: f64, share: f64) -> Motion {
    let [first, middle, last]: [Key; 3] = keys("reach", height).try_into().expect("keys");
    let at = |time: f64, key: Key| Key { time, ..key };
    let keys = [at(0.0, first), at(2.0 * share, middle), at(2.0, last)];
    perform("reach", &keys, body(), 60.0).expect("a motion")
}

/// Who reaches quickly and draws back slowly, and who does it the other way round: at heights that are told, or by people
/// of whom nothing is told.
fn vocabulary(told: bool) -> Vocabulary {
    let primitive = |name: &str, share: f64| {
        let exemplar = |height: f64| {
            let told = told.then(|| vec![height]);
            Exemplar::whole(reach(height, share), told)
        };
        let exemplars = [0.0, 0.3, 0.7, 1.0].map(exemplar).into();
        Primitive::learn(name, exemplars, &Modelling::default()).expect("a primitive")
    };
    let primitives = vec![primitive("quick", 0.35), primitive("slow", 0.65)];
    let none = Transitions::none(primitives.len());
    Vocabulary::new(Arc::clone(body()), primitives, Vec::new(), none).expect("a vocabulary")
}

/// What the slow primitive costs beyond the quick one.
fn ahead(told: bool, extent: Extent, seen: &EffectorPaths) -> f64 {
    let vocabulary = vocabulary(told);
    let settings = EncodingSettings {
        extent,
        ..EncodingSettings::default()
    };
    let encoder = Encoder::new(&vocabulary, &settings).expect("an encoder");
    let scores = encoder.encode("seen", seen).expect("an encoding").scores;
    (scores[0] / scores[1]).ln()
}

#[test]
fn when_hands_move_tells_clips_apart_that_paces_make_alike() {
    let quick = paths(&reach(0.5, 0.35));
    let (alone, with) = (
        ahead(true, Extent::Clip, &quick),
        ahead(false, Extent::Clip, &quick),
    );
    assert!(
        with > alone + 0.005,
        "{with} with outlines, {alone} without"
    );
    let (alone, with) = (
        ahead(true, Extent::Stream, &quick),
        ahead(false, Extent::Stream, &quick),
    );
    assert!((with - alone).abs() < 1e-9, "a stream: {with} and {alone}");
}

#[test]
fn a_hand_that_is_hidden_now_and_then_leaves_an_outline_and_one_that_is_not_seen_does_not() {
    let quick = paths(&reach(0.5, 0.35));
    let every = |n: usize| changed(&quick, |f, e, p| (e == 0 || f % n == 0).then_some(p));
    let of =
        |seen: &EffectorPaths| ahead(false, Extent::Clip, seen) - ahead(true, Extent::Clip, seen);
    let (whole, hidden) = (
        of(&quick),
        of(&changed(&quick, |f, e, p| {
            (e == 0 || f % 3 > 0).then_some(p)
        })),
    );
    assert!((whole - hidden).abs() < 0.3 * whole, "{hidden} for {whole}");
    assert!(of(&every(3)).abs() < 1e-9, "{}", of(&every(3)));
}
