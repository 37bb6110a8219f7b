//! The embedding: every segment a point, coloured by its group.

use crate::axis::{Scale, extent};
use crate::palette::{mark, mark_style};
use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, Type, fitted, nothing, text_width};

const WIDTH: f64 = 960.0;
const PLOT_TOP: f64 = 44.0;
const PLOT_HEIGHT: f64 = 430.0;
/// Groups whose name is written into the plot, the largest first; all stand in the legend.
const NAMED_IN_PLOT: usize = 24;
const LEGEND_COLUMNS: usize = 6;
const LEGEND_ENTRIES: usize = 72;
/// Height of a group's row where there is one dimension.
const ROW: f64 = 19.0;
const UNCLUSTERED: &str = "unclustered";

/// What [`embedding`] draws.
#[derive(Debug, Clone, Copy, Default)]
pub struct Embedding<'a> {
    /// Coordinates of each segment; the first three are drawn.
    pub points: &'a [Vec<f64>],
    /// The group of each segment, an index into `names`; `None` is unclustered. Missing at the end: `None`.
    pub groups: &'a [Option<usize>],
    /// The names of the groups.
    pub names: &'a [String],
    /// For each recording its segments in the order of time, as indices into `points`; joined by a faint line.
    pub recordings: &'a [Vec<usize>],
}

/// The embedded segments as a scatter plot, one view for two dimensions, two views (1-2 and 1-3) for three or more;
/// on one dimension a row for each group.
///
/// Lengths are true: both axes of a view have one scale.
pub fn embedding(data: &Embedding) -> String {
    const TITLE: &str = "Embedding of the segments";
    let mut drawn: Vec<(usize, [f64; 3])> = Vec::with_capacity(data.points.len());
    for (i, point) in data.points.iter().enumerate() {
        let at = |k: usize| point.get(k).copied().unwrap_or(0.0);
        let coordinates = [at(0), at(1), at(2)];
        if coordinates.iter().all(|c| c.is_finite()) {
            drawn.push((i, coordinates));
        }
    }
    if drawn.is_empty() {
        return nothing(TITLE, "There is no segment to show.");
    }
    let members = Members::of(data, &drawn);
    if data.points.iter().all(|p| p.len() < 2) {
        return on_a_line(TITLE, data, &drawn, &members);
    }
    let in_space = data.points.iter().any(|p| p.len() > 2);
    let views: &[[usize; 2]] = if in_space {
        &[[0, 1], [0, 2]]
    } else {
        &[[0, 1]]
    };
    let mut svg = Svg::new(WIDTH, 0.0, TITLE);
    let gap = 24.0;
    let plot_width = (WIDTH - 2.0 * MARGIN - gap * (views.len() - 1) as f64) / views.len() as f64;
    // One scale for all views, so that a distance on the first axis is the same length in each.
    let ranges: [[f64; 2]; 3] =
        [0, 1, 2].map(|k| extent(drawn.iter().map(|(_, c)| c[k])).unwrap_or([0.0, 1.0]));
    let size = |k: usize| ranges[k][1] - ranges[k][0];
    let (room_x, room_y) = (plot_width - 64.0, PLOT_HEIGHT - 64.0);
    let largest = views.iter().fold(1e-12, |most: f64, [h, v]| {
        most.max(size(*h) / room_x).max(size(*v) / room_y)
    });
    for (i, &[h, v]) in views.iter().enumerate() {
        let left = MARGIN + i as f64 * (plot_width + gap);
        let span = |k: usize, pixels: f64| {
            let middle = 0.5 * (ranges[k][0] + ranges[k][1]);
            let half = 0.5 * pixels * largest;
            [middle - half, middle + half]
        };
        let view = View {
            left,
            width: plot_width,
            x: Scale::new(span(h, plot_width), [left, left + plot_width]),
            y: Scale::new(span(v, PLOT_HEIGHT), [PLOT_TOP + PLOT_HEIGHT, PLOT_TOP]),
            axes: [h, v],
        };
        draw_view(&mut svg, &view, data, &drawn, &members);
    }
    let below = PLOT_TOP + PLOT_HEIGHT + 40.0;
    let mut bottom = draw_legend(&mut svg, below, data, &members);
    let lost = data.points.len() - drawn.len();
    if lost > 0 {
        svg.text(MARGIN, bottom, Anchor::Start, SMALL, &left_out(lost));
        bottom += 18.0;
    }
    svg.finish(Some(bottom))
}

