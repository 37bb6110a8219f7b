//! What the body watches: a recording, or a stream of joint angles on stdin.

use std::io::{Read, stdin};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indicatif::ProgressBar;
use kineme::Skeleton;
use kineme::interaction::Session;
use kineme::primitive::Observations;
use kineme_formats::tables::observed::ObservedRows;

use super::{alone, show};
use crate::args::{ControlArgs, ReadArgs};
use crate::failure::Failure;
use crate::observed::{STREAM, observe, open_stream};
use crate::source::{Source, print_warnings};

/// What is watched.
pub enum Watched {
    /// All of it is there.
    Recording(Observations),
    /// It comes row by row.
    Stream,
}

impl Watched {
    /// What the command line names, else what the plan does; files of a plan lie beside it.
    pub fn asked(
        args: &ControlArgs,
        observed: Option<&str>,
        body: &Arc<Skeleton>,
    ) -> Result<Option<Self>, Failure> {
        let beside = |file: &str| match file {
            STREAM => PathBuf::from(STREAM),
            _ => args.plan.parent().unwrap_or(Path::new("")).join(file),
        };
        let Some(path) = args.watch.clone().or_else(|| observed.map(beside)) else {
            return Ok(None);
        };
        if path.as_os_str() == STREAM {
            let taken = [&args.vocabulary, &args.plan];
            if taken.iter().any(|p| p.as_os_str() == STREAM) {
                return Err(Failure::usage("stdin holds one thing, and that is watched"));
            }
            return Ok(Some(Self::Stream));
        }
        Ok(Some(Self::Recording(recording(&path, &args.read, body)?)))
    }

    /// Runs the session to its end while it watches.
    pub fn run(
        &self,
        session: &mut Session<'_>,
        body: &Arc<Skeleton>,
        bar: &ProgressBar,
    ) -> Result<(), Failure> {
        match self {
            Self::Recording(seen) => alone(session, Some(seen), bar),
            Self::Stream => stream(&mut open_stream(stdin().lock(), body)?, session, bar),
        }
    }
}

/// Rows lead: the body has moved up to a row's time before it sees it. When no more come it goes on by itself.
fn stream<R: Read>(
    rows: &mut ObservedRows<R>,
    session: &mut Session<'_>,
    bar: &ProgressBar,
) -> Result<(), Failure> {
    let mut first = None;
    while let Some(mut seen) = rows.next_row()? {
        seen.secs -= *first.get_or_insert(seen.secs);
        until(session, seen.secs, bar)?;
        if session.finished() {
            return Ok(());
        }
        session.observe(&seen)?;
    }
    alone(session, None, bar)
}

fn until(session: &mut Session<'_>, secs: f64, bar: &ProgressBar) -> Result<(), Failure> {
    while !session.finished() && session.secs() < secs {
        session.tick()?;
        show(session.secs(), bar);
    }
    Ok(())
}

fn recording(path: &Path, args: &ReadArgs, body: &Arc<Skeleton>) -> Result<Observations, Failure> {
    let (source, mut entries) = Source::one_by_one(&[(path.to_path_buf(), None)], args)?;
    // One path leads to one entry, or to why there is none.
    let entry = entries.swap_remove(0)?;
    let (seen, warnings) = observe(body, &source, &entry)?;
    print_warnings([(entry.name(), warnings.as_slice())]);
    Ok(seen)
}
