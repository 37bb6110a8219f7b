//! Evidence of whole clips: how probable the clip is if one row was followed from its beginning to its end.

use super::chain::{Kernel, LOOSE};
use super::emission::{Emission, Fit};
use super::features::Feature;
use super::rows::Row;

/// Entering late and leaving early becomes improbable over so much phase.
const ENDS: f64 = 0.12;
/// Seconds that the body rests before it begins, or after it has ended, on average.
const REST_SECS: f64 = 0.3;
/// Probability that a movement that has ended begins again.
const AGAIN: f64 = 0.1;

/// How much an outline counts a second: about as much as one direction of the hands and one of the body.
const OUTLINE_TRUST: f64 = 7.0;

/// How much squared distances of the whole clip count a second, beside those of its moments: none below 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Trusts {
    /// Of routes: where people went their own ways, hardly at all.
    pub route: f64,
    /// Of shapes: where the pace tells movements apart, or postures are noise, hardly at all.
    pub shape: f64,
}

/// What a clip says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Evidence {
    /// Log-likelihood of each row by its postures.
    pub rows: Vec<f64>,
    /// Squared distance of each row's route, in deviations; `None` where routes tell nothing.
    pub routes: Option<Vec<f64>>,
    /// Squared distance a second of each row's shape; `None` where rows have none.
    pub shapes: Option<Vec<f64>>,
    /// Squared distance of each row's outline, in deviations; `None` where rows have none or not all was seen.
    pub outlines: Option<Vec<f64>>,
    /// Log-likelihood of movement of no known kind.
    pub broad: f64,
    /// Seconds of the clip.
    pub secs: f64,
}

impl Evidence {
    /// Seconds that evidence is divided by, however short the clip.
    pub fn lasts(&self) -> f64 {
        self.secs.max(0.1)
    }

    /// What a stream knows of it: moments alone.
    pub fn of_moments(&self) -> Self {
        Self {
            routes: None,
            shapes: None,
            outlines: None,
            ..self.clone()
        }
    }

    /// Log-likelihood of each row by its postures from moment to moment, its route, its shape and its outline.
    pub fn weighed(&self, trusts: Trusts) -> Vec<f64> {
        let mut rows = self.rows.clone();
        for (trust, distances) in [
            (trusts.route, &self.routes),
            (trusts.shape, &self.shapes),
            (OUTLINE_TRUST, &self.outlines),
        ] {
            for (log, distance) in rows.iter_mut().zip(distances.iter().flatten()) {
                *log -= 0.5 * trust * self.lasts() * distance;
            }
        }
        rows
    }
}

/// The forward pass over all rows, each by itself: the row is held through the clip.
///
/// `moments` are features and the seconds since the one before. The likelihood is tempered (its unit is a second of
/// independent evidence, not a frame), so rows can be compared, not read as densities.
pub(super) fn evidence<'a>(
    rows: &[Row],
    emission: &Emission,
    moments: impl Iterator<Item = (&'a Feature, f64)>,
) -> Evidence {
    let states = rows.iter().map(|r| r.phases.len()).sum();
    let mut mass = vec![0.0; states];
    let mut next = vec![0.0; rows.iter().map(|r| r.phases.len()).max().unwrap_or(0)];
    let mut logs = vec![0.0; rows.len()];
    let mut fit = Fit::default();
    let (mut broad, mut secs) = (0.0, 0.0);
    let mut kernels: (f64, Vec<Kernel>) = (f64::NAN, Vec::new());
    for (t, (feature, dt)) in moments.enumerate() {
        emission.fit(feature, &mut fit);
        broad += dt * fit.broad;
        secs += dt;
        if (kernels.0 - dt).abs() > 1e-9 || kernels.1.is_empty() {
            kernels = (dt, rows.iter().map(|r| Kernel::of(r, dt, LOOSE)).collect());
        }
        let stay = (-dt / REST_SECS).exp();
        let mut first = 0;
        for (r, row) in rows.iter().enumerate() {
            let n = row.phases.len();
            let own = &mut mass[first..first + n];
            let next = &mut next[..n];
            if t == 0 {
                begin(row, next);
            } else {
                let beyond = kernels.1[r].advance(row.cyclic, own, next);
                if !row.cyclic {
                    // Rest before the beginning and after the end, and the way from the end to the beginning.
                    for (x, m) in next.iter_mut().zip(own.iter()).take(1) {
                        *x = x.max(stay * m);
                    }
                    let ended = stay * own[n - 1] + beyond;
                    next[n - 1] += ended;
                    next[0] += AGAIN * ended * (1.0 - stay);
                }
            }
            let best = fit.states[first..first + n]
                .iter()
                .zip(next.iter())
                .filter(|(_, x)| **x > 0.0)
                .map(|(e, _)| dt * e)
                .fold(f64::NEG_INFINITY, f64::max);
            let mut total = 0.0;
            for ((m, x), e) in own.iter_mut().zip(next.iter()).zip(&fit.states[first..]) {
                // Out of reach, a state may fit beyond all bounds.
                *m = if *x > 0.0 {
                    x * (dt * e - best).exp()
                } else {
                    0.0
                };
                total += *m;
            }
            for m in own.iter_mut() {
                *m /= total;
            }
            logs[r] += best + total.ln();
            first += n;
        }
    }
    let mut first = 0;
    for (row, log) in rows.iter().zip(&mut logs) {
        let n = row.phases.len();
        if !row.cyclic {
            let own = mass[first..first + n].iter().zip(&row.progress);
            *log += own
                .map(|(m, p)| m * ((p - 1.0) / ENDS).exp())
                .sum::<f64>()
                .max(1e-300)
                .ln();
        }
        first += n;
    }
    Evidence {
        rows: logs,
        routes: None,
        shapes: None,
        outlines: None,
        broad,
        secs,
    }
}

/// Where a row begins: near phase 0; a cycle anywhere.
fn begin(row: &Row, mass: &mut [f64]) {
    for (m, p) in mass.iter_mut().zip(&row.progress) {
        *m = if row.cyclic { 1.0 } else { (-p / ENDS).exp() };
    }
    let total: f64 = mass.iter().sum();
    for m in mass.iter_mut() {
        *m /= total;
    }
}
