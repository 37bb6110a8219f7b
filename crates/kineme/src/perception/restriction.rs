//! [`Restriction`]: what a part of the body does, whatever the rest of it does meanwhile.
//!
//! Primitives superpose (paper, abstract): an arm may wave while the trunk twists, and the posture is then that of no
//! primitive. Seen by its arm alone the body waves, and by its trunk alone it twists. So a vocabulary is restricted to a
//! part: all other joints of its exemplars are put at neutral, and so are those of what is observed. What is left is a
//! vocabulary and an observation like any other, and every recogniser works on them as it is.

use std::sync::Arc;

use super::filter::Filter;
use super::parts::same_body;
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::primitive::{
    Exemplar, Listener, MOVES_RAD, Moved, Observation, Observations, Primitive, Reading,
    Recogniser, Recognition, Transitions, Vocabulary,
};
use crate::skeleton::{JointSet, PARTS, Root, Skeleton};

/// A part shows the primitives that turn its joints by so much at least of what any does, ranges summed.
const SHARE: f64 = 0.25;

/// A vocabulary as a part of the body shows it, and what makes observations alike.
///
/// Phases, parameters and durations are those of the whole primitives. Joints beyond the part need not be seen.
#[derive(Debug, Clone)]
pub struct Restriction {
    vocabulary: Vocabulary,
    part: Part,
}

/// The joints that are looked at, and what stands for the others.
#[derive(Debug, Clone)]
struct Part {
    joints: JointSet,
    /// Whether the root is looked at.
    root: bool,
    neutral: Vec<f64>,
}

impl Restriction {
    /// A vocabulary restricted to parts of the body ([`PARTS`]) and single joints, by name: the primitives that turn
    /// these by at least a quarter of what any primitive does. The root goes with both legs. Restricted to the
    /// whole body it is the vocabulary itself; else recognisers have learned nothing of it yet ([`Self::calibrated`]).
    ///
    /// # Errors
    /// Without names; for one that is neither a part nor a joint of the body; when no primitive moves them.
    pub fn new(vocabulary: &Vocabulary, names: &[String]) -> Result<Self> {
        if names.is_empty() {
            return Err(Error::invalid(format!(
                "no part of the body to look at; there are {}",
                PARTS.join(", ")
            )));
        }
        let body = vocabulary.body();
        let joints = JointSet::named(body, names)?;
        let whole = joints.is_whole(body);
        let part = Part {
            root: whole || joints.has_legs(body),
            neutral: body.neutral(),
            joints,
        };
        let vocabulary = match whole {
            true => vocabulary.clone(),
            false => part.vocabulary(vocabulary, names)?,
        };
        Ok(Self { vocabulary, part })
    }

    /// With what the filter learns of the restricted vocabulary by leaving exemplars out, unless that is known.
    ///
    /// # Errors
    /// When it cannot be fitted.
    pub fn calibrated(self) -> Result<Self> {
        if self.vocabulary.calibration("filter").is_some() {
            return Ok(self);
        }
        let learned = Filter::calibration(&self.vocabulary, &[])?;
        Ok(Self {
            vocabulary: self.vocabulary.calibrated(learned)?,
            ..self
        })
    }

    /// The vocabulary as the part shows it: primitives under their own names, in their own order.
    pub fn vocabulary(&self) -> &Vocabulary {
        &self.vocabulary
    }

    /// A motion as the part shows it.
    ///
    /// # Errors
    /// When it is of another body.
    pub fn motion(&self, motion: &Motion) -> Result<Motion> {
        same_body(&self.vocabulary, motion.skeleton())?;
        self.part.motion(motion)
    }

    /// Observations as the part shows them: beyond it nothing is missing.
    ///
    /// # Errors
    /// When they are of another body.
    pub fn observations(&self, seen: &Observations) -> Result<Observations> {
        let motion = self.motion(seen.motion())?;
        let body = self.vocabulary.body();
        let hidden = (0..motion.frames()).flat_map(|f| self.part.missing(body, seen.at(f).missing));
        let hidden: Vec<bool> = hidden.collect();
        match hidden.is_empty() {
            true => Ok(Observations::complete(motion)),
            false => Observations::with_missing(motion, hidden),
        }
    }

    /// A recogniser of the restricted vocabulary that takes observations of the whole body.
    pub fn recogniser<'r>(&'r self, of_part: Box<dyn Recogniser + 'r>) -> Restricted<'r> {
        Restricted {
            restriction: self,
            of_part,
        }
    }
}

