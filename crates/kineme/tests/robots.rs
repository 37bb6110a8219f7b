//! Movements brought to another body pose by pose, robots of hinges among them.

mod sources;

use std::sync::Arc;

use kineme::math::rotation::exp;
use kineme::retargeting::{Transfer, transfer};
use kineme::skeleton::{Joint, JointKind, Link, Range};
use kineme::{Role, Root, Skeleton, adonis};
use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use sources::{Style, moving};

/// Adonis with three hinges (about y, x and z, `range` degrees each) in place of every ball.
fn robot(range: f64) -> Arc<Skeleton> {
    let body = adonis().expect("a body");
    let mut joints: Vec<Joint> = Vec::new();
    let mut last = Vec::new();
    for joint in body.joints() {
        let JointKind::Ball { .. } = joint.kind else {
            let parent = joint.parent.map(|p| last[p]);
            last.push(joints.len());
            joints.push(Joint {
                parent,
                ..joint.clone()
            });
            continue;
        };
        for (k, axis) in [Vector3::y_axis(), Vector3::x_axis(), Vector3::z_axis()]
            .into_iter()
            .enumerate()
        {
            let first = k == 0;
            joints.push(Joint {
                name: format!("{}_{k}", joint.name),
                parent: match first {
                    true => joint.parent.map(|p| last[p]),
                    false => Some(joints.len() - 1),
                },
                offset: if first {
                    joint.offset
                } else {
                    Vector3::zeros()
                },
                kind: JointKind::Hinge {
                    axis,
                    range: Range::degrees(-range, range),
                },
                ..joint.clone()
            });
        }
        last.push(joints.len() - 1);
    }
    Arc::new(Skeleton::new("hinged", joints, vec![]).expect("a body"))
}

fn body(name: &str) -> Arc<Skeleton> {
    Arc::new(kineme::skeleton::body(name).expect("a body"))
}

/// World orientation of the joint that carries a part.
fn part(body: &Skeleton, pose: &[f64], role: Role) -> UnitQuaternion<f64> {
    let joint = *body.joints_of(role).last().expect("a joint of this role");
    body.frames(pose, &Root::ORIGIN)[joint].rotation
}

const PARTS: [Role; 8] = [
    Role::Chest,
    Role::Head,
    Role::LeftUpperArm,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::RightUpperArm,
    Role::RightLowerArm,
    Role::RightHand,
];

/// A posture of `body` whose coordinates lie anywhere within this share of their limits, the root upright.
fn posture(body: &Skeleton, share: f64, random: &mut Pcg64) -> Vec<f64> {
    let mut pose = body.neutral();
    for j in 0..body.joints().len() {
        for (&k, range) in body
            .coordinates(j)
            .collect::<Vec<_>>()
            .iter()
            .zip(body.limits(j))
        {
            pose[k] = share * random.random_range(range.low..=range.high);
        }
    }
    pose
}

