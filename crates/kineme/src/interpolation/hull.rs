//! The nearest point of a convex hull, by Wolfe's algorithm.

use nalgebra::{DMatrix, DVector};

/// How far beyond the hull of the exemplars parameters may go: the share by which [`super::Interpolator::clamped`]
/// dilates it about its centre.
pub const HULL_MARGIN: f64 = 0.1;

/// So many times the hull's size from it, a coordinate of a query is far off: how far is no matter, and would cost the
/// digits in which the hull's points differ.
const FAR: f64 = 1e3;

/// Share of the hull's size below which a query counts as inside.
const INSIDE: f64 = 1e-10;

/// The point of the convex hull of `points` (row-major, at least one) that is nearest to `p`; `p` itself where it is
/// inside. "Finding the nearest point in a polytope", Wolfe 1976.
pub(super) fn nearest(points: &[f64], p: &[f64]) -> Vec<f64> {
    let dims = p.len();
    if dims == 0 {
        return Vec::new();
    }
    let near = |d: usize| {
        let own = points.iter().skip(d).step_by(dims).copied();
        let low = own.clone().fold(f64::INFINITY, f64::min);
        let high = own.fold(f64::NEG_INFINITY, f64::max);
        [low, high]
    };
    let boxed: Vec<[f64; 2]> = (0..dims).map(near).collect();
    let widest = boxed.iter().map(|[l, h]| h - l).fold(0.0, f64::max);
    let near = p.iter().zip(&boxed);
    let near: Vec<f64> = near
        .map(|(x, [low, high])| x.clamp(low - FAR * widest, high + FAR * widest))
        .collect();
    let p = near.as_slice();
    // Seen from p: the nearest point is the one of least norm.
    let vertices: Vec<DVector<f64>> = points
        .chunks_exact(dims)
        .map(|v| DVector::from_iterator(dims, v.iter().zip(p).map(|(v, p)| v - p)))
        .collect();
    let size = vertices.iter().map(DVector::amax).fold(0.0, f64::max);
    if !(size.is_finite() && size > 0.0) {
        return p.to_vec();
    }
    let least = least_norm(&vertices, size);
    if least.amax() <= INSIDE * size {
        return p.to_vec();
    }
    p.iter().zip(&least).map(|(p, x)| p + x).collect()
}

/// The point of least norm in the hull of `vertices`, of the given size.
fn least_norm(vertices: &[DVector<f64>], size: f64) -> DVector<f64> {
    let norm = |i: &usize| vertices[*i].norm_squared();
    let all = || 0..vertices.len();
    let first = all()
        .min_by(|a, b| norm(a).total_cmp(&norm(b)))
        .unwrap_or(0);
    let mut corral = vec![first];
    let mut shares = vec![1.0];
    let mut x = vertices[first].clone();
    // Each major cycle lowers the norm strictly, so it ends; the bound is for what rounding may do.
    for _ in 0..100 + 10 * vertices.len() {
        let along = |i: &usize| vertices[*i].dot(&x);
        let Some(next) = all().min_by(|a, b| along(a).total_cmp(&along(b))) else {
            break;
        };
        let gain = x.norm_squared() - along(&next);
        if gain <= 1e-15 * size * size || corral.contains(&next) {
            break;
        }
        let (mut trial, mut parts) = (corral.clone(), shares.clone());
        trial.push(next);
        parts.push(0.0);
        if !settle(vertices, &mut trial, &mut parts) {
            break;
        }
        let moved = combine(vertices, &trial, &parts);
        if moved.norm_squared() >= x.norm_squared() {
            break;
        }
        (corral, shares, x) = (trial, parts, moved);
    }
    x
}

/// Wolfe's minor cycle: drops vertices until the point of least norm in the affine hull of the rest lies inside them.
/// False where rounding leaves no such point.
fn settle(vertices: &[DVector<f64>], corral: &mut Vec<usize>, shares: &mut Vec<f64>) -> bool {
    while let Some(wanted) = affine_least_norm(vertices, corral) {
        if wanted.iter().all(|w| *w > 0.0) {
            *shares = wanted;
            return true;
        }
        // As far toward it as all shares stay positive; those that vanish go.
        let step = shares
            .iter()
            .zip(&wanted)
            .filter(|(_, w)| **w <= 0.0)
            .map(|(s, w)| s / (s - w))
            .fold(1.0, |a: f64, b| if b < a { b } else { a });
        let blended = shares.iter().zip(&wanted).map(|(s, w)| s + step * (w - s));
        let blended: Vec<f64> = blended.collect();
        let dropped = (0..blended.len())
            .filter(|&i| wanted[i] <= 0.0)
            .min_by(|&a, &b| blended[a].total_cmp(&blended[b]));
        let kept: Vec<usize> = (0..blended.len())
            .filter(|&i| blended[i] > 0.0 && Some(i) != dropped)
            .collect();
        *corral = kept.iter().map(|&i| corral[i]).collect();
        *shares = kept.iter().map(|&i| blended[i]).collect();
    }
    false
}

/// Shares, summing to one, of the point of least norm in the affine hull; `None` where the vertices depend on each other.
fn affine_least_norm(vertices: &[DVector<f64>], corral: &[usize]) -> Option<Vec<f64>> {
    let (&first, others) = corral.split_first()?;
    let origin = &vertices[first];
    if others.is_empty() {
        return Some(vec![1.0]);
    }
    let edges: Vec<DVector<f64>> = others.iter().map(|&i| &vertices[i] - origin).collect();
    let edges = DMatrix::from_columns(&edges);
    let qr = edges.qr();
    let mut right = -origin.clone();
    qr.q_tr_mul(&mut right);
    let size = others.len();
    if size > origin.len() {
        return None;
    }
    let steps = qr
        .r()
        .solve_upper_triangular(&right.rows(0, size).into_owned())?;
    let rest = 1.0 - steps.sum();
    Some(std::iter::once(rest).chain(steps.iter().copied()).collect())
}

fn combine(vertices: &[DVector<f64>], corral: &[usize], shares: &[f64]) -> DVector<f64> {
    let mut x = DVector::zeros(vertices[corral[0]].len());
    for (&i, share) in corral.iter().zip(shares) {
        x.axpy(*share, &vertices[i], 1.0);
    }
    x
}
