//! The inverse problem: parameters that bring an effector to a point (Rose, Sloan and Cohen 2001).

use nalgebra::{DMatrix, DVector, Vector3};

use super::curve::Curve;
use super::model::Primitive;
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::skeleton::{Reach, Skeleton};

/// Phases at which the extreme is first looked for.
const PHASES: usize = 33;
/// How far from the extreme, in phase, the effector may meet its target: about a frame or two of the movement.
const NEAR_EXTREME: f64 = 0.05;
/// Places a dimension of the table of starts, none of them on the grid on which people put exemplars.
const LATTICE: usize = 8;
/// Starts that are tried while the target is missed.
const STARTS: [usize; 2] = [4, 12];
/// Steps of one start.
const STEPS: usize = 25;
/// A miss below this is none, metres.
const EXACT_M: f64 = 1e-6;
/// A miss below this needs no further starts, metres.
const GOOD_M: f64 = 1e-4;

/// The answer to a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// Parameters in [0, 1]^m, or just outside where the exemplars' hull is passed.
    pub parameters: Vec<f64>,
    /// The phase at which the effector is there.
    pub phase: f64,
    /// Where the effector is then, metres in the thorax frame.
    pub position: Vector3<f64>,
    /// How far that is from the target, metres.
    pub miss_m: f64,
}

/// One effector of one primitive, ready to be aimed: made once, asked often.
#[derive(Debug, Clone)]
pub struct Aim<'a> {
    primitive: &'a Primitive,
    chain: Reach,
    table: Vec<Start>,
}

#[derive(Debug, Clone)]
struct Start {
    parameters: Vec<f64>,
    phase: f64,
    position: Vector3<f64>,
}

impl Primitive {
    /// Prepares to aim an effector (`right_hand`, ...).
    ///
    /// # Errors
    /// When the body has no such effector.
    pub fn aim(&self, effector: &str) -> Result<Aim<'_>> {
        let chain = chain(self.body(), effector)?;
        let mut aim = Aim {
            primitive: self,
            chain,
            table: Vec::new(),
        };
        aim.table = starts(self).into_iter().map(|p| aim.start(p)).collect();
        Ok(aim)
    }
}

