//! A rectangle with two axes, and what figures of the paper share.

use crate::axis::Scale;
use crate::svg::{Anchor, LABEL, SMALL, Svg, tenth};

/// What is exact, in every figure.
pub const GREEN: &str = "#009e73";

/// Axes of data over a rectangle of pixels.
pub struct Plot {
    pub x: Scale,
    pub y: Scale,
    /// Left, top, right, bottom.
    pub edges: [f64; 4],
}

impl Plot {
    /// Ranges of data over left, top, right and bottom.
    pub fn new(x: [f64; 2], y: [f64; 2], edges: [f64; 4]) -> Self {
        let [left, top, right, bottom] = edges;
        Self {
            x: Scale::new(x, [left, right]),
            y: Scale::new(y, [bottom, top]),
            edges,
        }
    }

    /// The pixel of a point.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// The pixels of points.
    pub fn curve(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        points.iter().map(|p| self.at(*p)).collect()
    }

    /// Ground, grid, numbers and names of the axes; an empty name leaves the numbers of its axis out, too.
    pub fn draw(&self, svg: &mut Svg, x_name: &str, y_name: &str, ticks: [usize; 2]) {
        let [left, top, right, bottom] = self.edges;
        svg.rectangle(
            "class=\"panel\"",
            [left, top],
            [right - left, bottom - top],
            "",
        );
        for (value, label) in self.x.ticks(ticks[0]) {
            let x = self.x.at(value);
            svg.line("grid", [x, top], [x, bottom]);
            if !x_name.is_empty() {
                svg.text(x, bottom + 15.0, Anchor::Middle, SMALL, &signed(&label));
            }
        }
        for (value, label) in self.y.ticks(ticks[1]) {
            let y = self.y.at(value);
            svg.line("grid", [left, y], [right, y]);
            if !y_name.is_empty() {
                svg.text(left - 6.0, y + 4.0, Anchor::End, SMALL, &signed(&label));
            }
        }
        let (across, down) = (0.5 * (left + right), 0.5 * (top + bottom));
        svg.text(across, bottom + 33.0, Anchor::Middle, LABEL, x_name);
        svg.text_turned(left - 44.0, down, Anchor::Middle, LABEL, -90.0, y_name);
    }

    /// The frame, last of all, over whatever lies on the edge.
    pub fn close(&self, svg: &mut Svg) {
        let [left, top, right, bottom] = self.edges;
        svg.rectangle(
            "class=\"frame\"",
            [left, top],
            [right - left, bottom - top],
            "",
        );
    }
}

/// A number as it is read: with a true minus.
pub fn signed(number: &str) -> String {
    number.replacen('-', "\u{2212}", 1)
}

/// A closed outline as path data.
pub fn outline(points: &[[f64; 2]]) -> String {
    let mut data = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        data.push(if i == 0 { 'M' } else { 'L' });
        data.push_str(&format!("{} {}", tenth(*x), tenth(*y)));
    }
    data + "Z"
}

/// What a legend shows: how its mark is drawn at a point, and its words.
pub type Entry<'a> = (&'a dyn Fn(&mut Svg, [f64; 2]), &'a str);

/// Entries of a legend in one row: a swatch drawn at its left middle, and its name.
pub fn legend(svg: &mut Svg, [x, y]: [f64; 2], entries: &[Entry]) {
    let mut at = x;
    for (swatch, name) in entries {
        swatch(svg, [at, y]);
        svg.text(at + 28.0, y + 4.0, Anchor::Start, LABEL, name);
        at += 28.0 + crate::svg::text_width(name, LABEL.size) * 0.94 + 22.0;
    }
}

/// A swatch: a line of these attributes.
pub fn line_swatch(attributes: &'static str) -> impl Fn(&mut Svg, [f64; 2]) {
    move |svg, [x, y]| svg.polyline(attributes, &[[x, y], [x + 22.0, y]])
}

/// A swatch: a field of these attributes.
pub fn field_swatch(attributes: &'static str) -> impl Fn(&mut Svg, [f64; 2]) {
    move |svg, [x, y]| svg.rectangle(attributes, [x, y - 6.0], [22.0, 12.0], "")
}
