//! Adonis: 20 degrees of freedom, the upper body on fixed legs.

use nalgebra::Vector3;

use super::body::Skeleton;
use super::joint::{Joint, JointKind};
use super::parts::{
    Hinges, SACRUM, Side, TRUNK_TOP, arm, ball, effectors, leg, shoulder_offset, skull, trunk_axes,
    trunk_slab, vertex_over,
};
use super::role::Role;
use crate::error::Result;

/// Height of the neck's joint over the hips, metres: the level of the chin, half-way up the cervical spine.
const NECK: f64 = TRUNK_TOP + 0.08;

/// Adonis (paper, section IV): waist 3, neck 3, shoulders 3 + 3, elbows 1 + 1, wrists 3 + 3 = 20; the legs do not move.
///
/// No public table of the original's masses and lengths is known; these are de Leva's (1996).
///
/// # Errors
/// Never for this body; the constructor checks all bodies alike.
pub fn adonis() -> Result<Skeleton> {
    let axes = trunk_axes();
    let up = |z: f64| Vector3::new(0.0, 0.0, z);
    let mut joints = vec![
        Joint {
            name: "pelvis".into(),
            parent: None,
            offset: Vector3::zeros(),
            kind: JointKind::Fixed,
            axes,
            role: Some(Role::Hips),
            share: 1.0,
            tip: up(SACRUM),
            link: trunk_slab(0.0, SACRUM, 0.0),
        },
        Joint {
            name: "waist".into(),
            parent: Some(0),
            offset: up(SACRUM),
            kind: ball(&axes, [(-30.0, 90.0), (-35.0, 35.0), (-60.0, 60.0)]),
            axes,
            role: Some(Role::Chest),
            share: 1.0,
            tip: up(TRUNK_TOP - SACRUM),
            link: trunk_slab(SACRUM, TRUNK_TOP, SACRUM),
        },
        Joint {
            name: "neck".into(),
            parent: Some(1),
            offset: up(NECK - SACRUM),
            kind: ball(&axes, [(-60.0, 50.0), (-40.0, 40.0), (-80.0, 80.0)]),
            axes,
            role: Some(Role::Head),
            share: 1.0,
            tip: up(vertex_over(NECK)),
            link: skull(1.0, NECK),
        },
    ];
    for side in [Side::Left, Side::Right] {
        let offset = shoulder_offset(side, SACRUM, 0.0);
        arm(&mut joints, 1, offset, side, Hinges::Single, false);
    }
    for side in [Side::Left, Side::Right] {
        leg(&mut joints, 0, side, false);
    }
    let effectors = effectors(&joints);
    Skeleton::new("adonis", joints, effectors)
}
