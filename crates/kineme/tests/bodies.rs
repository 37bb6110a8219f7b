//! The built-in bodies: degrees of freedom, masses, symmetry, heights, clinical movements, forward kinematics.

use kineme::skeleton::{BODY_MASS, Frame, JointKind, STATURE};
use kineme::{Role, Root, Skeleton, adonis, ares, body};
use nalgebra::{UnitQuaternion, Vector3};

fn bodies() -> [Skeleton; 2] {
    [adonis().expect("a body"), ares().expect("a body")]
}

fn frames(body: &Skeleton, pose: &[f64]) -> Vec<Frame> {
    body.frames(pose, &Root::ORIGIN)
}

#[test]
fn degrees_of_freedom_are_the_papers() {
    for (body, dof, moving, listed) in [
        (
            adonis(),
            20,
            8,
            vec![
                ("waist", 3),
                ("neck", 3),
                ("left_shoulder", 3),
                ("right_elbow", 1),
                ("left_wrist", 3),
            ],
        ),
        (
            ares(),
            132,
            44,
            vec![
                ("pelvis", 3),
                ("lumbar_5", 3),
                ("skull", 3),
                ("left_elbow", 3),
                ("right_toes", 3),
            ],
        ),
    ] {
        let body = body.expect("a body");
        assert_eq!(body.dof(), dof, "{}", body.name());
        assert_eq!(body.coordinate_names().len(), dof);
        let joints = body.joints().iter().filter(|j| j.kind.dof() > 0);
        assert_eq!(joints.count(), moving, "{}", body.name());
        for (name, dof) in listed {
            let joint = body.joint(name).expect("a joint");
            assert_eq!(body.coordinates(joint).len(), dof, "{name}");
        }
    }
    let ares = ares().expect("a body");
    let count = |what: &dyn Fn(&str) -> bool| -> usize {
        let joints = ares.joints().iter().filter(|j| what(&j.name));
        joints.map(|j| j.kind.dof()).sum()
    };
    assert_eq!(
        count(&|n| n.contains("lumbar") || n.contains("thoracic") || n.contains("cervical")),
        72
    );
    for side in ["left", "right"] {
        let one_of = |n: &str, parts: [&str; 5]| parts.iter().any(|p| n == format!("{side}_{p}"));
        assert_eq!(
            count(&|n| one_of(n, ["clavicle", "shoulder", "elbow", "wrist", "fingers"])),
            15
        );
        assert_eq!(
            count(&|n| one_of(n, ["hip", "knee", "ankle", "toes", ""])),
            12
        );
    }
    assert!(body("hal").is_err_and(|e| e.is_unknown_name()));
}

#[test]
fn masses_are_de_levas_man() {
    for body in bodies() {
        assert!(
            (body.mass_kg() - BODY_MASS).abs() < 1e-9,
            "{}: {}",
            body.name(),
            body.mass_kg()
        );
        // Centre of mass of the standing man: 55 to 57 % of stature over the floor.
        let placed = frames(&body, &body.neutral());
        let moment: f64 = body
            .joints()
            .iter()
            .zip(&placed)
            .map(|(j, f)| j.link.mass_kg * f.place(&j.link.center).z)
            .sum();
        let height = (moment / body.mass_kg() + 0.924) / STATURE;
        assert!(
            (0.54..0.585).contains(&height),
            "{}: centre at {height}",
            body.name()
        );
    }
}

#[test]
fn inertias_are_those_of_solid_things() {
    for body in bodies() {
        for joint in body.joints() {
            let (mass, inertia) = (joint.link.mass_kg, joint.link.inertia);
            let what = format!("{} of {}", joint.name, body.name());
            assert!(mass > 0.0, "{what} weighs {mass}");
            assert!(
                (inertia - inertia.transpose()).amax() < 1e-15,
                "{what}: symmetric"
            );
            let mut axes: Vec<f64> = inertia.symmetric_eigenvalues().iter().copied().collect();
            axes.sort_by(f64::total_cmp);
            assert!(axes[0] > 0.0, "{what}: {axes:?}");
            assert!(
                axes[0] + axes[1] >= axes[2] * (1.0 - 1e-12),
                "{what}: {axes:?}"
            );
            // Radii of gyration in the range of a part of a body.
            for i in axes {
                let radius = (i / mass).sqrt();
                assert!((0.005..0.25).contains(&radius), "{what}: radius {radius}");
            }
        }
    }
}

