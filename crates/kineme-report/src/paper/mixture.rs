//! What a joint does over all parameters, and when it can assume a value: Figures 4 and 5.

use super::plot::{Entry, GREEN, Plot, field_swatch, legend, line_swatch, outline, signed};
use crate::axis::extent;
use crate::svg::{Anchor, HEAD, MARGIN, SMALL, Svg, Type, nothing};

/// A patch of a plane whose first axis is phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// From and to in phase.
    pub phase: [f64; 2],
    /// From and to along the other axis.
    pub across: [f64; 2],
    /// How much of it is meant, in [0, 1].
    pub share: f64,
}

/// A set in the plane of phase and one parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParameterSet {
    /// The parameter's name, and what the shares are of.
    pub name: String,
    /// Its patches.
    pub cells: Vec<Cell>,
}

/// The mixture space of a joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mixture {
    /// The figure's title.
    pub title: String,
    /// One line under it.
    pub subtitle: String,
    /// The joint's name with its unit, at the axis.
    pub joint: String,
    /// Phase, least and greatest value over all parameters; rising in phase.
    pub envelope: Vec<[f64; 3]>,
    /// Phase and value of each exemplar.
    pub exemplars: Vec<Vec<[f64; 2]>>,
    /// The value that was observed and its tolerance.
    pub level: Option<[f64; 2]>,
    /// Intervals of phase found by the paper's search.
    pub intervals: Vec<[f64; 2]>,
    /// The exact set in this plane: patches of phase and value.
    pub exact: Vec<Cell>,
    /// The exact set in the plane of phase and a parameter, drawn below.
    pub parameters: Option<ParameterSet>,
}

const WIDTH: f64 = 820.0;
const LEFT: f64 = MARGIN + 52.0;
const RIGHT: f64 = WIDTH - MARGIN;

/// The region that a joint's angle sweeps as parameters vary, against phase, with the exemplars as lines; over it, as
/// far as they are given, the level that was observed, the phases at which the joint can assume it, and the exact set.
pub fn mixture(figure: &Mixture) -> String {
    let values = figure.envelope.iter().flat_map(|e| [e[1], e[2]]);
    let values = values.chain(figure.exemplars.iter().flatten().map(|p| p[1]));
    let Some(range) = extent(values) else {
        return nothing(&figure.title, "There is no joint to show.");
    };
    let pad = 0.06 * (range[1] - range[0]);
    let tall = if figure.parameters.is_some() {
        300.0
    } else {
        360.0
    };
    let top = 92.0;
    let mut svg = Svg::new(WIDTH, 0.0, &figure.title);
    svg.text(MARGIN, 46.0, Anchor::Start, SMALL, &figure.subtitle);
    draw_legend(&mut svg, figure);
    let plot = Plot::new(
        [0.0, 1.0],
        [range[0] - pad, range[1] + pad],
        [LEFT, top, RIGHT, top + tall],
    );
    plot.draw(&mut svg, "phase \u{3c4}", &figure.joint, [10, 6]);
    draw_space(&mut svg, &plot, figure);
    plot.close(&mut svg);
    let mut bottom = top + tall + 44.0;
    if let Some(set) = &figure.parameters {
        bottom = draw_parameters(&mut svg, figure, set, bottom + 26.0);
    }
    svg.finish(Some(bottom))
}

fn draw_legend(svg: &mut Svg, figure: &Mixture) {
    let field = field_swatch("class=\"heat\" fill-opacity=\"0.24\"");
    let exemplar = line_swatch("class=\"right\" fill=\"none\" stroke-width=\"1.6\"");
    let level = line_swatch("class=\"accent-line\" stroke-width=\"1.8\" stroke-dasharray=\"6 4\"");
    let interval = field_swatch("class=\"accent\" fill-opacity=\"0.22\"");
    let exact = field_swatch("fill=\"#009e73\" fill-opacity=\"0.65\"");
    let mut entries: Vec<Entry> = vec![(&field, "swept by p"), (&exemplar, "exemplars")];
    if figure.level.is_some() {
        entries.push((&level, "observed value"));
    }
    if !figure.intervals.is_empty() {
        entries.push((&interval, "\u{3c4} found by the paper's search"));
    }
    if !figure.exact.is_empty() || figure.parameters.is_some() {
        entries.push((&exact, "exact set"));
    }
    legend(svg, [MARGIN, 70.0], &entries);
}

