//! From a neighbourhood graph to coordinates, whatever its size and however many components it has.

use super::components::Disconnected;
use super::geodesics::Geodesics;
use super::graph::{Edge, NeighbourGraph};
use super::scaling::{self, Projection, Scaling};
use crate::error::{Error, Result};
use crate::math::distances::DistanceMatrix;

/// Above this many items landmarks are followed: a matrix of all pairs would take 4 n^2 bytes.
const DENSE_ITEMS: usize = 8_000;

/// How a graph is embedded.
#[derive(Debug, Clone, PartialEq)]
pub struct EmbedOptions {
    /// Columns of the coordinates; `None` for the first with less than 5 % residual variance, else the knee.
    pub dimension: Option<usize>,
    /// Axes computed and judged, at least 1.
    pub max_dimension: usize,
    /// What becomes of several components.
    pub disconnected: Disconnected,
    /// How many landmarks to follow; `None` for all items up to 8,000, above for 5 % of them.
    pub landmarks: Option<usize>,
}

impl Default for EmbedOptions {
    fn default() -> Self {
        Self {
            dimension: None,
            max_dimension: 10,
            disconnected: Disconnected::Connect,
            landmarks: None,
        }
    }
}

/// Items as points, and what to know of how they came there.
#[derive(Debug, Clone, PartialEq)]
pub struct Embedding {
    /// The item of each row of `coordinates` and of the geodesics, rising: all, but for [`Disconnected::Largest`].
    pub items: Vec<usize>,
    /// Row-major, items by `dimension`, in the unit of the distances.
    pub coordinates: Vec<f64>,
    /// Columns of `coordinates`.
    pub dimension: usize,
    /// Leading eigenvalues, falling, as many as axes were judged.
    pub eigenvalues: Vec<f64>,
    /// Residual variance with 1, 2, ... axes.
    pub residual_variance: Vec<f64>,
    /// Magnitude of the negative eigenvalues over that of all: how far the geodesics are from Euclidean. Exact up to
    /// 1,000 items or landmarks, estimated above.
    pub negative_share: f64,
    /// The component of every item of the graph before any joining, numbered in the order of first appearance.
    pub components: Vec<usize>,
    /// Edges that were put in to join components; their lengths are plain distances.
    pub synthetic_edges: Vec<Edge>,
    /// The landmarks, if not all items were followed, as rows.
    pub landmarks: Option<Vec<usize>>,
    /// None where components stand apart.
    pub(super) projection: Option<Projection>,
    pub(super) novelty: f64,
}

impl Embedding {
    /// The coordinates of a row.
    ///
    /// # Panics
    /// When there is no such row.
    pub fn point(&self, row: usize) -> &[f64] {
        &self.coordinates[row * self.dimension..(row + 1) * self.dimension]
    }
}

/// Geodesics of a graph, and coordinates that keep them. Eigenvalues, residual variance and negative share are those of
/// the largest component where components are [separate](Disconnected::Separate).
///
/// # Errors
/// With fewer than two items or no axis; when candidates do not suffice to join the components; when landmarks
/// are fewer than axes and one more, or asked for of separate components.
pub fn embed(graph: &NeighbourGraph, options: &EmbedOptions) -> Result<(Embedding, Geodesics)> {
    let unusable = options.max_dimension == 0 || options.dimension == Some(0);
    if graph.len() < 2 || unusable {
        return Err(Error::invalid(format!(
            "an embedding needs two items and one axis at least, found {} items, {} axes",
            graph.len(),
            options.dimension.unwrap_or(options.max_dimension)
        )));
    }
    let several = graph.components().iter().any(|c| *c > 0);
    let mut items: Vec<usize> = (0..graph.len()).collect();
    let mut synthetic_edges = Vec::new();
    let changed = match options.disconnected {
        _ if !several => None,
        Disconnected::Separate => None,
        Disconnected::Connect => {
            synthetic_edges = graph.bridges().to_vec();
            let joined = graph.joined();
            if joined.components().iter().any(|c| *c > 0) {
                return Err(Error::unsupported(
                    "the candidate distances do not join all components: give more, or embed the largest one or each alone",
                ));
            }
            Some(joined)
        }
        Disconnected::Largest => {
            items = graph.largest_component();
            Some(graph.restricted(&items))
        }
    };
    let used = changed.as_ref().unwrap_or(graph);
    let landmarks = options.landmarks.or_else(|| {
        let some = (used.len() / 20).max(200);
        (used.len() > DENSE_ITEMS).then_some(some)
    });
    let apart = several && options.disconnected == Disconnected::Separate;
    let axes = options.max_dimension.max(options.dimension.unwrap_or(1));
    let (geodesics, placed) = match landmarks {
        Some(_) if apart => {
            return Err(Error::unsupported(
                "landmarks need one component: connect them or take the largest",
            ));
        }
        Some(count) => embed_landmarks(used, count, axes)?,
        None => {
            let matrix = used.geodesics();
            let placed = if apart {
                embed_apart(&matrix, used, axes, options.dimension)?
            } else {
                embed_all(&matrix, axes)?
            };
            (Geodesics::All(matrix), placed)
        }
    };
    let Placed {
        scaling,
        residual,
        projection,
    } = placed;
    let dimension = options
        .dimension
        .unwrap_or_else(|| scaling::choose_dimension(&residual))
        .min(scaling.dimension);
    let coordinates = scaling
        .coordinates
        .chunks_exact(scaling.dimension)
        .flat_map(|row| &row[..dimension])
        .copied()
        .collect();
    let landmarks = match &geodesics {
        Geodesics::All(_) => None,
        Geodesics::Landmarks(some) => Some(some.landmarks.clone()),
    };
    let embedding = Embedding {
        items,
        coordinates,
        dimension,
        eigenvalues: scaling.eigenvalues,
        residual_variance: residual,
        negative_share: scaling.negative_share,
        components: graph.components().to_vec(),
        synthetic_edges,
        landmarks,
        projection,
        novelty: graph.novelty_threshold(),
    };
    Ok((embedding, geodesics))
}

