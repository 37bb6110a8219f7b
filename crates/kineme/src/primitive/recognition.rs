//! [`Recogniser`]: the inverse of f, from observed postures to primitive, phase and parameters, or to nothing known.

use super::vocabulary::Vocabulary;
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::skeleton::Root;

/// One observed posture of a stream.
#[derive(Debug, Clone, Copy)]
pub struct Observation<'a> {
    /// Its time, seconds; later than that of the observation before.
    pub secs: f64,
    /// One finite number a coordinate of the body; those of missing joints are not looked at.
    pub pose: &'a [f64],
    /// Where the root is and which way it faces, where that is known.
    pub root: Option<Root>,
    /// Which joints were not seen, one flag a joint; empty where all were.
    pub missing: &'a [bool],
}

/// A motion as it was observed: joints may be missing in any frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    motion: Motion,
    missing: Vec<bool>,
}

impl Observations {
    /// A motion in which every joint was seen.
    pub fn complete(motion: Motion) -> Self {
        Self {
            motion,
            missing: Vec::new(),
        }
    }

    /// A motion of which these joints were not seen: frames x joints, frame-major.
    ///
    /// # Errors
    /// When there are not as many flags as frames times joints.
    pub fn with_missing(motion: Motion, missing: Vec<bool>) -> Result<Self> {
        let expected = motion.frames() * motion.skeleton().joints().len();
        if missing.len() != expected {
            return Err(Error::invalid(format!(
                "{} flags of missing joints, not {expected}: one a frame and joint",
                missing.len()
            )));
        }
        Ok(Self { motion, missing })
    }

    /// The motion; what it holds at missing joints means nothing.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// What was seen in a frame.
    pub fn at(&self, frame: usize) -> Observation<'_> {
        let joints = self.motion.skeleton().joints().len();
        Observation {
            secs: frame as f64 / self.motion.rate_hz(),
            pose: self.motion.pose(frame),
            root: Some(*self.motion.root(frame)),
            missing: match self.missing.is_empty() {
                true => &[],
                false => &self.missing[frame * joints..(frame + 1) * joints],
            },
        }
    }
}

/// How probable each answer is.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Of each primitive, in the order of the vocabulary, each in [0, 1].
    pub primitives: Vec<f64>,
    /// Of a body at rest.
    pub rest: f64,
    /// Of a movement that is none of the primitives.
    pub none: f64,
}

impl Posterior {
    /// The primitive that is more probable than every other answer; `None` where rest or none is at least as probable.
    /// Of equal primitives the first.
    pub fn best(&self) -> Option<usize> {
        let (first, p) = self.leading()?;
        (p > self.rest.max(self.none)).then_some(first)
    }

    /// The most probable primitive, whatever rest and none are, and its probability; `None` without primitives.
    pub fn leading(&self) -> Option<(usize, f64)> {
        let mut leading = None;
        for (i, &p) in self.primitives.iter().enumerate() {
            if leading.is_none_or(|(_, most)| p > most) {
                leading = Some((i, p));
            }
        }
        leading
    }
}

/// Where on a primitive's manifold a posture is.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// The primitive, an index into the vocabulary.
    pub primitive: usize,
    /// Phase in [0, 1].
    pub phase: f64,
    /// Its standard deviation.
    pub phase_deviation: f64,
    /// Parameters in [0, 1]^m.
    pub parameters: Vec<f64>,
    /// Their standard deviations.
    pub parameters_deviation: Vec<f64>,
}

/// What is thought of the present moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// How probable each answer is.
    pub posterior: Posterior,
    /// Where on the leading primitive the posture is; `None` where it is on no primitive.
    pub place: Option<Place>,
    /// How unlike everything known the posture is: 0 for the exemplars' own, 1 at the limit of what is accepted.
    pub novelty: f64,
}

/// A part of a motion and what was done in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Its beginning, seconds.
    pub start_secs: f64,
    /// Its end, seconds: the next one's beginning.
    pub end_secs: f64,
    /// The primitive; `None` for rest and for the unknown.
    pub primitive: Option<usize>,
    /// The mean probability of that answer.
    pub confidence: f64,
}

/// What is thought of a motion as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognition {
    /// How probable each answer is.
    pub posterior: Posterior,
    /// The parameters of the leading primitive in [0, 1]^m; empty where it has none.
    pub parameters: Vec<f64>,
    /// As [`Reading::novelty`], of the whole.
    pub novelty: f64,
    /// Who did what when: without gaps or overlaps, from the first frame to the last.
    pub spans: Vec<Span>,
}

/// Something that says of observed movement which primitive it is.
pub trait Recogniser: Sync {
    /// The primitives that it can answer.
    fn vocabulary(&self) -> &Vocabulary;

    /// Whether every primitive is judged by itself: probabilities then do not sum to one.
    fn is_binary(&self) -> bool {
        false
    }

    /// Begins to listen: what is answered to a posture depends on it and those before.
    fn listen(&self) -> Box<dyn Listener + '_>;

    /// What a motion is as a whole.
    ///
    /// # Errors
    /// When the motion is of another body.
    fn recognise(&self, seen: &Observations) -> Result<Recognition>;
}

/// A recogniser at work on a stream.
pub trait Listener {
    /// Takes the next posture and answers.
    ///
    /// # Errors
    /// When it is not of the vocabulary's body, or not later than the one before.
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading>;
}

/// Answers of a recogniser to every frame of a motion, each from the frames up to it.
///
/// # Errors
/// When the motion is of another body.
pub fn readings(recogniser: &dyn Recogniser, seen: &Observations) -> Result<Vec<Reading>> {
    let mut listener = recogniser.listen();
    (0..seen.motion().frames())
        .map(|f| listener.hear(&seen.at(f)))
        .collect()
}
