//! [`Flowfield`]: a primitive sampled.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};
use rayon::prelude::*;

use super::samples::{LANES, Lane, MOST_AXES, Samples};
use super::settings::{FlowSettings, MOST_COURSES, Metric};
use crate::error::Result;
use crate::interpolation::Interpolator;
use crate::math::rotation::{exp, log_near};
use crate::motion::Motion;
use crate::primitive::course::{EXTRA, LOG_SECS};
use crate::primitive::curve::Curve;
use crate::primitive::model::Primitive;
use crate::skeleton::{Root, Skeleton};

/// Courses beside the exemplars for 0, 1, 2 and more parameters.
const COURSES: [usize; 4] = [1, 24, 96, 160];
/// Share of the postures' variance that the coordinates of the search may miss.
const MISSED: f64 = 1e-6;
/// Least weight of a coordinate, as a share of the mean: what moves no landmark counts a little.
const LEAST_WEIGHT: f64 = 0.01;

/// A primitive as a field: at each posture and phase, where the movement goes from there and how far it is from there to
/// the manifold of postures that the primitive knows.
///
/// It holds the exemplars' curves, and S x B postures in at most 16 principal coordinates to find the near ones by: about
/// 140 bytes a sample.
#[derive(Debug, Clone)]
pub struct Flowfield {
    pub(super) settings: FlowSettings,
    pub(super) body: Arc<Skeleton>,
    pub(super) cyclic: bool,
    /// The exemplars over phase.
    pub(super) curves: Vec<Curve>,
    pub(super) interpolator: Interpolator,
    /// Parameters of each course, courses x parameters.
    pub(super) points: Vec<f64>,
    /// The same, `[block][parameter]` of lanes.
    point_lanes: Vec<Lane>,
    /// The middle of the exemplars' parameters.
    pub(super) centre: Vec<f64>,
    pub(super) dims: usize,
    /// What a squared radian of each coordinate counts; their sum is one.
    pub(super) weights: Vec<f64>,
    /// The mean posture.
    pub(super) middle: Vec<f64>,
    /// Directions of the search, axes x coordinates, times the roots of the weights.
    axes: Vec<f64>,
    pub(super) samples: Samples,
    /// Pieces of phase a second at each sample, `[block][phase]` of lanes.
    paces: Vec<Lane>,
    balls: Vec<Range<usize>>,
}

impl Flowfield {
    /// Samples a primitive.
    ///
    /// # Errors
    /// When a setting is outside of its range.
    pub fn of(primitive: &Primitive, settings: &FlowSettings) -> Result<Self> {
        settings.check()?;
        let body = Arc::clone(primitive.body());
        let (dof, pieces) = (body.dof(), settings.pieces);
        let cyclic = primitive.is_cyclic();
        let curves = primitive.curves().to_vec();
        let points = points(primitive, settings.courses);
        let dims = primitive.parameters().dims();
        let courses = points.len().checked_div(dims).unwrap_or(1);
        let n = curves.len();
        let mut shares = vec![0.0; courses * n];
        shares.par_chunks_mut(n).enumerate().for_each(|(c, row)| {
            let point = &points[c * dims..(c + 1) * dims];
            primitive.interpolator().weights(point, row);
        });

        // Postures and paces of the exemplars at the sampled phases: all courses are weighted sums of them.
        let phases = pieces + usize::from(!cyclic);
        let channels = dof + EXTRA;
        let mut own = vec![0.0; n * phases * channels];
        for (i, curve) in curves.iter().enumerate() {
            for b in 0..phases {
                let row = (i * phases + b) * channels;
                let phase = b as f64 / pieces as f64;
                curve.add(phase, 1.0, 0, &mut own[row..row + channels]);
            }
        }
        let postures: Vec<&[f64]> = own.chunks_exact(channels).map(|row| &row[..dof]).collect();
        let middle = mean(&postures, dof);
        let weights = match settings.metric {
            Metric::Landmarks => landmark_weights(&body, &middle)?,
            Metric::Activity => normalised(primitive.exemplars()[0].motion.activity_weights()),
        };
        let axes = principal(&postures, &middle, &weights);
        let r = axes.len() / dof;
        let placed: Vec<f64> = postures
            .par_iter()
            .flat_map_iter(|x| place(&axes, &middle, x).into_iter().take(r))
            .collect();
        let blended = |c: usize, of: &dyn Fn(usize) -> f64| -> f64 {
            (0..n).map(|i| shares[c * n + i] * of(i)).sum()
        };
        let samples = Samples::new([courses, pieces, r], cyclic, |c, b, a| {
            blended(c, &|i| placed[(i * phases + b) * r + a])
        });
        let pace = |c: usize, b: usize| {
            let log = blended(c, &|i| own[(i * phases + b) * channels + dof + LOG_SECS]);
            pieces as f64 * (-log).exp()
        };
        let mut paces = Vec::with_capacity(samples.blocks() * phases);
        for block in 0..samples.blocks() {
            for b in 0..phases {
                let of = |lane: usize| pace((block * LANES + lane).min(courses - 1), b);
                paces.push(std::array::from_fn(of));
            }
        }
        let mut point_lanes = Vec::with_capacity(samples.blocks() * dims);
        for block in 0..samples.blocks() {
            for d in 0..dims {
                let of = |lane: usize| points[(block * LANES + lane).min(courses - 1) * dims + d];
                point_lanes.push(std::array::from_fn(of));
            }
        }
        let balls = (0..body.joints().len())
            .map(|j| body.coordinates(j))
            .filter(|at| at.len() == 3)
            .collect();
        Ok(Self {
            settings: settings.clone(),
            body,
            cyclic,
            curves,
            interpolator: primitive.interpolator().clone(),
            points,
            point_lanes,
            centre: primitive.middle(),
            dims,
            weights,
            middle,
            axes,
            samples,
            paces,
            balls,
        })
    }

