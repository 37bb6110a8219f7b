//! What the paper could not test: movements played backward, and arms of different executions together.

use std::sync::Arc;

use kineme::primitive::Observations;
use kineme::{Motion, Role, Root, Vocabulary};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::clip::Clip;
use super::movements::{RATE_HZ, drawn};
use crate::sets::Result;

/// The executions of a hybrid lie at least so far apart in one of their parameters, of a range of 1.
pub const HYBRID_APART: f64 = 0.6;
/// Movements of fewer frames are no clip of their own: they were interrupted at once.
const LEAST_FRAMES: usize = 24;

const LEFT_ARM: [Role; 5] = [
    Role::LeftShoulder,
    Role::LeftUpperArm,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::LeftFingers,
];

/// The movements of a clip, each by itself.
///
/// # Errors
/// Never for a clip that has as many truths as frames.
pub fn cut_out(clip: &Clip) -> Result<Vec<Clip>> {
    let mut cut = Vec::new();
    let mut start = 0;
    for run in clip.truth.chunk_by(|a, b| a == b) {
        let range = start..start + run.len();
        start = range.end;
        if run[0].is_none() || run.len() < LEAST_FRAMES {
            continue;
        }
        cut.push(Clip {
            name: format!("{} from {}", clip.name, range.start),
            truth: run.to_vec(),
            seen: Observations::complete(clip.motion().slice(range)?),
        });
    }
    Ok(cut)
}

/// A clip played backward; none of the behaviours.
///
/// # Errors
/// Never for a valid motion.
pub fn reversed(clip: &Clip) -> Result<Clip> {
    let motion = clip.motion();
    let frames = (0..motion.frames()).rev();
    let poses = frames.clone().flat_map(|f| motion.pose(f).to_vec());
    let roots = frames.map(|f| *motion.root(f)).collect();
    let body = Arc::clone(motion.skeleton());
    let back = Motion::new(
        motion.name(),
        body,
        motion.rate_hz(),
        poses.collect(),
        roots,
    )?;
    Ok(Clip::negative(&clip.name, back))
}

/// So many movements of each primitive in which the left arm does what it does at other parameters than the rest of the
/// body, at the same phases. None of the behaviours: no parameters make them.
///
/// # Errors
/// Of no valid vocabulary.
pub fn hybrids(vocabulary: &Vocabulary, each: usize, seed: u64) -> Result<Vec<Clip>> {
    let body = vocabulary.body();
    let left = LEFT_ARM.iter().flat_map(|role| body.joints_of(*role));
    let left: Vec<usize> = left.flat_map(|j| body.coordinates(j)).collect();
    let mut random = Pcg64::seed_from_u64(seed);
    let mut clips = Vec::new();
    for primitive in vocabulary.primitives() {
        for k in 0..each {
            let one = drawn(primitive, &mut random);
            let apart = |other: &[f64]| {
                let gaps = one.iter().zip(other).map(|(a, b)| (a - b).abs());
                gaps.fold(0.0, f64::max) >= HYBRID_APART
            };
            // A corner is far enough from anything, if nothing drawn is.
            let corner: Vec<f64> = one.iter().map(|v| f64::from(u8::from(*v < 0.5))).collect();
            let other = (0..100).map(|_| drawn(primitive, &mut random));
            let other = other.into_iter().find(|p| apart(p)).unwrap_or(corner);
            let (own, foreign) = (primitive.at(&one)?, primitive.at(&other)?);
            let frames = (own.duration_secs() * RATE_HZ).ceil() as usize;
            let mut poses = Vec::with_capacity((frames + 1) * body.dof());
            for f in 0..=frames {
                let phase = own.phase_at(f as f64 / RATE_HZ);
                let mut pose = own.pose(phase);
                let arm = foreign.pose(phase);
                for &c in &left {
                    pose[c] = arm[c];
                }
                poses.extend(pose);
            }
            let name = format!("{} {k}", primitive.name());
            let roots = vec![Root::ORIGIN; frames + 1];
            let motion = Motion::new(&name, Arc::clone(body), RATE_HZ, poses, roots)?;
            clips.push(Clip::negative(&name, motion));
        }
    }
    Ok(clips)
}
