//! [`Primitive`]: f(p, τ), a class of movements given by exemplars and a way to blend them.

use std::sync::{Arc, OnceLock};

use super::course::{Course, Sample, sample};
use super::curve::Curve;
use super::exemplar::Exemplar;
use super::fitting::{MOST_EXEMPLARS, SHAPE_PHASES, fit, interpolated, moving, part_of, shape};
use super::modelling::{Fit, Interpolation, Modelling};
use super::registered::curves;
use super::space::{ParameterSource, ParameterSpace};
use super::structure::cycle_of;
use crate::alignment::{Registration, Trim};
use crate::error::{Error, Result};
use crate::interpolation::Interpolator;
use crate::motion::{Motion, landmark_dims};
use crate::skeleton::Skeleton;

/// What the derivation knew of a primitive's group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group {
    /// How many segments the group had; exemplars may be fewer.
    pub members: usize,
    /// Mean silhouette of the group in [-1, 1]; low values flag unintended groups. `None` when it was the only group.
    pub coherence: Option<f64>,
}

/// A class of structurally identical yet stylistically varied movements (paper, section III): a function from
/// parameters p in [0, 1]^m and phase τ in [0, 1] to posture, learned from exemplars.
#[derive(Debug, Clone)]
pub struct Primitive {
    name: String,
    exemplars: Vec<Exemplar>,
    fit: Fit,
    group: Option<Group>,
    interpolator: Interpolator,
    /// Made when first asked for: vocabularies of many primitives are looked through more often than run.
    curves: OnceLock<Vec<Curve>>,
}

impl PartialEq for Primitive {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && self.exemplars == other.exemplars
            && self.fit == other.fit
            && self.group == other.group
    }
}

impl Primitive {
    /// Learns a primitive: rests trimmed, exemplars registered to phase, parameters and interpolator settled.
    ///
    /// # Errors
    /// Without exemplars; when they are of different bodies, single frames, or differ in their number of adverbs; when
    /// one is of another structure than the others (its mirror image, the opposite foot first): the message names it.
    pub fn learn(name: &str, exemplars: Vec<Exemplar>, modelling: &Modelling) -> Result<Self> {
        let (exemplars, fit) = fit(name, exemplars, modelling)?;
        Self::from_fit(name, exemplars, fit, None)
    }

    /// The primitive of exemplars and what was fitted to them.
    ///
    /// # Errors
    /// When the parts do not agree: numbers of exemplars, parts used outside of motions, parameters that are not finite.
    pub fn from_fit(
        name: &str,
        exemplars: Vec<Exemplar>,
        fit: Fit,
        group: Option<Group>,
    ) -> Result<Self> {
        let wrong = |what: String| Error::invalid(format!("primitive `{name}`: {what}"));
        if name.trim().is_empty() {
            return Err(Error::invalid("a primitive needs a name"));
        }
        let n = exemplars.len();
        let Some(first) = exemplars.first() else {
            return Err(wrong("no exemplar".into()));
        };
        if n > MOST_EXEMPLARS {
            return Err(wrong(format!("{n} exemplars, more than {MOST_EXEMPLARS}")));
        }
        let body = first.motion.skeleton();
        if let Some(e) = exemplars.iter().find(|e| **e.motion.skeleton() != **body) {
            return Err(wrong(format!(
                "exemplars of the bodies `{}` and `{}`",
                body.name(),
                e.motion.skeleton().name()
            )));
        }
        if fit.used.len() != n || fit.warps.len() != n || fit.points.len() != n * fit.space.dims() {
            return Err(wrong(format!(
                "{n} exemplars, but parts of {}, warps of {}, {} parameters",
                fit.used.len(),
                fit.warps.len(),
                fit.points.len()
            )));
        }
        for (e, used) in exemplars.iter().zip(&fit.used) {
            let last = (e.motion.frames() - 1) as f64;
            let within = used.start >= 0.0 && used.end > used.start && used.end <= last + 1e-9;
            // A shorter part has no duration to speak of.
            let within = within && used.end - used.start >= 1.0;
            if !within || !(0.0..1.0).contains(&used.shift) {
                return Err(wrong(format!(
                    "frames {} to {} of {}, which has {}",
                    used.start,
                    used.end,
                    e.label(),
                    e.motion.frames()
                )));
            }
        }
        let landmarks = landmark_dims(body);
        let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
        let framed = !fit.reference.is_empty() && fit.reference.len().is_multiple_of(landmarks);
        if !framed || !finite(&fit.reference) || !finite(&fit.points) {
            return Err(wrong(
                "reference or parameters that are not finite frames".into(),
            ));
        }
        if let ParameterSource::Principal { mean, .. } = fit.space.source()
            && fit.space.dims() > 0
            && mean.len() != SHAPE_PHASES * landmarks
        {
            return Err(wrong("principal directions of another body".into()));
        }
        if !(2..=MOST_KNOTS).contains(&fit.knots) {
            return Err(wrong(format!("{} knots, not 2 to {MOST_KNOTS}", fit.knots)));
        }
        if fit.warps.iter().any(|w| w.is_closed() != fit.cyclic) {
            return Err(wrong(
                "open warps of a cycle, or closed ones of a stroke".into(),
            ));
        }
        let interpolator = Interpolator::new(&fit.points, n, fit.space.dims(), &fit.method)?;
        Ok(Self {
            name: name.into(),
            exemplars,
            fit,
            group,
            interpolator,
            curves: OnceLock::new(),
        })
    }

