//! [`Arbiter`]: who moves which joint.

use super::mask::Mask;
use super::plan::Arbitration;

/// The share of a movement that is worth making, but for the rounding of a third.
const ENOUGH: f64 = 0.333;

/// A behaviour that wants to move joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contender<'a> {
    /// Its number.
    pub behavior: usize,
    pub mask: &'a Mask,
    pub priority: i32,
    /// Its weight, and its activation where the winner takes all.
    pub weight: f64,
    /// How many had begun when it began.
    pub order: u64,
}

/// Who moves a joint, and with what share; the shares sum to one where anybody does. In the order of behaviours.
pub(super) type Shares = Vec<(usize, f64)>;

/// Who moves which joint.
#[derive(Debug, Clone)]
pub(super) struct Arbiter {
    kind: Arbitration,
    /// By how much a challenger must exceed the winner, and for how many ticks.
    margin: f64,
    patience: u64,
    winner: Option<usize>,
    /// For how many ticks somebody has exceeded the winner.
    challenged: u64,
}

impl Arbiter {
    pub fn new(kind: Arbitration, margin: f64, patience: u64) -> Self {
        Self {
            kind,
            margin,
            patience,
            winner: None,
            challenged: 0,
        }
    }

    /// Counts a tick; true when the body is to change hands though nobody came or went.
    pub fn tick(&mut self, contenders: &[Contender]) -> bool {
        let activation = |b: usize| {
            contenders
                .iter()
                .find(|c| c.behavior == b)
                .map(|c| c.weight)
        };
        let Some(held) = self.winner.and_then(activation) else {
            self.challenged = 0;
            return false;
        };
        let exceeds = contenders.iter().any(|c| c.weight > held + self.margin);
        self.challenged = if exceeds { self.challenged + 1 } else { 0 };
        self.challenged > self.patience
    }

    /// The shares of the contenders (in the order of behaviours) in each joint and, last, the root, where `before` has
    /// those until now.
    ///
    /// Who would get less than a third of its movement gets nothing of it, and waits: half a wave is none.
    pub fn shares(&mut self, contenders: &[Contender], before: &[Shares]) -> Vec<Shares> {
        if self.kind == Arbitration::Winner {
            self.elect(contenders);
        }
        let mut contenders = contenders.to_vec();
        loop {
            let shares = self.divided(&contenders, before);
            // Of those that hold nothing there is nothing to take.
            let crippled = |&k: &usize| {
                let c: &Contender = &contenders[k];
                let has = |s: &Shares| s.iter().any(|(behavior, _)| *behavior == c.behavior);
                let joints = shares.iter().zip(&c.mask.stakes);
                let stake = |(s, stake): (&Shares, &f64)| if has(s) { *stake } else { 0.0 };
                shares.iter().any(has) && joints.map(stake).sum::<f64>() < ENOUGH
            };
            let crippled = (0..contenders.len()).filter(crippled);
            let rank = |&k: &usize| {
                let c = &contenders[k];
                (c.priority, std::cmp::Reverse(c.order))
            };
            match crippled.min_by_key(rank) {
                Some(k) => contenders.remove(k),
                None => return shares,
            };
        }
    }

    fn divided(&self, contenders: &[Contender], before: &[Shares]) -> Vec<Shares> {
        let joints = before.len() - 1;
        let places = before.iter().enumerate();
        let shares = places.map(|(j, before)| {
            let wants = |c: &&Contender| {
                if j == joints {
                    c.mask.root
                } else {
                    c.mask.joints[j]
                }
            };
            let wanting = contenders.iter().filter(wants);
            match self.kind {
                Arbitration::Priority => first(wanting, before),
                Arbitration::Superposition => together(wanting),
                Arbitration::Winner => {
                    let winner = wanting.filter(|c| self.winner == Some(c.behavior));
                    winner.map(|c| (c.behavior, 1.0)).collect()
                }
            }
        });
        shares.collect()
    }

    fn elect(&mut self, contenders: &[Contender]) {
        let stays = contenders.iter().any(|c| self.winner == Some(c.behavior));
        if stays && self.challenged <= self.patience {
            return;
        }
        self.challenged = 0;
        let best = contenders.iter().max_by(|a, b| {
            let activation = a.weight.total_cmp(&b.weight);
            let priority = a.priority.cmp(&b.priority);
            activation.then(priority).then(b.order.cmp(&a.order))
        });
        self.winner = best.map(|c| c.behavior);
    }
}

