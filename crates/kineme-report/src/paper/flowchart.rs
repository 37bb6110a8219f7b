//! Who does what in a program, as boxes and arrows: Figure 3.

use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, TITLE, Type, nothing, tenth};

/// What a box is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kind {
    /// It computes.
    #[default]
    Module,
    /// It is handed on.
    Data,
    /// It lies outside.
    World,
}

/// A box.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Node {
    /// What it is called.
    pub name: String,
    /// Where in the code it is.
    pub module: String,
    /// What it does, a line each.
    pub lines: Vec<String>,
    /// What it is.
    pub kind: Kind,
    /// Left, top, width and height, pixels.
    pub place: [f64; 4],
    /// How many of it lie behind one another.
    pub copies: usize,
}

/// An arrow along corners.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Edge {
    /// The corners, pixels; it points to the last.
    pub corners: Vec<[f64; 2]>,
    /// What goes along it.
    pub label: String,
    /// Where the label's middle is.
    pub label_at: [f64; 2],
    /// Whether it is not always there: dashed.
    pub optional: bool,
}

/// A chart.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Flowchart {
    /// The figure's title.
    pub title: String,
    /// One line under it.
    pub subtitle: String,
    /// Width and height, pixels.
    pub size: [f64; 2],
    /// Its boxes.
    pub nodes: Vec<Node>,
    /// Its arrows.
    pub edges: Vec<Edge>,
}

/// Boxes and arrows.
pub fn flowchart(chart: &Flowchart) -> String {
    if chart.nodes.is_empty() {
        return nothing(&chart.title, "There is nothing to show.");
    }
    let [width, height] = chart.size;
    let mut svg = Svg::new(width, height, &chart.title);
    svg.text(MARGIN, 46.0, Anchor::Start, SMALL, &chart.subtitle);
    for edge in &chart.edges {
        draw_edge(&mut svg, edge);
    }
    for node in &chart.nodes {
        draw_node(&mut svg, node);
    }
    // Over lines and boxes, so that none crosses a word.
    for edge in &chart.edges {
        let look = Type {
            class: "soft halo",
            ..LABEL
        };
        for (k, line) in edge.label.split('\n').enumerate() {
            let [x, y] = edge.label_at;
            svg.text(x, y + 14.0 * k as f64, Anchor::Middle, look, line);
        }
    }
    svg.finish(None)
}

fn draw_edge(svg: &mut Svg, edge: &Edge) {
    let (Some(&end), Some(&before)) = (
        edge.corners.last(),
        edge.corners.len().checked_sub(2).map(|k| &edge.corners[k]),
    ) else {
        return;
    };
    let (dx, dy) = (end[0] - before[0], end[1] - before[1]);
    let length = dx.hypot(dy).max(1e-6);
    let (ux, uy) = (dx / length, dy / length);
    let base = [end[0] - 9.0 * ux, end[1] - 9.0 * uy];
    let mut corners = edge.corners.clone();
    if let Some(last) = corners.last_mut() {
        *last = base;
    }
    let dash = if edge.optional {
        "stroke-dasharray=\"5 4\""
    } else {
        ""
    };
    let line =
        format!("class=\"axis\" {dash} style=\"stroke-width:1.6\" stroke-linejoin=\"round\"");
    svg.polyline(&line, &corners);
    let side = |s: f64| [base[0] - s * 4.5 * uy, base[1] + s * 4.5 * ux];
    let [l, r] = [side(1.0), side(-1.0)];
    let head = format!(
        "M{} {}L{} {}L{} {}Z",
        tenth(l[0]),
        tenth(l[1]),
        tenth(end[0]),
        tenth(end[1]),
        tenth(r[0]),
        tenth(r[1])
    );
    svg.path("class=\"soft\"", &head);
}

fn draw_node(svg: &mut Svg, node: &Node) {
    let [x, y, w, h] = node.place;
    let (fill, rx) = match node.kind {
        Kind::Module => ("fill=\"#0072b2\" fill-opacity=\"0.16\"", 6.0),
        Kind::Data => ("class=\"panel\"", 22.0),
        Kind::World => ("fill=\"#e69f00\" fill-opacity=\"0.2\"", 6.0),
    };
    for k in (0..node.copies.max(1)).rev() {
        let off = 6.0 * k as f64;
        let place = [x + off, y - off];
        svg.rectangle(&format!("class=\"paper\" rx=\"{rx}\""), place, [w, h], "");
        svg.rectangle(&format!("{fill} rx=\"{rx}\""), place, [w, h], "");
        let edge = format!("class=\"frame\" style=\"stroke-width:1.4\" rx=\"{rx}\"");
        svg.rectangle(&edge, place, [w, h], "");
    }
    let middle = x + 0.5 * w;
    let name = Type {
        size: 13.0,
        ..TITLE
    };
    let lines = node.lines.len() as f64 * 15.0 + if node.module.is_empty() { 0.0 } else { 15.0 };
    let mut at = y + 0.5 * (h - lines - 13.0) + 12.0;
    svg.text(middle, at, Anchor::Middle, name, &node.name);
    if !node.module.is_empty() {
        at += 15.0;
        svg.text(middle, at, Anchor::Middle, SMALL, &node.module);
    }
    for line in &node.lines {
        at += 15.0;
        svg.text(middle, at, Anchor::Middle, LABEL, line);
    }
}
