//! The built viewer, where there was one when this crate was built.

include!(concat!(env!("OUT_DIR"), "/viewer.rs"));

/// The command that builds the viewer.
pub const HOW_TO_BUILD: &str = "cargo xtask viewer";

/// The script and the style of the viewer, or `None` for a page of still pictures.
pub fn viewer() -> Option<(&'static str, &'static str)> {
    Some((SCRIPT?, STYLE.unwrap_or_default()))
}
