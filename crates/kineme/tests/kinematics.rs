//! Landmarks and mirror images; effectors in the thorax frame with their Jacobians; joint limits.

use std::sync::Arc;

use kineme::math::rotation::{exp, log, right_jacobian};
use kineme::motion::{landmark_dims, mirror_landmarks};
use kineme::skeleton::{Effector, JointKind, Range};
use kineme::{Motion, Role, Root, Skeleton, adonis, ares};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn bodies() -> [Arc<Skeleton>; 2] {
    [adonis(), ares()].map(|b| Arc::new(b.expect("a body")))
}

/// A pose with every coordinate within `reach` radians of the middle of its range.
fn random_pose(body: &Skeleton, random: &mut Pcg64, reach: f64) -> Vec<f64> {
    let mut pose: Vec<f64> = (0..body.dof())
        .map(|_| random.random_range(-reach..reach))
        .collect();
    for (j, joint) in body.joints().iter().enumerate() {
        if let JointKind::Hinge { range, .. } = &joint.kind {
            pose[body.coordinates(j).start] += range.middle();
        }
    }
    pose
}

/// Poses and roots without any connection from frame to frame.
fn random_motion(body: &Arc<Skeleton>, seed: u64, frames: usize) -> Motion {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut poses = Vec::new();
    let mut roots = Vec::new();
    for _ in 0..frames {
        poses.extend(random_pose(body, &mut random, 0.6));
        roots.push(Root {
            position: Vector3::from_fn(|_, _| random.random_range(-2.0..2.0)),
            yaw: random.random_range(-6.0..6.0),
        });
    }
    Motion::new("random", Arc::clone(body), 60.0, poses, roots).expect("a motion")
}

#[test]
fn landmarks_are_places_against_the_root_that_standing_and_heading_leave_alone() {
    for (body, roles) in bodies().iter().zip([16, 20]) {
        assert_eq!(landmark_dims(body), 3 * roles, "{}", body.name());
        let motion = random_motion(body, 1, 5);
        let landmarks = motion.landmarks();
        assert_eq!(landmarks.len(), 5 * landmark_dims(body));
        let mut random = Pcg64::seed_from_u64(2);
        let elsewhere = Root {
            position: Vector3::from_fn(|_, _| random.random_range(-2.0..2.0)),
            yaw: 2.0,
        };
        let moved = Motion::new(
            "moved",
            Arc::clone(body),
            60.0,
            motion.poses().to_vec(),
            vec![elsewhere; 5],
        )
        .expect("a motion");
        for (a, b) in landmarks.iter().zip(moved.landmarks()) {
            assert!((a - b).abs() < 1e-12, "{}", body.name());
        }
        // The third landmark is the left upper arm.
        let shoulder = body.joints_of(Role::LeftUpperArm)[0];
        let at_origin = body.frames(motion.pose(4), &Root::ORIGIN)[shoulder].position;
        let found = &landmarks[4 * landmark_dims(body) + 6..][..3];
        assert!(
            (at_origin - Vector3::from_column_slice(found)).norm() < 1e-12,
            "{}",
            body.name()
        );
    }
}

#[test]
fn the_mirror_image_swaps_left_and_right_and_its_own_image_is_the_original() {
    let mirror = |p: Vector3<f64>| Vector3::new(p.x, -p.y, p.z);
    for body in bodies() {
        let motion = random_motion(&body, 3, 20);
        let mirrored = motion.mirrored().expect("a symmetric body");
        assert_eq!(mirrored.mirrored().expect("a motion"), motion);
        let (tracks, images) = (motion.effectors(), mirrored.effectors());
        for f in 0..motion.frames() {
            for (here, there) in [(0, 1), (1, 0), (2, 3), (3, 2), (4, 4)] {
                let off = mirror(tracks.at(f)[here]) - images.at(f)[there];
                assert!(off.norm() < 1e-12, "{}: {here} at {f}", body.name());
            }
        }
        let landmarks = motion.landmarks();
        let image = mirror_landmarks(&body, &landmarks);
        assert_eq!(mirror_landmarks(&body, &image), landmarks);
        for (a, b) in image.iter().zip(mirrored.landmarks()) {
            assert!((a - b).abs() < 1e-12, "{}", body.name());
        }
    }
}

