//! The answer that looks at nothing.

use super::features::{LastSeen, check_body};
use super::{some_primitives, whole};
use crate::error::Result;
use crate::primitive::{
    Listener, Observation, Observations, Posterior, Reading, Recogniser, Recognition, Vocabulary,
};

/// Always the primitive of most exemplars, of equal ones the first; as probable as it is common among them.
#[derive(Debug, Clone)]
pub struct Constant<'a> {
    vocabulary: &'a Vocabulary,
    posterior: Posterior,
}

impl<'a> Constant<'a> {
    /// The commonest answer of a vocabulary.
    ///
    /// # Errors
    /// When the vocabulary has no primitives.
    pub fn new(vocabulary: &'a Vocabulary) -> Result<Self> {
        some_primitives(vocabulary)?;
        let counts = vocabulary.primitives().iter().map(|p| p.exemplars().len());
        let all: usize = counts.clone().sum();
        Ok(Self {
            vocabulary,
            posterior: Posterior {
                primitives: counts.map(|n| n as f64 / all as f64).collect(),
                rest: 0.0,
                none: 0.0,
            },
        })
    }
}

impl Recogniser for Constant<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Unmoved {
            posterior: &self.posterior,
            last: LastSeen::new(self.vocabulary.body()),
        })
    }

    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        check_body(self.vocabulary.body(), seen)?;
        let leading = self.posterior.leading();
        let parameters = leading.map(|(i, _)| self.vocabulary.primitives()[i].middle());
        let posterior = self.posterior.clone();
        Ok(whole(seen, posterior, parameters.unwrap_or_default(), 0.0))
    }
}

/// Hears and does not listen.
struct Unmoved<'a> {
    posterior: &'a Posterior,
    last: LastSeen,
}

impl Listener for Unmoved<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        self.last.see(seen)?;
        Ok(Reading {
            posterior: self.posterior.clone(),
            place: None,
            novelty: 0.0,
        })
    }
}
