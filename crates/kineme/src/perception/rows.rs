//! Where in its parameter space a primitive is sampled.

use crate::primitive::{ParameterSource, Primitive};

/// Parameters at most that a lattice covers; of more, the exemplars' own places and their middle stand for all.
pub(super) const MOST_DIMS: usize = 3;

/// The places of an even lattice over [0, 1]^m, ends included, the last parameter changing fastest.
pub(super) fn lattice(dims: usize, nodes: usize) -> Vec<Vec<f64>> {
    let place = |i: usize| i as f64 / (nodes.max(2) - 1) as f64;
    let of = |at: usize| {
        let digit = |d: usize| at / nodes.pow((dims - 1 - d) as u32) % nodes;
        (0..dims).map(|d| place(digit(d))).collect()
    };
    (0..nodes.pow(dims as u32)).map(of).collect()
}

/// Whether parameters lie near the exemplars' hull, so that f is asked there and not at the nearest place that does.
pub(super) fn is_inside(primitive: &Primitive, p: &[f64]) -> bool {
    let near = primitive.interpolator().clamped(p);
    near.iter().zip(p).all(|(a, b)| (a - b).abs() < 1e-9)
}

/// The exemplars' places that a lattice does not hold: of principal coordinates and of places of effectors all, of
/// adverbs, which people write at the lattice's corners, none.
pub(super) fn own_places(primitive: &Primitive) -> Vec<Vec<f64>> {
    let dims = primitive.parameters().dims();
    let adverbs = *primitive.parameters().source() == ParameterSource::Adverbs;
    if dims == 0 || (adverbs && dims <= MOST_DIMS) {
        return Vec::new();
    }
    let own = (0..primitive.exemplars().len()).map(|i| primitive.point(i).to_vec());
    let middle = (dims > MOST_DIMS).then(|| primitive.middle());
    own.chain(middle).collect()
}

/// Whether a primitive's parameters have a meaning, so that its executions span a manifold: principal coordinates of a
/// few people do not.
pub(super) fn manifold(primitive: &Primitive) -> bool {
    let source = primitive.parameters().source();
    !matches!(source, ParameterSource::Principal { .. })
}
