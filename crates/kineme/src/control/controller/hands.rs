//! Who moves what: behaviours begin, pause and go on, and joints change hands.

use super::Controller;
use crate::control::arbiter::{Contender, Shares};
use crate::control::behavior::{Behavior, Status};
use crate::control::connection::{Percept, Wire};
use crate::control::controller::{NO_TICK, Ran};
use crate::control::state::Moving;

impl Controller<'_> {
    /// Calls the behaviours whose rules wait for what is newly recognised.
    pub(super) fn listen(&mut self, percept: &Percept) {
        let before = std::mem::replace(&mut self.recognised, percept.primitive);
        let Some(seen) = percept.primitive.filter(|_| before != percept.primitive) else {
            return;
        };
        let first = self.behaviors.len() - self.whens.len();
        for (behavior, when) in self.behaviors[first..].iter_mut().zip(&self.whens) {
            if *when == seen {
                behavior.due = Some(self.tick + behavior.delay);
            }
        }
    }

    /// Begins, pauses and resumes behaviours as the arbitrator says, and lets joints change hands without a jump.
    pub(super) fn arbitrate(&mut self) {
        for i in 0..self.behaviors.len() {
            if self.behaviors[i].due.is_some_and(|due| due <= self.tick) {
                self.behaviors[i].due = None;
                if self.behaviors[i].status == Status::Running {
                    self.write_down(i);
                }
                self.begun += 1;
                self.behaviors[i].called(self.begun);
            }
        }
        let mut before: Option<(Vec<Shares>, Moving)> = None;
        // Each behaviour acts on others at most once a tick.
        for round in 0..=self.behaviors.len() {
            let contending: Vec<bool> = (0..self.behaviors.len())
                .map(|i| self.contends(i))
                .collect();
            let contenders = contenders(&self.behaviors, &contending);
            let urged = round == 0 && self.arbiter.tick(&contenders);
            if contending == self.contending && !urged {
                break;
            }
            let shares = self.arbiter.shares(&contenders, &self.shares);
            self.contending = contending;
            let (_, now) = before.get_or_insert_with(|| (self.shares.clone(), self.now_whole()));
            let now = now.clone();
            self.shares = shares;
            self.hand_over(&now);
        }
        let dof = self.body().dof();
        let mut changed = vec![false; dof + 1];
        let mut any = self
            .settings
            .rest_secs
            .is_some_and(|secs| self.relax(secs, &mut changed));
        if let Some((before, _)) = &before {
            for (j, was) in before.iter().enumerate() {
                if *was != self.shares[j] {
                    changed[self.coordinates(j)].fill(true);
                    any = true;
                    self.release(j, was);
                }
            }
        }
        if any {
            let now = before.map_or_else(|| self.now_whole(), |(_, now)| now);
            self.change(&changed, now);
        }
    }

    /// Whether a behaviour wants joints and is not kept from it.
    fn contends(&self, i: usize) -> bool {
        let behavior = &self.behaviors[i];
        let inhibited = || {
            let mut wires = self.wires.iter();
            wires.any(|(from, to, wire)| {
                let runs = self.behaviors[*from].status == Status::Running;
                *to == i && runs && matches!(wire, Wire::Inhibit)
            })
        };
        behavior.status != Status::Idle && behavior.suppressed <= self.tick && !inhibited()
    }

    /// Lets behaviours begin that have got a joint, and pauses those that have lost all.
    fn hand_over(&mut self, now: &Moving) {
        for i in 0..self.behaviors.len() {
            let has = self
                .shares
                .iter()
                .flatten()
                .any(|(behavior, _)| *behavior == i);
            let status = self.behaviors[i].status;
            match status {
                Status::Waiting | Status::Paused if has => {
                    self.behaviors[i].begin(now.clone());
                    self.write_down(i);
                    if status == Status::Waiting {
                        self.act(i);
                    }
                }
                Status::Running if !has => {
                    let stands = self.behaviors[i].suppressed > self.tick;
                    // One that is inhibited runs on, though nobody hears it.
                    if self.contending[i] || stands {
                        self.behaviors[i].pause();
                    }
                }
                _ => {}
            }
        }
    }

    /// What a behaviour does to others when it begins.
    fn act(&mut self, i: usize) {
        for (_, to, wire) in self.wires.iter().filter(|(from, ..)| *from == i) {
            match wire {
                Wire::Suppress(ticks) => self.behaviors[*to].suppressed = self.tick + ticks,
                Wire::Aim(aimed) => self.behaviors[*to].aim(aimed.clone()),
                Wire::Inhibit | Wire::Select => {}
            }
        }
    }

    fn write_down(&mut self, i: usize) {
        let behavior = &mut self.behaviors[i];
        behavior.run = self.ran.len();
        self.ran.push(Ran {
            start_secs: self.tick as f64 / self.rate_hz,
            end_secs: self.tick as f64 / self.rate_hz,
            primitive: self.vocabulary.primitives()[behavior.primitive]
                .name()
                .into(),
            joints: behavior.mask.names(self.vocabulary.body()),
            planned: behavior.place,
            completed: false,
            miss_m: behavior.aimed.miss_m,
        });
    }

    /// Decides what a joint holds that nobody moves any longer: where a movement came to, else where it is.
    fn release(&mut self, j: usize, was: &Shares) {
        if !self.shares[j].is_empty() {
            self.free_since[j] = None;
            return;
        }
        self.free_since[j] = Some(self.tick);
        let at = self.coordinates(j);
        let ended = match was[..] {
            [(i, _)] if self.behaviors[i].status == Status::Idle => self.behaviors[i].held(),
            _ => None,
        };
        let from = ended.unwrap_or(&self.now.values);
        self.held[at.clone()].copy_from_slice(&from[at]);
    }

    /// Sends joints that were free for so long back to where they began; true when there are any.
    fn relax(&mut self, secs: f64, changed: &mut [bool]) -> bool {
        let ticks = (secs * self.rate_hz - NO_TICK).ceil() as u64;
        let mut any = false;
        for j in 0..self.free_since.len() - 1 {
            if self.free_since[j].is_some_and(|since| self.tick >= since + ticks) {
                self.free_since[j] = None;
                let at = self.coordinates(j);
                self.held[at.clone()].copy_from_slice(&self.rest[at.clone()]);
                changed[at].fill(true);
                any = true;
            }
        }
        any
    }

    /// From now on coordinates that changed hands go over to what the flows would have.
    fn change(&mut self, changed: &[bool], mut now: Moving) {
        let mut goal = self.blended();
        goal.velocities[self.body().dof()] += self.rise();
        if now.named_near(self.vocabulary.body(), &goal.values[..self.body().dof()]) {
            self.now.named_near(
                self.vocabulary.body(),
                &goal.values[..goal.values.len() - 1],
            );
            let acceleration = self.command.acceleration.clone();
            self.tell();
            self.command.acceleration = acceleration;
        }
        self.transitions.begin(changed, &now, &goal, self.tick);
    }
}

fn contenders<'a>(behaviors: &'a [Behavior], contending: &[bool]) -> Vec<Contender<'a>> {
    let numbered = behaviors.iter().enumerate().zip(contending);
    let wanting = numbered.filter(|(_, contends)| **contends);
    let contenders = wanting.map(|((behavior, b), _)| Contender {
        behavior,
        mask: &b.mask,
        priority: b.priority,
        weight: b.weight,
        order: b.order,
    });
    contenders.collect()
}
