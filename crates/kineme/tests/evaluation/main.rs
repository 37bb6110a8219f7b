//! Metrics over clips and streams, and the baselines beside which recognisers stand.

mod baselines;
mod clips;
mod paces;
mod routes;
mod streams;

use kineme::primitive::Interpolation;
use kineme::{Exemplar, Modelling, Motion, Primitive};

/// A primitive of these motions.
fn learned(name: &str, motions: impl Iterator<Item = Motion>) -> Primitive {
    let modelling = Modelling {
        interpolation: Interpolation::Shepard,
        ..Modelling::default()
    };
    let exemplars = motions
        .map(|motion| Exemplar::whole(motion, None))
        .collect();
    Primitive::learn(name, exemplars, &modelling).expect("a primitive")
}
