//! What a block of the observation costs a hypothesis: how far the row's own course is from what was seen.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use super::paths::EffectorPaths;
use super::rows::Row;
use super::settings::{EncodingSettings, SAMPLES};

/// Instants of a horizon that are compared, at most.
const LOOKS: usize = 3;
/// Cells worked on together.
pub(super) const LANES: usize = 8;

type Lane = [f32; LANES];

/// What was seen of one effector at one instant of a block, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sight {
    effector: usize,
    /// Instants after the block's start.
    sample: usize,
    point: Vector3<f64>,
    /// Displacement since the block's start; `None` where the start was not seen.
    moved: Option<Vector3<f64>>,
}

/// One decision's part of the observation, with the horizon over which predictions are compared.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    /// Its length as a share of a decision: below 1 only at the end of a motion.
    pub weight: f64,
    /// Its length in instants.
    pub span: usize,
    sights: Vec<Sight>,
}

/// A sight in the units of a row.
#[derive(Debug, Clone, Copy)]
struct Scaled {
    effector: usize,
    sample: usize,
    point: [f32; 3],
    /// Displacement and its soft direction.
    moved: Option<[[f32; 3]; 2]>,
}

/// Where effectors were at even instants, metres: instants x effectors.
pub(super) type Instants = Vec<Vec<Option<Vector3<f64>>>>;

/// The instants at which paths are compared, their metres multiplied by `scale`.
pub(super) fn instants(paths: &EffectorPaths, scale: f64, settings: &EncodingSettings) -> Instants {
    let step = settings.sample_secs();
    let count = (paths.duration_secs() / step + 1e-6).floor() as usize + 1;
    (0..count)
        .map(|k| {
            let seen = paths.sample(k as f64 * step, 0.0);
            seen.into_iter().map(|p| p.map(|p| p * scale)).collect()
        })
        .collect()
}

/// The blocks of a motion: one a decision, the last one shorter where it must be.
pub(super) fn blocks(instants: &Instants, settings: &EncodingSettings) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut first = 0;
    while first + 1 < instants.len() {
        let left = instants.len() - 1 - first;
        let horizon = settings.horizon().min(left);
        blocks.push(Block::new(
            &instants[first..=first + horizon],
            SAMPLES.min(left),
        ));
        first += SAMPLES.min(left);
    }
    blocks
}

impl Block {
    /// The block that begins at the first of `instants` and lasts for `span` of them.
    pub fn new(instants: &[Vec<Option<Vector3<f64>>>], span: usize) -> Self {
        let horizon = instants.len().saturating_sub(1);
        // Neighbouring instants say much the same: every second of a horizon of six is looked at, its end among them.
        let stride = horizon.div_ceil(LOOKS).max(1);
        let mut sights = Vec::new();
        for sample in (1..=horizon).rev().step_by(stride) {
            for (effector, point) in instants[sample].iter().enumerate() {
                let Some(point) = *point else { continue };
                sights.push(Sight {
                    effector,
                    sample,
                    point,
                    moved: instants[0][effector].map(|start| point - start),
                });
            }
        }
        Self {
            weight: span as f64 / SAMPLES as f64,
            span,
            sights,
        }
    }

    /// Its length, seconds.
    pub fn secs(&self, s: &EncodingSettings) -> f64 {
        self.span as f64 * s.sample_secs()
    }

    /// How far an effector went within its length at most, metres; infinite where nothing was seen to go.
    pub fn farthest_m(&self) -> f64 {
        let within = self.sights.iter().filter(|s| s.sample <= self.span);
        let far = within.filter_map(|s| Some(s.moved?.norm()));
        far.reduce(f64::max).unwrap_or(f64::INFINITY)
    }

    /// Whether nothing was seen in it.
    pub fn is_blind(&self) -> bool {
        self.sights.is_empty()
    }

    /// What a prediction of the effectors costs (metres, at an effector and an instant after the
    /// block's start), in units of `unit_m`: the mean over what was seen.
    pub fn cost(
        &self,
        unit_m: f64,
        s: &EncodingSettings,
        at: impl Fn(usize, usize) -> Vector3<f64>,
    ) -> f64 {
        let soft = |v: &Vector3<f64>| v / (v.norm() + s.softness);
        let mut sum = 0.0;
        for sight in &self.sights {
            let gap = (sight.point - at(sight.effector, sight.sample)) / unit_m;
            sum += s.position * gap.norm();
            if let Some(moved) = sight.moved {
                let predicted = at(sight.effector, sight.sample) - at(sight.effector, 0);
                let (seen, predicted) = (moved / unit_m, predicted / unit_m);
                sum += s.displacement * (seen - predicted).norm();
                sum += s.direction * (soft(&seen) - soft(&predicted)).norm();
            }
        }
        sum / self.sights.len().max(1) as f64
    }

    /// What the cells of a row cost at each pace, `unit_m` of the observation being a unit of the row: a whole number of [`LANES`] a pace, the first of them for the first of
    /// `cells`. Lanes beyond the cells mean nothing.
    pub fn costs(
        &self,
        row: &Row,
        cells: std::ops::Range<usize>,
        unit_m: f64,
        s: &EncodingSettings,
        out: &mut Vec<f32>,
    ) {
        let single = |v: Vector3<f64>| [v.x as f32, v.y as f32, v.z as f32];
        let sights = self.sights.iter().map(|sight| Scaled {
            effector: sight.effector,
            sample: sight.sample,
            point: single(sight.point / unit_m),
            moved: sight.moved.map(|moved| {
                let moved = moved / unit_m;
                [single(moved), single(moved / (moved.norm() + s.softness))]
            }),
        });
        let sights: Vec<Scaled> = sights.collect();
        let chunks = cells.len().div_ceil(LANES);
        out.clear();
        out.resize(s.rates.len() * chunks * LANES, 0.0);
        if !sights.is_empty() {
            Arch::new().dispatch(Costs {
                sights: &sights,
                row,
                first: cells.start,
                chunks,
                settings: s,
                out,
            });
        }
    }
}

