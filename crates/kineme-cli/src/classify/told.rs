//! Answers, for people and for scripts.

use kineme::primitive::{Place, Posterior, Reading, Recogniser, Recognition};
use kineme::{Primitive, Vocabulary};
use serde::Serialize;

use crate::describe::short;
use crate::failure::Failure;
use crate::json::{InOrder, line};
use crate::table::Side;

/// The columns of the table of motions.
pub(super) const MOTION_COLUMNS: [(&str, Side); 5] = [
    ("motion", Side::Left),
    ("movement", Side::Left),
    ("probability", Side::Right),
    ("novelty", Side::Right),
    ("parameters", Side::Left),
];

/// A motion, as `--json` tells it.
#[derive(Serialize)]
struct MotionLine<'a> {
    motion: &'a str,
    label: Option<&'a str>,
    #[serde(flatten)]
    probabilities: Probabilities,
    spans: Vec<SpanLine<'a>>,
    /// Of the label, in their own units.
    parameters: Option<Vec<f64>>,
    novelty: f64,
}

/// Seconds.
#[derive(Serialize)]
struct SpanLine<'a> {
    start: f64,
    end: f64,
    label: Option<&'a str>,
    confidence: f64,
}

/// A frame, as `--json` tells it; what follows the probabilities is the label's.
#[derive(Serialize)]
struct FrameLine<'a> {
    motion: &'a str,
    time: f64,
    /// The moment that the answer is of, where answers lag.
    #[serde(skip_serializing_if = "Option::is_none")]
    about: Option<f64>,
    label: Option<&'a str>,
    #[serde(flatten)]
    probabilities: Probabilities,
    phase: Option<f64>,
    parameters: Option<Vec<f64>>,
    phase_deviation: Option<f64>,
    parameters_deviation: Option<Vec<f64>>,
    novelty: f64,
}

/// Of each primitive; of answers that compete also of rest and none.
#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Probabilities {
    Posterior(InOrder<f64>),
    Binary(InOrder<f64>),
}

/// Says what a recogniser answers.
pub(super) struct Teller<'v> {
    vocabulary: &'v Vocabulary,
    is_binary: bool,
    /// Whether scripts read it.
    pub json: bool,
    /// Seconds by which answers to frames lag.
    lag_secs: f64,
    /// The longest name of an answer, letters.
    width: usize,
}

impl<'v> Teller<'v> {
    pub fn new(recogniser: &'v dyn Recogniser, lag_secs: f64, json: bool) -> Self {
        let vocabulary = recogniser.vocabulary();
        let names = vocabulary.primitives().iter().map(Primitive::name);
        let widths = names.map(|name| name.chars().count());
        Self {
            vocabulary,
            is_binary: recogniser.is_binary(),
            json,
            lag_secs,
            width: widths.max().unwrap_or(0).max("movement".len()),
        }
    }

    /// A motion's line of JSON.
    pub fn motion_line(&self, motion: &str, whole: &Recognition) -> Result<String, Failure> {
        let best = whole.posterior.best();
        let spans = whole.spans.iter().map(|s| SpanLine {
            start: s.start_secs,
            end: s.end_secs,
            label: s.primitive.map(|k| self.name(k)),
            confidence: s.confidence,
        });
        line(&MotionLine {
            motion,
            label: best.map(|k| self.name(k)),
            probabilities: self.probabilities(&whole.posterior),
            spans: spans.collect(),
            parameters: best.and_then(|k| self.parameters(k, &whole.parameters)),
            novelty: whole.novelty,
        })
    }

    /// A motion's rows in the table: its answer, and its spans where there are several.
    pub fn motion_rows(&self, motion: &str, whole: &Recognition) -> Vec<Vec<String>> {
        let (answer, probability) = self.answer(&whole.posterior);
        let best = whole.posterior.best();
        let parameters = best.and_then(|k| Some((k, self.parameters(k, &whole.parameters)?)));
        let mut rows = vec![vec![
            motion.to_owned(),
            answer.to_owned(),
            format!("{probability:.2}"),
            format!("{:.2}", whole.novelty),
            parameters.map_or_else(String::new, |(k, values)| self.named(k, &values)),
        ]];
        if whole.spans.len() > 1 {
            rows.extend(whole.spans.iter().map(|s| {
                vec![
                    format!("  {:.2} to {:.2} s", s.start_secs, s.end_secs),
                    s.primitive.map_or("-", |k| self.name(k)).to_owned(),
                    format!("{:.2}", s.confidence),
                ]
            }));
        }
        rows
    }