impl Aim<'_> {
    /// The phase at which the effector is at its extreme: farthest from where it started; in a cycle, from the middle of
    /// its path.
    ///
    /// # Errors
    /// When the parameters are not as many as the primitive has, or not finite.
    pub fn extreme(&self, p: &[f64]) -> Result<f64> {
        self.primitive.pose(p, 0.0)?;
        Ok(self.start(p.to_vec()).phase)
    }

    /// Where the effector is at f(p, τ), metres in the thorax frame.
    ///
    /// # Errors
    /// As [`Self::extreme`].
    pub fn position(&self, p: &[f64], phase: f64) -> Result<Vector3<f64>> {
        Ok(self.chain.position(&self.primitive.pose(p, phase)?))
    }

    /// The parameters at which the effector comes to `target` (metres in the thorax frame) at its extreme, and how far
    /// it misses: Levenberg's and Marquardt's method with analytic derivatives, from the nearest of a table of starts.
    pub fn at(&self, target: &Vector3<f64>) -> Reached {
        let mut order: Vec<&Start> = self.table.iter().collect();
        let far = |s: &Start| (s.position - target).norm_squared();
        order.sort_by(|a, b| far(a).total_cmp(&far(b)));
        let mut best: Option<Reached> = None;
        for (i, start) in order.into_iter().take(STARTS[1]).enumerate() {
            let enough = if i < STARTS[0] { GOOD_M } else { 10.0 * GOOD_M };
            if best.as_ref().is_some_and(|b| b.miss_m < enough) {
                break;
            }
            let found = self.descend(start, target);
            if best.as_ref().is_none_or(|b| found.miss_m < b.miss_m) {
                best = Some(found);
            }
        }
        best.expect("the table holds the exemplars at least")
    }

    /// Levenberg and Marquardt over parameters and phase. The phase stays near the extreme; where that has moved on with
    /// the parameters, the search goes on round the new one.
    fn descend(&self, start: &Start, target: &Vector3<f64>) -> Reached {
        const ROUNDS: usize = 4;
        let mut extreme = start.phase;
        let mut at = Reached {
            parameters: start.parameters.clone(),
            phase: start.phase,
            position: start.position,
            miss_m: (target - start.position).norm(),
        };
        for _ in 0..ROUNDS {
            self.improve(&mut at, target, extreme);
            extreme = self.summit(&at.parameters, extreme);
            let near = self.near(at.phase, extreme);
            if near == at.phase {
                break;
            }
            at.phase = near;
            at.position = self.place(&at.parameters, near);
            at.miss_m = (target - at.position).norm();
        }
        at
    }

    fn improve(&self, at: &mut Reached, target: &Vector3<f64>, extreme: f64) {
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            if at.miss_m < EXACT_M {
                return;
            }
            let jacobian = self.jacobian(&at.parameters, at.phase);
            let normal = jacobian.tr_mul(&jacobian);
            let gap = target - at.position;
            let right = jacobian.tr_mul(&DVector::from_column_slice(gap.as_slice()));
            let mut improved = false;
            for _ in 0..8 {
                let mut damped = normal.clone();
                for d in 0..damped.nrows() {
                    damped[(d, d)] += damping * (normal[(d, d)] + 1e-6);
                }
                if let Some(step) = damped.cholesky().map(|c| c.solve(&right)) {
                    let pairs = at.parameters.iter().zip(step.iter());
                    let moved: Vec<f64> = pairs.map(|(a, b)| a + b).collect();
                    let moved = self.primitive.interpolator().clamped(&moved);
                    let phase = self.near(at.phase + step[step.len() - 1], extreme);
                    let position = self.place(&moved, phase);
                    let miss_m = (target - position).norm();
                    if miss_m < at.miss_m {
                        *at = Reached {
                            parameters: moved,
                            phase,
                            position,
                            miss_m,
                        };
                        improved = true;
                        break;
                    }
                }
                damping *= 6.0;
            }
            if !improved {
                return;
            }
            damping = (damping * 0.2).max(1e-12);
        }
    }

    /// A phase kept near the extreme; in a cycle by its distance round the circle.
    fn near(&self, phase: f64, extreme: f64) -> f64 {
        let ahead = phase - extreme;
        if self.primitive.is_cyclic() {
            let ahead = ahead - ahead.round();
            return (extreme + ahead.clamp(-NEAR_EXTREME, NEAR_EXTREME)).rem_euclid(1.0);
        }
        (extreme + ahead.clamp(-NEAR_EXTREME, NEAR_EXTREME)).clamp(0.0, 1.0)
    }

    /// The effector's derivatives by the parameters and, last, by phase: 3 x (m + 1).
    fn jacobian(&self, p: &[f64], phase: f64) -> DMatrix<f64> {
        let dof = self.chain.dof();
        let mut by_pose = vec![0.0; 3 * dof];
        let told = "parameters were checked";
        let (pose, rows) = self.primitive.pose_gradient(p, phase).expect(told);
        let slope = self.primitive.sample(p, phase).expect(told).slope;
        self.chain.jacobian(&pose, &mut by_pose);
        DMatrix::from_fn(3, p.len() + 1, |r, c| {
            let column = if c < p.len() {
                &rows[c * dof..(c + 1) * dof]
            } else {
                &slope[..]
            };
            let row = &by_pose[r * dof..(r + 1) * dof];
            row.iter().zip(column).map(|(a, b)| a * b).sum()
        })
    }

    fn place(&self, p: &[f64], phase: f64) -> Vector3<f64> {
        let pose = self
            .primitive
            .pose(p, phase)
            .expect("parameters were checked");
        self.chain.position(&pose)
    }

    fn start(&self, parameters: Vec<f64>) -> Start {
        let (phase, position) = farthest(self.primitive.is_cyclic(), |phase| {
            self.place(&parameters, phase)
        });
        Start {
            parameters,
            phase,
            position,
        }
    }

    /// The extreme near another one: the parameters have changed a little.
    fn summit(&self, p: &[f64], near: f64) -> f64 {
        let cyclic = self.primitive.is_cyclic();
        let from = origin(cyclic, |phase| self.place(p, phase));
        let span = 1.0 / (PHASES - 1) as f64;
        let height = |phase: f64| (self.place(p, wrapped(phase, cyclic)) - from).norm_squared();
        wrapped(climb(near, span, height), cyclic)
    }
}

