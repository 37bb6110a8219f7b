//! The continuous form: every frame is an item, compared by the near future that follows it.

use rayon::prelude::*;

use super::components;
use super::frames::Frames;
use super::graph::{Edge, Mark, NeighbourGraph};
use super::segmented::{check_factors, nearest_distances};
use crate::error::{Error, Result};
use crate::math::distances::Neighbours;
use crate::math::statistics::{median, quantile};

/// Differences of mean squares below this share of the frames' squared extent are rounding: far above what a running
/// sum gathers between restarts, far below any movement.
const ROUNDING: f64 = 1e-12;
/// Window sums are begun afresh after this many frames, so that rounding cannot pile up.
const RESTART: usize = 256;

/// The continuous form of spatio-temporal Isomap: the K nearest nontrivial neighbours of a frame, under a distance over
/// the window of frames that follow, are its common temporal neighbours.
#[derive(Debug, Clone, PartialEq)]
pub struct Continuous {
    /// Frames compared from each one on, at least 1; about 0.25 s. Windows end with their recording.
    pub window: usize,
    /// Two neighbours of one recording are more than this many frames apart, and so are an item and its neighbours;
    /// about 0.5 s.
    pub exclusion: usize,
    /// K, at least 1.
    pub neighbours: usize,
    /// Divisor of edges between common temporal neighbours, 1 or more.
    pub c_ctn: f64,
    /// Divisor of edges between frames that follow each other, 1 or more; 1 is neutral.
    pub c_atn: f64,
    /// Whether two items must name each other to be drawn together.
    pub mutual: bool,
    /// Neighbours lie within this many median nearest distances, so that a movement seen once finds none.
    pub radius: Option<f64>,
}

impl Default for Continuous {
    /// For frames at 120 Hz.
    fn default() -> Self {
        Self::at_rate(120.0)
    }
}

impl Continuous {
    /// The defaults for frames at `rate_hz`: a window of 0.25 s, an exclusion of 0.5 s.
    pub fn at_rate(rate_hz: f64) -> Self {
        Self {
            window: ((0.25 * rate_hz).round() as usize).max(1),
            exclusion: (0.5 * rate_hz).round() as usize,
            neighbours: 3,
            c_ctn: 100.0,
            c_atn: 1.0,
            mutual: false,
            radius: Some(3.0),
        }
    }

    fn check(&self) -> Result<()> {
        if self.window == 0 || self.neighbours == 0 {
            return Err(Error::invalid(
                "a window has at least 1 frame and a neighbourhood at least 1 neighbour",
            ));
        }
        check_factors(self.c_ctn, self.c_atn, self.radius)
    }
}

/// The K nearest nontrivial neighbours of every frame: local minima of the window distance along each recording, taken
/// from the nearest on, none within the exclusion of the frame itself or of one already taken.
///
/// The window distance is the root of the mean squared frame distance over the window. O(1) for a pair beside its frame
/// distance, by a running sum along diagonals; rows in parallel; memory of `window` rows a thread.
///
/// # Errors
/// Without a window or neighbours to look for.
pub fn nontrivial_neighbours(frames: &Frames, options: &Continuous) -> Result<Neighbours> {
    options.check()?;
    Ok(search(frames, options)?.0)
}

