//! The XML of a robot's file and of the files that it includes, and the numbers in it.

use roxmltree::{Document, Error, Node, ParsingOptions};

use crate::error::{FormatError, Place, Result};
use crate::sheet::quoted;

/// Elements of a file at most: the largest robots have some thousand.
const ELEMENTS: u32 = 1_000_000;

/// The greatest number (metres, radians, degrees, kilograms) that a robot's file can mean.
pub const GREATEST: f64 = 1e9;

/// What to do about a file of macros.
pub const XACRO: &str = "a URDF without macros: run xacro on the file and read what it writes";

/// A file of a robot: its name, and its text.
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
            match &e {
                // Macros whose namespace is not declared, as in a file that xacro would include.
                Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
                    FormatError::new(&self.name, place, "a macro of xacro", XACRO)
                }
                _ => FormatError::new(&self.name, place, e.to_string(), "XML"),
            }
        })
    }
}

/// The documents of a robot: the first is its file, the others are what that includes.
pub struct Sources<'t> {
    pub files: Vec<(&'t Text, Document<'t>)>,
}

impl Sources<'_> {
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
}
