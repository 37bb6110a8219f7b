//! Floor 2: motion of any skeleton, or bare positions, expressed in the joints of a body.
//!
//! Retargeting is geometric, by anatomical frames: it needs no agreement of rest poses and works from bare positions
//! as from rotations. Limb lengths are normalised away: only directions and orientations pass.

mod anatomy;
mod fit;
mod fitting;
mod guess;
mod hinges;
mod landmarks;
mod limb;
mod orientation;
mod own;
mod profile;
mod transfer;

pub use anatomy::Anatomy;
pub use fit::{Retargeted, posture, retarget, transfer};
pub use guess::guess_role;
pub use landmarks::Landmarks;
pub use profile::{Profile, REQUIRED, RoleMap};
pub use transfer::{Transfer, Transferred};
