//! Parts that both built-in bodies share: limbs, slabs of the trunk, ranges of motion.
//!
//! Ranges: American Academy of Orthopaedic Surgeons, "Joint Motion: Method of Measuring and Recording", 1965, rounded.
//! They are passive and unloaded; where people who move go farther, [`ELBOW`], [`KNEE`] and [`ANKLE`] say by how much.

use nalgebra::{Unit, Vector3};

use super::anthropometry::{
    ANKLE_HEIGHT, FOOT, FOREARM, HALF_HIPS, HALF_SHOULDERS, HAND, HEAD, LOWER_TRUNK, MIDDLE_TRUNK,
    SHANK, SHOULDERS_OVER_HIPS, STATURE, THIGH, UPPER_ARM, UPPER_TRUNK, WHOLE_HAND, join, moved,
};
use super::body::Effector;
use super::joint::{ClinicalAxes, Joint, JointKind, Link, Range};
use super::role::Role;

/// Height of the lumbosacral joint over the hips, metres: two thirds of the lower trunk.
pub const SACRUM: f64 = 0.1;
/// Height of the suprasternale over the hips, metres: the sum of the three trunk segments.
pub const TRUNK_TOP: f64 = 0.5319;
/// Radius of the neck, metres: the cylinder that is taken out of the head's mass for the cervical vertebrae.
pub const NECK_RADIUS: f64 = 0.0575;
/// Density of the neck, kg/m^3 (Dempster 1955).
pub const NECK_DENSITY: f64 = 1110.0;

/// The left or the right half of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Side {
    /// The left.
    Left,
    /// The right.
    Right,
}

impl Side {
    /// `left` or `right`.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
        }
    }

    /// +1 for the left, -1 for the right: the sign of y.
    pub fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// Clinical axes of the trunk, neck and head: bending forward, to the left, turning to the left.
pub fn trunk_axes() -> ClinicalAxes {
    ClinicalAxes {
        flexion: Vector3::y(),
        abduction: -Vector3::x(),
        axial: Vector3::z(),
    }
}

/// Clinical axes of shoulder and hip: raising forward, away from the middle, turning inward.
pub fn limb_axes(side: Side) -> ClinicalAxes {
    ClinicalAxes {
        flexion: -Vector3::y(),
        abduction: Vector3::x() * side.sign(),
        axial: -Vector3::z() * side.sign(),
    }
}

/// Clinical axes of the wrist: toward the palm, toward the thumb, turning inward (pronation).
fn wrist_axes(side: Side) -> ClinicalAxes {
    ClinicalAxes {
        flexion: -Vector3::x() * side.sign(),
        abduction: -Vector3::y(),
        axial: -Vector3::z() * side.sign(),
    }
}

/// Clinical axes of the knee: the heel toward the seat.
fn knee_axes(side: Side) -> ClinicalAxes {
    ClinicalAxes {
        flexion: Vector3::y(),
        ..limb_axes(side)
    }
}

impl ClinicalAxes {
    /// The axes of the joint that moves a part, at the neutral standing pose; those of the trunk for a joint without role.
    pub fn of(role: Option<Role>) -> Self {
        use Role::*;
        let Some(role) = role else {
            return trunk_axes();
        };
        let side = match Role::name(role).starts_with("left") {
            true => Side::Left,
            false => Side::Right,
        };
        match role {
            Hips | Spine | Chest | UpperChest | Neck | Head => trunk_axes(),
            LeftHand | LeftFingers | RightHand | RightFingers => wrist_axes(side),
            LeftLowerLeg | RightLowerLeg => knee_axes(side),
            _ => limb_axes(side),
        }
    }
}

/// A ball joint whose reference rotation is the middle of these ranges (degrees).
pub fn ball(axes: &ClinicalAxes, degrees: [(f64, f64); 3]) -> JointKind {
    let ranges = degrees.map(|(low, high)| Range::degrees(low, high));
    let [flexion, abduction, axial] = ranges.map(|r| r.middle());
    JointKind::Ball {
        reference: axes.rotation(flexion, abduction, axial),
        ranges,
    }
}

/// A hinge of positive flexion in this range (degrees).
pub fn hinge(axes: &ClinicalAxes, low: f64, high: f64) -> JointKind {
    JointKind::Hinge {
        axis: Unit::new_normalize(axes.flexion),
        range: Range::degrees(low, high),
    }
}

/// The slab of the trunk between two heights over the hips, in the frame of a joint at height `at`.
pub fn trunk_slab(low: f64, high: f64, at: f64) -> Link {
    let mut bottom = 0.0;
    let mut slab: Option<Link> = None;
    for segment in [LOWER_TRUNK, MIDDLE_TRUNK, UPPER_TRUNK] {
        let (from, to) = (low.max(bottom), high.min(bottom + segment.length));
        if to > from {
            let center = Vector3::new(0.0, 0.0, 0.5 * (from + to) - at);
            let slice = segment.slice((to - from) / segment.length, to - from, center);
            slab = Some(slab.map_or(slice.clone(), |s| join(&s, &slice)));
        }
        bottom += segment.length;
    }
    slab.unwrap_or_else(massless)
}

