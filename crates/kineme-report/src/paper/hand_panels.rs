//! Hand paths of groups and of what is interpolated from them: Figure 1.

use crate::axis::{extent, round_step};
use crate::svg::{Anchor, HEAD, LABEL, MARGIN, SMALL, Svg, fitted, nothing, number, tenth};

/// One group.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HandPanel {
    /// What its movement is.
    pub title: String,
    /// Which group it is, and how large.
    pub facts: String,
    /// How well its segments hold together, a silhouette in [-1, 1].
    pub coherence: Option<f64>,
    /// Whether nobody meant it: framed as such.
    pub unintended: bool,
    /// Paths of the right hand in its segments: thorax frame, x forward, y left, z up, metres.
    pub right: Vec<Vec<[f64; 3]>>,
    /// The same for the left hand.
    pub left: Vec<Vec<[f64; 3]>>,
    /// Paths of the right hand in movements interpolated from them.
    pub right_interpolated: Vec<Vec<[f64; 3]>>,
    /// The same for the left hand.
    pub left_interpolated: Vec<Vec<[f64; 3]>>,
}

const WIDTH: f64 = 960.0;
const GAP: f64 = 18.0;
const PANEL: f64 = (WIDTH - 2.0 * MARGIN - GAP) / 2.0;
const HEADER: f64 = 48.0;
const DRAWING: f64 = 236.0;
const TITLE: &str = "Figure 1. Hand trajectories of four groups of segments";

/// Panels two in a row, each with its hands' paths from the front and from the person's right; all at one scale.
/// Segments are bold, interpolated movements thin and lighter; the right hand is dark, the left one orange.
pub fn hand_panels(panels: &[HandPanel]) -> String {
    let Some(frame) = Frame::around(panels) else {
        return nothing(TITLE, "There is no group with a hand path to show.");
    };
    let mut svg = Svg::new(WIDTH, 0.0, TITLE);
    draw_key(&mut svg);
    let height = HEADER + DRAWING + 14.0;
    for (k, panel) in panels.iter().enumerate() {
        let left = MARGIN + (k % 2) as f64 * (PANEL + GAP);
        let top = 66.0 + (k / 2) as f64 * (height + GAP);
        draw_panel(&mut svg, [left, top], height, panel, &frame);
    }
    let rows = panels.len().div_ceil(2) as f64;
    let bottom = 66.0 + rows * (height + GAP) + 6.0;
    let remark = "Seen in the frame of the thorax: + is its origin, midway between the shoulders; a dot is where a \
                  segment begins. Coherence is the mean silhouette of the group.";
    svg.text(MARGIN, bottom, Anchor::Start, SMALL, remark);
    svg.finish(Some(bottom + 16.0))
}

const BOLD: &str =
    "fill=\"none\" stroke-width=\"1.9\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
const THIN: &str =
    "fill=\"none\" stroke-width=\"0.9\" stroke-opacity=\"0.45\" stroke-dasharray=\"4 2\"";

fn draw_key(svg: &mut Svg) {
    let mut x = MARGIN;
    for (class, hand) in [("right", "right hand"), ("left", "left hand")] {
        for (look, what) in [(BOLD, ""), (THIN, ", interpolated")] {
            svg.polyline(
                &format!("class=\"{class}\" {look}"),
                &[[x, 46.0], [x + 24.0, 46.0]],
            );
            let name = format!("{hand}{what}");
            svg.text(x + 30.0, 50.0, Anchor::Start, LABEL, &name);
            x += 52.0 + crate::svg::text_width(&name, LABEL.size) * 0.94;
        }
    }
    let views = "left: from the front; right: from the person's right";
    svg.text(WIDTH - MARGIN, 50.0, Anchor::End, SMALL, views);
}

/// The one scale of all panels.
struct Frame {
    middle: [f64; 3],
    /// Pixels a metre.
    scale: f64,
    /// Width of the view from the front, pixels.
    front: f64,
}

