//! What is answered when so much is believed of each state.

use super::place::{Spread, place};
use super::recogniser::Filter;
use super::track::Mass;
use crate::error::Result;
use crate::primitive::{Posterior, Reading};

impl Filter<'_> {
    /// What is thought when so much is believed of each state; where on the primitive, if the pose is given.
    pub(super) fn reading(&self, mass: &Mass, pose: Option<&[f64]>) -> Result<Reading> {
        let rows = &self.stream.rows;
        let mut primitives = vec![0.0; self.vocabulary.primitives().len()];
        let mut rest = mass.rest;
        for (r, row) in rows.iter().enumerate() {
            let own = &mass.states[self.network.starts[r]..self.network.starts[r + 1]];
            for (k, m) in own.iter().enumerate() {
                let resting = row.rests(k) * m;
                rest += resting;
                primitives[row.primitive] += m - resting;
            }
        }
        // Sums of many probabilities are one but for rounding.
        let all = primitives.iter().sum::<f64>() + rest + mass.none;
        for p in &mut primitives {
            *p /= all;
        }
        let posterior = Posterior {
            primitives,
            rest: rest / all,
            none: mass.none / all,
        };
        let place = match (posterior.leading().filter(|(_, p)| *p > 0.0), pose) {
            (Some((leading, _)), Some(pose)) => {
                let spread = Spread::of(rows, &self.network.starts, &mass.states, leading);
                let primitive = &self.vocabulary.primitives()[leading];
                spread
                    .map(|s| place(primitive, leading, &s, pose))
                    .transpose()?
            }
            _ => None,
        };
        Ok(Reading {
            novelty: 2.0 * posterior.none,
            posterior,
            place,
        })
    }
}