impl NeighbourGraph {
    /// The graph of frames: each joined with the next of its recording and with its nontrivial neighbours, which are
    /// its common temporal neighbours.
    ///
    /// # Errors
    /// Without a window or neighbours to look for, or with factors below 1.
    pub fn continuous(frames: &Frames, options: &Continuous) -> Result<Self> {
        options.check()?;
        let (near, bridges) = search(frames, options)?;
        let next_in_recording =
            |x: usize| frames.starts.binary_search(&(x + 1)).err().map(|_| x + 1);
        let mut marks: Vec<Mark> = (0..frames.len())
            .flat_map(|x| near.of(x).iter().map(move |&(y, d)| (x, y, d)))
            .map(|(x, y, distance)| Mark {
                from: x,
                to: y,
                distance,
                common: true,
                adjacent: next_in_recording(x.min(y)) == Some(x.max(y)),
            })
            .collect();
        for (start, end) in frames.recordings() {
            for x in start..end - 1 {
                marks.push(Mark {
                    from: x,
                    to: x + 1,
                    distance: step(frames, x, options.window.min(end - x - 1)),
                    common: false,
                    adjacent: true,
                });
            }
        }
        let (c_ctn, c_atn) = (options.c_ctn, options.c_atn);
        let mut graph = Self::from_marks(frames.len(), marks, c_ctn, c_atn, options.mutual);
        graph.novelty = quantile(&nearest_distances(&near), 0.99).unwrap_or(f64::INFINITY);
        graph.bridges = components::bridges_of_edges(bridges, &graph.labels);
        Ok(graph)
    }
}

/// The window distance of a frame and the next, over `window` frames.
fn step(frames: &Frames, x: usize, window: usize) -> f64 {
    let mut sum = 0.0;
    let mut square = [0.0];
    for k in x..x + window {
        frames.squares(k, k + 1..k + 2, &mut square);
        sum += square[0];
    }
    (sum / window as f64).sqrt()
}

/// Nontrivial neighbours of all frames, and the nearest pair of every two recordings.
fn search(frames: &Frames, options: &Continuous) -> Result<(Neighbours, Vec<Edge>)> {
    let blocks: Vec<(usize, usize, usize)> = frames
        .recordings()
        .flat_map(|(start, end)| {
            let starts = (start..end).step_by(RESTART);
            starts.map(move |first| (first, (first + RESTART).min(end), end))
        })
        .collect();
    let (lists, bridges): (Vec<_>, Vec<_>) = blocks
        .into_par_iter()
        .map(|(first, last, end)| search_block(frames, options, first..last, end))
        .unzip();
    let mut lists: Vec<Vec<(usize, f64)>> = lists.into_iter().flatten().collect();
    let bridges = bridges.into_iter().flatten().collect();
    if let Some(radius) = options.radius {
        let nearest: Vec<f64> = lists
            .iter()
            .filter_map(|l| l.first().map(|n| n.1))
            .collect();
        let within = radius * median(&nearest).unwrap_or(0.0);
        for list in &mut lists {
            list.retain(|(_, d)| *d <= within);
        }
    }
    Ok((Neighbours::new(lists)?, bridges))
}

/// The rows `rows` of one recording, which ends at `end`, from the last row backwards: a window's sum is that of the
/// next diagonal place, plus the frame that enters, minus the frame that leaves.
fn search_block(
    frames: &Frames,
    options: &Continuous,
    rows: std::ops::Range<usize>,
    end: usize,
) -> (Vec<Vec<(usize, f64)>>, Vec<Edge>) {
    let len = frames.len();
    let window = options.window.min(len);
    let mut ring = vec![vec![0.0; len]; window + 1];
    let (mut sums, mut next) = (vec![0.0; len], vec![0.0; len]);
    let mut squares = vec![0.0; len];
    let mut lists = Vec::with_capacity(rows.len());
    let mut bridges: Vec<Option<Edge>> = vec![None; frames.starts.len() - 1];
    for x in rows.clone().rev() {
        std::mem::swap(&mut sums, &mut next);
        if x + 1 == rows.end {
            first_sums(frames, &mut ring, window, x, end, &mut sums);
        } else {
            let newest = x % (window + 1);
            frames.squares(x, 0..len, &mut ring[newest]);
            let entering = &ring[newest];
            let leaving = (x + window < end).then(|| &ring[(x + window) % (window + 1)]);
            for (start, stop) in frames.recordings() {
                sums[start..stop - 1].copy_from_slice(&next[start + 1..stop]);
                sums[stop - 1] = 0.0;
                for (sum, enter) in sums[start..stop].iter_mut().zip(&entering[start..stop]) {
                    *sum += enter;
                }
                let Some(leaving) = leaving.and_then(|row| row.get(start + window..stop)) else {
                    continue;
                };
                for (sum, leave) in sums[start..stop].iter_mut().zip(leaving) {
                    *sum -= leave;
                }
            }
        }
        for (r, (start, stop)) in frames.recordings().enumerate() {
            for y in start..stop {
                let count = window.min(end - x).min(stop - y);
                squares[y] = sums[y].max(0.0) / count as f64;
            }
            if start >= end {
                let nearest = (start..stop).min_by(|&a, &b| squares[a].total_cmp(&squares[b]));
                let edge = nearest.map(|y| Edge::new(x, y, squares[y].sqrt()));
                let best = bridges[r].map_or(f64::INFINITY, |e| e.length);
                bridges[r] = edge.filter(|e| e.length < best).or(bridges[r]);
            }
        }
        lists.push(select(frames, options, &squares, x));
    }
    lists.reverse();
    (lists, bridges.into_iter().flatten().collect())
}

