//! Where the hands go in the movements of each group: the paper's Figure 1.

use crate::axis::{extent, round_step};
use crate::svg::{Anchor, HEAD, LABEL, MARGIN, SMALL, Svg, fitted, nothing, number, tenth};

/// Below this silhouette a group is marked as doubtful: "no substantial structure has been found" (Kaufman and
/// Rousseeuw 1990, table 4).
pub const LOW_COHERENCE: f64 = 0.25;

const WIDTH: f64 = 960.0;
const COLUMNS: usize = 3;
const PANELS: usize = 24;
const GAP: f64 = 16.0;
const HEADER: f64 = 40.0;
/// The height of a drawing at most.
const DRAWING: f64 = 200.0;
/// Most members whose own paths are drawn; the mean is always of all.
const MEMBERS: usize = 24;
/// Samples of a drawn path.
const SAMPLES: usize = 33;

/// The hand paths of one group's segments.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GroupPaths {
    /// The group's name.
    pub name: String,
    /// How well its members hold together, a silhouette in [-1, 1]; `None` where it is not known.
    pub coherence: Option<f64>,
    /// For each member the path of the right hand in the thorax frame: x forward, y left, z up, metres, in even time.
    pub right: Vec<Vec<[f64; 3]>>,
    /// The same for the left hand.
    pub left: Vec<Vec<[f64; 3]>>,
}

/// A panel for each group with the paths of both hands, from the front and from the right side; all at one scale.
///
/// Thin lines are members, evenly chosen where they are many; the bold line is the mean over all members at equal
/// shares of their time, with a dot where it begins. Of more than 24 groups the largest are shown, in the given order.
pub fn hand_paths(groups: &[GroupPaths]) -> String {
    const TITLE: &str = "Hand paths of each group";
    let groups: Vec<Panel> = groups
        .iter()
        .map(Panel::of)
        .filter(|g| g.size() > 0)
        .collect();
    if groups.is_empty() {
        return nothing(TITLE, "There is no group with a hand path to show.");
    }
    let mut shown: Vec<usize> = (0..groups.len()).collect();
    shown.sort_by_key(|i| (std::cmp::Reverse(groups[*i].size()), *i));
    shown.truncate(PANELS);
    shown.sort_unstable();

    let mut svg = Svg::new(WIDTH, 0.0, TITLE);
    draw_key(&mut svg);
    let frame = Frame::around(shown.iter().map(|i| &groups[*i]));
    let columns = COLUMNS.min(shown.len());
    let height = HEADER + frame.height + 12.0;
    for (k, &i) in shown.iter().enumerate() {
        let left = MARGIN + (k % columns) as f64 * (PANEL_WIDTH + GAP);
        let top = 66.0 + (k / columns) as f64 * (height + GAP);
        draw_panel(&mut svg, [left, top], height, &groups[i], &frame);
    }
    let rows = shown.len().div_ceil(columns);
    let mut bottom = 66.0 + rows as f64 * (height + GAP) + 6.0;
    let mut remark = "Bold: the mean; thin: members; the dot is where a movement begins; + is the origin, midway \
                      between the shoulders."
        .to_owned();
    if groups.len() > shown.len() {
        let (all, some) = (groups.len(), shown.len());
        remark.push_str(&format!(" The {some} largest of {all} groups are shown."));
    }
    svg.text(MARGIN, bottom, Anchor::Start, SMALL, &remark);
    bottom += 16.0;
    svg.finish(Some(bottom))
}

const PANEL_WIDTH: f64 = (WIDTH - 2.0 * MARGIN - GAP * (COLUMNS - 1) as f64) / COLUMNS as f64;

