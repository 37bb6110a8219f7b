//! A primitive's flowfield in the plane of its first principal coordinates: Figure 2.

use super::plot::Plot;
use crate::axis::extent;
use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, Type, nothing, tenth};

/// An arrow of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// Where it stands.
    pub from: [f64; 2],
    /// Where the field leads in a short while.
    pub to: [f64; 2],
    /// The phase there, in [0, 1].
    pub phase: f64,
}

/// A posture as a figure of sticks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stick {
    /// Where in the field it is.
    pub at: [f64; 2],
    /// Its phase.
    pub phase: f64,
    /// The exemplar that it is of, an index.
    pub exemplar: usize,
    /// The bones, as seen from the front, metres, y up; those that move most last.
    pub bones: Vec<[[f64; 2]; 2]>,
    /// How many of the last bones move.
    pub moving: usize,
}

/// A flowfield.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Flow {
    /// The figure's title.
    pub title: String,
    /// One line under it.
    pub subtitle: String,
    /// Names of the axes.
    pub axes: [String; 2],
    /// The field.
    pub arrows: Vec<Arrow>,
    /// The exemplars' ways: place and phase.
    pub exemplars: Vec<Vec<([f64; 2], f64)>>,
    /// Selected postures; those of an even place in the list stand above the field, the others below it, in the order in which they stand from the
    /// left.
    pub above: Vec<Stick>,
    /// The postures below.
    pub below: Vec<Stick>,
}

const WIDTH: f64 = 880.0;
const STICK: f64 = 126.0;

