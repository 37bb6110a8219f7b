//! Warps: which place of a movement belongs to which phase.

use crate::error::{Error, Result};

/// A strictly rising, continuously differentiable map from phase to place, both in [0, 1], 0 to 0 and 1 to 1.
///
/// Phase is the common clock of a group of movements, place how far one of them has got in its own time. Between
/// its knots the map is a cubic whose slopes at the knots are the mean of the neighbouring secants, at most twice
/// the smaller of them: inside the region of Fritsch and Carlson (1980), and narrow enough that the slope never
/// falls below half of the least secant.
///
/// The warp of a cycle is *closed*: its slopes at both ends are one, and it goes on beyond them, so that
/// `place(phase + 1) = place(phase) + 1`. An open warp holds its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Warp {
    places: Vec<f64>,
    slopes: Vec<f64>,
    closed: bool,
}

impl Warp {
    /// The open warp through the places at the phases `k / (places.len() - 1)`.
    ///
    /// # Errors
    /// When there are fewer than two places, they do not rise strictly, or do not run from 0 to 1.
    pub fn new(places: Vec<f64>) -> Result<Self> {
        Self::through(places, false)
    }

    /// The closed warp through these places, for a cycle; errors as for [`Self::new`].
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn closed(places: Vec<f64>) -> Result<Self> {
        Self::through(places, true)
    }

    pub(super) fn through(places: Vec<f64>, closed: bool) -> Result<Self> {
        let n = places.len();
        if n < 2 || places[0] != 0.0 || places[n - 1] != 1.0 {
            return Err(Error::invalid(format!(
                "a warp runs from place 0 to place 1, found {places:?}"
            )));
        }
        let rises = |w: &[f64]| w[0].partial_cmp(&w[1]) == Some(std::cmp::Ordering::Less);
        if let Some(k) = places.windows(2).position(|w| !rises(w)) {
            return Err(Error::invalid(format!(
                "the places of a warp must rise, found {} after {}",
                places[k + 1],
                places[k]
            )));
        }
        let slopes = knot_slopes(&places, closed);
        Ok(Self {
            places,
            slopes,
            closed,
        })
    }

    /// The warp that changes nothing, with this many knots (at least two).
    pub fn identity(knots: usize) -> Self {
        let places = uniform(knots.max(2));
        Self {
            slopes: vec![1.0; places.len()],
            places,
            closed: false,
        }
    }

    /// The places at evenly spaced phases, from 0 to 1.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// True for the warp of a cycle.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The place at a phase. Beyond [0, 1] an open warp stays at its end, a closed one goes on.
    pub fn place(&self, phase: f64) -> f64 {
        let (turns, k, s) = self.span(phase);
        turns + self.within(k, s)
    }

    /// The slope d place / d phase at a phase, above 0 (beyond the ends of an open warp: that of the end).
    pub fn slope(&self, phase: f64) -> f64 {
        let (_, k, s) = self.span(phase);
        self.slope_within(k, s)
    }

    /// The phase at which a place is reached: the inverse of [`Self::place`].
    pub fn phase(&self, place: f64) -> f64 {
        let (turns, place) = self.folded(place);
        let spans = self.places.len() - 1;
        let after = self.places.partition_point(|&p| p <= place);
        let k = after.clamp(1, spans) - 1;
        // Newton's method, held inside a shrinking bracket; the cubic rises strictly, so there is one root.
        let (mut low, mut high) = (0.0, 1.0);
        let mut s = (place - self.places[k]) / (self.places[k + 1] - self.places[k]);
        for _ in 0..60 {
            let error = self.within(k, s) - place;
            if error == 0.0 {
                break;
            }
            if error > 0.0 {
                high = s;
            } else {
                low = s;
            }
            let next = s - error / self.slope_within(k, s) * spans as f64;
            let next = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            if (next - s).abs() < 1e-16 {
                break;
            }
            s = next;
        }
        turns + (k as f64 + s) / spans as f64
    }

    /// Whole turns taken off (0 for an open warp), and what is left, in [0, 1].
    fn folded(&self, value: f64) -> (f64, f64) {
        if self.closed && !(0.0..=1.0).contains(&value) {
            let turns = value.floor();
            return (turns, value - turns);
        }
        (0.0, value.clamp(0.0, 1.0))
    }