fn draw_key(svg: &mut Svg) {
    let mut entry = |x: f64, class: &str, name: &str| {
        let line = format!(
            "class=\"{class}\" fill=\"none\" stroke-width=\"2.6\" stroke-linecap=\"round\""
        );
        svg.polyline(&line, &[[x, 46.0], [x + 22.0, 46.0]]);
        svg.text(x + 28.0, 50.0, Anchor::Start, LABEL, name);
    };
    entry(MARGIN, "right", "right hand");
    entry(MARGIN + 110.0, "left", "left hand");
    let views = "in each panel: seen from the front (left), and from the person's right (right)";
    svg.text(WIDTH - MARGIN, 50.0, Anchor::End, SMALL, views);
}

/// A group's paths, resampled.
struct Panel<'a> {
    group: &'a GroupPaths,
    /// Right hand, left hand.
    hands: [Vec<Path>; 2],
}

type Path = [[f64; 3]; SAMPLES];

impl<'a> Panel<'a> {
    fn of(group: &'a GroupPaths) -> Self {
        let hands = [&group.right, &group.left]
            .map(|paths| paths.iter().filter_map(|path| resampled(path)).collect());
        Self { group, hands }
    }

    /// How many segments the group has.
    fn size(&self) -> usize {
        self.hands[0].len().max(self.hands[1].len())
    }
}

/// A path at even shares of its samples; `None` where it is empty or holds a number that is not finite.
fn resampled(path: &[[f64; 3]]) -> Option<Path> {
    let last = path.len().checked_sub(1)?;
    if path.iter().flatten().any(|c| !c.is_finite()) {
        return None;
    }
    Some(std::array::from_fn(|k| {
        let at = k as f64 * last as f64 / (SAMPLES - 1) as f64;
        let before = (at.floor() as usize).min(last);
        let after = (before + 1).min(last);
        let share = at - before as f64;
        std::array::from_fn(|c| path[before][c] + share * (path[after][c] - path[before][c]))
    }))
}

fn mean(paths: &[Path]) -> Path {
    std::array::from_fn(|k| {
        std::array::from_fn(|c| paths.iter().map(|p| p[k][c]).sum::<f64>() / paths.len() as f64)
    })
}

/// The one scale of all panels.
struct Frame {
    middle: [f64; 3],
    /// Pixels a metre.
    scale: f64,
    /// How high a drawing is, pixels: no higher than its paths want.
    height: f64,
    /// How the drawing's width is shared between the views, pixels.
    front: f64,
}

impl Frame {
    fn around<'a>(panels: impl Iterator<Item = &'a Panel<'a>> + Clone) -> Self {
        let range = |c: usize| {
            let values = panels
                .clone()
                .flat_map(|p| p.hands.iter().flatten().flatten());
            extent(values.map(|x| x[c]).chain([0.0])).unwrap_or([0.0, 0.0])
        };
        let ranges = [range(0), range(1), range(2)];
        let size = |c: usize| (ranges[c][1] - ranges[c][0]).max(0.05);
        let room = PANEL_WIDTH - 52.0;
        let scale = (room / (size(0) + size(1))).min((DRAWING - 28.0) / size(2));
        // What the scale leaves over goes to both views alike.
        let spare = PANEL_WIDTH - scale * (size(0) + size(1));
        Self {
            middle: ranges.map(|[low, high]| 0.5 * (low + high)),
            scale,
            height: (scale * size(2) + 28.0).clamp(80.0, DRAWING),
            front: scale * size(1) + 0.5 * spare,
        }
    }

    /// From the front the person's left is at our right; from the person's right, forward is.
    fn pixel(&self, view: usize, [left, top]: [f64; 2], point: &[f64; 3]) -> [f64; 2] {
        let across = if view == 0 { 1 } else { 0 };
        let middle = if view == 0 {
            0.5 * self.front
        } else {
            0.5 * (PANEL_WIDTH + self.front)
        };
        [
            left + middle + (point[across] - self.middle[across]) * self.scale,
            top + HEADER + 0.5 * self.height - (point[2] - self.middle[2]) * self.scale,
        ]
    }
}

