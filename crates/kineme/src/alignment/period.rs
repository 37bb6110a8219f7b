//! Is a whole sequence periodic, and with which period?

use super::dtw::{frames_of, squared_distance};
use crate::error::{Error, Result};

/// Rate at which a sequence is compared with itself; body movement holds nothing faster that repeats.
const COMPARED_HZ: f64 = 30.0;
/// Periods looked for, seconds.
const PERIODS_SECS: (f64, f64) = (0.2, 4.0);
/// Cycles that a sequence must hold at least; fewer say nothing of repetition.
const LEAST_CYCLES: f64 = 1.9;
/// How much sooner or later than the period a posture may come again, as a share of it.
const TEMPO: f64 = 0.1;
/// No more than this in seconds, however: a hand is raised in a fifth of a second, which must not be passed over.
const SHORT_SECS: f64 = 0.1;
/// Mean distance from the frame exactly a lag later, above which a sequence does not repeat at all: the leeway in tempo
/// would find likenesses in noise.
const UNLIKE: f64 = 0.75;
/// A shorter period is preferred when it repeats almost as well as the best: multiples of a period are periods.
const NEARLY: f64 = 0.1;

/// The period of a sequence that repeats itself from its first frame to its last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    /// One cycle, in frames of the sequence, with a fraction.
    pub frames: f64,
    /// 1 for perfect repetition, towards 0 where some moment of the sequence is as unlike its repetition as two
    /// frames drawn at random are.
    pub regularity: f64,
}

/// The period of a sequence (row-major, `dims` numbers a frame) if the *whole* of it is periodic.
///
/// Each frame is compared with the one a lag later (a tenth of the lag sooner or later allowed, as people do not keep
/// time exactly), in units of the sequence's own variance, so that frames drawn at random score 1: the difference
/// function of de Cheveigné and Kawahara (2002). A mean over the sequence would call a wave periodic that is raised
/// before and lowered after; so the worst moment (a quarter of the lag, at most 0.2 s) decides. Periods from 0.2 to 4 s are looked for, in
/// sequences of at least 1.9 cycles.
///
/// # Errors
/// As for [`align`](super::align), and when the rate is not positive.
pub fn period(sequence: &[f64], dims: usize, rate_hz: f64) -> Result<Option<Period>> {
    frames_of(sequence, dims)?;
    if !rate_hz.is_finite() || rate_hz <= 0.0 {
        return Err(Error::invalid(format!(
            "a rate must be positive, found {rate_hz} Hz"
        )));
    }
    let step = (rate_hz / COMPARED_HZ).round().max(1.0) as usize;
    let rows: Vec<&[f64]> = sequence.chunks_exact(dims).step_by(step).collect();
    let rate_hz = rate_hz / step as f64;
    let Some(itself) = SelfDistance::new(rows) else {
        return Ok(None);
    };
    let n = itself.rows.len();
    let longest = (PERIODS_SECS.1 * rate_hz).min((n - 1) as f64 / LEAST_CYCLES) as usize;
    let shortest = (PERIODS_SECS.0 * rate_hz).ceil().max(2.0) as usize;
    let most = (SHORT_SECS * rate_hz).round().max(1.0) as usize;
    let means: Vec<f64> = (0..=longest + 1).map(|lag| itself.mean(lag)).collect();
    let mut best: Option<(f64, Period)> = None;
    for lag in shortest..=longest {
        let (before, here, after) = (means[lag - 1], means[lag], means[lag + 1]);
        // Only where it comes back to itself: every slow movement is like itself a moment later.
        if here >= before || here > after || here > UNLIKE {
            continue;
        }
        let loose = itself.loose(lag, ((TEMPO * lag as f64).round() as usize).min(most));
        let mean = loose.iter().sum::<f64>() / loose.len() as f64;
        let worst = worst_window(&loose, (lag / 8).clamp(1, most));
        if worst < 1.0 && best.is_none_or(|(b, _)| mean < b - NEARLY) {
            let found = Period {
                frames: (lag as f64 + vertex(before, here, after)) * step as f64,
                regularity: 1.0 - worst,
            };
            best = Some((mean, found));
        }
    }
    Ok(best.map(|(_, period)| period))
}

/// Where between -0.5 and 0.5 the parabola through three values at -1, 0, 1 is least; the middle one is.
pub(super) fn vertex(before: f64, here: f64, after: f64) -> f64 {
    let bend = before - 2.0 * here + after;
    if bend > 0.0 {
        (0.5 * (before - after) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

/// Distances of a sequence's frames in units of twice its variance: 1 in the mean of all pairs.
struct SelfDistance<'a> {
    rows: Vec<&'a [f64]>,
    unit: f64,
}

impl<'a> SelfDistance<'a> {
    /// `None` for what never moves.
    fn new(rows: Vec<&'a [f64]>) -> Option<Self> {
        let n = rows.len() as f64;
        let mut mean = vec![0.0; rows[0].len()];
        for row in &rows {
            for (m, v) in mean.iter_mut().zip(*row) {
                *m += v / n;
            }
        }
        let squares: f64 = rows.iter().map(|r| squared_distance(r, &mean)).sum();
        let unit = 2.0 * squares / n;
        (unit.is_finite() && unit > 0.0).then_some(Self { rows, unit })
    }

    fn between(&self, s: usize, t: usize) -> f64 {
        squared_distance(self.rows[s], self.rows[t]) / self.unit
    }

    fn mean(&self, lag: usize) -> f64 {
        let count = self.rows.len().saturating_sub(lag);
        let sum: f64 = (0..count).map(|t| self.between(t, t + lag)).sum();
        sum / count.max(1) as f64
    }

    /// For each frame the least distance to a frame about a lag later.
    fn loose(&self, lag: usize, slack: usize) -> Vec<f64> {
        let last = self.rows.len() - 1;
        (0..=last - lag)
            .map(|t| {
                (t + lag - slack..=(t + lag + slack).min(last))
                    .map(|u| self.between(t, u))
                    .fold(f64::INFINITY, f64::min)
            })
            .collect()
    }
}

/// The greatest mean over windows of `2 half + 1` values, shorter ones at the ends.
fn worst_window(values: &[f64], half: usize) -> f64 {
    (0..values.len())
        .map(|t| {
            let window = &values[t.saturating_sub(half)..(t + half + 1).min(values.len())];
            window.iter().sum::<f64>() / window.len() as f64
        })
        .fold(0.0, f64::max)
}
