//! A stream of joint angles on stdin: every row is answered before the next one is read.

use std::io::stdin;

use kineme::primitive::Recogniser;

use super::told::Teller;
use crate::failure::{Failure, offer};
use crate::observed::{STREAM, open_stream};

/// Answers rows until there are no more, or nobody reads the answers.
pub(super) fn run(recogniser: &dyn Recogniser, teller: &Teller) -> Result<u8, Failure> {
    let mut rows = open_stream(stdin().lock(), recogniser.vocabulary().body())?;
    let mut listener = recogniser.listen();
    if !offer(teller.frames_columns().as_bytes())? {
        return Ok(0);
    }
    let mut since = None;
    while let Some(seen) = rows.next_row()? {
        let reading = listener.hear(&seen)?;
        let times = (*since.get_or_insert(seen.secs), seen.secs);
        if !offer(teller.frame(STREAM, times, &reading)?.as_bytes())? {
            break;
        }
    }
    Ok(0)
}
