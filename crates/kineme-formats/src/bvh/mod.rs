//! BVH, the Biovision hierarchy: text with a skeleton and rows of channels in degrees.
//!
//! No standard exists; the reading follows Meredith and Maddock, "Motion Capture File Formats
//! Explained" (University of Sheffield, 2001), and what files in use do:
//!
//! - A joint's rotation is the product of its rotation channels in the order of its `CHANNELS` line,
//!   about its own axes, with column vectors. Fewer than three are allowed.
//! - Position channels may stand anywhere in the line and at any joint. Whether they replace the
//!   joint's `OFFSET` or are added to it is nowhere written in a file; see *Conventions*.
//! - More rows than declared: the declared ones are read, and a warning says so. Fewer: an error.
//!
//! # Conventions
//! Three readings of position channels are in use: `replace` (they stand in place of `OFFSET`), `add`
//! (they are added to it), and `root_only` (they replace it at the root and count nowhere else).
//! Root and other joints are decided apart:
//!
//! - Children vote, each joint once: a mean position near its `OFFSET` means replace, near zero means add
//!   (with channels of zero that is `root_only`). The majority holds.
//! - A root without `OFFSET` needs no decision. One whose first position repeats its `OFFSET` means replace.
//! - What is left open goes to the reading that puts the lowest point of the motion nearest the floor (height
//!   zero); when none comes within half a body of it, replace.
//!
//! # Axes and unit
//! The up axis is z when the body is longer along z than along y in the rest pose (all angles zero) and in the
//! median frame, one of them clearly (by half), the other at least not against it; else y, the custom.
//! The unit is the one among metre, centimetre, inch, millimetre and 0.0254/0.45 m (the
//! CMU skeletons' own) that brings the longest chain of bones below the first branching joint
//! nearest 1.15 m in ratio: the reach of a leg or a trunk and arm of an adult.

mod interpret;
mod parse;
mod write;

pub use write::write;

use kineme::Recording;
use kineme::math::rotation::{Axis, EulerOrder};
use nalgebra::Vector3;

use crate::error::Result;

/// Reads a BVH file; `name` is what errors and the recording call it.
///
/// # Errors
/// [`crate::FormatError`] with the line where the text is no BVH file, is cut, or holds a number that
/// is none.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Recording> {
    let file = parse::read(name, bytes)?;
    interpret::recording(name, file, bytes.len())
}

/// One number a frame of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    Position(Axis),
    Rotation(Axis),
}

/// A joint as the file writes it: file units, file axes.
#[derive(Debug, Clone)]
struct Joint {
    name: String,
    parent: Option<usize>,
    offset: Vector3<f64>,
    site: Option<Vector3<f64>>,
    channels: Vec<Channel>,
}

impl Joint {
    /// The order of its rotation channels, completed by the axes that it lacks.
    fn order(&self) -> Option<EulerOrder> {
        let mut axes: Vec<Axis> = self
            .channels
            .iter()
            .filter_map(|c| match c {
                Channel::Rotation(axis) => Some(*axis),
                Channel::Position(_) => None,
            })
            .collect();
        if axes.is_empty() {
            return None;
        }
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            if axes.len() < 3 && !axes.contains(&axis) {
                axes.push(axis);
            }
        }
        Some(EulerOrder([axes[0], axes[1], axes[2]]))
    }
}

/// A file before its conventions are decided.
#[derive(Debug)]
struct File {
    joints: Vec<Joint>,
    frame_secs: f64,
    /// Row after row; a row holds the channels of all joints in file order.
    values: Vec<f64>,
    frames: usize,
    warnings: Vec<String>,
}
