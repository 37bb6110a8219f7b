//! The generated models are the skeletons: masses, symmetry, kinematics; and hinges turn as balls do.

use std::sync::Arc;

use kineme::control::{Command, Robot};
use kineme::math::rotation::exp;
use kineme::skeleton::JointKind;
use kineme::{Root, Skeleton};
use kineme_sim::{Hinges, Servo, SimSettings, SimulatedRobot, Triple, mjcf};
use mujoco_rs::prelude::{MjData, MjModel};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64;

fn bodies() -> [(Arc<Skeleton>, usize); 2] {
    [
        (Arc::new(kineme::adonis().expect("adonis")), 20),
        (Arc::new(kineme::ares().expect("ares")), 132),
    ]
}

fn robot(body: &Arc<Skeleton>) -> SimulatedRobot {
    SimulatedRobot::humanoid(body, &SimSettings::default()).expect("a robot")
}

fn resting(pose: &[f64]) -> Command {
    Command {
        pose: pose.to_vec(),
        velocity: vec![0.0; pose.len()],
        acceleration: vec![0.0; pose.len()],
        root: Root::ORIGIN,
        phase: 0.0,
        finished: true,
        limited: 0,
    }
}

/// A posture within limits, the root turned by up to half a radian about each axis.
fn posture(body: &Skeleton, random: &mut Pcg64) -> Vec<f64> {
    let mut pose: Vec<f64> = (0..body.dof())
        .map(|_| random.random_range(-0.5..0.5))
        .collect();
    for j in 1..body.joints().len() {
        let axes = &body.joints()[j].axes;
        let axes = [axes.flexion, axes.abduction, axes.axial];
        let at = body.coordinates(j);
        let limits = body.limits(j);
        let value: Vec<f64> = limits
            .iter()
            .map(|r| random.random_range(r.low..r.high))
            .collect();
        match value[..] {
            [angle] => pose[at.start] = angle,
            [f, a, x] => {
                let v = axes[0] * f + axes[1] * a + axes[2] * x;
                pose[at].copy_from_slice(v.as_slice());
            }
            _ => {}
        }
    }
    pose
}

/// The axes of a joint's hinges, if it is a ball.
fn triple(body: &Skeleton, j: usize) -> Option<Triple> {
    let joint = &body.joints()[j];
    match &joint.kind {
        JointKind::Ball { reference, ranges } => {
            Some(Triple::between(reference, &joint.axes, ranges))
        }
        _ => None,
    }
}

#[test]
fn a_model_has_the_masses_and_the_freedom_of_its_body() {
    for (body, dof) in bodies() {
        let text = mjcf(&body, &SimSettings::default());
        let model = MjModel::from_xml_string(&text).expect("a model");
        assert_eq!(model.jnt_type().len(), dof, "{}", body.name());
        assert!((model.totalmass() - body.mass_kg()).abs() < 1e-9);
        assert!(
            (model.totalmass() - 73.0).abs() < 0.2,
            "{}",
            model.totalmass()
        );
        for joint in body.joints() {
            let id = model.name_to_id(mujoco_rs::prelude::MjtObjBase::mjOBJ_BODY, &joint.name);
            let id = id.expect("a body of that name");
            let mass = model.body_mass()[id];
            assert!((mass - joint.link.mass_kg).abs() < 1e-12, "{}", joint.name);
            let center = Vector3::from(model.body_ipos()[id]);
            assert!((center - joint.link.center).norm() < 1e-12);
            let [w, x, y, z] = model.body_iquat()[id];
            let frame = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            let turned = frame.to_rotation_matrix();
            let principal = Matrix3::from_diagonal(&Vector3::from(model.body_inertia()[id]));
            let inertia = turned.matrix() * principal * turned.matrix().transpose();
            assert!(
                (inertia - joint.link.inertia).norm() < 1e-9,
                "{}",
                joint.name
            );
        }
    }
}

#[test]
fn the_halves_of_a_model_resist_alike() {
    for (body, dof) in bodies() {
        let robot = robot(&body);
        let model = robot.plant().model();
        let mut data = MjData::new(model);
        data.qpos_mut().copy_from_slice(robot.plant().angles());
        data.forward();
        let mut matrix = vec![0.0; dof * dof];
        data.full_m(&mut matrix).expect("room enough");
        let names: Vec<&str> = (0..dof)
            .map(|j| {
                let kind = mujoco_rs::prelude::MjtObjBase::mjOBJ_JOINT;
                model.id_to_name(kind, j).expect("a name")
            })
            .collect();
        let armature = SimSettings::default().armature;
        for (j, name) in names.iter().enumerate() {
            let own = matrix[j * dof + j];
            // Nothing has more than the whole body's inertia about its feet.
            assert!((armature..100.0).contains(&own), "{name}: {own} kg m^2");
            let twin = name.replace("left", "right");
            let k = names.iter().position(|n| *n == twin).expect("a twin");
            let other = matrix[k * dof + k];
            assert!(
                (own - other).abs() < 1e-9 * own,
                "{name}: {own} and {other}"
            );
        }
    }
}