/// An embedding of one dimension: a row for each group, so that points of several do not hide one another.
fn on_a_line(
    title: &str,
    data: &Embedding,
    drawn: &[(usize, [f64; 3])],
    members: &Members,
) -> String {
    let mut svg = Svg::new(WIDTH, 0.0, title);
    let rows = members.by_size.len() + usize::from(!members.noise.is_empty());
    let names = members
        .by_size
        .iter()
        .map(|g| text_width(&data.names[*g], LABEL.size));
    let room = names
        .fold(text_width(UNCLUSTERED, LABEL.size), f64::max)
        .min(190.0)
        + 60.0;
    let left = MARGIN + room;
    let bottom = PLOT_TOP + rows as f64 * ROW;
    let range = extent(drawn.iter().map(|(_, c)| c[0])).unwrap_or([0.0, 1.0]);
    let across = Scale::new(range, [left + 12.0, WIDTH - MARGIN - 12.0]);
    svg.rectangle(
        "class=\"panel\"",
        [left, PLOT_TOP],
        [WIDTH - MARGIN - left, bottom - PLOT_TOP],
        "",
    );
    for (value, label) in across.ticks(8) {
        let x = across.at(value);
        svg.line("grid", [x, PLOT_TOP], [x, bottom]);
        svg.text(x, bottom + 14.0, Anchor::Middle, SMALL, &label);
    }
    svg.text(
        WIDTH - MARGIN,
        PLOT_TOP - 8.0,
        Anchor::End,
        SMALL,
        "the only dimension, across; a row a group",
    );
    let mut order = members.by_size.clone();
    let middle = |g: usize| {
        let mut at: Vec<f64> = members.groups[g].iter().map(|p| p[0]).collect();
        at.sort_by(f64::total_cmp);
        at[at.len() / 2]
    };
    order.sort_by(|a, b| middle(*a).total_cmp(&middle(*b)).then(a.cmp(b)));
    let ends = [left - 8.0, PLOT_TOP + 0.5 * ROW];
    for (row, &group) in order.iter().enumerate() {
        let y = ends[1] + row as f64 * ROW;
        let points = &members.groups[group];
        let name = fitted(&data.names[group], LABEL.size, room - 50.0);
        svg.text(
            ends[0],
            y + 4.0,
            Anchor::End,
            LABEL,
            &format!("{name} ({})", points.len()),
        );
        svg.open(&mark_style(group), &data.names[group]);
        for point in points {
            svg.path("", &mark(group, [across.at(point[0]), y], 3.6));
        }
        svg.close();
    }
    if !members.noise.is_empty() {
        let y = ends[1] + order.len() as f64 * ROW;
        let name = format!("{UNCLUSTERED} ({})", members.noise.len());
        svg.text(ends[0], y + 4.0, Anchor::End, LABEL, &name);
        svg.open("class=\"noise\" fill-opacity=\"0.8\"", UNCLUSTERED);
        for point in &members.noise {
            svg.disc("", [across.at(point[0]), y], 2.7);
        }
        svg.close();
    }
    let lost = data.points.len() - drawn.len();
    if lost > 0 {
        svg.text(MARGIN, bottom + 34.0, Anchor::Start, SMALL, &left_out(lost));
    }
    svg.finish(Some(bottom + if lost > 0 { 46.0 } else { 26.0 }))
}

fn left_out(segments: usize) -> String {
    format!("{segments} segments without finite coordinates are left out.")
}

/// The points of each group, and of none.
struct Members {
    groups: Vec<Vec<[f64; 3]>>,
    noise: Vec<[f64; 3]>,
    /// Groups with a member, the largest first.
    by_size: Vec<usize>,
}

impl Members {
    fn of(data: &Embedding, drawn: &[(usize, [f64; 3])]) -> Self {
        let mut groups: Vec<Vec<[f64; 3]>> = vec![Vec::new(); data.names.len()];
        let mut noise = Vec::new();
        for &(i, point) in drawn {
            let group = data.groups.get(i).copied().flatten();
            match group.and_then(|g| groups.get_mut(g)) {
                Some(members) => members.push(point),
                None => noise.push(point),
            }
        }
        let mut by_size: Vec<usize> = (0..groups.len())
            .filter(|g| !groups[*g].is_empty())
            .collect();
        by_size.sort_by_key(|g| (std::cmp::Reverse(groups[*g].len()), *g));
        Self {
            groups,
            noise,
            by_size,
        }
    }
}

/// One projection and where it stands.
struct View {
    left: f64,
    width: f64,
    x: Scale,
    y: Scale,
    axes: [usize; 2],
}

impl View {
    fn pixel(&self, point: &[f64; 3]) -> [f64; 2] {
        [
            self.x.at(point[self.axes[0]]),
            self.y.at(point[self.axes[1]]),
        ]
    }
}

