//! [`Curve`]: several channels over phase, cubic between evenly spaced knots.

/// Channels over phase in [0, 1]: cubic Hermite pieces between evenly spaced knots, twice continuously differentiable.
///
/// A curve is linear in its values, so curves on the same knots are blended by blending values and slopes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    channels: usize,
    /// Knot-major.
    values: Vec<f64>,
    /// Per unit phase, knot-major.
    slopes: Vec<f64>,
}

impl Curve {
    /// The spline through `values` (knot-major, at least two knots). A closed curve repeats: its last knot is its first,
    /// and `values` already agree there.
    pub fn through(values: Vec<f64>, channels: usize, closed: bool) -> Self {
        let knots = values.len() / channels;
        let slopes = if closed {
            closed_slopes(&values, knots, channels)
        } else {
            open_slopes(&values, knots, channels)
        };
        Self {
            channels,
            values,
            slopes,
        }
    }

    /// The weighted sum of curves on the same knots.
    pub fn blended<'a>(curves: impl IntoIterator<Item = &'a Curve>, weights: &[f64]) -> Self {
        let mut curves = curves.into_iter().zip(weights);
        let (first, w) = curves.next().expect("a primitive has exemplars");
        let mut sum = Self {
            channels: first.channels,
            values: first.values.iter().map(|v| v * w).collect(),
            slopes: first.slopes.iter().map(|v| v * w).collect(),
        };
        for (curve, w) in curves {
            for (s, v) in sum.values.iter_mut().zip(&curve.values) {
                *s += w * v;
            }
            for (s, v) in sum.slopes.iter_mut().zip(&curve.slopes) {
                *s += w * v;
            }
        }
        sum
    }

    pub fn knots(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Adds `weight` times the channels `first..first + out.len()` at a phase to `out`.
    pub fn add(&self, phase: f64, weight: f64, first: usize, out: &mut [f64]) {
        let (k, s, _) = self.piece(phase);
        let (s2, s3) = (s * s, s * s * s);
        let h = 1.0 / (self.knots() - 1) as f64;
        let basis = [
            2.0 * s3 - 3.0 * s2 + 1.0,
            3.0 * s2 - 2.0 * s3,
            h * (s3 - 2.0 * s2 + s),
            h * (s3 - s2),
        ];
        self.combine(k, basis.map(|b| b * weight), first, out);
    }

    /// Adds `weight` times the derivatives by phase of the channels `first..` to `out`.
    pub fn add_slope(&self, phase: f64, weight: f64, first: usize, out: &mut [f64]) {
        let (k, s, pieces) = self.piece(phase);
        let s2 = s * s;
        let basis = [
            (6.0 * s2 - 6.0 * s) * pieces,
            (6.0 * s - 6.0 * s2) * pieces,
            3.0 * s2 - 4.0 * s + 1.0,
            3.0 * s2 - 2.0 * s,
        ];
        self.combine(k, basis.map(|b| b * weight), first, out);
    }

    /// One channel at a phase.
    pub fn channel(&self, phase: f64, channel: usize) -> f64 {
        let mut out = [0.0];
        self.add(phase, 1.0, channel, &mut out);
        out[0]
    }

    fn combine(&self, k: usize, basis: [f64; 4], first: usize, out: &mut [f64]) {
        let a = k * self.channels + first;
        let b = a + self.channels;
        let n = out.len();
        let values = self.values[a..a + n].iter().zip(&self.values[b..b + n]);
        let slopes = self.slopes[a..a + n].iter().zip(&self.slopes[b..b + n]);
        for ((o, (v0, v1)), (m0, m1)) in out.iter_mut().zip(values).zip(slopes) {
            *o += basis[0] * v0 + basis[1] * v1 + basis[2] * m0 + basis[3] * m1;
        }
    }

    /// The piece that holds a phase, the place in it in [0, 1], the number of pieces.
    fn piece(&self, phase: f64) -> (usize, f64, f64) {
        let pieces = self.knots() - 1;
        let at = phase.clamp(0.0, 1.0) * pieces as f64;
        let k = (at.floor() as usize).min(pieces - 1);
        (k, at - k as f64, pieces as f64)
    }
}

/// Slopes that make the second derivative continuous; at the ends those of the parabola through three knots.
fn open_slopes(values: &[f64], knots: usize, channels: usize) -> Vec<f64> {
    let per_phase = (knots - 1) as f64;
    let row = |k: usize| &values[k * channels..(k + 1) * channels];
    let mut slopes = vec![0.0; values.len()];
    if knots == 2 {
        for c in 0..channels {
            let slope = (row(1)[c] - row(0)[c]) * per_phase;
            slopes[c] = slope;
            slopes[channels + c] = slope;
        }
        return slopes;
    }
    let last = knots - 1;
    for c in 0..channels {
        let (a, b, d) = (row(0)[c], row(1)[c], row(2)[c]);
        slopes[c] = (4.0 * b - 3.0 * a - d) * 0.5 * per_phase;
        let (a, b, d) = (row(last)[c], row(last - 1)[c], row(last - 2)[c]);
        slopes[last * channels + c] = (3.0 * a - 4.0 * b + d) * 0.5 * per_phase;
    }
    // m[k-1] + 4 m[k] + m[k+1] = 3 (y[k+1] - y[k-1]) / h, the ends known (Thomas algorithm, one matrix for all channels).
    let mut upper = vec![0.0; knots];
    for k in 1..last {
        let pivot = 4.0 - upper[k - 1];
        upper[k] = 1.0 / pivot;
        for c in 0..channels {
            let mut right = 3.0 * (row(k + 1)[c] - row(k - 1)[c]) * per_phase;
            if k == last - 1 {
                right -= slopes[last * channels + c];
            }
            let before = slopes[(k - 1) * channels + c];
            slopes[k * channels + c] = (right - before) / pivot;
        }
    }
    for k in (1..last - 1).rev() {
        for c in 0..channels {
            slopes[k * channels + c] -= upper[k] * slopes[(k + 1) * channels + c];
        }
    }
    slopes
}

/// As [`open_slopes`], the second derivative continuous where the curve closes, too.
fn closed_slopes(values: &[f64], knots: usize, channels: usize) -> Vec<f64> {
    // The cyclic system is diagonally dominant by 2: Gauss-Seidel sweeps gain a factor of at least 3.7 each, so that 40
    // of them reach the last bit.
    const SWEEPS: usize = 40;
    let pieces = knots - 1;
    let per_phase = pieces as f64;
    let mut slopes = vec![0.0; values.len()];
    for _ in 0..SWEEPS {
        for k in 0..pieces {
            let (before, after) = ((k + pieces - 1) % pieces, (k + 1) % pieces);
            for c in 0..channels {
                let rise = values[after * channels + c] - values[before * channels + c];
                let sides = slopes[before * channels + c] + slopes[after * channels + c];
                slopes[k * channels + c] = 0.25 * (3.0 * rise * per_phase - sides);
            }
        }
    }
    let (start, end) = slopes.split_at_mut(pieces * channels);
    end.copy_from_slice(&start[..channels]);
    slopes
}
