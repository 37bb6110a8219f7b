//! Shapes: how a clip goes as a whole, whatever its pace.
//!
//! The forward pass goes along a row at about the pace of its exemplar, and its displacements are what that pace makes
//! them. Of the whole clip, stretched to one length, warped in time and less its mean posture, neither the pace nor how
//! somebody stands is left.

use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;

use super::emission::Part;
use super::features::Layout;
use super::rows::Row;
use crate::alignment::{Band, Sequences, distances_to_query, resample};
use crate::error::{Error, Result};
use crate::math::eigen::principal;
use crate::primitive::Vocabulary;

/// Frames to which movements are stretched, and the share of them within which they are warped.
const FRAMES: usize = 64;
const BAND: f64 = 0.1;

/// The shapes of rows, whitened by how postures of one primitive differ.
#[derive(Debug, Clone)]
pub(super) struct Shapes {
    /// Rows x frames x numbers of a posture.
    postures: Vec<f64>,
    /// Hands and body, postures alone.
    parts: Vec<Part>,
    /// Where all numbers are known.
    complete: Whitened,
}

#[derive(Debug, Clone)]
struct Whitened {
    /// Directions x numbers of a posture: makes differences white, each part as long as it is trusted.
    transform: DMatrix<f64>,
    rows: Sequences,
}

impl Shapes {
    /// The shapes of rows: those of exemplars' recordings. `None` where a row lies between exemplars: there the
    /// manifold is known, and a blend of recordings is none of its movements.
    ///
    /// # Errors
    /// When a covariance is not positive definite.
    pub fn new(
        vocabulary: &Vocabulary,
        rows: &[Row],
        layout: &Layout,
        parts: Vec<Part>,
    ) -> Result<Option<Self>> {
        let of = |row: &Row| {
            let exemplars = vocabulary.primitives()[row.primitive].exemplars();
            let motion = &exemplars[row.exemplar?].motion;
            let dof = vocabulary.body().dof();
            let poses = resample(motion.poses(), dof, &places());
            let postures: Vec<f64> = poses.chunks(dof).flat_map(|p| layout.posture(p)).collect();
            Some(shape(&postures, postures.len() / FRAMES))
        };
        let shapes: Option<Vec<Vec<f64>>> = rows.par_iter().map(of).collect();
        let Some(shapes) = shapes.filter(|s| s.iter().any(|s| !s.is_empty())) else {
            return Ok(None);
        };
        let postures = shapes.concat();
        Ok(Some(Self {
            complete: Whitened::new(&parts, &postures, &[])?,
            postures,
            parts,
        }))
    }

    /// Squared warping distances a frame, trusted a second as the parts are, of a clip's postures (one after the other,
    /// evenly in time) to the rows. Numbers of a posture that are `unknown` (empty: none) are left out.
    ///
    /// # Errors
    /// When a covariance is not positive definite or a number is not finite.
    pub fn distances(&self, postures: &[f64], unknown: &[bool]) -> Result<Vec<f64>> {
        let marginal: Whitened;
        let whitened = match unknown.contains(&true) {
            true => {
                marginal = Whitened::new(&self.parts, &self.postures, unknown)?;
                &marginal
            }
            false => &self.complete,
        };
        let transform = &whitened.transform;
        if transform.nrows() == 0 {
            return Ok(vec![
                0.0;
                self.postures.len() / (FRAMES * transform.ncols())
            ]);
        }
        let seen = shape(postures, transform.ncols());
        let seen = transform * DMatrix::from_column_slice(transform.ncols(), FRAMES, &seen);
        let radius = Band::radius(BAND, FRAMES);
        let distances = distances_to_query(&whitened.rows, seen.as_slice(), radius)?;
        Ok(distances.iter().map(|d| d * d / FRAMES as f64).collect())
    }
}

