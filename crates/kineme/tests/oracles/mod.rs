//! Reference values from other libraries, read where they are at hand.

use std::path::PathBuf;

use serde_json::Value;

/// The oracle file `name`; `None`, said aloud, where it is absent.
pub fn oracle(name: &str) -> Option<Value> {
    let data = std::env::var_os("KINEME_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let path = data.join("../oracles").join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: no oracle {name}");
        return None;
    };
    Some(serde_json::from_str(&text).expect("an oracle is JSON"))
}

/// The numbers of an array, nested ones one after the other.
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}
