//! [`Filter`]: the default recogniser.

use super::model::Model;
use crate::error::Result;
use crate::primitive::Vocabulary;

/// How the filter listens.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterSettings {
    /// How much the hands count: squared distances a second. Evidence of successive moments, and of the numbers of
    /// one, is far from independent: the likelihood is tempered.
    pub hands_trust: f64,
    /// The same of the whole body.
    pub body_trust: f64,
    /// Directions of the whitened features that are kept, those in which the vocabulary varies most.
    pub directions: usize,
    /// Rows a primitive at most: exemplars, and courses between them where parameters have a meaning.
    pub rows: usize,
    /// Moments a second that are looked at; frames between are answered from the last.
    pub clock_hz: f64,
    /// Seconds by which an answer may lag, that what followed may speak for it: 0 answers at once.
    pub lag_secs: f64,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            hands_trust: 8.0,
            body_trust: 3.0,
            directions: 40,
            rows: 64,
            clock_hz: 30.0,
            lag_secs: 0.0,
        }
    }
}

/// Follows a stream over primitive, parameters and phase.
#[derive(Debug)]
pub struct Filter<'v> {
    vocabulary: &'v Vocabulary,
    clips: Model,
    settings: FilterSettings,
}

impl<'v> Filter<'v> {
    /// A filter over a vocabulary.
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn new(vocabulary: &'v Vocabulary, settings: &FilterSettings) -> Result<Self> {
        Ok(Self {
            clips: Model::new(vocabulary, settings, true)?,
            vocabulary,
            settings: settings.clone(),
        })
    }
}