#[test]
fn a_model_stands_where_its_body_does() {
    let mut random = Pcg64::seed_from_u64(1);
    for (body, _) in bodies() {
        let mut robot = robot(&body);
        let ids: Vec<usize> = body
            .joints()
            .iter()
            .map(|joint| {
                let kind = mujoco_rs::prelude::MjtObjBase::mjOBJ_BODY;
                let id = robot.plant().model().name_to_id(kind, &joint.name);
                id.expect("a body of that name")
            })
            .collect();
        for _ in 0..20 {
            let pose = posture(&body, &mut random);
            robot.reset(&pose, &vec![0.0; body.dof()]).expect("reset");
            let data = robot.plant().data();
            for (frame, &id) in body.frames(&pose, &Root::ORIGIN).iter().zip(&ids) {
                let place = Vector3::from(data.xpos()[id]);
                let [w, x, y, z] = data.xquat()[id];
                let turned = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
                // The engine's frame of a fixed joint or a hinge is the joint's; of a ball, too.
                assert!((place - frame.position).norm() < 1e-9);
                assert!(turned.angle_to(&frame.rotation) < 1e-7);
                let apart = turned.to_rotation_matrix().matrix()
                    - frame.rotation.to_rotation_matrix().matrix();
                assert!(apart.norm() < 1e-9);
            }
        }
    }
}

/// Half of every range about the neutral posture.
#[test]
fn usual_postures_are_far_from_the_lock() {
    for (body, _) in bodies() {
        for (j, joint) in body.joints().iter().enumerate() {
            let (Some(triple), JointKind::Ball { reference, ranges }) =
                (triple(&body, j), &joint.kind)
            else {
                continue;
            };
            let [a, b, c] = triple.axes();
            assert!(a.dot(&b).abs() + b.dot(&c).abs() + a.dot(&c).abs() < 1e-12);
            assert!(triple.lock(&UnitQuaternion::identity()) < 1e-9);
            let at = |k: usize, i: usize| {
                let range = &ranges[k];
                0.5 * (range.low + i as f64 / 6.0 * (range.high - range.low))
            };
            for i in 0..343 {
                let angles = [at(0, i / 49), at(1, i / 7 % 7), at(2, i % 7)];
                let turned = joint.axes.rotation(angles[0], angles[1], angles[2]);
                let lock = triple.lock(&(reference.inverse() * turned)).to_degrees();
                assert!(lock < 60.0, "{}: {lock} degrees at {angles:?}", joint.name);
            }
        }
    }
}

#[test]
fn coordinates_come_back_from_the_hinges() {
    let mut random = Pcg64::seed_from_u64(2);
    for (body, dof) in bodies() {
        let hinges = robot(&body).hinges().clone();
        let triples: Vec<_> = (0..body.joints().len()).map(|j| triple(&body, j)).collect();
        let (mut angles, mut rates) = (vec![0.0; dof], vec![0.0; dof]);
        for _ in 0..50 {
            let pose = posture(&body, &mut random);
            let velocity: Vec<f64> = (0..dof).map(|_| random.random_range(-3.0..3.0)).collect();
            hinges.angles(&pose, &velocity, &mut angles, &mut rates);
            // From near by: a rotation vector longer than pi has another name.
            let mut again: Vec<f64> = pose.iter().map(|x| 0.9 * x).collect();
            let mut moving = vec![0.0; dof];
            hinges.pose(&angles, &rates, &mut again, &mut moving);
            for c in 0..dof {
                assert!((again[c] - pose[c]).abs() < 1e-9, "{} {c}", body.name());
            }
            for (j, triple) in triples.iter().enumerate() {
                let at = body.coordinates(j);
                // Near the lock rates are damped.
                let locked = triple.as_ref().is_some_and(|triple| {
                    let v = Vector3::from_column_slice(&pose[at.clone()]);
                    triple.lock(&exp(&v)) > 1.51
                });
                for c in at {
                    let error = (moving[c] - velocity[c]).abs();
                    assert!(locked || error < 1e-8, "{} {c}: {error}", body.name());
                }
            }
        }
    }
}

