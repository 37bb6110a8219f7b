//! What is learned of a split, and the recognisers over it.

use kineme::evaluation::{
    Constant, Features, NearestDtw, NearestDtwSettings, NearestPosture, NearestPostureSettings,
};
use kineme::perception::encoding::{Encoder, EncodingSettings};
use kineme::perception::{Filter, FilterSettings, Frame, FrameSettings, Paper, PaperSettings};
use kineme::primitive::{
    Exemplar, Mismatched, Modelling, Primitive, Recogniser, Transitions, Vocabulary,
};
use rayon::prelude::*;

use crate::sets::{LabelledSet, Result};

/// A recogniser of the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The default.
    Filter,
    /// The exact lattice.
    Frame,
    /// Section V-A as published, each primitive by itself.
    Paper,
    /// Section V-B with hypotheses: the hands alone.
    Encode,
    /// The nearest exemplar by time warping, all landmarks.
    Dtw,
    /// The same with the root's travel since the beginning.
    DtwRoute,
    /// The same as [`Self::Dtw`] by the hands alone.
    DtwHands,
    /// The nearest posture.
    Posture,
    /// The commonest class.
    Constant,
}

impl Method {
    /// Its name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Method::Filter => "filter",
            Method::Frame => "frame",
            Method::Paper => "paper",
            Method::Encode => "encode",
            Method::Dtw => "1NN-DTW",
            Method::DtwRoute => "1NN-DTW, route",
            Method::DtwHands => "1NN-DTW, hands",
            Method::Posture => "nearest posture",
            Method::Constant => "constant",
        }
    }

    /// The recogniser over a vocabulary, with its default settings.
    ///
    /// # Errors
    /// When it cannot be made of this vocabulary.
    pub fn over<'v>(self, vocabulary: &'v Vocabulary) -> Result<Box<dyn Recogniser + 'v>> {
        let hands = || Features::Effectors(vec!["left_hand".into(), "right_hand".into()]);
        Ok(match self {
            Method::Filter => Box::new(Filter::new(vocabulary, &FilterSettings::default())?),
            Method::Frame => Box::new(Frame::new(vocabulary, &FrameSettings::default())?),
            Method::Paper => Box::new(Paper::new(vocabulary, &PaperSettings::default())?),
            Method::Encode => Box::new(Encoder::new(vocabulary, &EncodingSettings::default())?),
            Method::Dtw => Box::new(NearestDtw::new(vocabulary, &NearestDtwSettings::default())?),
            Method::DtwRoute => {
                let settings = NearestDtwSettings {
                    route: true,
                    ..NearestDtwSettings::default()
                };
                Box::new(NearestDtw::new(vocabulary, &settings)?)
            }
            Method::DtwHands => {
                let settings = NearestDtwSettings {
                    features: hands(),
                    ..NearestDtwSettings::default()
                };
                Box::new(NearestDtw::new(vocabulary, &settings)?)
            }
            Method::Posture => {
                let settings = NearestPostureSettings::default();
                Box::new(NearestPosture::new(vocabulary, &settings)?)
            }
            Method::Constant => Box::new(Constant::new(vocabulary)?),
        })
    }
}

/// Some classes of a set, learned from some of its clips.
#[derive(Debug, Clone)]
pub struct Known {
    /// The vocabulary, calibrated.
    pub vocabulary: Vocabulary,
    /// The class of each primitive, an index into those of the set.
    pub class_of: Vec<usize>,
    /// How many classes the set has, known and unknown.
    pub classes: usize,
}

/// One primitive a class, learned from these clips alone; `None` for classes without one among them. Exemplars of
/// another structure than most are left out, as nobody labelled structure.
///
/// # Errors
/// As for [`Primitive::learn`].
pub fn primitives(set: &LabelledSet, clips: &[usize]) -> Result<Vec<Option<Primitive>>> {
    let exemplars = |class: usize| -> Vec<Exemplar> {
        let of = |i: &&usize| set.labels[**i] == class;
        let whole = |i: &usize| Exemplar::whole(set.motions[*i].clone(), None);
        clips.iter().filter(of).map(whole).collect()
    };
    learned(&set.classes, &exemplars)
}

/// The same of the exemplars of each class.
pub(super) fn learned(
    classes: &[String],
    exemplars: &(dyn Fn(usize) -> Vec<Exemplar> + Sync),
) -> Result<Vec<Option<Primitive>>> {
    let modelling = Modelling {
        mismatched: Mismatched::LeaveOut,
        ..Modelling::default()
    };
    let learn = |class: usize| {
        let exemplars = exemplars(class);
        if exemplars.is_empty() {
            return Ok(None);
        }
        Ok(Some(Primitive::learn(
            &classes[class],
            exemplars,
            &modelling,
        )?))
    };
    (0..classes.len()).into_par_iter().map(learn).collect()
}

impl Known {
    /// The vocabulary of these primitives, one a class.
    ///
    /// # Errors
    /// Without primitives.
    pub fn of(primitives: Vec<Option<Primitive>>) -> Result<Self> {
        let classes = primitives.len();
        let class_of = (0..classes).filter(|&c| primitives[c].is_some()).collect();
        let primitives: Vec<Primitive> = primitives.into_iter().flatten().collect();
        let body = primitives.first().ok_or("no primitives")?.body().clone();
        let transitions = Transitions::observed(&primitives);
        let vocabulary = Vocabulary::new(body, primitives, Vec::new(), transitions)?;
        let unlearned = vec![None; vocabulary.primitives().len()];
        let calibration = Filter::calibration(&vocabulary, &unlearned)?;
        let vocabulary = vocabulary.calibrated(calibration)?;
        Ok(Self {
            vocabulary,
            class_of,
            classes,
        })
    }

    /// All classes of a set, learned from these clips.
    ///
    /// # Errors
    /// As for [`primitives`].
    pub fn learn(set: &LabelledSet, clips: &[usize]) -> Result<Self> {
        Self::of(primitives(set, clips)?)
    }
}
