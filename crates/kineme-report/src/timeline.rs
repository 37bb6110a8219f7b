//! Which group each moment of each recording belongs to.

use crate::axis::Scale;
use crate::palette::{colour, text_on};
use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, Type, fitted, nothing, text_width};

const WIDTH: f64 = 960.0;
const ROWS: usize = 48;
const NAMES: f64 = 170.0;
const STRIP: f64 = 18.0;
const BEHAVIOR_STRIP: f64 = 14.0;
const TOP: f64 = 44.0;

/// A segment on the time line of its recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Span {
    /// When it begins, seconds.
    pub start: f64,
    /// When it ends, seconds.
    pub end: f64,
    /// Its group, an index into the names; `None` is unclustered.
    pub group: Option<usize>,
    /// The name of its behavior, the second level; `None` where it has none.
    pub behavior: Option<String>,
}

/// A recording with its segments in the order of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// The recording's name.
    pub name: String,
    /// Its segments.
    pub spans: Vec<Span>,
}

/// A strip for each recording, coloured by group (`names[group]`), with the behaviors bracketed beneath.
///
/// All strips have one scale of time. Of more than 48 recordings the first are shown.
pub fn timeline(rows: &[Row], names: &[String]) -> String {
    const TITLE: &str = "Time line of the recordings";
    let valid = |s: &&Span| s.start.is_finite() && s.end.is_finite() && s.end > s.start;
    let spans: Vec<Vec<&Span>> = rows
        .iter()
        .map(|r| r.spans.iter().filter(valid).collect())
        .collect();
    let shown = rows.len().min(ROWS);
    let Some(last) = spans[..shown]
        .iter()
        .flatten()
        .map(|s| s.end)
        .max_by(f64::total_cmp)
    else {
        return nothing(TITLE, "There is no segment to show.");
    };
    let first = spans[..shown]
        .iter()
        .flatten()
        .map(|s| s.start)
        .fold(0.0, f64::min);
    let mut svg = Svg::new(WIDTH, 0.0, TITLE);
    let left = MARGIN + NAMES;
    let time = Scale::new([first, last], [left, WIDTH - MARGIN]);
    let with_behaviors = spans[..shown]
        .iter()
        .flatten()
        .any(|s| s.behavior.is_some());
    let pitch = STRIP
        + 8.0
        + if with_behaviors {
            BEHAVIOR_STRIP + 2.0
        } else {
            0.0
        };
    let bottom = TOP + shown as f64 * pitch;
    for (value, label) in time.ticks(10) {
        let x = time.at(value);
        svg.line("grid", [x, TOP - 4.0], [x, bottom]);
        svg.text(x, bottom + 14.0, Anchor::Middle, SMALL, &label);
    }
    for (i, row) in rows[..shown].iter().enumerate() {
        let y = TOP + i as f64 * pitch;
        let name = fitted(&row.name, LABEL.size, NAMES - 10.0);
        svg.text(left - 8.0, y + 13.0, Anchor::End, LABEL, &name);
        for span in &spans[i] {
            draw_span(&mut svg, &time, y, span, names);
        }
        draw_behaviors(&mut svg, &time, y + STRIP + 2.0, &spans[i]);
    }
    svg.text(WIDTH - MARGIN, bottom + 30.0, Anchor::End, SMALL, "seconds");
    let mut y = bottom + 34.0;
    if rows.len() > shown {
        let remark = format!("The first {shown} of {} recordings are shown.", rows.len());
        svg.text(MARGIN, y - 4.0, Anchor::Start, SMALL, &remark);
        y += 14.0;
    }
    let bottom = draw_legend(&mut svg, y, &spans[..shown], names);
    svg.finish(Some(bottom))
}

fn draw_span(svg: &mut Svg, time: &Scale, y: f64, span: &Span, names: &[String]) {
    let (x, end) = (time.at(span.start), time.at(span.end));
    // A hair of paper between neighbours, as long as that leaves most of the span.
    let width = (end - x - 0.6).max(0.6 * (end - x));
    let group = span.group.and_then(|g| Some((g, names.get(g)?)));
    let name = group.map_or("unclustered", |(_, name)| name);
    let tooltip = format!("{name}, {:.2} to {:.2} s", span.start, span.end);
    match group {
        None => svg.rectangle(
            "class=\"noise\" fill-opacity=\"0.45\"",
            [x, y],
            [width, STRIP],
            &tooltip,
        ),
        Some((g, name)) => {
            let fill = format!("fill=\"{}\"", colour(g));
            svg.rectangle(&fill, [x, y], [width, STRIP], &tooltip);
            if text_width(name, SMALL.size) + 6.0 <= width {
                let class = if text_on(g) == "#fff" {
                    "on-dark"
                } else {
                    "on-light"
                };
                let look = Type { class, ..SMALL };
                svg.text(x + 0.5 * width, y + 13.0, Anchor::Middle, look, name);
            }
        }
    }
}

/// Brackets one run of segments of the same behavior, and names it where there is room.
fn draw_behaviors(svg: &mut Svg, time: &Scale, y: f64, spans: &[&Span]) {
    for run in spans.chunk_by(|a, b| a.behavior == b.behavior) {
        let (Some(name), Some(last)) = (&run[0].behavior, run.last()) else {
            continue;
        };
        let (x, end) = (time.at(run[0].start) + 0.8, time.at(last.end) - 0.8);
        svg.polyline(
            "class=\"axis\"",
            &[[x, y], [x, y + 3.0], [end, y + 3.0], [end, y]],
        );
        if text_width(name, SMALL.size) + 4.0 <= end - x {
            svg.text(0.5 * (x + end), y + 13.5, Anchor::Middle, SMALL, name);
        }
    }
}

fn draw_legend(svg: &mut Svg, top: f64, spans: &[Vec<&Span>], names: &[String]) -> f64 {
    let mut used = vec![false; names.len()];
    for span in spans.iter().flatten() {
        if let Some(seen) = span.group.and_then(|g| used.get_mut(g)) {
            *seen = true;
        }
    }
    let column = (WIDTH - 2.0 * MARGIN) / 6.0;
    let entries: Vec<usize> = (0..names.len()).filter(|g| used[*g]).collect();
    let rows = entries.len().div_ceil(6).max(1);
    for (i, &group) in entries.iter().enumerate() {
        let (x, y) = (
            MARGIN + (i / rows) as f64 * column,
            top + 14.0 + (i % rows) as f64 * 18.0,
        );
        svg.rectangle(
            &format!("fill=\"{}\"", colour(group)),
            [x, y - 9.0],
            [14.0, 10.0],
            "",
        );
        let name = fitted(&names[group], LABEL.size, column - 26.0);
        svg.text(x + 20.0, y, Anchor::Start, LABEL, &name);
    }
    top + 14.0 + rows as f64 * 18.0
}