#[test]
fn left_mirrors_right() {
    let mirror = |v: &Vector3<f64>| Vector3::new(v.x, -v.y, v.z);
    for body in bodies() {
        let mut pairs = 0;
        for left in body.joints() {
            let Some(rest) = left.name.strip_prefix("left_") else {
                let lies_in_middle = left.offset.y == 0.0 && left.link.center.y == 0.0;
                assert!(
                    lies_in_middle || left.name.starts_with("right_"),
                    "{}",
                    left.name
                );
                continue;
            };
            pairs += 1;
            let right = &body.joints()[body.joint(&format!("right_{rest}")).expect("a mirror")];
            let close = |a: &Vector3<f64>, b: &Vector3<f64>| (mirror(a) - b).norm() < 1e-12;
            assert!(close(&left.offset, &right.offset), "{rest}: offset");
            assert!(close(&left.tip, &right.tip), "{rest}: tip");
            assert!(
                close(&left.link.center, &right.link.center),
                "{rest}: centre"
            );
            assert_eq!(left.link.mass_kg, right.link.mass_kg, "{rest}: mass");
            let mut inertia = left.link.inertia;
            for k in [0, 2] {
                inertia[(1, k)] *= -1.0;
                inertia[(k, 1)] *= -1.0;
            }
            assert!(
                (inertia - right.link.inertia).amax() < 1e-15,
                "{rest}: inertia"
            );
            if let (
                JointKind::Ball {
                    reference: a,
                    ranges: ra,
                },
                JointKind::Ball {
                    reference: b,
                    ranges: rb,
                },
            ) = (&left.kind, &right.kind)
            {
                assert_eq!(ra, rb, "{rest}: ranges");
                let mirrored = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
                    a.w, -a.i, a.j, -a.k,
                ));
                assert!(mirrored.angle_to(b) < 1e-12, "{rest}: reference");
            }
        }
        assert!(pairs >= 7, "{}", body.name());
    }
}

#[test]
fn heights_are_the_tables() {
    // Drillis and Contini 1966: shares of stature; de Leva's lengths differ from them by millimetres.
    for body in bodies() {
        let placed = frames(&body, &body.neutral());
        let at = |role: Role| *body.joints_of(role).first().expect("a joint");
        let floor = placed[at(Role::LeftFoot)].position.z - 0.039 * STATURE;
        let head = *body.joints_of(Role::Head).last().expect("a head");
        let vertex = placed[head].place(&body.joints()[head].tip).z;
        let [shoulder, hip, knee] = [Role::LeftUpperArm, Role::LeftUpperLeg, Role::LeftLowerLeg]
            .map(|r| placed[at(r)].position);
        for (what, found, share) in [
            ("vertex", vertex - floor, 1.0),
            ("shoulder", shoulder.z - floor, 0.818),
            ("hip", hip.z - floor, 0.530),
            ("knee", knee.z - floor, 0.285),
            ("half shoulders", shoulder.y, 0.129),
            ("half hips", hip.y, 0.0955),
        ] {
            let off = found - share * STATURE;
            assert!(
                off.abs() < 0.008,
                "{}: {what} off by {off:.4} m",
                body.name()
            );
        }
        let head_center = body.effector_positions(&body.neutral(), &Root::ORIGIN)[4].z;
        let below = vertex - head_center;
        assert!(
            (below - 0.5976 * 0.2033).abs() < 1e-9,
            "{}: head's centre {below} below vertex",
            body.name()
        );
    }
}

#[test]
fn the_neutral_pose_has_every_frame_as_the_worlds() {
    for body in bodies() {
        for (joint, frame) in body.joints().iter().zip(frames(&body, &body.neutral())) {
            assert!(
                frame.rotation.angle() < 1e-12,
                "{} of {}",
                joint.name,
                body.name()
            );
        }
        let hand = body.effector_positions(&body.neutral(), &Root::ORIGIN)[0];
        let shoulder = body.joints_of(Role::LeftUpperArm)[0];
        let below = frames(&body, &body.neutral())[shoulder].position - hand;
        assert!(
            (below - Vector3::z() * 0.5506).norm() < 1e-12,
            "arms hang: {below:?}"
        );
    }
}

