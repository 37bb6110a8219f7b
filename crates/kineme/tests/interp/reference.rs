//! Values computed by other libraries.

use kineme::interpolation::{Interpolator, Kernel, Tail};
use serde_json::Value;

use super::oracles::{numbers, oracle};
use super::{blend, cardinal, largest_difference, weights, wendland};

/// One dimension of the oracle: its points, queries and values.
struct Case {
    dims: usize,
    points: Vec<f64>,
    queries: Vec<f64>,
    data: Value,
}

fn cases() -> Vec<Case> {
    let Some(all) = oracle("rbf.json") else {
        return Vec::new();
    };
    let case = |(name, dims): (&str, usize)| Case {
        dims,
        points: numbers(&all[name]["points"]),
        queries: numbers(&all[name]["queries"]),
        data: all[name].clone(),
    };
    [("2d", 2), ("3d", 3)].into_iter().map(case).collect()
}

impl Case {
    fn interpolator(&self, kernel: Kernel, tail: Tail, nugget: f64) -> Interpolator {
        let n = self.points.len() / self.dims;
        let method = cardinal(kernel, tail, nugget);
        Interpolator::new(&self.points, n, self.dims, &method).expect("an interpolator")
    }

    fn check(&self, what: &str, wanted: &Value, found: impl Fn(&[f64]) -> Vec<f64>) {
        let found: Vec<f64> = self.queries.chunks(self.dims).flat_map(found).collect();
        let off = largest_difference(&found, &numbers(wanted));
        assert!(!found.is_empty() && off < 1e-8, "{what}: off by {off:e}");
        println!("{}d {what}: off by {off:.1e}", self.dims);
    }
}

#[test]
fn blends_as_scipy_with_a_linear_polynomial() {
    for case in cases() {
        let values = numbers(&case.data["values"]);
        let columns = values.len() * case.dims / case.points.len();
        for (name, kernel, nugget) in [
            ("linear", Kernel::Linear, 0.0),
            ("cubic", Kernel::Cubic, 0.0),
            ("thin_plate_spline", Kernel::ThinPlate, 0.0),
            ("cubic_smoothing_0.1", Kernel::Cubic, 0.1),
        ] {
            let interpolator = case.interpolator(kernel, Tail::Augmented, nugget);
            case.check(name, &case.data["scipy"][name], |p| {
                blend(&interpolator, p, &values, columns)
            });
        }
    }
}

#[test]
fn has_the_cardinal_weights_of_wendlands_kernel() {
    for case in cases() {
        let wanted = &case.data["wendland_c2"];
        let kernel = wendland(wanted["support"].as_f64().expect("a support"));
        for (name, tail) in [
            ("cardinal_with_linear_tail", Tail::Augmented),
            (
                "cardinal_least_squares_linear_plus_residual",
                Tail::LeastSquares,
            ),
        ] {
            let interpolator = case.interpolator(kernel, tail, 0.0);
            case.check(name, &wanted[name], |p| weights(&interpolator, p));
        }
        let interpolator = case.interpolator(kernel, Tail::None, 0.0);
        case.check("cardinal", &wanted["cardinal"], |p| {
            let each = interpolator.deficit(p) / interpolator.len() as f64;
            weights(&interpolator, p).iter().map(|w| w - each).collect()
        });
    }
}
