//! Trajectory encoding: what was seen, what was predicted from each decision on, what was encoded: Figure 7.

use super::plot::Plot;
use crate::axis::extent;
use crate::palette::{colour, text_on};
use crate::svg::{Anchor, HEAD, LABEL, MARGIN, SMALL, Svg, Type, fitted, nothing, text_width};

/// One decision.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EncodedDecision {
    /// From, seconds.
    pub start: f64,
    /// To, seconds.
    pub end: f64,
    /// The primitive that took it, an index.
    pub winner: usize,
    /// The likeness of each primitive's prediction, in [0, 1].
    pub similarities: Vec<f64>,
    /// Time and height of the hand as each primitive predicts it over the horizon.
    pub predicted: Vec<Vec<[f64; 2]>>,
    /// The same in the view: left and up.
    pub predicted_view: Vec<Vec<[f64; 2]>>,
}

/// An observed movement and its encoding.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EncodedPaths {
    /// The figure's title.
    pub title: String,
    /// One line under it.
    pub subtitle: String,
    /// Names of the primitives.
    pub names: Vec<String>,
    /// What is drawn over time, with its unit.
    pub over_time: String,
    /// Names of the view's axes.
    pub view_axes: [String; 2],
    /// Time and value as observed.
    pub observed: Vec<[f64; 2]>,
    /// The same as encoded.
    pub encoded: Vec<[f64; 2]>,
    /// The observed path in the view.
    pub observed_view: Vec<[f64; 2]>,
    /// The encoded one.
    pub encoded_view: Vec<[f64; 2]>,
    /// The decisions.
    pub decisions: Vec<EncodedDecision>,
    /// What was really done: from, to, primitive.
    pub truth: Vec<(f64, f64, usize)>,
    /// One line below.
    pub remark: String,
}

const WIDTH: f64 = 960.0;
const NAMES: f64 = 118.0;
const ROW: f64 = 24.0;
const OBSERVED: &str =
    "class=\"frame\" style=\"stroke-width:3.6\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
const ENCODED: &str =
    "class=\"right\" fill=\"none\" stroke-width=\"1.9\" stroke-linejoin=\"round\"";
const PREDICTED: &str =
    "fill=\"none\" stroke-width=\"1.1\" stroke-opacity=\"0.75\" stroke-dasharray=\"3 2\"";

/// The path over time with every primitive's prediction from each decision on, the same seen from the front, and under
/// them a row of bars a primitive: how like the prediction was, the winner's filled.
pub fn encoded_paths(figure: &EncodedPaths) -> String {
    let ends = figure.decisions.iter().flat_map(|d| [d.start, d.end]);
    let predicted = || {
        figure
            .decisions
            .iter()
            .flat_map(|d| d.predicted.iter().flatten())
    };
    let lines = || {
        figure
            .observed
            .iter()
            .chain(&figure.encoded)
            .chain(predicted())
    };
    let (Some(time), Some(value)) = (extent(ends), extent(lines().map(|p| p[1]))) else {
        return nothing(&figure.title, "There is no decision to show.");
    };
    let mut svg = Svg::new(WIDTH, 0.0, &figure.title);
    svg.text(MARGIN, 46.0, Anchor::Start, SMALL, &figure.subtitle);
    draw_key(&mut svg);
    let pad = 0.06 * (value[1] - value[0]);
    let left = MARGIN + NAMES;
    let plot = Plot::new(
        time,
        [value[0] - pad, value[1] + pad],
        [left, 88.0, WIDTH - 300.0, 308.0],
    );
    plot.draw(&mut svg, "", &figure.over_time, [8, 5]);
    draw_paths(&mut svg, figure, &plot);
    draw_view(&mut svg, figure);
    let bottom = draw_bars(&mut svg, figure, &plot, 326.0);
    svg.text(MARGIN, bottom + 14.0, Anchor::Start, SMALL, &figure.remark);
    svg.finish(Some(bottom + 28.0))
}

fn draw_key(svg: &mut Svg) {
    let mut x = MARGIN;
    let dashed = format!("stroke=\"{}\" {PREDICTED}", colour(1));
    for (look, name) in [
        (OBSERVED, "observed"),
        (ENCODED, "encoded"),
        (
            dashed.as_str(),
            "predicted by each primitive from each decision on",
        ),
    ] {
        svg.polyline(look, &[[x, 66.0], [x + 26.0, 66.0]]);
        svg.text(x + 32.0, 70.0, Anchor::Start, LABEL, name);
        x += 60.0 + text_width(name, LABEL.size) * 0.94;
    }
}

fn draw_paths(svg: &mut Svg, figure: &EncodedPaths, plot: &Plot) {
    let [_, top, _, bottom] = plot.edges;
    for decision in &figure.decisions {
        let x = plot.x.at(decision.start);
        svg.line("grid", [x, top], [x, bottom]);
    }
    svg.polyline(OBSERVED, &plot.curve(&figure.observed));
    let [_, _, right, _] = plot.edges;
    for decision in &figure.decisions {
        for (k, path) in decision.predicted.iter().enumerate() {
            let look = format!("stroke=\"{}\" {PREDICTED}", colour(k));
            let points = plot.curve(path);
            let inside: Vec<_> = points.into_iter().filter(|p| p[0] <= right + 0.1).collect();
            svg.polyline(&look, &inside);
        }
    }
    svg.polyline(ENCODED, &plot.curve(&figure.encoded));
    for decision in &figure.decisions {
        if let Some(state) = decision.predicted.first().and_then(|p| p.first()) {
            svg.disc("class=\"right-end\"", plot.at(*state), 2.8);
        }
    }
    plot.close(svg);
}

