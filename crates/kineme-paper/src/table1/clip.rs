//! [`Clip`]: a motion with what it shows frame by frame; the second data set; hands altered as in the paper.

use std::sync::Arc;

use kineme::choreography::perform;
use kineme::primitive::Observations;
use kineme::{Motion, Role, Skeleton, Vocabulary};

use super::movements::RATE_HZ;
use crate::sets::Result;

const ANIMATIONS: &str = include_str!("../../../../choreography/animations.toml");

/// Phases at which primitives are looked at for what they move.
const LOOKS: usize = 16;
/// A coordinate that varies by less is not moved, radians.
const UNMOVED_RAD: f64 = 1e-3;

/// A motion and its truth.
#[derive(Debug, Clone)]
pub struct Clip {
    /// Its name.
    pub name: String,
    /// What is seen.
    pub seen: Observations,
    /// Which behaviour each frame shows, an index into the vocabulary; `None`: none of them.
    pub truth: Vec<Option<usize>>,
}

impl Clip {
    /// A motion that shows none of the behaviours in any frame.
    pub fn negative(name: &str, motion: Motion) -> Self {
        Self {
            name: name.into(),
            truth: vec![None; motion.frames()],
            seen: Observations::complete(motion),
        }
    }

    /// The motion.
    pub fn motion(&self) -> &Motion {
        self.seen.motion()
    }
}

/// The second data set: the animations of `choreography/`, none of which is one of the behaviours.
///
/// # Errors
/// Never for the embedded script on a built-in body.
pub fn animations(body: &Arc<Skeleton>) -> Result<Vec<Clip>> {
    let script = kineme_formats::script::parse("animations.toml", ANIMATIONS.as_bytes())?;
    let clip = |animation: &kineme::choreography::ScriptAnimation| -> Result<Clip> {
        let motion = perform(&animation.name, &animation.keys, body, RATE_HZ)?;
        Ok(Clip::negative(&animation.name, motion))
    };
    script.animations.iter().map(clip).collect()
}

/// What of a motion is replaced by the posture that all behaviours begin with, before anybody looks at it.
///
/// The authors altered the hands of their second and third set, so that an open hand would not give negatives away. The
/// wrists of our primitives move; theirs take the posture of the guard as well, for wrists are what captures have least.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Altered {
    /// Nothing.
    Nothing,
    /// Wrists and fingers.
    Hands,
    /// These, and every joint that no behaviour moves: the legs, which would give away whoever walks.
    Unmoved,
}

impl Altered {
    /// Its name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Altered::Nothing => "as captured",
            Altered::Hands => "hands altered",
            Altered::Unmoved => "hands and legs altered",
        }
    }

    /// The joints that are altered.
    ///
    /// # Errors
    /// When a primitive cannot be looked at.
    pub fn joints(self, vocabulary: &Vocabulary) -> Result<Vec<usize>> {
        let body = vocabulary.body();
        let hands = [
            Role::LeftHand,
            Role::LeftFingers,
            Role::RightHand,
            Role::RightFingers,
        ];
        let mut joints = match self {
            Altered::Nothing => return Ok(Vec::new()),
            Altered::Hands => Vec::new(),
            Altered::Unmoved => unmoved(vocabulary)?,
        };
        joints.extend(hands.iter().flat_map(|role| body.joints_of(*role)));
        joints.sort_unstable();
        joints.dedup();
        Ok(joints)
    }

    /// A clip so altered: these joints have the posture of the first primitive's beginning throughout.
    ///
    /// # Errors
    /// When a primitive cannot be looked at.
    pub fn of(self, clip: &Clip, vocabulary: &Vocabulary) -> Result<Clip> {
        let joints = self.joints(vocabulary)?;
        if joints.is_empty() {
            return Ok(clip.clone());
        }
        let guard = &vocabulary.primitives()[0];
        let guard = guard.pose(&guard.middle(), 0.0)?;
        let motion = clip.motion();
        let body = motion.skeleton();
        let mut poses = motion.poses().to_vec();
        for pose in poses.chunks_exact_mut(body.dof()) {
            for &joint in &joints {
                let at = body.coordinates(joint);
                pose[at.clone()].copy_from_slice(&guard[at]);
            }
        }
        let (rate, roots) = (motion.rate_hz(), motion.roots().to_vec());
        let motion = Motion::new(motion.name(), body.clone(), rate, poses, roots)?;
        Ok(Clip {
            name: clip.name.clone(),
            seen: Observations::complete(motion),
            truth: clip.truth.clone(),
        })
    }
}

/// The joints that no primitive of the vocabulary moves.
///
/// # Errors
/// When a primitive cannot be looked at.
pub fn unmoved(vocabulary: &Vocabulary) -> Result<Vec<usize>> {
    let body = vocabulary.body();
    let first = &vocabulary.primitives()[0];
    let mut low = first.pose(&first.middle(), 0.0)?;
    let mut high = low.clone();
    for primitive in vocabulary.primitives() {
        for e in 0..primitive.exemplars().len() {
            let course = primitive.at(primitive.point(e))?;
            for k in 0..=LOOKS {
                let pose = course.pose(k as f64 / LOOKS as f64);
                for ((low, high), v) in low.iter_mut().zip(&mut high).zip(pose) {
                    *low = low.min(v);
                    *high = high.max(v);
                }
            }
        }
    }
    let still = |j: &usize| {
        body.coordinates(*j)
            .all(|c| high[c] - low[c] <= UNMOVED_RAD)
    };
    Ok((0..body.joints().len()).filter(still).collect())
}
