//! The clamped cubic spline: through its knots, C2, at rest at both ends.

use kineme::math::spline::ClampedSpline;

const TIMES: [f64; 5] = [0.0, 0.3, 0.5, 1.2, 2.0];
const VALUES: [f64; 5] = [1.0, -2.0, 0.5, 0.5, 3.0];

fn slope(s: &ClampedSpline, t: f64, h: f64) -> f64 {
    (s.at(t + h) - s.at(t - h)) / (2.0 * h)
}

/// Second derivative from one side, exact for a cubic: `sign` +1 looks right of `t`, -1 left.
fn bend(s: &ClampedSpline, t: f64, sign: f64) -> f64 {
    let h = 0.02 * sign;
    let y: Vec<f64> = (0..4).map(|i| s.at(t + h * f64::from(i))).collect();
    (2.0 * y[0] - 5.0 * y[1] + 4.0 * y[2] - y[3]) / (h * h)
}

#[test]
fn passes_through_its_knots_twice_continuously_differentiable() {
    let s = ClampedSpline::new(&TIMES, &VALUES).expect("a spline");
    for (t, v) in TIMES.iter().zip(VALUES) {
        assert!((s.at(*t) - v).abs() < 1e-12, "at {t}");
    }
    for &t in &TIMES[1..4] {
        let jump = bend(&s, t, 1.0) - bend(&s, t, -1.0);
        assert!(
            jump.abs() < 1e-6,
            "second derivative jumps by {jump} at {t}"
        );
    }
}

#[test]
fn rests_at_both_ends_and_beyond() {
    let s = ClampedSpline::new(&TIMES, &VALUES).expect("a spline");
    for t in [TIMES[0], TIMES[4]] {
        assert!(slope(&s, t, 1e-6).abs() < 1e-3, "slope at {t}");
    }
    assert_eq!(s.at(-1.0), VALUES[0]);
    assert_eq!(s.at(9.0), VALUES[4]);
}

#[test]
fn two_knots_make_the_cubic_ease() {
    let s = ClampedSpline::new(&[1.0, 3.0], &[0.0, 4.0]).expect("a spline");
    for x in [0.1, 0.5, 0.8] {
        let wanted = 4.0 * x * x * (3.0 - 2.0 * x);
        assert!((s.at(1.0 + 2.0 * x) - wanted).abs() < 1e-12, "{x}");
    }
    let one = ClampedSpline::new(&[1.0], &[7.0]).expect("a spline");
    assert_eq!(one.at(0.0), 7.0);
}

#[test]
fn refuses_knots_that_are_none() {
    for (times, values) in [
        (vec![], vec![]),
        (vec![0.0, 1.0], vec![0.0]),
        (vec![0.0, 0.0], vec![0.0, 1.0]),
        (vec![1.0, 0.0], vec![0.0, 1.0]),
        (vec![0.0, f64::NAN], vec![0.0, 1.0]),
        (vec![0.0, 1.0], vec![0.0, f64::INFINITY]),
    ] {
        let found = ClampedSpline::new(&times, &values);
        assert!(found.is_err_and(|e| e.is_invalid()), "{times:?} {values:?}");
    }
}