    /// The same exemplars, registered and parametrised as they are, with another interpolator; principal coordinates may
    /// become fewer or more.
    ///
    /// # Errors
    /// When the parameters are not finite.
    pub fn interpolated(&self, interpolation: Interpolation) -> Result<Self> {
        let fit = interpolated(&self.exemplars, &self.fit, interpolation)?;
        Self::from_fit(&self.name, self.exemplars.clone(), fit, self.group)
    }

    /// The same primitive under another name.
    pub fn renamed(self, name: &str) -> Self {
        Self {
            name: name.into(),
            ..self
        }
    }

    /// The same primitive with what the derivation knew of its group.
    pub fn of_group(self, group: Group) -> Self {
        Self {
            group: Some(group),
            ..self
        }
    }

    /// Its name, unique in the vocabulary.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The body that it moves.
    pub fn body(&self) -> &Arc<Skeleton> {
        self.exemplars[0].motion.skeleton()
    }

    /// Its exemplars, at least one; of a derived group the most central first.
    pub fn exemplars(&self) -> &[Exemplar] {
        &self.exemplars
    }

    /// What was fitted to them.
    pub fn fitted(&self) -> &Fit {
        &self.fit
    }

    /// What the derivation knew of its group; `None` where a person determined it.
    pub fn group(&self) -> Option<&Group> {
        self.group.as_ref()
    }

    /// What its parameters mean.
    pub fn parameters(&self) -> &ParameterSpace {
        &self.fit.space
    }

    /// The weights of its exemplars as a function of parameters.
    pub fn interpolator(&self) -> &Interpolator {
        &self.interpolator
    }

    /// Whether the end joins the beginning: phase wraps from 1 to 0.
    pub fn is_cyclic(&self) -> bool {
        self.fit.cyclic
    }

