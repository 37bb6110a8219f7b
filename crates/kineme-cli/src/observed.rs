//! What is observed: motions as a vocabulary's body does them, and streams of joint angles.

use std::io::Read;
use std::sync::Arc;

use kineme::Skeleton;
use kineme::primitive::Observations;
use kineme_formats::input::Entry;
use kineme_formats::tables::observed::ObservedRows;

use crate::failure::{Failure, complain};
use crate::source::Source;

/// What stands for stdin, and for the motion that comes from it.
pub const STREAM: &str = "-";
/// Joints that are named in a note.
const NAMED: usize = 5;

/// A motion as a body does it. In a table of this very body what is missing stays so.
pub fn observe(
    body: &Arc<Skeleton>,
    source: &Source,
    entry: &Entry,
) -> Result<(Observations, Vec<String>), Failure> {
    if let Some(observed) = entry.read_observed(body)? {
        return Ok((observed.seen, observed.warnings));
    }
    let recording = source.read(entry)?;
    let (motion, warnings) = source.retarget(&recording, body)?;
    Ok((Observations::complete(motion), warnings))
}

/// Opens a stream of a body's joint angles, and tells which joints it never shows.
pub fn open_stream<R: Read>(reader: R, body: &Arc<Skeleton>) -> Result<ObservedRows<R>, Failure> {
    let rows = ObservedRows::open(STREAM, reader, body).map_err(|e| {
        Failure::from(e).hint(format!(
            "`kineme convert INPUT - --body {} --to csv` writes such a table; other motions are read from files",
            body.name()
        ))
    })?;
    tell_unseen(&rows.unseen());
    Ok(rows)
}

fn tell_unseen(joints: &[&str]) {
    if joints.is_empty() {
        return;
    }
    let more = match joints.len().saturating_sub(NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let named: Vec<&str> = joints.iter().copied().take(NAMED).collect();
    complain(&format!(
        "note: never seen, for the table has not all their columns: {}{more}",
        named.join(", ")
    ));
}
