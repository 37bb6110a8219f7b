//! Parameters kept to the dilated hull of the exemplars.

use kineme::interpolation::{HULL_MARGIN, Interpolator, Method};
use proptest::prelude::*;

use super::{largest_difference, uniform};

fn over(points: &[f64], n: usize, dims: usize) -> Interpolator {
    Interpolator::new(points, n, dims, &Method::Shepard { power: 2.0 }).expect("an interpolator")
}

#[test]
fn known_hulls() {
    let check = |points: &[f64], p: &[f64], wanted: &[f64]| {
        let n = points.len() / p.len();
        let found = over(points, n, p.len()).clamped(p);
        let off = largest_difference(&found, wanted);
        assert!(
            off < 1e-12,
            "{p:?} of {points:?}: {found:?}, not {wanted:?}"
        );
    };
    // The unit square with a point inside dilates to [-0.05, 1.05].
    let square = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.5];
    check(&square, &[0.3, 1.04], &[0.3, 1.04]);
    check(&square, &[0.3, 7.0], &[0.3, 1.05]);
    check(&square, &[-3.0, 7.0], &[-0.05, 1.05]);
    check(&square, &[1.05, 0.5], &[1.05, 0.5]);
    // However far off: no digit of the hull is lost.
    for far in [1e3, 1e9, 1e17, 1e300] {
        check(&square, &[far, 0.25], &[1.05, 0.25]);
        check(&square, &[-far, far], &[-0.05, 1.05]);
    }
    // A segment in the plane: what is beside it falls onto it.
    check(&[0.0, 0.0, 1.0, 1.0], &[1.0, 0.0], &[0.5, 0.5]);
    check(&[0.0, 0.0, 1.0, 1.0], &[9.0, 9.0], &[1.05, 1.05]);
    check(&[0.2, 0.7], &[5.0, 5.0], &[0.2, 0.7]);
    check(&[0.2, 0.7, 0.2, 0.7], &[5.0, 5.0], &[0.2, 0.7]);
    check(&[0.0, 1.0, 0.5], &[-2.0], &[-0.05]);
    assert_eq!(over(&[], 3, 0).clamped(&[]), Vec::<f64>::new());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// The optimality of a nearest point x: no vertex lies farther toward p, `(p - x) (v - x) <= 0` for all v.
    #[test]
    fn no_point_of_the_hull_is_nearer(n in 1usize..=50, dims in 1usize..=4, seed in any::<u64>(), reach in 0.2..4.0) {
        let mut points = uniform(seed, n, dims);
        if seed % 4 == 0 {
            // On a lattice, with ties, coinciding points and faces of many vertices.
            points.iter_mut().for_each(|x| *x = (*x * 3.0).floor() / 2.0);
        }
        let p: Vec<f64> = uniform(!seed, 1, dims).iter().map(|x| 0.5 + reach * (x - 0.5)).collect();
        let interpolator = over(&points, n, dims);
        let x = interpolator.clamped(&p);
        let mut places: Vec<&[f64]> = points.chunks(dims).collect();
        places.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        places.dedup();
        let centre: Vec<f64> = (0..dims)
            .map(|l| places.iter().map(|v| v[l]).sum::<f64>() / places.len() as f64)
            .collect();
        let moved: f64 = p.iter().zip(&x).map(|(p, x)| (p - x) * (p - x)).sum();
        let mut nearest_face = f64::INFINITY;
        for v in &places {
            let toward: f64 = (0..dims)
                .map(|l| (p[l] - x[l]) * (centre[l] + (1.0 + HULL_MARGIN) * (v[l] - centre[l]) - x[l]))
                .sum();
            prop_assert!(toward < 1e-12, "{toward:e} toward {v:?} from {x:?}");
            nearest_face = nearest_face.min(toward.abs());
        }
        // And x is of the hull: it touches a vertex's plane, and is its own nearest point.
        if moved > 0.0 {
            prop_assert!(nearest_face < 1e-12, "{nearest_face:e} short of the hull");
            prop_assert!(largest_difference(&interpolator.clamped(&x), &x) < 1e-9);
        }
    }
}
