//! How sure to be: the temperature, learned from exemplars that are left out.

use super::learned::USUAL_TEMPERATURE;
use super::learning::{INDEPENDENT, Trial};
use crate::math::statistics::median;
use crate::perception::temperature::LogNormal;

/// What it costs, in logarithms of probability, to fit the temperature e times off the usual one: where one person gave
/// all exemplars, nothing that is left out is hard, and nothing is learned of others.
const TEMPERATURE_PRIOR: f64 = 10.0;
/// How much the temperature of the next person may differ from the usual one, before anything was learned: the deviation
/// of its natural logarithm.
const SPREAD: f64 = 0.7;

/// The temperatures that are tried: twenty to a power of ten.
fn candidates() -> impl Iterator<Item = f64> {
    (0..=60).map(|k| 10f64.powf(-1.5 + 3.0 * f64::from(k) / 60.0))
}

/// What is believed of the next person's temperature after the exemplars that were left out alone. `None` without known
/// trials or rivals.
///
/// Trials with half of the exemplars left out are harder than the next person is, who meets all of them.
pub(super) fn belief(trials: &[Trial]) -> Option<LogNormal> {
    let alone = trials.iter().filter(|t| t.alone && t.classes.len() > 1);
    let known: Vec<(&Trial, usize)> = alone.filter_map(|t| Some((t, t.truth?))).collect();
    if known.is_empty() {
        return None;
    }
    let prior = LogNormal {
        mean: USUAL_TEMPERATURE,
        spread: SPREAD,
    };
    Some(prior.after(candidates(), |t| {
        let of =
            |(trial, truth): &(&Trial, usize)| loss(&trial.classes, Some(*truth), t * trial.unit);
        -INDEPENDENT * known.iter().map(of).sum::<f64>()
    }))
}

/// The temperature at which the truth is most probable, and what it then costs; `None` without known trials or rivals.
pub(super) fn temperature(trials: &[Trial]) -> Option<(f64, f64)> {
    let known: Vec<(&Trial, usize)> = trials
        .iter()
        .filter_map(|t| Some((t, t.truth?)))
        .filter(|(t, _)| t.classes.len() > 1)
        .collect();
    if known.is_empty() {
        return None;
    }
    let all = |t: f64| -> f64 {
        let of =
            |(trial, truth): &(&Trial, usize)| loss(&trial.classes, Some(*truth), t * trial.unit);
        let off = (t / USUAL_TEMPERATURE).ln();
        known.iter().map(of).sum::<f64>() + TEMPERATURE_PRIOR * off * off
    };
    let with_loss = candidates().map(|t| (t, all(t)));
    with_loss.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// How far the likeliest of wrong answers leads the second, as a rule, in units of temperature: less than that tells nothing.
/// It stands for the temperature where every primitive has one exemplar, and nothing known can be left out. `None` where
/// less than three primitives are.
pub(super) fn chance_lead(trials: &[Trial]) -> Option<f64> {
    let lead = |trial: &Trial| {
        let mut classes = trial.classes.clone();
        classes.sort_by(|a, b| b.total_cmp(a));
        let [first, second] = *classes.first_chunk()?;
        Some((first - second) / trial.unit).filter(|lead| lead.is_finite())
    };
    let unknown = trials.iter().filter(|t| t.truth.is_none());
    median(&unknown.filter_map(lead).collect::<Vec<f64>>())
}

/// Less the logarithm of a primitive's probability among all, of the most probable one if none is named.
fn loss(classes: &[f64], of: Option<usize>, temperature: f64) -> f64 {
    let most = classes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = classes
        .iter()
        .map(|c| ((c - most) / temperature).exp())
        .sum();
    sum.ln() - of.map_or(0.0, |k| (classes[k] - most) / temperature)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Left out alone: how far the truth is ahead of its rival, in units of temperature.
    fn trial(lead: f64) -> Trial {
        Trial {
            classes: vec![lead, 0.0],
            unit: 1.0,
            fold: 0,
            truth: Some(0),
            alone: true,
        }
    }

    #[test]
    fn what_says_nothing_leaves_the_prior() {
        assert_eq!(belief(&[]), None);
        let unknown = Trial {
            truth: None,
            ..trial(1.0)
        };
        assert_eq!(belief(&[unknown]), None, "nothing known was left out");
        let sure: Vec<Trial> = (0..50).map(|_| trial(1e4)).collect();
        let found = belief(&sure).expect("trials");
        assert!((found.mean - USUAL_TEMPERATURE).abs() < 0.01, "{found:?}");
        // The grid ends nearly five deviations away on either side.
        assert!((found.spread - SPREAD).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn sure_mistakes_make_modest_and_many_trials_make_certain() {
        let of = |rights: usize, wrongs: usize| {
            let trials = (0..rights).map(|_| trial(6.0));
            let trials: Vec<Trial> = trials.chain((0..wrongs).map(|_| trial(-6.0))).collect();
            belief(&trials).expect("trials")
        };
        let (right, mixed, many) = (of(90, 0), of(80, 10), of(800, 100));
        assert!(right.mean < USUAL_TEMPERATURE && USUAL_TEMPERATURE < mixed.mean);
        assert!(
            mixed.spread < SPREAD && many.spread < 0.5 * mixed.spread,
            "{mixed:?} {many:?}"
        );
        // Odds of eight to one where the lead is 6 nats ask for a temperature of 6 / ln 8.
        let wanted = 6.0 / 8f64.ln();
        assert!((many.mean / wanted).ln().abs() < 0.1, "{many:?}, {wanted}");
    }
}
