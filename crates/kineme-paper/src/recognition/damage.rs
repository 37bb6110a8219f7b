//! What noise, missing joints and another speed cost.

use std::fmt::Write as _;

use kineme::primitive::Observations;
use kineme::{Motion, Role};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::answers::{among_known, answers, mean, rights};
use super::corpora::{Corpus, Split};
use super::known::{Known, Method};
use crate::sets::Result;

/// What is done to a clip before it is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damage {
    /// Nothing.
    None,
    /// White noise on every coordinate, of this standard deviation.
    NoiseDeg(f64),
    /// Each joint missing in this share of the frames, independently.
    Missing(f64),
    /// One limb's joint missing throughout, announced.
    Lost,
    /// One limb's joint standing still at neutral, unannounced.
    Stuck,
    /// So many times as fast.
    Speed(f64),
}

/// All of them, in the order of the columns.
pub const DAMAGES: [Damage; 7] = [
    Damage::None,
    Damage::NoiseDeg(5.0),
    Damage::Missing(0.2),
    Damage::Lost,
    Damage::Stuck,
    Damage::Speed(0.5),
    Damage::Speed(2.0),
];

/// Joints that may be lost.
const LIMBS: [Role; 8] = [
    Role::LeftUpperArm,
    Role::RightUpperArm,
    Role::LeftLowerArm,
    Role::RightLowerArm,
    Role::LeftUpperLeg,
    Role::RightUpperLeg,
    Role::LeftLowerLeg,
    Role::RightLowerLeg,
];

impl Damage {
    /// The heading of its column.
    pub fn name(self) -> String {
        match self {
            Damage::None => "as recorded".into(),
            Damage::NoiseDeg(deg) => format!("noise of {deg}°"),
            Damage::Missing(share) => format!("{:.0} % missing", 100.0 * share),
            Damage::Lost => "one joint lost".into(),
            Damage::Stuck => "one joint stuck".into(),
            Damage::Speed(times) => format!("{times} times as fast"),
        }
    }

    /// A clip so damaged; `seed` draws what is to be drawn.
    ///
    /// # Errors
    /// When the body lacks the limbs, or a number is none that can be drawn from.
    pub fn of(self, seed: u64, motion: &Motion) -> Result<Observations> {
        let mut random = Pcg64::seed_from_u64(seed);
        let body = motion.skeleton();
        let joints = body.joints().len();
        let rate = motion.rate_hz();
        let with = |poses: Vec<f64>| {
            let roots = motion.roots().to_vec();
            Motion::new(motion.name(), body.clone(), rate, poses, roots)
        };
        let limb = |random: &mut Pcg64| {
            let role = LIMBS[random.random_range(0..LIMBS.len())];
            let joint = body.joints_of(role).first().copied();
            joint.ok_or_else(|| format!("`{}` lacks a limb", body.name()))
        };
        Ok(match self {
            Damage::None => Observations::complete(motion.clone()),
            Damage::NoiseDeg(deg) => {
                let noisy = |v: &f64| v + deg.to_radians() * normal(&mut random);
                Observations::complete(with(motion.poses().iter().map(noisy).collect())?)
            }
            Damage::Missing(share) => {
                let flags = (0..motion.frames() * joints).map(|_| random.random_bool(share));
                Observations::with_missing(motion.clone(), flags.collect())?
            }
            Damage::Lost => {
                let lost = limb(&mut random)?;
                let flags = (0..motion.frames() * joints).map(|k| k % joints == lost);
                Observations::with_missing(motion.clone(), flags.collect())?
            }
            Damage::Stuck => {
                let at = body.coordinates(limb(&mut random)?);
                let neutral = body.neutral();
                let mut poses = motion.poses().to_vec();
                for pose in poses.chunks_exact_mut(body.dof()) {
                    pose[at.clone()].copy_from_slice(&neutral[at.clone()]);
                }
                Observations::complete(with(poses)?)
            }
            Damage::Speed(times) => Observations::complete(at_speed(motion, times)?),
        })
    }
}

/// A draw of the standard normal distribution (Box and Muller 1958).
fn normal(random: &mut Pcg64) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

/// The motion so many times as fast, at the same rate.
fn at_speed(motion: &Motion, times: f64) -> Result<Motion> {
    let rate = motion.rate_hz();
    let r = motion.resampled(rate / times)?;
    let (poses, roots) = (r.poses().to_vec(), r.roots().to_vec());
    Ok(Motion::new(
        r.name(),
        r.skeleton().clone(),
        rate,
        poses,
        roots,
    )?)
}

/// Accuracy of each method under each damage, one in `every` clips asked.
///
/// # Errors
/// When a primitive cannot be learned or a clip not be recognised.
pub fn costs(corpus: &Corpus, methods: &[Method], every: usize) -> Result<Vec<Vec<Vec<f64>>>> {
    let mut right = vec![vec![Vec::new(); DAMAGES.len()]; methods.len()];
    for Split { train, test } in &corpus.splits {
        let known = Known::learn(&corpus.set, train)?;
        let some: Vec<usize> = test.iter().copied().step_by(every).collect();
        for (right, method) in right.iter_mut().zip(methods) {
            let recogniser = method.over(&known.vocabulary)?;
            for (right, damage) in right.iter_mut().zip(DAMAGES) {
                let seen = |clip: usize, motion: &Motion| damage.of(clip as u64, motion);
                let judged = answers(&*recogniser, &known, &corpus.set, &some, &seen)?;
                right.extend(rights(&among_known(&judged, recogniser.is_binary())));
            }
        }
    }
    Ok(right)
}

/// Writes the table of a set: accuracy as recorded, and what each damage takes from it.
///
/// # Errors
/// Without clips.
pub fn write_costs(
    out: &mut String,
    corpus: &Corpus,
    methods: &[Method],
    right: &[Vec<Vec<f64>>],
) -> Result<()> {
    let names: Vec<String> = DAMAGES.iter().map(|d| d.name()).collect();
    writeln!(
        out,
        "\n### {}, damaged: {} clips\n\n| method | {} |\n| --- {}|",
        corpus.name,
        right[0][0].len(),
        names.join(" | "),
        "| --- ".repeat(names.len())
    )?;
    for (method, right) in methods.iter().zip(right) {
        let means = right.iter().map(|r| Ok(mean(r, 1)?.value));
        let means = means.collect::<Result<Vec<f64>>>()?;
        let cost = |m: &f64| format!("{:.3} ({:+.3})", m, m - means[0]);
        let costs: Vec<String> = means[1..].iter().map(cost).collect();
        writeln!(
            out,
            "| {} | {:.3} | {} |",
            method.name(),
            means[0],
            costs.join(" | ")
        )?;
    }
    Ok(())
}
