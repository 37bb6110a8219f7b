//! The warps of a group, brought to a common clock that is nobody's: the identity is their mean.

use rayon::prelude::*;

use super::smooth::{SLOPE_FLOOR, floored};
use super::warp::{Warp, uniform};
use crate::error::Result;

/// Warps followed by the inverse of their mean, so that at each knot the mean of the places is the phase, with the
/// floor under their slopes kept.
pub(super) fn centred(warps: &[Warp], closed: bool) -> Result<Vec<Warp>> {
    let mut warps = recentred(warps, closed)?;
    let lacking = |warps: &[Warp]| SLOPE_FLOOR - warps.iter().map(least_slope).fold(1.0, f64::min);
    // Raising one warp to the floor moves the mean by its share; a few turns bring both together.
    for _ in 0..8 {
        if lacking(&warps) <= 0.0 {
            break;
        }
        let floored: Vec<Warp> = warps
            .iter()
            .map(|w| floored(w.places(), closed))
            .collect::<Result<_>>()?;
        warps = recentred(&floored, closed)?;
    }
    let lack = lacking(&warps);
    if lack <= 0.0 {
        return Ok(warps);
    }
    // What is left over goes by a touch of the identity, which does not move the mean.
    let touch = lack / (1.0 - SLOPE_FLOOR + lack);
    let even = uniform(warps[0].places().len());
    let blend = |(p, e): (&f64, &f64)| p + touch * (e - p);
    warps
        .iter()
        .map(|w| Warp::through(w.places().iter().zip(&even).map(blend).collect(), closed))
        .collect()
}

/// The least slope of a warp between two knots.
fn least_slope(warp: &Warp) -> f64 {
    let spans = (warp.places().len() - 1) as f64;
    let steps = warp.places().windows(2).map(|w| (w[1] - w[0]) * spans);
    steps.fold(f64::INFINITY, f64::min)
}

/// Warps followed by the inverse of their mean.
fn recentred(warps: &[Warp], closed: bool) -> Result<Vec<Warp>> {
    let knots = warps[0].places().len();
    let count = warps.len() as f64;
    let mean = |phase: f64| warps.iter().map(|w| w.place(phase)).sum::<f64>() / count;
    let slope = |phase: f64| warps.iter().map(|w| w.slope(phase)).sum::<f64>() / count;
    let means: Vec<f64> = uniform(knots).into_iter().map(mean).collect();
    let rough = Warp::through(means, closed)?;
    // The mean of cubics is not the cubic of means: a few steps of Newton's method close the gap.
    let phases: Vec<f64> = (1..knots - 1)
        .into_par_iter()
        .map(|k| {
            let place = k as f64 / (knots - 1) as f64;
            let mut phase = rough.phase(place);
            for _ in 0..4 {
                let error = mean(phase) - place;
                if error.abs() < 1e-15 {
                    break;
                }
                phase = (phase - error / slope(phase)).clamp(0.0, 1.0);
            }
            phase
        })
        .collect();
    warps
        .iter()
        .map(|w| {
            let inner = phases.iter().map(|&p| w.place(p));
            let places = std::iter::once(0.0).chain(inner).chain([1.0]).collect();
            Warp::through(places, closed)
        })
        .collect()
}
