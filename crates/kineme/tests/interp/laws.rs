//! What holds for any points.

use kineme::interpolation::{Interpolator, Kernel, Method, Tail, wendland_support};
use proptest::prelude::*;

use super::{blend, cardinal, largest_difference, methods, scattered, uniform, weights, wendland};

/// Points of a random count and dimension with a query outside or among them.
#[derive(Debug)]
struct Case {
    points: Vec<f64>,
    n: usize,
    dims: usize,
    p: Vec<f64>,
}

impl Case {
    fn interpolator(&self, method: &Method) -> Interpolator {
        Interpolator::new(&self.points, self.n, self.dims, method).expect("an interpolator")
    }
}

fn cases() -> impl Strategy<Value = Case> {
    (6usize..20, 1usize..=4, any::<u64>()).prop_map(|(n, dims, seed)| {
        let points = scattered(seed, n, dims);
        let p = uniform(seed ^ 1, 1, dims);
        Case {
            points,
            n,
            dims,
            p: p.iter().map(|x| 1.6 * x - 0.3).collect(),
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn weights_sum_to_one_and_their_gradients_to_zero(case in cases()) {
        for method in methods() {
            let interpolator = case.interpolator(&method);
            let mut gradient = vec![0.0; case.n * case.dims];
            let mut w = vec![0.0; case.n];
            interpolator.weights_and_gradient(&case.p, &mut w, &mut gradient);
            let size: f64 = 1.0 + w.iter().map(|w| w.abs()).sum::<f64>();
            prop_assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-13 * size, "{method:?} {w:?}");
            prop_assert_eq!(&weights(&interpolator, &case.p), &w);
            for l in 0..case.dims {
                let column = || gradient[l..].iter().step_by(case.dims);
                let size: f64 = 1.0 + column().map(|g| g.abs()).sum::<f64>();
                prop_assert!(column().sum::<f64>().abs() < 1e-12 * size, "{method:?}");
            }
        }
    }

    #[test]
    fn exact_methods_give_an_exemplar_to_itself(case in cases()) {
        for method in methods() {
            let interpolator = case.interpolator(&method);
            let smoothed = matches!(method, Method::Cardinal { nugget, .. } if nugget > 0.0);
            prop_assert_eq!(interpolator.is_exact(), !smoothed, "{:?}", interpolator.notes());
            // Beside the point as well: that it is met at the very point is no accident of the arithmetic.
            for (i, point) in case.points.chunks(case.dims).enumerate() {
                let beside: Vec<f64> = point.iter().map(|x| x + 1e-11).collect();
                for p in [point, &beside] {
                    let w = weights(&interpolator, p);
                    let delta: Vec<f64> = (0..case.n).map(|k| f64::from(u8::from(k == i))).collect();
                    let off = largest_difference(&w, &delta);
                    prop_assert_eq!(off < 1e-7, !smoothed, "{:?}: off by {}", method, off);
                }
            }
        }
    }

    #[test]
    fn shepard_stays_in_the_hull(case in cases()) {
        for power in [0.5, 1.0, 2.0, 7.0] {
            let w = weights(&case.interpolator(&Method::Shepard { power }), &case.p);
            prop_assert!(w.iter().all(|w| (0.0..=1.0).contains(w)), "{w:?}");
        }
    }

    #[test]
    fn linear_data_come_back_exactly(case in cases()) {
        // The parameters themselves are such data.
        for kernel in [wendland(0.8), Kernel::Linear, Kernel::Cubic, Kernel::ThinPlate] {
            for tail in [Tail::LeastSquares, Tail::Augmented] {
                if tail == Tail::LeastSquares && !matches!(kernel, Kernel::Wendland { .. }) {
                    continue;
                }
                for nugget in [0.0, 0.3] {
                    let interpolator = case.interpolator(&cardinal(kernel, tail, nugget));
                    let found = blend(&interpolator, &case.p, &case.points, case.dims);
                    let off = largest_difference(&found, &case.p);
                    prop_assert!(off < 1e-9, "{kernel:?} {tail:?} {nugget}: {off:e}");
                }
            }
        }
    }

    #[test]
    fn the_order_of_points_does_not_matter(case in cases(), turn in 1usize..5) {
        let mut turned = case.points.clone();
        turned.rotate_left(turn * case.dims);
        for method in methods() {
            let mut wanted = weights(&case.interpolator(&method), &case.p);
            wanted.rotate_left(turn);
            let other = Interpolator::new(&turned, case.n, case.dims, &method).expect("an interpolator");
            let off = largest_difference(&weights(&other, &case.p), &wanted);
            prop_assert!(off < 1e-9, "{method:?}: {off:e}");
        }
    }

    #[test]
    fn gradients_are_those_of_central_differences(case in cases()) {
        for method in methods() {
            let interpolator = case.interpolator(&method);
            check_gradient(&interpolator, &case.p, 1e-5)?;
        }
    }

    #[test]
    fn leaving_one_out_is_fitting_the_others(case in cases()) {
        for method in methods() {
            let interpolator = case.interpolator(&method);
            for i in [0, 2, case.n - 1] {
                let mut others = case.points.clone();
                others.drain(i * case.dims..(i + 1) * case.dims);
                let wanted = Interpolator::new(&others, case.n - 1, case.dims, &method).expect("an interpolator");
                prop_assert_eq!(interpolator.left_out(i).expect("the others"), wanted);
            }
            prop_assert!(interpolator.left_out(case.n).is_err());
        }
    }
}

/// Compares with central differences of step 1e-6, relative to the largest slope.
fn check_gradient(
    interpolator: &Interpolator,
    p: &[f64],
    tolerance: f64,
) -> Result<(), TestCaseError> {
    let (n, dims) = (interpolator.len(), interpolator.dims());
    let (mut w, mut gradient) = (vec![0.0; n], vec![0.0; n * dims]);
    interpolator.weights_and_gradient(p, &mut w, &mut gradient);
    let largest = gradient.iter().fold(1.0, |a: f64, g| a.max(g.abs()));
    let h = 1e-6;
    for l in 0..dims {
        let at = |step: f64| {
            let mut moved = p.to_vec();
            moved[l] += step;
            weights(interpolator, &moved)
        };
        for (i, (ahead, behind)) in at(h).iter().zip(at(-h)).enumerate() {
            let off = (gradient[i * dims + l] - (ahead - behind) / (2.0 * h)).abs();
            prop_assert!(
                off < tolerance * largest,
                "{:?}: dw_{i}/dp_{l} off by {off:e}",
                interpolator.method()
            );
        }
    }
    Ok(())
}

#[test]
fn gradients_hold_at_the_exemplars_too() {
    let points = scattered(3, 9, 2);
    for method in methods() {
        // The linear kernel has a kink there, and Shepard's weights bend too sharply for the step below power 2.
        if matches!(
            method,
            Method::Cardinal {
                kernel: Kernel::Linear,
                ..
            }
        ) {
            continue;
        }
        let interpolator = Interpolator::new(&points, 9, 2, &method).expect("an interpolator");
        for point in points.chunks(2) {
            check_gradient(&interpolator, point, 1e-4).expect("a gradient");
        }
    }
}

#[test]
fn weights_are_once_continuously_differentiable_across_the_edge_of_the_support() {
    // The support of the first point ends at 0.5 on the axis.
    let points = [0.0, 0.0, 0.9, 0.1, 0.8, 0.9, 0.1, 0.8];
    for tail in [Tail::None, Tail::LeastSquares, Tail::Augmented] {
        let method = cardinal(wendland(0.5), tail, 0.0);
        let interpolator = Interpolator::new(&points, 4, 2, &method).expect("an interpolator");
        let at = |x: f64| {
            let (mut w, mut g) = ([0.0; 4], [0.0; 8]);
            interpolator.weights_and_gradient(&[x, 0.0], &mut w, &mut g);
            [&w[..], &g[..]].concat()
        };
        let jump = largest_difference(&at(0.5 - 1e-7), &at(0.5 + 1e-7));
        assert!(jump < 1e-5, "{tail:?}: jumps by {jump:e}");
    }
}

#[test]
fn shepards_weights_are_flat_at_the_exemplars() {
    let points = scattered(11, 7, 3);
    let interpolator =
        Interpolator::new(&points, 7, 3, &Method::Shepard { power: 2.0 }).expect("an interpolator");
    for point in points.chunks(3) {
        for step in [0.0, 1e-11, 1e-9] {
            let p: Vec<f64> = point.iter().map(|x| x + step).collect();
            let (mut w, mut g) = ([0.0; 7], [0.0; 21]);
            interpolator.weights_and_gradient(&p, &mut w, &mut g);
            let steepest = g.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
            assert!(
                steepest <= 1e4 * step,
                "{steepest:e} at {step:e} from a point"
            );
        }
    }
}

#[test]
fn analytic_weights() {
    let check = |method: &Method, points: &[f64], p: f64, wanted: &[f64]| {
        let interpolator =
            Interpolator::new(points, points.len(), 1, method).expect("an interpolator");
        let found = weights(&interpolator, &[p]);
        let off = largest_difference(&found, wanted);
        assert!(off < 1e-14, "{method:?} at {p}: {found:?}, not {wanted:?}");
    };
    let shepard = |power| Method::Shepard { power };
    check(&shepard(2.0), &[0.0, 1.0], 0.25, &[0.9, 0.1]);
    check(&shepard(1.0), &[0.0, 1.0], 0.25, &[0.75, 0.25]);
    // Two points: the line through them; no tail: kernels that do not meet, and the rest to both alike.
    let rose = cardinal(wendland(1.0), Tail::LeastSquares, 0.0);
    check(&rose, &[0.0, 1.0], 0.25, &[0.75, 0.25]);
    check(&rose, &[0.0, 1.0], 1.5, &[-0.5, 1.5]);
    let bare = cardinal(wendland(1.0), Tail::None, 0.0);
    let near = 0.5f64.powi(4) * 3.0;
    check(
        &bare,
        &[0.0, 2.0],
        0.5,
        &[0.5 + near / 2.0, 0.5 - near / 2.0],
    );
    check(&bare, &[0.0, 2.0], 9.0, &[0.5, 0.5]);
    // Kriging with one variance of noise: half of each kernel.
    let noisy = cardinal(wendland(1.0), Tail::None, 1.0);
    check(&noisy, &[0.0, 2.0], 0.0, &[0.75, 0.25]);
}

#[test]
fn the_default_support_is_four_times_the_widest_gap() {
    let check = |points: &[f64], dims: usize, wanted: f64| {
        let n = points.len().checked_div(dims).unwrap_or(3);
        let found = wendland_support(points, n, dims);
        assert!((found - wanted).abs() < 1e-15, "{points:?}: {found}");
    };
    check(&[0.0, 0.1, 1.0], 1, 3.6);
    check(&[0.0, 0.0, 3.0, 4.0, 0.0, 0.0], 2, 20.0);
    check(&[0.5, 0.5], 1, 1.0);
    check(&[], 0, 1.0);
}
