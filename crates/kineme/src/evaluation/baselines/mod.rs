//! Recognisers that anything better must beat. They know no rest and nothing unknown, and say nothing of phase.

mod constant;
mod features;
mod nearest_dtw;
mod nearest_posture;
mod typical;
mod windows;

pub use constant::Constant;
pub use features::Features;
pub use nearest_dtw::{NearestDtw, NearestDtwSettings};
pub use nearest_posture::{NearestPosture, NearestPostureSettings};

use crate::error::{Error, Result};
use crate::primitive::{Observations, Posterior, Recognition, Span, Vocabulary};

/// An exemplar of a vocabulary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Which {
    primitive: usize,
    exemplar: usize,
}

/// The exemplars of a vocabulary, primitive by primitive.
fn exemplars(vocabulary: &Vocabulary) -> Vec<Which> {
    let primitives = vocabulary.primitives().iter().enumerate();
    primitives
        .flat_map(|(primitive, p)| {
            (0..p.exemplars().len()).map(move |exemplar| Which {
                primitive,
                exemplar,
            })
        })
        .collect()
}

/// Refuses a vocabulary without primitives: there is nothing to answer.
fn some_primitives(vocabulary: &Vocabulary) -> Result<()> {
    if vocabulary.primitives().is_empty() {
        return Err(Error::unsupported(
            "a vocabulary without primitives recognises nothing",
        ));
    }
    Ok(())
}

/// For each primitive the least of `distances`, one a thing that `of` a primitive is, and where it is.
fn least_of_each(
    primitives: usize,
    of: &[Which],
    distances: impl IntoIterator<Item = f64>,
) -> Vec<(f64, usize)> {
    let mut least = vec![(f64::INFINITY, 0); primitives];
    for (i, (which, d)) in of.iter().zip(distances).enumerate() {
        if d < least[which.primitive].0 {
            least[which.primitive] = (d, i);
        }
    }
    least
}

/// The softmax of minus `distances` over `temperature`.
fn softmax(distances: &[f64], temperature: f64) -> Posterior {
    let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let weights = distances.iter().map(|d| (-(d - least) / temperature).exp());
    let weights: Vec<f64> = weights.collect();
    let sum: f64 = weights.iter().sum();
    Posterior {
        primitives: weights.iter().map(|w| w / sum).collect(),
        rest: 0.0,
        none: 0.0,
    }
}

/// What is thought of a motion that is taken as one movement.
fn whole(
    seen: &Observations,
    posterior: Posterior,
    parameters: Vec<f64>,
    novelty: f64,
) -> Recognition {
    let primitive = posterior.best();
    Recognition {
        spans: vec![Span {
            start_secs: 0.0,
            end_secs: seen.motion().duration_secs(),
            primitive,
            confidence: primitive.map_or(0.0, |i| posterior.primitives[i]),
        }],
        posterior,
        parameters,
        novelty,
    }
}

/// Refuses settings that are not above 0.
fn positive(settings: &[(&str, f64)]) -> Result<()> {
    match settings.iter().find(|(_, v)| !(v.is_finite() && *v > 0.0)) {
        Some((name, v)) => Err(Error::invalid(format!("{name} must be above 0, found {v}"))),
        None => Ok(()),
    }
}
