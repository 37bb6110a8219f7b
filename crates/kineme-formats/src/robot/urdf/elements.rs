//! Links and joints, each as its element has it.

use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use roxmltree::Node;

use kineme::skeleton::Range;

use crate::error::{FormatError, Result};
use crate::robot::source::{GREATEST, Sources, XACRO};
use crate::robot::tree::TURN;
use crate::sheet::quoted;

/// A link: a rigid body.
pub struct Link<'a, 't> {
    pub node: Node<'a, 't>,
    pub name: &'a str,
    pub inertial: Option<Inertial>,
}

/// Mass and inertia of a link.
pub struct Inertial {
    /// The centre of mass and the axes of the inertia, in the link's frame, metres.
    pub frame: Isometry3<f64>,
    pub mass_kg: f64,
    /// About the centre of mass, kg m^2.
    pub inertia: Matrix3<f64>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Floating,
    Planar,
}

/// A joint from a link to another. Its frame is that of the child.
pub struct Joint<'a, 't> {
    pub node: Node<'a, 't>,
    pub name: &'a str,
    pub kind: Kind,
    pub parent: &'a str,
    pub child: &'a str,
    /// Its frame in the parent's, metres.
    pub origin: Isometry3<f64>,
    /// In its own frame.
    pub axis: Unit<Vector3<f64>>,
    /// Where it ends, radians or metres; of a continuous joint a turn either way.
    pub range: Range,
    /// What its motor gives at most, N m; none says nothing, zero says that nobody filled it in.
    pub effort: Option<f64>,
    /// N m s a radian.
    pub damping: f64,
    /// N m.
    pub friction: f64,
    pub mimic: Option<Mimic<'a, 't>>,
}

/// That a joint follows another: its coordinate is `multiplier` times the other's and `offset` more.
pub struct Mimic<'a, 't> {
    pub node: Node<'a, 't>,
    pub joint: &'a str,
    pub multiplier: f64,
    pub offset: f64,
}

/// The element's link.
pub fn link<'a, 't>(sources: &Sources<'_>, node: Node<'a, 't>) -> Result<Link<'a, 't>> {
    let name = name(sources, node, "name")?;
    let inertial = child(node, "inertial")
        .map(|node| inertial(sources, node))
        .transpose()?;
    Ok(Link {
        node,
        name,
        inertial,
    })
}

fn inertial(sources: &Sources<'_>, node: Node<'_, '_>) -> Result<Inertial> {
    let mass = needed(sources, node, "mass")?;
    let mass_kg = required(sources, mass, "value")?;
    if mass_kg < 0.0 {
        return Err(sources.error(mass, format!("value = {mass_kg}"), "no less than zero"));
    }
    let tensor = needed(sources, node, "inertia")?;
    let entry = |key| required(sources, tensor, key);
    let [xx, xy, xz] = [entry("ixx")?, entry("ixy")?, entry("ixz")?];
    let [yy, yz, zz] = [entry("iyy")?, entry("iyz")?, entry("izz")?];
    Ok(Inertial {
        frame: origin(sources, node)?,
        mass_kg,
        inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    })
}

/// The element's joint.
pub fn joint<'a, 't>(sources: &Sources<'_>, node: Node<'a, 't>) -> Result<Joint<'a, 't>> {
    let name = name(sources, node, "name")?;
    let kind = match sources.text(node, "type")? {
        "fixed" => Kind::Fixed,
        "revolute" => Kind::Revolute,
        "continuous" => Kind::Continuous,
        "prismatic" => Kind::Prismatic,
        "floating" => Kind::Floating,
        "planar" => Kind::Planar,
        other => {
            let found = format!("a joint of type {}", quoted(other));
            let expected = "revolute, continuous, prismatic, fixed, floating or planar";
            return Err(sources.error(node, found, expected));
        }
    };
    let end = |key: &str| self::name(sources, needed(sources, node, key)?, "link");
    let mut joint = Joint {
        node,
        name,
        kind,
        parent: end("parent")?,
        child: end("child")?,
        origin: origin(sources, node)?,
        axis: Vector3::x_axis(),
        range: Range {
            low: -TURN,
            high: TURN,
        },
        effort: None,
        damping: 0.0,
        friction: 0.0,
        mimic: None,
    };
    // What the others cannot have is not looked at: many a fixed joint has an axis of zeros.
    if !matches!(kind, Kind::Revolute | Kind::Continuous | Kind::Prismatic) {
        return Ok(joint);
    }
    joint.mimic = child(node, "mimic")
        .map(|node| mimic(sources, node))
        .transpose()?;
    if let Some(axis) = child(node, "axis") {
        let xyz = numbers::<3>(sources, axis, "xyz")?.unwrap_or([1.0, 0.0, 0.0]);
        joint.axis = Unit::try_new(Vector3::from(xyz), 1e-9)
            .ok_or_else(|| sources.error(axis, "an axis of no length", "a direction"))?;
    }
    if let Some(dynamics) = child(node, "dynamics") {
        joint.damping = no_less_than_zero(sources, dynamics, "damping")?;
        joint.friction = no_less_than_zero(sources, dynamics, "friction")?;
    }
    let limit = child(node, "limit");
    if let Some(limit) = limit {
        let effort = bound(sources, limit, "effort")?;
        if effort.is_some_and(|e| e < 0.0) {
            let found = format!("effort = {}", effort.unwrap_or_default());
            return Err(sources.error(limit, found, "no less than zero"));
        }
        joint.effort = effort.filter(|e| *e <= GREATEST);
    }
    match limit {
        _ if kind == Kind::Continuous => {}
        Some(limit) => joint.range = range(sources, limit)?,
        // What mimics goes as far as what it mimics.
        None if joint.mimic.is_some() => {}
        None => {
            let found = format!("joint {} without <limit>", quoted(name));
            let expected =
                "<limit lower=\"..\" upper=\"..\"/>, or type continuous for a hinge without an end";
            return Err(sources.error(node, found, expected));
        }
    }
    Ok(joint)
}

