//! Profiles: which joints of a skeleton or robot play which role, as TOML.

use std::collections::BTreeMap;

use kineme::Role;
use kineme::math::rotation::Axis;

use crate::document::{Document, Value};
use crate::error::Result;

/// How a family of skeletons names its joints, and its axes and unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The profile's name.
    pub name: String,
    /// The upward axis, y or z; `None` leaves it to the reader of the motion.
    pub up: Option<Axis>,
    /// Metres a unit of length; `None` leaves it to the reader of the motion.
    pub unit_metres: Option<f64>,
    /// For each role the joint that plays it, or the hinges that do together, from the body outwards.
    pub roles: BTreeMap<Role, Vec<String>>,
}

/// Reads a profile.
///
/// # Errors
/// When the text is no TOML, a key or role is unknown, a value has the wrong type, the name or all roles are
/// missing, the unit is not positive, or a joint plays two roles.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Profile> {
    let (doc, root) = Document::open(name, bytes)?;
    let table = root.get_ref();
    doc.only(table, &["name", "up", "unit_metres", "roles"])?;
    let profile_name = doc.name(doc.required(table, root.span(), "name")?)?;
    let up = table.get("up").map(|v| up_axis(&doc, v)).transpose()?;
    let unit_metres = table
        .get("unit_metres")
        .map(|value| match doc.number(value)? {
            unit if unit > 0.0 => Ok(unit),
            unit => Err(doc.error(
                value.span(),
                unit.to_string(),
                "a positive number of metres",
            )),
        })
        .transpose()?;

    let listed = doc.required(table, root.span(), "roles")?;
    let mut roles = BTreeMap::new();
    let mut role_of: BTreeMap<String, Role> = BTreeMap::new();
    for (key, value) in doc.table(listed)? {
        let role = Role::parse(key.get_ref())
            .map_err(|e| doc.error(key.span(), e.to_string(), "a role"))?;
        let joints = joints(&doc, value)?;
        for joint in &joints {
            if let Some(other) = role_of.insert(joint.clone(), role) {
                let found = format!("joint `{joint}`, which `{}` has too", other.name());
                return Err(doc.error(value.span(), found, "one role a joint"));
            }
        }
        roles.insert(role, joints);
    }
    if roles.is_empty() {
        return Err(doc.error(listed.span(), "no role", "at least one role"));
    }
    Ok(Profile {
        name: profile_name.to_string(),
        up,
        unit_metres,
        roles,
    })
}

fn up_axis(doc: &Document<'_>, value: &Value<'_>) -> Result<Axis> {
    match doc.name(value)? {
        "y" => Ok(Axis::Y),
        "z" => Ok(Axis::Z),
        other => Err(doc.error(value.span(), format!("`{other}`"), "\"y\" or \"z\"")),
    }
}

fn joints(doc: &Document<'_>, value: &Value<'_>) -> Result<Vec<String>> {
    if value.get_ref().is_str() {
        return Ok(vec![doc.name(value)?.to_string()]);
    }
    let names = doc
        .array(value)?
        .map(|v| doc.name(v).map(str::to_string))
        .collect::<Result<Vec<_>>>()?;
    if names.is_empty() {
        return Err(doc.error(
            value.span(),
            "no joint",
            "a joint's name, or a list of hinges",
        ));
    }
    Ok(names)
}