    /// The body that it moves.
    pub fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    /// How it was made.
    pub fn settings(&self) -> &FlowSettings {
        &self.settings
    }

    /// Whether phase wraps from 1 to 0.
    pub fn is_cyclic(&self) -> bool {
        self.cyclic
    }

    /// Courses that were sampled, the exemplars' own included.
    pub fn courses(&self) -> usize {
        self.samples.courses()
    }

    /// What a squared radian of each coordinate counts in distances; their sum is one.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The distance of two postures: the weighted root mean square of their coordinates' differences, radians.
    pub fn distance_rad(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b).zip(&self.weights);
        pairs
            .map(|((a, b), w)| w * (a - b) * (a - b))
            .sum::<f64>()
            .sqrt()
    }

    /// A posture in the coordinates of the search.
    pub(super) fn query(&self, pose: &[f64]) -> [f64; MOST_AXES] {
        place(&self.axes, &self.middle, pose)
    }

    /// A velocity (or any difference of postures) in the coordinates of the search.
    pub(super) fn direction(&self, velocity: &[f64]) -> [f64; MOST_AXES] {
        let mut found = [0.0; MOST_AXES];
        for (f, axis) in found.iter_mut().zip(self.axes.chunks_exact(velocity.len())) {
            *f = axis.iter().zip(velocity).map(|(a, v)| a * v).sum();
        }
        found
    }

    /// What the parameters of the courses of a block cost, seen from `parameters`.
    #[inline(always)]
    pub(super) fn parameter_cost(&self, block: usize, parameters: &[f64]) -> Lane {
        let stiff = self.stiffness();
        let mut cost = [0.0; LANES];
        let rows = &self.point_lanes[block * self.dims..(block + 1) * self.dims];
        for (row, p) in rows.iter().zip(parameters) {
            for (c, v) in cost.iter_mut().zip(row) {
                *c += stiff * (v - p) * (v - p);
            }
        }
        cost
    }

    /// What squared parameters count beside squared radians.
    pub(super) fn stiffness(&self) -> f64 {
        (self.settings.sigma_rad / self.settings.sigma_parameters).powi(2)
    }

    /// Pieces of phase a second of the courses of a block.
    pub(super) fn paces(&self, block: usize, place: i64) -> &Lane {
        let phases = self.paces.len() / self.samples.blocks();
        &self.paces[block * phases + self.samples.row(place)]
    }

    /// A posture with each ball's rotation vector under the name that is nearest to the mean posture's.
    pub(super) fn named(&self, pose: &[f64]) -> Vec<f64> {
        let mut named = pose.to_vec();
        for ball in &self.balls {
            let v = Vector3::from_column_slice(&pose[ball.clone()]);
            let near = Vector3::from_column_slice(&self.middle[ball.clone()]);
            if (v - near).norm() > std::f64::consts::PI {
                let v = log_near(&exp(&v), &near);
                named[ball.clone()].copy_from_slice(v.as_slice());
            }
        }
        named
    }
}

