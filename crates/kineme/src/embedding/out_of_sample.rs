//! Items that come later: linked to the graph by the same rules, placed by the same projection.

use super::geodesics::Geodesics;
use super::graph::NeighbourGraph;
use super::segmented::SpatioTemporal;
use super::space::Embedding;
use crate::error::{Error, Result};
use crate::math::distances::k_nearest;

/// A new segment, by its distances to all items of the graph; infinite where not known.
#[derive(Debug, Clone, Copy)]
pub struct NewItem<'a> {
    /// Its own distances.
    pub distances: &'a [f64],
    /// Those of the segment before it in its recording, if there is one.
    pub previous: Option<&'a [f64]>,
    /// Those of the segment after it.
    pub next: Option<&'a [f64]>,
}

/// How a new item hangs on a graph.
#[derive(Debug, Clone, PartialEq)]
pub struct Links {
    /// Known items and the lengths of edges to them, shortened as the graph's own are.
    pub edges: Vec<(usize, f64)>,
    /// The plain distance to the nearest known item.
    pub nearest: f64,
}

/// Where a new item lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// In the columns of the embedding.
    pub coordinates: Vec<f64>,
    /// True when it is farther from all known items than 99 % of those are from their nearest: do not trust the place.
    pub novel: bool,
}

impl NeighbourGraph {
    /// Links a new item to its K nearest and to its common temporal neighbours; common temporal neighbours are those whose predecessor or successor is near
    /// its own, by the rule of `options`. Give the successors and options that the graph was made with.
    ///
    /// # Errors
    /// When a row of distances or the successors do not fit the graph, or no distance is finite.
    pub fn links(
        &self,
        item: &NewItem,
        successors: &[Option<usize>],
        options: &SpatioTemporal,
    ) -> Result<Links> {
        options.check()?;
        let rows = [Some(item.distances), item.previous, item.next];
        let lengths = rows.iter().flatten().map(|r| r.len());
        let fitting = lengths.chain([successors.len()]).all(|n| n == self.len());
        let bad = |d: &f64| d.is_nan() || *d < 0.0;
        if !fitting || rows.iter().flatten().any(|r| r.iter().any(bad)) {
            return Err(Error::invalid(format!(
                "a new item has one distance, zero or more, and one successor or none for each of {} items",
                self.len()
            )));
        }
        let wide = options.temporal_neighbours.unwrap_or(options.neighbours);
        let near = |row: &[f64]| -> Vec<usize> {
            let list = k_nearest(row, wide, None);
            list.into_iter().map(|(i, _)| i).collect()
        };
        let (near_previous, near_next) = (item.previous.map(near), item.next.map(near));
        let ranked = k_nearest(item.distances, wide.max(options.neighbours), None);
        let nearest = ranked.first().map(|e| e.1).ok_or_else(|| {
            Error::invalid("a new item needs a finite distance to at least one item")
        })?;
        let shortened = ranked
            .into_iter()
            .enumerate()
            .filter_map(|(rank, (y, distance))| {
                let forward = near_next
                    .as_ref()
                    .zip(successors[y])
                    .map(|(near, next)| near.contains(&next));
                let before = successors.iter().position(|next| *next == Some(y));
                let backward = near_previous
                    .as_ref()
                    .zip(before)
                    .map(|(near, before)| near.contains(&before));
                let common =
                    rank < wide && distance <= self.reach && options.rule.holds(forward, backward);
                let divisor = if common { options.c_ctn } else { 1.0 };
                (rank < options.neighbours || common).then_some((y, distance / divisor))
            });
        Ok(Links {
            edges: shortened.collect(),
            nearest,
        })
    }
}

impl Embedding {
    /// Places an item linked to known ones: its geodesic to each reference leads over the best link, and the
    /// projection of landmark scaling gives its coordinates. `geodesics` are those made with this embedding.
    ///
    /// # Errors
    /// When no link leads to an embedded item, a link is no length, or the components stand apart.
    pub fn place(&self, geodesics: &Geodesics, links: &Links) -> Result<Placement> {
        let projection = self.projection.as_ref().ok_or_else(|| {
            Error::unsupported("separate components have no common space for new items")
        })?;
        let mut to_references = match geodesics {
            Geodesics::All(matrix) => vec![f64::INFINITY; matrix.len()],
            Geodesics::Landmarks(some) => vec![f64::INFINITY; some.rows.len()],
        };
        let mut row = vec![0.0; to_references.len()];
        for &(item, length) in &links.edges {
            if length.is_nan() || length < 0.0 {
                return Err(Error::invalid(format!(
                    "a link is zero or longer, found {length} to item {item}"
                )));
            }
            let Ok(place) = self.items.binary_search(&item) else {
                continue;
            };
            match geodesics {
                Geodesics::All(matrix) => matrix.row_into(place, &mut row),
                Geodesics::Landmarks(some) => {
                    for (value, from) in row.iter_mut().zip(&some.rows) {
                        *value = from[place];
                    }
                }
            }
            for (best, known) in to_references.iter_mut().zip(&row) {
                *best = best.min(length + known);
            }
        }
        if to_references.iter().any(|d| d.is_infinite()) {
            return Err(Error::invalid("no link leads to an embedded item"));
        }
        Ok(Placement {
            coordinates: projection.place(&to_references, self.dimension),
            novel: links.nearest > self.novelty,
        })
    }
}
