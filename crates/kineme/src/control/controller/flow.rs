//! What a tick does: the flows go on, the shares make one posture of them, feedback and limits one command.

use nalgebra::Vector3;

use super::Controller;
use crate::control::behavior::Status;
use crate::control::connection::Wire;
use crate::control::robot::Sensed;
use crate::control::state::Moving;
use crate::math::rotation::{exp, log_near};

impl Controller<'_> {
    /// Compares what was felt with what was told, and slows behaviours whose joints are elsewhere.
    pub(super) fn feel(&mut self, sensed: Option<&Sensed>) {
        let body = self.vocabulary.body();
        let dof = body.dof();
        let told = &self.command.pose;
        let of_body = |s: &&Sensed| s.pose.len() == dof && s.pose.iter().all(|v| v.is_finite());
        let measured = sensed.filter(of_body).map(|sensed| {
            self.measured.clone_from(&sensed.pose);
            for j in 0..body.joints().len() {
                let at = body.coordinates(j);
                if at.len() == 3 {
                    let vector = |row: &[f64]| Vector3::from_column_slice(&row[at.clone()]);
                    let (here, there) = (vector(&self.measured), vector(told));
                    if (here - there).norm() > std::f64::consts::PI {
                        let named = log_near(&exp(&here), &there);
                        self.measured[at].copy_from_slice(named.as_slice());
                    }
                }
            }
            &self.measured[..]
        });
        self.yielding.feel(told, measured);
        let deviations = &self.yielding.deviations;
        for (i, behavior) in self.behaviors.iter_mut().enumerate() {
            if behavior.status != Status::Running {
                continue;
            }
            let moved =
                (0..body.joints().len()).filter(|&j| self.shares[j].iter().any(|s| s.0 == i));
            let far = moved
                .flat_map(|j| &deviations[body.coordinates(j)])
                .fold(0.0_f64, |most, d| most.max(d.abs()));
            let secs = 1.0 / self.rate_hz;
            behavior.speed = self.settings.feedback.speed(behavior.speed, far, secs);
        }
    }

    /// The flows a tick on, and the command that comes of them.
    pub(super) fn advance(&mut self) {
        self.tick += 1;
        let secs = self.secs();
        for i in 0..self.behaviors.len() {
            let behavior = &mut self.behaviors[i];
            if behavior.status != Status::Running {
                continue;
            }
            let completed = behavior.advance();
            let ran = &mut self.ran[behavior.run];
            (ran.end_secs, ran.completed) = (secs, completed);
            if completed {
                for (_, to, _) in self
                    .wires
                    .iter()
                    .filter(|w| w.0 == i && matches!(w.2, Wire::Select))
                {
                    self.behaviors[*to].due = Some(self.tick);
                }
            }
        }
        let travel = self.now.travel;
        self.now = self.blended();
        self.transitions.add(self.tick, self.rate_hz, &mut self.now);
        self.yielding.advance();
        let body = self.vocabulary.body();
        self.command.travel(travel, &self.now, 1.0 / self.rate_hz);
        let mut told = self.now.clone();
        self.yielding.add(&mut told);
        self.command.emit(body, &told, self.rate_hz);
        let heard = (0..self.behaviors.len()).map(|i| (self.weight(i), i));
        let most = heard.fold((0.0, None), |most, (weight, i)| {
            if weight > most.0 {
                (weight, Some(i))
            } else {
                most
            }
        });
        if let Some(i) = most.1 {
            self.command.phase = self.behaviors[i].phase();
        }
        self.command.finished = self.behaviors.iter().all(|b| b.status == Status::Idle);
    }

    /// Makes a command of where the flows would have the body and what feedback has taken over.
    pub(super) fn tell(&mut self) {
        let body = self.vocabulary.body();
        let mut told = self.now.clone();
        self.yielding.add(&mut told);
        self.command.emit(body, &told, self.rate_hz);
    }

    /// The sum of a behaviour's shares in joints.
    pub(super) fn weight(&self, i: usize) -> f64 {
        let joints = &self.shares[..self.shares.len() - 1];
        let own = joints
            .iter()
            .flatten()
            .filter(|(behavior, _)| *behavior == i);
        own.map(|(_, share)| share).sum()
    }

    /// Where the behaviours' shares would have the body, by the weighted mean of coordinates (of a ball its rotation
    /// vector); what nobody moves is held. The height's velocity is without [`Self::rise`].
    pub(super) fn blended(&self) -> Moving {
        let mut sum = Moving::still(self.held.clone());
        let body = self.vocabulary.body();
        for (j, shares) in self.shares.iter().enumerate() {
            let at = self.coordinates(j);
            let is_root = j + 1 == self.shares.len();
            for (k, (i, share)) in shares.iter().enumerate() {
                let mut renamed;
                let mut own = self.behaviors[*i].now();
                if k > 0 && at.len() == 3 && !is_root && body.limits(j).is_empty() {
                    renamed = own.clone();
                    if renamed.named_near(body, &sum.values[..body.dof()]) {
                        own = &renamed;
                    }
                }
                for c in at.clone() {
                    let (x, v) = (share * own.values[c], share * own.velocities[c]);
                    if k == 0 {
                        (sum.values[c], sum.velocities[c]) = (x, v);
                    } else {
                        sum.values[c] += x;
                        sum.velocities[c] += v;
                    }
                }
                if is_root {
                    let travel = sum.travel.iter_mut().zip(own.travel);
                    travel.for_each(|(s, v)| *s += share * v);
                }
            }
        }
        sum
    }

    /// Vertical velocity of the flows that move the root, metres a second.
    pub(super) fn rise(&self) -> f64 {
        let root = self.body().dof();
        let shares = self.shares.iter().last().into_iter().flatten();
        let rises = shares.map(|(i, share)| {
            let behavior = &self.behaviors[*i];
            share * (behavior.now_whole().velocities[root] - behavior.now().velocities[root])
        });
        rises.sum()
    }

    pub(super) fn now_whole(&self) -> Moving {
        let mut now = self.now.clone();
        now.velocities[self.body().dof()] += self.rise();
        now
    }

    /// The coordinates of a joint, or of the root, which is behind the joints.
    pub(super) fn coordinates(&self, j: usize) -> std::ops::Range<usize> {
        let body = self.vocabulary.body();
        if j < body.joints().len() {
            body.coordinates(j)
        } else {
            body.dof()..body.dof() + 1
        }
    }
}