/// The same path as somebody opposite sees it.
fn draw_view(svg: &mut Svg, figure: &EncodedPaths) {
    let points = || figure.observed_view.iter().chain(&figure.encoded_view);
    let (Some(x), Some(y)) = (
        extent(points().map(|p| p[0])),
        extent(points().map(|p| p[1])),
    ) else {
        return;
    };
    let edges = [WIDTH - 218.0, 88.0, WIDTH - MARGIN, 308.0];
    // One scale along both axes.
    let metres = ((x[1] - x[0]) / (edges[2] - edges[0])).max((y[1] - y[0]) / (edges[3] - edges[1]));
    let around = |[low, high]: [f64; 2], pixels: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * 1.12 * metres * pixels);
        [middle - half, middle + half]
    };
    let plot = Plot::new(
        around(x, edges[2] - edges[0]),
        around(y, edges[3] - edges[1]),
        edges,
    );
    plot.draw(svg, &figure.view_axes[0], &figure.view_axes[1], [5, 6]);
    svg.polyline(OBSERVED, &plot.curve(&figure.observed_view));
    svg.polyline(ENCODED, &plot.curve(&figure.encoded_view));
    for decision in &figure.decisions {
        if let Some(state) = decision.predicted_view.first().and_then(|p| p.first()) {
            svg.disc("class=\"right-end\"", plot.at(*state), 2.8);
        }
    }
    plot.close(svg);
}

fn draw_bars(svg: &mut Svg, figure: &EncodedPaths, plot: &Plot, top: f64) -> f64 {
    let [left, _, right, _] = plot.edges;
    let rows = figure.names.len();
    let bottom = top + ROW * rows as f64;
    let head = Type {
        class: "soft",
        ..HEAD
    };
    svg.rectangle(
        "class=\"panel\"",
        [left, top],
        [right - left, bottom - top],
        "",
    );
    for (k, name) in figure.names.iter().enumerate() {
        let base = top + ROW * (k + 1) as f64;
        svg.line("grid", [left, base], [right, base]);
        let label = fitted(name, LABEL.size, NAMES - 8.0);
        svg.text(left - 8.0, base - 8.0, Anchor::End, LABEL, &label);
        for decision in &figure.decisions {
            let [a, b] = [decision.start, decision.end].map(|t| plot.x.at(t));
            let likeness = decision.similarities.get(k).copied().unwrap_or(0.0);
            let high = (ROW - 3.0) * likeness.clamp(0.0, 1.0);
            let own = colour(k);
            let look = match decision.winner == k {
                true => format!("fill=\"{own}\""),
                false => format!("fill=\"{own}\" fill-opacity=\"0.22\""),
            };
            let tooltip = format!("{name}, {:.2} s: likeness {likeness:.2}", decision.start);
            svg.rectangle(&look, [a + 0.8, base - high], [b - a - 1.6, high], &tooltip);
        }
    }
    svg.rectangle(
        "class=\"frame\"",
        [left, top],
        [right - left, bottom - top],
        "",
    );
    svg.text(
        right + 14.0,
        top + 54.0,
        Anchor::Start,
        head,
        "likeness of each",
    );
    svg.text(
        right + 14.0,
        top + 69.0,
        Anchor::Start,
        head,
        "primitive's prediction",
    );
    svg.text(
        right + 14.0,
        top + 88.0,
        Anchor::Start,
        SMALL,
        "full height = 1;",
    );
    svg.text(
        right + 14.0,
        top + 103.0,
        Anchor::Start,
        SMALL,
        "filled: takes the decision",
    );
    let mut y = bottom + 8.0;
    let taken: Vec<(f64, f64, usize)> = figure
        .decisions
        .iter()
        .map(|d| (d.start, d.end, d.winner))
        .collect();
    for (what, spans) in [
        ("encoded as", joined(&taken)),
        ("really done", figure.truth.clone()),
    ] {
        svg.text(left - 8.0, y + 13.0, Anchor::End, LABEL, what);
        for (start, end, k) in spans {
            let [a, b] = [start, end].map(|t| plot.x.at(t).min(right));
            let fill = format!("fill=\"{}\"", colour(k));
            svg.rectangle(&fill, [a + 0.5, y], [b - a - 1.0, 18.0], "");
            let name = figure.names.get(k).map_or("", String::as_str);
            let look = Type {
                class: if text_on(k) == "#000" {
                    "on-light"
                } else {
                    "on-dark"
                },
                ..LABEL
            };
            if text_width(name, LABEL.size) * 0.9 < b - a - 4.0 {
                svg.text(0.5 * (a + b), y + 13.0, Anchor::Middle, look, name);
            }
        }
        y += 24.0;
    }
    for (value, label) in plot.x.ticks(8) {
        svg.text(plot.x.at(value), y + 10.0, Anchor::Middle, SMALL, &label);
    }
    svg.text(
        0.5 * (left + right),
        y + 27.0,
        Anchor::Middle,
        LABEL,
        "time (s)",
    );
    y + 38.0
}

/// Decisions of one primitive that follow one another, as one.
fn joined(spans: &[(f64, f64, usize)]) -> Vec<(f64, f64, usize)> {
    let mut all: Vec<(f64, f64, usize)> = Vec::new();
    for &(start, end, k) in spans {
        match all.last_mut() {
            Some(last) if last.2 == k => last.1 = end,
            _ => all.push((start, end, k)),
        }
    }
    all
}