#[test]
fn coordinates_are_zero_in_the_middle_of_the_range_and_far_from_a_half_turn() {
    for body in bodies() {
        for (j, joint) in body.joints().iter().enumerate() {
            let JointKind::Ball { ranges, .. } = &joint.kind else {
                continue;
            };
            let mut pose = body.neutral();
            let middle = ranges.map(|r| r.middle());
            let rotation = joint.axes.rotation(middle[0], middle[1], middle[2]);
            body.set_rotation(&mut pose, j, &rotation, None);
            let at = body.coordinates(j);
            assert!(
                pose[at.clone()].iter().all(|c| c.abs() < 1e-9),
                "{}",
                joint.name
            );
            // Single movements to the ends of the range.
            for (k, range) in ranges.iter().enumerate() {
                for end in [range.low, range.high] {
                    let mut angles = [0.0; 3];
                    angles[k] = end;
                    let rotation = joint.axes.rotation(angles[0], angles[1], angles[2]);
                    body.set_rotation(&mut pose, j, &rotation, None);
                    let length = pose[at.clone()].iter().map(|c| c * c).sum::<f64>().sqrt();
                    assert!(
                        length < 2.8,
                        "{}: {k} at {end} is {length} rad off",
                        joint.name
                    );
                }
            }
        }
    }
}

#[test]
fn coordinates_follow_a_turn_past_pi_but_not_for_ever() {
    let [_, ares] = bodies();
    let ankle = ares.joint("left_ankle").expect("a joint");
    let at = ares.coordinates(ankle);
    let mut before = ares.neutral();
    for step in 0..=63 {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.1 * f64::from(step));
        let mut pose = before.clone();
        let taken = ares.set_rotation(&mut pose, ankle, &turn, Some(&before));
        assert!(
            taken.angle_to(&turn) < 1e-9,
            "the rotation itself is exact at {step}"
        );
        let c = Vector3::from_column_slice(&pose[at.clone()]);
        let b = Vector3::from_column_slice(&before[at.clone()]);
        assert!(c.norm() < 3.8, "step {step}: {c:?}");
        assert!(
            (c - b).norm() < 0.2 || b.norm() > 3.6,
            "step {step}: {b:?} to {c:?}"
        );
        before = pose;
    }
    let neutral = ares.neutral();
    for c in at {
        assert!(
            (before[c] - neutral[c]).abs() < 0.1,
            "after a whole turn it is where it was"
        );
    }
}

/// One clinical movement, and the displacement of a point of a joint's frame that it must cause, as signs or exactly.
struct Movement {
    role: Role,
    degrees: &'static [f64],
    /// Joint whose frame shows the movement, a direction of that frame, and where it must point.
    seen: (Role, [f64; 3], [f64; 3]),
}

fn movement(
    role: Role,
    degrees: &'static [f64],
    seen: Role,
    axis: [f64; 3],
    to: [f64; 3],
) -> Movement {
    Movement {
        role,
        degrees,
        seen: (seen, axis, to),
    }
}

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];
const FORWARD: [f64; 3] = [1.0, 0.0, 0.0];
const BACK: [f64; 3] = [-1.0, 0.0, 0.0];
const LEFT: [f64; 3] = [0.0, 1.0, 0.0];
const RIGHT: [f64; 3] = [0.0, -1.0, 0.0];