fn random(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

#[test]
fn on_the_same_body_a_pose_stays_what_it_is() {
    let ares = body("ares");
    let mut same = Transfer::between(&ares, &body("ares")).expect("the same body");
    assert!(same.without_counterpart().is_empty());
    let pose = posture(&ares, 1.0, &mut random(1));
    let rates: Vec<f64> = pose.iter().map(|x| 2.0 * x).collect();
    let mut out = vec![0.0; ares.dof()];
    same.pose(&pose, &mut out);
    assert_eq!(out, pose);
    let moved = same.command(&pose, &rates, &pose);
    assert_eq!(
        (&moved.pose, &moved.velocity, &moved.acceleration),
        (&pose, &rates, &pose)
    );
}

#[test]
fn pose_by_pose_is_the_transfer_of_the_whole_motion() {
    let motion = moving(15, Style::default());
    for to in [body("adonis"), robot(170.0)] {
        let (whole, _) = transfer(&motion, &to).expect("a motion");
        let mut single = Transfer::between(motion.skeleton(), &to).expect("bodies alike");
        let mut out = vec![0.0; to.dof()];
        for f in 0..motion.frames() {
            single.pose(motion.pose(f), &mut out);
            for (a, b) in out.iter().zip(whole.pose(f)) {
                assert!(
                    (a - b).abs() < 1e-9,
                    "{}, frame {f}: {a} not {b}",
                    to.name()
                );
            }
        }
    }
}

#[test]
fn there_and_back_again_a_posture_is_the_same_where_both_bodies_have_the_joint() {
    let (adonis, ares) = (body("adonis"), body("ares"));
    let mut random = random(2);
    for case in 0..200 {
        let pose = posture(&adonis, 1.0, &mut random);
        let mut there = vec![0.0; ares.dof()];
        let mut back = vec![0.0; adonis.dof()];
        let way = |from, to| Transfer::between(from, to).expect("bodies alike");
        way(&adonis, &ares).pose(&pose, &mut there);
        way(&ares, &adonis).pose(&there, &mut back);
        for role in PARTS {
            let off = part(&adonis, &back, role).angle_to(&part(&adonis, &pose, role));
            assert!(off < 1e-6, "posture {case}, {}: {off}", role.name());
        }
    }
}

#[test]
fn hinges_bring_the_part_to_where_a_ball_has_it() {
    let (adonis, hinged) = (body("adonis"), robot(179.0));
    let mut random = random(3);
    let mut out = vec![0.0; hinged.dof()];
    for case in 0..200 {
        let pose = posture(&adonis, 0.7, &mut random);
        // No posture before: the whole range is searched, whichever way the arm points.
        let mut once = Transfer::between(&adonis, &hinged).expect("bodies alike");
        once.pose(&pose, &mut out);
        for role in PARTS {
            let off = part(&hinged, &out, role).angle_to(&part(&adonis, &pose, role));
            assert!(off < 1e-5, "posture {case}, {}: {off}", role.name());
        }
    }
}

#[test]
fn joints_without_counterpart_are_named() {
    let names = |from: &Arc<Skeleton>, to: &Arc<Skeleton>| -> Vec<String> {
        let way = Transfer::between(from, to).expect("bodies alike");
        let joints = way.without_counterpart().iter();
        joints.map(|&j| from.joints()[j].name.clone()).collect()
    };
    let (adonis, ares) = (body("adonis"), body("ares"));
    assert!(names(&adonis, &ares).is_empty());
    let missing = names(&ares, &adonis);
    for joint in ["pelvis", "left_clavicle", "left_fingers", "right_knee"] {
        assert!(missing.iter().any(|m| m == joint), "{joint} in {missing:?}");
    }
    assert!(!missing.iter().any(|m| m == "lumbar_3" || m == "left_elbow"));
}

#[test]
fn bodies_that_share_no_part_are_refused() {
    let bare = |name: &str, role: Option<Role>| {
        let root = Joint {
            name: "root".into(),
            parent: None,
            kind: JointKind::Hinge {
                axis: Vector3::z_axis(),
                range: Range::degrees(-90.0, 90.0),
            },
            role,
            offset: Vector3::zeros(),
            axes: adonis().expect("a body").joints()[0].axes,
            share: 1.0,
            tip: Vector3::zeros(),
            link: Link {
                mass_kg: 1.0,
                center: Vector3::zeros(),
                inertia: Matrix3::identity(),
            },
        };
        Arc::new(Skeleton::new(name, vec![root], vec![]).expect("a body"))
    };
    let ares = body("ares");
    for arm in [bare("crane", None), bare("foot", Some(Role::LeftToes))] {
        let refused = Transfer::between(&arm, &body("adonis")).expect_err("nothing to show");
        assert!(refused.is_unsupported(), "{refused}");
    }
    assert!(Transfer::between(&bare("foot", Some(Role::LeftToes)), &ares).is_ok());
}

#[test]
fn through_a_singularity_the_hinges_go_on_without_a_jump() {
    let (adonis, hinged) = (body("adonis"), robot(170.0));
    let shoulder = *adonis.joints_of(Role::LeftUpperArm).last().expect("an arm");
    let mut pose = adonis.neutral();
    let mut out = vec![0.0; hinged.dof()];
    let mut way = Transfer::between(&adonis, &hinged).expect("bodies alike");
    let mut before: Option<Vec<f64>> = None;
    let mut widest = 0f64;
    // The arm sweeps over the left, where the first and the third hinge are about one line, at 90 degrees a second.
    for f in 0..=210 {
        let t = f as f64 / 120.0;
        let side = exp(&Vector3::new(t * 90f64.to_radians(), 0.0, 0.0));
        let turn = exp(&Vector3::new(0.0, 0.0, 0.01)) * side;
        adonis.set_rotation(&mut pose, shoulder, &turn, None);
        way.pose(&pose, &mut out);
        let arm = part(&hinged, &out, Role::LeftUpperArm);
        let down = -Vector3::z();
        let off = (arm * down).angle(&(turn * down));
        assert!(
            off < 1f64.to_radians(),
            "frame {f}: {} degrees",
            off.to_degrees()
        );
        if let Some(before) = &before {
            let steps = out.iter().zip(before).map(|(a, b)| (a - b).abs());
            widest = steps.fold(widest, f64::max);
        }
        before = Some(out.clone());
    }
    assert!(widest < 0.2, "{widest} rad in one step");
}

/// A movement of Adonis that turns about everything: its coordinates with two derivatives.
fn waving(adonis: &Skeleton, t: f64) -> [Vec<f64>; 3] {
    let (mut pose, mut rate, mut bend) = (adonis.neutral(), Vec::new(), Vec::new());
    for (k, x) in pose.iter_mut().enumerate() {
        let (hz, at) = (2.0 + 0.3 * k as f64, 0.7 * k as f64);
        *x += 0.25 * (hz * t + at).sin();
        // Elbows bend, away from their stop.
        *x += if k == 9 || k == 16 { 0.6 } else { 0.0 };
        rate.push(0.25 * hz * (hz * t + at).cos());
        bend.push(-0.25 * hz * hz * (hz * t + at).sin());
    }
    [pose, rate, bend]
}

#[test]
fn velocity_and_acceleration_are_those_of_the_poses() {
    let adonis = body("adonis");
    for to in [body("ares"), robot(170.0)] {
        let mut way = Transfer::between(&adonis, &to).expect("bodies alike");
        // So fine that a difference is a derivative, and that keeping the angles before costs nothing.
        let step = 1e-4;
        let mut poses = Vec::new();
        let mut told = Vec::new();
        for f in 0..4000 {
            let [pose, rate, bend] = waving(&adonis, f as f64 * step);
            let moved = way.command(&pose, &rate, &bend);
            poses.push(moved.pose.clone());
            told.push((moved.velocity.clone(), moved.acceleration.clone()));
        }
        for f in (50..3950).step_by(50) {
            for (k, (&v, &a)) in told[f].0.iter().zip(&told[f].1).enumerate() {
                let at = |i: usize| poses[i][k];
                let velocity = (at(f + 40) - at(f - 40)) / (80.0 * step);
                let acceleration = (at(f + 40) - 2.0 * at(f) + at(f - 40)) / (40.0 * step).powi(2);
                assert!(
                    (v - velocity).abs() < 5e-3 * (1.0 + velocity.abs()),
                    "{} {k}: {v} not {velocity}",
                    to.name()
                );
                assert!(
                    (a - acceleration).abs() < 0.05 * (1.0 + acceleration.abs()),
                    "{} frame {f} coordinate {k}: {a} not {acceleration}",
                    to.name()
                );
            }
        }
    }
}

#[test]
fn ranges_are_kept_and_what_is_left_is_done_by_the_others() {
    let (adonis, narrow) = (body("adonis"), robot(40.0));
    let mut way = Transfer::between(&adonis, &narrow).expect("bodies alike");
    let shoulder = *adonis.joints_of(Role::LeftUpperArm).last().expect("an arm");
    let first = narrow.joint("left_shoulder_0").expect("a hinge");
    let at = narrow.coordinates(first).start;
    let still = vec![0.0; adonis.dof()];
    for f in 0..200 {
        let [mut pose, mut rate, _] = waving(&adonis, f as f64 * 0.02);
        let raised = exp(&Vector3::new(0.3, -1.2, 0.0));
        adonis.set_rotation(&mut pose, shoulder, &raised, None);
        rate[adonis.coordinates(shoulder)].copy_from_slice(&[0.5, -0.5, 0.5]);
        let moved = way.command(&pose, &rate, &still);
        for (j, joint) in narrow.joints().iter().enumerate() {
            if let JointKind::Hinge { range, .. } = joint.kind {
                let angle = moved.pose[narrow.coordinates(j).start];
                assert!((range.low..=range.high).contains(&angle), "{}", joint.name);
            }
        }
        let stopped = moved.pose[at] + 40f64.to_radians();
        assert!(stopped.abs() < 1e-12, "{stopped} from its stop");
        assert_eq!((moved.velocity[at], moved.acceleration[at]), (0.0, 0.0));
        // No other angles within the ranges come nearer.
        let wanted = part(&adonis, &pose, Role::LeftUpperArm);
        let chest = part(&narrow, &moved.pose, Role::Chest);
        let off = |pose: &[f64]| {
            let arm = chest.inverse() * part(&narrow, pose, Role::LeftUpperArm);
            (chest * arm).angle_to(&wanted)
        };
        let here = off(&moved.pose);
        for k in at..at + 3 {
            for step in [-1e-3, 1e-3] {
                let mut beside = moved.pose.clone();
                beside[k] = (beside[k] + step).clamp(-40f64.to_radians(), 40f64.to_radians());
                assert!(off(&beside) > here - 2e-5, "frame {f}, hinge {k}");
            }
        }
    }
}

#[test]
fn axes_may_lie_anyhow_and_the_first_posture_may_be_anywhere() {
    // Two hinges that are neither parallel nor upright: what they can do, they are found to do.
    let adonis = body("adonis");
    let mut random = random(5);
    let unit = |random: &mut Pcg64| {
        let mut next = || random.random_range(-1.0..1.0);
        Unit::new_normalize(Vector3::new(next(), next(), next()))
    };
    for case in 0..50 {
        let axes = [unit(&mut random), unit(&mut random)];
        let mut joints: Vec<Joint> = adonis.joints()[..2].to_vec();
        joints[1].kind = JointKind::Fixed;
        joints[1].role = None;
        for (k, axis) in axes.iter().enumerate() {
            joints.push(Joint {
                name: format!("hinge_{k}"),
                parent: Some(1 + k),
                kind: JointKind::Hinge {
                    axis: *axis,
                    range: Range::degrees(-150.0, 150.0),
                },
                role: Some(Role::Chest),
                ..adonis.joints()[1].clone()
            });
        }
        let robot = Arc::new(Skeleton::new("two", joints, vec![]).expect("a body"));
        let angles = [0.0; 2].map(|_| random.random_range(-1.4..1.4));
        let wanted = part(&robot, &angles, Role::Chest);
        let mut pose = adonis.neutral();
        adonis.set_rotation(&mut pose, 1, &wanted, None);
        let mut out = vec![0.0; 2];
        let mut way = Transfer::between(&adonis, &robot).expect("bodies alike");
        way.pose(&pose, &mut out);
        let off = part(&robot, &out, Role::Chest).angle_to(&wanted);
        assert!(off < 1e-4, "case {case}: {off}");
    }
}

#[test]
fn ares_moves_the_robot_as_it_moves_adonis() {
    // Ares' whole trunk and girdle end in the same orientations, whatever carries them.
    let (ares, hinged) = (body("ares"), robot(179.0));
    let way = Transfer::between(&ares, &hinged).expect("bodies alike");
    let motion = moving(22, Style::default());
    let mut way = way;
    let mut out = vec![0.0; hinged.dof()];
    let mut worst = 0f64;
    for f in 0..motion.frames() {
        way.pose(motion.pose(f), &mut out);
        for role in [Role::Chest, Role::LeftUpperArm, Role::RightUpperArm] {
            let off = part(&hinged, &out, role).angle_to(&part(&ares, motion.pose(f), role));
            worst = worst.max(off);
        }
    }
    assert!(worst < 2f64.to_radians(), "{} degrees", worst.to_degrees());
}
