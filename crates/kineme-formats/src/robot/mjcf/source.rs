//! What MJCF says in ways of its own: includes, angles and their unit, orientations.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use kineme::math::rotation::{Axis, shortest};

use crate::error::Result;
use crate::robot::source::Sources;
use crate::sheet::quoted;

/// How a model writes angles and where limits come from: its `compiler`.
#[derive(Debug, Clone)]
pub struct Compiler {
    /// Radians in the unit of an angle.
    pub unit: f64,
    /// The axes of Euler angles; capitals turn about axes that stay.
    pub sequence: [char; 3],
    /// Whether a range means that there is a limit.
    pub autolimits: bool,
}

impl Default for Compiler {
    fn default() -> Self {
        Self {
            unit: 1f64.to_radians(),
            sequence: ['x', 'y', 'z'],
            autolimits: true,
        }
    }
}

impl<'t> Sources<'t> {
    /// The elements in an element, those of included files in place of the `include`.
    pub fn children<'a>(&'a self, node: Node<'a, 't>) -> Result<Vec<Node<'a, 't>>> {
        let mut children = Vec::new();
        for child in node.children().filter(Node::is_element) {
            if !child.has_tag_name("include") {
                children.push(child);
                continue;
            }
            let name = self.text(child, "file")?;
            let found = self.files[1..].iter().find(|(text, _)| text.name == name);
            let inside = std::ptr::eq(child.document(), &self.files[0].1);
            match found {
                Some((_, document)) if inside => {
                    let elements = document.root_element().children();
                    children.extend(elements.filter(Node::is_element));
                }
                _ => {
                    let found = format!("an include of {} in an included file", quoted(name));
                    return Err(self.error(child, found, "includes one deep"));
                }
            }
        }
        Ok(children)
    }

    /// The place of an element, metres; zero where it has none.
    pub fn position(&self, node: Node<'_, '_>) -> Result<Vector3<f64>> {
        Ok(self
            .optional::<3>(node, "pos")?
            .map_or(Vector3::zeros(), Vector3::from))
    }

    /// The orientation of an element, by whichever attribute gives it; none is none.
    pub fn orientation(
        &self,
        node: Node<'_, '_>,
        compiler: &Compiler,
    ) -> Result<UnitQuaternion<f64>> {
        const WAYS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
        let given: Vec<&str> = WAYS
            .into_iter()
            .filter(|k| node.has_attribute(*k))
            .collect();
        if given.len() > 1 {
            return Err(self.error(node, given.join(" and "), "one orientation"));
        }
        let direction = |key: &str, v: [f64; 3]| {
            Vector3::from(v)
                .try_normalize(1e-9)
                .ok_or_else(|| self.error(node, format!("{key} of no length"), "a direction"))
        };
        if let Some(q) = self.optional::<4>(node, "quat")? {
            let q = nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]);
            return UnitQuaternion::try_new(q, 1e-9)
                .ok_or_else(|| self.error(node, "quat of no length", "a rotation"));
        }
        if let Some([x, y, z, angle]) = self.optional::<4>(node, "axisangle")? {
            let axis = direction("axisangle", [x, y, z])?;
            return Ok(UnitQuaternion::from_scaled_axis(
                axis * (angle * compiler.unit),
            ));
        }
        if let Some(angles) = self.optional::<3>(node, "euler")? {
            let turns = compiler.sequence.iter().zip(angles);
            return Ok(
                turns.fold(UnitQuaternion::identity(), |before, (letter, angle)| {
                    let axis = match letter.to_ascii_lowercase() {
                        'x' => Axis::X,
                        'y' => Axis::Y,
                        _ => Axis::Z,
                    };
                    let turn = axis.turn(angle * compiler.unit);
                    match letter.is_ascii_lowercase() {
                        true => before * turn,
                        false => turn * before,
                    }
                }),
            );
        }
        if let Some([a, b, c, d, e, f]) = self.optional::<6>(node, "xyaxes")? {
            let x = direction("xyaxes", [a, b, c])?;
            let y = Vector3::new(d, e, f);
            let y = direction("xyaxes", (y - x * x.dot(&y)).into())?;
            let turn = Matrix3::from_columns(&[x, y, x.cross(&y)]);
            return Ok(UnitQuaternion::from_rotation_matrix(
                &Rotation3::from_matrix_unchecked(turn),
            ));
        }
        match self.optional::<3>(node, "zaxis")? {
            Some(z) => Ok(shortest(&Vector3::z(), &direction("zaxis", z)?)),
            None => Ok(UnitQuaternion::identity()),
        }
    }
}