/// Window sums of row `x` from nothing; leaves the frame distances of its window in the ring.
fn first_sums(
    frames: &Frames,
    ring: &mut [Vec<f64>],
    window: usize,
    x: usize,
    end: usize,
    sums: &mut [f64],
) {
    sums.fill(0.0);
    for k in 0..window.min(end - x) {
        let row = &mut ring[(x + k) % (window + 1)];
        frames.squares(x + k, 0..frames.len(), row);
        for (start, stop) in frames.recordings().filter(|(start, stop)| stop - start > k) {
            for (sum, square) in sums[start..stop].iter_mut().zip(&row[start + k..stop]) {
                *sum += square;
            }
        }
    }
}

/// The nontrivial neighbours of frame `x`, from its squared window distances to all frames.
fn select(frames: &Frames, options: &Continuous, squares: &[f64], x: usize) -> Vec<(usize, f64)> {
    let mut minima: Vec<(usize, usize, f64)> = Vec::new();
    for (r, (start, stop)) in frames.recordings().enumerate() {
        let own = (start..stop).contains(&x);
        let outside = |y: &usize| !own || y.abs_diff(x) > options.exclusion;
        let found = local_minima(&squares[start..stop], ROUNDING * frames.extent);
        let places = found.into_iter().map(|i| start + i);
        minima.extend(places.filter(outside).map(|y| (r, y, squares[y].sqrt())));
    }
    minima.sort_unstable_by(|a, b| a.2.total_cmp(&b.2).then(a.1.cmp(&b.1)));
    let mut taken: Vec<(usize, usize, f64)> = Vec::with_capacity(options.neighbours);
    for (r, y, d) in minima {
        if taken.len() == options.neighbours {
            break;
        }
        let near = |t: &(usize, usize, f64)| t.0 == r && t.1.abs_diff(y) <= options.exclusion;
        if !taken.iter().any(near) {
            taken.push((r, y, d));
        }
    }
    taken.into_iter().map(|(_, y, d)| (y, d)).collect()
}

/// Where a sequence turns from falling to rising by more than `tolerance`: an even stretch counts once, at its first
/// place, and an end counts when the sequence rises from it.
fn local_minima(values: &[f64], tolerance: f64) -> Vec<usize> {
    let mut minima = Vec::new();
    let (mut falling, mut lowest, mut high) = (true, 0, f64::INFINITY);
    for (i, &value) in values.iter().enumerate() {
        if falling {
            if value < values[lowest] - tolerance {
                lowest = i;
            } else if value > values[lowest] + tolerance {
                minima.push(lowest);
                (falling, high) = (false, value);
            }
        } else if value < high - tolerance {
            (falling, lowest) = (true, i);
        } else {
            high = high.max(value);
        }
    }
    if falling {
        minima.push(lowest);
    }
    minima
}
