//! How well boundaries agree with reference ones, and how well chance would.

use rand::SeedableRng;
use rand::seq::index;
use rand_pcg::Pcg64;

use super::spans::Span;

/// Agreement of boundaries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryScore {
    /// The share of found boundaries that match; 1 where none was found.
    pub precision: f64,
    /// The share of reference boundaries that are matched; 1 where there are none.
    pub recall: f64,
    /// The harmonic mean of both.
    pub f1: f64,
}

impl BoundaryScore {
    fn new(matched: usize, found: usize, reference: usize) -> Self {
        let share = |of: usize| match of {
            0 => 1.0,
            _ => matched as f64 / of as f64,
        };
        let (precision, recall) = (share(found), share(reference));
        let f1 = match found + reference {
            0 => 1.0,
            both => 2.0 * matched as f64 / both as f64,
        };
        Self {
            precision,
            recall,
            f1,
        }
    }
}

/// The frames at which spans begin or end inside a recording of so many frames, each once, in order.
pub fn boundaries(spans: &[Span], frames: usize) -> Vec<usize> {
    let mut out: Vec<usize> = spans
        .iter()
        .flat_map(|s| [s.start, s.end])
        .filter(|&t| t > 0 && t < frames)
        .collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Scores found boundaries against reference ones, both in frames and in order, at a tolerance in frames.
///
/// Matching is one to one, with as many pairs as there can be. 0.1 s and 0.25 s are customary tolerances.
pub fn score(found: &[usize], reference: &[usize], tolerance: usize) -> BoundaryScore {
    BoundaryScore::new(
        matched(found, reference, tolerance),
        found.len(),
        reference.len(),
    )
}

/// The mean score of as many boundaries set at random: what a found score must beat.
///
/// Each of `draws` (at least one is made) takes `count` different frames of `1..frames`, all alike.
pub fn random_score(
    count: usize,
    reference: &[usize],
    frames: usize,
    tolerance: usize,
    draws: usize,
    seed: u64,
) -> BoundaryScore {
    let mut rng = Pcg64::seed_from_u64(seed);
    let inner = frames.saturating_sub(1);
    let draws = draws.max(1);
    let mut sum = [0.0; 3];
    for _ in 0..draws {
        let mut cuts = index::sample(&mut rng, inner, count.min(inner)).into_vec();
        cuts.sort_unstable();
        for cut in &mut cuts {
            *cut += 1;
        }
        let one = score(&cuts, reference, tolerance);
        for (s, v) in sum.iter_mut().zip([one.precision, one.recall, one.f1]) {
            *s += v / draws as f64;
        }
    }
    let [precision, recall, f1] = sum;
    BoundaryScore {
        precision,
        recall,
        f1,
    }
}

/// The most pairs that lie within the tolerance. Taking the earliest possible pair each time attains it, as both
/// sides are in order and all tolerances are alike.
fn matched(found: &[usize], reference: &[usize], tolerance: usize) -> usize {
    let (mut i, mut j, mut count) = (0, 0, 0);
    while let (Some(&a), Some(&b)) = (found.get(i), reference.get(j)) {
        if a.abs_diff(b) <= tolerance {
            count += 1;
            i += 1;
            j += 1;
        } else if a < b {
            i += 1;
        } else {
            j += 1;
        }
    }
    count
}
