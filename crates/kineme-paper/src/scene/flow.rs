//! The flowfield of a primitive in the three coordinates in which its postures differ most.

use kineme_report::scene::{Floats, Flow};
use nalgebra::{DMatrix, DVector};

/// The flow of postures on the lattice and of the exemplars: rows of joint coordinates; `None` where nothing moves.
pub fn flow(lattice: &[Vec<f64>], exemplars: &[Vec<f64>]) -> Option<Flow> {
    let all = || lattice.iter().chain(exemplars);
    let (count, dof) = (all().count(), lattice.first()?.len());
    let mut mean = DVector::zeros(dof);
    for row in all() {
        mean += DVector::from_column_slice(row) / count as f64;
    }
    let centred = DMatrix::from_fn(count, dof, |i, c| {
        let row = if i < lattice.len() {
            &lattice[i]
        } else {
            &exemplars[i - lattice.len()]
        };
        row[c] - mean[c]
    });
    let covariance = centred.tr_mul(&centred) / count as f64;
    let whole = covariance.trace();
    // No visible movement: a thousandth of a radian.
    if whole.is_nan() || whole < 1e-6 {
        return None;
    }
    let eigen = covariance.symmetric_eigen();
    let mut order: Vec<usize> = (0..dof).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    order.truncate(3);
    let axes: Vec<DVector<f64>> = order
        .iter()
        .map(|&k| {
            let axis = eigen.eigenvectors.column(k).into_owned();
            // An eigenvector's sign is arbitrary: its largest entry shall be positive.
            let sign = axis[axis.iamax()].signum();
            axis * sign
        })
        .collect();
    let coordinates: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let row = centred.row(i).transpose();
            [0, 1, 2].map(|k| axes.get(k).map_or(0.0, |axis| axis.dot(&row)))
        })
        .collect();
    let (of_lattice, of_exemplars) = coordinates.split_at(lattice.len());
    let explained = [0, 1, 2].map(|k| order.get(k).map_or(0.0, |&e| eigen.eigenvalues[e] / whole));
    Some(Flow {
        explained,
        lattice: Floats::pack(of_lattice.iter().flatten().copied()),
        exemplars: Floats::pack(of_exemplars.iter().flatten().copied()),
    })
}
