//! Robots: MJCF, the XML of MuJoCo, and URDF, that of ROS, to a [`Skeleton`] of hinges.
//!
//! Bodies, hinges, their ranges and what `inertial` says are read; contacts and meshes are the engine's own matter. The
//! base is held where it stands: a free joint is no coordinate. Which hinges make up which part of a human body a profile
//! says ([`crate::profile`]: a role lists its hinges), a built-in one for the Unitree G1, else the hinges' names; and from
//! where the joints lie follows the neutral standing posture in which a [`Skeleton`] is defined.
//!
//! A file is what its root element says, whatever it is called: `<mujoco>` is MJCF, `<robot>` is URDF. Both become the
//! same tree of bodies, and from there on nothing asks which it was. Of a URDF:
//!
//! - Every `revolute` and `continuous` joint is a hinge. A `prismatic` one is held where it is at zero, as near as its
//!   limits let it.
//! - A joint that mimics another is no coordinate of its own: it is held at the angle that it has while the other is at
//!   zero. Both are told in [`RobotModel::warnings`].
//! - A `floating` or `planar` joint of the root link holds the base, as does a link `world` that does nothing but carry
//!   it; elsewhere such a joint is refused.
//! - An engine that cannot find the meshes (`package://` means nothing to it) needs none: [`RobotModel::mjcf`] is the
//!   robot as MJCF without shapes. What moves without a mass or an inertia, which no engine takes, has next to none there.
//!   Elements that extend URDF (`transmission`, `gazebo`, `mujoco`), `safety_controller` and limits of velocity are not
//!   read.

mod mjcf;
mod model;
mod neutral;
mod roles;
mod source;
mod tree;
mod urdf;

use std::path::{Path, PathBuf};

use kineme::Skeleton;

use crate::error::{FormatError, Place, Result};
use crate::profile::{self, Profile};
use source::Text;

/// Bytes of a robot's file at most: the largest robots have some hundred kilobytes.
const LARGEST: u64 = 1 << 26;

/// A robot of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotModel {
    /// Its body. Every joint's frame is the world's in the neutral standing posture: arms hang with the palms to the
    /// thighs, legs are straight. Named as the model.
    pub skeleton: Skeleton,
    /// The robot's file.
    pub path: PathBuf,
    /// The robot as MJCF without shapes, for an engine; `None` where the file is MJCF itself.
    pub mjcf: Option<String>,
    /// The hinge behind each coordinate of a pose.
    pub hinges: Vec<RobotHinge>,
    /// The name of the base, the body that carries all others.
    pub root: String,
    /// The profile that gave the roles, or `guessed`.
    pub profile: String,
    /// What was passed over or could not be had.
    pub warnings: Vec<String>,
}

/// A hinge of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotHinge {
    /// The joint's name in the file.
    pub joint: String,
    /// The engine's coordinate (radians) in the neutral standing posture: the engine's is this plus the pose's.
    pub neutral_rad: f64,
}

/// Reads a robot of an MJCF or URDF file. Its profile is the one given, else that of a file of the same stem beside it
/// with the extension `toml`, else a built-in one whose joints are all there; without any, roles are guessed from names.
///
/// # Errors
/// When a file cannot be read or is neither, with the line: a reference to nothing, a number that is none, a joint that
/// is no hinge, links that make no tree, macros of xacro. When the profile names a joint that is not there.
pub fn read(path: &Path, profile: Option<&Profile>) -> Result<RobotModel> {
    let name = path.display().to_string();
    let bytes = bytes(path)?;
    let beside = path.with_extension("toml");
    let own = match profile {
        None if beside.is_file() => Some(profile::parse(
            &beside.display().to_string(),
            &self::bytes(&beside)?,
        )?),
        _ => None,
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let included = |file: &str| self::bytes(&folder.join(file));
    parse(&name, &bytes, &included, profile.or(own.as_ref()))
}

/// Reads a robot of the bytes of an MJCF or URDF file; `included` gives those of the files that MJCF includes.
///
/// # Errors
/// As [`read`].
pub fn parse(
    name: &str,
    bytes: &[u8],
    included: &dyn Fn(&str) -> Result<Vec<u8>>,
    profile: Option<&Profile>,
) -> Result<RobotModel> {
    let main = Text::of(name, bytes)?;
    let document = main.parse()?;
    let root = document.root_element();
    let tree = match root.tag_name().name() {
        "mujoco" => mjcf::tree(&main, document, included)?,
        "robot" => urdf::tree(&main, document)?,
        other => {
            let line = document.text_pos_at(root.range().start).row as usize;
            let found = format!("<{other}>");
            let expected = "a robot: <mujoco> (MJCF) or <robot> (URDF)";
            return Err(FormatError::new(name, Place::Line(line), found, expected));
        }
    };
    model::model(name, tree, profile)
}

fn bytes(path: &Path) -> Result<Vec<u8>> {
    let refused = |found: String, expected: &str| {
        FormatError::new(path.display().to_string(), Place::File, found, expected)
    };
    let unread = |e: std::io::Error| refused(crate::told(&e), "a file that can be read");
    let length = std::fs::metadata(path).map_err(unread)?.len();
    if length > LARGEST {
        return Err(refused(
            format!("{length} bytes"),
            "a robot of 64 MiB at most",
        ));
    }
    std::fs::read(path).map_err(unread)
}
