//! The animations that are no primitive: a person could do each, the arms are busy in each, and no two are alike.

use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};

use kineme::Role;
use kineme::alignment::{Band, Sequences, distances_to_query, pair_distances};
use kineme::choreography::{Script, perform};
use kineme::motion::Motion;
use kineme::skeleton::{Frame, JointKind, Range};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

const ANIMATIONS: &str = include_str!("../../../choreography/animations.toml");
const SESSION: &str = include_str!("../../../choreography/session.toml");
const MOVEMENTS: &str = include_str!("../../../choreography/session-movements.csv");

/// Frames a second: a hand at 10 m/s moves 17 cm between two of them.
const RATE_HZ: f64 = 60.0;
/// Frames that motions are compared at, whatever they last.
const FRAMES: usize = 48;
/// Share of a motion that one may run ahead of another when they are compared.
const BAND: f64 = 0.25;
/// What tells two movements apart: the parts of the body that a stick figure shows.
const LANDMARKS: [Role; 12] = [
    Role::Chest,
    Role::Head,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::LeftFingers,
    Role::RightLowerArm,
    Role::RightHand,
    Role::RightFingers,
    Role::LeftLowerLeg,
    Role::LeftFoot,
    Role::RightLowerLeg,
    Role::RightFoot,
];

static SCRIPT: LazyLock<Script> = LazyLock::new(|| read("animations.toml", ANIMATIONS));
static MOTIONS: LazyLock<Vec<Motion>> = LazyLock::new(|| performed(&SCRIPT));

fn read(name: &str, text: &str) -> Script {
    let script = kineme_formats::script::parse(name, text.as_bytes()).expect("a script");
    script.validate().expect("a valid script");
    script
}

fn performed(script: &Script) -> Vec<Motion> {
    let body = Arc::new(kineme::body(&script.body).expect("a body"));
    let perform =
        |a: &kineme::choreography::ScriptAnimation| perform(&a.name, &a.keys, &body, RATE_HZ);
    script
        .animations
        .iter()
        .map(|a| perform(a).expect("a motion"))
        .collect()
}

