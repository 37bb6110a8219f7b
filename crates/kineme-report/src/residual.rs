//! How much of the geodesic distances each dimension explains.

use crate::axis::Scale;
use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, Type, nothing};

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 300.0;

/// Residual variance (1 - r^2 between geodesic and embedded distances; Tenenbaum, de Silva and Langford 2000, figure 2)
/// against the dimension, 1 for the first value; the `chosen` dimension is ringed.
pub fn residual_variance(values: &[f64], chosen: usize) -> String {
    const TITLE: &str = "Residual variance by dimension";
    if !values.iter().any(|v| v.is_finite()) {
        return nothing(TITLE, "There is no residual variance to show.");
    }
    let mut svg = Svg::new(WIDTH, HEIGHT, TITLE);
    let (left, right, top, bottom) = (MARGIN + 40.0, WIDTH - MARGIN, 46.0, HEIGHT - 46.0);
    let most = values
        .iter()
        .copied()
        .filter(|v| v.is_finite())
        .fold(0.0, f64::max);
    let x = Scale::new([0.5, values.len() as f64 + 0.5], [left, right]);
    let y = Scale::new(
        [0.0, if most > 0.0 { 1.08 * most } else { 1.0 }],
        [bottom, top],
    );
    svg.rectangle(
        "class=\"panel\"",
        [left, top],
        [right - left, bottom - top],
        "",
    );
    for (value, label) in y.ticks(5) {
        svg.line("grid", [left, y.at(value)], [right, y.at(value)]);
        svg.text(left - 6.0, y.at(value) + 4.0, Anchor::End, SMALL, &label);
    }
    let stride = values.len().div_ceil(14).max(1);
    for dimension in (1..=values.len()).step_by(stride) {
        let label = dimension.to_string();
        svg.text(
            x.at(dimension as f64),
            bottom + 16.0,
            Anchor::Middle,
            SMALL,
            &label,
        );
    }
    svg.text(
        0.5 * (left + right),
        HEIGHT - 12.0,
        Anchor::Middle,
        LABEL,
        "dimension",
    );
    let (middle, edge) = (0.5 * (top + bottom), MARGIN - 2.0);
    svg.text_turned(
        edge,
        middle,
        Anchor::Middle,
        LABEL,
        -90.0,
        "residual variance",
    );
    let points: Vec<(usize, [f64; 2])> = values
        .iter()
        .enumerate()
        .filter(|(_, v)| v.is_finite())
        .map(|(i, v)| (i + 1, [x.at(i as f64 + 1.0), y.at(*v)]))
        .collect();
    let line: Vec<[f64; 2]> = points.iter().map(|(_, point)| *point).collect();
    svg.polyline("class=\"right\" fill=\"none\" stroke-width=\"1.6\"", &line);
    for &(dimension, point) in &points {
        svg.disc("class=\"right-end\"", point, 3.2);
        if dimension == chosen {
            svg.disc("class=\"accent-line\" stroke-width=\"2\"", point, 8.0);
            let look = Type {
                class: "ink halo",
                bold: true,
                ..LABEL
            };
            let note = format!("chosen: {chosen} ({:.3})", values[dimension - 1]);
            let on_right = point[0] > 0.6 * right;
            let (dx, anchor) = if on_right {
                (6.0, Anchor::End)
            } else {
                (6.0, Anchor::Start)
            };
            svg.text(point[0] + dx, point[1] - 14.0, anchor, look, &note);
        }
    }
    svg.finish(None)
}