/// A link without mass, for joints whose link is counted elsewhere.
pub fn massless() -> Link {
    Link {
        mass_kg: 0.0,
        center: Vector3::zeros(),
        inertia: nalgebra::Matrix3::zeros(),
    }
}

/// The share of the head segment's mass that lies in a neck of this height.
pub fn neck_share(height: f64) -> f64 {
    std::f64::consts::PI * NECK_RADIUS * NECK_RADIUS * height * NECK_DENSITY / HEAD.mass_kg()
}

/// Height of the vertex over a joint that stands `at` metres over the hips: the whole body is [`STATURE`] tall.
pub fn vertex_over(at: f64) -> f64 {
    STATURE - (ANKLE_HEIGHT + SHANK.length + THIGH.length) - at
}

/// The head above the neck, in the frame of its joint `at` metres over the hips; `share` of the segment's mass.
/// Its centre is where de Leva has it, below the vertex.
pub fn skull(share: f64, at: f64) -> Link {
    let center = Vector3::new(0.0, 0.0, vertex_over(at) - HEAD.center * HEAD.length);
    HEAD.slice(share, HEAD.length, center)
}

/// Which joints a limb's hinges become.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hinges {
    /// One coordinate: elbow and knee of Adonis.
    Single,
    /// Three coordinates: all joints of Ares.
    Ball,
}

/// Ranges of the shoulder, degrees: flexion, abduction, inward turning.
const SHOULDER: [(f64, f64); 3] = [(-60.0, 180.0), (-50.0, 180.0), (-90.0, 70.0)];

/// Flexion of the elbow, degrees: straight arms lie inside, not at the end, and folded ones are recorded at 141 and 156
/// (99 and 99.9 % of frames of nine sets of recordings).
const ELBOW: (f64, f64) = (-10.0, 160.0);
/// Flexion of the knee, degrees: overextension to 10 (AAOS) and a recording's error; squatting takes 157 (Hemmerich et
/// al., "Hip, knee, and ankle kinematics of high range of motion activities of daily living", 2006).
const KNEE: (f64, f64) = (-15.0, 155.0);
/// Dorsal flexion of the ankle, degrees: unloaded 50 down and 20 up (AAOS); under the body's weight 1 frame in 100 lies
/// beyond 13 to 51 up, as the set of recordings may be, and 1 in 1,000 beyond 37 to 82 down.
const ANKLE: (f64, f64) = (-70.0, 40.0);

/// The arm from the shoulder joint outward, appended to `joints`; `parent` carries it at `offset`.
/// Fingers are a joint of their own where `fingers`, else part of the hand. Returns the hand's index.
pub fn arm(
    joints: &mut Vec<Joint>,
    parent: usize,
    offset: Vector3<f64>,
    side: Side,
    hinges: Hinges,
    fingers: bool,
) -> usize {
    use Side::{Left, Right};
    let name = |part: &str| format!("{}_{part}", side.name());
    let axes = limb_axes(side);
    let first = joints.len();
    let [upper, lower, hand, finger] = match side {
        Left => [
            Role::LeftUpperArm,
            Role::LeftLowerArm,
            Role::LeftHand,
            Role::LeftFingers,
        ],
        Right => [
            Role::RightUpperArm,
            Role::RightLowerArm,
            Role::RightHand,
            Role::RightFingers,
        ],
    };
    let down = |length: f64| Vector3::new(0.0, 0.0, -length);
    joints.push(Joint {
        name: name("shoulder"),
        parent: Some(parent),
        offset,
        kind: ball(&axes, SHOULDER),
        axes,
        role: Some(upper),
        share: 1.0,
        tip: down(UPPER_ARM.length),
        link: UPPER_ARM.hanging(),
    });
    joints.push(Joint {
        name: name("elbow"),
        parent: Some(first),
        offset: down(UPPER_ARM.length),
        kind: match hinges {
            Hinges::Single => hinge(&axes, ELBOW.0, ELBOW.1),
            Hinges::Ball => ball(&axes, [ELBOW, (-10.0, 10.0), (-10.0, 10.0)]),
        },
        axes,
        role: Some(lower),
        share: 1.0,
        tip: down(FOREARM.length),
        link: FOREARM.hanging(),
    });
    // Pronation is carried at the wrist, as in Adonis: the elbow's coordinates then follow from positions alone.
    let wrist = wrist_axes(side);
    // The palm is the first 46 % of the hand's length and carries 60 % of its mass; the fingers the rest.
    let palm = HAND.slice(0.6, HAND.length, down(0.5 * HAND.length));
    let rest = WHOLE_HAND - HAND.length;
    let digits = HAND.slice(0.4, rest, down(0.5 * rest));
    joints.push(Joint {
        name: name("wrist"),
        parent: Some(first + 1),
        offset: down(FOREARM.length),
        kind: ball(&wrist, [(-70.0, 80.0), (-30.0, 20.0), (-85.0, 85.0)]),
        axes: wrist,
        role: Some(hand),
        share: 1.0,
        tip: down(if fingers { HAND.length } else { WHOLE_HAND }),
        link: if fingers {
            palm
        } else {
            join(&palm, &moved(&digits, down(HAND.length)))
        },
    });
    if fingers {
        joints.push(Joint {
            name: name("fingers"),
            parent: Some(first + 2),
            offset: down(HAND.length),
            kind: ball(&wrist, [(-10.0, 90.0), (-20.0, 20.0), (-5.0, 5.0)]),
            axes: wrist,
            role: Some(finger),
            share: 1.0,
            tip: down(rest),
            link: digits,
        });
    }
    first + 2
}

