//! A part that several hinges turn: the angles that come nearest a wanted rotation.

use std::sync::Arc;

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

use crate::math::rotation::log;
use crate::skeleton::{JointKind, Range, Skeleton};

/// How dear (radians of rotation for each radian of angle) it is to leave the angles before: near a singularity, where
/// a tiny turn of the part would take a large one of the hinges, they go there in more than one step.
const STAYING: f64 = 0.03;
/// The same where there is nothing before: just enough to choose among equals the posture nearest neutral.
const CHOOSING: f64 = 1e-4;
/// Gauss-Newton steps at most, and the step (radians) that is no step any more.
const STEPS: usize = 40;
const STILL: f64 = 1e-10;
/// Halvings of a step that does not come nearer.
const HALVINGS: usize = 8;
/// Angles of a range from which the first search starts, as shares of it.
const STARTS: [f64; 3] = [0.2, 0.5, 0.8];

/// Consecutive hinges of a body that turn one part together.
#[derive(Debug, Clone)]
pub struct Hinges {
    /// Axes in the frame of the part before, from the body outward.
    axes: Vec<Unit<Vector3<f64>>>,
    ranges: Vec<Range>,
    /// The coordinate of each hinge in a pose.
    at: Vec<usize>,
    angles: Vec<f64>,
    /// The turn that the last search left undone, in the part's own frame.
    missed: UnitQuaternion<f64>,
    scratch: Scratch,
}

/// Working space of a search, one entry a hinge.
#[derive(Debug, Clone)]
struct Scratch {
    /// Angles from which the search started, and the ones that it looks at next.
    first: Vec<f64>,
    next: Vec<f64>,
    step: Vec<f64>,
    /// How the part turns with the hinge, in its own frame.
    columns: Vec<Vector3<f64>>,
    /// Whether the hinge may move: in this search, and in this step.
    loose: Vec<bool>,
    free: Vec<bool>,
}

impl Scratch {
    fn of(count: usize) -> Self {
        Self {
            first: vec![0.0; count],
            next: vec![0.0; count],
            step: vec![0.0; count],
            columns: vec![Vector3::zeros(); count],
            loose: vec![true; count],
            free: vec![true; count],
        }
    }
}