/// The inner loop over all cells and paces of a row.
struct Costs<'a> {
    sights: &'a [Scaled],
    row: &'a Row,
    first: usize,
    chunks: usize,
    settings: &'a EncodingSettings,
    out: &'a mut [f32],
}

impl WithSimd for Costs<'_> {
    type Output = ();

    // Inlined into a function compiled for the machine's vector instructions; the loops vectorise there.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let s = self.settings;
        let weights = [s.position as f32, s.displacement as f32, s.direction as f32];
        let softness = s.softness as f32;
        let share = 1.0 / self.sights.len() as f32;
        for (r, &rate) in s.rates.iter().enumerate() {
            for chunk in 0..self.chunks {
                let cell = self.first + chunk * LANES;
                let mut sum: Lane = [0.0; LANES];
                for sight in self.sights {
                    let ahead = s.cells(rate, sight.sample);
                    add(sight, self.row, cell, ahead, weights, softness, &mut sum);
                }
                let at = (r * self.chunks + chunk) * LANES;
                for (out, sum) in self.out[at..at + LANES].iter_mut().zip(sum) {
                    *out = sum * share;
                }
            }
        }
    }
}

/// Adds what one sight costs [`LANES`] cells whose predictions are `ahead` cells further on.
#[inline(always)]
fn add(
    sight: &Scaled,
    row: &Row,
    cell: usize,
    ahead: f64,
    [position, displacement, direction]: [f32; 3],
    softness: f32,
    sum: &mut Lane,
) {
    let whole = ahead.floor() as usize;
    let rest = (ahead - whole as f64) as f32;
    let mut gap: Lane = [0.0; LANES];
    let mut size: Lane = [0.0; LANES];
    let mut predicted: [Lane; 3] = [[0.0; LANES]; 3];
    for (axis, predicted) in predicted.iter_mut().enumerate() {
        let track = &row.track(sight.effector, axis)[cell..];
        let (here, there) = (&track[..LANES], &track[whole..whole + LANES + 1]);
        let seen = sight.point[axis];
        for l in 0..LANES {
            let p = there[l] + rest * (there[l + 1] - there[l]);
            gap[l] += (seen - p) * (seen - p);
            let d = p - here[l];
            predicted[l] = d;
            size[l] += d * d;
        }
    }
    for l in 0..LANES {
        sum[l] += position * gap[l].sqrt();
    }
    let Some([moved, soft]) = sight.moved else {
        return;
    };
    let mut missed: Lane = [0.0; LANES];
    let mut turned: Lane = [0.0; LANES];
    for s in &mut size {
        *s = 1.0 / (s.sqrt() + softness);
    }
    for axis in 0..3 {
        for l in 0..LANES {
            let d = predicted[axis][l];
            let (m, t) = (moved[axis] - d, soft[axis] - d * size[l]);
            missed[l] += m * m;
            turned[l] += t * t;
        }
    }
    for l in 0..LANES {
        sum[l] += displacement * missed[l].sqrt() + direction * turned[l].sqrt();
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::Row;
    use super::*;

    #[test]
    fn many_cells_at_once_cost_what_each_costs_alone() {
        let s = EncodingSettings::default();
        let wave = |t: f64, k: usize| {
            Vector3::new(
                (1.3 * t + k as f64).sin(),
                (0.7 * t).cos(),
                0.4 * (2.1 * t).sin(),
            )
        };
        for (cyclic, cells) in [(false, 53), (true, 31)] {
            let place = |cell: usize, e: usize| 0.5 * wave(0.07 * cell as f64, e);
            let row = Row::made(cyclic, cells, 2, &s, place);
            let instants: Vec<Vec<Option<Vector3<f64>>>> = (0..=s.horizon())
                .map(|k| {
                    (0..2)
                        .map(|e| {
                            (e == 0 || k != 2).then(|| 0.4 * wave(0.5 + 0.1 * k as f64, e + 2))
                        })
                        .collect()
                })
                .collect();
            let block = Block::new(&instants, SAMPLES);
            let mut costs = Vec::new();
            block.costs(&row, 3..cells, 0.45, &s, &mut costs);
            let width = costs.len() / s.rates.len();
            for (r, &rate) in s.rates.iter().enumerate() {
                for cell in 3..cells {
                    let at = |e: usize, sample: usize| {
                        let ahead = s.cells(rate, sample);
                        let whole = ahead.floor() as usize;
                        let (a, b) = (row.after(cell, whole), row.after(cell, whole + 1));
                        0.45 * place(a, e).lerp(&place(b, e), ahead - whole as f64)
                    };
                    let alone = block.cost(0.45, &s, at);
                    let together = f64::from(costs[r * width + cell - 3]);
                    assert!(
                        (alone - together).abs() < 1e-5,
                        "{rate} {cell}: {alone} {together}"
                    );
                }
            }
        }
    }
}
