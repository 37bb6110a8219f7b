//! Sets of phases as sorted, disjoint intervals, in pieces of phase.

/// Sorted, disjoint, closed intervals.
pub(super) type Intervals = Vec<(f64, f64)>;

/// The range of one coordinate over parameters, at the ends of pieces of phase; linear between them.
#[derive(Debug, Clone)]
pub(super) struct Envelope {
    /// Least values, one more than pieces.
    pub low: Vec<f64>,
    /// Greatest values.
    pub high: Vec<f64>,
}

impl Envelope {
    /// The phases within `within` at which the coordinate can come within `delta` of `x`: the interval search. Every
    /// piece is looked at, and its ends are where the envelope crosses, which between two values of a linear piece
    /// needs no bisection. A coordinate that was not seen (NaN) can be anything.
    pub fn attained(&self, x: f64, delta: f64, within: &Intervals, out: &mut Intervals) {
        out.clear();
        if x.is_nan() {
            out.extend(within);
            return;
        }
        let (above, below) = (x + delta, x - delta);
        for &(from, to) in within {
            let last = (self.low.len() - 2) as f64;
            let first = from.floor().min(last) as usize;
            let end = (to.ceil() as usize).clamp(first + 1, self.low.len() - 1);
            for i in first..end {
                let low = share(above - self.low[i], above - self.low[i + 1]);
                let high = share(self.high[i] - below, self.high[i + 1] - below);
                let a = (i as f64 + low.0.max(high.0)).max(from);
                let b = (i as f64 + low.1.min(high.1)).min(to);
                if a > b {
                    continue;
                }
                match out.last_mut() {
                    Some(before) if before.1 >= a => before.1 = before.1.max(b),
                    _ => out.push((a, b)),
                }
            }
        }
    }

    /// How far `x` is from the envelope at the end of a piece, radians; 0 within and where it was not seen.
    pub fn gap(&self, x: f64, end: usize) -> f64 {
        (self.low[end] - x).max(x - self.high[end]).max(0.0)
    }
}

/// The part of [0, 1] in which a linear function of these ends is not negative; from 1 to 0 where it is nowhere.
fn share(first: f64, last: f64) -> (f64, f64) {
    match (first >= 0.0, last >= 0.0) {
        (true, true) => (0.0, 1.0),
        (false, false) => (1.0, 0.0),
        (true, false) => (0.0, first / (first - last)),
        (false, true) => (first / (first - last), 1.0),
    }
}

/// What of all phases is not before the least of a set.
pub(super) fn not_before(set: &Intervals, pieces: usize) -> Intervals {
    let least = set.first().map_or(0.0, |i| i.0);
    vec![(least, pieces as f64)]
}

/// The total length.
pub(super) fn length(set: &Intervals) -> f64 {
    set.iter().map(|(a, b)| b - a).sum()
}

/// Mean and variance of a uniform draw; of single points where that is all there is.
pub(super) fn moments(set: &Intervals) -> Option<(f64, f64)> {
    let whole = length(set);
    let weight = |(a, b): &(f64, f64)| match whole > 0.0 {
        true => (b - a) / whole,
        false => 1.0 / set.len() as f64,
    };
    if set.is_empty() {
        return None;
    }
    let mean: f64 = set.iter().map(|i| weight(i) * 0.5 * (i.0 + i.1)).sum();
    let square = |i: &(f64, f64)| {
        let off = 0.5 * (i.0 + i.1) - mean;
        weight(i) * (off * off + (i.1 - i.0).powi(2) / 12.0)
    };
    Some((mean, set.iter().map(square).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tent of least values i, down again, with greatest values one higher.
    fn tent() -> Envelope {
        let low = vec![0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0];
        let high = low.iter().map(|x| x + 1.0).collect();
        Envelope { low, high }
    }

    #[test]
    fn a_value_is_attained_on_the_way_out_and_back() {
        let all = vec![(0.0, 6.0)];
        for (x, delta, within, expected) in [
            (2.0, 0.0, all.clone(), vec![(1.0, 2.0), (4.0, 5.0)]),
            (2.0, 0.5, all.clone(), vec![(0.5, 2.5), (3.5, 5.5)]),
            (3.0, 0.0, all.clone(), vec![(2.0, 4.0)]),
            (4.5, 0.4, all.clone(), vec![]),
            (4.5, 0.5, all.clone(), vec![(3.0, 3.0)]),
            (2.0, 0.0, vec![(1.5, 4.25)], vec![(1.5, 2.0), (4.0, 4.25)]),
            (f64::NAN, 0.0, vec![(1.5, 4.25)], vec![(1.5, 4.25)]),
            (0.0, 0.0, vec![(6.0, 6.0)], vec![(6.0, 6.0)]),
        ] {
            let mut out = Vec::new();
            tent().attained(x, delta, &within, &mut out);
            assert_eq!(out, expected, "{x} {delta} {within:?}");
        }
    }

    #[test]
    fn moments_are_those_of_a_uniform_draw() {
        let (mean, variance) = moments(&vec![(0.0, 1.0), (2.0, 3.0)]).expect("a set");
        assert_eq!(mean, 1.5);
        assert!((variance - (1.0 + 1.0 / 12.0)).abs() < 1e-15);
        assert_eq!(moments(&vec![(2.0, 2.0)]), Some((2.0, 0.0)));
        assert_eq!(moments(&Vec::new()), None);
    }
}