impl Frame {
    fn around(panels: &[HandPanel]) -> Option<Self> {
        let points = || {
            let of = |p: &'_ HandPanel| {
                [
                    &p.right,
                    &p.left,
                    &p.right_interpolated,
                    &p.left_interpolated,
                ]
                .into_iter()
                .flatten()
                .flatten()
                .copied()
                .collect::<Vec<[f64; 3]>>()
            };
            panels.iter().flat_map(of)
        };
        let ranges = [0, 1, 2].map(|c| {
            let own = extent(points().map(|p| p[c]))?;
            extent(own.into_iter().chain([0.0]))
        });
        let [Some(x), Some(y), Some(z)] = ranges else {
            return None;
        };
        let size = |r: [f64; 2]| (r[1] - r[0]).max(0.05);
        let room = PANEL - 60.0;
        let scale = (room / (size(x) + size(y))).min((DRAWING - 16.0) / size(z));
        let spare = PANEL - scale * (size(x) + size(y));
        Some(Self {
            middle: [x, y, z].map(|[low, high]| 0.5 * (low + high)),
            scale,
            front: scale * size(y) + 0.5 * spare,
        })
    }

    /// From the front the person's left is at our right; from the person's right, forward is.
    fn pixel(&self, view: usize, [left, top]: [f64; 2], point: &[f64; 3]) -> [f64; 2] {
        let (across, middle) = match view {
            0 => (1, 0.5 * self.front),
            _ => (0, 0.5 * (PANEL + self.front)),
        };
        [
            left + middle + (point[across] - self.middle[across]) * self.scale,
            top + HEADER + 0.5 * DRAWING - (point[2] - self.middle[2]) * self.scale,
        ]
    }
}

fn draw_panel(svg: &mut Svg, corner: [f64; 2], height: f64, panel: &HandPanel, frame: &Frame) {
    let [left, top] = corner;
    svg.rectangle("class=\"panel\" rx=\"4\"", corner, [PANEL, height], "");
    if panel.unintended {
        let dashed = "class=\"accent-line\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\" rx=\"4\"";
        svg.rectangle(dashed, corner, [PANEL, height], "");
    }
    let mut title = panel.title.clone();
    if let Some(coherence) = panel.coherence.filter(|c| c.is_finite()) {
        let value = super::plot::signed(&format!("{coherence:.2}"));
        title.push_str(&format!(", coherence {value}"));
    }
    let title = fitted(&title, HEAD.size, PANEL - 24.0);
    svg.text(left + 12.0, top + 20.0, Anchor::Start, HEAD, &title);
    svg.text(left + 12.0, top + 36.0, Anchor::Start, SMALL, &panel.facts);
    let divide = left + frame.front;
    svg.line(
        "grid",
        [divide, top + HEADER],
        [divide, top + height - 12.0],
    );
    for view in 0..2 {
        let [x, y] = frame.pixel(view, corner, &[0.0; 3]);
        svg.line("axis", [x - 5.0, y], [x + 5.0, y]);
        svg.line("axis", [x, y - 5.0], [x, y + 5.0]);
        let hands = [
            ("left", THIN, &panel.left_interpolated),
            ("right", THIN, &panel.right_interpolated),
            ("left", BOLD, &panel.left),
            ("right", BOLD, &panel.right),
        ];
        for (class, look, paths) in hands {
            svg.open(&format!("class=\"{class}\" {look}"), "");
            for path in paths {
                let points: Vec<_> = path.iter().map(|p| frame.pixel(view, corner, p)).collect();
                svg.polyline("", &points);
            }
            svg.close();
        }
        for (class, paths) in [("left-end", &panel.left), ("right-end", &panel.right)] {
            for first in paths.iter().filter_map(|path| path.first()) {
                let [x, y] = frame.pixel(view, corner, first);
                let dot = format!("M{} {}h0", tenth(x), tenth(y));
                let class = class.trim_end_matches("-end");
                let look = "stroke-width=\"5\" stroke-linecap=\"round\"";
                svg.path(&format!("class=\"{class}\" {look}"), &dot);
            }
        }
    }
    let metres = round_step(36.0 / frame.scale);
    let (right, y) = (left + PANEL - 12.0, top + height - 10.0);
    svg.line("axis", [right - metres * frame.scale, y], [right, y]);
    let label = format!("{} cm", number(metres * 100.0));
    svg.text(right, y - 5.0, Anchor::End, SMALL, &label);
}
