//! Figure 2: the flowfield of horizontal arm waving.

use kineme::primitive::{FlowSettings, Flowfield, Primitive};
use kineme::{Role, Root, Skeleton};
use kineme_report::paper::{Arrow, Flow, Stick};
use nalgebra::{DMatrix, SymmetricEigen};

use crate::sets::Result;

/// Places along each parameter at which the field is asked.
const ACROSS: usize = 5;
/// Phases at which it is asked.
const PHASES: usize = 15;
/// Postures of an exemplar's line.
const POSTURES: usize = 49;
/// How far ahead an arrow points, seconds.
const AHEAD_SECS: f64 = 0.035;
/// Phases whose postures are drawn.
const DRAWN: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];
/// Half the height of a head, metres.
const HEAD_M: f64 = 0.11;

/// The field in the plane of its first two principal coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldView {
    /// What is drawn.
    pub flow: Flow,
    /// Shares of the variance of the exemplars' postures along the two axes.
    pub shares: [f64; 2],
}

/// The flowfield of a primitive that carries one arm across: its updates at postures of the manifold, seen along the
/// first two principal coordinates of the exemplars' postures. Axes are turned so that the movement goes from right to
/// left, as in the paper.
///
/// # Errors
/// When the field cannot be made.
pub fn field_view(primitive: &Primitive) -> Result<FieldView> {
    let field = Flowfield::of(primitive, &FlowSettings::default())?;
    let plane = Plane::of(primitive);
    let mut arrows = Vec::new();
    for p in lattice(primitive.parameters().dims()) {
        let course = primitive.at(&p)?;
        for k in 0..PHASES {
            let phase = k as f64 / (PHASES - 1) as f64;
            let state = field
                .enter_at(&course.pose(phase), phase)?
                .with_parameters(&p)?;
            let update = field.update(&state);
            let pairs = state.pose().iter().zip(&update.velocity);
            let next: Vec<f64> = pairs.map(|(x, v)| x + AHEAD_SECS * v).collect();
            arrows.push(Arrow {
                from: plane.place(state.pose()),
                to: plane.place(&next),
                phase,
            });
        }
    }
    let n = primitive.exemplars().len();
    let posture = |i: usize, phase: f64| primitive.registered(i, phase).pose;
    let way = |i: usize| {
        let at = |k: usize| k as f64 / (POSTURES - 1) as f64;
        let place = |k: usize| (plane.place(&posture(i, at(k))), at(k));
        (0..POSTURES).map(place).collect()
    };
    let [top, bottom] = extremes(primitive);
    let sticks = |i: usize| {
        let stick = |&phase: &f64| {
            let pose = posture(i, phase);
            let (bones, moving) = bones(primitive.body(), &pose);
            Stick {
                at: plane.place(&pose),
                phase,
                exemplar: i,
                bones,
                moving,
            }
        };
        DRAWN.iter().map(stick).collect()
    };
    let [first, second] = plane.shares.map(|s| 100.0 * s);
    let axis =
        |k: usize, share: f64| format!("principal coordinate {k} ({share:.0} % of variance)");
    let flow = Flow {
        title: "Figure 2. The flowfield of horizontal arm waving".into(),
        subtitle: format!(
            "`{}` of {n} choreographed exemplars; each arrow is the field's update from one posture, {:.0} ms long; the \
             flow goes from right to left",
            primitive.name(),
            1000.0 * AHEAD_SECS
        ),
        axes: [axis(1, first), axis(2, second)],
        arrows,
        exemplars: (0..n).map(way).collect(),
        above: sticks(top),
        below: sticks(bottom),
    };
    Ok(FieldView {
        flow,
        shares: plane.shares,
    })
}

/// All places of an even lattice over [0, 1]^dims.
fn lattice(dims: usize) -> Vec<Vec<f64>> {
    let digit = |at: usize, d: usize| at / ACROSS.pow(d as u32) % ACROSS;
    let place = |at: usize| {
        let of = |d: usize| digit(at, d) as f64 / (ACROSS - 1) as f64;
        (0..dims).map(of).collect()
    };
    (0..ACROSS.pow(dims as u32)).map(place).collect()
}

/// Of the exemplars with the greatest first parameter, those with the greatest and the least last one.
fn extremes(primitive: &Primitive) -> [usize; 2] {
    let n = primitive.exemplars().len();
    let ends = |i: usize| {
        let p = primitive.point(i);
        (p.first().copied(), p.last().copied())
    };
    let rank = |i: usize, sign: f64| {
        let (first, last) = ends(i);
        first.unwrap_or(0.0) * 2.0 + sign * last.unwrap_or(0.0)
    };
    [1.0, -1.0].map(|sign| {
        let best = (0..n).max_by(|&a, &b| rank(a, sign).total_cmp(&rank(b, sign)));
        best.unwrap_or(0)
    })
}

