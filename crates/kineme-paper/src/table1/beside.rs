//! What stands beside Table I: damage, what no body did, people who strike or wave, and times.

use std::time::Instant;

use kineme::Vocabulary;
use kineme::math::statistics::quantile;
use rayon::prelude::*;

use super::captured::Captured;
use super::clip::{Altered, Clip};
use super::disturbed::{cut_out, hybrids, reversed};
use super::row::{Table, Timing};
use super::run::{FEW, Judge, SETS};
use crate::recognition::damage::Damage;
use crate::sets::Result;

/// A behaviour counts as affirmed in a recording when it is for so long, seconds.
const AFFIRMED_SECS: f64 = 0.1;
/// Hybrids of each primitive.
const HYBRIDS: usize = 20;

/// Damage to the first set.
const DAMAGES: [Damage; 7] = [
    Damage::NoiseDeg(0.25),
    Damage::NoiseDeg(0.5),
    Damage::NoiseDeg(1.0),
    Damage::NoiseDeg(2.0),
    Damage::NoiseDeg(5.0),
    Damage::Lost,
    Damage::Stuck,
];

/// Damage to the first set, movements played backward, and hybrids.
pub(super) fn disturbed(
    table: &mut Table,
    vocabulary: &Vocabulary,
    own: &[Clip],
    seed: u64,
    watch: &mut dyn FnMut(&str),
) -> Result<()> {
    let judges: Vec<Judge> = FEW
        .iter()
        .map(|mode| Judge::new(*mode, vocabulary))
        .collect::<Result<_>>()?;
    for damage in DAMAGES {
        watch(&format!("{}: {}", SETS[0], damage.name()));
        let damaged = |(k, clip): (usize, &Clip)| -> Result<Clip> {
            Ok(Clip {
                seen: damage.of(seed ^ k as u64, clip.motion())?,
                ..clip.clone()
            })
        };
        let clips: Vec<Clip> = own.iter().enumerate().map(damaged).collect::<Result<_>>()?;
        let clips: Vec<&Clip> = clips.iter().collect();
        for judge in &judges {
            let row = judge.row(SETS[0], &clips, Altered::Nothing)?;
            table.damaged.push((damage.name(), row));
        }
    }
    let cut: Vec<Clip> = own
        .iter()
        .map(cut_out)
        .collect::<Result<Vec<_>>>()?
        .concat();
    let back: Vec<Clip> = cut.iter().map(reversed).collect::<Result<_>>()?;
    for (name, clips) in [
        ("movements, cut out", cut),
        ("the same backward", back),
        (
            "hybrids: another execution's left arm",
            hybrids(vocabulary, HYBRIDS, seed)?,
        ),
    ] {
        watch(name);
        let clips: Vec<&Clip> = clips.iter().collect();
        for judge in &judges {
            let tallies = judge.tallies(&clips, Altered::Nothing)?;
            let affirmed: u64 = tallies
                .iter()
                .map(|t| t.any.hits + t.any.false_alarms)
                .sum();
            let frames: u64 = tallies.iter().map(|t| t.frames).sum();
            let share = affirmed as f64 / frames as f64;
            table
                .impossible
                .push((name.into(), judge.mode, share, clips.len()));
        }
    }
    Ok(())
}

/// Recordings that left the third set, hands altered: in how many a behaviour is affirmed.
pub(super) fn left(
    table: &mut Table,
    vocabulary: &Vocabulary,
    captured: &Captured,
    watch: &mut dyn FnMut(&str),
) -> Result<()> {
    let mut kinds: Vec<&str> = captured
        .left
        .iter()
        .map(|(_, kind, _)| kind.as_str())
        .collect();
    kinds.sort_unstable();
    kinds.dedup();
    for mode in FEW {
        watch(&format!("{}: people who strike or wave", mode.name()));
        let judge = Judge::new(mode, vocabulary)?;
        let classes = vocabulary.primitives().len();
        let affirmed = |(clip, kind, _): &(Clip, String, _)| -> Result<(String, bool)> {
            let seen = Altered::Hands.of(clip, vocabulary)?;
            let decided = mode.decide(judge.recogniser.as_deref(), classes, &seen.seen)?;
            let least = (AFFIRMED_SECS * clip.motion().rate_hz()).round().max(1.0);
            let long = |k: usize| {
                let own: Vec<bool> = decided
                    .affirmed
                    .iter()
                    .skip(k)
                    .step_by(classes)
                    .copied()
                    .collect();
                own.chunk_by(|a, b| a == b)
                    .any(|run| run[0] && run.len() as f64 >= least)
            };
            Ok((kind.clone(), (0..classes).any(long)))
        };
        let answers: Vec<(String, bool)> = captured
            .left
            .par_iter()
            .map(affirmed)
            .collect::<Result<_>>()?;
        for kind in &kinds {
            let own = || answers.iter().filter(|(k, _)| k == kind);
            let yes = own().filter(|(_, yes)| *yes).count();
            table.left.push(((*kind).into(), mode, yes, own().count()));
        }
    }
    Ok(())
}

/// How long the decisions of each frame take, one after the other.
pub(super) fn timing(judge: &Judge, clip: &Clip) -> Result<Timing> {
    let mut micros = Vec::new();
    if let Some(recogniser) = &judge.recogniser {
        let mut listener = recogniser.listen();
        for f in 0..clip.motion().frames() {
            let begun = Instant::now();
            listener.hear(&clip.seen.at(f))?;
            micros.push(begun.elapsed().as_secs_f64() * 1e6);
        }
    }
    let at = |q| quantile(&micros, q).unwrap_or(f64::NAN);
    Ok(Timing {
        mode: judge.mode,
        frames: micros.len(),
        median_us: at(0.5),
        p99_us: at(0.99),
    })
}
