//! Windows of the last moments of movements.

use std::collections::VecDeque;

/// The features of the last moments of a stream.
#[derive(Debug, Clone)]
pub(super) struct Recent {
    secs: f64,
    samples: usize,
    frames: VecDeque<(f64, Vec<f64>)>,
}

impl Recent {
    /// Holds `secs`, told as `samples` of them, at least two.
    pub fn new(secs: f64, samples: usize) -> Self {
        Self {
            secs,
            samples,
            frames: VecDeque::new(),
        }
    }

    /// Adds a frame, later than the last, and forgets what no window reaches any more.
    pub fn push(&mut self, at: f64, features: Vec<f64>) {
        self.frames.push_back((at, features));
        let begin = at - self.secs;
        while self
            .frames
            .get(1)
            .is_some_and(|(second, _)| *second <= begin)
        {
            self.frames.pop_front();
        }
    }

    /// The window that ends with the last frame, evenly sampled; before the first frame the body stood as in it.
    pub fn window(&self) -> Vec<f64> {
        let Some(&(now, _)) = self.frames.back() else {
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut after = 0;
        for k in 0..self.samples {
            let back = (self.samples - 1 - k) as f64 / (self.samples - 1) as f64;
            let at = now - self.secs * back;
            while after + 1 < self.frames.len() && self.frames[after].0 < at {
                after += 1;
            }
            let (t1, x1) = &self.frames[after];
            let (t0, x0) = &self.frames[after.saturating_sub(1)];
            let share = match t1 - t0 {
                gap if gap > 0.0 => ((at - t0) / gap).clamp(0.0, 1.0),
                _ => 1.0,
            };
            out.extend(x0.iter().zip(x1).map(|(a, b)| a + share * (b - a)));
        }
        out
    }
}

/// The windows of a movement (frame-major features, `dims` a frame), one every `stride_secs` and one at its end.
pub(super) fn windows(
    features: &[f64],
    dims: usize,
    rate_hz: f64,
    mut recent: Recent,
    stride_secs: f64,
) -> Vec<Vec<f64>> {
    let frames = features.len() / dims;
    let mut windows = Vec::new();
    let mut next = stride_secs;
    for (f, frame) in features.chunks_exact(dims).enumerate() {
        let at = f as f64 / rate_hz;
        recent.push(at, frame.to_vec());
        if at >= next || f + 1 == frames {
            windows.push(recent.window());
            next += stride_secs;
        }
    }
    windows
}
