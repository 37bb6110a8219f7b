//! Outlines: how much the parts of a body move in each quarter of a clip, and where they are then.
//!
//! Who follows a clip from moment to moment errs where it is matched with the wrong moments of an exemplar. An outline
//! needs no matching. Its numbers are few enough to be whitened all at once, the quarters with one another: who moves
//! little does so from beginning to end, and that counts once.

use nalgebra::{Cholesky, DMatrix, DVector, DVectorView};

use crate::alignment::resample;
use crate::error::{Error, Result};
use crate::math::eigen::principal;

/// A clip is stretched to so many times two frames, of which the mean of each two is looked at.
const FRAMES: usize = 32;
/// In so many equal parts.
const PARTS: usize = 4;
/// Half waves a clip (the orders of its cosine transform) that are one octave: from each of these to the next.
const OCTAVES: [usize; 5] = [1, 2, 4, 8, 16];
/// Below this much, metres, movement is hardly told from stillness; that of an octave, which is less.
const STILL_M: f64 = 0.05;
const STILL_OCTAVE_M: f64 = 0.02;
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
    /// Directions x numbers.
    transform: DMatrix<f64>,
    /// Directions x rows.
    rows: DMatrix<f64>,
}

impl Outlines {
    /// Of the outlines of rows, and of what is left between those of one primitive, pair by pair.
    ///
    /// # Errors
    /// When their covariance is not positive definite.
    pub fn new(outlines: &[DVector<f64>], residuals: &[DVector<f64>]) -> Result<Self> {
        let covariance = covariance(outlines[0].len(), residuals);
        let n = covariance.nrows();
        let inverse = Cholesky::new(covariance)
            .and_then(|c| c.l().solve_lower_triangular(&DMatrix::identity(n, n)))
            .ok_or_else(|| Error::invalid("outlines that differ without bounds"))?;
        let raw = DMatrix::from_columns(outlines);
        let mut centred = &inverse * &raw;
        let mean = centred.column_mean();
        centred.column_iter_mut().for_each(|mut c| c -= &mean);
        let (_, basis) = principal(&centred)?;
        let transform = basis.rows(0, DIRECTIONS.min(n)) * inverse;
        Ok(Self {
            rows: &transform * raw,
            transform,
        })
    }

    /// Squared distances, in deviations, in the mean of the directions, of an outline to those of the rows.
    pub fn distances(&self, outline: &DVector<f64>) -> Vec<f64> {
        let seen = &self.transform * outline;
        let squared = |row: DVectorView<'_, f64>| (row - &seen).norm_squared();
        let rows = self.rows.column_iter().map(squared);
        rows.map(|d| d / seen.len() as f64).collect()
    }
}

