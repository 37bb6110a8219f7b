//! The nearest sequences of each, without warping every pair.
//!
//! Warping can only shorten the distance of two sequences, and in a narrow band it does not shorten it by
//! much: the nearest by warping are among the somewhat farther by plain distance. So plain distances of
//! coarser copies choose candidates, and only these are warped.

use rand::SeedableRng;
use rand::seq::index;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::lanes::{EuclideanTask, LANES, Lane};
use super::pairs::Sequences;
use crate::error::{Error, Result};

/// For each sequence others with their warping distances, nearest first, ties by index.
///
/// Symmetric: if `j` stands in the list of `i`, then `i` in the list of `j`, with the same distance.
/// No sequence stands in its own list.
pub type NeighbourLists = Vec<Vec<(usize, f64)>>;

/// How many candidates are warped, and on what they are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nearest {
    /// Candidates of each sequence, at least 1; symmetry adds those that chose it.
    pub candidates: usize,
    /// Frames of the averaged copies on which candidates are chosen, at least 1.
    pub coarse_frames: usize,
    /// Radius of the warping band in frames.
    pub radius: usize,
}

impl Nearest {
    /// 64 candidates on 8 averaged frames, with this radius of the band.
    pub fn with_radius(radius: usize) -> Self {
        Self {
            candidates: 64,
            coarse_frames: 8,
            radius,
        }
    }
}

/// How well the true nearest must be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecallGoal {
    /// Nearest neighbours that matter to the caller.
    pub neighbours: usize,
    /// The share of them that must be found, 0 to 1.
    pub recall: f64,
    /// Sequences on which the share is measured.
    pub sample: usize,
    /// Seed of the sample.
    pub seed: u64,
}

impl Default for RecallGoal {
    fn default() -> Self {
        Self {
            neighbours: 10,
            recall: 0.99,
            sample: 100,
            seed: 0,
        }
    }
}

/// What [`nearest_to_recall`] reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// The lists.
    pub lists: NeighbourLists,
    /// The recall measured on them.
    pub recall: f64,
    /// The candidates that it took.
    pub candidates: usize,
}

/// Warping distances between each sequence and its candidates.
///
/// # Errors
/// When `candidates` or `coarse_frames` is 0.
pub fn nearest_neighbours(sequences: &Sequences, config: &Nearest) -> Result<NeighbourLists> {
    if config.candidates == 0 || config.coarse_frames == 0 {
        return Err(Error::invalid(format!(
            "nearest neighbours need at least one candidate and one coarse frame, found {} and {}",
            config.candidates, config.coarse_frames
        )));
    }
    // Each pair once, at its smaller index.
    let mut partners: Vec<Vec<usize>> = vec![Vec::new(); sequences.len()];
    for (i, chosen) in candidates(sequences, config).into_iter().enumerate() {
        for j in chosen {
            partners[i.min(j)].push(i.max(j));
        }
    }
    let distances: Vec<Vec<f64>> = partners
        .par_iter_mut()
        .enumerate()
        .map(|(i, partners)| {
            partners.sort_unstable();
            partners.dedup();
            sequences.distances(sequences.slice(i..i + 1), partners, config.radius)
        })
        .collect();
    let mut lists: NeighbourLists = vec![Vec::new(); sequences.len()];
    for (i, (partners, row)) in partners.iter().zip(&distances).enumerate() {
        for (&j, &d) in partners.iter().zip(row) {
            lists[i].push((j, d));
            lists[j].push((i, d));
        }
    }
    lists.par_iter_mut().for_each(|list| sort_nearest(list));
    Ok(lists)
}

/// [`nearest_neighbours`] with twice the candidates until the goal is reached or all pairs are warped.
///
/// # Errors
/// As for [`nearest_neighbours`], and when the goal's recall lies outside [0, 1].
pub fn nearest_to_recall(
    sequences: &Sequences,
    config: &Nearest,
    goal: &RecallGoal,
) -> Result<Reached> {
    if !(0.0..=1.0).contains(&goal.recall) {
        return Err(Error::invalid(format!(
            "a recall lies between 0 and 1, found {}",
            goal.recall
        )));
    }
    let mut config = *config;
    loop {
        let lists = nearest_neighbours(sequences, &config)?;
        let recall = recall(sequences, &lists, config.radius, goal);
        let all = config.candidates >= sequences.len().saturating_sub(1);
        if all || recall >= goal.recall {
            return Ok(Reached {
                lists,
                recall,
                candidates: config.candidates,
            });
        }
        config.candidates *= 2;
    }
}

