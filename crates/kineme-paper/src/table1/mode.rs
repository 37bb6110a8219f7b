//! [`Mode`]: how behaviours are affirmed or denied, frame by frame.

use kineme::Vocabulary;
use kineme::perception::{Filter, FilterSettings, Frame, FrameSettings, Paper, PaperSettings};
use kineme::primitive::{Observations, Recogniser, readings};

use crate::sets::Result;

/// How is decided. Everywhere a behaviour is affirmed in a frame where its probability is above one half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mode {
    /// Section V-A as published: each behaviour against its own complement.
    Paper {
        /// Postures.
        n: usize,
        /// Frames from one to the next.
        stride: usize,
    },
    /// The exact density; behaviours, rest and none compete.
    Frame {
        /// Postures.
        n: usize,
        /// Frames from one to the next.
        stride: usize,
    },
    /// The filter, answering so much later than it sees.
    Filter {
        /// Seconds of hindsight; 0 answers at once.
        lag_secs: f64,
        /// A behaviour that is not affirmed for so long without a break is denied, seconds. Known so much later.
        held_secs: f64,
    },
    /// The filter's spans of a recording that is known whole: a quarter of a second of hindsight, nothing shorter than
    /// a fifth of a second. It tells no probabilities.
    Spans,
    /// Always deny: the baseline.
    Never,
}

impl Mode {
    /// The filter as it comes.
    pub const FILTER: Mode = Mode::Filter {
        lag_secs: 0.0,
        held_secs: 0.0,
    };

    /// The filter with a tenth of a second of hindsight.
    pub const HINDSIGHT: Mode = Mode::Filter {
        lag_secs: 0.1,
        held_secs: 0.0,
    };

    /// Its name in the tables.
    pub fn name(self) -> String {
        match self {
            Mode::Paper { .. } => "paper".into(),
            Mode::Frame { .. } => "frame".into(),
            Mode::FILTER => "filter".into(),
            Mode::Filter {
                lag_secs,
                held_secs,
            } => {
                let lag = match lag_secs > 0.0 {
                    true => format!(", {lag_secs} s of hindsight"),
                    false => String::new(),
                };
                let held = match held_secs > 0.0 {
                    true => format!(", held for {held_secs} s"),
                    false => String::new(),
                };
                format!("filter{lag}{held}")
            }
            Mode::Spans => "filter, spans of the whole recording".into(),
            Mode::Never => "never".into(),
        }
    }

    /// Postures and frames between them, where that is a choice.
    pub fn postures(self) -> Option<(usize, usize)> {
        match self {
            Mode::Paper { n, stride } | Mode::Frame { n, stride } => Some((n, stride)),
            _ => None,
        }
    }

    /// What decides, over a vocabulary; `None` where nothing needs to.
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn over<'v>(self, vocabulary: &'v Vocabulary) -> Result<Option<Box<dyn Recogniser + 'v>>> {
        let filter = |lag_secs| FilterSettings {
            lag_secs,
            ..FilterSettings::default()
        };
        Ok(match self {
            Mode::Paper { n, stride } => {
                let settings = PaperSettings {
                    n,
                    stride,
                    ..PaperSettings::default()
                };
                Some(Box::new(Paper::new(vocabulary, &settings)?))
            }
            Mode::Frame { n, stride } => {
                let settings = FrameSettings {
                    n,
                    stride,
                    ..FrameSettings::default()
                };
                Some(Box::new(Frame::new(vocabulary, &settings)?))
            }
            Mode::Filter { lag_secs, .. } => {
                Some(Box::new(Filter::new(vocabulary, &filter(lag_secs))?))
            }
            Mode::Spans => Some(Box::new(Filter::new(vocabulary, &filter(0.0))?)),
            Mode::Never => None,
        })
    }

    /// Whether another way decides by the same answers, and merely holds longer or less long.
    pub fn shares(self, other: Mode) -> bool {
        match (self, other) {
            (Mode::Filter { lag_secs: a, .. }, Mode::Filter { lag_secs: b, .. }) => a == b,
            _ => self == other,
        }
    }

    /// What is decided of every frame of a motion, by what [`Self::over`] made over `classes` behaviours.
    ///
    /// # Errors
    /// When the motion is of another body.
    pub fn decide(
        self,
        recogniser: Option<&dyn Recogniser>,
        classes: usize,
        seen: &Observations,
    ) -> Result<Decisions> {
        let answered = self.answered(recogniser, classes, seen)?;
        Ok(self.held(answered, classes, seen.motion().rate_hz()))
    }

    /// What [`Self::decide`] decides before anything is held.
    pub(super) fn answered(
        self,
        recogniser: Option<&dyn Recogniser>,
        classes: usize,
        seen: &Observations,
    ) -> Result<Decisions> {
        let motion = seen.motion();
        let (frames, rate) = (motion.frames(), motion.rate_hz());
        let Some(recogniser) = recogniser else {
            return Ok(Decisions {
                affirmed: vec![false; frames * classes],
                probable: Some(vec![0.0; frames * classes]),
            });
        };
        if self == Mode::Spans {
            let mut affirmed = vec![false; frames * classes];
            for span in recogniser.recognise(seen)?.spans {
                let at = |secs: f64| ((secs * rate).round() as usize).min(frames);
                for f in at(span.start_secs)..at(span.end_secs) {
                    if let Some(k) = span.primitive {
                        affirmed[f * classes + k] = true;
                    }
                }
            }
            return Ok(Decisions {
                affirmed,
                probable: None,
            });
        }
        let answers = readings(recogniser, seen)?;
        let lag = match self {
            Mode::Filter { lag_secs, .. } => (lag_secs * rate).round() as usize,
            _ => 0,
        };
        let of = |f: usize| &answers[(f + lag).min(frames - 1)].posterior.primitives;
        let probable: Vec<f64> = (0..frames).flat_map(|f| of(f).iter().copied()).collect();
        Ok(Decisions {
            affirmed: probable.iter().map(|p| *p > 0.5).collect(),
            probable: Some(probable),
        })
    }

    /// Decisions without what is not affirmed for as long as this way wants it.
    pub(super) fn held(self, mut decided: Decisions, classes: usize, rate_hz: f64) -> Decisions {
        if let Mode::Filter { held_secs, .. } = self {
            let least = (held_secs * rate_hz).round() as usize;
            drop_short(&mut decided.affirmed, classes, least);
        }
        decided
    }
}

/// What was decided of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Decisions {
    /// Which behaviours are affirmed: frames x behaviours.
    pub affirmed: Vec<bool>,
    /// How probable they are, where that is told.
    pub probable: Option<Vec<f64>>,
}

/// Denies what is affirmed in fewer successive frames.
fn drop_short(affirmed: &mut [bool], classes: usize, least: usize) {
    let frames = affirmed.len() / classes;
    for k in 0..classes {
        let mut begun = 0;
        for f in 0..=frames {
            if f < frames && affirmed[f * classes + k] {
                continue;
            }
            if f - begun < least {
                for dropped in begun..f {
                    affirmed[dropped * classes + k] = false;
                }
            }
            begun = f + 1;
        }
    }
}
