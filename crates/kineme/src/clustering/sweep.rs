//! Sweep-and-prune clustering of points: boxes that overlap on every axis are linked, links make clusters
//! (Jenkins and Mataric, after the collision tests of Cohen, Lin, Manocha and Ponamgi 1995).

use rand::SeedableRng;
use rand::seq::index;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::math::distances::count_points;
use crate::math::partition::{UnionFind, cluster_sizes, renumbered};
use crate::math::statistics::{agreement, noise_as_singletons};

/// Where in the sorted edge lengths the automatic width looks for its gap.
const GAP_FROM: f64 = 0.60;
const GAP_TO: f64 = 0.99;
/// Subsamples from which stability is told, and their share of the points.
const SUBSAMPLES: u64 = 20;
const SUBSAMPLE_SHARE: f64 = 0.8;

/// The width of the boxes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Width {
    /// In the unit of the points, zero or more.
    Fixed(f64),
    /// In the largest gap of the logarithms of the edge lengths of the minimum spanning tree under the Chebyshev metric,
    /// between their 60th and 99th percentile.
    #[default]
    Automatic,
}

/// How points are grouped.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepAndPrune {
    /// Width of the boxes: two points are linked when they differ by no more on every axis.
    pub width: Width,
    /// Smaller groups are noise; at least 1.
    pub min_cluster_size: usize,
    /// Seed of the subsamples that stability is told from.
    pub seed: u64,
}

impl Default for SweepAndPrune {
    fn default() -> Self {
        Self {
            width: Width::Automatic,
            min_cluster_size: 3,
            seed: 0,
        }
    }
}

/// Groups, the width they were made with, and how far to trust it.
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalClusters {
    /// The group of every point, numbered in the order of first appearance; `None` for noise.
    pub labels: Vec<Option<usize>>,
    /// The width used.
    pub width: f64,
    /// Mean adjusted Rand index with the groups found in 20 subsamples of 80 % of the points, their width chosen anew
    /// when automatic; noise counts as clusters of one. Near 1 is stable; on real motion it often is not.
    pub stability: f64,
}

/// Groups points, row-major in `dimension` columns: single linkage under the Chebyshev metric, cut at the width.
///
/// The sweep is O(n log n) and a step for each pair that overlaps on the first axis; the automatic width is O(n^2).
///
/// # Errors
/// When points are not finite, the width is negative or not finite, or groups may be empty.
pub fn sweep_and_prune(
    points: &[f64],
    dimension: usize,
    options: &SweepAndPrune,
) -> Result<IntervalClusters> {
    let len = count_points(points, dimension)?;
    if options.min_cluster_size == 0 {
        return Err(Error::invalid("a group has at least 1 point"));
    }
    if let Width::Fixed(width) = options.width
        && !(width.is_finite() && width >= 0.0)
    {
        return Err(Error::invalid(format!(
            "a width is zero or more, found {width}"
        )));
    }
    let (labels, width) = group(points, dimension, options);
    let sample = ((len as f64 * SUBSAMPLE_SHARE).round() as usize).min(len);
    let agreements: Vec<f64> = (0..SUBSAMPLES)
        .into_par_iter()
        .map(|stream| {
            let mut random = Pcg64::seed_from_u64(options.seed.wrapping_add(stream));
            let mut chosen = index::sample(&mut random, len, sample).into_vec();
            chosen.sort_unstable();
            let some: Vec<f64> = chosen
                .iter()
                .flat_map(|&i| &points[i * dimension..(i + 1) * dimension])
                .copied()
                .collect();
            let whole: Vec<Option<usize>> = chosen.iter().map(|&i| labels[i]).collect();
            let (part, _) = group(&some, dimension, options);
            agreement(&noise_as_singletons(&whole), &noise_as_singletons(&part)).ari
        })
        .collect();
    Ok(IntervalClusters {
        labels,
        width,
        stability: agreements.iter().sum::<f64>() / SUBSAMPLES as f64,
    })
}

fn group(points: &[f64], dimension: usize, options: &SweepAndPrune) -> (Vec<Option<usize>>, f64) {
    let width = match options.width {
        Width::Fixed(width) => width,
        Width::Automatic => automatic_width(points, dimension),
    };
    let all: Vec<Option<usize>> = sweep(points, dimension, width)
        .into_iter()
        .map(Some)
        .collect();
    let sizes = cluster_sizes(&all);
    let large = |l: &Option<usize>| l.filter(|l| sizes[*l] >= options.min_cluster_size);
    let kept: Vec<Option<usize>> = all.iter().map(large).collect();
    (renumbered(&kept), width)
}

/// Connected components of overlapping boxes, by a sweep along the first axis.
fn sweep(points: &[f64], dimension: usize, width: f64) -> Vec<usize> {
    let at = |i: usize| &points[i * dimension..(i + 1) * dimension];
    let mut order: Vec<usize> = (0..points.len() / dimension).collect();
    order.sort_by(|&a, &b| at(a)[0].total_cmp(&at(b)[0]));
    let mut sets = UnionFind::new(order.len());
    // The boxes still open are those from `open` to the newest.
    let mut open = 0;
    for (newest, &i) in order.iter().enumerate() {
        while at(i)[0] - at(order[open])[0] > width {
            open += 1;
        }
        for &j in &order[open..newest] {
            if chebyshev(at(i), at(j)) <= width {
                sets.join(i, j);
            }
        }
    }
    sets.labels()
}

/// The geometric middle of the largest gap between successive edge lengths of the minimum spanning tree.
fn automatic_width(points: &[f64], dimension: usize) -> f64 {
    let mut edges = spanning_edges(points, dimension);
    edges.sort_unstable_by(f64::total_cmp);
    let Some(&longest) = edges.last() else {
        return 0.0;
    };
    // Points that coincide have edges of length zero, whose logarithm is no length's.
    let least = (1e-12 * longest).max(f64::MIN_POSITIVE);
    let logs: Vec<f64> = edges.iter().map(|e| e.max(least).ln()).collect();
    let place = |share: f64| (share * (logs.len() - 1) as f64).floor() as usize;
    let gap = |i: &usize| logs[i + 1] - logs[*i];
    // The last edge inside the band has its gap to the next one counted too: few points have few edges.
    let last = place(GAP_TO).min(logs.len().saturating_sub(2));
    let widest = (place(GAP_FROM)..=last).max_by(|a, b| gap(a).total_cmp(&gap(b)).then(b.cmp(a)));
    match widest {
        Some(i) if i + 1 < logs.len() => (0.5 * (logs[i] + logs[i + 1])).exp(),
        _ => longest,
    }
}

/// Edge lengths of the minimum spanning tree under the Chebyshev metric (Prim).
fn spanning_edges(points: &[f64], dimension: usize) -> Vec<f64> {
    let len = points.len() / dimension;
    let at = |i: usize| &points[i * dimension..(i + 1) * dimension];
    let mut open: Vec<(usize, f64)> = (1..len).map(|i| (i, f64::INFINITY)).collect();
    let mut edges = Vec::with_capacity(open.len());
    let mut reached = 0;
    while !open.is_empty() {
        let mut nearest = 0;
        for k in 0..open.len() {
            let d = chebyshev(at(reached), at(open[k].0));
            open[k].1 = open[k].1.min(d);
            if open[k].1 < open[nearest].1 {
                nearest = k;
            }
        }
        let (item, length) = open.swap_remove(nearest);
        edges.push(length);
        reached = item;
    }
    edges
}

fn chebyshev(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |most, (x, y)| f64::max(most, (x - y).abs()))
}