impl Whitened {
    fn new(parts: &[Part], postures: &[f64], unknown: &[bool]) -> Result<Self> {
        let dims = parts.iter().map(|p| p.range.end).max().unwrap_or(0);
        let raw = DMatrix::from_column_slice(dims, postures.len() / dims.max(1), postures);
        let mut directions = Vec::new();
        for part in parts {
            let hidden = |i: &usize| unknown.get(*i).copied().unwrap_or(false);
            let known: Vec<usize> = part.range.clone().filter(|i| !hidden(i)).collect();
            if known.is_empty() {
                continue;
            }
            let own = known.iter().map(|i| i - part.range.start);
            let own: Vec<usize> = own.collect();
            let covariance = part.covariance.select_rows(&own).select_columns(&own);
            let inverse = Cholesky::new(covariance).and_then(|c| {
                let n = known.len();
                c.l().solve_lower_triangular(&DMatrix::identity(n, n))
            });
            let inverse = inverse.ok_or_else(|| Error::invalid("postures that do not differ"))?;
            // Each row is about its own mean, so all of them are.
            let (_, basis) = principal(&(&inverse * raw.select_rows(&known)))?;
            let kept = part.directions.clamp(1, known.len());
            let own = basis.rows(0, kept) * inverse * part.trust_per_sec.sqrt();
            for direction in own.row_iter() {
                let mut whole = vec![0.0; dims];
                known
                    .iter()
                    .zip(direction.iter())
                    .for_each(|(&i, v)| whole[i] = *v);
                directions.extend(whole);
            }
        }
        let count = directions.len() / dims.max(1);
        let transform = DMatrix::from_row_slice(count, dims, &directions);
        let white = &transform * raw;
        Ok(Self {
            rows: Sequences::new(white.as_slice(), FRAMES, count.max(1))?,
            transform,
        })
    }
}

/// Postures stretched to one length, less their mean: frames x dims.
fn shape(postures: &[f64], dims: usize) -> Vec<f64> {
    let mut frames = resample(postures, dims, &places());
    for d in 0..dims {
        let own = || (d..FRAMES * dims).step_by(dims);
        let mean = own().map(|i| frames[i]).sum::<f64>() / FRAMES as f64;
        own().for_each(|i| frames[i] -= mean);
    }
    frames
}

/// Evenly spaced places from 0 to 1.
fn places() -> Vec<f64> {
    (0..FRAMES)
        .map(|k| k as f64 / (FRAMES - 1) as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECS: f64 = 2.0;

    /// Two numbers that go round a circle so many times, at so many frames, about a place.
    fn round(times: f64, frames: usize, about: [f64; 2]) -> Vec<f64> {
        let at = |f: usize| {
            let angle = times * std::f64::consts::TAU * f as f64 / (frames - 1) as f64;
            [about[0] + angle.cos(), about[1] + angle.sin()]
        };
        (0..frames).flat_map(at).collect()
    }

    /// The shapes of one round and of two; a deviation of 0.1, trusted twice a second.
    fn shapes() -> Shapes {
        let parts = vec![Part {
            range: 0..2,
            trust_per_sec: SECS,
            directions: 20,
            covariance: DMatrix::identity(2, 2) * 0.01,
        }];
        let rows = [1.0, 2.0].map(|times| shape(&round(times, FRAMES, [0.0; 2]), 2));
        let postures = rows.concat();
        Shapes {
            complete: Whitened::new(&parts, &postures, &[]).expect("whitened"),
            postures,
            parts,
        }
    }

    #[test]
    fn neither_pace_nor_place_changes_a_shape() {
        let shapes = shapes();
        for (frames, about) in [
            (64, [0.0, 0.0]),
            (32, [0.3, 0.0]),
            (127, [0.0, -2.0]),
            (190, [1.0, 1.0]),
        ] {
            for (row, times) in [1.0, 2.0].into_iter().enumerate() {
                let distances = shapes.distances(&round(times, frames, about), &[]);
                let distances = distances.expect("distances");
                let case = format!("{times} at {frames}: {distances:?}");
                assert!(distances[row] < 2.0, "{case}");
                assert!(distances[1 - row] > 20.0, "{case}");
            }
        }
    }

    #[test]
    fn distances_are_in_deviations_and_as_long_as_they_are_trusted() {
        // Unwarped, as what stays the same wherever in time has nothing to be warped to.
        let still = shape(&vec![0.0; 2 * FRAMES], 2);
        let mut shapes = shapes();
        shapes.postures = [round(1.0, FRAMES, [0.0; 2]), still.clone()].concat();
        shapes.complete = Whitened::new(&shapes.parts, &shapes.postures, &[]).expect("whitened");
        let of = |unknown: &[bool]| shapes.distances(&still, unknown).expect("distances");
        let all = of(&[]);
        // A circle of 10 deviations about its middle; the frame that ends it, where it began, is off by little.
        assert!((all[0] / (SECS * 100.0) - 1.0).abs() < 0.05, "{all:?}");
        assert!(all[1] < 1e-9, "{all:?}");
        let half = of(&[true, false]);
        assert!((half[0] / (SECS * 50.0) - 1.0).abs() < 0.05, "{half:?}");
        assert_eq!(of(&[true, true]), [0.0, 0.0]);
    }
}
