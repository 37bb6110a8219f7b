//! The robot of a URDF as MJCF: bodies, hinges and inertias without shapes, for an engine that has not its meshes.

use std::fmt::Write as _;

use nalgebra::Vector3;

use super::elements::{Joint, Kind};
use super::inertia::{LEAST_MASS, Principal};
use super::still::listed;
use crate::robot::tree::{Body, Hinge, Tree};

/// What a file says of a hinge besides where it is.
pub struct Drive {
    /// Whether its range is one that it ends at.
    limited: bool,
    /// N m.
    effort: Option<f64>,
    /// N m s a radian.
    damping: f64,
    /// N m.
    friction: f64,
}

impl Drive {
    pub fn of(joint: &Joint<'_, '_>) -> Self {
        Self {
            limited: joint.kind == Kind::Revolute,
            effort: joint.effort,
            damping: joint.damping,
            friction: joint.friction,
        }
    }
}

/// What an engine is told that a body weighs.
struct Mass {
    mass_kg: f64,
    center: Vector3<f64>,
    principal: Principal,
}

/// The robot as MJCF, and what there was to put right. `drives` has one for each hinge, in the order of the bodies.
/// Bodies stand as they are at rest, their frames along the world's axes.
pub fn write(tree: &Tree, drives: &[Drive]) -> (String, Vec<String>) {
    let (masses, mut doubts) = masses(&tree.bodies);
    let mut text = format!(
        "<mujoco model=\"{}\">\n<compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\"/>\n<worldbody>\n",
        escaped(tree.title.as_deref().unwrap_or("robot"))
    );
    let mut drives = drives.iter();
    let mut idle: Vec<&str> = Vec::new();
    // The bodies around the present one, those whose end is still to be written.
    let mut around: Vec<usize> = Vec::new();
    for (k, (body, mass)) in tree.bodies.iter().zip(&masses).enumerate() {
        while around.last().is_some_and(|last| body.parent != Some(*last)) {
            around.pop();
            text.push_str("</body>\n");
        }
        around.push(k);
        let origin = body
            .parent
            .map_or(Vector3::zeros(), |p| tree.bodies[p].position);
        let place = numbers((body.position - origin).as_slice());
        let _ = writeln!(
            text,
            "<body name=\"{}\" pos=\"{place}\">",
            escaped(&body.name)
        );
        if let Some(mass) = mass {
            write_mass(&mut text, mass, body);
        }
        for (hinge, drive) in body.hinges.iter().zip(drives.by_ref()) {
            if drive.effort == Some(0.0) {
                idle.push(&hinge.name);
            }
            write_hinge(&mut text, hinge, drive);
        }
    }
    text.push_str(&"</body>\n".repeat(around.len()));
    text.push_str("</worldbody>\n</mujoco>\n");
    if !idle.is_empty() {
        doubts.push(format!(
            "joints with an effort of 0, taken for no limit of torque: {}",
            listed(&idle)
        ));
    }
    (text, doubts)
}

fn write_mass(text: &mut String, mass: &Mass, body: &Body) {
    let q = mass.principal.axes.quaternion();
    let _ = writeln!(
        text,
        "<inertial pos=\"{}\" quat=\"{}\" mass=\"{}\" diaginertia=\"{}\"/>",
        numbers((mass.center - body.position).as_slice()),
        numbers(&[q.w, q.i, q.j, q.k]),
        mass.mass_kg,
        numbers(&mass.principal.moments)
    );
}

fn write_hinge(text: &mut String, hinge: &Hinge, drive: &Drive) {
    let name = escaped(&hinge.name);
    let axis = numbers(hinge.axis.as_slice());
    let _ = write!(text, "<joint name=\"{name}\" axis=\"{axis}\"");
    if drive.limited {
        let _ = write!(text, " range=\"{} {}\"", hinge.range.low, hinge.range.high);
    }
    if let Some(effort) = drive.effort.filter(|effort| *effort > 0.0) {
        let _ = write!(text, " actuatorfrcrange=\"{} {effort}\"", -effort);
    }
    for (key, value) in [("damping", drive.damping), ("frictionloss", drive.friction)] {
        if value > 0.0 {
            let _ = write!(text, " {key}=\"{value}\"");
        }
    }
    text.push_str("/>\n");
}

/// What each body weighs, so that an engine takes it, and what was put right for that.
///
/// What a hinge moves must resist it: the body itself, or one that is fixed to it. Where none does, as between the
/// hinges of one shoulder whose links the file gives no mass, the body has next to none.
fn masses(bodies: &[Body]) -> (Vec<Option<Mass>>, Vec<String>) {
    let (mut light, mut odd): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    let mut masses: Vec<Option<Mass>> = Vec::with_capacity(bodies.len());
    for body in bodies {
        masses.push(
            body.inertial
                .as_ref()
                .and_then(|(mass_kg, center, inertia)| {
                    let principal = Principal::of(inertia)?;
                    if !principal.is_possible() {
                        odd.push(&body.name);
                    }
                    Some(Mass {
                        mass_kg: *mass_kg,
                        center: *center,
                        principal: principal.possible(),
                    })
                }),
        );
    }
    let resists = |m: &Mass| m.mass_kg >= LEAST_MASS && m.principal.resists();
    let mut firm: Vec<bool> = masses
        .iter()
        .map(|m| m.as_ref().is_some_and(resists))
        .collect();
    for k in (0..bodies.len()).rev() {
        match (bodies[k].parent, bodies[k].hinges.is_empty()) {
            (Some(parent), true) => firm[parent] |= firm[k],
            (_, true) => {}
            (_, false) if firm[k] => {}
            (_, false) => {
                light.push(&bodies[k].name);
                masses[k] = Some(least(masses[k].take(), &bodies[k]));
            }
        }
    }
    light.reverse();
    let notes = [
        (
            light,
            "in physics links that move without a mass or an inertia have next to none",
        ),
        (
            odd,
            "in physics an inertia that no body can have is the nearest that one can",
        ),
    ];
    let notes = notes.into_iter().filter(|(names, _)| !names.is_empty());
    let notes = notes.map(|(names, what)| format!("{what}: {}", listed(&names)));
    (masses, notes.collect())
}

/// A mass with at least what an engine asks for.
fn least(mass: Option<Mass>, body: &Body) -> Mass {
    let (mass_kg, center, principal) = match mass {
        Some(mass) => (mass.mass_kg, mass.center, mass.principal),
        None => (0.0, body.position, Principal::none()),
    };
    Mass {
        mass_kg: mass_kg.max(LEAST_MASS),
        center,
        principal: principal.resisting(),
    }
}

fn numbers(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(f64::to_string).collect();
    words.join(" ")
}

/// A text as the value of an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' | '\n' | '\r' => {
                let _ = write!(escaped, "&#{};", c as u32);
            }
            _ => escaped.push(c),
        }
    }
    escaped
}
