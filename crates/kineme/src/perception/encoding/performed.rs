//! What of a recording is the movement: not how a hand came to its place, nor how it left it.
//!
//! A recording of a wave begins with raising the hand and ends with lowering it, which taken by itself is another
//! movement. The rule is of kinematics alone: a hand that hangs before or after has a place of rest, and what it does far
//! from there is what was performed. Of a movement that is nothing but way there and back, its far part is left; of one
//! that goes to and fro, what lies between its first and its last turning point: the stroke of a gesture, without its
//! preparation and its retraction (Kendon 1980).

use std::ops::Range;

use nalgebra::Vector3;

use super::paths::EffectorPaths;
use crate::error::{Error, Result};

/// A hand so far below the shoulders hangs, in reaches.
const HANGING: f64 = 0.45;
/// From this share of the greatest distance from rest on, a hand is at what it performs.
const FAR_SHARE: f64 = 0.7;
/// A turning point is left again by the way it was come to, for so far at least, in reaches.
const TURN: f64 = 0.08;
/// The cosine between coming and going, below which a path turns back.
const BACK: f64 = -0.3;
/// A hand moves if its path is at least this share of the longest one's.
const MOVING_SHARE: f64 = 0.5;
/// Width over which paths are smoothed before they are measured, seconds.
const SMOOTH_SECS: f64 = 0.05;
/// How many standard deviations of the mean are looked at.
const WIDTHS: f64 = 3.0;

impl EffectorPaths {
    /// The frames from `range`.
    ///
    /// # Errors
    /// When the range is empty or reaches beyond the end.
    pub fn slice(&self, range: Range<usize>) -> Result<Self> {
        if range.is_empty() || range.end > self.frames() {
            return Err(Error::invalid(format!(
                "frames {} to {} of {}",
                range.start,
                range.end,
                self.frames()
            )));
        }
        let points = range.flat_map(|f| self.at(f).to_vec()).collect();
        Self::new(self.rate_hz(), self.effectors().to_vec(), points)
    }

    /// Some of the effectors, in the order given.
    ///
    /// # Errors
    /// When there is no such effector, or none is given.
    pub fn only(&self, effectors: &[&str]) -> Result<Self> {
        let known = || self.effectors().iter().map(String::as_str);
        let places = effectors
            .iter()
            .map(|name| {
                let place = known().position(|e| e == *name);
                place.ok_or_else(|| Error::unknown_name("effector", name, known()))
            })
            .collect::<Result<Vec<_>>>()?;
        let points = (0..self.frames())
            .flat_map(|f| places.iter().map(move |&e| self.at(f)[e]))
            .collect();
        let names = effectors.iter().map(|e| (*e).to_string()).collect();
        Self::new(self.rate_hz(), names, points)
    }

    /// The mirror image: left and right change their names, their order stays.
    ///
    /// # Errors
    /// When an effector lacks its other side.
    pub fn mirrored(&self) -> Result<Self> {
        let other = |name: &String| match name.split_once('_') {
            Some(("left", part)) => format!("right_{part}"),
            Some(("right", part)) => format!("left_{part}"),
            _ => name.clone(),
        };
        let names: Vec<String> = self.effectors().iter().map(other).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let swapped = self.only(&names)?;
        let flip = |p: &Vector3<f64>| Vector3::new(p.x, -p.y, p.z);
        let points = (0..self.frames())
            .flat_map(|f| swapped.at(f).iter().map(|p| p.as_ref().map(flip)))
            .collect();
        Self::new(self.rate_hz(), self.effectors().to_vec(), points)
    }

    /// How long the path of each effector is, smoothed over a twentieth of a second, metres.
    pub fn lengths_m(&self) -> Vec<f64> {
        (0..self.effectors().len())
            .map(|e| {
                let path = self.smoothed(e);
                let steps = path.windows(2);
                steps.map(|w| (w[1] - w[0]).norm()).sum()
            })
            .collect()
    }

    /// Which effectors move: those with at least half as long a path as the one that moves most.
    pub fn moving(&self) -> Vec<bool> {
        let lengths = self.lengths_m();
        let most = lengths.iter().copied().fold(0.0, f64::max);
        let moves = |l: &f64| *l > 0.0 && *l >= MOVING_SHARE * most;
        lengths.iter().map(moves).collect()
    }

    /// The frames in which an effector (an index) performs: in which it goes to and fro ([`Self::to_and_fro`]), or else all
    /// in which it is away from rest ([`Self::away`]).
    pub fn performed(&self, effector: usize) -> Range<usize> {
        let to_and_fro = self.to_and_fro(effector);
        to_and_fro.unwrap_or_else(|| self.away(effector))
    }

