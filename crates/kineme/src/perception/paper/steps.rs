//! The steps of the paper's computation as its Figures 4 to 6 show them: what the classifier itself looks at.

use super::Paper;
use super::class::{Class, Coordinate};
use super::intervals::Intervals;
use crate::error::{Error, Result};

/// What a coordinate does over all parameters: the mixture space of Figures 4 and 5.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    /// Phases in [0, 1] at which f was sampled, rising: one more than [`super::PaperSettings::pieces`].
    pub phases: Vec<f64>,
    /// The least value at each phase, radians; linear between them.
    pub low: Vec<f64>,
    /// The greatest.
    pub high: Vec<f64>,
    /// The values sampled at each phase, one for each place in parameter space, places in the same order at all phases.
    pub samples: Vec<Vec<f64>>,
}

/// A histogram as a density: Figure 6.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    /// Ends of the bins, rising, one more than bins, radians.
    pub edges: Vec<f64>,
    /// Density in each bin, 1/rad; over all bins it integrates to one.
    pub densities: Vec<f64>,
}

/// The computation step by step. A primitive is named by its place in the vocabulary, a coordinate by its place in
/// [`Paper::coordinates`]; a set of phases is sorted, disjoint intervals in [0, 1].
impl Paper<'_> {
    /// The names of the coordinates that are compared: a hinge's own, or a ball's role with the axis of its rotation
    /// vector, such as `right_upper_arm_x`.
    pub fn coordinates(&self) -> &[String] {
        self.scope.parts.names()
    }

    /// A pose of the vocabulary's body in these coordinates, radians.
    ///
    /// # Errors
    /// When the pose has not the body's coordinates.
    pub fn place(&self, pose: &[f64]) -> Result<Vec<f64>> {
        let dof = self.vocabulary.body().dof();
        match pose.len() == dof {
            true => Ok(self.scope.parts.place(pose)),
            false => Err(Error::invalid(format!(
                "a pose of {} coordinates for a body of {dof}",
                pose.len()
            ))),
        }
    }

    /// The coordinates that a primitive's chain of densities goes through, in its order.
    ///
    /// # Errors
    /// When there is no such primitive.
    pub fn chain(&self, primitive: usize) -> Result<Vec<usize>> {
        Ok(self
            .class(primitive)?
            .chain()
            .iter()
            .map(|c| c.at)
            .collect())
    }

    /// The length of the range over which a coordinate is uniform where the movement is not the primitive, radians.
    ///
    /// # Errors
    /// When the coordinate is not among those of the chain.
    pub fn range_rad(&self, coordinate: usize) -> Result<f64> {
        match self.scope.moving.contains(&coordinate) {
            true => Ok(self.scope.range(coordinate)),
            false => Err(self.unmoved(coordinate)),
        }
    }

    /// The mixture space of a coordinate (Figures 4 and 5).
    ///
    /// # Errors
    /// When there is no such primitive, or the coordinate is none that a primitive moves.
    pub fn mixture(&self, primitive: usize, coordinate: usize) -> Result<Mixture> {
        let own = self.coordinate(primitive, coordinate)?;
        let pieces = self.settings.pieces;
        Ok(Mixture {
            phases: (0..=pieces).map(|i| i as f64 / pieces as f64).collect(),
            low: own.envelope.low.clone(),
            high: own.envelope.high.clone(),
            samples: self.classes[primitive].samples(coordinate),
        })
    }

    /// The phases within `within` at which a coordinate can assume a value, the tolerance allowed for: the interval
    /// search of Figure 4.
    ///
    /// # Errors
    /// As [`Self::mixture`], and when `within` is no set of phases.
    pub fn attained(
        &self,
        primitive: usize,
        coordinate: usize,
        value: f64,
        within: &[[f64; 2]],
    ) -> Result<Vec<[f64; 2]>> {
        let own = self.coordinate(primitive, coordinate)?;
        let within = self.in_pieces(within)?;
        let mut found = Intervals::new();
        own.envelope
            .attained(value, self.delta_rad(), &within, &mut found);
        let pieces = self.settings.pieces as f64;
        Ok(found
            .iter()
            .map(|(a, b)| [a / pieces, b / pieces])
            .collect())
    }

    /// The density of a coordinate's value among samples from these phases, 1/rad: what the classifier reads off the
    /// histogram, the bins that meet the tolerance together.
    ///
    /// # Errors
    /// As [`Self::attained`].
    pub fn density(
        &self,
        primitive: usize,
        coordinate: usize,
        value: f64,
        within: &[[f64; 2]],
    ) -> Result<f64> {
        let own = self.coordinate(primitive, coordinate)?;
        let within = self.in_pieces(within)?;
        Ok(own.histogram.density(value, self.delta_rad(), &within))
    }

    /// The histogram of a coordinate's samples from these phases (Figure 6).
    ///
    /// # Errors
    /// As [`Self::attained`].
    pub fn histogram(
        &self,
        primitive: usize,
        coordinate: usize,
        within: &[[f64; 2]],
    ) -> Result<Bars> {
        let own = self.coordinate(primitive, coordinate)?;
        let (edges, densities) = own.histogram.bars(&self.in_pieces(within)?);
        Ok(Bars { edges, densities })
    }

    fn class(&self, primitive: usize) -> Result<&Class> {
        let count = self.classes.len();
        let missing = || Error::invalid(format!("primitive {primitive} of {count}"));
        self.classes.get(primitive).ok_or_else(missing)
    }

    fn coordinate(&self, primitive: usize, coordinate: usize) -> Result<&Coordinate> {
        let mut chain = self.class(primitive)?.chain().iter();
        let own = chain.find(|c| c.at == coordinate);
        own.ok_or_else(|| self.unmoved(coordinate))
    }

    fn unmoved(&self, coordinate: usize) -> Error {
        match self.coordinates().get(coordinate) {
            Some(name) => Error::invalid(format!("no primitive moves `{name}`")),
            None => Error::invalid(format!(
                "coordinate {coordinate} of {}",
                self.coordinates().len()
            )),
        }
    }

    /// A set of phases in pieces.
    fn in_pieces(&self, within: &[[f64; 2]]) -> Result<Intervals> {
        let ends = within.as_flattened();
        let rising = ends.windows(2).all(|w| w[0] <= w[1]);
        if !rising || !ends.iter().all(|e| (0.0..=1.0).contains(e)) {
            return Err(Error::invalid(format!(
                "{within:?} are no rising intervals of phase in [0, 1]"
            )));
        }
        let pieces = self.settings.pieces as f64;
        Ok(within
            .iter()
            .map(|[a, b]| (a * pieces, b * pieces))
            .collect())
    }
}
