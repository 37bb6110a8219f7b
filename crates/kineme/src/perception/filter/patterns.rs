//! What moments are compared by when certain numbers are unknown: made once, and kept while it comes back.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::emission::Emission;
use super::exact::Exact;
use super::model::Model;
use crate::error::Result;

/// So many are kept beside that for complete observations: some ten megabytes each.
const KEPT: usize = 24;

/// The emission for what is known, for displacements alone, and of the manifold itself.
#[derive(Debug)]
pub(super) struct Known {
    pub all: Emission,
    pub displacements: Emission,
    pub exact: Option<Exact>,
}

impl Known {
    fn of(model: &Model, unknown: &[bool]) -> Result<Self> {
        let still = model.layout.still();
        let hidden = |i: usize| still[i] || unknown.get(i).copied().unwrap_or(false);
        let hidden: Vec<bool> = (0..still.len()).map(hidden).collect();
        Ok(Self {
            all: model.without(unknown)?,
            displacements: model.without(&hidden)?,
            exact: model.exact(unknown)?,
        })
    }
}

/// Those of a model, shared by all its streams.
#[derive(Debug)]
pub(super) struct Patterns {
    complete: Arc<Known>,
    /// The latest first.
    made: Mutex<VecDeque<Arc<Known>>>,
}

impl Patterns {
    pub fn new(model: &Model) -> Result<Self> {
        Ok(Self {
            complete: Arc::new(Known::of(model, &[])?),
            made: Mutex::default(),
        })
    }

    /// Whether complete observations tell by which manner a stream moves.
    pub fn exact(&self) -> bool {
        self.complete.exact.is_some()
    }

    /// What is compared when these numbers are unknown.
    pub fn of(&self, model: &Model, unknown: &[bool]) -> Result<Arc<Known>> {
        if !unknown.contains(&true) {
            return Ok(Arc::clone(&self.complete));
        }
        let made = || self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = again(&mut made(), unknown) {
            return Ok(known);
        }
        // Others go on while it is made.
        let known = Arc::new(Known::of(model, unknown)?);
        let mut made = made();
        made.truncate(KEPT - 1);
        made.push_front(Arc::clone(&known));
        Ok(known)
    }
}

/// What was made for these unknown numbers; it is the latest then.
fn again(made: &mut VecDeque<Arc<Known>>, unknown: &[bool]) -> Option<Arc<Known>> {
    let at = made.iter().position(|k| k.all.unknown == unknown)?;
    let known = made.remove(at)?;
    made.push_front(Arc::clone(&known));
    Some(known)
}