fn draw_view(
    svg: &mut Svg,
    view: &View,
    data: &Embedding,
    drawn: &[(usize, [f64; 3])],
    members: &Members,
) {
    let (left, right) = (view.left, view.left + view.width);
    let bottom = PLOT_TOP + PLOT_HEIGHT;
    svg.rectangle(
        "class=\"panel\"",
        [left, PLOT_TOP],
        [view.width, PLOT_HEIGHT],
        "",
    );
    for (value, label) in view.x.ticks(6) {
        let x = view.x.at(value);
        svg.line("grid", [x, PLOT_TOP], [x, bottom]);
        svg.text(x, bottom + 14.0, Anchor::Middle, SMALL, &label);
    }
    for (value, label) in view.y.ticks(6) {
        let y = view.y.at(value);
        svg.line("grid", [left, y], [right, y]);
        if y > PLOT_TOP + 12.0 && y < bottom - 8.0 {
            svg.text(left + 4.0, y - 3.0, Anchor::Start, SMALL, &label);
        }
    }
    let [h, v] = view.axes.map(|k| k + 1);
    let axes = format!("dimension {h} across, {v} upward");
    svg.text(right, PLOT_TOP - 8.0, Anchor::End, SMALL, &axes);

    let place: std::collections::BTreeMap<usize, [f64; 2]> = drawn
        .iter()
        .map(|(i, point)| (*i, view.pixel(point)))
        .collect();
    // Thousands of lines must not become a wall.
    let opacity = (60.0 / drawn.len() as f64).clamp(0.035, 0.3);
    svg.open(&format!("stroke-opacity=\"{opacity:.3}\""), "");
    for recording in data.recordings {
        let line: Vec<[f64; 2]> = recording
            .iter()
            .filter_map(|i| place.get(i).copied())
            .collect();
        svg.polyline("class=\"chain\"", &line);
    }
    svg.close();
    let radius = (3.8 - drawn.len() as f64 / 1200.0).clamp(2.0, 3.6);
    if !members.noise.is_empty() {
        let tooltip = format!("unclustered ({})", members.noise.len());
        svg.open("class=\"noise\" fill-opacity=\"0.8\"", &tooltip);
        for point in &members.noise {
            svg.disc("", view.pixel(point), radius * 0.75);
        }
        svg.close();
    }
    for &group in &members.by_size {
        let points = &members.groups[group];
        svg.open(
            &mark_style(group),
            &format!("{} ({})", data.names[group], points.len()),
        );
        for point in points {
            svg.path("", &mark(group, view.pixel(point), radius));
        }
        svg.close();
    }
    name_groups(svg, view, data, members);
}

/// Writes the names of the largest groups near their middles, each where it covers no other name, or not at all.
fn name_groups(svg: &mut Svg, view: &View, data: &Embedding, members: &Members) {
    let look = Type {
        class: "ink halo",
        ..LABEL
    };
    let mut taken: Vec<[f64; 4]> = Vec::new();
    for &group in members.by_size.iter().take(NAMED_IN_PLOT) {
        let points = &members.groups[group];
        let middle = |k: usize| {
            let mut values: Vec<f64> = points.iter().map(|p| view.pixel(p)[k]).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let name = fitted(&data.names[group], look.size, 120.0);
        let half = 0.5 * text_width(&name, look.size);
        let (x, y) = (middle(0), middle(1));
        let free = [-9.0, 17.0, -23.0].into_iter().find_map(|dy| {
            let x = x.clamp(view.left + half + 3.0, view.left + view.width - half - 3.0);
            let y = y + dy;
            let place = [x - half - 2.0, y - 11.0, x + half + 2.0, y + 3.0];
            let inside = place[1] > PLOT_TOP && place[3] < PLOT_TOP + PLOT_HEIGHT;
            let apart = taken
                .iter()
                .all(|t| place[2] < t[0] || place[0] > t[2] || place[3] < t[1] || place[1] > t[3]);
            (inside && apart).then_some((x, y, place))
        });
        if let Some((x, y, place)) = free {
            svg.text(x, y, Anchor::Middle, look, &name);
            taken.push(place);
        }
    }
}

/// The legend in columns, in the order of the names; gives the place below it.
fn draw_legend(svg: &mut Svg, top: f64, data: &Embedding, members: &Members) -> f64 {
    let mut shown: Vec<usize> = members
        .by_size
        .iter()
        .copied()
        .take(LEGEND_ENTRIES)
        .collect();
    shown.sort_unstable();
    let column = (WIDTH - 2.0 * MARGIN) / LEGEND_COLUMNS as f64;
    let entries = shown.len() + usize::from(!members.noise.is_empty());
    let rows = entries.div_ceil(LEGEND_COLUMNS).max(1);
    // Columns are read downward.
    let place = |i: usize| {
        let x = MARGIN + (i / rows) as f64 * column;
        [x, top + (i % rows) as f64 * 18.0]
    };
    for (i, &group) in shown.iter().enumerate() {
        let [x, y] = place(i);
        svg.path(&mark_style(group), &mark(group, [x + 5.0, y - 4.0], 4.0));
        let text = format!("{} ({})", data.names[group], members.groups[group].len());
        svg.text(
            x + 15.0,
            y,
            Anchor::Start,
            LABEL,
            &fitted(&text, LABEL.size, column - 20.0),
        );
    }
    if !members.noise.is_empty() {
        let [x, y] = place(shown.len());
        svg.disc("class=\"noise\"", [x + 5.0, y - 4.0], 3.0);
        let text = format!("unclustered ({})", members.noise.len());
        svg.text(x + 15.0, y, Anchor::Start, LABEL, &text);
    }
    let mut bottom = top + rows as f64 * 18.0;
    let more = members.by_size.len() - shown.len();
    if more > 0 {
        let remark = format!("and {more} smaller groups; colours and shapes repeat");
        svg.text(MARGIN, bottom, Anchor::Start, SMALL, &remark);
        bottom += 18.0;
    }
    bottom
}
