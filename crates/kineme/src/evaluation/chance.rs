//! How far answers of exactly right probabilities would seem miscalibrated, as the clips are few.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::bootstrap::Bootstrap;
use super::clips::Judged;
use super::measures::Sample;
use crate::error::Result;
use crate::math::statistics::quantile;

/// The calibration error that exactly right probabilities show by chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByChance {
    /// In the mean of the draws: what of a measured error needs no explanation.
    pub mean: f64,
    /// In all but the least probable draws, a share of one less the level: a measured error above it is no chance.
    pub high: f64,
}

/// What [`super::Scores::calibration_error`] would be by chance alone, were every answer right exactly as often as it
/// says. `None` where posteriors do not sum to 1.
///
/// Consistency resampling (Broecker and Smith 2007), the probabilities kept as they are: in each draw of `bootstrap` an
/// answer of probability c counts as right with probability c. `clips` holds the answers to each clip: one, or one of
/// each split in which it was asked; those to one clip are drawn together, the surer right whenever the less sure is, as
/// a clip that is hard is so in every split.
///
/// # Errors
/// As for [`super::scores`].
pub fn calibration_by_chance(
    clips: &[&[Judged]],
    bootstrap: &Bootstrap,
) -> Result<Option<ByChance>> {
    let sample = Sample::new(&clips.concat())?;
    bootstrap.check(clips.len())?;
    if !sample.is_probabilistic() {
        return Ok(None);
    }
    let mut random = Pcg64::seed_from_u64(bootstrap.seed);
    let mut fates = Vec::new();
    let draw = |_| {
        fates.clear();
        for answers in clips {
            let fate: f64 = random.random();
            fates.extend(answers.iter().map(|_| fate));
        }
        sample.calibration_error(|answer, confidence| fates[answer] < confidence)
    };
    let drawn: Vec<f64> = (0..bootstrap.draws).map(draw).collect();
    let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
    Ok(Some(ByChance {
        mean,
        high: quantile(&drawn, bootstrap.level).unwrap_or(mean),
    }))
}
