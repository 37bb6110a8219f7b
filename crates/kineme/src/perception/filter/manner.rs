//! The two manners in which a stream may move: like the exemplars, as people do, or by the primitives themselves, as a
//! body does that carries them out. A manner hardly ever changes.

use super::chain::{LOOSE, TIGHT};
use super::recogniser::Filter;
use super::track::{Mass, Step};

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

/// How belief goes on in each manner in a certain time.
#[derive(Debug, Clone)]
pub(super) struct Steps {
    pub secs: f64,
    alike: Step,
    /// Nothing where nobody carries primitives out.
    exact: Option<Step>,
}

impl Steps {
    pub fn of(filter: &Filter<'_>, secs: f64, both: bool) -> Self {
        let rows = &filter.stream.rows;
        Self {
            secs,
            alike: filter.network.step(rows, secs, LOOSE),
            exact: both.then(|| filter.exact_network.step(rows, secs, TIGHT)),
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

    /// Belief after these steps, before anything is seen.
    pub fn forward(&self, filter: &Filter<'_>, steps: &Steps) -> Self {
        let rows = &filter.stream.rows;
        let mut alike = filter.network.forward(rows, &steps.alike, &self.alike);
        let mut exact = None;
        if let (Some(own), Some(step)) = (&self.exact, &steps.exact) {
            let own = exact.insert(filter.exact_network.forward(rows, step, own));
            alike.exchange(own, changed(steps.secs));
        }
        Self { alike, exact }
    }

    /// What belief was worth before these steps, if it is worth so much after them.
    pub fn backward(&self, filter: &Filter<'_>, steps: &Steps) -> Self {
        let rows = &filter.stream.rows;
        let back = |worth: &Mass| filter.network.backward(rows, &steps.alike, worth);
        match (&self.exact, &steps.exact) {
            (Some(exact), Some(step)) => {
                let (mut alike, mut exact) = (self.alike.clone(), exact.clone());
                // The same as forward: either may become the other.
                alike.exchange(&mut exact, changed(steps.secs));
                Self {
                    alike: back(&alike),
                    exact: Some(filter.exact_network.backward(rows, step, &exact)),
                }
            }
            _ => Self {
                alike: back(&self.alike),
                exact: None,
            },
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

/// The chance that the manner has changed after a time.
fn changed(secs: f64) -> f64 {
    1.0 - (-CHANGE * secs).exp()
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
