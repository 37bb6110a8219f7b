//! What moves on a page, made from motions, recordings and vocabularies.
//!
//! The page's own types ([`kineme_report::scene`]) know points and times only; here is decided which points a body
//! has, how finely a movement is shown, and what is said when something is left out.

mod cards;
mod flesh;
mod flow;
mod shows;
mod takes;

pub use cards::{CardBudget, HOW_TO_READ, cards};
pub use flesh::Shape;
pub use shows::{take_of_performance, takes_of_show};
pub use takes::{Shown, actor, actor_of_recording, spans, take_of_derived, thinned};

use kineme_report::scene::{Body, Scene};

/// The index of a body in the scene, which gets it if it has it not.
pub fn body_index(scene: &mut Scene, body: &Body) -> usize {
    let known = scene.bodies.iter().position(|b| b == body);
    known.unwrap_or_else(|| {
        scene.bodies.push(body.clone());
        scene.bodies.len() - 1
    })
}

/// Thickness of a sole, metres: so far above the ground is the lowest point of who stands on it.
const SOLE_M: f64 = 0.025;

/// Lifts or lowers a movement so that it stands on the ground where it is lowest: floors of studios are not all at zero.
/// A body that was never `placed` in height, such as a choreographed one, stands on it at every moment.
fn ground(rows: &mut [Vec<[f64; 3]>], placed: bool) {
    let pieces = if placed { rows.len() } else { 1 };
    for rows in rows.chunks_mut(pieces.max(1)) {
        let heights = rows.iter().flatten().map(|p| p[2]);
        let lowest = heights
            .filter(|z| z.is_finite())
            .fold(f64::INFINITY, f64::min);
        if lowest.is_finite() {
            for point in rows.iter_mut().flatten() {
                point[2] += SOLE_M - lowest;
            }
        }
    }
}

/// Whether heights differ at all.
fn differ(heights: impl IntoIterator<Item = f64>) -> bool {
    let mut heights = heights.into_iter();
    let first = heights.next();
    heights.any(|h| first.is_some_and(|f| (h - f).abs() > 1e-6))
}

/// Bytes that a point takes on the page: three numbers of 16 bits in base64.
const BYTES_PER_POINT: usize = 8;
