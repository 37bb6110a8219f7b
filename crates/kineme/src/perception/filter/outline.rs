//! Outlines: how much the parts of a body move in each quarter of a clip, and where they are then.
//!
//! The forward pass and the shapes compare moments with moments, so both err where a clip is matched with the wrong moments
//! of an exemplar. An outline needs no matching. Its numbers are few enough to be whitened all at once, the quarters with
//! one another: who moves little does so from beginning to end, and that counts once.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use super::features::Layout;
use super::noise::pairs;
use super::rows::Row;
use crate::alignment::resample;
use crate::error::{Error, Result};
use crate::math::eigen::principal;
use crate::primitive::Vocabulary;
use crate::skeleton::Role;

/// A clip is stretched to so many times two frames, of which the mean of each two is looked at.
const FRAMES: usize = 32;
/// In so many equal parts.
const PARTS: usize = 4;
/// Beside the hands as seen from the shoulders, these landmarks: ends and middles of limbs and trunk.
const ROLES: [Role; 10] = [
    Role::Chest,
    Role::Head,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::RightLowerArm,
    Role::RightHand,
    Role::LeftLowerLeg,
    Role::LeftFoot,
    Role::RightLowerLeg,
    Role::RightFoot,
];
/// Below this much, metres, movement is hardly told from stillness.
const STILL_M: f64 = 0.05;
/// A place counts as much as a factor of e in movement does if it is so far off, metres.
const PLACE_M: f64 = 0.2;
/// The standard deviation of all numbers, expected before any exemplar was seen, how many residuals that counts for, and
/// what is added to the deviations for fear of chance.
const PRIOR: f64 = 0.5;
const PRIOR_COUNT: f64 = 20.0;
const FLOOR: f64 = 0.05;
/// The share of the covariance that is replaced by its diagonal.
const SHRINK: f64 = 0.1;
/// Directions that are kept: those in which the rows vary most once whitened.
const DIRECTIONS: usize = 40;

/// The outlines of rows, whitened by how those of one primitive differ.
#[derive(Debug, Clone)]
pub(super) struct Outlines {
    /// Numbers of a posture that are looked at.
    looked_at: Vec<usize>,
    /// Directions x numbers.
    transform: DMatrix<f64>,
    /// Directions x rows.
    rows: DMatrix<f64>,
}

impl Outlines {
    /// The outlines of rows: those of exemplars' recordings, looked at so many times a second. `None` where a row lies
    /// between exemplars: there the manifold is known, and a blend of recordings is none of its movements.
    ///
    /// # Errors
    /// When their covariance is not positive definite.
    pub fn new(
        vocabulary: &Vocabulary,
        rows: &[Row],
        layout: &Layout,
        clock_hz: f64,
    ) -> Result<Option<Self>> {
        let looked_at = layout.numbers_of(&ROLES);
        let of = |row: &Row| {
            let exemplars = vocabulary.primitives()[row.primitive].exemplars();
            let motion = &exemplars[row.exemplar?].motion;
            let every = ((motion.rate_hz() / clock_hz).round() as usize).max(1);
            let frames = (0..motion.frames()).step_by(every);
            let postures: Vec<f64> = frames
                .flat_map(|f| layout.posture(motion.pose(f)))
                .collect();
            Some(outline(&postures, layout.posture_dims(), &looked_at))
        };
        let outlines: Option<Vec<DVector<f64>>> = rows.par_iter().map(of).collect();
        let Some(outlines) = outlines.filter(|o| !o.is_empty() && !looked_at.is_empty()) else {
            return Ok(None);
        };
        let covariance = covariance(vocabulary, rows, &outlines);
        let n = covariance.nrows();
        let inverse = Cholesky::new(covariance)
            .and_then(|c| c.l().solve_lower_triangular(&DMatrix::identity(n, n)))
            .ok_or_else(|| Error::invalid("outlines that differ without bounds"))?;
        let raw = DMatrix::from_columns(&outlines);
        let mut centred = &inverse * &raw;
        let mean = centred.column_mean();
        centred.column_iter_mut().for_each(|mut c| c -= &mean);
        let (_, basis) = principal(&centred)?;
        let transform = basis.rows(0, DIRECTIONS.min(n)) * inverse;
        Ok(Some(Self {
            looked_at,
            rows: &transform * raw,
            transform,
        }))
    }

    /// Squared distances, in deviations, in the mean of the directions, of a clip's postures (one after the other, evenly
    /// in time) to the rows.
    pub fn distances(&self, postures: &[f64], dims: usize) -> Vec<f64> {
        let seen = &self.transform * outline(postures, dims, &self.looked_at);
        let squared = |row: nalgebra::DVectorView<'_, f64>| (row - &seen).norm_squared();
        let rows = self.rows.column_iter().map(squared);
        rows.map(|d| d / seen.len() as f64).collect()
    }
}

