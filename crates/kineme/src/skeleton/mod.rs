//! Floor 1: articulated bodies, their poses and their geometry.
//!
//! A pose is one vector of coordinates; [`Skeleton::coordinate_names`] says what each of them is. Ball joints have
//! three, the rotation vector relative to the joint's reference rotation, hinges one, the angle.

mod adonis;
mod anthropometry;
mod ares;
mod body;
mod clinical;
mod joint;
mod joint_set;
mod kinematics;
mod limits;
mod mirror;
mod parts;
mod reach;
mod role;

pub use adonis::adonis;
pub use anthropometry::{BODY_MASS, STATURE};
pub use ares::ares;
pub use body::{Effector, Skeleton};
pub use joint::{ClinicalAxes, Joint, JointKind, Link, Range};
pub(crate) use joint_set::part;
pub use joint_set::{JointSet, PARTS};
pub use kinematics::{Frame, Root};
pub use reach::Reach;
pub use role::Role;

use crate::error::{Error, Result};

/// The built-in body of this name: `ares` or `adonis`.
///
/// # Errors
/// For any other name.
pub fn body(name: &str) -> Result<Skeleton> {
    match name {
        "ares" => ares(),
        "adonis" => adonis(),
        _ => Err(Error::unknown_name("body", name, ["ares", "adonis"])),
    }
}