    /// The frames, two at least, from the first to the last turning point of an effector (an index) while it is away from
    /// rest; `None` with fewer than two.
    pub fn to_and_fro(&self, effector: usize) -> Option<Range<usize>> {
        let points = self.turning_points(effector, self.away(effector));
        let (first, last) = (*points.first()?, *points.last()?);
        (first < last).then_some(first..last + 1)
    }

    /// The frames of a range at which an effector turns back, in order: it comes from one side and leaves to the same
    /// one, by more than 107 degrees, both ways looked at to where they are 0.08 of the reach away. Of frames on end that
    /// do, as around the end of a stroke, the middle one; so too of turning points between which it gets no farther than
    /// that, as while a hand is held. The same in space whatever the direction, and in time forward and backward but for
    /// a frame.
    pub fn turning_points(&self, effector: usize, within: Range<usize>) -> Vec<usize> {
        let path = self.smoothed(effector);
        let far = TURN * self.reach_m().unwrap_or(1.0);
        let gap = |a: usize, b: usize| path[b] - path[a];
        let mut points = Vec::new();
        let mut first: Option<usize> = None;
        let end = within.end.min(path.len());
        for here in within.start..end {
            let before = (0..here).rev().find(|&e| gap(e, here).norm() >= far);
            let after = (here + 1..path.len()).find(|&g| gap(here, g).norm() >= far);
            let back = before.zip(after).is_some_and(|(before, after)| {
                let (come, gone) = (gap(before, here), gap(here, after));
                come.dot(&gone) < BACK * come.norm() * gone.norm()
            });
            if back {
                first = first.or(Some(here));
            } else {
                points.extend(first.take().map(|first| (first + here - 1) / 2));
            }
        }
        points.extend(first.map(|first| (first + end - 1) / 2));
        // A hand that is held trembles: without a way between them these are one turning point.
        let stays = |a: &usize, b: &usize| {
            let off = |f: usize| gap(*a, f).norm().max(gap(f, *b).norm());
            (*a..=*b).all(|f| off(f) < far)
        };
        let held = points.chunk_by(stays);
        held.map(|h| (h[0] + h[h.len() - 1]) / 2).collect()
    }

    /// The frames, two at least where there are, in which an effector (an index) is away from rest: from the first to the
    /// last one at which it is farther from where it hung, before and after, than 0.7 of the greatest such distance. What
    /// begins (ends) with a hand that does not hang, 0.45 of the reach below the shoulders, begins (ends) with the
    /// movement. All frames where nothing was seen of it.
    pub fn away(&self, effector: usize) -> Range<usize> {
        let all = 0..self.frames();
        let path = self.smoothed(effector);
        let reach = self.reach_m().unwrap_or(1.0);
        let (Some(first), Some(last)) = (path.first(), path.last()) else {
            return all;
        };
        let hangs = |p: &&Vector3<f64>| p.z < -HANGING * reach;
        let rests: Vec<&Vector3<f64>> = [first, last].into_iter().filter(hangs).collect();
        let far = |p: &Vector3<f64>| {
            let gaps = rests.iter().map(|r| (p - **r).norm());
            gaps.reduce(f64::min)
        };
        let Some(distances) = path.iter().map(far).collect::<Option<Vec<f64>>>() else {
            return all;
        };
        let least = FAR_SHARE * distances.iter().copied().fold(0.0, f64::max);
        let away = |d: &f64| *d >= least;
        let start = distances.iter().position(away).filter(|_| hangs(&first));
        let end = distances.iter().rposition(away).filter(|_| hangs(&last));
        let span = start.unwrap_or(0)..end.map_or(all.end, |e| e + 1);
        // One frame has no path.
        let start = span.start.min(all.end.saturating_sub(2));
        start..span.end.max(start + 2).min(all.end)
    }

    /// The places of an effector, one a frame, smoothed; gaps are bridged by what is near. Empty where nothing was seen.
    ///
    /// The mean is Gaussian with a standard deviation of 0.05 s.
    pub fn smoothed(&self, effector: usize) -> Vec<Vector3<f64>> {
        let mut seen: Option<Vector3<f64>> = (0..self.frames()).find_map(|f| self.at(f)[effector]);
        let held: Vec<Vector3<f64>> = (0..self.frames())
            .filter_map(|f| {
                seen = self.at(f)[effector].or(seen);
                seen
            })
            .collect();
        let width = SMOOTH_SECS * self.rate_hz();
        let span = (WIDTHS * width).floor() as usize;
        let kernel: Vec<f64> = (0..=span)
            .map(|d| (-0.5 * (d as f64 / width).powi(2)).exp())
            .collect();
        (0..held.len())
            .map(|f| {
                let window = f.saturating_sub(span)..(f + span + 1).min(held.len());
                let weight = |g: usize| kernel[g.abs_diff(f)];
                let sum: Vector3<f64> = window.clone().map(|g| weight(g) * held[g]).sum();
                sum / window.map(weight).sum::<f64>()
            })
            .collect()
    }
}
