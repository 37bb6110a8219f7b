//! Points that do not span their space, coincide, or are alone; and what is refused.

use kineme::interpolation::{Interpolator, Kernel, Method, Tail};

use super::{blend, cardinal, largest_difference, methods, uniform, weights, wendland};

fn fit(points: &[f64], n: usize, dims: usize, method: &Method) -> Interpolator {
    Interpolator::new(points, n, dims, method).expect("an interpolator")
}

/// Every method, every dimension: weights at `p` are `wanted`, their gradient zero, and a note has the word.
fn check_constant(points: &[f64], n: usize, p: &[f64], wanted: &[f64], word: &str) {
    for method in methods() {
        let interpolator = fit(points, n, p.len(), &method);
        let (mut w, mut g) = (vec![9.0; n], vec![9.0; n * p.len()]);
        interpolator.weights_and_gradient(p, &mut w, &mut g);
        assert_eq!(w, wanted, "{method:?}");
        assert!(g.iter().all(|g| *g == 0.0), "{method:?}: {g:?}");
        assert_eq!(interpolator.is_exact(), n == 1);
        let notes = interpolator.notes();
        assert!(notes.iter().any(|n| n.contains(word)), "{notes:?}");
    }
}

#[test]
fn one_place_or_no_parameters_make_the_weights_constant() {
    check_constant(&[0.3, 0.4], 1, &[5.0, -1.0], &[1.0], "constant");
    check_constant(&[], 4, &[], &[0.25; 4], "no parameters");
    check_constant(&[0.5; 6], 3, &[0.1, 0.2], &[1.0 / 3.0; 3], "constant");
    check_constant(&[], 1, &[], &[1.0], "no parameters");
}

#[test]
fn coinciding_points_share_one_weight() {
    let apart = [0.0, 0.0, 1.0, 0.1, 0.2, 0.9, 0.7, 0.6];
    // Points 1 and 3 are one place, and 0, 2, 5 another.
    let doubled = [
        0.0, 0.0, 1.0, 0.1, 0.0, 0.0, 1.0, 0.1, 0.2, 0.9, 0.0, 0.0, 0.7, 0.6,
    ];
    let p = [0.4, 0.45];
    for method in methods() {
        let interpolator = fit(&doubled, 7, 2, &method);
        let once = fit(&apart, 4, 2, &method);
        let (mut w, mut g) = ([0.0; 7], [0.0; 14]);
        interpolator.weights_and_gradient(&p, &mut w, &mut g);
        let (mut v, mut h) = ([0.0; 4], [0.0; 8]);
        once.weights_and_gradient(&p, &mut v, &mut h);
        let place = [0, 1, 0, 1, 2, 0, 3];
        let share = [3.0, 2.0, 3.0, 2.0, 1.0, 3.0, 1.0];
        for i in 0..7 {
            assert!((w[i] - v[place[i]] / share[i]).abs() < 1e-15, "{method:?}");
            for l in 0..2 {
                let wanted = h[place[i] * 2 + l] / share[i];
                assert!((g[i * 2 + l] - wanted).abs() < 1e-14, "{method:?}");
            }
        }
        assert!(!interpolator.is_exact());
        assert!(interpolator.notes()[0].contains("4 places"));
        assert!(once.notes().is_empty(), "{:?}", once.notes());
    }
}

#[test]
fn the_linear_part_keeps_to_what_the_points_span() {
    // On a line in three dimensions, slanted so that no coordinate is idle; at uneven places.
    let direction = [0.6, 0.64, -0.48];
    let along = [0.0, 0.3, 0.35, 0.8, 1.0];
    let points: Vec<f64> = along
        .iter()
        .flat_map(|t| direction.map(|d| 0.2 + t * d))
        .collect();
    for method in methods() {
        let Method::Cardinal { tail, nugget, .. } = method else {
            continue;
        };
        let interpolator = fit(&points, 5, 3, &method);
        let said = interpolator.notes().iter().any(|n| n.contains("1 of 3"));
        assert_eq!(said, tail != Tail::None, "{:?}", interpolator.notes());
        assert_eq!(interpolator.is_exact(), nugget == 0.0);
        if tail == Tail::None {
            continue;
        }
        for t in [-0.2, 0.1, 0.5, 1.3] {
            let p = direction.map(|d| 0.2 + t * d);
            let found = blend(&interpolator, &p, &along, 1)[0];
            assert!((found - t).abs() < 1e-9, "{method:?} at {t}: {found}");
        }
    }
}

#[test]
fn as_many_points_as_coefficients_make_it_linear() {
    // A kernel matrix that is all zeros does not matter then: two points one apart under r^2 ln r.
    for kernel in [
        wendland(0.3),
        Kernel::Linear,
        Kernel::Cubic,
        Kernel::ThinPlate,
    ] {
        for tail in [Tail::LeastSquares, Tail::Augmented] {
            let two = fit(&[0.0, 1.0], 2, 1, &cardinal(kernel, tail, 0.0));
            let off = largest_difference(&weights(&two, &[0.3]), &[0.7, 0.3]);
            assert!(off < 1e-15 && two.is_exact(), "{kernel:?} {tail:?}");
        }
    }
}

