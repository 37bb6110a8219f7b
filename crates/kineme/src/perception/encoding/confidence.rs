//! How sure the choice among primitives is: a temperature that is believed in, not known.

use super::chains::shares;
use crate::perception::temperature::LogNormal;

/// The temperature of real vocabularies, units.
const USUAL: f64 = 0.03;
/// How much the temperature of the next person may differ from it, before anything was learned: the deviation of its
/// natural logarithm.
const SPREAD: f64 = 0.7;
/// Exemplars of a few people stand and fall together: of what they say about the next one, so much counts.
const INDEPENDENT: f64 = 0.1;
/// Temperatures that are tried: twenty to a power of ten, from 1/1000 unit on.
const TRIED: u32 = 60;
/// Less probable than this counts as so probable.
const LEAST: f64 = 1e-12;

/// The temperature by which costs of a clip become probabilities. One temperature would be sure of what it cannot know:
/// how much the next person differs. So it has a spread, and probabilities are the mean over it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    /// Its geometric mean, units.
    pub temperature: f64,
    /// The deviation of its natural logarithm; 0: it is known.
    pub spread: f64,
}

impl Confidence {
    /// What is believed after movements that were left out alone, what each primitive cost them and which it was: Bayes'
    /// rule on a logarithmic grid, with a log-normal prior. `None` without movements.
    ///
    /// Where the nearer half of the true primitive is left out as well, the trials are harder than the next person is,
    /// who meets all exemplars, and made people two or three times too modest.
    pub(super) fn learned(alone: &[(&[f64], usize)]) -> Option<Self> {
        if alone.is_empty() {
            return None;
        }
        let tried = (0..=TRIED).map(|k| 10f64.powf(f64::from(k) / 20.0 - 3.0));
        let prior = LogNormal {
            mean: USUAL,
            spread: SPREAD,
        };
        let believed = prior.after(tried, |t| {
            let log = |&(costs, truth): &(&[f64], usize)| shares(costs, t)[truth].max(LEAST).ln();
            INDEPENDENT * alone.iter().map(log).sum::<f64>()
        });
        Some(Self {
            temperature: believed.mean,
            spread: believed.spread,
        })
    }

    /// How probable each primitive is, of what each costs, if the clip is one of them: the mean over what the temperature
    /// may be. The order of the primitives is that of their costs.
    pub(super) fn shares(&self, costs: &[f64]) -> Vec<f64> {
        let believed = LogNormal {
            mean: self.temperature,
            spread: self.spread,
        };
        // Whatever a file says, a share stays a number.
        believed.mean_of(costs.len(), |t| shares(costs, t.clamp(1e-6, 1e6)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is believed after so many movements whose own primitive led by `lead` units, and so many that it lost by as
    /// much.
    fn learned(lead: f64, [right, wrong]: [usize; 2]) -> Confidence {
        let (right_costs, wrong_costs) = ([0.0, lead], [lead, 0.0]);
        let rights = (0..right).map(|_| (right_costs.as_slice(), 0));
        let wrongs = (0..wrong).map(|_| (wrong_costs.as_slice(), 0));
        let trials: Vec<(&[f64], usize)> = rights.chain(wrongs).collect();
        Confidence::learned(&trials).expect("trials")
    }

    #[test]
    fn movements_that_say_nothing_leave_the_prior() {
        assert_eq!(Confidence::learned(&[]), None);
        let sure = learned(1e4, [50, 0]);
        assert!((sure.temperature / USUAL).ln().abs() < 0.02, "{sure:?}");
        assert!((sure.spread - SPREAD).abs() < 0.02, "{sure:?}");
    }

    #[test]
    fn mistakes_make_modest_and_many_movements_make_certain() {
        let lead = 6.0 * USUAL;
        let [right, mixed] = [[90, 0], [80, 10]].map(|counts| learned(lead, counts));
        let many = learned(lead, [8000, 1000]);
        assert!(right.temperature < USUAL && USUAL < mixed.temperature);
        assert!(
            mixed.spread < SPREAD && many.spread < 0.5 * mixed.spread,
            "{mixed:?} {many:?}"
        );
        // Those of a few people tell little of the next one.
        assert!(learned(lead, [8, 1]).spread > 0.6);
        // Odds of eight to one at this lead ask for a temperature of lead / ln 8.
        let wanted = lead / 8f64.ln();
        assert!(
            (many.temperature / wanted).ln().abs() < 0.1,
            "{many:?}, {wanted}"
        );
    }

    #[test]
    fn a_spread_keeps_the_order_and_gives_the_unlikely_more() {
        let costs = [0.3, 0.1, 0.12, super::super::chains::FAR];
        let of = |spread: f64| {
            let temperature = 0.03;
            Confidence {
                temperature,
                spread,
            }
            .shares(&costs)
        };
        assert_eq!(of(0.0), shares(&costs, 0.03));
        let (known, believed) = (of(0.0), of(0.7));
        for all in [&known, &believed] {
            assert!((all.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(all[1] > all[2] && all[2] > all[0] && all[3] == 0.0);
        }
        assert!(believed[0] > 5.0 * known[0], "{known:?} {believed:?}");
        let sum = of(1e4).iter().sum::<f64>();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }
}