fn wrapped(phase: f64, cyclic: bool) -> f64 {
    if cyclic {
        phase.rem_euclid(1.0)
    } else {
        phase.clamp(0.0, 1.0)
    }
}

fn chain(body: &Skeleton, effector: &str) -> Result<Reach> {
    body.reach(body.effector(effector)?)
}

/// Parameters from which aiming starts: a lattice, and the exemplars.
fn starts(primitive: &Primitive) -> Vec<Vec<f64>> {
    let dims = primitive.parameters().dims();
    let each = match dims {
        0 => 1,
        1 | 2 => LATTICE,
        3 => LATTICE / 2,
        _ => 2,
    };
    let count = each.checked_pow(dims.min(8) as u32).unwrap_or(1);
    let mut starts = Vec::with_capacity(count + primitive.exemplars().len());
    for i in 0..count {
        let mut rest = i;
        let lattice = (0..dims).map(|_| {
            let k = rest % each;
            rest /= each;
            (k as f64 + 0.5) / each as f64
        });
        let p: Vec<f64> = lattice.collect();
        starts.push(primitive.interpolator().clamped(&p));
    }
    starts.extend((0..primitive.exemplars().len()).map(|i| primitive.point(i).to_vec()));
    starts
}

/// From where the extreme is measured.
fn origin(cyclic: bool, place: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    const CORNERS: usize = 8;
    if !cyclic {
        return place(0.0);
    }
    let sum: Vector3<f64> = (0..CORNERS).map(|k| place(k as f64 / CORNERS as f64)).sum();
    sum / CORNERS as f64
}

/// The phase at which a path is farthest from its origin, and the place there.
fn farthest(cyclic: bool, place: impl Fn(f64) -> Vector3<f64>) -> (f64, Vector3<f64>) {
    let from = origin(cyclic, &place);
    let span = 1.0 / (PHASES - 1) as f64;
    let height = |phase: f64| (place(wrapped(phase, cyclic)) - from).norm_squared();
    let first = (0..PHASES)
        .map(|k| k as f64 * span)
        .max_by(|a, b| height(*a).total_cmp(&height(*b)))
        .unwrap_or(1.0);
    let phase = wrapped(climb(first, span, height), cyclic);
    (phase, place(phase))
}

/// The highest place within `span` of a phase: walk while it rises, then halve the bracket by parabolas.
fn climb(from: f64, span: f64, height: impl Fn(f64) -> f64) -> f64 {
    const TURNS: usize = 24;
    let mut middle = (from, height(from));
    let mut width = span;
    for _ in 0..TURNS {
        let (below, above) = (height(middle.0 - width), height(middle.0 + width));
        if below > middle.1 || above > middle.1 {
            middle = if above >= below {
                (middle.0 + width, above)
            } else {
                (middle.0 - width, below)
            };
            continue;
        }
        let bend = below + above - 2.0 * middle.1;
        if bend < 0.0 {
            let at = middle.0 + 0.5 * width * (below - above) / bend;
            let h = height(at);
            if h > middle.1 {
                middle = (at, h);
            }
        }
        width *= 0.1;
        if width < 1e-7 {
            break;
        }
    }
    middle.0
}

/// The extreme places of registered exemplars.
pub(super) fn extreme_places(
    body: &Skeleton,
    effector: &str,
    curves: &[Curve],
    cyclic: bool,
) -> Result<Vec<[f64; 3]>> {
    let chain = chain(body, effector)?;
    let place = |curve: &Curve| {
        let (_, place) = farthest(cyclic, |phase| {
            let mut pose = vec![0.0; body.dof()];
            curve.add(phase, 1.0, 0, &mut pose);
            chain.position(&pose)
        });
        [place.x, place.y, place.z]
    };
    Ok(curves.iter().map(place).collect())
}

/// The place of an effector at its extreme in a motion, frame by frame.
pub(super) fn extreme_of_motion(motion: &Motion, effector: &str) -> Result<[f64; 3]> {
    let chain = chain(motion.skeleton(), effector)?;
    let first = chain.position(motion.pose(0));
    let places = (0..motion.frames()).map(|f| chain.position(motion.pose(f)));
    let far = |p: &Vector3<f64>| (p - first).norm_squared();
    let place = places
        .max_by(|a, b| far(a).total_cmp(&far(b)))
        .ok_or_else(|| Error::invalid("a motion without frames"))?;
    Ok([place.x, place.y, place.z])
}
