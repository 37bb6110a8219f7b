//! Metrics over clips and streams, and the baselines beside which recognisers stand.

mod baselines;
mod clips;
mod paces;
mod routes;
mod streams;

use kineme::primitive::Interpolation;
use kineme::{Exemplar, Modelling, Motion, Primitive, Provenance};

/// A primitive of these motions.
fn learned(name: &str, motions: impl Iterator<Item = Motion>) -> Primitive {
    let exemplar = |(k, motion): (usize, Motion)| Exemplar {
        provenance: Provenance {
            motion: format!("{name}-{k}"),
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
    let exemplars = motions.enumerate().map(exemplar).collect();
    Primitive::learn(name, exemplars, &modelling).expect("a primitive")
}
