//! Masses, lengths and inertias of body segments from the literature, and how a segment is sliced among joints.
//!
//! Masses, centres and radii of gyration: P. de Leva, "Adjustments to Zatsiorsky-Seluyanov's segment inertia
//! parameters", Journal of Biomechanics 29(9), 1996, men. Widths and heights that de Leva does not give: R. Drillis
//! and R. Contini, "Body segment parameters", 1966, as shares of stature.

use nalgebra::{Matrix3, Vector3};

use super::joint::Link;

/// Stature of the reference man, metres (de Leva 1996).
pub const STATURE: f64 = 1.741;
/// Mass of the reference man, kilograms (de Leva 1996).
pub const BODY_MASS: f64 = 73.0;

/// A segment of the table.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    /// Length, metres.
    pub length: f64,
    /// Share of body mass.
    pub mass: f64,
    /// Centre of mass as a share of the length, from the upper (proximal) end.
    pub center: f64,
    /// Radii of gyration over length about the sagittal (x), transverse (y) and longitudinal (z) axis.
    pub radii: [f64; 3],
}

const fn segment(length: f64, mass: f64, center: f64, radii: [f64; 3]) -> Segment {
    Segment {
        length,
        mass,
        center,
        radii,
    }
}

/// Head with neck, vertex to mid gonion.
pub const HEAD: Segment = segment(0.2033, 0.0694, 0.5976, [0.362, 0.376, 0.312]);
/// Upper trunk, suprasternale to xiphion.
pub const UPPER_TRUNK: Segment = segment(0.1707, 0.1596, 0.2999, [0.716, 0.454, 0.659]);
/// Middle trunk, xiphion to omphalion.
pub const MIDDLE_TRUNK: Segment = segment(0.2155, 0.1633, 0.4502, [0.482, 0.383, 0.468]);
/// Lower trunk, omphalion to mid hip.
pub const LOWER_TRUNK: Segment = segment(0.1457, 0.1117, 0.6115, [0.615, 0.551, 0.587]);
/// Upper arm.
pub const UPPER_ARM: Segment = segment(0.2817, 0.0271, 0.5772, [0.285, 0.269, 0.158]);
/// Forearm.
pub const FOREARM: Segment = segment(0.2689, 0.0162, 0.4574, [0.276, 0.265, 0.121]);
/// Hand, wrist to third metacarpal head.
pub const HAND: Segment = segment(0.0862, 0.0061, 0.7900, [0.628, 0.513, 0.401]);
/// Thigh.
pub const THIGH: Segment = segment(0.4222, 0.1416, 0.4095, [0.329, 0.329, 0.149]);
/// Shank.
pub const SHANK: Segment = segment(0.4340, 0.0433, 0.4459, [0.255, 0.249, 0.103]);
/// Foot, heel to toe tip.
pub const FOOT: Segment = segment(0.2581, 0.0137, 0.4415, [0.257, 0.245, 0.124]);

/// Half the width between the shoulders, metres (Drillis and Contini: .129 of stature).
pub const HALF_SHOULDERS: f64 = 0.129 * STATURE;
/// Half the width between the hips, metres (.0955 of stature).
pub const HALF_HIPS: f64 = 0.0955 * STATURE;
/// Height of the shoulders over the hips, metres (.818 and .530 of stature).
pub const SHOULDERS_OVER_HIPS: f64 = (0.818 - 0.530) * STATURE;
/// Height of the ankle, metres (.039 of stature).
pub const ANKLE_HEIGHT: f64 = 0.039 * STATURE;
/// Length of the whole hand, metres (.108 of stature).
pub const WHOLE_HAND: f64 = 0.108 * STATURE;

impl Segment {
    /// Mass in kilograms.
    pub fn mass_kg(&self) -> f64 {
        self.mass * BODY_MASS
    }

    /// Second moments of mass (integral of x^2, y^2, z^2 over the segment, about its centre), kg m^2.
    ///
    /// From the principal inertias `I = m (r L)^2`: for example `Sxx = (Iy + Iz - Ix) / 2`.
    fn second_moments(&self) -> [f64; 3] {
        let i = self
            .radii
            .map(|r| self.mass_kg() * (r * self.length).powi(2));
        [
            0.5 * (i[1] + i[2] - i[0]),
            0.5 * (i[0] + i[2] - i[1]),
            0.5 * (i[0] + i[1] - i[2]),
        ]
    }

    /// The whole segment hanging down from its joint (longitudinal axis -z).
    pub fn hanging(&self) -> Link {
        link(
            self.mass_kg(),
            Vector3::new(0.0, 0.0, -self.center * self.length),
            self.second_moments(),
        )
    }

    /// A slice that takes `share` of the mass and is `height` metres long, with its centre at `center` of a joint's
    /// frame, longitudinal axis z: it keeps the segment's widths, and along z it is uniform.
    pub fn slice(&self, share: f64, height: f64, center: Vector3<f64>) -> Link {
        let [x, y, _] = self.second_moments();
        let mass = share * self.mass_kg();
        link(
            mass,
            center,
            [share * x, share * y, mass * height * height / 12.0],
        )
    }

    /// The same slice with its longitudinal axis along x (feet): what was x, the width across the sole, becomes z.
    pub fn slice_forward(&self, share: f64, length: f64, center: Vector3<f64>) -> Link {
        let [x, y, _] = self.second_moments();
        let mass = share * self.mass_kg();
        link(
            mass,
            center,
            [mass * length * length / 12.0, share * y, share * x],
        )
    }
}

fn link(mass_kg: f64, center: Vector3<f64>, [x, y, z]: [f64; 3]) -> Link {
    Link {
        mass_kg,
        center,
        inertia: Matrix3::from_diagonal(&Vector3::new(y + z, x + z, x + y)),
    }
}

/// Two rigidly joined links as one (parallel axis theorem).
pub fn join(a: &Link, b: &Link) -> Link {
    let mass_kg = a.mass_kg + b.mass_kg;
    let center = (a.center * a.mass_kg + b.center * b.mass_kg) / mass_kg;
    let about = |l: &Link| {
        let d = l.center - center;
        l.inertia + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * l.mass_kg
    };
    Link {
        mass_kg,
        center,
        inertia: about(a) + about(b),
    }
}

/// A link moved within its joint's frame.
pub fn moved(link: &Link, by: Vector3<f64>) -> Link {
    Link {
        center: link.center + by,
        ..link.clone()
    }
}