/// The one of highest priority; of equals the one that has it, else the one that began first.
fn first<'a>(wanting: impl Iterator<Item = &'a Contender<'a>>, before: &Shares) -> Shares {
    let has = |c: &Contender| before.iter().any(|(behavior, _)| *behavior == c.behavior);
    let rank = |c: &&Contender| (c.priority, has(c), std::cmp::Reverse(c.order));
    let first = wanting.max_by_key(rank);
    first.map(|c| (c.behavior, 1.0)).into_iter().collect()
}

/// All of the highest priority, by their weights.
fn together<'a>(wanting: impl Iterator<Item = &'a Contender<'a>> + Clone) -> Shares {
    let Some(highest) = wanting.clone().map(|c| c.priority).max() else {
        return Shares::new();
    };
    let equals = wanting.filter(|c| c.priority == highest);
    let whole: f64 = equals.clone().map(|c| c.weight).sum();
    equals.map(|c| (c.behavior, c.weight / whole)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Who contends, and the shares in both joints then.
    type Round<'a> = (&'a [usize], [&'a [(usize, f64)]; 2]);

    /// Rounds of behaviours over two joints.
    fn check(kind: Arbitration, rounds: &[Round]) {
        let all = [
            ([true, true], 0, 1.0),
            ([true, false], 0, 3.0),
            ([false, true], 2, 0.5),
            ([true, true], 2, 1.05),
        ];
        let masks = all.map(|(joints, ..)| Mask {
            joints: joints.to_vec(),
            stakes: joints.map(|held| f64::from(u8::from(held)) / 2.0).to_vec(),
            root: false,
        });
        let mut arbiter = Arbiter::new(kind, 0.1, 2);
        let mut shares = vec![Shares::new(); 3];
        for (round, (who, wanted)) in rounds.iter().enumerate() {
            let contenders: Vec<Contender> = who
                .iter()
                .map(|&behavior| Contender {
                    behavior,
                    mask: &masks[behavior],
                    priority: all[behavior].1,
                    weight: all[behavior].2,
                    order: 10 - behavior as u64,
                })
                .collect();
            arbiter.tick(&contenders);
            shares = arbiter.shares(&contenders, &shares);
            for j in 0..2 {
                assert_eq!(shares[j], wanted[j], "{kind:?}, round {round}, joint {j}");
            }
            assert!(shares[2].is_empty());
        }
    }

    #[test]
    fn a_joint_belongs_to_the_highest_priority_and_of_equals_to_the_incumbent() {
        check(
            Arbitration::Priority,
            &[
                (&[], [&[], &[]]),
                (&[0], [&[(0, 1.0)], &[(0, 1.0)]]),
                (&[0, 1], [&[(0, 1.0)], &[(0, 1.0)]]),
                (&[0, 1, 2], [&[(0, 1.0)], &[(2, 1.0)]]),
                (&[0, 1, 2, 3], [&[(3, 1.0)], &[(2, 1.0)]]),
                (&[0, 1], [&[(1, 1.0)], &[(0, 1.0)]]),
                (&[], [&[], &[]]),
            ],
        );
    }

    #[test]
    fn weights_share_a_joint_among_the_highest_priority() {
        check(
            Arbitration::Superposition,
            &[
                (&[0, 1], [&[(0, 0.25), (1, 0.75)], &[(0, 1.0)]]),
                (&[0, 1, 2], [&[(0, 0.25), (1, 0.75)], &[(2, 1.0)]]),
                (&[0, 1, 3], [&[(3, 1.0)], &[(3, 1.0)]]),
                (&[1], [&[(1, 1.0)], &[]]),
            ],
        );
    }

    #[test]
    fn the_winner_has_the_body_until_it_is_exceeded_for_long_enough() {
        let zero: [&[(usize, f64)]; 2] = [&[(0, 1.0)], &[(0, 1.0)]];
        check(
            Arbitration::Winner,
            &[
                (&[0, 2], zero),
                // Not by enough.
                (&[0, 3], zero),
                (&[0, 3], zero),
                (&[0, 3], zero),
                (&[0, 3], zero),
                // Not for long enough.
                (&[0, 1], zero),
                (&[0, 1], zero),
                (&[0, 2], zero),
                (&[0, 1], zero),
                (&[0, 1], zero),
                (&[0, 1], [&[(1, 1.0)], &[]]),
                // Gone at once when it is over.
                (&[0, 2], zero),
                (&[2, 3], [&[(3, 1.0)], &[(3, 1.0)]]),
            ],
        );
    }
}
