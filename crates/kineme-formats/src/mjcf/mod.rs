//! Robots: MJCF, the XML of MuJoCo, to a [`Skeleton`] of hinges.
//!
//! Bodies, hinges, their ranges and what `inertial` says are read; actuators, contacts and meshes are the engine's own
//! matter. The base is held where it stands: a free joint is no coordinate. Which hinges make up which part of a human
//! body a profile says ([`crate::profile`]: a role lists its hinges), a built-in one for the Unitree G1, else the
//! hinges' names; and from where the joints lie follows the neutral standing posture in which a [`Skeleton`] is defined.

mod neutral;
mod robot;
mod roles;
mod source;
mod tree;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use kineme::Skeleton;

use crate::error::{FormatError, Place, Result};
use crate::profile::{self, Profile};
use crate::sheet::quoted;
use source::{Sources, Text};

/// Bytes of a model's file at most: the largest robots have some hundred kilobytes.
const LARGEST: u64 = 1 << 26;

/// A robot of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotModel {
    /// Its body. Every joint's frame is the world's in the neutral standing posture: arms hang with the palms to the
    /// thighs, legs are straight. Named as the model.
    pub skeleton: Skeleton,
    /// The model's file.
    pub path: PathBuf,
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
    /// The joint's name in the model.
    pub joint: String,
    /// The engine's coordinate (radians) in the neutral standing posture: the engine's is this plus the pose's.
    pub neutral_rad: f64,
}

/// Reads a robot of an MJCF file. Its profile is the one given, else that of a file of the same stem beside it with the
/// extension `toml`, else a built-in one whose joints are all there; without any, roles are guessed from names.
///
/// # Errors
/// When a file cannot be read or is no MJCF, with the line: a reference to nothing, a number that is none, a joint that
/// is no hinge. When the profile names a joint that is not there.
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

/// Reads a robot of the bytes of an MJCF file; `included` gives those of the files that it includes.
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
    let mut texts = Vec::new();
    for file in includes(&main)? {
        texts.push(Text::of(&file, &included(&file)?)?);
    }
    let files = std::iter::once(&main)
        .chain(&texts)
        .map(|text| Ok((text, text.parse()?)))
        .collect::<Result<_>>()?;
    let sources = Sources { files };
    let tree = tree::tree(&sources)?;
    let title = sources.files[0].1.root_element().attribute("model");
    robot::robot(name, title, tree, profile)
}

/// The files that a model includes, each once as MuJoCo wants it.
fn includes(main: &Text) -> Result<Vec<String>> {
    let document = main.parse()?;
    let mut seen = BTreeSet::new();
    let mut files = Vec::new();
    for node in document.descendants().filter(|n| n.has_tag_name("include")) {
        let line = document.text_pos_at(node.range().start).row as usize;
        let refused = |found: String, expected: &str| {
            FormatError::new(&main.name, Place::Line(line), found, expected)
        };
        let file = node
            .attribute("file")
            .ok_or_else(|| refused("<include> without `file`".into(), "a file"))?;
        if !seen.insert(file) {
            let found = format!("a second include of {}", quoted(file));
            return Err(refused(found, "each file once"));
        }
        files.push(file.to_string());
    }
    Ok(files)
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
            "a model of 64 MiB at most",
        ));
    }
    std::fs::read(path).map_err(unread)
}