/// The leg from the hip outward, appended to `joints`; fixed legs (Adonis) have no coordinates. Returns the foot's index.
pub fn leg(joints: &mut Vec<Joint>, pelvis: usize, side: Side, moves: bool) -> usize {
    use Side::{Left, Right};
    let name = |part: &str| format!("{}_{part}", side.name());
    let kind = |axes: &ClinicalAxes, ranges| {
        if moves {
            ball(axes, ranges)
        } else {
            JointKind::Fixed
        }
    };
    let first = joints.len();
    let [upper, lower, foot, toes] = match side {
        Left => [
            Role::LeftUpperLeg,
            Role::LeftLowerLeg,
            Role::LeftFoot,
            Role::LeftToes,
        ],
        Right => [
            Role::RightUpperLeg,
            Role::RightLowerLeg,
            Role::RightFoot,
            Role::RightToes,
        ],
    };
    // The ankle stands over a quarter of the foot's length, the ball of the foot at 72 %.
    let (ankle, ball_of_foot) = (0.25 * FOOT.length, 0.72 * FOOT.length);
    let sole = -0.75 * ANKLE_HEIGHT;
    let forward = |x: f64, z: f64| Vector3::new(x, 0.0, z);
    let mut push = |part: &str, parent, offset, axes, ranges, role, tip, link| {
        joints.push(Joint {
            name: name(part),
            parent: Some(parent),
            offset,
            kind: kind(&axes, ranges),
            axes,
            role: Some(role),
            share: 1.0,
            tip,
            link,
        });
    };
    push(
        "hip",
        pelvis,
        Vector3::new(0.0, side.sign() * HALF_HIPS, 0.0),
        limb_axes(side),
        [(-20.0, 125.0), (-25.0, 45.0), (-40.0, 40.0)],
        upper,
        forward(0.0, -THIGH.length),
        THIGH.hanging(),
    );
    push(
        "knee",
        first,
        forward(0.0, -THIGH.length),
        knee_axes(side),
        [KNEE, (-10.0, 10.0), (-10.0, 10.0)],
        lower,
        forward(0.0, -SHANK.length),
        SHANK.hanging(),
    );
    push(
        "ankle",
        first + 1,
        forward(0.0, -SHANK.length),
        limb_axes(side),
        [ANKLE, (-20.0, 20.0), (-30.0, 30.0)],
        foot,
        forward(ball_of_foot - ankle, sole),
        FOOT.slice_forward(
            0.85,
            ball_of_foot,
            forward(0.5 * ball_of_foot - ankle, 0.5 * sole),
        ),
    );
    push(
        "toes",
        first + 2,
        forward(ball_of_foot - ankle, sole),
        limb_axes(side),
        [(-40.0, 70.0), (-10.0, 10.0), (-10.0, 10.0)],
        toes,
        forward(FOOT.length - ball_of_foot, 0.0),
        FOOT.slice_forward(
            0.15,
            FOOT.length - ball_of_foot,
            forward(0.5 * (FOOT.length - ball_of_foot), 0.0),
        ),
    );
    first + 2
}

/// Where the shoulder joint stands in the frame of a trunk joint at height `at` over the hips, `across` metres from the middle.
pub fn shoulder_offset(side: Side, at: f64, across: f64) -> Vector3<f64> {
    Vector3::new(
        0.0,
        side.sign() * (HALF_SHOULDERS - across),
        SHOULDERS_OVER_HIPS - at,
    )
}

/// The five effectors: wrist centres, ankle centres, the head's centre.
pub fn effectors(joints: &[Joint]) -> Vec<Effector> {
    let at = |name: &str, role: Role| {
        let joint = joints.iter().position(|j| j.role == Some(role))?;
        let point = if role == Role::Head {
            joints[joint].link.center
        } else {
            Vector3::zeros()
        };
        Some(Effector {
            name: name.into(),
            joint,
            point,
        })
    };
    [
        at("left_hand", Role::LeftHand),
        at("right_hand", Role::RightHand),
        at("left_foot", Role::LeftFoot),
        at("right_foot", Role::RightFoot),
        at("head", Role::Head),
    ]
    .into_iter()
    .flatten()
    .collect()
}