/// Coordinates on all axes that were judged.
struct Placed {
    scaling: Scaling,
    residual: Vec<f64>,
    projection: Option<Projection>,
}

fn embed_all(matrix: &DistanceMatrix, axes: usize) -> Result<Placed> {
    let (scaling, projection) = scaling::scale(matrix, axes)?;
    let residual = scaling::residual_variance(matrix, &scaling.coordinates, scaling.dimension)?;
    Ok(Placed {
        scaling,
        residual,
        projection: Some(projection),
    })
}

fn embed_landmarks(
    graph: &NeighbourGraph,
    count: usize,
    axes: usize,
) -> Result<(Geodesics, Placed)> {
    if count <= axes.min(graph.len() - 1) {
        return Err(Error::invalid(format!(
            "{axes} axes need more than {axes} landmarks (ten times as many are good), found {count}"
        )));
    }
    let from = graph.landmark_geodesics(count)?;
    // Both directions of a path may differ in the last bit: the upper triangle decides.
    let among = DistanceMatrix::from_fn(count, |a, b| from.rows[a][from.landmarks[b]])?;
    let (mut scaling, projection) = scaling::scale(&among, axes)?;
    let mut to_landmarks = vec![0.0; count];
    scaling.coordinates = (0..graph.len())
        .flat_map(|i| {
            for (distance, row) in to_landmarks.iter_mut().zip(&from.rows) {
                *distance = row[i];
            }
            projection.place(&to_landmarks, projection.axes())
        })
        .collect();
    let residual =
        scaling::landmark_residual_variance(&from, &scaling.coordinates, scaling.dimension);
    let placed = Placed {
        scaling,
        residual,
        projection: Some(projection),
    };
    Ok((Geodesics::Landmarks(from), placed))
}

/// Each component alone, side by side along the first axis, a gap as wide as the widest between them.
fn embed_apart(
    matrix: &DistanceMatrix,
    graph: &NeighbourGraph,
    axes: usize,
    dimension: Option<usize>,
) -> Result<Placed> {
    let count = graph.components().iter().max().map_or(0, |m| m + 1);
    let mut members = vec![Vec::new(); count];
    for (item, &label) in graph.components().iter().enumerate() {
        members[label].push(item);
    }
    let largest = graph.components()[graph.largest_component()[0]];
    let Placed {
        scaling, residual, ..
    } = embed_all(&matrix.subset(&members[largest]), axes)?;
    let columns = dimension.unwrap_or_else(|| scaling::choose_dimension(&residual));
    let alone = members
        .iter()
        .map(|m| scaling::classical_mds(&matrix.subset(m), columns))
        .collect::<Result<Vec<Scaling>>>()?;
    let extent = |s: &Scaling| {
        let first = s.coordinates.iter().step_by(s.dimension);
        let ends = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
        first.fold((f64::INFINITY, f64::NEG_INFINITY), ends)
    };
    let widest = alone
        .iter()
        .map(extent)
        .map(|(low, high)| high - low)
        .fold(0.0, f64::max);
    let gap = if widest > 0.0 { widest } else { 1.0 };
    let columns = columns.min(scaling.dimension);
    let mut coordinates = vec![0.0; graph.len() * columns];
    let mut cursor = 0.0;
    for (items, part) in members.iter().zip(&alone) {
        let (low, high) = extent(part);
        for (r, &item) in items.iter().enumerate() {
            let row = &part.coordinates[r * part.dimension..(r + 1) * part.dimension];
            let place = &mut coordinates[item * columns..(item + 1) * columns];
            for (value, v) in place.iter_mut().zip(row) {
                *value = *v;
            }
            place[0] += cursor - low;
        }
        cursor += high - low + gap;
    }
    Ok(Placed {
        scaling: Scaling {
            coordinates,
            dimension: columns,
            ..scaling
        },
        residual,
        projection: None,
    })
}
