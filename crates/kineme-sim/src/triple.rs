//! [`Triple`]: three hinges in one body that turn as one ball joint.

use kineme::math::rotation::{Axis, EulerOrder, exp, wrap};
use kineme::skeleton::{ClinicalAxes, Range};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Postures of each clinical angle, ends included, among which [`Triple::between`] looks for the lock.
const POSTURES: usize = 5;
/// The share of a joint's ranges, about the neutral posture, in which people move most.
const USUAL: f64 = 0.5;
/// Cosine of the middle angle below which rates are damped: 3 degrees from the lock.
const LOCKING: f64 = 0.05;
/// Damping of the rates there.
const DAMPING: f64 = 1e-3;

/// Three hinges about orthogonal axes, one after the other, which together take every rotation of a ball joint.
///
/// Their angles are intrinsic Euler angles of the rotation relative to the ball's reference rotation. Where the middle
/// angle comes to a right angle the first and the third axis coincide and the triple is locked: [`Self::between`]
/// chooses axes that keep away from there.
#[derive(Debug, Clone, PartialEq)]
pub struct Triple {
    /// The frame of the axes in the ball's reference frame.
    pub frame: UnitQuaternion<f64>,
    /// The axes of that frame about which the hinges turn, from the parent outward.
    pub order: EulerOrder,
}

impl Triple {
    /// The axes for a ball joint of these ranges (flexion, abduction, axial rotation): those whose middle angle stays
    /// smallest over the half of every range about the neutral posture.
    ///
    /// Over whole ranges no axes spare a shoulder the lock, for its ranges combine to nearly all rotations; over these
    /// halves, where people move most, no joint of Ares comes nearer to it than 30 degrees.
    pub fn between(
        reference: &UnitQuaternion<f64>,
        axes: &ClinicalAxes,
        ranges: &[Range; 3],
    ) -> Self {
        let angles = ranges.map(|r| {
            std::array::from_fn::<f64, POSTURES, _>(|i| {
                let share = i as f64 / (POSTURES - 1) as f64;
                USUAL * (r.low + share * (r.high - r.low))
            })
        });
        let mut postures = Vec::with_capacity(POSTURES.pow(3));
        for flexion in angles[0] {
            for abduction in angles[1] {
                for axial in angles[2] {
                    postures.push(reference.inverse() * axes.rotation(flexion, abduction, axial));
                }
            }
        }
        let mut best: Option<(f64, Triple)> = None;
        for triple in candidates() {
            let worst = postures.iter().map(|q| triple.lock(q)).fold(0.0, f64::max);
            // Candidates come in pairs that differ by signs: the first of equals, whatever the rounding.
            if best.as_ref().is_none_or(|(least, _)| worst < least - 1e-9) {
                best = Some((worst, triple));
            }
        }
        best.map_or_else(Self::plain, |(_, triple)| triple)
    }

    /// About y, x and z of the reference frame.
    pub fn plain() -> Self {
        Self {
            frame: UnitQuaternion::identity(),
            order: EulerOrder([Axis::Y, Axis::X, Axis::Z]),
        }
    }

    /// The axes in the ball's reference frame, from the parent outward.
    pub fn axes(&self) -> [Vector3<f64>; 3] {
        self.order
            .0
            .map(|axis| self.frame * axis.unit().into_inner())
    }

    /// The rotation relative to the reference rotation at these angles, radians.
    pub fn rotation(&self, angles: [f64; 3]) -> UnitQuaternion<f64> {
        self.frame * self.order.rotation(angles) * self.frame.inverse()
    }

    /// The angles (radians) of a rotation: of the two triples that make it, and of their full turns, those nearest
    /// `previous`, so that a movement goes on through the lock.
    pub fn angles(&self, rotation: &UnitQuaternion<f64>, previous: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.euler(rotation);
        let pi = std::f64::consts::PI;
        let near = |angles: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| previous[i] + wrap(angles[i] - previous[i]))
        };
        let far =
            |angles: &[f64; 3]| -> f64 { (0..3).map(|i| (angles[i] - previous[i]).powi(2)).sum() };
        let (one, other) = (near([a, b, c]), near([a + pi, pi - b, c + pi]));
        if far(&other) < far(&one) { other } else { one }
    }

    /// The matrix that takes the rates of the angles to the angular velocity in the turned frame.
    pub fn rates(&self, angles: [f64; 3]) -> Matrix3<f64> {
        let [a, b, c] = self.axes();
        let third = exp(&(c * angles[2])).inverse();
        let second = exp(&(b * angles[1])).inverse();
        Matrix3::from_columns(&[third * (second * a), third * b, c])
    }

    /// The rates of the angles (radians a second) that turn with this angular velocity, given in the turned frame.
    /// Within 3 degrees of the lock, where no rates do, those that come near without growing beyond measure.
    pub fn rates_of(&self, angles: [f64; 3], angular: &Vector3<f64>) -> [f64; 3] {
        let matrix = self.rates(angles);
        if angles[1].cos().abs() > LOCKING
            && let Some(inverse) = matrix.try_inverse()
        {
            return (inverse * angular).into();
        }
        // Damped least squares.
        let square = matrix.transpose() * matrix + Matrix3::identity() * DAMPING;
        let rates = square.try_inverse().map_or_else(Vector3::zeros, |inverse| {
            inverse * matrix.transpose() * angular
        });
        rates.into()
    }

    /// How far the middle angle is from zero, radians, in [0, pi / 2].
    pub fn lock(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        self.euler(rotation)[1].abs()
    }

    fn euler(&self, rotation: &UnitQuaternion<f64>) -> [f64; 3] {
        self.order
            .angles(&(self.frame.inverse() * rotation * self.frame))
    }
}

/// All orders of three different axes, of the reference frame and of this frame turned half-way about each of them.
fn candidates() -> impl Iterator<Item = Triple> {
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let half = std::f64::consts::FRAC_PI_4;
    let turned = axes
        .into_iter()
        .flat_map(move |a| [a.turn(-half), a.turn(half)]);
    let frames = std::iter::once(UnitQuaternion::identity()).chain(turned);
    let orders = [
        [1, 0, 2],
        [1, 2, 0],
        [0, 1, 2],
        [0, 2, 1],
        [2, 0, 1],
        [2, 1, 0],
    ];
    frames.flat_map(move |frame| {
        orders.map(|order| Triple {
            frame,
            order: EulerOrder(order.map(|i| axes[i])),
        })
    })
}