#[test]
fn a_body_with_unlike_halves_has_no_mirror_image() {
    for body in bodies() {
        let mut joints = body.joints().to_vec();
        let elbow = body.joint("left_elbow").expect("a joint");
        joints[elbow].offset.z -= 0.01;
        let effectors: Vec<Effector> = body.effectors().to_vec();
        let lopsided = Arc::new(Skeleton::new("lopsided", joints, effectors).expect("a body"));
        let motion = random_motion(&lopsided, 4, 1);
        let error = motion.mirrored().expect_err("unlike halves");
        assert!(error.is_unsupported(), "{error}");
        assert!(error.to_string().contains("elbow"), "{error}");
    }
}

#[test]
fn the_right_jacobian_is_the_derivative_of_exp() {
    let mut random = Pcg64::seed_from_u64(5);
    for length in [0.0, 1e-9, 1e-4, 0.0999, 0.1001, 1.0, 3.0, 3.6] {
        let v = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
        let v: Vector3<f64> = v.normalize() * length;
        let found = right_jacobian(&v);
        for k in 0..3 {
            let d = Vector3::ith(k, 1e-5);
            let wanted = log(&(exp(&(v - d)).inverse() * exp(&(v + d)))) / 2e-5;
            let off = (found.column(k) - wanted).norm();
            assert!(off < 1e-9, "length {length}, column {k}: {off:e}");
        }
    }
    // Where the series takes over from the closed form they agree to rounding.
    let at = |a: f64| right_jacobian(&(Vector3::new(0.6, -0.48, 0.64) * a));
    let jump = (at(0.1 + 1e-12) - at(0.1 - 1e-12)).amax();
    assert!(jump < 2e-12, "{jump:e}");
}

#[test]
fn a_reach_is_the_effector_in_the_thorax_frame() {
    let mut random = Pcg64::seed_from_u64(6);
    for body in bodies() {
        for (e, effector) in body.effectors().iter().enumerate() {
            assert_eq!(body.effector(&effector.name).expect("its name"), e);
            let reach = body.reach(e).expect("shoulders");
            for _ in 0..50 {
                let pose = random_pose(&body, &mut random, 1.0);
                let root = Root {
                    position: Vector3::new(1.0, -2.0, 0.5),
                    yaw: random.random_range(-3.0..3.0),
                };
                let frames = body.frames(&pose, &root);
                let world = frames[effector.joint].place(&effector.point);
                let wanted = body.thorax(&frames).expect("shoulders").local(&world);
                let off = (reach.position(&pose) - wanted).norm();
                assert!(off < 1e-12, "{} of {}: {off:e}", effector.name, body.name());
            }
        }
    }
}

#[test]
fn the_jacobian_of_a_reach_is_its_central_difference() {
    const STEP: f64 = 1e-5;
    let mut random = Pcg64::seed_from_u64(7);
    // Coordinates that matter to hands, feet and head: limbs, the trunk for the feet, and Ares' clavicles for all.
    for (body, matter) in bodies().iter().zip([[4, 4, 3, 3, 3], [12, 12, 63, 63, 30]]) {
        let dof = body.dof();
        let mut jacobian = vec![f64::NAN; 3 * dof];
        for (e, effector) in body.effectors().iter().enumerate() {
            let mut most = 0;
            let reach = body.reach(e).expect("shoulders");
            let poses = [body.neutral(), vec![0.0; dof]]
                .into_iter()
                .chain((0..8).map(|_| random_pose(body, &mut random, 1.4)));
            for mut pose in poses {
                let place = reach.jacobian(&pose, &mut jacobian);
                assert!((place - reach.position(&pose)).norm() < 1e-15);
                let mut moving = 0;
                for c in 0..dof {
                    let here = pose[c];
                    pose[c] = here + STEP;
                    let after = reach.position(&pose);
                    pose[c] = here - STEP;
                    let wanted = (after - reach.position(&pose)) / (2.0 * STEP);
                    pose[c] = here;
                    let found = Vector3::from_fn(|row, _| jacobian[row * dof + c]);
                    let off = (found - wanted).norm();
                    let what = format!("{} of {}", effector.name, body.name());
                    assert!(off < 1e-6 * wanted.norm().max(0.1), "{what}: {c}: {off:e}");
                    moving += usize::from(found.norm() > 0.0);
                }
                most = most.max(moving);
            }
            assert_eq!(most, matter[e], "{} of {}", effector.name, body.name());
        }
    }
}

