//! Four primitives, made by hand on both bodies, and postures from which to begin them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

use kineme::choreography::{Key, perform};
use kineme::{
    Course, Exemplar, Modelling, Motion, Primitive, Role, Root, Skeleton, Transitions, Vocabulary,
    adonis, ares,
};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

fn key(time: f64, angles: &[(Role, [f64; 3])]) -> Key {
    let hinge = |role: Role| matches!(role, Role::RightLowerArm | Role::LeftLowerArm);
    let listed =
        |&(role, a): &(Role, [f64; 3])| (role, if hinge(role) { vec![a[0]] } else { a.to_vec() });
    Key {
        time,
        angles: angles.iter().map(listed).collect::<BTreeMap<_, _>>(),
    }
}

/// Reach out with the right arm and come back.
pub fn reach(height: f64) -> Vec<Key> {
    use Role::{Chest, RightLowerArm, RightUpperArm};
    let home = [
        (RightUpperArm, [15.0, 8.0, 0.0]),
        (RightLowerArm, [95.0, 0.0, 0.0]),
        (Chest, [0.0; 3]),
    ];
    let out = [
        (RightUpperArm, [40.0 + 60.0 * height, 15.0, 0.0]),
        (RightLowerArm, [15.0, 0.0, 0.0]),
        (Chest, [0.0, 0.0, 12.0]),
    ];
    vec![key(0.0, &home), key(0.4, &out), key(0.9, &home)]
}

/// Raise the left arm and leave it there.
pub fn raise(height: f64) -> Vec<Key> {
    let at = |flexion: f64, elbow: f64| {
        [
            (Role::LeftUpperArm, [flexion, 12.0, 5.0]),
            (Role::LeftLowerArm, [elbow, 0.0, 0.0]),
        ]
    };
    vec![
        key(0.0, &at(10.0, 30.0)),
        key(0.7, &at(70.0 + 40.0 * height, 15.0)),
    ]
}

/// Wave with the right hand, from one side to the other.
pub fn wave(height: f64) -> Vec<Key> {
    let at = |side: f64| {
        [
            (Role::RightUpperArm, [60.0 + 20.0 * height, 40.0, side]),
            (Role::RightLowerArm, [80.0, 0.0, 0.0]),
        ]
    };
    vec![
        key(0.0, &at(-30.0)),
        key(0.5, &at(35.0)),
        key(1.0, &at(-25.0)),
    ]
}

fn choreographed(body: &Arc<Skeleton>, name: &str, keys: fn(f64) -> Vec<Key>) -> Primitive {
    let one = |h: f64| {
        let motion = perform(name, &keys(h), body, 120.0).expect("keys");
        Exemplar::whole(motion, Some(vec![h]))
    };
    Primitive::learn(
        name,
        [0.0, 0.5, 1.0].map(one).to_vec(),
        &Modelling::default(),
    )
    .expect(name)
}

pub const WALK_M_S: f64 = 1.2;
pub const WALK_RAD_S: f64 = 0.3;

/// Arms that swing while the body goes round in a circle, its height going up and down.
fn walk(body: &Arc<Skeleton>) -> Primitive {
    let one = |swing: f64| {
        let (rate, period, cycles) = (100.0, 1.0 + 0.1 * swing, 5.0);
        let count = (rate * period * cycles) as usize + 1;
        let (mut poses, mut roots) = (Vec::new(), Vec::new());
        for f in 0..count {
            let t = f as f64 / rate;
            let wave = (TAU * t / period).sin();
            let mut pose = body.neutral();
            for (role, sign) in [(Role::LeftUpperArm, 1.0), (Role::RightUpperArm, -1.0)] {
                let angles = [10.0 + sign * (25.0 + 10.0 * swing) * wave, 8.0, 0.0];
                body.set_clinical(&mut pose, role, &angles).expect("an arm");
            }
            for (role, sign) in [(Role::LeftLowerArm, 1.0), (Role::RightLowerArm, -1.0)] {
                let angle = 30.0 + sign * 10.0 * (wave + 0.3 * (2.0 * TAU * t / period).sin());
                body.set_clinical(&mut pose, role, &[angle])
                    .expect("an elbow");
            }
            poses.extend(pose);
            let yaw = WALK_RAD_S * t;
            roots.push(Root {
                position: Vector3::new(
                    WALK_M_S / WALK_RAD_S * yaw.sin(),
                    WALK_M_S / WALK_RAD_S * (1.0 - yaw.cos()),
                    0.9 + 0.02 * (2.0 * TAU * t / period).cos(),
                ),
                yaw,
            });
        }
        let motion = Motion::new("walk", Arc::clone(body), rate, poses, roots);
        Exemplar::whole(motion.expect("a motion"), Some(vec![swing]))
    };
    let modelling = Modelling {
        cyclic: Some(true),
        ..Modelling::default()
    };
    Primitive::learn("walk", [0.0, 1.0].map(one).to_vec(), &modelling).expect("walk")
}

fn vocabulary(body: Skeleton) -> Vec<Primitive> {
    let body = Arc::new(body);
    vec![
        choreographed(&body, "reach", reach),
        choreographed(&body, "raise", raise),
        choreographed(&body, "wave", wave),
        walk(&body),
    ]
}

pub fn of_adonis() -> &'static [Primitive] {
    static MADE: OnceLock<Vec<Primitive>> = OnceLock::new();
    MADE.get_or_init(|| vocabulary(adonis().expect("adonis")))
}

pub fn of_ares() -> &'static [Primitive] {
    static MADE: OnceLock<Vec<Primitive>> = OnceLock::new();
    MADE.get_or_init(|| vocabulary(ares().expect("ares")))
}

pub fn course(primitive: &Primitive, p: f64) -> Arc<Course> {
    Arc::new(primitive.at(&[p]).expect("a course"))
}

pub fn gap(a: &[f64], b: &[f64]) -> f64 {
    let far = |(x, y): (&f64, &f64)| (x - y).abs();
    a.iter().zip(b).map(far).fold(0.0, f64::max)
}

/// A posture in which every joint is somewhere within its limits.
pub fn posture(body: &Skeleton, random: &mut Pcg64) -> Vec<f64> {
    let mut pose = vec![0.0; body.dof()];
    for (j, joint) in body.joints().iter().enumerate() {
        let at = body.coordinates(j);
        match body.limits(j) {
            [one] => pose[at.start] = random.random_range(one.low..one.high),
            [_, _, _] => {
                let axes = [joint.axes.flexion, joint.axes.abduction, joint.axes.axial];
                let sum: Vector3<f64> = axes
                    .iter()
                    .zip(body.limits(j))
                    .map(|(axis, r)| axis * random.random_range(r.low..r.high))
                    .sum();
                pose[at].copy_from_slice(sum.as_slice());
            }
            _ => {
                for c in at {
                    pose[c] = random.random_range(-1.0..1.0);
                }
            }
        }
    }
    body.limited(&mut pose);
    pose
}

/// The primitives as what a controller moves a body by.
pub fn vocabulary_of(primitives: &[Primitive]) -> Vocabulary {
    let body = Arc::clone(primitives[0].body());
    let transitions = Transitions::none(primitives.len());
    Vocabulary::new(body, primitives.to_vec(), Vec::new(), transitions).expect("a vocabulary")
}