/// The colour of a phase: from dark to light, so that print and every colour vision keep the order (the ramp is
/// viridis, of Smith and van der Walt 2015, without its ends).
pub fn phase_colour(phase: f64) -> String {
    const STOPS: [[f64; 3]; 5] = [
        [72.0, 40.0, 120.0],
        [59.0, 82.0, 139.0],
        [33.0, 145.0, 140.0],
        [74.0, 193.0, 109.0],
        [160.0, 205.0, 40.0],
    ];
    let at = phase.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let k = (at.floor() as usize).min(STOPS.len() - 2);
    let level = |c: usize| {
        let value = STOPS[k][c] + (at - k as f64) * (STOPS[k + 1][c] - STOPS[k][c]);
        value.round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", level(0), level(1), level(2))
}

/// The field as arrows coloured by phase, exemplars bold, selected postures joined to their places.
pub fn flow(figure: &Flow) -> String {
    let points = || {
        let arrows = figure.arrows.iter().flat_map(|a| [a.from, a.to]);
        arrows.chain(figure.exemplars.iter().flatten().map(|(p, _)| *p))
    };
    let ranges = [0, 1].map(|c| extent(points().map(|p| p[c])));
    let [Some(x), Some(y)] = ranges else {
        return nothing(&figure.title, "There is no field to show.");
    };
    let padded = |[low, high]: [f64; 2], share: f64| {
        let pad = share * (high - low).max(1e-6);
        [low - pad, high + pad]
    };
    let mut svg = Svg::new(WIDTH, 0.0, &figure.title);
    svg.text(MARGIN, 46.0, Anchor::Start, SMALL, &figure.subtitle);
    draw_ramp(&mut svg);
    let top = 90.0 + if figure.above.is_empty() { 0.0 } else { STICK };
    let plot = Plot::new(
        padded(x, 0.04),
        padded(y, 0.06),
        [MARGIN + 52.0, top, WIDTH - MARGIN, top + 380.0],
    );
    plot.draw(&mut svg, &figure.axes[0], &figure.axes[1], [8, 6]);
    for arrow in &figure.arrows {
        draw_arrow(&mut svg, &plot, arrow);
    }
    for exemplar in &figure.exemplars {
        draw_exemplar(&mut svg, &plot, exemplar);
    }
    plot.close(&mut svg);
    let [_, _, _, bottom] = plot.edges;
    draw_sticks(&mut svg, &plot, &figure.above, top - STICK - 4.0, true);
    let under = bottom + 44.0;
    draw_sticks(&mut svg, &plot, &figure.below, under, false);
    let room = if figure.below.is_empty() {
        0.0
    } else {
        STICK + 8.0
    };
    svg.finish(Some(under + room))
}

fn draw_ramp(svg: &mut Svg) {
    let (left, y) = (MARGIN, 60.0);
    svg.text(left, y + 10.0, Anchor::Start, LABEL, "phase \u{3c4}  0");
    let start = left + 62.0;
    for k in 0..40 {
        let fill = format!("fill=\"{}\"", phase_colour(f64::from(k) / 39.0));
        svg.rectangle(&fill, [start + 4.0 * f64::from(k), y], [4.4, 11.0], "");
    }
    svg.text(start + 168.0, y + 10.0, Anchor::Start, LABEL, "1");
    let (x, y) = (start + 206.0, y + 5.5);
    svg.polyline(
        "class=\"right\" fill=\"none\" stroke-width=\"3.4\"",
        &[[x, y], [x + 24.0, y]],
    );
    svg.text(x + 30.0, y + 4.5, Anchor::Start, LABEL, "exemplars");
    svg.polyline(
        "class=\"chain\" stroke-dasharray=\"2 3\"",
        &[[x + 110.0, y], [x + 134.0, y]],
    );
    svg.text(
        x + 140.0,
        y + 4.5,
        Anchor::Start,
        LABEL,
        "postures of two of them",
    );
}

fn draw_arrow(svg: &mut Svg, plot: &Plot, arrow: &Arrow) {
    let (a, b) = (plot.at(arrow.from), plot.at(arrow.to));
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx.hypot(dy);
    let colour = phase_colour(arrow.phase);
    if length < 1.5 {
        svg.disc(&format!("fill=\"{colour}\""), a, 1.2);
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let head = (0.45 * length).min(5.0);
    let base = [b[0] - head * ux, b[1] - head * uy];
    let side = |s: f64| [base[0] - s * 0.5 * head * uy, base[1] + s * 0.5 * head * ux];
    let [l, r] = [side(1.0), side(-1.0)];
    let data = format!(
        "M{} {}L{} {}M{} {}L{} {}L{} {}Z",
        tenth(a[0]),
        tenth(a[1]),
        tenth(base[0]),
        tenth(base[1]),
        tenth(l[0]),
        tenth(l[1]),
        tenth(b[0]),
        tenth(b[1]),
        tenth(r[0]),
        tenth(r[1]),
    );
    let look = format!("fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"1.1\"");
    svg.path(&look, &data);
}

/// Bold, over a core of the phases' colours.
fn draw_exemplar(svg: &mut Svg, plot: &Plot, way: &[([f64; 2], f64)]) {
    let points: Vec<[f64; 2]> = way.iter().map(|(p, _)| plot.at(*p)).collect();
    let bold = "class=\"right\" fill=\"none\" stroke-width=\"3.4\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
    svg.polyline(bold, &points);
    for (pair, (_, phase)) in points.windows(2).zip(way) {
        let core = format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"1.1\"",
            phase_colour(*phase)
        );
        svg.polyline(&core, pair);
    }
}

fn draw_sticks(svg: &mut Svg, plot: &Plot, sticks: &[Stick], top: f64, above: bool) {
    let [left, _, right, _] = plot.edges;
    let points = || sticks.iter().flat_map(|s| s.bones.iter().flatten());
    let (Some(x), Some(y)) = (
        extent(points().map(|p| p[0])),
        extent(points().map(|p| p[1])),
    ) else {
        return;
    };
    let slot = (right - left) / sticks.len() as f64;
    let tall = STICK - 26.0;
    let scale = (tall / (y[1] - y[0]).max(1e-6)).min((slot - 8.0) / (x[1] - x[0]).max(1e-6));
    for (k, stick) in sticks.iter().enumerate() {
        let middle = left + (k as f64 + 0.5) * slot;
        let foot = if above {
            top + tall
        } else {
            top + STICK - 10.0
        };
        let place = |p: &[f64; 2]| {
            let across = p[0] - 0.5 * (x[0] + x[1]);
            [middle + scale * across, foot - scale * (p[1] - y[0])]
        };
        // Joined at the edge that faces the field.
        let end = if above {
            [middle, foot + 4.0]
        } else {
            [middle, top + 8.0]
        };
        let target = plot.at(stick.at);
        svg.polyline("class=\"chain\" stroke-dasharray=\"2 3\"", &[end, target]);
        let colour = phase_colour(stick.phase);
        let dot = format!("fill=\"{colour}\" class=\"frame\" style=\"fill:{colour}\"");
        svg.disc(&dot, target, 5.0);
        let still = stick.bones.len().saturating_sub(stick.moving);
        let round = "fill=\"none\" stroke-linecap=\"round\"";
        svg.open(
            &format!("class=\"axis\" {round} style=\"stroke-width:2.2\""),
            "",
        );
        for bone in &stick.bones[..still] {
            svg.polyline("", &bone.each_ref().map(place));
        }
        svg.close();
        svg.open(
            &format!("class=\"right\" {round} style=\"stroke-width:3.4\""),
            "",
        );
        for bone in &stick.bones[still..] {
            svg.polyline("", &bone.each_ref().map(place));
        }
        svg.close();
        let label = format!("\u{3c4} = {:.2}", stick.phase);
        let look = Type {
            class: "ink",
            ..SMALL
        };
        let beside = middle + 0.5 * scale * (x[1] - x[0]) + 2.0;
        svg.text(
            beside.min(right - 40.0),
            foot - 4.0,
            Anchor::Start,
            look,
            &label,
        );
    }
}
