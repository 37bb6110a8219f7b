//! JSON on stdout.

use serde::{Serialize, Serializer};

use crate::failure::Failure;

/// An object whose keys keep their order.
pub struct InOrder<T>(pub Vec<(String, T)>);

impl<T: Serialize> Serialize for InOrder<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

/// A value as a line of its own.
pub fn line<T: Serialize>(value: &T) -> Result<String, Failure> {
    let text = serde_json::to_string(value);
    let text = text.map_err(|e| Failure::failed(format!("the results as JSON: {e}")))?;
    Ok(text + "\n")
}
