//! Rows: the movements that an encoder knows, sampled in time. A hypothesis is a row and a cell of it.

use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::paths::EffectorPaths;
use super::settings::{EncodingSettings, REACH_UNITS};
use crate::error::Result;
use crate::motion::Motion;
use crate::primitive::{Primitive, Sample, Vocabulary};
use crate::skeleton::Root;

/// Phases at which the clock of a row is read.
const TICKS: usize = 128;
/// Cells that a row may have, which bounds the memory: half an hour at the default settings.
const MOST_CELLS: usize = 1 << 16;

/// One movement that is known, over time: a registered exemplar.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// Its primitive, an index into the vocabulary.
    pub primitive: usize,
    /// The exemplar of the primitive.
    pub exemplar: usize,
    /// Whether the last cell joins the first.
    pub cyclic: bool,
    /// Phase of the primitive at each cell; does not decrease.
    pub phases: Vec<f64>,
    /// Metres on the vocabulary's body that are a unit.
    pub unit_m: f64,
    /// Effectors over time in units, `[effector][axis][cell]`, each track padded beyond its end.
    tracks: Vec<f32>,
    padded: usize,
}

impl Row {
    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.phases.len()
    }

    /// The cell `ahead` cells further: held at the end, wrapped in a cycle.
    pub fn after(&self, cell: usize, ahead: usize) -> usize {
        match self.cyclic {
            true => (cell + ahead) % self.cells(),
            false => (cell + ahead).min(self.cells() - 1),
        }
    }

    /// How much of the row lies before a cell, in [0, 1]; a cycle has no beginning.
    pub fn share(&self, cell: usize) -> f64 {
        match self.cyclic {
            true => 0.0,
            false => cell as f64 / (self.cells() - 1).max(1) as f64,
        }
    }

    /// How much of the row is left after a cell, in [0, 1]; nothing of a cycle.
    pub fn missing(&self, cell: usize) -> f64 {
        match self.cyclic {
            true => 0.0,
            false => 1.0 - self.share(cell),
        }
    }

    /// The phase at a place between cells.
    pub fn phase(&self, place: f64) -> f64 {
        let n = self.cells();
        let at = place.floor();
        let (a, b) = (self.after(0, at as usize), self.after(0, at as usize + 1));
        let (low, mut high) = (self.phases[a], self.phases[b]);
        if self.cyclic && high < low {
            high += 1.0;
        }
        let phase = low + (place - at) * (high - low);
        if self.cyclic && n > 1 {
            phase.rem_euclid(1.0)
        } else {
            phase.min(1.0)
        }
    }

    /// One coordinate of an effector, cell by cell and on beyond the end.
    pub fn track(&self, effector: usize, axis: usize) -> &[f32] {
        let first = (3 * effector + axis) * self.padded;
        &self.tracks[first..first + self.padded]
    }
}

/// The rows of a vocabulary's exemplars, those of a primitive in order; where there are more than may be, an even choice
/// of each primitive's.
pub(super) fn rows(vocabulary: &Vocabulary, settings: &EncodingSettings) -> Result<Vec<Row>> {
    let primitives = vocabulary.primitives();
    let all: usize = primitives.iter().map(|p| p.exemplars().len()).sum();
    let mut wanted: Vec<(usize, usize)> = Vec::new();
    for (p, primitive) in primitives.iter().enumerate() {
        let own = primitive.exemplars().len();
        let kept = match all <= settings.most_rows {
            true => own,
            false => (own * settings.most_rows / all).max(1),
        };
        wanted.extend((0..kept).map(|k| (p, k * own / kept)));
    }
    wanted
        .par_iter()
        .map(|&(p, e)| Row::of(&primitives[p], (p, e), settings))
        .collect()
}

impl Row {
    /// A row of given places, for tests.
    #[cfg(test)]
    pub fn made(
        cyclic: bool,
        cells: usize,
        effectors: usize,
        settings: &EncodingSettings,
        place: impl Fn(usize, usize) -> Vector3<f64>,
    ) -> Self {
        let padded = cells + settings.padding();
        Self {
            primitive: 0,
            exemplar: 0,
            cyclic,
            phases: (0..cells).map(|c| c as f64 / cells as f64).collect(),
            unit_m: 1.0,
            tracks: tracks(cyclic, cells, effectors, padded, place),
            padded,
        }
    }

