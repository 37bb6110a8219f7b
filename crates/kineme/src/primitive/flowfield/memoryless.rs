//! The field of the paper: no phase is carried.

use super::field::Flowfield;
use super::flow::{END, FlowState, Gap, Update};
use super::samples::{LANES, Match, Matches};
use crate::primitive::course::Sample;
use crate::primitive::course::Travel;

impl Flowfield {
    /// The mean flow of the nearest samples, whatever their phase, and the correction toward them.
    pub(super) fn without_phase(&self, state: &FlowState) -> Update {
        let matches = self.nearest_samples(&state.pose);
        let (kernel, k) = self.kernel(&matches);
        let n = self.curves.len();
        let dof = self.body.dof();
        let mut mean = Sample {
            pose: vec![0.0; dof],
            slope: vec![0.0; dof],
            secs_per_phase: 0.0,
            travel: Travel::default(),
        };
        let mut parameters = vec![0.0; self.dims];
        let mut weights = vec![0.0; n];
        let (mut rate, mut turn, mut phase) = (0.0, [0.0; 2], 0.0);
        let mut row = vec![0.0; n];
        for (m, &share) in matches.as_slice().iter().zip(&kernel[..k]) {
            let p = &self.points[m.course * self.dims..(m.course + 1) * self.dims];
            self.interpolator.weights(p, &mut row);
            let at = self.samples.phase(m);
            let point = self.point(&row, at);
            let own = state.pace / point.secs_per_phase;
            add(share, &point.pose, &mut mean.pose);
            // Velocities are averaged, not slopes: that is what the paper's gradients are.
            add(share * own, &point.slope, &mut mean.slope);
            add(share, &row, &mut weights);
            add(share, p, &mut parameters);
            mean.travel.forward += share * point.travel.forward;
            mean.travel.left += share * point.travel.left;
            mean.travel.height += share * point.travel.height;
            mean.travel.yaw_rate += share * point.travel.yaw_rate;
            rate += share * own;
            phase += share * at;
            let angle = std::f64::consts::TAU * at;
            turn[0] += share * angle.cos();
            turn[1] += share * angle.sin();
        }
        if self.cyclic {
            phase = turn[1].atan2(turn[0]) / std::f64::consts::TAU;
        }
        let phase = self.on_curve(phase);
        let gap = Gap::between(self, &state.pose, &mean);
        let finished = !self.cyclic && phase > END;
        let pull = self.settings.correction;
        let mut tangent = mean.slope;
        let mut toward = gap.normal;
        if finished {
            let end = self.point(&weights, 1.0).pose;
            tangent.fill(0.0);
            for (t, (e, x)) in toward.iter_mut().zip(end.iter().zip(&state.pose)) {
                *t = e - x;
            }
        }
        let pairs = tangent.iter().zip(&toward);
        Update {
            velocity: pairs.map(|(t, r)| t + pull * r).collect(),
            tangent,
            phase_rate: rate,
            phase,
            parameters,
            weights,
            nearest: mean.pose,
            travel: mean.travel,
            distance_rad: gap.distance_rad,
            out_of_basin: gap.distance_rad > self.settings.basin_rad,
            finished,
        }
    }

    /// The nearest of all samples, several of one course among them.
    fn nearest_samples(&self, pose: &[f64]) -> Matches {
        let query = self.query(pose);
        let mut matches = Matches::new(self.settings.neighbours + 1);
        let phases = self.samples.pieces() + usize::from(!self.cyclic);
        for block in 0..self.samples.blocks() {
            let courses = (self.samples.courses() - block * LANES).min(LANES);
            for place in 0..phases as i64 {
                let mut cost = [0.0; LANES];
                for (q, lanes) in query.iter().zip(self.samples.lanes(block, place)) {
                    for (c, x) in cost.iter_mut().zip(lanes) {
                        *c += (q - x) * (q - x);
                    }
                }
                for (lane, &cost) in cost[..courses].iter().enumerate() {
                    matches.offer(Match {
                        course: block * LANES + lane,
                        cost,
                        centre: place,
                        offset: 0.0,
                    });
                }
            }
        }
        matches
    }
}

fn add(share: f64, values: &[f64], sum: &mut [f64]) {
    for (s, v) in sum.iter_mut().zip(values) {
        *s += share * v;
    }
}
