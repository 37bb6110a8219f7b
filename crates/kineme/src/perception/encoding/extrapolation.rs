//! Extrapolation: predictors that know no primitive. A primitive that predicts no better than they do knows nothing of
//! the movement.

use nalgebra::Vector3;

use super::cost::{Block, Instants};
use super::settings::{EncodingSettings, SAMPLES};

/// The mean cost of the best extrapolation of each block, in units of `unit_m`: the posture is held, goes on at its
/// velocity, or comes to rest within the horizon with the least jerk (Flash and Hogan 1985).
pub(super) fn background(
    instants: &Instants,
    blocks: &[Block],
    unit_m: f64,
    s: &EncodingSettings,
) -> f64 {
    weighted_mean(blocks, |b, block| {
        let first = b * SAMPLES;
        let start = |e: usize| instants[first][e].unwrap_or_default();
        let velocity = |e: usize| -> Vector3<f64> {
            let before = first.checked_sub(1).and_then(|f| instants[f][e]);
            let here = instants[first][e];
            before.zip(here).map_or(Vector3::zeros(), |(a, b)| b - a)
        };
        let horizon = s.horizon() as f64;
        let held = block.cost(unit_m, s, |e, _| start(e));
        let straight = block.cost(unit_m, s, |e, k| start(e) + k as f64 * velocity(e));
        let stopping = block.cost(unit_m, s, |e, k| {
            start(e) + horizon * stopped((k as f64 / horizon).min(1.0)) * velocity(e)
        });
        held.min(straight).min(stopping)
    })
}

/// The mean cost of predicting that each block ends where it begins, in units of `unit_m`.
pub(super) fn held(
    instants: &Instants,
    blocks: &[Block],
    unit_m: f64,
    s: &EncodingSettings,
) -> f64 {
    weighted_mean(blocks, |b, block| {
        block.cost(unit_m, s, |e, _| {
            instants[b * SAMPLES][e].unwrap_or_default()
        })
    })
}

/// The mean of what each block (and its index) costs, by the blocks' weights.
fn weighted_mean(blocks: &[Block], cost: impl Fn(usize, &Block) -> f64) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (b, block) in blocks.iter().enumerate() {
        sum += block.weight * cost(b, block);
        all += block.weight;
    }
    sum / all.max(1e-9)
}

/// How far one comes, at unit speed, whose velocity dies down as 1 - 10 u^3 + 15 u^4 - 6 u^5.
fn stopped(u: f64) -> f64 {
    let u4 = u.powi(4);
    u - 2.5 * u4 + 3.0 * u4 * u - u4 * u * u
}