    fn of(
        primitive: &Primitive,
        (index, exemplar): (usize, usize),
        settings: &EncodingSettings,
    ) -> Result<Self> {
        let cyclic = primitive.is_cyclic();
        let phases = phases(primitive, exemplar, settings.cell_secs());
        let motion = performed(primitive, exemplar, &phases, settings.cell_secs())?;
        let paths = EffectorPaths::of_motion(&motion, &settings.effectors, settings.heading_secs)?;
        let unit_m = paths.reach_m().unwrap_or(1.0) / REACH_UNITS;
        let padded = phases.len() + settings.padding();
        // Forward kinematics sees every effector.
        let place = |c: usize, e: usize| paths.at(c)[e].unwrap_or_default() / unit_m;
        let tracks = tracks(
            cyclic,
            phases.len(),
            settings.effectors.len(),
            padded,
            place,
        );
        Ok(Self {
            primitive: index,
            exemplar,
            cyclic,
            phases,
            unit_m,
            tracks,
            padded,
        })
    }
}

/// Places (in units, of a cell and an effector) as tracks, held or repeated beyond the end.
fn tracks(
    cyclic: bool,
    count: usize,
    effectors: usize,
    padded: usize,
    place: impl Fn(usize, usize) -> Vector3<f64>,
) -> Vec<f32> {
    let mut tracks = Vec::with_capacity(3 * effectors * padded);
    for effector in 0..effectors {
        for axis in 0..3 {
            tracks.extend((0..padded).map(|c| {
                let c = if cyclic { c % count } else { c.min(count - 1) };
                place(c, effector)[axis] as f32
            }));
        }
    }
    tracks
}

/// The phases of a registered exemplar at even times, from 0 on; of a cycle, one round without its end.
fn phases(primitive: &Primitive, exemplar: usize, step_secs: f64) -> Vec<f64> {
    let pace = |k: usize| {
        let phase = k as f64 / TICKS as f64;
        // Just short of the end, where a cycle would wrap.
        primitive
            .registered(exemplar, phase.min(1.0 - 1e-9))
            .secs_per_phase
    };
    let mut clock = Vec::with_capacity(TICKS + 1);
    let mut secs = 0.0;
    let mut before = pace(0);
    clock.push(secs);
    for k in 1..=TICKS {
        let here = pace(k);
        secs += 0.5 * (before + here) / TICKS as f64;
        clock.push(secs);
        before = here;
    }
    let count = ((secs / step_secs).round() as usize).clamp(1, MOST_CELLS);
    let count = count + usize::from(!primitive.is_cyclic());
    (0..count)
        .map(|c| {
            let at = (c as f64 * step_secs).min(secs);
            let k = clock.partition_point(|&s| s <= at).clamp(1, TICKS);
            let share = (at - clock[k - 1]) / (clock[k] - clock[k - 1]).max(1e-12);
            ((k - 1) as f64 + share.min(1.0)) / TICKS as f64
        })
        .collect()
}

/// The motion of a registered exemplar at these phases, travelling as it does.
pub(super) fn performed(
    primitive: &Primitive,
    exemplar: usize,
    phases: &[f64],
    step_secs: f64,
) -> Result<Motion> {
    let mut poses = Vec::with_capacity(phases.len() * primitive.body().dof());
    let mut roots = Vec::with_capacity(phases.len());
    let mut root = Root::ORIGIN;
    for &phase in phases {
        let sample = primitive.registered(exemplar, phase);
        root = moved(&root, &sample, step_secs);
        poses.extend_from_slice(&sample.pose);
        roots.push(root);
    }
    Motion::new(
        primitive.name(),
        Arc::clone(primitive.body()),
        1.0 / step_secs,
        poses,
        roots,
    )
}

/// The root after travelling as a sample says.
pub(super) fn moved(root: &Root, sample: &Sample, secs: f64) -> Root {
    let (sine, cosine) = root.yaw.sin_cos();
    let travel = &sample.travel;
    let mut position = root.position;
    position.x += secs * (cosine * travel.forward - sine * travel.left);
    position.y += secs * (sine * travel.forward + cosine * travel.left);
    position.z = travel.height;
    Root {
        position,
        yaw: root.yaw + secs * travel.yaw_rate,
    }
}
