//! [`Paper`]: the Bayesian classifier as published (section V-A), every primitive judged by itself.
//!
//! P(X|C) is factored into univariate densities, joint after joint. A joint's observed angle confines the phase to the
//! intervals in which the primitive can attain it, whatever its parameters (Fig. 4), and the density of the next joint
//! is a histogram of samples from these intervals alone (Figs. 5 and 6). The next posture's phases are not before the
//! earliest that are left. P(X|not C) is uniform, priors are equal.
//!
//! The chain conditions on phase and forgets which parameters attained an angle, so joints taken from different
//! executions at the same phase pass together. That is the published method; [`super::Frame`] is the exact one.

mod class;
mod histogram;
mod intervals;
mod settings;
mod steps;

pub use settings::PaperSettings;
pub use steps::{Bars, Mixture};

use std::collections::VecDeque;

use class::{Class, Samples};
use intervals::Intervals;

use super::parts::{Guard, Parts, Posture, Scope, Tolerances, same_body, widened};
use super::spans::whole;
use crate::error::Result;
use crate::primitive::{
    Listener, Observation, Observations, Posterior, Reading, Recogniser, Recognition, Vocabulary,
    readings,
};

/// The paper's classifier.
///
/// **What is compared.** Univariate joint coordinates: angles of hinges, the three numbers of a ball's rotation vector,
/// for a chain of vertebrae the sum of theirs. A coordinate that no primitive of the vocabulary moves has no density:
/// it has factor 1 within `constant_rad` of its value, and farther off refuses the posture, as a clenched fist did in
/// the paper until the hands were altered. A joint that was not seen is left out of the chain.
///
/// **Sensor malfunction.** A reading outside of the joint limits widened by `limits_rad` refuses the posture. Nothing
/// else is forgiven: one joint that is wrong within its limits refuses it, too.
///
/// **Order.** Of the joints, those first that tell most about phase. What is learned of parameters is not carried from
/// joint to joint, nor from posture to posture.
#[derive(Debug)]
pub struct Paper<'v> {
    vocabulary: &'v Vocabulary,
    settings: PaperSettings,
    scope: Scope,
    classes: Vec<Class>,
}

impl<'v> Paper<'v> {
    /// Samples every primitive of the vocabulary.
    ///
    /// # Errors
    /// When a setting is out of its range, or the body has more than 64 parts.
    pub fn new(vocabulary: &'v Vocabulary, settings: &PaperSettings) -> Result<Self> {
        settings.check()?;
        let parts = Parts::of(vocabulary.body())?;
        let samples: Vec<Samples> = vocabulary
            .primitives()
            .iter()
            .map(|p| Samples::of(p, &parts, &settings.samples, settings.pieces))
            .collect::<Result<_>>()?;
        let tolerances = Tolerances {
            delta: widened(vocabulary, settings.delta_rad, settings.residual),
            constant: settings.constant_rad,
            limits: settings.limits_rad,
        };
        let scope = Scope::new(parts, samples.iter().map(Samples::bounds), tolerances);
        let primitives = vocabulary.primitives().iter().zip(samples);
        let classes = primitives
            .map(|(p, own)| Class::new(own, &scope, settings.pieces, p.is_cyclic()))
            .collect();
        Ok(Self {
            vocabulary,
            settings: settings.clone(),
            scope,
            classes,
        })
    }

    /// Half width of "equals" for this vocabulary, radians: the setting, or what its leave-one-out error asks for.
    pub fn delta_rad(&self) -> f64 {
        self.scope.tolerances.delta
    }

    /// Whether nothing but the primitives' own coordinates can refuse a posture.
    fn is_sound(&self, posture: &Posture) -> bool {
        posture.constant_gap.iter().all(|&g| g <= 1.0) && self.scope.in_range(posture)
    }

    fn reading(&self, window: &[&Posture]) -> Reading {
        let delta = self.scope.tolerances.delta;
        let last = window[window.len() - 1];
        let sound = window.iter().all(|p| self.is_sound(p));
        let judged: Vec<Option<(f64, Intervals)>> = self
            .classes
            .iter()
            .map(|c| sound.then(|| c.judge(window, delta)).flatten())
            .collect();
        let probability = |j: &Option<(f64, Intervals)>| match j {
            // The logistic function, which neither overflows nor loses small numbers.
            Some((log, _)) => 1.0 / (1.0 + (-log).exp()),
            None => 0.0,
        };
        let primitives: Vec<f64> = judged.iter().map(probability).collect();
        let most = primitives.iter().copied().fold(0.0, f64::max);
        let posterior = Posterior {
            primitives,
            rest: 0.0,
            none: 1.0 - most,
        };
        let place = posterior.leading().and_then(|(k, _)| {
            let (_, phases) = judged[k].as_ref()?;
            Some(self.classes[k].place(k, phases, last, delta))
        });
        let constant = last.constant_gap.iter().copied().fold(0.0, f64::max);
        let distance = self
            .classes
            .iter()
            .fold(f64::INFINITY, |least, c| c.distance(last, delta, least));
        Reading {
            posterior,
            place,
            novelty: constant.max(distance),
        }
    }
}

impl Recogniser for Paper<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    /// Each primitive against its own complement.
    fn is_binary(&self) -> bool {
        true
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(PaperListener {
            paper: self,
            guard: Guard::default(),
            postures: VecDeque::new(),
        })
    }

    /// The mean of the frames' probabilities, primitive by primitive; none is what the greatest leaves.
    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        same_body(self.vocabulary, seen.motion().skeleton())?;
        let readings = readings(self, seen)?;
        let rate = seen.motion().rate_hz();
        Ok(whole(&readings, rate, self.settings.dwell_secs, true))
    }
}

/// The paper's classifier at work on a stream.
struct PaperListener<'a> {
    paper: &'a Paper<'a>,
    guard: Guard,
    /// As many as the n postures span, the latest last.
    postures: VecDeque<Posture>,
}

impl Listener for PaperListener<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        self.guard.check(self.paper.vocabulary.body(), seen)?;
        let (n, stride) = (self.paper.settings.n, self.paper.settings.stride);
        if self.postures.len() > (n - 1) * stride {
            self.postures.pop_front();
        }
        self.postures.push_back(self.paper.scope.posture(seen));
        let last = self.postures.len() - 1;
        // At the beginning of a stream fewer postures have to do.
        let window: Vec<&Posture> = (0..n.min(last / stride + 1))
            .rev()
            .map(|back| &self.postures[last - back * stride])
            .collect();
        Ok(self.paper.reading(&window))
    }
}