fn draw_space(svg: &mut Svg, plot: &Plot, figure: &Mixture) {
    let [_, top, _, bottom] = plot.edges;
    for [from, to] in &figure.intervals {
        let (a, b) = (plot.x.at(*from), plot.x.at(*to));
        let field = "class=\"accent\" fill-opacity=\"0.14\"";
        svg.rectangle(field, [a, top], [b - a, bottom - top], "");
    }
    let low = figure.envelope.iter().map(|e| plot.at([e[0], e[1]]));
    let high = figure.envelope.iter().rev().map(|e| plot.at([e[0], e[2]]));
    let swept: Vec<[f64; 2]> = low.chain(high).collect();
    let area = outline(&swept);
    svg.path("class=\"heat\" fill-opacity=\"0.24\"", &area);
    svg.open(&format!("fill=\"{GREEN}\" fill-opacity=\"0.6\""), "");
    for cell in &figure.exact {
        let [a, b] = cell.phase.map(|t| plot.x.at(t));
        let [low, high] = cell.across.map(|v| plot.y.at(v));
        svg.rectangle("", [a, high], [b - a, low - high], "");
    }
    svg.close();
    svg.open("class=\"right\" fill=\"none\" stroke-width=\"1.5\"", "");
    for exemplar in &figure.exemplars {
        svg.polyline("", &plot.curve(exemplar));
    }
    svg.close();
    if let Some([value, tolerance]) = figure.level {
        draw_level(svg, plot, figure, value, tolerance);
    }
    draw_ends(svg, plot, figure);
}

fn draw_level(svg: &mut Svg, plot: &Plot, figure: &Mixture, value: f64, tolerance: f64) {
    let [left, _, right, _] = plot.edges;
    let (high, low) = (plot.y.at(value + tolerance), plot.y.at(value - tolerance));
    let band = "class=\"accent\" fill-opacity=\"0.16\"";
    svg.rectangle(band, [left, high], [right - left, low - high], "");
    let y = plot.y.at(value);
    let dashed = "class=\"accent-line\" stroke-width=\"1.8\" stroke-dasharray=\"6 4\"";
    svg.polyline(dashed, &[[left, y], [right, y]]);
    let label = signed(&format!("{value:.2} \u{b1} {tolerance:.2} rad"));
    // Where no interval is: at the beginning, as far as the movement allows.
    let first = figure.intervals.first().map_or(0.0, |i| i[0]);
    let (x, anchor) = match first > 0.3 {
        true => (left + 8.0, Anchor::Start),
        false => (right - 8.0, Anchor::End),
    };
    let look = Type {
        class: "ink halo",
        ..HEAD
    };
    svg.text(x, high - 6.0, anchor, look, &label);
}

/// Lines and numbers at the ends of the intervals.
fn draw_ends(svg: &mut Svg, plot: &Plot, figure: &Mixture) {
    let [_, top, right, bottom] = plot.edges;
    let look = Type {
        class: "ink halo",
        ..HEAD
    };
    for &[from, to] in &figure.intervals {
        for (end, anchor, dx) in [(from, Anchor::End, -5.0), (to, Anchor::Start, 5.0)] {
            let x = plot.x.at(end);
            if end > 0.0 && end < 1.0 {
                let line = "class=\"accent-line\" stroke-width=\"1.4\"";
                svg.polyline(line, &[[x, top], [x, bottom]]);
            }
            let inside = (x + 60.0 > right && dx > 0.0) || (x - 60.0 < plot.edges[0] && dx < 0.0);
            let (anchor, dx) = match (inside, anchor) {
                (true, Anchor::End) => (Anchor::Start, 5.0),
                (true, _) => (Anchor::End, -5.0),
                (false, anchor) => (anchor, dx),
            };
            let label = format!("\u{3c4} = {end:.2}");
            svg.text(x + dx, top + 16.0, anchor, look, &label);
        }
    }
}

/// The exact set over phase and a parameter, under the same axis of phase; returns the bottom.
fn draw_parameters(svg: &mut Svg, figure: &Mixture, set: &ParameterSet, top: f64) -> f64 {
    let head = "What a joint at that value says exactly: not a \u{3c4}, but pairs (p, \u{3c4})";
    svg.text(MARGIN, top - 10.0, Anchor::Start, HEAD, head);
    let plot = Plot::new(
        [0.0, 1.0],
        [0.0, 1.0],
        [LEFT, top + 4.0, RIGHT, top + 174.0],
    );
    plot.draw(svg, "phase \u{3c4}", &set.name, [10, 5]);
    let [_, top, _, bottom] = plot.edges;
    for &[from, to] in &figure.intervals {
        let (a, b) = (plot.x.at(from), plot.x.at(to));
        let field = "class=\"accent\" fill-opacity=\"0.14\"";
        svg.rectangle(field, [a, top], [b - a, bottom - top], "");
        for x in [a, b] {
            let line = "class=\"accent-line\" stroke-width=\"1.4\"";
            svg.polyline(line, &[[x, top], [x, bottom]]);
        }
    }
    for cell in set.cells.iter().filter(|c| c.share > 0.0) {
        let [a, b] = cell.phase.map(|t| plot.x.at(t));
        let [low, high] = cell.across.map(|p| plot.y.at(p));
        let fill = format!("fill=\"{GREEN}\" fill-opacity=\"{:.2}\"", 0.9 * cell.share);
        svg.rectangle(&fill, [a, high], [b - a, low - high], "");
    }
    plot.close(svg);
    bottom + 44.0
}