/// Every motion, or the names and reasons of those that break a rule.
fn check(rule: impl Fn(&Motion) -> Vec<String>) {
    let broken: Vec<String> = MOTIONS
        .iter()
        .flat_map(|m| {
            rule(m)
                .into_iter()
                .map(|why| format!("{}: {why}", m.name()))
        })
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn more_than_fifty_animations_bear_names_of_their_own() {
    assert!(SCRIPT.exemplars.is_empty());
    assert!(MOTIONS.len() >= 56, "{}", MOTIONS.len());
    let primitives = [
        "jab", "hook", "uppercut", "elbow", "shield", "punch", "wav", "twist",
    ];
    let mut names: BTreeSet<String> = read("session.toml", SESSION)
        .animations
        .iter()
        .map(|a| a.name.clone())
        .collect();
    for animation in &SCRIPT.animations {
        let name = &animation.name;
        assert!(names.insert(name.clone()), "{name} twice");
        assert!(!primitives.iter().any(|p| name.contains(p)), "{name}");
    }
}

#[test]
fn each_lasts_one_to_six_seconds_and_has_four_to_twenty_keys() {
    check(|m| {
        let secs = m.duration_secs();
        let out = !(0.98..=6.02).contains(&secs);
        out.then(|| format!("{secs:.2} s")).into_iter().collect()
    });
    for animation in &SCRIPT.animations {
        let keys = animation.keys.len();
        assert!((4..=20).contains(&keys), "{}: {keys} keys", animation.name);
    }
}

#[test]
fn keys_are_whole_degrees_and_hundredths_of_a_second() {
    for animation in &SCRIPT.animations {
        for key in &animation.keys {
            let hundredths = key.time * 100.0;
            let whole = (hundredths - hundredths.round()).abs() < 1e-9
                && key.angles.values().flatten().all(|a| a.fract() == 0.0);
            assert!(whole, "{} at {} s", animation.name, key.time);
        }
    }
}

#[test]
fn hands_move_much() {
    let least = 0.4;
    check(|m| {
        let speed = mean_hand_speed(m);
        let idle = speed < least;
        idle.then(|| format!("hands at {speed:.2} m/s"))
            .into_iter()
            .collect()
    });
}

/// The mean over time of both wrists' speed, m/s.
fn mean_hand_speed(motion: &Motion) -> f64 {
    let hands = [Role::LeftHand, Role::RightHand].map(|r| motion.skeleton().joints_of(r)[0]);
    let places: Vec<[Vector3<f64>; 2]> = (0..motion.frames())
        .map(|f| {
            let frames = motion.frames_at(f);
            hands.map(|j| frames[j].position)
        })
        .collect();
    let path: f64 = places
        .windows(2)
        .map(|w| (w[1][0] - w[0][0]).norm() + (w[1][1] - w[0][1]).norm())
        .sum();
    0.5 * path / motion.duration_secs()
}

/// How far (radians) a rotation in the parent's frame lies out of a ball's ranges, in its nearer clinical reading.
fn excess(
    rotation: &UnitQuaternion<f64>,
    joint: &kineme::skeleton::Joint,
    ranges: &[Range; 3],
) -> f64 {
    let axes = Matrix3::from_columns(&[joint.axes.flexion, joint.axes.abduction, joint.axes.axial]);
    // In the basis of the signed axes the rotation is X(a) Y(b) Z(c), turned backward where the basis is left-handed.
    let hand = axes.determinant().signum();
    let m = axes.transpose() * rotation.to_rotation_matrix().matrix() * axes;
    let b = m[(0, 2)].clamp(-1.0, 1.0).asin();
    let over = |angle: f64, range: &Range| {
        let turns = [-std::f64::consts::TAU, 0.0, std::f64::consts::TAU];
        turns
            .map(|t| (range.low - angle - t).max(angle + t - range.high).max(0.0))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    };
    if b.cos() < 1e-6 {
        // At a right angle only the sum or difference of the other two is defined; any split of it will do.
        let [flexion, _, axial] = ranges;
        let sum = m[(1, 0)].atan2(m[(1, 1)]) * hand;
        let (low, high) = if b > 0.0 {
            (axial.low + flexion.low, axial.high + flexion.high)
        } else {
            (axial.low - flexion.high, axial.high - flexion.low)
        };
        return over(sum, &Range { low, high }).max(over(b * hand, &ranges[1]));
    }
    [b, std::f64::consts::PI - b]
        .map(|b| {
            let s = b.cos();
            let a = (-m[(1, 2)] / s).atan2(m[(2, 2)] / s);
            let c = (-m[(0, 1)] / s).atan2(m[(0, 0)] / s);
            let angles = [a, b, c].map(|v| v * hand);
            angles
                .iter()
                .zip(ranges)
                .map(|(v, r)| over(*v, r))
                .fold(0.0, f64::max)
        })
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn the_clinical_reading_of_a_rotation_is_the_one_it_was_made_of() {
    let body = kineme::ares().expect("a body");
    for joint in body.joints() {
        let at = |d: [f64; 3]| {
            joint
                .axes
                .rotation(d[0].to_radians(), d[1].to_radians(), d[2].to_radians())
        };
        let narrow = |d: [f64; 3]| d.map(|v| Range::degrees(v - 0.1, v + 0.1));
        for degrees in [
            [20.0, 30.0, -40.0],
            [150.0, 10.0, 20.0],
            [30.0, 90.0, 20.0],
            [-10.0, 140.0, 35.0],
        ] {
            assert!(
                excess(&at(degrees), joint, &narrow(degrees)) < 1e-9,
                "{}",
                joint.name
            );
            let beside = [degrees[0], degrees[1] + 5.0, degrees[2]];
            assert!(
                excess(&at(beside), joint, &narrow(degrees)) > 0.05,
                "{}",
                joint.name
            );
        }
    }
}

#[test]
fn joints_stay_in_their_ranges_and_far_from_the_singularity() {
    let tolerance = 2f64.to_radians();
    check(|m| {
        let body = m.skeleton();
        let mut worst: Vec<(f64, f64)> = vec![(0.0, 0.0); body.joints().len()];
        for f in 0..m.frames() {
            for (j, joint) in body.joints().iter().enumerate() {
                let JointKind::Ball { ranges, .. } = &joint.kind else {
                    continue;
                };
                let coordinates = &m.pose(f)[body.coordinates(j)];
                let out = excess(&body.rotation(j, coordinates), joint, ranges);
                let length = Vector3::from_column_slice(coordinates).norm();
                worst[j] = (worst[j].0.max(out), worst[j].1.max(length));
            }
        }
        let names = body.joints().iter().map(|j| &j.name);
        names
            .zip(worst)
            .filter(|(_, (out, length))| *out > tolerance || *length > 3.0)
            .map(|(name, (out, length))| {
                format!(
                    "{name} {:.1} degrees out, {length:.2} rad",
                    out.to_degrees()
                )
            })
            .collect()
    });
}

#[test]
fn joints_turn_no_faster_than_people_turn_them() {
    let fastest = 25.0;
    check(|m| {
        let body = m.skeleton();
        let mut broken = Vec::new();
        for (j, joint) in body.joints().iter().enumerate() {
            let turns: Vec<_> = (0..m.frames())
                .map(|f| body.rotation(j, &m.pose(f)[body.coordinates(j)]))
                .collect();
            let peak = turns
                .windows(2)
                .map(|w| w[0].angle_to(&w[1]) * RATE_HZ)
                .fold(0.0, f64::max);
            if peak > fastest {
                broken.push(format!("{} {peak:.1} rad/s", joint.name));
            }
        }
        broken
    });
}

#[test]
fn hands_and_elbows_stay_out_of_trunk_and_head() {
    check(|m| {
        let body = m.skeleton();
        let only = |role| body.joints_of(role)[0];
        let chest = *body.joints_of(Role::Chest).last().expect("a chest");
        let head = only(Role::Head);
        let points = [
            Role::LeftLowerArm,
            Role::LeftHand,
            Role::LeftFingers,
            Role::RightLowerArm,
            Role::RightHand,
            Role::RightFingers,
        ];
        let mut broken = BTreeSet::new();
        for f in 0..m.frames() {
            let frames = m.frames_at(f);
            let skull = frames[head].place(&body.joints()[head].link.center);
            for role in points {
                let point = frames[only(role)].position;
                if in_trunk(&frames[chest], &point) {
                    broken.insert(format!("{} in the trunk", role.name()));
                }
                if (point - skull).norm() < 0.08 {
                    broken.insert(format!("{} in the head", role.name()));
                }
            }
        }
        broken.into_iter().collect()
    });
}

/// Whether a point lies in the rib cage: an elliptic cylinder 28 cm wide and 18 cm deep under the shoulders.
fn in_trunk(chest: &Frame, point: &Vector3<f64>) -> bool {
    let p = chest.local(point);
    (-0.36..0.0).contains(&p.z) && (p.x / 0.09).powi(2) + (p.y / 0.14).powi(2) < 1.0
}

/// Landmarks about the root (metres) at [`FRAMES`] frames of a motion, frame-major.
fn landmarks(motion: &Motion) -> Vec<f64> {
    let body = motion.skeleton();
    let joints = LANDMARKS.map(|r| *body.joints_of(r).last().expect("a landmark"));
    let rows: Vec<Vec<f64>> = (0..motion.frames())
        .map(|f| {
            let frames = motion.frames_at(f);
            joints
                .iter()
                .flat_map(|&j| <[f64; 3]>::from(frames[j].position))
                .collect()
        })
        .collect();
    let last = (rows.len() - 1) as f64;
    (0..FRAMES)
        .flat_map(|i| {
            let place = last * i as f64 / (FRAMES - 1) as f64;
            let (a, share) = (place.floor() as usize, place.fract());
            let b = (a + 1).min(rows.len() - 1);
            let blend = rows[a]
                .iter()
                .zip(&rows[b])
                .map(|(x, y)| x + (y - x) * share);
            blend.collect::<Vec<f64>>()
        })
        .collect()
}

/// A warping distance as the root mean square distance of a landmark, metres, had the path one step a frame.
fn a_landmark(distance: f64) -> f64 {
    distance / ((FRAMES * LANDMARKS.len()) as f64).sqrt()
}

fn sequences(motions: &[Motion]) -> Sequences {
    let values: Vec<f64> = motions.iter().flat_map(landmarks).collect();
    Sequences::new(&values, FRAMES, 3 * LANDMARKS.len()).expect("sequences")
}

#[test]
fn no_two_animations_are_alike() {
    let least = 0.12;
    let distances = pair_distances(&sequences(&MOTIONS), Band::radius(BAND, FRAMES));
    let n = MOTIONS.len();
    let mut pairs: Vec<(f64, &str, &str)> = (0..n)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .map(|(i, j)| {
            (
                a_landmark(distances[i * n + j]),
                MOTIONS[i].name(),
                MOTIONS[j].name(),
            )
        })
        .collect();
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    for (d, a, b) in &pairs[..12] {
        println!("{:.1} cm: {a}, {b}", 100.0 * d);
    }
    assert!(pairs[0].0 > least, "{:?}", pairs[0]);
}

#[test]
fn none_is_another_seen_in_a_mirror() {
    let least = 0.12;
    let compared = sequences(&MOTIONS);
    let mut nearest: Vec<(f64, &str, &str)> = Vec::new();
    for (i, motion) in MOTIONS.iter().enumerate() {
        let to_all = distances_to_query(
            &compared,
            &mirrored(&landmarks(motion)),
            Band::radius(BAND, FRAMES),
        )
        .expect("distances");
        let others = to_all.iter().zip(MOTIONS.iter()).skip(i + 1);
        nearest.extend(others.map(|(d, m)| (a_landmark(*d), m.name(), motion.name())));
    }
    nearest.sort_by(|x, y| x.0.total_cmp(&y.0));
    for (d, a, b) in &nearest[..6] {
        println!("{:.1} cm: {a}, mirrored {b}", 100.0 * d);
    }
    assert!(nearest[0].0 > least, "{:?}", nearest[0]);
}

/// Landmarks with left and right swapped.
fn mirrored(landmarks: &[f64]) -> Vec<f64> {
    let partner = |role: Role| {
        let other = match role.name().split_once('_') {
            Some(("left", part)) => format!("right_{part}"),
            Some(("right", part)) => format!("left_{part}"),
            _ => role.name().to_string(),
        };
        LANDMARKS
            .iter()
            .position(|r| r.name() == other)
            .expect("a partner")
    };
    let partners = LANDMARKS.map(partner);
    landmarks
        .chunks_exact(3 * LANDMARKS.len())
        .flat_map(|row| partners.map(|p| [row[3 * p], -row[3 * p + 1], row[3 * p + 2]]))
        .flatten()
        .collect()
}

#[test]
fn none_is_a_movement_of_the_session() {
    let least = 0.12;
    let session = performed(&read("session.toml", SESSION));
    let movements: Vec<Motion> = movements(&session);
    let compared = sequences(&MOTIONS);
    let mut nearest: Vec<(f64, &str, String)> = Vec::new();
    for movement in &movements {
        let to_all =
            distances_to_query(&compared, &landmarks(movement), Band::radius(BAND, FRAMES))
                .expect("distances");
        let pairs = to_all.iter().zip(MOTIONS.iter());
        nearest.extend(pairs.map(|(d, m)| (a_landmark(*d), m.name(), movement.name().to_string())));
    }
    nearest.sort_by(|x, y| x.0.total_cmp(&y.0));
    for (d, a, b) in &nearest[..6] {
        println!("{:.1} cm: {a}, {b}", 100.0 * d);
    }
    assert!(nearest[0].0 > least, "{:?}", nearest[0]);
}

/// The whole movements of the session, from the first to the last of the strokes that follow one another.
fn movements(session: &[Motion]) -> Vec<Motion> {
    let mut spans: Vec<(String, f64, f64, String)> = Vec::new();
    for line in MOVEMENTS.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().expect("seconds");
        let (start, end) = (number(1), number(2));
        match spans.last_mut() {
            Some(s) if s.0 == cells[0] && s.3 == cells[3] && start - s.2 < 1e-6 => s.2 = end,
            _ => spans.push((cells[0].to_string(), start, end, cells[3].to_string())),
        }
    }
    let frame = |secs: f64| (secs * RATE_HZ).round() as usize;
    spans
        .iter()
        .map(|(recording, start, end, movement)| {
            let whole = session
                .iter()
                .find(|m| m.name() == recording)
                .expect("a recording");
            let part = whole.slice(frame(*start)..frame(*end) + 1).expect("a span");
            let name = format!("{movement} of {recording} at {start} s");
            Motion::new(
                name,
                Arc::clone(part.skeleton()),
                RATE_HZ,
                part.poses().to_vec(),
                part.roots().to_vec(),
            )
            .expect("a motion")
        })
        .collect()
}

#[test]
fn a_rotation_about_an_axis_reads_as_its_angle() {
    // The basis of a left-handed limb and of the right-handed trunk, against nalgebra's own rotations.
    let body = kineme::ares().expect("a body");
    for name in ["left_shoulder", "right_shoulder", "pelvis"] {
        let joint = &body.joints()[body.joint(name).expect("a joint")];
        let turn = Rotation3::from_scaled_axis(joint.axes.flexion * 0.7);
        let range = Range {
            low: 0.7 - 1e-6,
            high: 0.7 + 1e-6,
        };
        let none = Range {
            low: -1e-6,
            high: 1e-6,
        };
        assert!(
            excess(
                &UnitQuaternion::from_rotation_matrix(&turn),
                joint,
                &[range, none, none]
            ) < 1e-9,
            "{name}"
        );
    }
}
