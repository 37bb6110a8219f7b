//! The exact set of parameters and phases at which a primitive can assume values: what the paper's Figures 4 to 6
//! approximate by phases alone.

use super::Frame;
use super::tree::Query;
use crate::error::{Error, Result};

/// A patch of a primitive's manifold: a cell of the lattice over parameters and phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// The middle of its parameters, in [0, 1]^m.
    pub parameters: Vec<f64>,
    /// Half of its length along each parameter; 0 where it is a single place.
    pub reach: Vec<f64>,
    /// Its phases, from and to.
    pub phase: [f64; 2],
    /// The least and greatest value in it of each coordinate that was asked for, radians.
    pub bounds: Vec<[f64; 2]>,
}

impl Frame<'_> {
    /// The names of the coordinates that are compared, as [`crate::perception::Paper::coordinates`].
    pub fn coordinates(&self) -> &[String] {
        self.scope.parts.names()
    }

    /// The patches of a primitive in which all these coordinates can be within the tolerance of these values at once,
    /// with the bounds in them of the coordinates `shown`; in the order of the lattice. Without values, all patches.
    ///
    /// # Errors
    /// When there is no such primitive, or a coordinate is none that a primitive moves.
    pub fn explaining(
        &self,
        primitive: usize,
        values: &[(usize, f64)],
        shown: &[usize],
    ) -> Result<Vec<Patch>> {
        let Some(class) = self.classes.get(primitive) else {
            let count = self.classes.len();
            return Err(Error::invalid(format!("primitive {primitive} of {count}")));
        };
        let column = |c: usize| {
            let at = self.columns.iter().position(|&k| k == c);
            at.ok_or_else(|| Error::invalid(format!("no primitive moves coordinate {c}")))
        };
        // What is not asked for is not seen: it lies outside of nothing.
        let mut at = vec![f32::NAN; self.columns.len()];
        for &(c, value) in values {
            at[column(c)?] = value as f32;
        }
        let shown = shown
            .iter()
            .map(|&c| column(c))
            .collect::<Result<Vec<_>>>()?;
        let gaps = vec![0.0; self.scope.parts.count()];
        let boxes = class.tree.boxes();
        let (pieces, params) = (class.shape.pieces, class.params);
        let patch = |cell: usize| {
            let (row, piece) = (cell / pieces, cell % pieces);
            let own = row * params..(row + 1) * params;
            Patch {
                parameters: class.points[own.clone()].to_vec(),
                reach: class.reach[own].to_vec(),
                phase: [piece, piece + 1].map(|i| i as f64 / pieces as f64),
                bounds: shown
                    .iter()
                    .map(|&k| boxes[cell][k].map(f64::from))
                    .collect(),
            }
        };
        let hits = class.tree.hits(&Query { at, gaps });
        Ok(hits.iter().map(|hit| patch(hit.cell as usize)).collect())
    }
}