#[test]
fn a_reach_needs_an_effector_and_shoulders() {
    let [adonis, _] = bodies();
    assert!(adonis.effector("tail").is_err_and(|e| e.is_unknown_name()));
    assert!(adonis.reach(5).is_err_and(|e| e.is_invalid()));
    let mut joints = adonis.joints().to_vec();
    for joint in &mut joints {
        joint.role = joint.role.filter(|r| *r != Role::LeftUpperArm);
    }
    let armless = Skeleton::new("armless", joints, adonis.effectors().to_vec()).expect("a body");
    assert!(armless.reach(0).is_err_and(|e| e.is_unsupported()));
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Every coordinate of a pose against its limits, as `Skeleton::limits` measures it.
fn measured(body: &Skeleton, pose: &[f64]) -> Vec<(f64, Range)> {
    let mut measured = Vec::new();
    for (j, joint) in body.joints().iter().enumerate() {
        let at = body.coordinates(j);
        match body.limits(j) {
            [range] => measured.push((pose[at.start], *range)),
            ranges @ [_, _, _] => {
                let v = Vector3::from_column_slice(&pose[at]);
                let axes = [joint.axes.flexion, joint.axes.abduction, joint.axes.axial];
                measured.extend(axes.iter().zip(ranges).map(|(a, r)| (v.dot(a), *r)));
            }
            _ => {}
        }
    }
    measured
}

/// How far inside its limits a coordinate is held back, as documented.
fn transition(range: &Range) -> f64 {
    (3.0 * DEGREE).min((range.high - range.low) / 8.0)
}

fn limited(body: &Skeleton, pose: &[f64]) -> Vec<f64> {
    let mut pose = pose.to_vec();
    body.limited(&mut pose);
    pose
}

#[test]
fn what_is_well_inside_its_limits_stays_bit_for_bit() {
    let mut random = Pcg64::seed_from_u64(8);
    for body in bodies() {
        let neutral = body.neutral();
        assert_eq!(limited(&body, &neutral), neutral, "{}", body.name());
        for _ in 0..50 {
            let pose = limited(&body, &random_pose(&body, &mut random, 3.0));
            let middle = body.neutral();
            // Half-way from any permitted posture to standing.
            let pose: Vec<f64> = pose
                .iter()
                .zip(&middle)
                .map(|(a, b)| 0.5 * (a + b))
                .collect();
            let inside = measured(&body, &pose)
                .iter()
                .all(|(x, r)| (r.low + transition(r)..=r.high - transition(r)).contains(x));
            assert!(inside, "{}", body.name());
            let mut same = pose.clone();
            assert_eq!(body.limited(&mut same), 0, "{}", body.name());
            assert_eq!(same, pose, "{}", body.name());
        }
    }
}

#[test]
fn clinical_postures_within_the_ranges_are_hardly_moved() {
    let mut random = Pcg64::seed_from_u64(9);
    for body in bodies() {
        for (j, joint) in body.joints().iter().enumerate() {
            let JointKind::Ball { ranges, .. } = &joint.kind else {
                continue;
            };
            for _ in 0..200 {
                let [f, a, x] = ranges.map(|r| random.random_range(r.low..r.high));
                let mut pose = body.neutral();
                body.set_rotation(&mut pose, j, &joint.axes.rotation(f, a, x), None);
                let after = limited(&body, &pose);
                for c in body.coordinates(j) {
                    let moved = (after[c] - pose[c]).abs() / DEGREE;
                    assert!(moved < 1.5, "{} of {}: {moved}", joint.name, body.name());
                }
            }
        }
    }
}

#[test]
fn limited_poses_are_within_the_limits_and_limiting_them_again_does_little() {
    let mut random = Pcg64::seed_from_u64(10);
    for body in bodies() {
        for reach in [0.5, 2.0, 6.0, 1e3] {
            let pose = random_pose(&body, &mut random, reach);
            let mut once = pose.clone();
            let count = body.limited(&mut once);
            let (before, after) = (measured(&body, &pose), measured(&body, &once));
            let again = measured(&body, &limited(&body, &once));
            let held =
                |(x, r): &(f64, Range)| *x > r.high - transition(r) || *x < r.low + transition(r);
            assert_eq!(count, before.iter().filter(|m| held(m)).count());
            for ((x, range), (y, _)) in after.iter().zip(&again) {
                assert!(*x >= range.low - 1e-9 && *x <= range.high + 1e-9, "{x}");
                assert!((x - y).abs() < 0.25 * transition(range), "{x} to {y}");
            }
        }
    }
}

#[test]
fn the_root_has_no_limit() {
    let [_, ares] = bodies();
    let mut pose = ares.neutral();
    pose[0] = 2.0;
    pose[1] = -3.0;
    assert_eq!(ares.limited(&mut pose), 0);
    assert_eq!(pose[..2], [2.0, -3.0]);
}

#[test]
fn limits_are_continuous_and_so_are_their_first_derivatives() {
    const STEP: f64 = 1e-5;
    let mut random = Pcg64::seed_from_u64(11);
    for body in bodies() {
        for _ in 0..20 {
            let from = random_pose(&body, &mut random, 0.3);
            let way = random_pose(&body, &mut random, 1.0);
            let norm = way.iter().map(|v| v * v).sum::<f64>().sqrt();
            // Through the limits of most coordinates, a tenth of a degree at a time.
            for i in 0..400 {
                let at = |s: f64| {
                    let pose: Vec<f64> = from.iter().zip(&way).map(|(a, b)| a + b * s).collect();
                    limited(&body, &pose)
                };
                let s = f64::from(i) * 0.1 * DEGREE * norm / 4.0;
                let slope = |s: f64| -> Vec<f64> {
                    let (a, b) = (at(s - STEP), at(s + STEP));
                    a.iter()
                        .zip(&b)
                        .map(|(a, b)| (b - a) / (2.0 * STEP))
                        .collect()
                };
                for (a, b) in slope(s).iter().zip(slope(s + 2.0 * STEP)) {
                    // Tanh bends by at most 0.77 over the transition, here at least half a degree.
                    assert!(a.abs() <= 3.0 && (a - b).abs() < 0.02, "{i}: {a} then {b}");
                }
            }
        }
    }
}

#[test]
fn limits_are_the_same_in_the_mirror() {
    for body in bodies() {
        let motion = random_motion(&body, 12, 10);
        let wild: Vec<f64> = motion.poses().iter().map(|v| v * 6.0).collect();
        let wild = Motion::new(
            "wild",
            Arc::clone(&body),
            60.0,
            wild,
            motion.roots().to_vec(),
        )
        .expect("a motion");
        let mirrored = wild.mirrored().expect("symmetric");
        for f in 0..wild.frames() {
            let mut here = limited(&body, wild.pose(f));
            here = Motion::new("one", Arc::clone(&body), 60.0, here, vec![Root::ORIGIN])
                .and_then(|m| m.mirrored())
                .expect("symmetric")
                .pose(0)
                .to_vec();
            for (a, b) in here.iter().zip(limited(&body, mirrored.pose(f))) {
                assert!((a - b).abs() < 1e-9, "{}", body.name());
            }
        }
    }
}