    /// What a user should know of the fit.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        let fitted = self.fit.notes.iter();
        fitted.chain(self.interpolator.notes()).map(String::as_str)
    }

    /// The parameters of an exemplar, in [0, 1]^m.
    pub fn point(&self, exemplar: usize) -> &[f64] {
        let dims = self.fit.space.dims();
        &self.fit.points[exemplar * dims..(exemplar + 1) * dims]
    }

    /// The middle of the exemplars' parameters.
    pub fn middle(&self) -> Vec<f64> {
        let n = self.exemplars.len() as f64;
        let mean = |d: usize| {
            (0..self.exemplars.len())
                .map(|i| self.point(i)[d])
                .sum::<f64>()
                / n
        };
        (0..self.fit.space.dims()).map(mean).collect()
    }

    /// f(p, ·): the movement at parameters in [0, 1]^m. Parameters far outside the exemplars' hull are brought to it,
    /// dilated by a tenth; [`Course::parameters`] tells.
    ///
    /// # Errors
    /// When the parameters are not as many as the space has, or not finite.
    pub fn at(&self, p: &[f64]) -> Result<Course> {
        let (p, weights) = self.weights(p)?;
        let curve = Curve::blended(self.curves(), &weights);
        Ok(Course::new(
            Arc::clone(self.body()),
            p,
            self.fit.cyclic,
            curve,
        ))
    }

    /// f(p, τ) and what goes with it, without making a whole course.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn sample(&self, p: &[f64], phase: f64) -> Result<Sample> {
        let (_, weights) = self.weights(p)?;
        let curves = self.curves().iter().zip(weights);
        Ok(sample(curves, self.body().dof(), self.on_curve(phase)))
    }

    /// f(p, τ).
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn pose(&self, p: &[f64], phase: f64) -> Result<Vec<f64>> {
        let (_, weights) = self.weights(p)?;
        let mut pose = vec![0.0; self.body().dof()];
        for (curve, weight) in self.curves().iter().zip(weights) {
            curve.add(self.on_curve(phase), weight, 0, &mut pose);
        }
        Ok(pose)
    }

    /// f(p, τ) and its derivatives by the parameters, one row of coordinates a parameter.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn pose_gradient(&self, p: &[f64], phase: f64) -> Result<(Vec<f64>, Vec<f64>)> {
        let p = self.brought(p)?;
        let (n, m, dof) = (self.exemplars.len(), p.len(), self.body().dof());
        let mut weights = vec![0.0; n];
        let mut gradient = vec![0.0; n * m];
        self.interpolator
            .weights_and_gradient(&p, &mut weights, &mut gradient);
        let mut pose = vec![0.0; dof];
        let mut rows = vec![0.0; m * dof];
        let mut own = vec![0.0; dof];
        for (i, curve) in self.curves().iter().enumerate() {
            own.fill(0.0);
            curve.add(self.on_curve(phase), 1.0, 0, &mut own);
            for (x, v) in pose.iter_mut().zip(&own) {
                *x += weights[i] * v;
            }
            for d in 0..m {
                let w = gradient[i * m + d];
                for (x, v) in rows[d * dof..(d + 1) * dof].iter_mut().zip(&own) {
                    *x += w * v;
                }
            }
        }
        Ok((pose, rows))
    }

    /// A registered exemplar at a phase: what an exact interpolator returns at the exemplar's parameters.
    pub fn registered(&self, exemplar: usize, phase: f64) -> Sample {
        let curve = [(&self.curves()[exemplar], 1.0)];
        sample(curve, self.body().dof(), self.on_curve(phase))
    }

    /// The parameters in [0, 1]^m of a further motion of this kind, registered to the exemplars; a cycle or a movement
    /// with its rests.
    ///
    /// # Errors
    /// When the motion is of another body or a single frame, or when the parameters are adverbs, which only a person
    /// can tell.
    pub fn parameters_of(&self, motion: &Motion) -> Result<Vec<f64>> {
        if **motion.skeleton() != **self.body() || motion.frames() < 2 {
            return Err(Error::invalid(format!(
                "`{}` is no movement of the body `{}`",
                motion.name(),
                self.body().name()
            )));
        }
        let (values, coordinates) = match self.fit.space.source() {
            ParameterSource::Adverbs if self.fit.space.dims() == 0 => return Ok(Vec::new()),
            ParameterSource::Adverbs => {
                return Err(Error::unsupported(format!(
                    "the parameters of `{}` are adverbs, which no motion tells of itself",
                    self.name
                )));
            }
            ParameterSource::Principal { mean, directions } => {
                let shape = self.shape_of(motion)?;
                let offset: Vec<f64> = shape.iter().zip(mean).map(|(s, m)| s - m).collect();
                let along = |d: &[f64]| d.iter().zip(&offset).map(|(a, b)| a * b).sum();
                let values: Vec<f64> = directions.chunks_exact(mean.len()).map(along).collect();
                (values, None)
            }
            ParameterSource::Effector {
                effector,
                coordinates,
            } => {
                let place = super::aim::extreme_of_motion(motion, effector)?;
                (place.to_vec(), Some(coordinates))
            }
        };
        match coordinates {
            Some(kept) => {
                let kept: Vec<f64> = kept.iter().map(|&c| values[c]).collect();
                self.fit.space.to_unit(&kept)
            }
            None => self.fit.space.to_unit(&values),
        }
    }

    /// Landmarks of a motion at evenly spaced phases after registration to the exemplars.
    fn shape_of(&self, motion: &Motion) -> Result<Vec<f64>> {
        let dims = landmark_dims(self.body());
        let seen = motion.landmarks();
        let registration = Registration {
            knots: self.fit.reference.len() / dims,
            cyclic: self.fit.cyclic,
            ..Registration::default()
        };
        let used = if self.fit.cyclic {
            let secs = self.at(&self.middle())?.duration_secs();
            cycle_of(&seen, dims, motion.rate_hz(), secs, &self.fit.reference)?
        } else {
            moving(&seen, dims, motion.rate_hz(), &Trim::default())
        };
        let sequence = part_of(&seen, dims, &used, self.fit.cyclic);
        let aligned = registration.register_to(&self.fit.reference, &sequence, dims)?;
        Ok(shape(&sequence, dims, &aligned.warp))
    }

    pub(super) fn curves(&self) -> &[Curve] {
        self.curves
            .get_or_init(|| curves(&self.exemplars, &self.fit))
    }

    /// Parameters near the hull, and the weights there.
    fn weights(&self, p: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let p = self.brought(p)?;
        let mut weights = vec![0.0; self.exemplars.len()];
        self.interpolator.weights(&p, &mut weights);
        Ok((p, weights))
    }

    /// Parameters brought near the exemplars' hull.
    fn brought(&self, p: &[f64]) -> Result<Vec<f64>> {
        if p.len() != self.fit.space.dims() || p.iter().any(|v| !v.is_finite()) {
            // The space words the refusal.
            self.fit.space.to_unit(p)?;
        }
        Ok(self.interpolator.clamped(p))
    }

    fn on_curve(&self, phase: f64) -> f64 {
        if self.fit.cyclic {
            phase.rem_euclid(1.0)
        } else {
            phase.clamp(0.0, 1.0)
        }
    }
}

/// Knots that a curve may have: what a file may ask for without taking the memory.
const MOST_KNOTS: usize = 1024;
