//! Kinematic centroid segmentation: a limb as a pendulum, a segment one swing (Jenkins and Mataric 2003).
//!
//! The bob is the limb's centroid (the mean place of its joints) in the frame of the limb's parent. A swing
//! ends where the bob is farthest from where the swing began. Pauses are taken out first: a hold is never
//! the end of a swing to the eye of the distance, which just stands still there and goes on growing.
//!
//! By default all limbs' centroids are stacked into one bob ([`segment`] on one [`Limb`]); cutting limb by
//! limb and merging the cuts, as published, is [`segment`] on several.

use super::signal::{Frames, Signal, above_zero, at_least, derivative, moving_average, runs};
use super::spans::{Span, covering};
use crate::error::{Error, Result};

/// A bob and the length of its pendulum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limb<'a> {
    /// The bob's place, in the units of `length`; several stacked limbs have several places in one frame.
    pub bob: Signal<'a>,
    /// Length of the limb, above 0; of stacked limbs their mean length.
    pub length: f64,
}

/// Settings of the pendulum segmenter; lengths are in limb lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pendulum {
    /// The least distance from its start at which a swing may end.
    pub min_swing: f64,
    /// How far the distance must fall for its maximum to be one: at least this,
    pub fall: f64,
    /// and at least this share of the maximum, in [0, 1).
    pub fall_share: f64,
    /// The shortest swing, seconds: of the cuts at its ends the one with less swing is dropped.
    pub min_secs: f64,
    /// Cuts of several limbs that lie so near (seconds) become one.
    pub merge_secs: f64,
    /// A bob slower than this (limb lengths a second) ...
    pub rest_speed: f64,
    /// ... for so long (seconds) is at rest.
    pub rest_secs: f64,
    /// What moves less than this between two rests counts as rest.
    pub rest_swing: f64,
    /// The window over which places are averaged, seconds; 0.075 passes about 6 Hz.
    pub smooth_secs: f64,
}

impl Default for Pendulum {
    fn default() -> Self {
        Self {
            min_swing: 0.1,
            fall: 0.01,
            fall_share: 0.05,
            min_secs: 0.15,
            merge_secs: 0.1,
            rest_speed: 0.25,
            rest_secs: 0.25,
            rest_swing: 0.1,
            smooth_secs: 0.075,
        }
    }
}

/// The end of a swing that is the beginning of the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The frame: the middle, where the distance stays at its maximum for some frames.
    pub frame: usize,
    /// The same to a fraction of a frame.
    pub time_frames: f64,
    /// The distance from the swing's start, in limb lengths: how much the cut is to be trusted.
    pub swing: f64,
    /// The limb that swung, an index; of merged cuts the one with the greatest swing.
    pub limb: usize,
}

/// Swings, and the rests between them; together they cover the recording.
///
/// With one limb, the swings of that bob. With several, a swing ends where any limb's does (cuts nearer than
/// `merge_secs` are one), and only a rest of all limbs is a rest.
///
/// # Errors
/// Without limbs, with limbs of different frames or rates, with a length that is not positive, or a setting out
/// of range.
pub fn segment(limbs: &[Limb], config: &Pendulum) -> Result<Vec<Span>> {
    let (pieces, cuts) = pieces_and_cuts(limbs, config)?;
    let mut swings = Vec::with_capacity(pieces.len() + cuts.len());
    for (start, end) in pieces {
        let inside = |c: &&Cut| c.frame > start && c.frame < end;
        let mut last = start;
        for cut in cuts.iter().filter(inside) {
            swings.push((last, cut.frame));
            last = cut.frame;
        }
        swings.push((last, end));
    }
    Ok(covering(&swings, limbs[0].bob.frames()))
}

/// The ends of swings inside movements, in order; the borders of rests are not among them.
///
/// # Errors
/// As for [`segment`].
pub fn cuts(limbs: &[Limb], config: &Pendulum) -> Result<Vec<Cut>> {
    Ok(pieces_and_cuts(limbs, config)?.1)
}

