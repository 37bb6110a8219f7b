//! The two manners in which a stream may move: like the exemplars, as people do, or by the primitives themselves, as a
//! body does that carries them out. A manner hardly ever changes.

use super::chain::{Kernel, LOOSE, TIGHT};
use super::recogniser::Filter;
use super::rows::Row;
use super::track::{Mass, Network};

/// Chance a second that the manner changes.
const CHANGE: f64 = 0.0001;

/// What is believed in each manner: probabilities, which all together sum to one, or what they are worth.
#[derive(Debug, Clone)]
pub(super) struct Belief {
    /// Like the exemplars.
    pub alike: Mass,
    /// By the primitives themselves; nothing where that cannot be told from the other.
    pub exact: Option<Mass>,
}

/// How rows go on in each manner.
#[derive(Debug, Clone)]
pub(super) struct Kernels {
    pub secs: f64,
    alike: Vec<Kernel>,
    exact: Vec<Kernel>,
}

impl Kernels {
    pub fn of(rows: &[Row], secs: f64, both: bool) -> Self {
        let within = |paces| rows.iter().map(|r| Kernel::of(r, secs, paces)).collect();
        Self {
            secs,
            alike: within(LOOSE),
            exact: if both { within(TIGHT) } else { Vec::new() },
        }
    }
}

impl Belief {
    /// Both manners alike probable.
    pub fn prior(mass: Mass, both: bool) -> Self {
        match both {
            true => Self {
                alike: mass.times(0.5),
                exact: Some(mass.times(0.5)),
            },
            false => Self {
                alike: mass,
                exact: None,
            },
        }
    }

    /// Belief after the time of these kernels, before anything is seen.
    pub fn forward(&self, filter: &Filter<'_>, kernels: &Kernels) -> Self {
        let step = |network: &Network, own: &[Kernel], mass: &Mass| {
            network.forward(&filter.stream.rows, own, mass, kernels.secs)
        };
        let alike = step(&filter.network, &kernels.alike, &self.alike);
        match &self.exact {
            None => Self { alike, exact: None },
            Some(exact) => {
                let exact = step(&filter.exact_network, &kernels.exact, exact);
                mixed(&alike, &exact, kernels.secs)
            }
        }
    }

    /// What belief was worth before that time, if it is worth so much after it.
    pub fn backward(&self, filter: &Filter<'_>, kernels: &Kernels) -> Self {
        let step = |network: &Network, own: &[Kernel], worth: &Mass| {
            network.backward(&filter.stream.rows, own, worth, kernels.secs)
        };
        match &self.exact {
            None => Self {
                alike: step(&filter.network, &kernels.alike, &self.alike),
                exact: None,
            },
            Some(exact) => {
                let worth = mixed(&self.alike, exact, kernels.secs);
                let back = |e: Mass| step(&filter.exact_network, &kernels.exact, &e);
                Self {
                    alike: step(&filter.network, &kernels.alike, &worth.alike),
                    exact: worth.exact.map(back),
                }
            }
        }
    }

    /// Multiplies each by another, and makes the sum one; where nothing is left, what was believed before stays.
    pub fn weigh(&mut self, by: &Self) {
        let mut sum = self.alike.dot(&by.alike);
        if let (Some(own), Some(other)) = (&self.exact, &by.exact) {
            sum += own.dot(other);
        }
        if sum <= 0.0 {
            return;
        }
        self.alike.weigh(&by.alike, sum);
        if let (Some(own), Some(other)) = (&mut self.exact, &by.exact) {
            own.weigh(other, sum);
        }
    }

    /// Probabilities whatever the manner.
    pub fn whole(self) -> Mass {
        match self.exact {
            Some(exact) => self.alike.plus(&exact),
            None => self.alike,
        }
    }
}

/// Either manner after a time in which it may have changed; the same forward and backward.
fn mixed(alike: &Mass, exact: &Mass, secs: f64) -> Belief {
    let change = 1.0 - (-CHANGE * secs).exp();
    Belief {
        alike: alike.times(1.0 - change).plus(&exact.times(change)),
        exact: Some(exact.times(1.0 - change).plus(&alike.times(change))),
    }
}

/// Logarithms of likelihoods in the exact manner: of the states, a second; of standing still where movements begin or
/// end; of unknown movement.
pub(super) struct Manifold<'a> {
    pub states: &'a [f64],
    pub standing: f64,
    pub none: f64,
}

/// Likelihoods in both manners, up to a factor that all share, from logarithms: of the states, a second, alike and
/// exactly; of rest; of unknown movement.
pub(super) fn likelihood(
    alike: &[f64],
    exact: Option<Manifold<'_>>,
    dt: f64,
    rest: f64,
    none: f64,
) -> Belief {
    let highest = |logs: &[f64]| dt * logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut most = highest(alike).max(rest).max(none);
    if let Some(exact) = &exact {
        let known = highest(exact.states).max(exact.standing);
        most = most.max(known).max(exact.none);
    }
    let exactly =
        |e: Manifold<'_>| Mass::likelihood(e.states, dt, rest.max(e.standing), e.none, most);
    Belief {
        alike: Mass::likelihood(alike, dt, rest, none, most),
        exact: exact.map(exactly),
    }
}