/// The share of the true nearest neighbours by warping that `lists` hold, over a seeded sample of sequences.
///
/// A neighbour as near as the farthest true one counts for it. 1 where there is nothing to find. The goal
/// gives number of neighbours, sample and seed; `radius` is that of the band.
pub fn recall(
    sequences: &Sequences,
    lists: &[Vec<(usize, f64)>],
    radius: usize,
    goal: &RecallGoal,
) -> f64 {
    let n = sequences.len().min(lists.len());
    let neighbours = goal.neighbours.min(n.saturating_sub(1));
    if neighbours == 0 || goal.sample == 0 {
        return 1.0;
    }
    let mut rng = Pcg64::seed_from_u64(goal.seed);
    let sample = index::sample(&mut rng, n, goal.sample.min(n)).into_vec();
    let found: usize = sample
        .par_iter()
        .map(|&i| {
            let others: Vec<usize> = (0..n).filter(|&j| j != i).collect();
            let mut true_distances =
                sequences.distances(sequences.slice(i..i + 1), &others, radius);
            true_distances.sort_unstable_by(f64::total_cmp);
            let farthest = true_distances[neighbours - 1];
            let held = lists[i].iter().filter(|(_, d)| *d <= farthest).count();
            held.min(neighbours)
        })
        .sum();
    found as f64 / (neighbours * sample.len()) as f64
}

/// For each sequence the nearest others by Euclidean distance of averaged copies.
fn candidates(sequences: &Sequences, config: &Nearest) -> Vec<Vec<usize>> {
    let n = sequences.len();
    let coarse = averaged(sequences, config.coarse_frames);
    let size = config.coarse_frames.min(sequences.frames()) * sequences.dims();
    let blocks: Vec<Vec<Lane>> = (0..n.div_ceil(LANES))
        .into_par_iter()
        .map(|b| {
            let mut block = vec![[0.0; LANES]; size];
            for lane in 0..LANES {
                let item = (b * LANES + lane).min(n - 1);
                let copy = &coarse[item * size..(item + 1) * size];
                for (cell, v) in block.iter_mut().zip(copy) {
                    cell[lane] = *v;
                }
            }
            block
        })
        .collect();
    // Queries in groups, so that a block is read once for many of them.
    let group = 64;
    let chosen: Vec<Vec<Vec<usize>>> = coarse
        .par_chunks(group * size)
        .enumerate()
        .map(|(g, queries)| {
            let mut rows = vec![Vec::with_capacity(n + LANES); queries.len() / size];
            for block in &blocks {
                let lanes = EuclideanTask { block, queries }.run();
                for (row, lane) in rows.iter_mut().zip(lanes) {
                    row.extend(lane);
                }
            }
            let own = g * group..;
            own.zip(&rows)
                .map(|(i, row)| least_of(&row[..n], i, config.candidates))
                .collect()
        })
        .collect();
    chosen.into_iter().flatten().collect()
}

/// The indices of the `count` least numbers but `own`, in no particular order; ties by index.
fn least_of(row: &[f32], own: usize, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..row.len()).filter(|&j| j != own).collect();
    if count < order.len() {
        order.select_nth_unstable_by(count, |&a, &b| row[a].total_cmp(&row[b]).then(a.cmp(&b)));
        order.truncate(count);
    }
    order
}

/// Copies of at most `coarse_frames` frames, each the mean of its share of the frames.
fn averaged(sequences: &Sequences, coarse_frames: usize) -> Vec<f32> {
    let (frames, dims) = (sequences.frames(), sequences.dims());
    let coarse = coarse_frames.min(frames);
    let values = sequences.slice(0..sequences.len());
    let mut out = Vec::with_capacity(sequences.len() * coarse * dims);
    for sequence in values.chunks_exact(frames * dims) {
        for c in 0..coarse {
            let (start, end) = (c * frames / coarse, (c + 1) * frames / coarse);
            let share = &sequence[start * dims..end * dims];
            out.extend(
                (0..dims).map(|d| {
                    share.iter().skip(d).step_by(dims).sum::<f32>() / (end - start) as f32
                }),
            );
        }
    }
    out
}

fn sort_nearest(list: &mut [(usize, f64)]) {
    list.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
}
