//! Tables of motion: joint positions, MSR-Action3D text, joint angles.

pub mod angles;
pub mod body_angles;
pub(crate) mod kinect;
pub mod msr;
pub mod observed;
pub mod positions;
mod timebase;
pub(crate) mod upright;
