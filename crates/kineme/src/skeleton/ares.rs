//! Ares: 132 degrees of freedom, the whole body with every vertebra.

use nalgebra::Vector3;

use super::anthropometry::HEAD;
use super::anthropometry::UPPER_TRUNK;
use super::body::Skeleton;
use super::joint::{ClinicalAxes, Joint, Link};
use super::parts::{
    Hinges, SACRUM, Side, TRUNK_TOP, arm, ball, effectors, leg, neck_share, shoulder_offset, skull,
    trunk_axes, trunk_slab, vertex_over,
};
use super::role::Role;
use crate::error::Result;

/// Relative heights of a lumbar, thoracic and cervical vertebra with its disc.
const HEIGHTS: [f64; 3] = [1.6, 1.0, 0.75];
/// Share of the upper trunk's mass in each shoulder girdle.
const GIRDLE_SHARE: f64 = 0.08;
/// Distance of the sternoclavicular joint from the middle, metres.
const CLAVICLE: f64 = 0.02;

/// Ares (paper, section IV): 132 degrees of freedom in 44 joints of three.
///
/// The paper lists 72 in the spine, 15 an arm, 12 a leg and 3 in the neck: 129 in 43 joints. Our 44th joint is the
/// pelvis, which carries the body's orientation less its heading. The 24 joints of the spine are 5 lumbar, 12 thoracic
/// and 7 cervical; the joint of the neck is the one between atlas and skull. Fingers are one segment a hand.
///
/// # Errors
/// Never for this body; the constructor checks all bodies alike.
pub fn ares() -> Result<Skeleton> {
    let axes = trunk_axes();
    let up = |z: f64| Vector3::new(0.0, 0.0, z);
    let unit = (TRUNK_TOP - SACRUM) / (5.0 * HEIGHTS[0] + 12.0 * HEIGHTS[1]);
    let mut joints = vec![Joint {
        name: "pelvis".into(),
        parent: None,
        offset: Vector3::zeros(),
        kind: ball(&axes, [(-90.0, 90.0), (-90.0, 90.0), (-90.0, 90.0)]),
        axes,
        role: Some(Role::Hips),
        share: 1.0,
        tip: up(SACRUM),
        link: trunk_slab(0.0, SACRUM, 0.0),
    }];
    let neck_height = 7.0 * HEIGHTS[2] * unit;
    let skull_share = 1.0 - neck_share(neck_height);
    let mut height = SACRUM;
    let regions: [(&str, usize, Role, f64, [f64; 3]); 3] = [
        // Ranges of one vertebra (degrees, half of the region's range divided by its joints). A lumbar vertebra turns
        // by 3 in people, but here half of the trunk's turning of up to 60 is spread over five of them.
        ("lumbar", 5, Role::Spine, 0.5, [11.0, 6.0, 6.0]),
        ("thoracic", 12, Role::Chest, 0.5, [5.0, 4.0, 5.0]),
        ("cervical", 7, Role::Neck, 0.6, [10.0, 7.0, 10.0]),
    ];
    let mut top_of_thorax = (0, 0.0);
    for (r, (region, count, role, share, ranges)) in regions.into_iter().enumerate() {
        for i in 0..count {
            let tall = HEIGHTS[r] * unit;
            let below = joints.len() - 1;
            let offset = up(if below == 0 {
                SACRUM
            } else {
                joints[below].tip.z
            });
            let link = if region == "cervical" {
                let center = up(0.5 * tall);
                HEAD.slice(neck_share(tall), tall, center)
            } else {
                trunk_slab(height, height + tall, height)
            };
            if region == "thoracic" && i + 1 == count {
                top_of_thorax = (joints.len(), height);
            }
            joints.push(Joint {
                // Vertebrae are numbered from above: the lowest lumbar is L5.
                name: format!("{region}_{}", count - i),
                parent: Some(below),
                offset,
                kind: ball(&axes, ranges.map(|d| (-d, d))),
                axes,
                role: Some(role),
                share: share / count as f64,
                tip: up(tall),
                link,
            });
            height += tall;
        }
    }
    let atlas = joints.len() - 1;
    joints.push(Joint {
        name: "skull".into(),
        parent: Some(atlas),
        offset: joints[atlas].tip,
        kind: ball(&axes, [(-25.0, 25.0), (-10.0, 10.0), (-40.0, 40.0)]),
        axes,
        role: Some(Role::Head),
        share: 0.4,
        tip: up(vertex_over(height)),
        link: skull(skull_share, height),
    });
    shoulders(&mut joints, top_of_thorax);
    for side in [Side::Left, Side::Right] {
        leg(&mut joints, 0, side, true);
    }
    let effectors = effectors(&joints);
    Skeleton::new("ares", joints, effectors)
}

/// Both shoulder girdles and arms on the uppermost thoracic vertebra; the girdles' mass comes out of the upper thorax.
fn shoulders(joints: &mut Vec<Joint>, (thorax, height): (usize, f64)) {
    lighten_upper_thorax(joints, thorax);
    for side in [Side::Left, Side::Right] {
        // The clavicle's positive movements: forward, upward, turning backward.
        let axes = ClinicalAxes {
            flexion: Vector3::z() * -side.sign(),
            abduction: Vector3::x() * side.sign(),
            axial: Vector3::y() * -1.0,
        };
        let to_shoulder = shoulder_offset(side, height, CLAVICLE);
        let reach = Vector3::new(0.0, to_shoulder.y, 0.0);
        let role = match side {
            Side::Left => Role::LeftShoulder,
            Side::Right => Role::RightShoulder,
        };
        let girdle = joints.len();
        joints.push(Joint {
            name: format!("{}_clavicle", side.name()),
            parent: Some(thorax),
            offset: Vector3::new(0.0, side.sign() * CLAVICLE, to_shoulder.z),
            kind: ball(&axes, [(-20.0, 30.0), (-10.0, 45.0), (-10.0, 40.0)]),
            axes,
            role: Some(role),
            share: 1.0,
            tip: reach,
            link: UPPER_TRUNK.slice(GIRDLE_SHARE, reach.y.abs(), 0.5 * reach),
        });
        arm(joints, girdle, reach, side, Hinges::Ball, true);
    }
}

/// Takes the girdles' mass out of the vertebrae that carry the upper trunk, each in proportion to its own.
fn lighten_upper_thorax(joints: &mut [Joint], thorax: usize) {
    let taken = 2.0 * GIRDLE_SHARE * UPPER_TRUNK.mass_kg();
    let upper = thorax - 7..=thorax;
    let carried: f64 = joints[upper.clone()].iter().map(|j| j.link.mass_kg).sum();
    let keep = 1.0 - taken / carried;
    for joint in &mut joints[upper] {
        joint.link = Link {
            mass_kg: joint.link.mass_kg * keep,
            center: joint.link.center,
            inertia: joint.link.inertia * keep,
        };
    }
}