impl Part {
    /// The primitives that the part shows, restricted to it.
    fn vocabulary(&self, whole: &Vocabulary, names: &[String]) -> Result<Vocabulary> {
        let all = whole.primitives();
        let moved: Vec<Vec<f64>> = all.iter().map(|p| Moved::of(p).ranges).collect();
        let own: Vec<f64> = moved.iter().map(|m| turned(m, &self.joints)).collect();
        let most = own.iter().copied().fold(0.0, f64::max);
        if most <= MOVES_RAD {
            let moves = |name: &&str| {
                let joints = JointSet::named(whole.body(), &[name.to_string()]);
                joints.is_ok_and(|j| moved.iter().any(|m| turned(m, &j) > MOVES_RAD))
            };
            let parts: Vec<&str> = PARTS.into_iter().filter(moves).collect();
            return Err(Error::invalid(format!(
                "no primitive moves {}; the vocabulary's move {}",
                names.join(", "),
                parts.join(", ")
            )));
        }
        let kept: Vec<usize> = (0..all.len()).filter(|&k| own[k] >= SHARE * most).collect();
        let of = |k: &usize| self.primitive(&all[*k]);
        let primitives: Vec<Primitive> = kept.iter().map(of).collect::<Result<_>>()?;
        let pairs = kept.iter().flat_map(|&a| kept.iter().map(move |&b| (a, b)));
        let transitions = Transitions {
            counts: pairs
                .map(|(a, b)| whole.transitions().count(a, b))
                .collect(),
            n: kept.len(),
        };
        let is_kept = |name: &String| primitives.iter().any(|p| p.name() == name);
        let behaviors = whole.behaviors().iter().cloned().map(|mut behavior| {
            behavior.primitives.retain(is_kept);
            behavior
        });
        let behaviors = behaviors.filter(|b| !b.primitives.is_empty()).collect();
        Vocabulary::new(Arc::clone(whole.body()), primitives, behaviors, transitions)
    }

    /// A primitive whose exemplars move the part alone, registered and parametrised as they were.
    fn primitive(&self, whole: &Primitive) -> Result<Primitive> {
        let of = |e: &Exemplar| {
            Ok(Exemplar {
                motion: self.motion(&e.motion)?,
                ..e.clone()
            })
        };
        let exemplars = whole.exemplars().iter().map(of).collect::<Result<_>>()?;
        let (fit, group) = (whole.fitted().clone(), whole.group().copied());
        Primitive::from_fit(whole.name(), exemplars, fit, group)
    }

    /// What stands at a pose of the part, and of neutral joints.
    fn pose(&self, body: &Skeleton, pose: &[f64]) -> Vec<f64> {
        let mut seen = self.neutral.clone();
        for j in (0..body.joints().len()).filter(|&j| self.joints.holds(j)) {
            let own = body.coordinates(j);
            seen[own.clone()].copy_from_slice(&pose[own]);
        }
        seen
    }

    /// Flags of missing joints, of which none is beyond the part; empty stays empty.
    fn missing(&self, body: &Skeleton, missing: &[bool]) -> Vec<bool> {
        match missing.is_empty() {
            true => Vec::new(),
            false => (0..body.joints().len())
                .map(|j| missing[j] && self.joints.holds(j))
                .collect(),
        }
    }

    fn motion(&self, motion: &Motion) -> Result<Motion> {
        let body = motion.skeleton();
        let poses = (0..motion.frames()).flat_map(|f| self.pose(body, motion.pose(f)));
        let roots = match self.root {
            true => motion.roots().to_vec(),
            false => vec![Root::ORIGIN; motion.frames()],
        };
        Motion::new(
            motion.name(),
            Arc::clone(body),
            motion.rate_hz(),
            poses.collect(),
            roots,
        )
    }
}

/// By how much these joints are turned altogether, radians.
fn turned(ranges: &[f64], joints: &JointSet) -> f64 {
    let own = (0..ranges.len()).filter(|&j| joints.holds(j));
    own.map(|j| ranges[j]).sum()
}

/// A recogniser that looks at a part of the body ([`Restriction::recogniser`]).
pub struct Restricted<'r> {
    restriction: &'r Restriction,
    of_part: Box<dyn Recogniser + 'r>,
}

impl Recogniser for Restricted<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.of_part.vocabulary()
    }

    fn is_binary(&self) -> bool {
        self.of_part.is_binary()
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Attentive {
            restriction: self.restriction,
            of_part: self.of_part.listen(),
        })
    }

    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        self.of_part
            .recognise(&self.restriction.observations(seen)?)
    }
}

/// A listener that looks at a part of the body.
struct Attentive<'r> {
    restriction: &'r Restriction,
    of_part: Box<dyn Listener + 'r>,
}

impl Listener for Attentive<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let Restriction { vocabulary, part } = self.restriction;
        let body = vocabulary.body();
        // What is no posture of the body the listener itself refuses.
        if seen.pose.len() != body.dof()
            || !(seen.missing.is_empty() || seen.missing.len() == body.joints().len())
        {
            return self.of_part.hear(seen);
        }
        self.of_part.hear(&Observation {
            secs: seen.secs,
            pose: &part.pose(body, seen.pose),
            root: match part.root {
                true => seen.root,
                false => Some(Root::ORIGIN),
            },
            missing: &part.missing(body, seen.missing),
        })
    }
}
