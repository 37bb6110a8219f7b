//! The recognisers of the command line: made here for every verb.

use kineme::Vocabulary;
use kineme::perception::{Filter, FilterSettings, Frame, FrameSettings, Paper, PaperSettings};
use kineme::primitive::Recogniser;

use crate::args::{ClassifierArgs, ClassifierName};
use crate::failure::Failure;

/// The classifier of this name over a vocabulary.
pub fn classifier<'v>(
    name: ClassifierName,
    args: &ClassifierArgs,
    vocabulary: &'v Vocabulary,
) -> Result<Box<dyn Recogniser + 'v>, Failure> {
    refuse_others(name, args)?;
    Ok(match name {
        ClassifierName::Filter => {
            let defaults = FilterSettings::default();
            let settings = FilterSettings {
                lag_secs: args.lag.unwrap_or(defaults.lag_secs),
                ..defaults
            };
            Box::new(Filter::new(vocabulary, &settings)?)
        }
        ClassifierName::Frame => {
            let defaults = FrameSettings::default();
            let settings = FrameSettings {
                n: args.n.map_or(defaults.n, usize::from),
                stride: args.stride.map_or(defaults.stride, usize::from),
                ..defaults
            };
            Box::new(Frame::new(vocabulary, &settings)?)
        }
        ClassifierName::Paper => {
            let defaults = PaperSettings::default();
            let settings = PaperSettings {
                n: args.n.map_or(defaults.n, usize::from),
                stride: args.stride.map_or(defaults.stride, usize::from),
                ..defaults
            };
            Box::new(Paper::new(vocabulary, &settings)?)
        }
    })
}

/// Refuses what only other classifiers look at.
fn refuse_others(name: ClassifierName, args: &ClassifierArgs) -> Result<(), Failure> {
    let of_postures = [
        ("--n", args.n.is_some()),
        ("--stride", args.stride.is_some()),
    ];
    let strange = match name {
        ClassifierName::Filter => of_postures.into_iter().find(|(_, given)| *given),
        ClassifierName::Frame | ClassifierName::Paper => {
            Some(("--lag", args.lag.is_some())).filter(|(_, given)| *given)
        }
    };
    match strange {
        None => Ok(()),
        Some(("--lag", _)) => {
            Err(Failure::usage("--lag is the filter's alone").hint("--method filter"))
        }
        Some((option, _)) => Err(Failure::usage(format!(
            "{option} says nothing to the filter, which follows all postures"
        ))
        .hint("--method frame or --method paper")),
    }
}
