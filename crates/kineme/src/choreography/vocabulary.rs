//! From a script to a vocabulary: its exemplars performed, and learned primitive by primitive.

use std::sync::Arc;

use rayon::prelude::*;

use super::perform::perform;
use super::script::{Script, ScriptExemplar};
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::primitive::{Exemplar, Modelling, Primitive, Transitions, Vocabulary};
use crate::skeleton::Skeleton;

/// Frames a second at which scripts are performed: what optical motion capture records.
pub const PERFORMED_HZ: f64 = 120.0;

impl Script {
    /// The vocabulary of the script's exemplars on `body`; primitives in the order in which they first appear, their
    /// parameters the adverbs that the exemplars name. `source` is the script's file, with the BLAKE3 of its bytes.
    ///
    /// # Errors
    /// When the script is invalid or has no exemplar, the body lacks a part that a key names, or exemplars make no primitive.
    pub fn vocabulary(
        &self,
        body: &Arc<Skeleton>,
        modelling: &Modelling,
        source: (&str, Option<&str>),
    ) -> Result<Vocabulary> {
        self.validate()?;
        let mut names: Vec<&str> = Vec::new();
        for e in &self.exemplars {
            if !names.contains(&e.primitive.as_str()) {
                names.push(&e.primitive);
            }
        }
        if names.is_empty() {
            return Err(Error::unsupported(
                "the script has animations only: a vocabulary needs exemplars",
            ));
        }
        let primitives = names
            .par_iter()
            .map(|name| self.primitive(name, body, modelling, source))
            .collect::<Result<Vec<_>>>()?;
        let transitions = Transitions::none(primitives.len());
        Vocabulary::new(Arc::clone(body), primitives, Vec::new(), transitions)
    }

    /// Every exemplar and animation as a motion of `body`, in the order written; exemplars are named after their
    /// primitive and counted.
    ///
    /// # Errors
    /// When the body lacks a part that a key names.
    pub fn motions(&self, body: &Arc<Skeleton>) -> Result<Vec<Motion>> {
        let exemplars = self.exemplars.iter().map(|e| {
            let name = format!("{}-{}", e.primitive, self.number(e));
            perform(&name, &e.keys, body, PERFORMED_HZ)
        });
        let animations = self
            .animations
            .iter()
            .map(|a| perform(&a.name, &a.keys, body, PERFORMED_HZ));
        exemplars.chain(animations).collect()
    }

    /// The number of an exemplar among those of its primitive, from 1.
    fn number(&self, exemplar: &ScriptExemplar) -> usize {
        let alike = self
            .exemplars
            .iter()
            .filter(|e| e.primitive == exemplar.primitive);
        1 + alike.take_while(|e| !std::ptr::eq(*e, exemplar)).count()
    }

    fn primitive(
        &self,
        name: &str,
        body: &Arc<Skeleton>,
        modelling: &Modelling,
        (file, blake3): (&str, Option<&str>),
    ) -> Result<Primitive> {
        let own: Vec<&ScriptExemplar> = self
            .exemplars
            .iter()
            .filter(|e| e.primitive == name)
            .collect();
        let exemplars = own.iter().enumerate().map(|(i, e)| {
            let motion = perform(
                &format!("{file}/{name}-{}", i + 1),
                &e.keys,
                body,
                PERFORMED_HZ,
            )?;
            let adverbs: Vec<f64> = e.parameters.values().copied().collect();
            let adverbs = (!adverbs.is_empty()).then_some(adverbs);
            let mut exemplar = Exemplar::whole(motion, adverbs);
            exemplar.provenance.blake3 = blake3.map(String::from);
            Ok(exemplar)
        });
        let exemplars = exemplars.collect::<Result<Vec<_>>>()?;
        let modelling = Modelling {
            adverbs: own[0].parameters.keys().cloned().collect(),
            ..modelling.clone()
        };
        Primitive::learn(name, exemplars, &modelling)
    }
}
