//! The recognisers that can be judged.

use clap::ValueEnum;
use kineme::Vocabulary;
use kineme::evaluation::{
    Constant, NearestDtw, NearestDtwSettings, NearestPosture, NearestPostureSettings,
};
use kineme::perception::encoding::{Encoder, EncodingSettings};
use kineme::primitive::Recogniser;

use crate::args::{ClassifierArgs, ClassifierName, MethodName};
use crate::failure::Failure;
use crate::recognisers::classifier;

/// The recogniser of this name over a vocabulary, with its defaults.
pub(super) fn recogniser(
    name: MethodName,
    vocabulary: &Vocabulary,
) -> Result<Box<dyn Recogniser + '_>, Failure> {
    let classifier = |name| classifier(name, &ClassifierArgs::default(), vocabulary);
    Ok(match name {
        MethodName::Filter => classifier(ClassifierName::Filter)?,
        MethodName::Frame => classifier(ClassifierName::Frame)?,
        MethodName::Paper => classifier(ClassifierName::Paper)?,
        MethodName::Encode => Box::new(Encoder::new(vocabulary, &EncodingSettings::default())?),
        MethodName::NearestDtw => {
            Box::new(NearestDtw::new(vocabulary, &NearestDtwSettings::default())?)
        }
        MethodName::NearestPosture => Box::new(NearestPosture::new(
            vocabulary,
            &NearestPostureSettings::default(),
        )?),
        MethodName::Constant => Box::new(Constant::new(vocabulary)?),
    })
}

/// Whether a method ever answers that a movement is none of the primitives.
pub(super) fn can_reject(method: MethodName) -> bool {
    match method {
        MethodName::Filter | MethodName::Frame | MethodName::Paper | MethodName::Encode => true,
        MethodName::NearestDtw | MethodName::NearestPosture | MethodName::Constant => false,
    }
}

/// What the command line calls it.
pub(super) fn name(method: MethodName) -> String {
    let value = method.to_possible_value();
    value.map_or_else(String::new, |v| v.get_name().to_owned())
}
