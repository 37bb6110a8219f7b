//! [`Segmenter`]: the choice of a method, as a derivation holds it.

use super::changepoint::{self, ChangePoint};
use super::duration;
use super::pendulum::{self, Limb, Pendulum};
use super::signal::Signal;
use super::spans::{Segmentation, Span, clips};
use super::zfunction::{self, ZFunction};
use crate::error::{Error, Result};

/// How recordings are cut into movements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segmenter {
    /// At the ends of pendulum swings of the limbs, and at rests.
    Pendulum(Pendulum),
    /// At pauses in the activity of the joints.
    ZFunction(ZFunction),
    /// At changes of the features' course.
    ChangePoint(ChangePoint),
    /// Not at all: each recording is one movement.
    Clips,
}

impl Default for Segmenter {
    fn default() -> Self {
        Self::Pendulum(Pendulum::default())
    }
}

/// What a recording looks like to the segmenters. Each needs its own view; others may be left empty.
#[derive(Debug, Clone, Copy)]
pub struct Views<'a> {
    /// How many frames the recording has.
    pub frames: usize,
    /// Frames a second.
    pub rate_hz: f64,
    /// For the pendulum: one stacked bob, or several limbs.
    pub limbs: &'a [Limb<'a>],
    /// For the z-function: joint coordinates.
    pub angles: Option<Signal<'a>>,
    /// For the z-function: a weight for each coordinate, or none for equal ones.
    pub weights: &'a [f64],
    /// For change points: features of like units.
    pub features: Option<Signal<'a>>,
}

impl<'a> Views<'a> {
    /// Views of a recording of so many frames, all of them empty.
    pub fn new(frames: usize, rate_hz: f64) -> Self {
        Self {
            frames,
            rate_hz,
            limbs: &[],
            angles: None,
            weights: &[],
            features: None,
        }
    }

    /// The view that a method needs, if it is there and covers the recording.
    fn fitting(&self, view: Option<Signal<'a>>, method: &str, what: &str) -> Result<Signal<'a>> {
        let view = view.ok_or_else(|| {
            Error::invalid(format!("the {method} segmenter needs {what}, found none"))
        })?;
        if view.frames() != self.frames || view.rate_hz() != self.rate_hz {
            return Err(Error::invalid(format!(
                "{what} cover {} frames at {} Hz, the recording {} at {} Hz",
                view.frames(),
                view.rate_hz(),
                self.frames,
                self.rate_hz
            )));
        }
        Ok(view)
    }
}

impl Segmenter {
    /// The method's name: `pendulum`, `zfunction`, `changepoint` or `clips`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pendulum(_) => "pendulum",
            Self::ZFunction(_) => "zfunction",
            Self::ChangePoint(_) => "changepoint",
            Self::Clips => "clips",
        }
    }

    /// The default settings of the method of that name.
    ///
    /// # Errors
    /// When no method has that name; the message lists them.
    pub fn named(name: &str) -> Result<Self> {
        match name {
            "pendulum" => Ok(Self::default()),
            "zfunction" => Ok(Self::ZFunction(ZFunction::default())),
            "changepoint" => Ok(Self::ChangePoint(ChangePoint::default())),
            "clips" => Ok(Self::Clips),
            _ => Err(Error::unknown_name(
                "segmenter",
                name,
                ["pendulum", "zfunction", "changepoint", "clips"],
            )),
        }
    }

    /// Cuts a recording; with `target_secs`, so that the median movement is about as long (clips stay whole).
    ///
    /// # Errors
    /// When the view that the method needs is empty or of another length or rate, when settings are out of
    /// range, or the target is not positive.
    pub fn segment(&self, views: &Views, target_secs: Option<f64>) -> Result<Segmentation> {
        let as_given = |spans: Vec<Span>| Segmentation::new(spans, views.rate_hz, 1.0);
        match self {
            Self::Clips => Ok(as_given(clips(views.frames))),
            Self::Pendulum(config) => {
                let limbs = views.limbs;
                views.fitting(limbs.first().map(|l| l.bob), "pendulum", "places of limbs")?;
                match target_secs {
                    Some(target) => duration::pendulum(limbs, config, target),
                    None => pendulum::segment(limbs, config).map(as_given),
                }
            }
            Self::ZFunction(config) => {
                let angles = views.fitting(views.angles, "zfunction", "joint coordinates")?;
                match target_secs {
                    Some(target) => duration::zfunction(&angles, views.weights, config, target),
                    None => zfunction::segment(&angles, views.weights, config).map(as_given),
                }
            }
            Self::ChangePoint(config) => {
                let features = views.fitting(views.features, "changepoint", "features")?;
                match target_secs {
                    Some(target) => duration::changepoint(&features, config, target),
                    None => changepoint::segment(&features, config).map(as_given),
                }
            }
        }
    }
}
