//! Times spatio-temporal Isomap and clustering on made-up segments, and the graph of as many made-up frames:
//! `embedding_timing [items]`.

use std::time::Instant;

use kineme::clustering::{Density, SweepAndPrune, hdbscan, sweep_and_prune};
use kineme::embedding::{Continuous, EmbedOptions, Frames, NeighbourGraph, SpatioTemporal, embed};
use kineme::math::distances::DistanceMatrix;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn main() -> kineme::Result<()> {
    let len: usize = std::env::args()
        .nth(1)
        .and_then(|n| n.parse().ok())
        .unwrap_or(5_000);
    let mut random = Pcg64::seed_from_u64(1);
    let groups: Vec<Vec<f64>> = (0..20)
        .map(|_| (0..12).map(|_| random.random_range(-1.0..1.0)).collect())
        .collect();
    // A routine of twenty movements, again and again, never twice the same.
    let points: Vec<f64> = (0..len)
        .flat_map(|i| groups[i % 20].clone())
        .map(|v| v + 0.4 * random.random_range(-1.0..1.0))
        .collect();
    let successors: Vec<Option<usize>> = (0..len)
        .map(|i| ((i + 1) % 200 != 0 && i + 1 < len).then_some(i + 1))
        .collect();
    let start = Instant::now();
    let mut last = 0.0;
    let mut lap = |what: &str| {
        let now = start.elapsed().as_secs_f64();
        println!("{what}: {:.2} s", now - last);
        last = now;
    };
    let distances = DistanceMatrix::euclidean(&points, 12)?;
    lap("distances");
    let options = SpatioTemporal {
        neighbours: 12,
        ..SpatioTemporal::default()
    };
    let graph = NeighbourGraph::segmented(&distances, &successors, &options)?;
    lap("graph");
    let edges = graph.edges().len();
    println!("  {:.1} edges a node", 2.0 * edges as f64 / len as f64);
    let matrix = graph.geodesics();
    lap("geodesics");
    drop(matrix);
    let (embedding, geodesics) = embed(&graph, &EmbedOptions::default())?;
    lap("geodesics, scaling and residual variance");
    println!(
        "  dimension {}, residual variance {:.3?}, negative share {:.3}",
        embedding.dimension, embedding.residual_variance, embedding.negative_share
    );
    if let Some(matrix) = geodesics.matrix() {
        let labels = hdbscan(matrix, &Density::default())?;
        let groups = labels.iter().flatten().max().map_or(0, |m| m + 1);
        lap("hdbscan");
        println!(
            "  {groups} groups, {} noise",
            labels.iter().filter(|l| l.is_none()).count()
        );
    }
    let found = sweep_and_prune(
        &embedding.coordinates,
        embedding.dimension,
        &SweepAndPrune::default(),
    )?;
    lap("sweep and prune with stability");
    println!(
        "  width {:.4}, stability {:.2}",
        found.width, found.stability
    );
    let frames: Vec<f64> = (0..len * 30)
        .map(|v| ((v / 30) as f64 * 0.07 * (1.0 + 0.01 * (v % 30) as f64)).sin())
        .collect();
    let frames = Frames::new(&frames, 30, &[len / 2, len - len / 2])?;
    let graph = NeighbourGraph::continuous(&frames, &Continuous::default())?;
    lap("continuous graph of 30-dimensional frames");
    println!("  {} common temporal neighbours", graph.common_edges());
    println!("all: {:.2} s", start.elapsed().as_secs_f64());
    Ok(())
}