    /// Whole turns, the span between two knots that a phase lies in, and where in it, in [0, 1].
    fn span(&self, phase: f64) -> (f64, usize, f64) {
        let (turns, phase) = self.folded(phase);
        let spans = self.places.len() - 1;
        let at = phase * spans as f64;
        let k = (at.floor() as usize).min(spans - 1);
        (turns, k, at - k as f64)
    }

    /// The cubic Hermite of span `k` at `s` in [0, 1], held to the span against rounding.
    fn within(&self, k: usize, s: f64) -> f64 {
        let (p, q) = (self.places[k], self.places[k + 1]);
        let h = 1.0 / (self.places.len() - 1) as f64;
        let (u, v) = (h * self.slopes[k], h * self.slopes[k + 1]);
        let rise = q - p;
        let bend = u + v - 2.0 * rise;
        // Horner's form about the nearer knot is exact at both ends.
        let place = if s <= 0.5 {
            p + s * (u + s * (3.0 * rise - 2.0 * u - v + s * bend))
        } else {
            let r = 1.0 - s;
            q - r * (v + r * (3.0 * rise - u - 2.0 * v + r * bend))
        };
        place.clamp(p, q)
    }

    fn slope_within(&self, k: usize, s: f64) -> f64 {
        let (u, v) = (self.slopes[k], self.slopes[k + 1]);
        let secant = (self.places[k + 1] - self.places[k]) * (self.places.len() - 1) as f64;
        let r = 1.0 - s;
        6.0 * secant * s * r + u * r * (1.0 - 3.0 * s) + v * s * (3.0 * s - 2.0)
    }
}

/// Slopes at the knots, as [`Warp`] describes them.
fn knot_slopes(places: &[f64], closed: bool) -> Vec<f64> {
    let spans = places.len() - 1;
    let secants: Vec<f64> = places
        .windows(2)
        .map(|w| (w[1] - w[0]) * spans as f64)
        .collect();
    let between = |a: f64, b: f64| (0.5 * (a + b)).min(2.0 * a.min(b));
    let mut slopes = Vec::with_capacity(places.len());
    let (first, last) = (secants[0], secants[spans - 1]);
    let tied = between(last, first);
    // At an open end the parabola through the three outer knots, within the same bounds.
    let end = |outer: f64, inner: f64| (1.5 * outer - 0.5 * inner).clamp(0.5 * outer, 2.0 * outer);
    slopes.push(match (closed, spans) {
        (true, _) => tied,
        (false, 1) => first,
        (false, _) => end(first, secants[1]),
    });
    slopes.extend(secants.windows(2).map(|w| between(w[0], w[1])));
    slopes.push(match (closed, spans) {
        (true, _) => tied,
        (false, 1) => last,
        (false, _) => end(last, secants[spans - 2]),
    });
    slopes
}

/// Evenly spaced numbers from 0 to 1, at least two.
pub(super) fn uniform(knots: usize) -> Vec<f64> {
    (0..knots).map(|k| k as f64 / (knots - 1) as f64).collect()
}

/// The frames of a sequence (row-major, `dims` numbers each) at places in [0, 1], linear between frames.
///
/// Place 0 is the first frame, 1 the last; places beyond are held to the nearer end. Numbers that are no whole
/// frame at the end are left out; without a frame, or with `dims` 0, the result is empty.
pub fn resample(sequence: &[f64], dims: usize, places: &[f64]) -> Vec<f64> {
    if dims == 0 || sequence.len() < dims {
        return Vec::new();
    }
    let last = sequence.len() / dims - 1;
    let mut out = Vec::with_capacity(places.len() * dims);
    for place in places {
        push_frame(
            sequence,
            dims,
            place.clamp(0.0, 1.0) * last as f64,
            &mut out,
        );
    }
    out
}

/// Appends the frame at a fractional frame number within the sequence.
pub(super) fn push_frame(sequence: &[f64], dims: usize, at: f64, out: &mut Vec<f64>) {
    let last = sequence.len() / dims - 1;
    let before = (at.max(0.0) as usize).min(last);
    let after = (before + 1).min(last);
    let share = at - before as f64;
    let row = |f: usize| &sequence[f * dims..(f + 1) * dims];
    out.extend(
        row(before)
            .iter()
            .zip(row(after))
            .map(|(x, y)| x + (y - x) * share),
    );
}