#[test]
fn points_that_nearly_coincide_are_told() {
    // How far point 3 is from point 0, and whether the points are still met.
    for (gap, exact) in [(1e-4, true), (1e-7, false)] {
        let points = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, gap, 0.0, 0.6, 0.7];
        for tail in [Tail::None, Tail::LeastSquares, Tail::Augmented] {
            let interpolator = fit(&points, 5, 2, &cardinal(wendland(2.0), tail, 0.0));
            let notes = interpolator.notes();
            assert!(notes[0].contains("ill conditioned"), "{notes:?}");
            assert_eq!(interpolator.is_exact(), exact, "{gap:e} {tail:?} {notes:?}");
            assert_eq!(notes.len() == 1, exact, "{notes:?}");
            for (i, p) in points.chunks(2).enumerate() {
                let w = weights(&interpolator, p);
                let delta: Vec<f64> = (0..5).map(|k| f64::from(u8::from(k == i))).collect();
                let off = largest_difference(&w, &delta);
                assert!(off < if exact { 1e-12 } else { 2.0 }, "{off:e}");
            }
            // Weights of opposite signs may be large there: the sum is as good as their digits.
            let w = weights(&interpolator, &[0.3, 0.4]);
            let size: f64 = w.iter().map(|w| w.abs()).sum();
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-15 * size, "{w:?}");
        }
    }
}

#[test]
fn a_matrix_singular_to_working_precision_takes_a_ridge_and_says_so() {
    // Six points within 1e-7 of each other beside one far away: no cubic bump tells them apart.
    let mut points: Vec<f64> = (0..6).map(|i| 1e-7 * f64::from(i)).collect();
    points.push(1.0);
    let interpolator = fit(&points, 7, 1, &cardinal(wendland(2.0), Tail::None, 0.0));
    for p in [-0.5, 0.0, 2.5e-7, 0.4, 1.0] {
        let w = weights(&interpolator, &[p]);
        assert!(w.iter().all(|w| w.is_finite()), "{w:?}");
        assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{w:?}");
    }
    let notes = interpolator.notes();
    assert!(
        notes[0].contains("ridge") && notes[1].contains("not met"),
        "{notes:?}"
    );
    assert!(!interpolator.is_exact());
}

#[test]
fn refuses_what_it_cannot_fit() {
    let shepard = Method::Shepard { power: 2.0 };
    let unit = wendland(1.0);
    let two = [0.0, 1.0];
    let rose = cardinal(unit, Tail::LeastSquares, 0.0);
    let cases: [(&[f64], usize, usize, Method); 11] = [
        (&[], 0, 0, shepard),
        (&two, 2, 2, shepard),
        (&two, usize::MAX, usize::MAX, shepard),
        (&[0.0, f64::NAN], 2, 1, shepard),
        (&[0.0, f64::INFINITY], 1, 2, shepard),
        (&[0.0, f64::MAX, 0.5, f64::MAX], 2, 2, rose),
        (&two, 2, 1, Method::Shepard { power: 0.0 }),
        (&two, 2, 1, cardinal(wendland(-1.0), Tail::None, 0.0)),
        (&two, 2, 1, cardinal(unit, Tail::None, -0.1)),
        (&two, 2, 1, cardinal(unit, Tail::None, f64::NAN)),
        (
            &two,
            2,
            1,
            cardinal(wendland(f64::INFINITY), Tail::None, 0.0),
        ),
    ];
    for (points, n, dims, method) in cases {
        let found = Interpolator::new(points, n, dims, &method);
        assert!(
            found.is_err_and(|e| e.is_invalid()),
            "{points:?} {method:?}"
        );
    }
    let singular = cardinal(Kernel::ThinPlate, Tail::None, 0.0);
    let found = Interpolator::new(&two, 2, 1, &singular);
    assert!(found.is_err_and(|e| e.is_unsupported()));
    let alone = fit(&[0.5], 1, 1, &shepard);
    assert!(alone.left_out(0).is_err_and(|e| e.is_invalid()));
}

#[test]
fn no_numbers_make_it_panic() {
    let values = [
        0.0, 1.0, -1.0, 0.5, 1e-320, 1e-160, 3e-13, 1e100, -1e100, 1e50,
    ];
    let mut fitted = 0;
    for seed in 0..600 {
        let draw = uniform(seed, 64, 1);
        // The first four are ordinary: half of all cases mix nothing else.
        let among = if seed % 2 == 0 {
            4.0
        } else {
            values.len() as f64
        };
        let value = |i: usize| values[(draw[i] * among) as usize];
        let (n, dims) = (1 + seed as usize % 7, (seed / 7) as usize % 5);
        let points: Vec<f64> = (0..n * dims).map(value).collect();
        let p: Vec<f64> = (50..50 + dims).map(value).collect();
        for method in methods() {
            let Ok(interpolator) = Interpolator::new(&points, n, dims, &method) else {
                continue;
            };
            fitted += 1;
            let (mut w, mut g) = (vec![0.0; n], vec![0.0; n * dims]);
            interpolator.weights_and_gradient(&p, &mut w, &mut g);
            assert_eq!(interpolator.clamped(&p).len(), dims);
            if seed % 2 == 0 {
                let size: f64 = w.iter().map(|w| w.abs()).sum();
                let sum: f64 = w.iter().sum();
                assert!(
                    (sum - 1.0).abs() < 1e-14 * size,
                    "{method:?} {points:?}: {w:?}"
                );
            }
        }
    }
    assert!(fitted > 4000, "{fitted} fitted");
}