/// Where a joint ends; a bound that is left out is zero, one beyond all numbers is a turn beyond the other.
fn range(sources: &Sources<'_>, limit: Node<'_, '_>) -> Result<Range> {
    let [lower, upper] = ["lower", "upper"].map(|key| bound(sources, limit, key));
    let (lower, upper) = (lower?.unwrap_or(0.0), upper?.unwrap_or(0.0));
    if lower > upper {
        let found = format!("lower = {lower}, upper = {upper}");
        return Err(sources.error(limit, found, "lower no greater than upper"));
    }
    Ok(Range {
        low: match lower < -GREATEST {
            true => upper.clamp(-GREATEST, 0.0) - TURN,
            false => lower.min(GREATEST),
        },
        high: match upper > GREATEST {
            true => lower.clamp(0.0, GREATEST) + TURN,
            false => upper.max(-GREATEST),
        },
    })
}

fn mimic<'a, 't>(sources: &Sources<'_>, node: Node<'a, 't>) -> Result<Mimic<'a, 't>> {
    let [multiplier] = numbers(sources, node, "multiplier")?.unwrap_or([1.0]);
    let [offset] = numbers(sources, node, "offset")?.unwrap_or([0.0]);
    Ok(Mimic {
        node,
        joint: name(sources, node, "joint")?,
        multiplier,
        offset,
    })
}

/// The frame that an element's `origin` gives, in that in which the element stands: `rpy` are turns about the axes of
/// that frame, first x, then y, then z.
fn origin(sources: &Sources<'_>, node: Node<'_, '_>) -> Result<Isometry3<f64>> {
    let Some(origin) = child(node, "origin") else {
        return Ok(Isometry3::identity());
    };
    let xyz = numbers::<3>(sources, origin, "xyz")?.unwrap_or_default();
    let rpy = numbers::<3>(sources, origin, "rpy")?;
    let quaternion = numbers::<4>(sources, origin, "quat_xyzw")?;
    let rotation = match (rpy, quaternion) {
        (Some(_), Some(_)) => {
            return Err(sources.error(origin, "rpy and quat_xyzw", "one orientation"));
        }
        (Some([roll, pitch, yaw]), None) => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        (None, Some([x, y, z, w])) => UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9)
            .ok_or_else(|| sources.error(origin, "quat_xyzw of no length", "a rotation"))?,
        (None, None) => UnitQuaternion::identity(),
    };
    Ok(Isometry3::from_parts(Translation3::from(xyz), rotation))
}

/// The first element of this name in an element.
fn child<'a, 't>(node: Node<'a, 't>, tag: &str) -> Option<Node<'a, 't>> {
    node.children().find(|c| c.has_tag_name(tag))
}

/// The same where it must be there.
fn needed<'a, 't>(sources: &Sources<'_>, node: Node<'a, 't>, tag: &str) -> Result<Node<'a, 't>> {
    child(node, tag).ok_or_else(|| {
        let around = node.tag_name().name();
        sources.error(node, format!("<{around}> without <{tag}>"), "one")
    })
}

/// A name, which is neither empty nor an expression of xacro.
fn name<'a>(sources: &Sources<'_>, node: Node<'a, '_>, key: &str) -> Result<&'a str> {
    let text = sources.text(node, key)?;
    if text.trim().is_empty() {
        return Err(sources.error(node, format!("{key} = {}", quoted(text)), "a name"));
    }
    if expression(text) {
        return Err(sources.error(node, format!("{key} = {}", quoted(text)), XACRO));
    }
    Ok(text)
}

/// Whether a text has a place where xacro would put something in.
fn expression(text: &str) -> bool {
    text.contains("${") || text.contains("$(")
}

/// The numbers of an attribute, if it is there.
fn numbers<const N: usize>(
    sources: &Sources<'_>,
    node: Node<'_, '_>,
    key: &str,
) -> Result<Option<[f64; N]>> {
    let xacro = node.attribute(key).is_some_and(expression);
    sources.optional(node, key).map_err(|error| match xacro {
        true => FormatError {
            expected: XACRO.into(),
            ..error
        },
        false => error,
    })
}

/// A number that must be there.
fn required(sources: &Sources<'_>, node: Node<'_, '_>, key: &str) -> Result<f64> {
    sources.text(node, key)?;
    Ok(numbers(sources, node, key)?.map_or(0.0, |[x]| x))
}

/// A number that is zero where it is not there.
fn no_less_than_zero(sources: &Sources<'_>, node: Node<'_, '_>, key: &str) -> Result<f64> {
    let [value] = numbers(sources, node, key)?.unwrap_or([0.0]);
    match value < 0.0 {
        true => Err(sources.error(node, format!("{key} = {value}"), "no less than zero")),
        false => Ok(value),
    }
}

/// A bound, which may be infinite: files write 1e16 or inf where there is none.
fn bound(sources: &Sources<'_>, node: Node<'_, '_>, key: &str) -> Result<Option<f64>> {
    let text = node.attribute(key).unwrap_or_default();
    match text.trim().parse::<f64>() {
        Ok(value) if !value.is_nan() => Ok(Some(value)),
        _ => Ok(numbers(sources, node, key)?.map(|[x]| x)),
    }
}
