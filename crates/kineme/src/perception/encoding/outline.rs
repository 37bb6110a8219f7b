//! What the outlines of paths cost a row: of whole clips, beside its chain.
//!
//! A chain compares decisions with decisions, at whatever pace, and errs where it follows the wrong part of an exemplar. How
//! much the effectors move when, and how often they go to and fro, needs no following.

use nalgebra::{DVector, Vector3};
use rayon::prelude::*;

use super::paths::EffectorPaths;
use super::rows::Row;
use super::settings::{EncodingSettings, REACH_UNITS};
use crate::error::Result;
use crate::perception::outline::{self, octaves, outline};
use crate::perception::pairs::{all_pairs, farther};
use crate::perception::rows::manifold;
use crate::primitive::Vocabulary;

/// What a squared deviation of outlines costs, units: a quarter of the temperature of the soft minimum over exemplars, so
/// that all directions together count for half of one.
const COST: f64 = 0.0125;

/// The outlines of an encoder's rows.
#[derive(Debug, Clone)]
pub(super) struct Outlines(outline::Outlines);

impl Outlines {
    /// The outlines of rows: those of exemplars' recordings. `None` where parameters have a meaning: what lies between the
    /// exemplars is as much the primitive as they are.
    ///
    /// # Errors
    /// When the body lacks an effector or shoulders, or the outlines differ without bounds.
    pub fn new(
        vocabulary: &Vocabulary,
        rows: &[Row],
        s: &EncodingSettings,
    ) -> Result<Option<Self>> {
        let known = vocabulary.primitives();
        if known.iter().any(manifold) {
            return Ok(None);
        }
        let of = |row: &Row| {
            let motion = &known[row.primitive].exemplars()[row.exemplar].motion;
            let paths = EffectorPaths::of_motion(motion, &s.effectors, s.heading_secs)?;
            Ok(of_paths(
                &paths,
                paths.reach_m().unwrap_or(1.0) / REACH_UNITS,
            ))
        };
        let outlines: Vec<Option<DVector<f64>>> = rows.par_iter().map(of).collect::<Result<_>>()?;
        let outlines = outlines.into_iter().collect::<Option<Vec<_>>>();
        let Some(outlines) = outlines.filter(|o| !o.is_empty()) else {
            return Ok(None);
        };
        let residual = |(a, b): (usize, usize)| {
            let r = &outlines[a] - &outlines[b];
            (r.norm_squared(), r)
        };
        let of = |primitive: usize| {
            let own = (0..rows.len()).filter(|&r| rows[r].primitive == primitive);
            let pairs = all_pairs(&own.collect::<Vec<usize>>());
            farther(pairs.into_iter().map(residual).collect())
        };
        let residuals: Vec<DVector<f64>> = (0..known.len()).flat_map(of).collect();
        let outlines = outline::Outlines::new(&outlines, &residuals)?;
        Ok(Some(Self(outlines)))
    }

    /// What paths cost each row by their outline alone, `unit_m` of their metres being a unit. `None` where an effector was
    /// not seen most of the time.
    pub fn costs(&self, paths: &EffectorPaths, unit_m: f64) -> Option<Vec<f64>> {
        let distances = self.0.distances(&of_paths(paths, unit_m)?);
        Some(distances.into_iter().map(|d| COST * d).collect())
    }
}

/// What rows cost by their chains and by their outlines.
pub(super) fn sums(chains: &[f64], outlines: &[f64]) -> Vec<f64> {
    chains.iter().zip(outlines).map(|(c, o)| c + o).collect()
}

/// The outline of the effectors, and of where each is against each other, in units of `unit_m`.
fn of_paths(paths: &EffectorPaths, unit_m: f64) -> Option<DVector<f64>> {
    let effectors = 0..paths.effectors().len();
    let courses = effectors.map(|e| bridged(paths, e));
    let courses: Vec<Vec<Vector3<f64>>> = courses.collect::<Option<_>>()?;
    let mut clip = Vec::new();
    for frame in 0..paths.frames() {
        for (e, course) in courses.iter().enumerate() {
            clip.extend((course[frame] / unit_m).iter());
            for other in &courses[e + 1..] {
                clip.extend(((course[frame] - other[frame]) / unit_m).iter());
            }
        }
    }
    let dims = clip.len() / paths.frames();
    let all: Vec<usize> = (0..dims).collect();
    let (parts, octaves) = (outline(&clip, dims, &all), octaves(&clip, dims, &all));
    let numbers = parts.len() + octaves.len();
    Some(DVector::from_iterator(
        numbers,
        parts.iter().chain(&octaves).copied(),
    ))
}

/// The course of an effector, straight where it was not seen for a while; `None` where that is most of the time.
fn bridged(paths: &EffectorPaths, effector: usize) -> Option<Vec<Vector3<f64>>> {
    let seen = (0..paths.frames()).filter_map(|f| Some((f, paths.at(f)[effector]?)));
    let seen: Vec<(usize, Vector3<f64>)> = seen.collect();
    if 2 * seen.len() <= paths.frames() {
        return None;
    }
    let mut next = 0;
    let at = |frame: usize| {
        while next < seen.len() && seen[next].0 < frame {
            next += 1;
        }
        let (before, after) = (next.checked_sub(1).map(|k| seen[k]), seen.get(next));
        match (before, after) {
            (Some((f, a)), Some(&(g, b))) => a.lerp(&b, (frame - f) as f64 / (g - f) as f64),
            (Some((_, p)), None) | (None, Some(&(_, p))) => p,
            (None, None) => Vector3::zeros(),
        }
    };
    Some((0..paths.frames()).map(at).collect())
}