/// Where a search starts and what binds it.
#[derive(Debug, Clone, Copy)]
pub enum Start<'p> {
    /// Nothing came before: the whole of the ranges is searched.
    Anywhere,
    /// The pose before; the angles leave it as little as they must.
    After(&'p [f64]),
    /// A pose found for a neighbouring goal, to see how the angles change with the goal: hinges at their stops stay,
    /// and what could not be reached there is not asked for here.
    Beside(&'p [f64]),
}

impl Hinges {
    /// The hinges of these joints.
    pub fn new(body: &Arc<Skeleton>, joints: &[usize]) -> Self {
        let mut hinges = Self {
            axes: Vec::new(),
            ranges: Vec::new(),
            at: Vec::new(),
            angles: Vec::new(),
            missed: UnitQuaternion::identity(),
            scratch: Scratch::of(0),
        };
        for &j in joints {
            if let JointKind::Hinge { axis, range } = body.joints()[j].kind {
                hinges.axes.push(axis);
                hinges.ranges.push(range);
                hinges.at.push(body.coordinates(j).start);
            }
        }
        let count = hinges.axes.len();
        hinges.angles = vec![0.0; count];
        hinges.scratch = Scratch::of(count);
        hinges
    }

    /// Writes into `pose` the angles within the ranges that bring the part nearest `goal`, a rotation in the frame of
    /// the part before.
    pub fn place(&mut self, goal: &UnitQuaternion<f64>, start: Start<'_>, pose: &mut [f64]) {
        match start {
            Start::Anywhere => self.search(goal),
            Start::After(before) => {
                self.take(before);
                for (angle, range) in self.angles.iter_mut().zip(&self.ranges) {
                    *angle = angle.max(range.low).min(range.high);
                }
                self.scratch.loose.fill(true);
                self.descend(goal, STAYING, true);
            }
            Start::Beside(centre) => {
                self.take(centre);
                let hinges = self.angles.iter().zip(&self.ranges);
                for (loose, (angle, range)) in self.scratch.loose.iter_mut().zip(hinges) {
                    *loose = range.low < *angle && *angle < range.high;
                }
                let goal = goal * self.missed.inverse();
                self.descend(&goal, STAYING, false);
            }
        }
        if !matches!(start, Start::Beside(_)) {
            self.missed = rotation(&self.axes, &self.angles).inverse() * goal;
        }
        for (&at, angle) in self.at.iter().zip(&self.angles) {
            pose[at] = *angle;
        }
    }

    fn take(&mut self, pose: &[f64]) {
        for (angle, &at) in self.angles.iter_mut().zip(&self.at) {
            *angle = pose[at];
        }
    }

    /// The best of descents from everywhere in the ranges, and from neutral.
    fn search(&mut self, goal: &UnitQuaternion<f64>) {
        let count = self.axes.len();
        let mut best = (f64::INFINITY, vec![0.0; count]);
        // More than three hinges are redundant: the others start from the middle.
        let varied = count.min(3) as u32;
        for start in 0..=STARTS.len().pow(varied) {
            let mut digits = start.wrapping_sub(1);
            for (k, (angle, range)) in self.angles.iter_mut().zip(&self.ranges).enumerate() {
                let width = range.high - range.low;
                *angle = match start {
                    0 => 0f64.max(range.low).min(range.high),
                    _ if k < 3 => range.low + STARTS[digits % STARTS.len()] * width,
                    _ => range.middle(),
                };
                digits /= STARTS.len();
            }
            self.scratch.loose.fill(true);
            self.descend(goal, CHOOSING, true);
            let off = log(&(rotation(&self.axes, &self.angles).inverse() * goal));
            let far: f64 = self.angles.iter().map(|a| a * a).sum();
            let cost = off.norm_squared() + CHOOSING * CHOOSING * far;
            // Clearly better only: rounding must not choose.
            if cost < best.0 - 1e-10 {
                best = (cost, self.angles.clone());
            }
        }
        self.angles = best.1;
    }

    /// Gauss-Newton on `|log(R' goal)|^2 + staying^2 |angles - first|^2` from the present angles, over the loose hinges;
    /// where `bound`, within the ranges, and a hinge that leans on its stop is left out of the step.
    fn descend(&mut self, goal: &UnitQuaternion<f64>, staying: f64, bound: bool) {
        let (axes, ranges, angles) = (&self.axes, &self.ranges, &mut self.angles);
        let Scratch {
            first,
            next,
            step,
            columns,
            loose,
            free,
        } = &mut self.scratch;
        first.copy_from_slice(angles);
        let cost = |angles: &[f64], first: &[f64]| {
            let off = log(&(rotation(axes, angles).inverse() * goal));
            let left: f64 = angles.iter().zip(first).map(|(a, b)| (a - b).powi(2)).sum();
            (off, off.norm_squared() + staying * staying * left)
        };
        let (mut off, mut least) = cost(angles, first);
        for _ in 0..STEPS {
            let mut after = UnitQuaternion::identity();
            for k in (0..columns.len()).rev() {
                columns[k] = after.inverse() * axes[k].into_inner();
                after = UnitQuaternion::from_axis_angle(&axes[k], angles[k]) * after;
            }
            free.copy_from_slice(loose);
            // Each round takes out the hinges that would go through their stops; there are no more rounds than hinges.
            loop {
                newton(angles, first, columns, free, &off, staying, step);
                let mut stopped = false;
                for k in 0..free.len() {
                    let out = (angles[k] >= ranges[k].high && step[k] > 0.0)
                        || (angles[k] <= ranges[k].low && step[k] < 0.0);
                    if bound && free[k] && out {
                        free[k] = false;
                        stopped = true;
                    }
                }
                if !stopped {
                    break;
                }
            }
            if step.iter().all(|s| s.abs() < STILL) {
                return;
            }
            let mut share = 1.0;
            let mut nearer = false;
            for _ in 0..HALVINGS {
                for k in 0..next.len() {
                    next[k] = angles[k] + share * step[k];
                    if bound {
                        next[k] = next[k].max(ranges[k].low).min(ranges[k].high);
                    }
                }
                let (then, found) = cost(next, first);
                if found < least {
                    (off, least) = (then, found);
                    angles.copy_from_slice(next);
                    nearer = true;
                    break;
                }
                share *= 0.5;
            }
            if !nearer {
                return;
            }
        }
    }
}

/// The turn of hinges about these axes by these angles.
fn rotation(axes: &[Unit<Vector3<f64>>], angles: &[f64]) -> UnitQuaternion<f64> {
    axes.iter()
        .zip(angles)
        .fold(UnitQuaternion::identity(), |turn, (axis, angle)| {
            turn * UnitQuaternion::from_axis_angle(axis, *angle)
        })
}

/// The Gauss-Newton step of the free hinges: the u - d that makes `|J u - (off + J d)|^2 + staying^2 |u|^2` least, d
/// being how far the angles are from the first. Three equations, however many hinges.
fn newton(
    angles: &[f64],
    first: &[f64],
    columns: &[Vector3<f64>],
    free: &[bool],
    off: &Vector3<f64>,
    staying: f64,
    out: &mut [f64],
) {
    let mut square = Matrix3::identity() * (staying * staying);
    let mut wanted = *off;
    for k in (0..columns.len()).filter(|&k| free[k]) {
        square += columns[k] * columns[k].transpose();
        wanted += columns[k] * (angles[k] - first[k]);
    }
    let along = square
        .cholesky()
        .map_or(Vector3::zeros(), |c| c.solve(&wanted));
    for k in 0..columns.len() {
        out[k] = match free[k] {
            true => columns[k].dot(&along) - (angles[k] - first[k]),
            false => 0.0,
        };
    }
}