#[test]
fn clinical_angles_move_the_way_people_say() {
    use Role::*;
    let both: Vec<Movement> = vec![
        movement(LeftUpperArm, &[90.0], LeftUpperArm, DOWN, FORWARD),
        movement(RightUpperArm, &[90.0], RightUpperArm, DOWN, FORWARD),
        movement(RightUpperArm, &[180.0], RightUpperArm, DOWN, UP),
        movement(LeftUpperArm, &[0.0, 90.0], LeftUpperArm, DOWN, LEFT),
        movement(RightUpperArm, &[0.0, 90.0], RightUpperArm, DOWN, RIGHT),
        movement(
            LeftUpperArm,
            &[0.0, 0.0, 90.0],
            LeftUpperArm,
            FORWARD,
            RIGHT,
        ),
        movement(
            RightUpperArm,
            &[0.0, 0.0, 90.0],
            RightUpperArm,
            FORWARD,
            LEFT,
        ),
        movement(LeftLowerArm, &[90.0], LeftLowerArm, DOWN, FORWARD),
        movement(RightLowerArm, &[90.0], RightHand, DOWN, FORWARD),
        movement(LeftHand, &[90.0], LeftHand, DOWN, RIGHT),
        movement(RightHand, &[90.0], RightHand, DOWN, LEFT),
        movement(LeftHand, &[0.0, 90.0], LeftHand, DOWN, FORWARD),
        movement(RightHand, &[0.0, 90.0], RightHand, DOWN, FORWARD),
        movement(LeftHand, &[0.0, 0.0, 90.0], LeftHand, FORWARD, RIGHT),
        movement(Chest, &[90.0], Chest, UP, FORWARD),
        movement(Chest, &[0.0, 90.0], Chest, UP, LEFT),
        movement(Chest, &[0.0, 0.0, 90.0], Chest, FORWARD, LEFT),
        movement(Spine, &[0.0, 0.0, 90.0], Chest, FORWARD, LEFT),
        movement(Head, &[90.0], Head, UP, FORWARD),
        movement(Neck, &[0.0, 0.0, 90.0], Head, FORWARD, LEFT),
    ];
    let ares_only = vec![
        movement(LeftUpperLeg, &[90.0], LeftUpperLeg, DOWN, FORWARD),
        movement(RightUpperLeg, &[0.0, 90.0], RightUpperLeg, DOWN, RIGHT),
        movement(
            LeftUpperLeg,
            &[0.0, 0.0, 90.0],
            LeftUpperLeg,
            FORWARD,
            RIGHT,
        ),
        movement(LeftLowerLeg, &[90.0], LeftLowerLeg, DOWN, BACK),
        movement(RightLowerLeg, &[90.0], RightLowerLeg, DOWN, BACK),
        movement(LeftFoot, &[90.0], LeftFoot, FORWARD, UP),
        movement(RightToes, &[90.0], RightToes, FORWARD, UP),
        movement(LeftFingers, &[90.0], LeftFingers, DOWN, RIGHT),
        movement(LeftShoulder, &[0.0, 90.0], LeftShoulder, LEFT, UP),
        movement(RightShoulder, &[0.0, 90.0], RightShoulder, RIGHT, UP),
        movement(LeftShoulder, &[90.0], LeftShoulder, LEFT, FORWARD),
        movement(RightShoulder, &[90.0], RightShoulder, RIGHT, FORWARD),
        movement(Hips, &[90.0], Hips, UP, FORWARD),
    ];
    let [adonis, ares] = bodies();
    for (body, movements) in [(&adonis, &both), (&ares, &both), (&ares, &ares_only)] {
        for m in movements {
            let mut pose = body.neutral();
            body.set_clinical(&mut pose, m.role, m.degrees)
                .expect("a movement");
            let (seen, axis, to) = m.seen;
            let joint = *body.joints_of(seen).last().expect("a joint");
            let found = frames(body, &pose)[joint].rotation * Vector3::from(axis);
            let what = format!("{} of {} at {:?}", m.role.name(), body.name(), m.degrees);
            assert!(
                (found - Vector3::from(to)).norm() < 1e-9,
                "{what}: {found:?} not {to:?}"
            );
        }
    }
}

