//! Pairs of exemplars of one primitive, by which is told how its executions differ.

/// At most so many pairs a primitive.
pub(super) const MOST_PAIRS: usize = 200;

/// Pairs of members, evenly taken where they are many.
pub(super) fn all_pairs(members: &[usize]) -> Vec<(usize, usize)> {
    let n = members.len();
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    let step = (n * n.saturating_sub(1) / 2).div_ceil(MOST_PAIRS).max(1);
    let pairs = pairs.step_by(step);
    pairs.map(|(i, j)| (members[i], members[j])).collect()
}

/// Of what is left between pairs, each with its size, the larger half: who is new will be as far from those who are known
/// as the most different of them are from one another.
pub(super) fn farther<R>(mut residuals: Vec<(f64, R)>) -> Vec<R> {
    if residuals.len() > 1 {
        residuals.sort_by(|a, b| a.0.total_cmp(&b.0));
        residuals.drain(..residuals.len() / 2);
    }
    residuals.into_iter().map(|(_, r)| r).collect()
}
