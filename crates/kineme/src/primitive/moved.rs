//! [`Moved`]: through what ranges a primitive moves the joints of its body.

use super::model::Primitive;

/// Joints that turn by less altogether are not moved, radians (about a degree).
pub(crate) const MOVES_RAD: f64 = 0.02;
/// Phases at which exemplars are looked at.
const PHASES: usize = 33;
/// Travel below this (metres, a second) is none.
const TRAVELS: f64 = 1e-3;

/// What a primitive moves, over all phases of all its exemplars.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// By joint, the diagonal of the box of its coordinates, radians.
    pub ranges: Vec<f64>,
    /// Whether the root travels, turns, or rises and falls.
    pub root: bool,
}

impl Moved {
    /// What a primitive moves.
    pub fn of(primitive: &Primitive) -> Self {
        let body = primitive.body();
        let mut low = vec![f64::INFINITY; body.dof()];
        let mut high = vec![f64::NEG_INFINITY; body.dof()];
        let mut heights = [f64::INFINITY, f64::NEG_INFINITY];
        let mut travels = false;
        for exemplar in 0..primitive.exemplars().len() {
            for k in 0..PHASES {
                let sample = primitive.registered(exemplar, k as f64 / (PHASES - 1) as f64);
                for (c, x) in sample.pose.iter().enumerate() {
                    low[c] = low[c].min(*x);
                    high[c] = high[c].max(*x);
                }
                let t = &sample.travel;
                heights = [heights[0].min(t.height), heights[1].max(t.height)];
                travels |= [t.forward, t.left, t.yaw_rate]
                    .iter()
                    .any(|v| v.abs() > TRAVELS);
            }
        }
        let range = |j: usize| -> f64 {
            let square = |c: usize| (high[c] - low[c]).powi(2);
            body.coordinates(j).map(square).sum::<f64>().sqrt()
        };
        Self {
            ranges: (0..body.joints().len()).map(range).collect(),
            root: travels || heights[1] - heights[0] > TRAVELS,
        }
    }
}
