//! What the encoder learns of a vocabulary, kept with it: its [`Rejection`] as a [`Calibration`].

use super::confidence::Confidence;
use super::encoder::{Encoder, checked_rows};
use super::paths::Chains;
use super::rejection::{Rejection, SCORES};
use super::settings::EncodingSettings;
use crate::error::{Error, Result};
use crate::primitive::{Calibration, Vocabulary};
use crate::skeleton::Skeleton;

/// The recogniser that a calibration names.
const NAME: &str = "encoder";
/// The first number kept: what the others mean has changed since they were first kept.
const EDITION: f64 = 2.0;
/// Shared numbers: edition, limit, temperature, bias, the temperature of clips and its spread, then the weights.
const SHARED: usize = 6 + SCORES;

impl Encoder<'_> {
    /// Whether a body has the shoulders and hands that the default settings look at.
    pub fn can_watch(body: &Skeleton) -> bool {
        Chains::of(body, &EncodingSettings::default().effectors).is_ok()
    }

    /// What an encoder of the default settings learns of a vocabulary: of each primitive its limit, and of the whole
    /// what [`Rejection`] holds besides; for [`Vocabulary::calibrated`]. Primitives with a limit in `kept` (in the order
    /// of the vocabulary) keep it.
    ///
    /// # Errors
    /// When the vocabulary has no primitive, or its body is none that [`Self::can_watch`].
    pub fn calibration(vocabulary: &Vocabulary, kept: &[Option<Vec<f64>>]) -> Result<Calibration> {
        let settings = EncodingSettings::default();
        let (rows, outlines) = checked_rows(vocabulary, &settings)?;
        let limit = |numbers: &Option<Vec<f64>>| match numbers.as_deref() {
            Some([limit]) if *limit > 0.0 => Some(*limit),
            _ => None,
        };
        let limits: Vec<Option<f64>> = kept.iter().map(limit).collect();
        let rejection = Rejection::fit(vocabulary, (&rows, outlines.as_ref()), &settings, &limits)?;
        Ok(rejection.calibration())
    }

    /// Whether numbers that a vocabulary keeps mean what they mean to this encoder.
    pub(in crate::perception) fn understands(calibration: &Calibration) -> bool {
        calibration.shared.first() == Some(&EDITION)
    }
}

impl Rejection {
    fn calibration(&self) -> Calibration {
        let Confidence {
            temperature,
            spread,
        } = self.confidence;
        let mut shared = vec![
            EDITION,
            self.limit,
            self.temperature,
            self.bias,
            temperature,
            spread,
        ];
        shared.extend(self.weights);
        Calibration {
            recogniser: NAME.into(),
            primitives: self.limits.iter().map(|&limit| vec![limit]).collect(),
            shared,
        }
    }

    /// The rejection that is kept with a vocabulary, if it was fitted to such settings by such an encoder.
    pub(super) fn kept(
        vocabulary: &Vocabulary,
        settings: &EncodingSettings,
    ) -> Result<Option<Self>> {
        let Some(kept) = vocabulary.calibration(NAME) else {
            return Ok(None);
        };
        // An earlier edition's numbers start with a limit.
        let earlier = !kept.shared.is_empty() && !Encoder::understands(kept);
        if earlier || !fits_alike(settings) {
            return Ok(None);
        }
        let one_each = kept.primitives.iter().all(|numbers| numbers.len() == 1);
        if !one_each || kept.shared.len() != SHARED {
            return Err(Error::invalid(format!(
                "the calibration of `{NAME}` has {} shared numbers where {SHARED} are known, or not one of each \
                 primitive: another version of the program made it",
                kept.shared.len()
            )));
        }
        let (fixed, weights) = kept.shared.split_at(SHARED - SCORES);
        Self {
            limits: kept.primitives.concat(),
            limit: fixed[1],
            temperature: fixed[2],
            bias: fixed[3],
            confidence: Confidence {
                temperature: fixed[4],
                spread: fixed[5],
            },
            weights: std::array::from_fn(|i| weights[i]),
        }
        .checked(vocabulary)
        .map(Some)
    }
}

/// Whether an encoder of these settings learns the same as one of the default settings: they differ in nothing but how
/// observations are judged.
fn fits_alike(settings: &EncodingSettings) -> bool {
    let default = EncodingSettings::default();
    let alike = EncodingSettings {
        method: default.method,
        extent: default.extent,
        reach_m: default.reach_m,
        switch_cost: default.switch_cost,
        beam: default.beam,
        matching: default.matching,
        ..settings.clone()
    };
    alike == default
}
