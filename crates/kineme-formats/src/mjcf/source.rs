//! The XML of a model and of the files that it includes, and the numbers in it.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use kineme::math::rotation::{Axis, shortest};

use crate::error::{FormatError, Place, Result};
use crate::sheet::quoted;

/// Elements of a model at most: the largest robots have some thousand.
const ELEMENTS: u32 = 1_000_000;

/// The greatest number (metres, radians, degrees, kilograms) that a model can mean.
const GREATEST: f64 = 1e9;

/// A file of a model: its name, and its text.
pub struct Text {
    pub name: String,
    pub text: String,
}

impl Text {
    /// The text of a file's bytes.
    pub fn of(name: &str, bytes: &[u8]) -> Result<Self> {
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let place = Place::Byte(e.valid_up_to());
            FormatError::new(name, place, "bytes that are no text", "XML in UTF-8")
        })?;
        Ok(Self {
            name: name.into(),
            text: text.into(),
        })
    }

    /// The document in it.
    pub fn parse(&self) -> Result<Document<'_>> {
        let options = ParsingOptions {
            allow_dtd: false,
            nodes_limit: ELEMENTS,
            ..ParsingOptions::default()
        };
        Document::parse_with_options(&self.text, options).map_err(|e| {
            let place = Place::Line(e.pos().row as usize);
            FormatError::new(&self.name, place, e.to_string(), "XML")
        })
    }
}

/// The documents of a model: the first is the model, the others are what it includes.
pub struct Sources<'t> {
    pub files: Vec<(&'t Text, Document<'t>)>,
}

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

    /// An error at an element.
    pub fn error(
        &self,
        node: Node<'_, '_>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> FormatError {
        let start = node.range().start;
        let file = self
            .files
            .iter()
            .find(|(_, document)| std::ptr::eq(document, node.document()));
        let name = file.map_or("", |(text, _)| text.name.as_str());
        let line = file.map_or(0, |(_, d)| d.text_pos_at(start).row as usize);
        FormatError::new(name, Place::Line(line), found, expected)
    }

    /// An attribute that must be there.
    pub fn text<'a>(&self, node: Node<'a, '_>, key: &str) -> Result<&'a str> {
        node.attribute(key).ok_or_else(|| {
            let tag = node.tag_name().name();
            self.error(node, format!("<{tag}> without `{key}`"), "one")
        })
    }

    /// The numbers of an attribute's text, finite and as many as asked for.
    pub fn numbers<const N: usize>(
        &self,
        node: Node<'_, '_>,
        key: &str,
        text: &str,
    ) -> Result<[f64; N]> {
        let numbers: Option<Vec<f64>> = text
            .split_ascii_whitespace()
            .map(|word| word.parse::<f64>().ok().filter(|x| x.abs() <= GREATEST))
            .collect();
        numbers
            .and_then(|n| <[f64; N]>::try_from(n).ok())
            .ok_or_else(|| {
                let plural = if N == 1 { "" } else { "s" };
                let expected = format!("{N} finite number{plural}");
                self.error(node, format!("{key} = {}", quoted(text)), expected)
            })
    }

    /// The numbers of an attribute, if it is there.
    pub fn optional<const N: usize>(
        &self,
        node: Node<'_, '_>,
        key: &str,
    ) -> Result<Option<[f64; N]>> {
        node.attribute(key)
            .map(|text| self.numbers(node, key, text))
            .transpose()
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
