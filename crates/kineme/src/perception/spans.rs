//! From answers to single frames to what was done when, and to an answer for the whole.

use crate::primitive::{Posterior, Reading, Recognition, Span};

/// What each answer is worth at a frame: the primitives, and last none of them, rest included.
fn worths(posterior: &Posterior, binary: bool) -> Vec<f64> {
    let nothing = match binary {
        true => posterior.none,
        false => posterior.rest + posterior.none,
    };
    let mut worths = posterior.primitives.clone();
    worths.push(nothing);
    worths
}

/// The division of the frames in which the answers have the greatest sum of probabilities, none of its parts being
/// shorter than `dwell` frames (the whole, if that is shorter): dynamic programming over (frame, answer).
fn division(worths: &[Vec<f64>], dwell: usize) -> Vec<usize> {
    let (frames, answers) = (worths.len(), worths[0].len());
    let dwell = dwell.clamp(1, frames);
    // Sums of each answer's worths before each frame.
    let mut sums = vec![vec![0.0; answers]];
    for (f, row) in worths.iter().enumerate() {
        sums.push((0..answers).map(|a| sums[f][a] + row[a]).collect());
    }
    // best[f][a]: the first f frames, the last part answering a and long enough; and where that part began to be so.
    let mut best = vec![vec![f64::NEG_INFINITY; answers]; frames + 1];
    let mut begun = vec![vec![None; answers]; frames + 1];
    for f in dwell..=frames {
        let cut = f - dwell;
        let before = (0..answers)
            .max_by(|&a, &b| best[cut][a].total_cmp(&best[cut][b]).then(b.cmp(&a)))
            .unwrap_or(0);
        let start = match cut {
            0 => 0.0,
            _ => best[cut][before],
        };
        for a in 0..answers {
            let fresh = start + sums[f][a] - sums[cut][a];
            let longer = best[f - 1][a] + worths[f - 1][a];
            if longer >= fresh {
                best[f][a] = longer;
            } else {
                best[f][a] = fresh;
                begun[f][a] = Some(before);
            }
        }
    }
    let mut f = frames;
    let mut answer = (0..answers)
        .max_by(|&a, &b| best[f][a].total_cmp(&best[f][b]).then(b.cmp(&a)))
        .unwrap_or(0);
    let mut labels = vec![answer; frames];
    while f > 0 {
        labels[f - 1] = answer;
        match begun[f][answer] {
            None => f -= 1,
            Some(before) => {
                labels[f - dwell..f].fill(answer);
                f -= dwell;
                answer = before;
            }
        }
    }
    labels
}

/// Who did what when.
pub(super) fn spans(
    readings: &[Reading],
    rate_hz: f64,
    dwell_secs: f64,
    binary: bool,
) -> Vec<Span> {
    let worths: Vec<Vec<f64>> = readings
        .iter()
        .map(|r| worths(&r.posterior, binary))
        .collect();
    if worths.is_empty() {
        return Vec::new();
    }
    let dwell = (dwell_secs * rate_hz).round().max(1.0) as usize;
    let labels = division(&worths, dwell);
    let last = labels.len() - 1;
    let mut spans = Vec::new();
    let mut from = 0;
    for f in 1..=labels.len() {
        if f < labels.len() && labels[f] == labels[from] {
            continue;
        }
        let answer = labels[from];
        let sum: f64 = worths[from..f].iter().map(|w| w[answer]).sum();
        spans.push(Span {
            start_secs: from as f64 / rate_hz,
            end_secs: f.min(last) as f64 / rate_hz,
            primitive: (answer + 1 < worths[0].len()).then_some(answer),
            confidence: sum / (f - from) as f64,
        });
        from = f;
    }
    spans
}

/// What a motion is as a whole. Frames are no independent witnesses, so their answers are averaged, not multiplied.
///
/// Of classes that compete: the motion is at rest as far as its liveliest frame is, and primitives and none share what
/// is left as the frames do, each counting as much as it is not at rest. Of binary judgements: the mean of each, and
/// none is what the greatest leaves.
pub(super) fn whole(
    readings: &[Reading],
    rate_hz: f64,
    dwell_secs: f64,
    binary: bool,
) -> Recognition {
    let count = readings.first().map_or(0, |r| r.posterior.primitives.len());
    let mean = |of: &dyn Fn(&Reading) -> f64| {
        readings.iter().map(of).sum::<f64>() / readings.len().max(1) as f64
    };
    let live = mean(&|r| 1.0 - r.posterior.rest);
    let liveliest = readings
        .iter()
        .map(|r| 1.0 - r.posterior.rest)
        .fold(0.0, f64::max);
    let share = match binary {
        true => 1.0,
        false if live > 0.0 => liveliest / live,
        false => 0.0,
    };
    let primitives: Vec<f64> = (0..count)
        .map(|k| share * mean(&|r| r.posterior.primitives[k]))
        .collect();
    let posterior = if binary {
        let most = primitives.iter().copied().fold(0.0, f64::max);
        Posterior {
            primitives,
            rest: 0.0,
            none: 1.0 - most,
        }
    } else {
        Posterior {
            primitives,
            rest: 1.0 - liveliest,
            none: share * mean(&|r| r.posterior.none),
        }
    };
    let leading = posterior.leading().map(|(k, _)| k);
    Recognition {
        parameters: leading.map_or(Vec::new(), |k| parameters(readings, k)),
        posterior,
        novelty: mean(&|r| r.novelty),
        spans: spans(readings, rate_hz, dwell_secs, binary),
    }
}

/// The mean of a primitive's parameters over the frames in which it leads, each as sure as it is.
fn parameters(readings: &[Reading], primitive: usize) -> Vec<f64> {
    let mut sum = Vec::new();
    let mut weights = 0.0;
    for r in readings {
        if let Some(place) = r.place.as_ref().filter(|p| p.primitive == primitive) {
            let w = r.posterior.primitives[primitive];
            sum.resize(place.parameters.len(), 0.0);
            for (s, p) in sum.iter_mut().zip(&place.parameters) {
                *s += w * p;
            }
            weights += w;
        }
    }
    if weights == 0.0 {
        return Vec::new();
    }
    sum.iter().map(|s| s / weights).collect()
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    /// Lengths of the runs of equal labels.
    fn runs(labels: &[usize]) -> Vec<usize> {
        labels.chunk_by(|a, b| a == b).map(<[usize]>::len).collect()
    }

    #[test]
    fn the_division_is_the_best_of_all_without_short_parts() {
        let mut rng = Pcg64::seed_from_u64(12);
        for case in 0..150 {
            let (frames, dwell) = (1 + case % 7, 1 + case / 7 % 4);
            let worths: Vec<Vec<f64>> = (0..frames)
                .map(|_| (0..3).map(|_| rng.random_range(0.0..1.0)).collect())
                .collect();
            let worth = |labels: &[usize]| -> f64 {
                labels.iter().zip(&worths).map(|(&l, row)| row[l]).sum()
            };
            let long = |labels: &[usize]| runs(labels).iter().all(|&r| r >= dwell.min(frames));
            let all = (0..3_usize.pow(frames as u32)).map(|code| {
                let digit = |f: usize| code / 3_usize.pow(f as u32) % 3;
                (0..frames).map(digit).collect::<Vec<usize>>()
            });
            let best = all
                .filter(|l| long(l))
                .map(|l| worth(&l))
                .fold(0.0, f64::max);
            let found = division(&worths, dwell);
            assert!(long(&found), "{dwell}: {found:?}");
            assert!((worth(&found) - best).abs() < 1e-12, "{dwell}: {found:?}");
        }
    }
}
