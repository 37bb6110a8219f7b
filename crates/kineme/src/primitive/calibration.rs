//! [`Calibration`]: what a recogniser learned of a vocabulary by leaving exemplars out, as plain numbers.

/// What a recogniser learned of a vocabulary by leaving exemplars out, stored with it. The recogniser of that name knows
/// what the numbers mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The recogniser, such as `filter`.
    pub recogniser: String,
    /// Finite numbers of each primitive, in the order of the vocabulary, equally many.
    pub primitives: Vec<Vec<f64>>,
    /// Finite numbers of the whole, such as a temperature.
    pub shared: Vec<f64>,
}