#[test]
fn clinical_angles_compose_flexion_then_abduction_then_axial_and_share_out_along_the_spine() {
    for body in bodies() {
        for (role, degrees) in [
            (Role::RightUpperArm, vec![40.0, 30.0, -20.0]),
            (Role::Chest, vec![20.0, -10.0, 15.0]),
            (Role::Head, vec![10.0, 5.0]),
        ] {
            let mut pose = vec![0.7; body.dof()];
            let before = pose.clone();
            body.set_clinical(&mut pose, role, &degrees)
                .expect("a pose");
            let joints = body.joints_of(role);
            let angle = |i: usize| degrees.get(i).map_or(0.0, |d: &f64| d.to_radians());
            let wanted = body.joints()[joints[0]]
                .axes
                .rotation(angle(0), angle(1), angle(2));
            let whole = joints.iter().fold(UnitQuaternion::identity(), |q, &j| {
                q * body.rotation(j, &pose[body.coordinates(j)])
            });
            assert!(
                whole.angle_to(&wanted) < 1e-9,
                "{} of {}",
                role.name(),
                body.name()
            );
            for j in (0..body.joints().len()).filter(|j| !joints.contains(j)) {
                let at = body.coordinates(j);
                assert_eq!(pose[at.clone()], before[at], "only {} moves", role.name());
            }
        }
    }
}

#[test]
fn clinical_angles_that_make_no_sense_are_refused() {
    let [adonis, ares] = bodies();
    let refused = |body: &Skeleton, role: Role, degrees: &[f64]| {
        let mut pose = body.neutral();
        body.set_clinical(&mut pose, role, degrees)
            .expect_err("refused")
    };
    for (body, role) in [
        (&adonis, Role::LeftUpperLeg),
        (&adonis, Role::LeftFingers),
        (&adonis, Role::Hips),
        (&ares, Role::UpperChest),
    ] {
        let error = refused(body, role, &[10.0]);
        assert!(error.is_unknown_name(), "{error}");
        let text = error.to_string();
        assert!(
            text.contains(body.name()) && text.contains("right_lower_arm"),
            "{text}"
        );
    }
    for (role, degrees) in [
        (Role::LeftLowerArm, &[10.0, 5.0][..]),
        (Role::LeftUpperArm, &[1.0, 2.0, 3.0, 4.0][..]),
        (Role::LeftUpperArm, &[][..]),
        (Role::LeftUpperArm, &[f64::NAN][..]),
    ] {
        assert!(refused(&adonis, role, degrees).is_invalid(), "{degrees:?}");
    }
    assert!(
        ares.set_clinical(&mut [0.0; 20], Role::Head, &[1.0])
            .is_err_and(|e| e.is_invalid())
    );
}

#[test]
fn forward_kinematics_by_hand() {
    let [adonis, ares] = bodies();
    for body in [&adonis, &ares] {
        // Upper arm forward, elbow bent by a right angle: the forearm points up.
        let mut pose = body.neutral();
        body.set_clinical(&mut pose, Role::LeftUpperArm, &[90.0])
            .expect("a pose");
        body.set_clinical(&mut pose, Role::LeftLowerArm, &[90.0])
            .expect("a pose");
        let root = Root {
            position: Vector3::new(1.0, 2.0, 3.0),
            yaw: std::f64::consts::FRAC_PI_2,
        };
        let wrist = body.effector_positions(&pose, &root)[0];
        // Facing y, the left is -x.
        let shoulder = Vector3::new(1.0 - 0.129 * STATURE, 2.0, 3.0 + 0.288 * STATURE);
        let wanted = shoulder + Vector3::new(0.0, 0.2817, 0.2689);
        assert!(
            (wrist - wanted).norm() < 1e-9,
            "{}: {wrist:?} not {wanted:?}",
            body.name()
        );
        let frames = body.frames(&pose, &root);
        let thorax = body.thorax(&frames).expect("shoulders");
        let local = thorax.local(&wrist);
        let wanted = Vector3::new(0.2817, 0.129 * STATURE, 0.2689);
        assert!((local - wanted).norm() < 1e-9, "{}: {local:?}", body.name());
    }
    // A bow of the whole spine by a right angle leaves the neck forward of the pelvis and lower than upright.
    let mut pose = ares.neutral();
    ares.set_clinical(&mut pose, Role::Spine, &[45.0])
        .expect("a pose");
    ares.set_clinical(&mut pose, Role::Chest, &[45.0])
        .expect("a pose");
    let neck = frames(&ares, &pose)[ares.joint("cervical_7").expect("a joint")];
    assert!((neck.rotation.angle() - 0.0).abs() > 1.5);
    assert!(
        neck.position.x > 0.2 && neck.position.z < 0.5 && neck.position.z > 0.2,
        "{neck:?}"
    );
}