/// Parameters of the courses: a low-discrepancy sequence within the exemplars' (dilated) hull, and the exemplars' own.
fn points(primitive: &Primitive, asked: Option<usize>) -> Vec<f64> {
    const PRIMES: [u32; 6] = [2, 3, 5, 7, 11, 13];
    const TRIES: usize = 12;
    let dims = primitive.parameters().dims();
    let wanted = asked.unwrap_or(COURSES[dims.min(3)]);
    let n = primitive.exemplars().len();
    if dims == 0 {
        return Vec::new();
    }
    let mut points = Vec::new();
    let kept = n.min(MOST_COURSES);
    for i in 0..kept {
        points.extend_from_slice(primitive.point(i * n / kept));
    }
    if dims > PRIMES.len() {
        return points;
    }
    let mut found = 0;
    for i in 0..wanted * TRIES {
        if found == wanted {
            break;
        }
        let p: Vec<f64> = PRIMES[..dims].iter().map(|&b| halton(i, b)).collect();
        let inside = primitive.interpolator().clamped(&p);
        if p.iter().zip(&inside).all(|(a, b)| (a - b).abs() < 1e-9) {
            points.extend(p);
            found += 1;
        }
    }
    // Courses that are scanned together are neighbours, so that most of them are left out together.
    let mut order: Vec<&[f64]> = points.chunks_exact(dims).collect();
    order.sort_by_key(|p| interleaved(p));
    order.concat()
}

/// The place of a point on the curve of interleaved binary digits (Morton 1966).
fn interleaved(point: &[f64]) -> u64 {
    const DIGITS: u32 = 8;
    let mut key = 0;
    for digit in (0..DIGITS).rev() {
        for p in point {
            let level = (p.clamp(0.0, 1.0) * f64::from((1 << DIGITS) - 1)) as u64;
            key = key << 1 | (level >> digit & 1);
        }
    }
    key
}

/// The radical inverse of `index` + 1 in a base (Halton 1960).
fn halton(index: usize, base: u32) -> f64 {
    let base = base as usize;
    let (mut rest, mut share, mut value) = (index + 1, 1.0, 0.0);
    while rest > 0 {
        share /= base as f64;
        value += share * (rest % base) as f64;
        rest /= base;
    }
    value
}

fn mean(postures: &[&[f64]], dof: usize) -> Vec<f64> {
    let mut mean = vec![0.0; dof];
    for x in postures {
        for (m, v) in mean.iter_mut().zip(*x) {
            *m += v / postures.len() as f64;
        }
    }
    mean
}

/// Weights that sum to one, none below a small share of the mean.
fn normalised(mut weights: Vec<f64>) -> Vec<f64> {
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    for w in &mut weights {
        *w = if mean > 0.0 {
            w.max(LEAST_WEIGHT * mean)
        } else {
            1.0
        };
    }
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| w / sum).collect()
}

/// Squared displacement of all landmarks a radian of each coordinate, at a posture, by central differences.
fn landmark_weights(body: &Arc<Skeleton>, pose: &[f64]) -> Result<Vec<f64>> {
    const STEP: f64 = 1e-4;
    let dof = body.dof();
    let mut poses = Vec::with_capacity(2 * dof * dof);
    for c in 0..dof {
        for step in [STEP, -STEP] {
            let first = poses.len();
            poses.extend_from_slice(pose);
            poses[first + c] += step;
        }
    }
    let roots = vec![Root::ORIGIN; 2 * dof];
    let moved = Motion::new("weights", Arc::clone(body), 1.0, poses, roots)?.landmarks();
    let landmarks = moved.len() / (2 * dof);
    let squared = moved.chunks_exact(2 * landmarks).map(|pair| {
        let (ahead, behind) = pair.split_at(landmarks);
        let gaps = ahead.iter().zip(behind).map(|(a, b)| a - b);
        gaps.map(|g| g * g).sum::<f64>() / (4.0 * STEP * STEP)
    });
    Ok(normalised(squared.collect()))
}

/// Principal directions of weighted postures, as many as it takes to miss [`MISSED`] of their variance.
fn principal(postures: &[&[f64]], middle: &[f64], weights: &[f64]) -> Vec<f64> {
    let dof = middle.len();
    let roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let centred = DMatrix::from_fn(dof, postures.len(), |c, s| {
        roots[c] * (postures[s][c] - middle[c])
    });
    let eigen = SymmetricEigen::new(&centred * centred.transpose());
    let mut order: Vec<usize> = (0..dof).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let total: f64 = eigen.eigenvalues.iter().sum();
    let mut left = total;
    let mut axes = Vec::new();
    for &a in order.iter().take(MOST_AXES) {
        if !axes.is_empty() && left <= MISSED * total {
            break;
        }
        left -= eigen.eigenvalues[a];
        let direction: DVector<f64> = eigen.eigenvectors.column(a).into_owned();
        axes.extend(direction.iter().zip(&roots).map(|(d, r)| d * r));
    }
    axes
}

fn place(axes: &[f64], middle: &[f64], pose: &[f64]) -> [f64; MOST_AXES] {
    let mut found = [0.0; MOST_AXES];
    for (f, axis) in found.iter_mut().zip(axes.chunks_exact(middle.len())) {
        let terms = axis.iter().zip(pose.iter().zip(middle));
        *f = terms.map(|(a, (x, m))| a * (x - m)).sum();
    }
    found
}
