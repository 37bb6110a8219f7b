//! What is answered, and how many answers are right.

use kineme::math::statistics::quantile;
use kineme::primitive::Posterior;

use super::questions::{Question, SETS, Truth};

/// The share of the fitting motions of the tuning half that the limit of the refusal keeps.
const KEPT: f64 = 0.98;

/// What was answered to a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The motion.
    pub question: Question,
    /// The likeliest set, whether or not it was refused.
    pub leading: usize,
    /// Whether it was refused: rest or none is at least as probable, or the cost is above the limit.
    pub refused: bool,
}

impl Answer {
    /// What is answered where the primitives of the vocabulary are of these sets.
    pub fn of(question: &Question, posterior: &Posterior, sets: &[usize]) -> Self {
        let mut shares = [0.0; SETS.len()];
        for (p, &set) in posterior.primitives.iter().zip(sets) {
            shares[set] += p;
        }
        let leading = least(&shares.map(|s| -s));
        Self {
            question: question.clone(),
            leading,
            refused: posterior.rest.max(posterior.none) >= shares[leading],
        }
    }

    /// The set that costs least, refused above a limit of what is left unsaid. Without costs no hand moves, and it is
    /// refused.
    pub fn cheapest(question: &Question, costs: Option<&Costs>, limit: f64) -> Self {
        Self {
            question: question.clone(),
            leading: costs.map_or(0, |c| least(&c.sets)),
            refused: costs.is_none_or(|c| c.unsaid > limit),
        }
    }

    /// The answer: refused is none.
    pub fn set(&self) -> Truth {
        (!self.refused).then_some(self.leading)
    }

    /// Whether the answer is the truth.
    pub fn is_right(&self) -> bool {
        self.set() == self.question.truth
    }
}

/// What it costs to say a movement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    /// In each set, units of the encoder.
    pub sets: [f64; SETS.len()],
    /// How much the best set leaves unsaid: what it costs, as a share of what it costs to predict that nothing moves.
    pub unsaid: f64,
}

/// The first least of the values.
fn least(values: &[f64; SETS.len()]) -> usize {
    let mut best = 0;
    for k in 1..SETS.len() {
        if values[k] < values[best] {
            best = k;
        }
    }
    best
}

/// The limit above which what is left unsaid is refused: what 98 in 100 motions of the tuning half that resemble a set
/// stay below.
pub fn limit(asked: &[(Question, Option<Costs>)]) -> f64 {
    let own = asked.iter().filter(|(q, _)| q.tuned() && q.truth.is_some());
    let unsaid: Vec<f64> = own.filter_map(|(_, c)| Some((*c)?.unsaid)).collect();
    quantile(&unsaid, KEPT).unwrap_or(f64::INFINITY)
}

/// The interval of 95 in 100 for a share of which `part` of `whole` was drawn (Wilson 1927).
pub fn wilson(part: usize, whole: usize) -> (f64, f64) {
    const Z: f64 = 1.959_963_984_540_054;
    if whole == 0 {
        return (0.0, 1.0);
    }
    let n = whole as f64;
    let p = part as f64 / n;
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((middle - half).max(0.0), (middle + half).min(1.0))
}

/// Of the answers to motions that resemble a set: how many were answered by it, with refusals counting as wrong; how many
/// have it as their likeliest, refused or not; and how many there are.
pub fn right<'a>(answers: impl Iterator<Item = &'a Answer>) -> (usize, usize, usize) {
    let (mut answered, mut leading, mut all) = (0, 0, 0);
    for a in answers.filter(|a| a.question.truth.is_some()) {
        answered += usize::from(a.is_right());
        leading += usize::from(Some(a.leading) == a.question.truth);
        all += 1;
    }
    (answered, leading, all)
}

/// Of the answers to motions that fit none: how many are refusals, and how many there are.
pub fn refused<'a>(answers: impl Iterator<Item = &'a Answer>) -> (usize, usize) {
    let (mut refused, mut all) = (0, 0);
    for a in answers.filter(|a| a.question.truth.is_none()) {
        refused += usize::from(a.refused);
        all += 1;
    }
    (refused, all)
}
