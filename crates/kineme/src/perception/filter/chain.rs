//! Chains: how phase may go on along a row, from one moment of a stream to the next.

use super::rows::Row;

/// People do a movement at two fifths to five halves of the pace of its row; a body that carries it out, hardly faster
/// or slower.
pub(super) const LOOSE: [f64; 2] = [0.4, 2.5];
pub(super) const TIGHT: [f64; 2] = [0.9, 1.11];
/// Paces at which the advance is looked at.
const PACES: usize = 17;

/// The advance of a row in some time: probabilities of going on by so many moments.
#[derive(Debug, Clone, Default)]
pub(super) struct Kernel {
    /// Probability of an advance of `first + k` moments.
    weights: Vec<f64>,
    first: usize,
}

impl Kernel {
    /// The advance in `secs`: paces log-uniform between the slowest and the fastest, spread over the two moments between which
    /// each comes to lie.
    pub fn of(row: &Row, secs: f64, [slowest, fastest]: [f64; 2]) -> Self {
        let advance = |k: usize| {
            let share = k as f64 / (PACES - 1) as f64;
            let pace = slowest * (fastest / slowest).powf(share);
            // No advance goes once round: what is beyond cannot be told from less.
            (secs / row.step_secs * pace).min(row.phases.len() as f64 - 1.0)
        };
        let first = advance(0).floor() as usize;
        let last = advance(PACES - 1).floor() as usize + 1;
        let mut weights = vec![0.0; last - first + 1];
        for k in 0..PACES {
            let at = advance(k);
            let below = at.floor();
            let i = below as usize - first;
            weights[i] += (1.0 - (at - below)) / PACES as f64;
            weights[i + 1] += (at - below) / PACES as f64;
        }
        Self { weights, first }
    }

    /// Mass after the advance; `next` is overwritten. What passes the end of a row that is no cycle is returned.
    pub fn advance(&self, cyclic: bool, mass: &[f64], next: &mut [f64]) -> f64 {
        let n = mass.len();
        next.fill(0.0);
        let mut beyond = 0.0;
        for (k, w) in self.weights.iter().enumerate() {
            let by = self.first + k;
            if cyclic {
                let by = by % n;
                let (head, tail) = mass.split_at(n - by);
                for (x, m) in next[by..].iter_mut().zip(head) {
                    *x += w * m;
                }
                for (x, m) in next[..by].iter_mut().zip(tail) {
                    *x += w * m;
                }
            } else {
                let kept = n - by.min(n);
                for (x, m) in next[n - kept..].iter_mut().zip(&mass[..kept]) {
                    *x += w * m;
                }
                beyond += w * mass[kept..].iter().sum::<f64>();
            }
        }
        beyond
    }

    /// The step backward, for smoothing: what each moment is worth when its successors are worth so much, and going
    /// beyond the end is worth `end`.
    pub fn retreat(&self, cyclic: bool, worth: &[f64], end: f64, before: &mut [f64]) {
        let n = worth.len();
        before.fill(0.0);
        for (k, w) in self.weights.iter().enumerate() {
            let by = self.first + k;
            let (kept, round) = match cyclic {
                true => (n - by % n, by % n),
                false => (n - by.min(n), 0),
            };
            for (x, v) in before[..kept].iter_mut().zip(&worth[n - kept..]) {
                *x += w * v;
            }
            for (x, v) in before[kept..].iter_mut().zip(&worth[..round]) {
                *x += w * v;
            }
            if !cyclic {
                for x in &mut before[kept..] {
                    *x += w * end;
                }
            }
        }
    }
}
