//! Rotations: exponential and logarithm, Euler angles of every order, swing and twist.
//!
//! All rotations are unit quaternions; a *rotation vector* is axis times angle in radians.

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

/// The rotation of a rotation vector (axis times angle, radians): `exp`.
pub fn exp(v: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(*v)
}

/// The rotation vector (axis times angle, radians, length at most pi) of a rotation: `log`.
pub fn log(q: &UnitQuaternion<f64>) -> Vector3<f64> {
    // atan2 on the hemisphere with w >= 0 keeps full precision near zero and near pi.
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let v = q.imag() * sign;
    let n = v.norm();
    if n < 1e-12 {
        v * 2.0
    } else {
        v * (2.0 * n.atan2(q.w * sign) / n)
    }
}

/// The logarithm whose rotation vector is nearest `previous`, so that a motion through pi does not jump.
pub fn log_near(q: &UnitQuaternion<f64>, previous: &Vector3<f64>) -> Vector3<f64> {
    let v = log(q);
    let n = v.norm();
    if n < 1e-9 {
        return v;
    }
    let other = v * ((n - std::f64::consts::TAU) / n);
    if (other - previous).norm_squared() < (v - previous).norm_squared() {
        other
    } else {
        v
    }
}

/// The right Jacobian of SO(3) at a rotation vector: `exp(v + d) = exp(v) exp(right_jacobian(v) d)` to first order in d
/// (Chirikjian 2012, section 10.6).
pub fn right_jacobian(v: &Vector3<f64>) -> Matrix3<f64> {
    let square = v.norm_squared();
    // (1 - cos a) / a^2 and (a - sin a) / a^3; their series where the differences would cancel.
    let (first, second) = if square < 1e-2 {
        (
            0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)),
            (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))) / 6.0,
        )
    } else {
        let angle = square.sqrt();
        let (sine, cosine) = angle.sin_cos();
        ((1.0 - cosine) / square, (angle - sine) / (square * angle))
    };
    let cross = v.cross_matrix();
    Matrix3::identity() - cross * first + cross * cross * second
}

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

impl Axis {
    /// The unit vector of the axis.
    pub fn unit(self) -> Unit<Vector3<f64>> {
        match self {
            Axis::X => Vector3::x_axis(),
            Axis::Y => Vector3::y_axis(),
            Axis::Z => Vector3::z_axis(),
        }
    }

    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The turn by `angle` radians about this axis.
    pub fn turn(self, angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&self.unit(), angle)
    }
}

/// An order of intrinsic Euler turns: `R = R_0(a_0) R_1(a_1) R_2(a_2)` with column vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct EulerOrder(pub [Axis; 3]);

impl EulerOrder {
    /// Reads three letters such as `ZXY`; `None` for anything else or for an order whose neighbours repeat.
    pub fn parse(text: &str) -> Option<Self> {
        let mut axes = [Axis::X; 3];
        let mut letters = text.chars();
        for axis in &mut axes {
            *axis = match letters.next()?.to_ascii_uppercase() {
                'X' => Axis::X,
                'Y' => Axis::Y,
                'Z' => Axis::Z,
                _ => return None,
            };
        }
        let valid = letters.next().is_none() && axes[0] != axes[1] && axes[1] != axes[2];
        valid.then_some(Self(axes))
    }

    /// The rotation of three intrinsic angles (radians).
    pub fn rotation(&self, angles: [f64; 3]) -> UnitQuaternion<f64> {
        self.0[0].turn(angles[0]) * self.0[1].turn(angles[1]) * self.0[2].turn(angles[2])
    }

    /// The three intrinsic angles (radians) of a rotation; at gimbal lock the third is zero but for rounding.
    ///
    /// Tait-Bryan orders put the middle angle in [-pi/2, pi/2], proper Euler orders in [0, pi].
    pub fn angles(&self, q: &UnitQuaternion<f64>) -> [f64; 3] {
        let m: Matrix3<f64> = q.to_rotation_matrix().into_inner();
        let [i, j, k] = self.0.map(Axis::index);
        let proper = i == k;
        // The axis that the order leaves out, for proper orders.
        let last = if proper { 3 - i - j } else { k };
        let sign = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };
        let (first, middle) = if proper {
            let sine = m[(i, j)].hypot(m[(i, last)]);
            let middle = sine.atan2(m[(i, i)]);
            if sine > LOCKED {
                (m[(j, i)].atan2(-sign * m[(last, i)]), middle)
            } else {
                ((sign * m[(last, j)]).atan2(m[(j, j)]), middle)
            }
        } else {
            let cosine = m[(i, i)].hypot(m[(i, j)]);
            let middle = (sign * m[(i, k)]).atan2(cosine);
            if cosine > LOCKED {
                ((-sign * m[(j, k)]).atan2(m[(k, k)]), middle)
            } else {
                ((sign * m[(k, j)]).atan2(m[(j, j)]), middle)
            }
        };
        // What is left over is a turn about the third axis: near gimbal lock this keeps the product exact,
        // where reading the third angle off the matrix would not.
        let rest = (self.0[0].turn(first) * self.0[1].turn(middle)).inverse() * q;
        let third = twist_angle(&rest, &self.0[2].unit());
        [first, middle, third]
    }
}

/// Sine (cosine) of the middle angle below which an Euler order counts as locked.
const LOCKED: f64 = 1e-9;

/// The angle (radians, in (-pi, pi]) of the part of `q` that turns about `axis`: `q = swing * twist`.
pub fn twist_angle(q: &UnitQuaternion<f64>, axis: &Unit<Vector3<f64>>) -> f64 {
    let along = q.imag().dot(axis);
    wrap(2.0 * along.atan2(q.w))
}

/// The angle brought into (-pi, pi].
pub fn wrap(angle: f64) -> f64 {
    let a = angle.rem_euclid(std::f64::consts::TAU);
    if a > std::f64::consts::PI {
        a - std::f64::consts::TAU
    } else {
        a
    }
}

/// The smallest rotation that brings direction `from` to direction `to`; about any normal when they are opposite,
/// none when one of them has no length.
pub fn shortest(from: &Vector3<f64>, to: &Vector3<f64>) -> UnitQuaternion<f64> {
    let (Some(from), Some(to)) = (from.try_normalize(0.0), to.try_normalize(0.0)) else {
        return UnitQuaternion::identity();
    };
    // Half-way direction: exact for tiny turns, where an arc cosine keeps only eight digits.
    if let Some(half) = (from + to).try_normalize(1e-9) {
        let q = nalgebra::Quaternion::from_parts(from.dot(&half), from.cross(&half));
        return UnitQuaternion::new_normalize(q);
    }
    let helper = if from.x.abs() < 0.9 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let axis = Unit::new_normalize(from.cross(&helper));
    UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI)
}

/// The right-handed frame whose z axis is `z` and whose y axis lies as near `y` as it can; `None` when they are parallel or tiny.
pub fn frame_z_y(z: &Vector3<f64>, y: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let z = z.try_normalize(1e-9)?;
    let x = y.cross(&z).try_normalize(1e-6 * y.norm().max(1e-9))?;
    let m = Matrix3::from_columns(&[x, z.cross(&x), z]);
    Some(UnitQuaternion::from_rotation_matrix(
        &nalgebra::Rotation3::from_matrix_unchecked(m),
    ))
}
