//! A stream of joint angles on stdin: every row is answered before the next one is read.

use std::io::stdin;

use kineme::primitive::Recogniser;
use kineme_formats::tables::observed::ObservedRows;

use super::told::Teller;
use crate::failure::{Failure, complain, offer};

/// What stands for the motion of a stream.
const NAME: &str = "-";
/// Joints that are named in a note.
const NAMED: usize = 5;

/// Answers rows until there are no more, or nobody reads the answers.
pub(super) fn run(recogniser: &dyn Recogniser, teller: &Teller) -> Result<u8, Failure> {
    let body = recogniser.vocabulary().body();
    let mut rows = ObservedRows::open(NAME, stdin().lock(), body).map_err(|e| {
        Failure::from(e).hint(format!(
            "`kineme convert INPUT - --body {} --to csv` writes such a table; other motions are read from files",
            body.name()
        ))
    })?;
    tell_unseen(&rows.unseen());
    let mut listener = recogniser.listen();
    if !offer(teller.frames_columns().as_bytes())? {
        return Ok(0);
    }
    let mut since = None;
    while let Some(seen) = rows.next_row()? {
        let reading = listener.hear(&seen)?;
        let times = (*since.get_or_insert(seen.secs), seen.secs);
        if !offer(teller.frame(NAME, times, &reading)?.as_bytes())? {
            break;
        }
    }
    Ok(0)
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