/// Rates of angles and coordinates are derivatives of the angles and the coordinates: central differences.
#[test]
fn rates_are_derivatives() {
    let (body, dof) = &bodies()[0];
    let hinges: Hinges = robot(body).hinges().clone();
    let mut random = Pcg64::seed_from_u64(3);
    let neutral = body.neutral();
    for _ in 0..20 {
        let direction: Vec<f64> = (0..*dof).map(|_| random.random_range(-1.0..1.0)).collect();
        let at = |t: f64| -> Vec<f64> {
            let pairs = neutral.iter().zip(&direction);
            pairs.map(|(x, d)| 0.5 * x + 0.7 * d * t.sin()).collect()
        };
        let (t, h) = (0.4, 1e-5);
        let velocity: Vec<f64> = direction.iter().map(|d| 0.7 * d * f64::cos(t)).collect();
        let angles_at = |t: f64| {
            let (mut angles, mut rates) = (vec![0.0; *dof], vec![0.0; *dof]);
            hinges.angles(&at(t), &velocity, &mut angles, &mut rates);
            (angles, rates)
        };
        let ((before, _), (_, rates), (after, _)) =
            (angles_at(t - h), angles_at(t), angles_at(t + h));
        for i in 0..*dof {
            let slope = (after[i] - before[i]) / (2.0 * h);
            assert!(
                (slope - rates[i]).abs() < 1e-6,
                "hinge {i}: {slope} {}",
                rates[i]
            );
        }
    }
}

/// A shoulder that swings through the lock keeps continuous angles, and the same posture comes out on the way.
#[test]
fn angles_go_on_through_the_lock() {
    let triple = Triple::plain();
    let mut angles = [0.0; 3];
    for i in 0..=200 {
        let middle = 0.01 * f64::from(i); // 0 to 2 rad, past a right angle
        let rotation = triple.rotation([0.3, middle, -0.2]);
        let next = triple.angles(&rotation, angles);
        let step = (0..3)
            .map(|k| (next[k] - angles[k]).abs())
            .fold(0.0, f64::max);
        assert!(
            i == 0 || step < 0.011 || (middle - 1.57).abs() < 0.02,
            "{step} at {middle}"
        );
        assert!(triple.rotation(next).angle_to(&rotation) < 1e-7);
        angles = next;
    }
    assert!((angles[1] - 2.0).abs() < 1e-6, "{angles:?}");
}

/// The engine's own step, which resets what diverges, and ours, which stops it before, do the same.
#[test]
fn a_step_is_the_engines_own() {
    let (body, dof) = &bodies()[0];
    for servo in [Servo::Pd, Servo::ComputedTorque] {
        let settings = SimSettings {
            servo: Some(servo),
            ..SimSettings::default()
        };
        let mut robot = SimulatedRobot::humanoid(body, &settings).expect("a robot");
        let mut random = Pcg64::seed_from_u64(5);
        for _ in 0..5 {
            let pose = posture(body, &mut random);
            let velocity: Vec<f64> = (0..*dof).map(|_| random.random_range(-3.0..3.0)).collect();
            robot.reset(&pose, &velocity).expect("reset");
            let (angles, rates) = (
                robot.plant().angles().to_vec(),
                robot.plant().rates().to_vec(),
            );
            robot
                .advance(&resting(&pose), settings.step_secs)
                .expect("stable");
            let mut data = MjData::new(robot.plant().model());
            data.qpos_mut().copy_from_slice(&angles);
            data.qvel_mut().copy_from_slice(&rates);
            data.ctrl_mut().copy_from_slice(robot.plant().data().ctrl());
            data.step();
            assert_eq!(data.qpos(), robot.plant().angles());
            assert_eq!(data.qvel(), robot.plant().rates());
        }
    }
}

/// Adonis without drives is a pendulum of 20 hinges, but for their armature: what it loses in height it gains in speed.
#[test]
fn a_body_that_nothing_drives_keeps_its_energy() {
    let (body, dof) = &bodies()[0];
    let settings = SimSettings {
        servo: Some(Servo::ComputedTorque),
        joint_limits: false,
        ..SimSettings::default()
    };
    let robot = SimulatedRobot::humanoid(body, &settings).expect("a robot");
    let model = robot.plant().model();
    let mut data = MjData::new(model);
    data.qpos_mut().copy_from_slice(robot.plant().angles());
    let mut matrix = vec![0.0; dof * dof];
    let mut energy = |data: &mut MjData<&MjModel>| {
        data.forward();
        data.full_m(&mut matrix).expect("room enough");
        let v = data.qvel();
        let pairs = (0..*dof).flat_map(|i| (0..*dof).map(move |j| (i, j)));
        let kinetic: f64 = pairs
            .map(|(i, j)| 0.5 * v[i] * matrix[i * dof + j] * v[j])
            .sum();
        let heights = data.xipos().iter().zip(model.body_mass());
        (
            kinetic,
            heights
                .map(|(place, mass)| 9.81 * mass * place[2])
                .sum::<f64>(),
        )
    };
    // Tipped forward, so that it falls.
    data.qpos_mut()[0] += 0.3;
    let (_, before) = energy(&mut data);
    for _ in 0..500 {
        data.step();
    }
    let (kinetic, after) = energy(&mut data);
    let lost = (kinetic + after - before).abs();
    println!("kinetic {kinetic:.3} J, fallen {:.3} J", before - after);
    assert!(
        kinetic > 10.0 && lost < 0.02 * kinetic,
        "{lost} of {kinetic} J"
    );
}
