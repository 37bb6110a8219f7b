//! URDF, the XML of ROS: links, and the joints between them.
//!
//! A file's [`elements`] are read one by one, then put together to the [`tree`] of bodies; [`mjcf`] says the same to an
//! engine.

mod elements;
mod inertia;
mod mjcf;
mod still;
mod tree;

pub use tree::tree;