/// The stretches between rests, and the cuts inside them.
fn pieces_and_cuts(limbs: &[Limb], config: &Pendulum) -> Result<(Vec<Frames>, Vec<Cut>)> {
    check(limbs, config)?;
    let bob = &limbs[0].bob;
    let frames = bob.frames();
    let min = bob.frames_in(config.min_secs).max(1);
    let rest = bob.frames_in(config.rest_secs).max(1);
    let paths: Vec<Path> = limbs.iter().map(|l| Path::new(l, config)).collect();

    let all_slow: Vec<bool> = (0..frames)
        .map(|t| paths.iter().all(|p| p.slow[t]))
        .collect();
    let mut pieces = between_rests(&all_slow, rest);
    pieces.retain(|&(start, end)| {
        let swings = |p: &Path| p.reach(start, end) >= config.rest_swing;
        end - start >= min && paths.iter().any(swings)
    });

    let mut found: Vec<Cut> = Vec::new();
    for (limb, path) in paths.iter().enumerate() {
        // A limb that pauses while others move begins anew after its pause.
        for (start, end) in between_rests(&path.slow, rest) {
            let mut cuts = path.swings(start, end, limb, config);
            drop_short(&mut cuts, start, end, min);
            found.extend(cuts);
        }
    }
    let merged = merge(found, bob.frames_in(config.merge_secs));
    let mut cuts = Vec::with_capacity(merged.len());
    for &(start, end) in &pieces {
        let inside = |c: &Cut| c.frame > start && c.frame < end;
        let mut own: Vec<Cut> = merged.iter().copied().filter(inside).collect();
        drop_short(&mut own, start, end, min);
        cuts.extend(own);
    }
    Ok((pieces, cuts))
}

/// A bob's smoothed path in limb lengths.
struct Path {
    places: Vec<f64>,
    dims: usize,
    /// Frames in which it is slower than a rest allows.
    slow: Vec<bool>,
}

impl Path {
    fn new(limb: &Limb, config: &Pendulum) -> Self {
        let (bob, dims) = (&limb.bob, limb.bob.dims());
        let half = bob.half_window(config.smooth_secs);
        let slow = derivative(bob, half)
            .chunks_exact(dims)
            .map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt() < config.rest_speed * limb.length)
            .collect();
        let mut places = moving_average(bob.values(), dims, half);
        for v in &mut places {
            *v /= limb.length;
        }
        Self { places, dims, slow }
    }

    fn distance(&self, s: usize, t: usize) -> f64 {
        let at = |t: usize| &self.places[t * self.dims..(t + 1) * self.dims];
        let squares: f64 = at(s)
            .iter()
            .zip(at(t))
            .map(|(a, b)| (a - b) * (a - b))
            .sum();
        squares.sqrt()
    }

    /// The greatest distance from the first frame.
    fn reach(&self, start: usize, end: usize) -> f64 {
        (start..end)
            .map(|t| self.distance(start, t))
            .fold(0.0, f64::max)
    }

    /// The ends of swings strictly between `start` and `end`.
    fn swings(&self, start: usize, end: usize, limb: usize, config: &Pendulum) -> Vec<Cut> {
        let mut cuts = Vec::new();
        let mut s = start;
        // Distances from frame s on.
        let mut distances = vec![0.0];
        let mut best = 0;
        while s + distances.len() < end {
            let d = self.distance(s, s + distances.len());
            distances.push(d);
            let highest = distances[best];
            let fall = config.fall.max(config.fall_share * highest);
            if d > highest {
                best = distances.len() - 1;
            } else if highest >= config.min_swing && d <= highest - fall {
                let middle = middle_of_maximum(&distances, best, 0.1 * fall);
                let offset = (middle.round() as usize).clamp(1, distances.len() - 1);
                cuts.push(Cut {
                    frame: s + offset,
                    time_frames: s as f64 + middle,
                    swing: highest,
                    limb,
                });
                s += offset;
                distances.truncate(1);
                best = 0;
            }
        }
        // What is left belongs to the last swing unless it is one itself.
        if distances[best] < config.min_swing {
            cuts.pop();
        }
        cuts
    }
}

