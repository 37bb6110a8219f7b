//! MJCF, the XML of MuJoCo.

mod source;
mod worldbody;

use std::collections::BTreeSet;

use roxmltree::Document;

use super::source::{Sources, Text};
use super::tree::Tree;
use crate::error::{FormatError, Place, Result};
use crate::sheet::quoted;

/// The bodies and hinges of a model; `included` gives the bytes of the files that it includes.
///
/// # Errors
/// As [`super::read`].
pub fn tree<'t>(
    main: &'t Text,
    document: Document<'t>,
    included: &dyn Fn(&str) -> Result<Vec<u8>>,
) -> Result<Tree> {
    let mut texts = Vec::new();
    for file in includes(main, &document)? {
        texts.push(Text::of(&file, &included(&file)?)?);
    }
    let mut files = vec![(main, document)];
    for text in &texts {
        files.push((text, text.parse()?));
    }
    worldbody::tree(&Sources { files })
}

/// The files that a model includes, each once as MuJoCo wants it.
fn includes(main: &Text, document: &Document<'_>) -> Result<Vec<String>> {
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
