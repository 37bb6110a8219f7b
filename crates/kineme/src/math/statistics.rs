//! Statistics that more than one room needs: order statistics, correlation, agreement of partitions.

use std::collections::BTreeMap;

/// The `q`-quantile (0 to 1, linear between order statistics) of the finite values; `None` without any.
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if sorted.is_empty() {
        return None;
    }
    sorted.sort_unstable_by(f64::total_cmp);
    let place = q.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let low = place.floor() as usize;
    let high = place.ceil() as usize;
    Some(sorted[low] + (sorted[high] - sorted[low]) * (place - low as f64))
}

/// The median of the finite values; `None` without any.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Mean and sample standard deviation; the deviation of fewer than two values is 0.
pub fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let n = values.len();
    if n == 0 {
        return (f64::NAN, 0.0);
    }
    let mean = values.iter().sum::<f64>() / n as f64;
    if n < 2 {
        return (mean, 0.0);
    }
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (n - 1) as f64).sqrt())
}

/// Agreement of two partitions: adjusted Rand index and normalised mutual information.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Adjusted Rand index (Hubert and Arabie 1985): 1 for equal partitions, about 0 for chance.
    pub ari: f64,
    /// Mutual information over the arithmetic mean of the entropies, in [0, 1].
    pub nmi: f64,
}

/// Compares two partitions of the same items, given as labels.
///
/// # Panics
/// When the slices differ in length.
pub fn agreement(a: &[usize], b: &[usize]) -> Agreement {
    assert_eq!(a.len(), b.len(), "partitions of the same items");
    let mut cells: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut rows: BTreeMap<usize, f64> = BTreeMap::new();
    let mut columns: BTreeMap<usize, f64> = BTreeMap::new();
    for (&x, &y) in a.iter().zip(b) {
        *cells.entry((x, y)).or_default() += 1.0;
        *rows.entry(x).or_default() += 1.0;
        *columns.entry(y).or_default() += 1.0;
    }
    let n = a.len() as f64;
    let pairs = |counts: &mut dyn Iterator<Item = f64>| counts.map(|c| c * (c - 1.0) / 2.0).sum();
    let together: f64 = pairs(&mut cells.values().copied());
    let in_rows: f64 = pairs(&mut rows.values().copied());
    let in_columns: f64 = pairs(&mut columns.values().copied());
    let all = n * (n - 1.0) / 2.0;
    let expected = if all > 0.0 {
        in_rows * in_columns / all
    } else {
        0.0
    };
    let most = 0.5 * (in_rows + in_columns);
    let ari = if (most - expected).abs() < 1e-12 {
        1.0
    } else {
        (together - expected) / (most - expected)
    };
    let entropy = |counts: &BTreeMap<usize, f64>| -> f64 {
        counts.values().map(|c| -(c / n) * (c / n).ln()).sum()
    };
    let (row_entropy, column_entropy) = (entropy(&rows), entropy(&columns));
    let information: f64 = cells
        .iter()
        .map(|(&(x, y), c)| c / n * (c * n / (rows[&x] * columns[&y])).ln())
        .sum();
    let mean_entropy = 0.5 * (row_entropy + column_entropy);
    let nmi = if mean_entropy < 1e-12 {
        1.0
    } else {
        (information / mean_entropy).clamp(0.0, 1.0)
    };
    Agreement { ari, nmi }
}

/// Labels for [`agreement`] in which every item without a group is a cluster of its own.
pub fn noise_as_singletons(labels: &[Option<usize>]) -> Vec<usize> {
    let first_free = labels.iter().flatten().max().map_or(0, |m| m + 1);
    let mut free = first_free..;
    labels
        .iter()
        .map(|l| l.unwrap_or_else(|| free.next().unwrap_or(first_free)))
        .collect()
}