fn draw_panel(svg: &mut Svg, corner: [f64; 2], height: f64, panel: &Panel, frame: &Frame) {
    let [left, top] = corner;
    let group = panel.group;
    let coherence = group.coherence.filter(|c| c.is_finite());
    let doubtful = coherence.is_some_and(|c| c < LOW_COHERENCE);
    svg.rectangle(
        "class=\"panel\" rx=\"4\"",
        corner,
        [PANEL_WIDTH, height],
        "",
    );
    let name = fitted(
        &group.name,
        HEAD.size,
        PANEL_WIDTH - if doubtful { 130.0 } else { 20.0 },
    );
    svg.text(left + 10.0, top + 18.0, Anchor::Start, HEAD, &name);
    let size = panel.size();
    let mut facts = format!("{size} segment{}", if size == 1 { "" } else { "s" });
    if size > MEMBERS {
        facts.push_str(&format!(", {MEMBERS} drawn"));
    }
    if let Some(coherence) = coherence {
        // A true minus, as the text around it is set.
        let value = format!("{coherence:.2}").replace('-', "\u{2212}");
        facts.push_str(&format!(" \u{b7} coherence {value}"));
    }
    svg.text(left + 10.0, top + 33.0, Anchor::Start, SMALL, &facts);
    if doubtful {
        let attributes =
            "class=\"accent-line\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\" rx=\"4\"";
        svg.rectangle(attributes, corner, [PANEL_WIDTH, height], "");
        let right = left + PANEL_WIDTH - 10.0;
        let warning = "low coherence";
        svg.text(right, top + 18.0, Anchor::End, LABEL, warning);
        let x = right - crate::svg::text_width(warning, LABEL.size) - 14.0;
        let y = top + 18.0;
        let triangle = format!("M{} {}l5.5 -10l5.5 10Z", tenth(x), tenth(y));
        svg.path("class=\"accent\"", &triangle);
    }
    let divide = left + frame.front;
    svg.line(
        "grid",
        [divide, top + HEADER + 4.0],
        [divide, top + height - 10.0],
    );
    for view in 0..2 {
        let [x, y] = frame.pixel(view, corner, &[0.0; 3]);
        svg.line("axis", [x - 4.0, y], [x + 4.0, y]);
        svg.line("axis", [x, y - 4.0], [x, y + 4.0]);
        // The left hand first: in the paper the right one, dark, is on top.
        for (hand, class) in [(1, "left"), (0, "right")] {
            draw_hand(svg, class, &panel.hands[hand], |p| {
                frame.pixel(view, corner, p)
            });
        }
    }
    draw_scale_bar(
        svg,
        [left + PANEL_WIDTH - 10.0, top + height - 8.0],
        frame.scale,
    );
}

fn draw_hand(svg: &mut Svg, class: &str, paths: &[Path], pixel: impl Fn(&[f64; 3]) -> [f64; 2]) {
    if paths.is_empty() {
        return;
    }
    let project = |path: &Path| -> Vec<[f64; 2]> { path.iter().map(&pixel).collect() };
    let thin =
        "fill=\"none\" stroke-width=\"0.8\" stroke-opacity=\"0.38\" stroke-linejoin=\"round\"";
    svg.open(&format!("class=\"{class}\" {thin}"), "");
    let drawn = paths.len().min(MEMBERS);
    for k in 0..drawn {
        svg.polyline("", &project(&paths[k * paths.len() / drawn]));
    }
    svg.close();
    let bold =
        "fill=\"none\" stroke-width=\"2.6\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
    let mean = project(&mean(paths));
    svg.polyline(&format!("class=\"{class}\" {bold}"), &mean);
    svg.disc(&format!("class=\"{class}-end\""), mean[0], 3.6);
}

fn draw_scale_bar(svg: &mut Svg, [right, y]: [f64; 2], scale: f64) {
    let metres = round_step(28.0 / scale);
    let length = metres * scale;
    svg.line("axis", [right - length, y], [right, y]);
    let label = if metres < 1.0 {
        format!("{} cm", number(metres * 100.0))
    } else {
        format!("{} m", number(metres))
    };
    svg.text(right, y - 4.0, Anchor::End, SMALL, &label);
}
