//! Floor 1: articulated bodies, their poses and their geometry.

mod role;

pub use role::Role;