    /// What precedes the frames of a file.
    pub fn frames_head(&self, motion: &str) -> String {
        match self.json {
            true => String::new(),
            false => format!("{motion}\n{}", self.frames_columns()),
        }
    }

    /// What follows them.
    pub fn frames_end(&self) -> &'static str {
        if self.json { "" } else { "\n" }
    }

    /// The names of the columns of frames, for people.
    pub fn frames_columns(&self) -> String {
        if self.json {
            return String::new();
        }
        let movement = format!("{:width$}", "movement", width = self.width);
        let about = match self.lag_secs > 0.0 {
            true => "      about",
            false => "",
        };
        format!("     time{about}  {movement}  probability  phase  novelty  parameters\n")
    }

    /// The line of a frame at `secs` of what began at `since`.
    pub fn frame(
        &self,
        motion: &str,
        (since, secs): (f64, f64),
        reading: &Reading,
    ) -> Result<String, Failure> {
        let about = (self.lag_secs > 0.0).then(|| (secs - self.lag_secs).max(since));
        let best = reading.posterior.best();
        let place = reading.place.as_ref();
        let place = place.filter(|place| Some(place.primitive) == best);
        if !self.json {
            return Ok(self.frame_text(secs, about, reading, place));
        }
        let deviation = |place: &Place| {
            let axes = self.primitive(place.primitive).parameters().axes().iter();
            let pairs = axes.zip(&place.parameters_deviation);
            pairs.map(|(axis, d)| (axis.high - axis.low) * d).collect()
        };
        line(&FrameLine {
            motion,
            time: secs,
            about,
            label: best.map(|k| self.name(k)),
            probabilities: self.probabilities(&reading.posterior),
            phase: place.map(|p| p.phase),
            parameters: place.and_then(|p| self.parameters(p.primitive, &p.parameters)),
            phase_deviation: place.map(|p| p.phase_deviation),
            parameters_deviation: place.map(deviation),
            novelty: reading.novelty,
        })
    }

    fn frame_text(
        &self,
        secs: f64,
        about: Option<f64>,
        reading: &Reading,
        place: Option<&Place>,
    ) -> String {
        let about = about.map_or_else(String::new, |about| format!("  {about:9.3}"));
        let (answer, probability) = self.answer(&reading.posterior);
        let phase = place.map_or("-".into(), |p| format!("{:.2}", p.phase));
        let values = place.and_then(|p| self.parameters(p.primitive, &p.parameters));
        let parameters = place.zip(values);
        let named = parameters.map_or_else(String::new, |(p, v)| self.named(p.primitive, &v));
        let line = format!(
            "{secs:9.3}{about}  {answer:width$}  {probability:11.2}  {phase:>5}  {:7.2}  {named}",
            reading.novelty,
            width = self.width
        );
        line.trim_end().to_owned() + "\n"
    }

    fn primitive(&self, k: usize) -> &'v Primitive {
        &self.vocabulary.primitives()[k]
    }

    fn name(&self, k: usize) -> &'v str {
        self.primitive(k).name()
    }

    /// The answer in a word, and how probable it is.
    fn answer(&self, posterior: &Posterior) -> (&'v str, f64) {
        match posterior.best() {
            Some(k) => (self.name(k), posterior.primitives[k]),
            None if posterior.rest > posterior.none => ("rest", posterior.rest),
            None => ("none", posterior.none),
        }
    }

    fn probabilities(&self, posterior: &Posterior) -> Probabilities {
        let primitives = posterior.primitives.iter().enumerate();
        let mut all: Vec<(String, f64)> = primitives
            .map(|(k, p)| (self.name(k).to_owned(), *p))
            .collect();
        if self.is_binary {
            return Probabilities::Binary(InOrder(all));
        }
        all.push(("rest".into(), posterior.rest));
        all.push(("none".into(), posterior.none));
        Probabilities::Posterior(InOrder(all))
    }

    /// Parameters in their own units; `None` where nothing is known of them.
    fn parameters(&self, k: usize, places: &[f64]) -> Option<Vec<f64>> {
        let space = self.primitive(k).parameters();
        (places.len() == space.dims()).then(|| space.from_unit(places))
    }

    /// `height 0.5, side 0.2`.
    fn named(&self, k: usize, values: &[f64]) -> String {
        let axes = self.primitive(k).parameters().axes().iter().zip(values);
        let told: Vec<String> = axes
            .map(|(a, v)| format!("{} {}", a.name, short(*v)))
            .collect();
        told.join(", ")
    }
}
