//! Rotations: against reference values, and the laws of exponential, logarithm, twist and wrap.

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use kineme::math::rotation::{
    EulerOrder, exp, frame_z_y, log, log_near, shortest, twist_angle, wrap,
};
use nalgebra::{Matrix3, Quaternion, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use serde_json::Value;

/// Reference values, where the data folder is present.
fn oracle(name: &str) -> Option<Value> {
    let data = std::env::var_os("KINEME_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let Ok(text) = std::fs::read_to_string(data.join("../oracles").join(name)) else {
        println!("skipped: no reference values {name}");
        return None;
    };
    Some(serde_json::from_str(&text).expect("reference values are JSON"))
}

fn numbers(v: &Value) -> Vec<f64> {
    let list = v.as_array().expect("a list of numbers");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn quaternion(v: &Value) -> UnitQuaternion<f64> {
    let q = numbers(&v["quaternion_wxyz"]);
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

fn matrix(v: &Value) -> Matrix3<f64> {
    let rows = v["matrix"].as_array().expect("rows");
    Matrix3::from_row_slice(&rows.iter().flat_map(numbers).collect::<Vec<_>>())
}

fn check_matrix(found: &UnitQuaternion<f64>, wanted: &Matrix3<f64>, within: f64, what: &str) {
    let off = (found.to_rotation_matrix().matrix() - wanted).amax();
    assert!(off < within, "{what}: off by {off:e}");
}

#[test]
fn reference_rotations_agree_in_every_form_and_order() {
    let Some(oracle) = oracle("euler.json") else {
        return;
    };
    let rotations = oracle["rotations"].as_array().expect("rotations");
    for (i, rotation) in rotations.iter().enumerate() {
        let q = quaternion(rotation);
        let what = format!("rotation {i} ({})", rotation["kind"]);
        check_matrix(&q, &matrix(rotation), 1e-9, &what);
        let vector = Vector3::from_column_slice(&numbers(&rotation["rotation_vector"]));
        check_matrix(&exp(&vector), &matrix(rotation), 1e-9, &what);
        // A half turn has two logarithms.
        let off = (log(&q) - vector).norm();
        let opposite = (log(&q) + vector).norm();
        let half_turn = (vector.norm() - PI).abs() < 1e-6;
        assert!(
            off < 1e-9 || half_turn && opposite < 1e-5,
            "{what}: log off by {off:e}"
        );
        let locked: Vec<&str> = rotation["gimbal"]
            .as_array()
            .expect("orders")
            .iter()
            .filter_map(Value::as_str)
            .collect();
        for (name, angles) in rotation["euler_degrees"].as_object().expect("orders") {
            let what = format!("{what}, {name}");
            let order = EulerOrder::parse(name).expect("an order");
            let found = order.angles(&q);
            check_matrix(&order.rotation(found), &matrix(rotation), 1e-9, &what);
            let wanted: Vec<f64> = numbers(angles).iter().map(|d| d.to_radians()).collect();
            check_matrix(
                &order.rotation([wanted[0], wanted[1], wanted[2]]),
                &matrix(rotation),
                1e-6,
                &what,
            );
            if !locked.contains(&name.as_str()) {
                for (f, w) in found.iter().zip(&wanted) {
                    assert!(wrap(f - w).abs() < 1e-9, "{what}: {found:?} not {wanted:?}");
                }
            }
        }
    }
}

#[test]
fn reference_angles_of_every_order_make_their_rotation() {
    let Some(oracle) = oracle("euler.json") else {
        return;
    };
    for case in oracle["from_euler"].as_array().expect("cases") {
        let name = case["order"].as_str().expect("a name");
        let order = EulerOrder::parse(name).expect("an order");
        let a = numbers(&case["degrees"]);
        let q = order.rotation([a[0].to_radians(), a[1].to_radians(), a[2].to_radians()]);
        check_matrix(&q, &matrix(case), 1e-9, &format!("{name} {a:?}"));
    }
}

#[test]
fn orders_are_three_letters_without_a_repeated_neighbour() {
    for (text, valid) in [
        ("XYZ", true),
        ("zxy", true),
        ("XYX", true),
        ("XXY", false),
        ("XYY", false),
        ("XY", false),
        ("XYZX", false),
        ("ABC", false),
        ("", false),
    ] {
        assert_eq!(EulerOrder::parse(text).is_some(), valid, "{text:?}");
    }
}

#[test]
fn log_near_follows_a_turn_through_pi_and_on_to_two_pi() {
    for axis in [Vector3::x(), Vector3::new(0.6, -0.8, 0.0), Vector3::z()] {
        let mut before = Vector3::zeros();
        for step in 0..=62 {
            let angle = 0.1 * f64::from(step);
            let v = log_near(&exp(&(axis * angle)), &before);
            assert!((v - axis * angle).norm() < 1e-9, "{angle}: {v:?}");
            before = v;
        }
    }
}

#[test]
fn wrap_brings_angles_into_the_half_open_turn() {
    for (angle, wanted) in [
        (0.0, 0.0),
        (PI, PI),
        (-PI, PI),
        (3.0 * PI, PI),
        (TAU, 0.0),
        (-0.5, -0.5),
        (4.0, 4.0 - TAU),
        (-1e-18, 0.0),
    ] {
        assert!(
            (wrap(angle) - wanted).abs() < 1e-12,
            "{angle}: {}",
            wrap(angle)
        );
    }
}

#[test]
fn shortest_is_exact_for_tiny_turns_and_defined_for_opposites() {
    let tiny = shortest(&Vector3::x(), &Vector3::new(1.0, 1e-11, 0.0));
    assert!((tiny.angle() - 1e-11).abs() < 1e-15, "{:e}", tiny.angle());
    for v in [Vector3::x(), Vector3::y(), Vector3::new(1.0, 2.0, -3.0)] {
        let q = shortest(&v, &-v);
        assert!((q * v + v).norm() < 1e-9, "{v:?}");
        assert!((q.angle() - PI).abs() < 1e-9, "{v:?}");
    }
    let none = shortest(&Vector3::zeros(), &Vector3::x());
    assert_eq!(none, UnitQuaternion::identity());
}

#[test]
fn a_frame_needs_two_directions() {
    assert!(frame_z_y(&Vector3::z(), &Vector3::z()).is_none());
    assert!(frame_z_y(&Vector3::zeros(), &Vector3::y()).is_none());
    let q = frame_z_y(&Vector3::new(0.0, 0.0, 2.0), &Vector3::new(0.0, 3.0, 1.0));
    assert!(q.is_some_and(|q| q.angle() < 1e-12));
}

fn vector(most: f64) -> impl Strategy<Value = Vector3<f64>> {
    (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, 0.0..most)
        .prop_filter_map("a direction", |(x, y, z, length)| {
            Some(Vector3::new(x, y, z).try_normalize(0.1)? * length)
        })
}

proptest! {
    #[test]
    fn log_undoes_exp_within_a_half_turn(v in vector(PI - 1e-6)) {
        prop_assert!((log(&exp(&v)) - v).norm() < 1e-9);
    }

    #[test]
    fn exp_undoes_log(v in vector(3.0 * PI)) {
        let q = exp(&v);
        prop_assert!(exp(&log(&q)).angle_to(&q) < 1e-9);
        prop_assert!(log(&q).norm() <= PI + 1e-12);
    }

    #[test]
    fn log_near_is_a_logarithm_and_no_farther_than_the_plain_one(v in vector(PI), before in vector(TAU)) {
        let q = exp(&v);
        let near = log_near(&q, &before);
        prop_assert!(exp(&near).angle_to(&q) < 1e-7);
        prop_assert!((near - before).norm() <= (log(&q) - before).norm() + 1e-12);
    }

    #[test]
    fn what_is_left_of_a_twist_does_not_twist(v in vector(PI), axis in vector(1.0).prop_filter("length", |a| a.norm() > 0.1)) {
        let (q, axis) = (exp(&v), Unit::new_normalize(axis));
        let twist = UnitQuaternion::from_axis_angle(&axis, twist_angle(&q, &axis));
        let swing = q * twist.inverse();
        prop_assert!(twist_angle(&swing, &axis).abs() < 1e-6 || swing.w.abs() < 1e-6);
    }

    #[test]
    fn shortest_turns_one_direction_into_the_other_about_their_normal(a in vector(2.0), b in vector(2.0)) {
        prop_assume!(a.norm() > 1e-3 && b.norm() > 1e-3);
        let q = shortest(&a, &b);
        prop_assert!((q * a.normalize() - b.normalize()).norm() < 1e-9);
        prop_assert!((q.angle() - a.angle(&b)).abs() < 1e-6);
    }

    #[test]
    fn angles_make_their_rotation_again(v in vector(PI), order in 0usize..12) {
        let orders = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"];
        let order = EulerOrder::parse(orders[order]).expect("an order");
        let q = exp(&v);
        prop_assert!(order.rotation(order.angles(&q)).angle_to(&q) < 1e-9);
    }
}
