//! The bodies that `--body` names: built-in ones, and robots of MJCF and URDF files.

use std::path::Path;
use std::sync::Arc;

use kineme::Skeleton;
use kineme_formats::robot::{self, RobotModel};

use crate::failure::{Failure, complain};

/// Whether a name is that of a robot's file.
pub fn is_robot(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    let known = [".xml", ".mjcf", ".urdf", ".xacro"];
    known.iter().any(|end| lower.ends_with(end))
}

/// The built-in body of this name: what vocabularies are of.
pub fn built_in(name: &str) -> Result<Arc<Skeleton>, Failure> {
    if is_robot(name) {
        return Err(Failure::usage(format!(
            "`{name}`: a vocabulary's file knows its body by name, so it is of a built-in body, not of a robot's file"
        ))
        .hint("--body ares or --body adonis; `convert` takes robots"));
    }
    let skeleton = kineme::body(name).map_err(|e| Failure::usage(e.to_string()))?;
    Ok(Arc::new(skeleton))
}

/// The built-in body of this name, or the robot of this file.
pub fn any(name: &str) -> Result<Arc<Skeleton>, Failure> {
    if is_robot(name) {
        return Ok(Arc::new(robot(name)?.skeleton));
    }
    built_in(name)
}

/// The robot of a file; tells what was passed over, and where its roles come from when they were guessed.
pub fn robot(name: &str) -> Result<RobotModel, Failure> {
    let robot = robot::read(Path::new(name), None)?;
    for warning in &robot.warnings {
        complain(&format!("note: {name}: {warning}"));
    }
    if robot.profile == "guessed" {
        let joints = robot.skeleton.joints().iter();
        let parts = joints.filter_map(|j| Some(format!("{} {}", j.role?.name(), j.name)));
        let parts: Vec<String> = parts.collect();
        complain(&format!(
            "note: {name}: parts guessed from names ({}); a profile beside it, of the same name with .toml, says them",
            parts.join(", ")
        ));
    }
    Ok(robot)
}