/// For each part of a clip: how much each number moves in it (the logarithm of the root mean square of its velocity, in
/// metres a part, so that pace is left out), and its mean, less the clip's. Then of the whole: how far each number is from
/// its mean, and how much it moves. What jitter adds to velocities is told by second differences, and taken off.
fn outline(postures: &[f64], dims: usize, looked_at: &[usize]) -> DVector<f64> {
    let places: Vec<f64> = (0..2 * FRAMES)
        .map(|k| k as f64 / (2 * FRAMES - 1) as f64)
        .collect();
    let frames = resample(postures, dims, &places);
    let mut numbers = Vec::with_capacity(looked_at.len() * (2 * PARTS + 2));
    for &i in looked_at {
        let at = |f: usize| 0.5 * (frames[2 * f * dims + i] + frames[(2 * f + 1) * dims + i]);
        let course: Vec<f64> = (0..FRAMES).map(at).collect();
        let mean = |own: &[f64]| own.iter().sum::<f64>() / own.len() as f64;
        let moves = |own: &[f64]| {
            let steps: Vec<f64> = own.windows(2).map(|p| (p[1] - p[0]).powi(2)).collect();
            let bends = own.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).powi(2));
            // White noise of variance v adds 2 v to the one, and 6 v to the other.
            let moved = mean(&steps) - mean(&bends.collect::<Vec<f64>>()) / 3.0;
            (moved.max(0.0).sqrt() * (FRAMES / PARTS) as f64 + STILL_M).ln()
        };
        let middle = mean(&course);
        for part in 0..PARTS {
            let (from, to) = (part * FRAMES / PARTS, (part + 1) * FRAMES / PARTS);
            numbers.push(moves(&course[from..(to + 1).min(FRAMES)]));
            numbers.push((mean(&course[from..to]) - middle) / PLACE_M);
        }
        let off: Vec<f64> = course.iter().map(|v| (v - middle).powi(2)).collect();
        numbers.push((mean(&off).sqrt() + STILL_M).ln());
        numbers.push(moves(&course));
    }
    DVector::from_vec(numbers)
}

/// The covariance of an outline about that of its row.
fn covariance(vocabulary: &Vocabulary, rows: &[Row], outlines: &[DVector<f64>]) -> DMatrix<f64> {
    let residual = |(a, b): (usize, usize)| {
        let r = &outlines[a] - &outlines[b];
        (r.norm_squared(), r)
    };
    let of = |primitive: usize| pairs(vocabulary, rows, primitive, residual);
    let residuals: Vec<DVector<f64>> = (0..vocabulary.primitives().len()).flat_map(of).collect();
    let n = outlines[0].len();
    let mut sum = DMatrix::identity(n, n) * (PRIOR_COUNT * PRIOR * PRIOR);
    let count = PRIOR_COUNT + residuals.len() as f64;
    if !residuals.is_empty() {
        let residuals = DMatrix::from_columns(&residuals);
        // Two rows differ by twice what one differs from the truth.
        sum += &residuals * residuals.transpose() * 0.5;
    }
    let covariance = sum / count;
    let diagonal = DMatrix::from_diagonal(&covariance.diagonal());
    covariance * (1.0 - SHRINK) + diagonal * SHRINK + DMatrix::identity(n, n) * (FLOOR * FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One number that goes up and back in a share of the frames, from a place.
    fn stroke(frames: usize, from: f64, to: f64, place: f64) -> Vec<f64> {
        let at = |f: usize| {
            let share = (f as f64 / (frames - 1) as f64 - from) / (to - from);
            place + 0.5 * (1.0 - (share.clamp(0.0, 1.0) * std::f64::consts::TAU).cos())
        };
        (0..frames).map(at).collect()
    }

    fn of(frames: usize, from: f64, to: f64, place: f64) -> DVector<f64> {
        outline(&stroke(frames, from, to, place), 1, &[0])
    }

    #[test]
    fn neither_pace_nor_place_changes_an_outline() {
        let usual = of(90, 0.1, 0.9, 0.0);
        for (frames, place) in [(45, 0.0), (180, 0.0), (90, -1.5), (400, 2.0)] {
            let off = (of(frames, 0.1, 0.9, place) - &usual).amax();
            assert!(off < 0.05, "{frames} frames at {place}: {off}");
        }
    }

    #[test]
    fn an_outline_tells_in_which_quarter_how_much_moves_and_where() {
        let early = of(200, 0.0, 0.25, 0.0);
        let moves = |part: usize| early[2 * part];
        let place = |part: usize| early[2 * part + 1];
        // Half of the time up, half of it down, a metre each: the root mean square of a sine's slope, a quarter long.
        let wanted = (std::f64::consts::PI / 2f64.sqrt() + STILL_M).ln();
        // Of a stroke so short an eighth is taken for jitter.
        assert!(
            (moves(0) - wanted).abs() < 0.15,
            "{} for {wanted}",
            moves(0)
        );
        for part in 1..PARTS {
            assert!(moves(part) < STILL_M.ln() + 0.2, "{part}: {}", moves(part));
            // Half a metre up in a quarter is an eighth in the mean.
            assert!((place(part) + 0.125 / PLACE_M).abs() < 0.02);
        }
        assert!((place(0) - 0.375 / PLACE_M).abs() < 0.05);
        let late = of(200, 0.75, 1.0, 0.0);
        assert!((late[6] - moves(0)).abs() < 0.1 && late[0] < STILL_M.ln() + 0.2);
        // Of the whole, both are alike.
        assert!((late[8] - early[8]).abs() < 0.05 && (late[9] - early[9]).abs() < 0.05);
    }

    #[test]
    fn distances_are_in_deviations_in_the_mean_of_all_directions() {
        let rows = [of(90, 0.0, 0.25, 0.0), of(90, 0.75, 1.0, 0.0)];
        let n = rows[0].len();
        let outlines = Outlines {
            looked_at: vec![0],
            transform: DMatrix::identity(n, n) * 2.0,
            rows: DMatrix::from_columns(&rows) * 2.0,
        };
        let distances = outlines.distances(&stroke(90, 0.0, 0.25, 0.0), 1);
        let apart = 4.0 * (&rows[0] - &rows[1]).norm_squared() / n as f64;
        assert!(distances[0] < 1e-9, "{distances:?}");
        assert!((distances[1] - apart).abs() < 1e-9, "{distances:?}");
    }
}
