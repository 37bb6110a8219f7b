//! [`Span`]: the output of every segmenter.

use crate::error::{Error, Result};
use crate::math::statistics::median;

/// What happens in a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpanKind {
    /// A movement.
    Move,
    /// A pause.
    Rest,
}

/// Frames `start..end` of a recording.
///
/// Segmenters return spans in order of time that do not overlap; those that see rests cover the recording,
/// and every frame belongs to a movement or a rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Span {
    /// First frame.
    pub start: usize,
    /// One past the last frame.
    pub end: usize,
    /// Movement or rest.
    pub kind: SpanKind,
}

impl Span {
    /// A movement.
    pub fn movement(start: usize, end: usize) -> Self {
        Self {
            start,
            end,
            kind: SpanKind::Move,
        }
    }

    /// A rest.
    pub fn rest(start: usize, end: usize) -> Self {
        Self {
            start,
            end,
            kind: SpanKind::Rest,
        }
    }

    /// How many frames it has.
    pub fn len(&self) -> usize {
        self.end.saturating_sub(self.start)
    }

    /// True without frames; no segmenter returns such.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True for a movement.
    pub fn is_movement(&self) -> bool {
        self.kind == SpanKind::Move
    }
}

/// What a segmenter made of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmentation {
    /// The spans, in order.
    pub spans: Vec<Span>,
    /// The median length of the movements, seconds; `None` when nothing moves.
    pub median_secs: Option<f64>,
    /// The factor on the segmenter's own setting that a wanted duration led to; 1 is the setting as given.
    pub scale: f64,
}

impl Segmentation {
    pub(super) fn new(spans: Vec<Span>, rate_hz: f64, scale: f64) -> Self {
        let lengths: Vec<f64> = movements(&spans)
            .map(|s| s.len() as f64 / rate_hz)
            .collect();
        Self {
            spans,
            median_secs: median(&lengths),
            scale,
        }
    }
}

/// The movements among spans.
pub fn movements(spans: &[Span]) -> impl Iterator<Item = &Span> {
    spans.iter().filter(|s| s.is_movement())
}

/// These movements (in order, apart) with the rests between them, over a recording of so many frames.
pub(super) fn covering(movements: &[(usize, usize)], frames: usize) -> Vec<Span> {
    let mut spans = Vec::with_capacity(2 * movements.len() + 1);
    let mut last = 0;
    for &(start, end) in movements {
        if start > last {
            spans.push(Span::rest(last, start));
        }
        spans.push(Span::movement(start, end));
        last = end;
    }
    if last < frames {
        spans.push(Span::rest(last, frames));
    }
    spans
}

/// A recording that is one movement already; nothing without frames.
pub fn clips(frames: usize) -> Vec<Span> {
    if frames == 0 {
        return Vec::new();
    }
    vec![Span::movement(0, frames)]
}

/// Movements marked by hand: pairs of start and end in seconds from the first frame, in any order.
///
/// Times become frames by rounding; what reaches past the recording is cut off at its ends. Marks may touch.
///
/// # Errors
/// When a rate or time is not a number, a mark ends before it starts, lies outside the recording, holds no
/// frame, or overlaps another one. The message names the mark by its times.
pub fn marks(marks_secs: &[(f64, f64)], frames: usize, rate_hz: f64) -> Result<Vec<Span>> {
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Error::invalid(format!(
            "marks need a positive rate, found {rate_hz} Hz"
        )));
    }
    let mut sorted = marks_secs.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut spans: Vec<Span> = Vec::with_capacity(sorted.len());
    let mut previous: Option<(f64, f64)> = None;
    for (start, end) in sorted {
        let refuse = |why: String| Err(Error::invalid(format!("mark {start} s to {end} s {why}")));
        if !(start.is_finite() && end.is_finite()) {
            return refuse("needs finite times".into());
        }
        if end <= start {
            return refuse("does not end after its start".into());
        }
        if let Some((s, e)) = previous.filter(|p| start < p.1) {
            return refuse(format!("overlaps the mark {s} s to {e} s"));
        }
        previous = Some((start, end));
        // A cast of a negative number to usize gives 0, of a huge one the largest.
        let frame = |secs: f64| ((secs * rate_hz).round() as usize).min(frames);
        let span = Span::movement(frame(start), frame(end));
        if span.is_empty() {
            return refuse(format!(
                "holds no frame of a recording of {} s at {rate_hz} Hz",
                frames as f64 / rate_hz
            ));
        }
        spans.push(span);
    }
    Ok(spans)
}
