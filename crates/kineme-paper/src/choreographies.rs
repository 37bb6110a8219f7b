//! The vocabularies of `choreography/`, embedded.

use std::sync::Arc;

use kineme::primitive::{Modelling, Transitions};
use kineme::{Skeleton, Vocabulary};

use crate::sets::Result;

/// The five vocabularies of the paper's movements, by name.
pub const SCRIPTS: [(&str, &str); 5] = [
    ("boxing", include_str!("../../../choreography/boxing.toml")),
    (
        "punching",
        include_str!("../../../choreography/punching.toml"),
    ),
    (
        "vertical-waving",
        include_str!("../../../choreography/vertical-waving.toml"),
    ),
    (
        "horizontal-waving",
        include_str!("../../../choreography/horizontal-waving.toml"),
    ),
    ("twist", include_str!("../../../choreography/twist.toml")),
];

/// How people greet: waves of the forearm, and of the arm as a pendulum on its head. It belongs to the set of horizontal
/// waving where people's waves are judged. The paper has no such movement.
pub const GREETING: (&str, &str) = (
    "greeting",
    include_str!("../../../choreography/greeting.toml"),
);

/// One of them on a body.
///
/// # Errors
/// Never for the embedded scripts on a built-in body.
pub fn choreography(name: &str, text: &str, body: &Arc<Skeleton>) -> Result<Vocabulary> {
    let file = format!("{name}.toml");
    let script = kineme_formats::script::parse(&file, text.as_bytes())?;
    Ok(script.vocabulary(body, &Modelling::default(), (&file, None))?)
}

/// The primitives of the paper's movements as one vocabulary.
///
/// # Errors
/// Never for the embedded scripts on a built-in body.
pub fn everything(body: &Arc<Skeleton>) -> Result<Vocabulary> {
    let mut primitives = Vec::new();
    for (name, text) in SCRIPTS {
        primitives.extend_from_slice(choreography(name, text, body)?.primitives());
    }
    let transitions = Transitions::none(primitives.len());
    Ok(Vocabulary::new(
        Arc::clone(body),
        primitives,
        Vec::new(),
        transitions,
    )?)
}