/// The outline of a clip: `dims` numbers a frame, metres, evenly in time, of which some are looked at.
///
/// For each part of a clip: how much each number moves in it (the logarithm of the root mean square of its velocity, in
/// metres a part, so that pace is left out), and its mean, less the clip's. Then of the whole: how far each number is from
/// its mean, and how much it moves. What jitter adds to velocities is told by second differences, and taken off.
pub(super) fn outline(clip: &[f64], dims: usize, looked_at: &[usize]) -> DVector<f64> {
    let mut numbers = Vec::with_capacity(looked_at.len() * (2 * PARTS + 2));
    for course in courses(clip, dims, looked_at) {
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

/// How often things go to and fro, which quarters do not tell: of each number that is looked at, how far it goes (the
/// logarithm of a root mean square, metres) in each octave of its cosine transform. Jitter adds the same to every order: as
/// much as there is above the octaves, which is taken off.
pub(super) fn octaves(clip: &[f64], dims: usize, looked_at: &[usize]) -> DVector<f64> {
    let waves = waves();
    let mut numbers = Vec::with_capacity(looked_at.len() * (OCTAVES.len() - 1));
    for course in courses(clip, dims, looked_at) {
        let power = |wave: &[f64]| {
            let product = wave.iter().zip(&course).map(|(w, v)| w * v).sum::<f64>();
            product * product
        };
        let powers: Vec<f64> = waves.chunks_exact(FRAMES).map(power).collect();
        let jitter = mean(&powers[OCTAVES[OCTAVES.len() - 1]..]);
        numbers.extend(OCTAVES.windows(2).map(|octave| {
            let own = &powers[octave[0]..octave[1]];
            let moved = own.len() as f64 * (mean(own) - jitter);
            (moved.max(0.0).sqrt() + STILL_OCTAVE_M).ln()
        }));
    }
    DVector::from_vec(numbers)
}

/// The courses of the numbers that are looked at, over [`FRAMES`] frames.
fn courses(clip: &[f64], dims: usize, looked_at: &[usize]) -> impl Iterator<Item = Vec<f64>> {
    let places: Vec<f64> = (0..2 * FRAMES)
        .map(|k| k as f64 / (2 * FRAMES - 1) as f64)
        .collect();
    let frames = resample(clip, dims, &places);
    looked_at.iter().map(move |i| {
        let at = |f: usize| 0.5 * (frames[2 * f * dims + i] + frames[(2 * f + 1) * dims + i]);
        (0..FRAMES).map(at).collect()
    })
}

fn mean(own: &[f64]) -> f64 {
    own.iter().sum::<f64>() / own.len() as f64
}

/// The cosines of each order, one after the other, so long that the square of a course's product with one is the mean
/// square of what it has of it (Ahmed, Natarajan and Rao 1974).
fn waves() -> Vec<f64> {
    let at = |order: usize, f: usize| {
        let angle = std::f64::consts::PI * order as f64 * (f as f64 + 0.5) / FRAMES as f64;
        2f64.sqrt() / FRAMES as f64 * angle.cos()
    };
    (0..FRAMES)
        .flat_map(|order| (0..FRAMES).map(move |f| at(order, f)))
        .collect()
}

/// The covariance of an outline of so many numbers about that of its row.
fn covariance(n: usize, residuals: &[DVector<f64>]) -> DMatrix<f64> {
    let mut sum = DMatrix::identity(n, n) * (PRIOR_COUNT * PRIOR * PRIOR);
    let count = PRIOR_COUNT + residuals.len() as f64;
    if !residuals.is_empty() {
        let residuals = DMatrix::from_columns(residuals);
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
            transform: DMatrix::identity(n, n) * 2.0,
            rows: DMatrix::from_columns(&rows) * 2.0,
        };
        let distances = outlines.distances(&of(90, 0.0, 0.25, 0.0));
        let apart = 4.0 * (&rows[0] - &rows[1]).norm_squared() / n as f64;
        assert!(distances[0] < 1e-9, "{distances:?}");
        assert!((distances[1] - apart).abs() < 1e-9, "{distances:?}");
    }

    #[test]
    fn octaves_tell_how_often_something_goes_to_and_fro_whatever_the_jitter() {
        let found = |times: f64, jitter: f64| {
            let at = |f: usize| {
                let angle = times * std::f64::consts::TAU * f as f64 / 299.0;
                let mut other = f as u64;
                let mut white = 0.0;
                // The sum of twelve even draws is nearly normal.
                for _ in 0..12 {
                    other = other
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(12_345);
                    white += (other >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
                }
                0.3 * angle.cos() + jitter * white
            };
            let course: Vec<f64> = (0..300).map(at).collect();
            octaves(&course, 1, &[0])
        };
        // Once to and fro is two half waves.
        for (times, octave) in [(0.5, 0), (1.25, 1), (2.75, 2), (6.0, 3)] {
            for jitter in [0.0, 0.02] {
                let found = found(times, jitter);
                let wanted = (0.3 / 2f64.sqrt() + STILL_OCTAVE_M).ln();
                let off = (found[octave] - wanted).abs();
                assert!(off < 0.15, "{times}: {found} for {wanted}");
                for other in (0..OCTAVES.len() - 1).filter(|o| o.abs_diff(octave) > 1) {
                    assert!(found[other] < STILL_OCTAVE_M.ln() + 1.3, "{times}: {found}");
                }
            }
        }
    }
}