/// The middle of the stretch around `best` in which the distance stays within `tolerance` of it, in frames.
///
/// Its ends lie where straight lines between frames cross that level, so a plateau is cut in its middle and a
/// round maximum is found to a fraction of a frame. `best` must have lower distances on both sides.
fn middle_of_maximum(distances: &[f64], best: usize, tolerance: f64) -> f64 {
    let level = distances[best] - tolerance;
    let low = |d: &f64| *d < level;
    let before = distances[..best].iter().rposition(low).unwrap_or(0);
    let after = distances[best..]
        .iter()
        .position(low)
        .map_or(best, |k| best + k);
    let share = |outside: f64, inside: f64| (level - outside) / (inside - outside);
    let rise = before as f64 + share(distances[before], distances[before + 1]);
    let fall = after as f64 - share(distances[after], distances[after - 1]);
    0.5 * (rise + fall)
}

/// The stretches of frames outside of rests: runs of slow frames of at least `rest` frames.
fn between_rests(slow: &[bool], rest: usize) -> Vec<Frames> {
    let mut moving = vec![true; slow.len()];
    for (start, end) in runs(slow) {
        if end - start >= rest {
            moving[start..end].fill(false);
        }
    }
    runs(&moving)
}

/// Drops cuts until no piece of `start..end` is shorter than `min` frames: at the shortest the lesser cut.
fn drop_short(cuts: &mut Vec<Cut>, start: usize, end: usize, min: usize) {
    while !cuts.is_empty() {
        let frame = |k: usize| match k {
            0 => start,
            k => cuts.get(k - 1).map_or(end, |c| c.frame),
        };
        let length = |k: &usize| frame(k + 1).saturating_sub(frame(*k));
        let shortest = (0..=cuts.len()).min_by_key(length).unwrap_or(0);
        if length(&shortest) >= min {
            return;
        }
        // Piece k lies between cuts k - 1 and k.
        let drop = match shortest {
            0 => 0,
            k if k == cuts.len() => k - 1,
            k if cuts[k].swing < cuts[k - 1].swing => k,
            k => k - 1,
        };
        cuts.remove(drop);
    }
}

/// Cuts of several limbs as one list: those within `near` frames of the first of them become one, at their mean
/// weighted by swing.
fn merge(mut cuts: Vec<Cut>, near: usize) -> Vec<Cut> {
    cuts.sort_by_key(|c| (c.frame, c.limb));
    let mut out = Vec::with_capacity(cuts.len());
    let mut rest = &cuts[..];
    while let Some(first) = rest.first() {
        let count = rest.partition_point(|c| c.frame - first.frame <= near);
        let (group, after) = rest.split_at(count);
        let strongest = group
            .iter()
            .fold(first, |a, b| if b.swing > a.swing { b } else { a });
        let weight: f64 = group.iter().map(|c| c.swing).sum();
        let mean =
            |value: fn(&Cut) -> f64| group.iter().map(|c| c.swing * value(c)).sum::<f64>() / weight;
        out.push(match group {
            [only] => *only,
            _ => Cut {
                frame: mean(|c| c.frame as f64).round() as usize,
                time_frames: mean(|c| c.time_frames),
                ..*strongest
            },
        });
        rest = after;
    }
    out
}

fn check(limbs: &[Limb], config: &Pendulum) -> Result<()> {
    let Some(first) = limbs.first() else {
        return Err(Error::invalid("the pendulum segmenter needs a limb"));
    };
    for limb in limbs {
        above_zero("the length of a limb", limb.length)?;
        let (a, b) = (&first.bob, &limb.bob);
        if a.frames() != b.frames() || a.rate_hz() != b.rate_hz() {
            return Err(Error::invalid(format!(
                "limbs need the same frames, found {} at {} Hz and {} at {} Hz",
                a.frames(),
                a.rate_hz(),
                b.frames(),
                b.rate_hz()
            )));
        }
    }
    above_zero("min_swing", config.min_swing)?;
    above_zero("fall", config.fall)?;
    at_least("fall_share", config.fall_share, 0.0)?;
    if config.fall_share >= 1.0 {
        return Err(Error::invalid(format!(
            "fall_share must lie below 1, found {}",
            config.fall_share
        )));
    }
    at_least("min_secs", config.min_secs, 0.0)?;
    at_least("merge_secs", config.merge_secs, 0.0)?;
    at_least("rest_speed", config.rest_speed, 0.0)?;
    at_least("rest_secs", config.rest_secs, 0.0)?;
    at_least("rest_swing", config.rest_swing, 0.0)?;
    at_least("smooth_secs", config.smooth_secs, 0.0)
}