/// Two principal directions of the exemplars' postures.
struct Plane {
    mean: Vec<f64>,
    directions: [Vec<f64>; 2],
    shares: [f64; 2],
}

impl Plane {
    fn of(primitive: &Primitive) -> Self {
        let n = primitive.exemplars().len();
        let phase = |k: usize| k as f64 / (POSTURES - 1) as f64;
        let postures: Vec<Vec<f64>> = (0..n)
            .flat_map(|i| (0..POSTURES).map(move |k| (i, k)))
            .map(|(i, k)| primitive.registered(i, phase(k)).pose)
            .collect();
        let dof = primitive.body().dof();
        let count = postures.len() as f64;
        let mean: Vec<f64> = (0..dof)
            .map(|c| postures.iter().map(|x| x[c]).sum::<f64>() / count)
            .collect();
        let centred = DMatrix::from_fn(postures.len(), dof, |r, c| postures[r][c] - mean[c]);
        let eigen = SymmetricEigen::new(centred.tr_mul(&centred) / count);
        let mut order: Vec<usize> = (0..dof).collect();
        order.sort_by(|&a, &b| {
            eigen.eigenvalues[b]
                .total_cmp(&eigen.eigenvalues[a])
                .then(a.cmp(&b))
        });
        let whole: f64 = eigen.eigenvalues.iter().sum();
        let mut plane = Self {
            directions: [0, 1].map(|k| {
                eigen
                    .eigenvectors
                    .column(order[k])
                    .iter()
                    .copied()
                    .collect()
            }),
            shares: [0, 1].map(|k| eigen.eigenvalues[order[k]] / whole),
            mean,
        };
        // An eigenvector has no sign: the flow goes left, and what is higher stands higher.
        let [top, bottom] = extremes(primitive);
        let far = |a: &[f64], b: &[f64], k: usize| plane.place(b)[k] - plane.place(a)[k];
        let ends = [0.0, 1.0].map(|phase| primitive.registered(top, phase).pose);
        let heights = [bottom, top].map(|i| primitive.registered(i, 0.5).pose);
        let flips = [
            far(&ends[0], &ends[1], 0) > 0.0,
            far(&heights[0], &heights[1], 1) < 0.0,
        ];
        for (direction, flip) in plane.directions.iter_mut().zip(flips) {
            if flip {
                direction.iter_mut().for_each(|v| *v = -*v);
            }
        }
        plane
    }

    fn place(&self, pose: &[f64]) -> [f64; 2] {
        self.directions.each_ref().map(|direction| {
            let terms = pose.iter().zip(&self.mean).zip(direction);
            terms.map(|((x, m), d)| (x - m) * d).sum()
        })
    }
}

/// The bones of the upper body as somebody opposite sees them, metres, y up; the last so many are the right arm's.
fn bones(body: &Skeleton, pose: &[f64]) -> (Vec<[[f64; 2]; 2]>, usize) {
    let frames = body.frames(pose, &Root::ORIGIN);
    let seen = |p: &nalgebra::Vector3<f64>| [p.y, p.z];
    let legs = [
        Role::LeftUpperLeg,
        Role::RightUpperLeg,
        Role::LeftLowerLeg,
        Role::RightLowerLeg,
        Role::LeftFoot,
        Role::RightFoot,
        Role::LeftToes,
        Role::RightToes,
    ];
    let within = |mut j: usize, roles: &[Role]| loop {
        if body.joints()[j].role.is_some_and(|r| roles.contains(&r)) {
            return true;
        }
        match body.joints()[j].parent {
            Some(parent) => j = parent,
            None => return false,
        }
    };
    let (mut still, mut moving) = (Vec::new(), Vec::new());
    for (j, joint) in body.joints().iter().enumerate() {
        let Some(parent) = joint.parent else { continue };
        let bone = [seen(&frames[parent].position), seen(&frames[j].position)];
        if within(parent, &[Role::RightUpperArm]) {
            moving.push(bone);
        } else if !within(j, &legs) {
            still.push(bone);
        }
    }
    if let Ok(head) = body.effector("head") {
        let effector = &body.effectors()[head];
        let [x, y] = seen(&frames[effector.joint].place(&effector.point));
        let round = |k: usize| {
            let turn = k as f64 / 12.0 * std::f64::consts::TAU;
            [x + 0.75 * HEAD_M * turn.cos(), y + HEAD_M * turn.sin()]
        };
        still.extend((0..12).map(|k| [round(k), round(k + 1)]));
    }
    let count = moving.len();
    still.extend(moving);
    (still, count)
}
