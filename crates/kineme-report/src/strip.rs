//! A movement as a strip of postures: what is seen of it where nothing can move.

use crate::scene::{Body, Places};
use crate::svg::{escape, tenth};

/// Height of the strip, pixels.
const HEIGHT: f64 = 132.0;
/// Metres that this height shows.
const METRES: f64 = 2.1;
/// Pixels between postures.
const PITCH: f64 = 76.0;

/// Postures of a body at some rows of its places, side by side from left to right, in colour: seen from ahead and a
/// little from its left. Rows that are not there and missing points draw nothing.
pub fn strip(title: &str, body: &Body, places: &Places, rows: &[usize], colour: &str) -> String {
    let all = places.unpack();
    let width = PITCH * rows.len().max(1) as f64;
    let title = escape(title);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"strip\" role=\"img\" aria-label=\"{title}\" width=\"{0}\" \
         height=\"{HEIGHT}\" viewBox=\"0 0 {0} {HEIGHT}\">\n<g stroke=\"{colour}\" stroke-linecap=\"round\">\n",
        tenth(width)
    );
    let scale = HEIGHT / METRES;
    for (i, row) in rows.iter().filter_map(|&r| all.get(r)).enumerate() {
        let Some(centre) = row.get(body.centre).copied().flatten() else {
            continue;
        };
        let ground = row
            .iter()
            .flatten()
            .fold(f64::INFINITY, |low, p| low.min(p[2]));
        // Farther ones first, so that nearer ones cover them.
        let mut bones: Vec<(f64, [[f64; 2]; 2], f64)> = Vec::with_capacity(body.bones.len());
        for bone in &body.bones {
            let [Some(a), Some(b)] = bone.ends.map(|e| row.get(e).copied().flatten()) else {
                continue;
            };
            let seen = [a, b].map(|p| {
                let [right, up, _] = seen(p, centre);
                let x = PITCH * (i as f64 + 0.5) + scale * right;
                [x, HEIGHT - 8.0 - scale * (up - ground)]
            });
            let depth = 0.5 * (seen_depth(a, centre) + seen_depth(b, centre));
            bones.push((depth, seen, scale * (bone.radii[0] + bone.radii[1])));
        }
        bones.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, [a, b], thick) in bones {
            let [ax, ay, bx, by] = [a[0], a[1], b[0], b[1]].map(tenth);
            let thick = thick.max(1.5);
            // A rim in the colour of the paper tells near limbs from those behind them.
            for (stroke, width) in [(" stroke=\"var(--paper,#fff)\"", thick + 1.6), ("", thick)] {
                let width = tenth(width);
                svg.push_str(&format!(
                    "<path d=\"M{ax} {ay}L{bx} {by}\"{stroke} stroke-width=\"{width}\"/>\n"
                ));
            }
        }
    }
    svg.push_str("</g>\n</svg>\n");
    svg
}

/// A place as seen: rightward, upward, nearer; the eye stands ahead of the body, a third to its left.
fn seen(p: [f64; 3], centre: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = 0.6_f64.sin_cos();
    let (x, y) = (p[0] - centre[0], p[1] - centre[1]);
    [y * cos - x * sin, p[2], x * cos + y * sin]
}

fn seen_depth(p: [f64; 3], centre: [f64; 3]) -> f64 {
    seen(p, centre)[2]
}
