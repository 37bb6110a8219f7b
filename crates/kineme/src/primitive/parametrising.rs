//! What the parameters of a primitive are: adverbs, an effector's places, or principal coordinates.

use nalgebra::{DMatrix, DVector};

use super::exemplar::Exemplar;
use super::modelling::Modelling;
use super::selection::{leading, unit};
use super::space::{ParameterAxis, ParameterSource, ParameterSpace};
use crate::error::Result;

/// An effector's coordinate that varies less, metres, is no parameter.
const LEAST_SPREAD: f64 = 0.02;

/// The space of the exemplars' adverbs; `None` where they have none. An adverb that all exemplars share is dropped.
pub(super) fn adverbs(
    exemplars: &[Exemplar],
    modelling: &Modelling,
    notes: &mut Vec<String>,
) -> Result<Option<(ParameterSpace, Vec<f64>)>> {
    let n = exemplars.len();
    let Some(count) = exemplars[0].adverbs.as_ref().map(Vec::len) else {
        return Ok(None);
    };
    let values: Vec<f64> = exemplars
        .iter()
        .flat_map(|e| e.adverbs.iter().flatten().copied())
        .collect();
    let name = |d: usize| match modelling.adverbs.get(d) {
        Some(name) => name.clone(),
        None => format!("p{}", d + 1),
    };
    let found = spaced(&values, count, n, name, 0.0, notes);
    let space = ParameterSpace::new(found.axes, ParameterSource::Adverbs)?;
    Ok(Some((space, found.points)))
}

/// Columns of values as parameters.
struct Spaced {
    axes: Vec<ParameterAxis>,
    /// In [0, 1], row-major.
    points: Vec<f64>,
    /// The columns that vary.
    kept: Vec<usize>,
}

/// Axes and unit points of columns that vary by more than `least`; the others are dropped and noted.
fn spaced(
    values: &[f64],
    count: usize,
    n: usize,
    name: impl Fn(usize) -> String,
    least: f64,
    notes: &mut Vec<String>,
) -> Spaced {
    let (_, ranges) = unit(values, count, count, n);
    let (kept, dropped): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|&d| ranges[d][1] - ranges[d][0] > least);
    for d in dropped {
        notes.push(format!(
            "`{}` is {:.4} in all exemplars: no parameter",
            name(d),
            ranges[d][0]
        ));
    }
    let axes = kept.iter().map(|&d| ParameterAxis {
        name: name(d),
        low: ranges[d][0],
        high: ranges[d][1],
    });
    let columns: Vec<f64> = (0..n)
        .flat_map(|i| kept.iter().map(move |&d| values[i * count + d]))
        .collect();
    let (points, _) = unit(&columns, kept.len(), kept.len(), n);
    Spaced {
        axes: axes.collect(),
        points,
        kept,
    }
}

/// The space of an effector's places, `x, y, z` an exemplar.
pub(super) fn effector_space(
    effector: &str,
    places: &[[f64; 3]],
    notes: &mut Vec<String>,
) -> Result<(ParameterSpace, Vec<f64>)> {
    const COORDINATES: [&str; 3] = ["forward", "left", "up"];
    let values: Vec<f64> = places.iter().flatten().copied().collect();
    let name = |d: usize| format!("{effector}-{}", COORDINATES[d]);
    let found = spaced(&values, 3, places.len(), name, LEAST_SPREAD, notes);
    let source = ParameterSource::Effector {
        effector: effector.into(),
        coordinates: found.kept,
    };
    Ok((ParameterSpace::new(found.axes, source)?, found.points))
}

/// The space of the first principal coordinates: metres, root mean square over landmarks and phases.
pub(super) fn principal_space(
    shapes: &[Vec<f64>],
    gram: &DMatrix<f64>,
    dims: usize,
) -> Result<ParameterSpace> {
    let n = shapes.len();
    let length = shapes[0].len();
    let mut mean = vec![0.0; length];
    for s in shapes {
        for (m, v) in mean.iter_mut().zip(s) {
            *m += v / n as f64;
        }
    }
    let rows: Vec<f64> = (0..n).map(|a| gram.row(a).sum() / n as f64).collect();
    let all = rows.iter().sum::<f64>() / n as f64;
    let centred = DMatrix::from_fn(n, n, |a, b| gram[(a, b)] - rows[a] - rows[b] + all);
    let mut directions = Vec::with_capacity(dims * length);
    let mut axes = Vec::with_capacity(dims);
    for (d, (_, vector)) in leading(centred, dims).into_iter().enumerate() {
        let mut direction = DVector::zeros(length);
        for (a, s) in shapes.iter().enumerate() {
            for (x, (v, m)) in direction.iter_mut().zip(s.iter().zip(&mean)) {
                *x += vector[a] * (v - m);
            }
        }
        if direction.normalize_mut() <= f64::EPSILON {
            break;
        }
        let along = |s: &Vec<f64>| -> f64 {
            let offset = s.iter().zip(&mean).map(|(v, m)| v - m);
            offset.zip(direction.iter()).map(|(o, x)| o * x).sum()
        };
        let (low, high) = shapes
            .iter()
            .map(along)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        if high <= low {
            break;
        }
        axes.push(ParameterAxis {
            name: format!("shape-{}", d + 1),
            low,
            high,
        });
        directions.extend(direction.iter());
    }
    ParameterSpace::new(axes, ParameterSource::Principal { mean, directions })
}
