//! Which group each moment of each recording belongs to.

use crate::axis::Scale;
use crate::palette::{COLOURS, colour, text_on};
use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, Type, fitted, nothing, text_width};

const WIDTH: f64 = 960.0;
/// Room for the recordings' names, pixels: as much as they need, within these.
const NAMES: [f64; 2] = [64.0, 240.0];
const STRIP: f64 = 18.0;
const BEHAVIOR_STRIP: f64 = 15.0;
const TOP: f64 = 44.0;
/// Lines in the figure: long recordings are broken into several while there is room.
const LINES: usize = 48;
/// How wide the middle segment should be, pixels.
const READABLE: f64 = 22.0;
const LEGEND_COLUMNS: usize = 6;

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
    /// Its segments, in seconds from its own beginning.
    pub spans: Vec<Span>,
}

/// A strip for each recording, coloured by group (`names[group]`), with the behaviors bracketed beneath.
///
/// All strips have one scale of time. Long recordings are broken into lines, as text is, so that segments stay
/// readable; of more than 48 recordings the first are shown.
pub fn timeline(rows: &[Row], names: &[String]) -> String {
    const TITLE: &str = "Time line of the recordings";
    let valid = |s: &&Span| s.start >= 0.0 && s.end > s.start && s.end.is_finite();
    let shown: Vec<(&str, Vec<&Span>)> = rows
        .iter()
        .map(|row| (row.name.as_str(), row.spans.iter().filter(valid).collect()))
        .filter(|(_, spans): &(&str, Vec<&Span>)| !spans.is_empty())
        .collect();
    if shown.is_empty() {
        return nothing(TITLE, "There is no segment to show.");
    }
    let left_out = shown.len().saturating_sub(LINES);
    let shown = &shown[..shown.len() - left_out];
    let widest = shown.iter().map(|(name, _)| text_width(name, LABEL.size));
    let room = widest.fold(0.0, f64::max) + 10.0;
    let room = room.clamp(NAMES[0], NAMES[1]);
    let left = MARGIN + room;
    let lines = broken(shown, names, WIDTH - MARGIN - left);
    let mut svg = Svg::new(WIDTH, 0.0, TITLE);
    let time = Scale::new([0.0, lines.seconds], [left, WIDTH - MARGIN]);
    let with_behaviors = shown
        .iter()
        .any(|(_, spans)| spans.iter().any(|s| s.behavior.is_some()));
    let pitch = STRIP + 8.0 + if with_behaviors { BEHAVIOR_STRIP } else { 0.0 };
    let bottom = TOP + lines.lines.len() as f64 * pitch;
    for (value, label) in time.ticks(10) {
        let x = time.at(value);
        svg.line("grid", [x, TOP - 4.0], [x, bottom]);
        svg.text(x, bottom + 14.0, Anchor::Middle, SMALL, &label);
    }
    svg.text(left - 8.0, bottom + 14.0, Anchor::End, SMALL, "seconds");
    let prefix = common_prefix(names);
    for (i, line) in lines.lines.iter().enumerate() {
        let y = TOP + i as f64 * pitch;
        let label = if line.begin > 0.0 { SMALL } else { LABEL };
        let name = fitted(&line.label, label.size, room - 10.0);
        svg.text(left - 8.0, y + 13.0, Anchor::End, label, &name);
        for piece in &line.pieces {
            draw_piece(&mut svg, &time, y, piece, names, prefix);
        }
        draw_behaviors(&mut svg, &time, y + STRIP + 2.0, &line.pieces);
    }
    let mut y = bottom + 28.0;
    if left_out > 0 {
        let (some, all) = (shown.len(), shown.len() + left_out);
        let remark = format!("The first {some} of {all} recordings are shown.");
        svg.text(MARGIN, y + 4.0, Anchor::Start, SMALL, &remark);
        y += 18.0;
    }
    let bottom = draw_legend(&mut svg, y, shown, names);
    svg.finish(Some(bottom))
}

/// Recordings broken into lines of equal time.
struct Lines<'a> {
    seconds: f64,
    lines: Vec<Line<'a>>,
}

struct Line<'a> {
    label: String,
    /// When the line begins in its recording, seconds.
    begin: f64,
    pieces: Vec<Piece<'a>>,
}

/// The part of a segment that falls on a line, in seconds from the line's beginning.
struct Piece<'a> {
    start: f64,
    end: f64,
    span: &'a Span,
    group: Option<usize>,
}

fn broken<'a>(recordings: &[(&'a str, Vec<&'a Span>)], names: &[String], width: f64) -> Lines<'a> {
    let length = |spans: &[&Span]| spans.iter().map(|s| s.end).fold(0.0, f64::max);
    let longest = recordings
        .iter()
        .map(|(_, spans)| length(spans))
        .fold(0.0, f64::max);
    let mut lengths: Vec<f64> = recordings
        .iter()
        .flat_map(|(_, spans)| spans.iter().map(|s| s.end - s.start))
        .collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths.get(lengths.len() / 2).copied().unwrap_or(1.0);
    let mut seconds = middle * width / READABLE;
    let count = |seconds: f64| -> f64 {
        recordings
            .iter()
            .map(|(_, spans)| (length(spans) / seconds).ceil())
            .sum()
    };
    while seconds < longest && count(seconds) > LINES as f64 {
        seconds *= 1.1;
    }
    // Whole seconds, so that lines begin at a time that one can read.
    if seconds > 5.0 {
        seconds = seconds.ceil();
    }
    // Rather one full line than a second with a scrap on it.
    if seconds > 0.8 * longest {
        seconds = longest;
    }
    let mut lines = Vec::new();
    for (name, spans) in recordings {
        let mut begin = 0.0;
        while begin < length(spans) {
            let end = begin + seconds;
            let pieces = spans
                .iter()
                .filter(|s| s.start < end && s.end > begin)
                .map(|span| Piece {
                    start: span.start.max(begin) - begin,
                    end: span.end.min(end) - begin,
                    span,
                    group: span.group.filter(|g| *g < names.len()),
                });
            let label = if begin == 0.0 {
                (*name).to_owned()
            } else {
                format!("from {} s", crate::svg::number(begin))
            };
            lines.push(Line {
                label,
                begin,
                pieces: pieces.collect(),
            });
            begin = end;
        }
    }
    Lines { seconds, lines }
}

/// What all names begin with, up to their last hyphen: it may be left out where there is no room.
fn common_prefix(names: &[String]) -> &str {
    let Some(first) = names.first() else {
        return "";
    };
    let mut prefix = first.rfind('-').map_or("", |at| &first[..=at]);
    while !names.iter().all(|name| name.starts_with(prefix)) {
        let shorter = prefix.trim_end_matches('-').rfind('-');
        prefix = shorter.map_or("", |at| &prefix[..=at]);
    }
    prefix
}

fn draw_piece(svg: &mut Svg, time: &Scale, y: f64, piece: &Piece, names: &[String], prefix: &str) {
    let (x, end) = (time.at(piece.start), time.at(piece.end));
    // A hair of paper between neighbours, as long as that leaves most of the segment.
    let width = (end - x - 0.6).max(0.6 * (end - x));
    let Span { start, end, .. } = piece.span;
    let name = piece.group.map_or("unclustered", |g| names[g].as_str());
    let tooltip = format!("{name}, {start:.2} to {end:.2} s");
    let Some(group) = piece.group else {
        let attributes = "class=\"noise\" fill-opacity=\"0.45\"";
        svg.rectangle(attributes, [x, y], [width, STRIP], &tooltip);
        return;
    };
    let fill = format!("fill=\"{}\"", colour(group));
    svg.rectangle(&fill, [x, y], [width, STRIP], &tooltip);
    let short = name.strip_prefix(prefix).unwrap_or(name);
    let fits = |text: &&str| text_width(text, SMALL.size) + 3.0 <= width;
    if let Some(text) = [name, short].into_iter().find(fits) {
        let class = if text_on(group) == "#fff" {
            "on-dark"
        } else {
            "on-light"
        };
        let look = Type { class, ..SMALL };
        svg.text(x + 0.5 * width, y + 13.0, Anchor::Middle, look, text);
    }
}

/// Brackets each run of segments of the same behavior, and names it where there is room.
fn draw_behaviors(svg: &mut Svg, time: &Scale, y: f64, pieces: &[Piece]) {
    for run in pieces.chunk_by(|a, b| a.span.behavior == b.span.behavior) {
        let [first, ..] = run else { continue };
        let (Some(name), Some(last)) = (&first.span.behavior, run.last()) else {
            continue;
        };
        let (x, end) = (time.at(first.start) + 0.8, time.at(last.end) - 1.4);
        svg.polyline(
            "class=\"axis\"",
            &[[x, y], [x, y + 3.0], [end, y + 3.0], [end, y]],
        );
        let short = name
            .rsplit_once('-')
            .map_or(name.as_str(), |(_, tail)| tail);
        let fits = |text: &&str| text_width(text, SMALL.size) + 2.0 <= end - x;
        if let Some(text) = [name.as_str(), short].into_iter().find(fits) {
            svg.text(0.5 * (x + end), y + 13.0, Anchor::Middle, SMALL, text);
        }
    }
}

fn draw_legend(svg: &mut Svg, top: f64, rows: &[(&str, Vec<&Span>)], names: &[String]) -> f64 {
    let mut used = vec![false; names.len()];
    for span in rows.iter().flat_map(|(_, spans)| spans) {
        if let Some(seen) = span.group.and_then(|g| used.get_mut(g)) {
            *seen = true;
        }
    }
    let column = (WIDTH - 2.0 * MARGIN) / LEGEND_COLUMNS as f64;
    let entries: Vec<usize> = (0..names.len()).filter(|g| used[*g]).collect();
    let in_column = entries.len().div_ceil(LEGEND_COLUMNS).max(1);
    for (i, &group) in entries.iter().enumerate() {
        let x = MARGIN + (i / in_column) as f64 * column;
        let y = top + 14.0 + (i % in_column) as f64 * 18.0;
        svg.rectangle(
            &format!("fill=\"{}\"", colour(group)),
            [x, y - 9.0],
            [14.0, 10.0],
            "",
        );
        let name = fitted(&names[group], LABEL.size, column - 26.0);
        svg.text(x + 20.0, y, Anchor::Start, LABEL, &name);
    }
    let bottom = top + 14.0 + in_column as f64 * 18.0;
    if entries.len() <= COLOURS {
        return bottom;
    }
    let remark = format!(
        "Colours repeat after {COLOURS} groups: a segment under the pointer tells its name."
    );
    svg.text(MARGIN, bottom, Anchor::Start, SMALL, &remark);
    bottom + 18.0
}

#[cfg(test)]
mod tests {
    use super::common_prefix;

    #[test]
    fn names_share_what_stands_before_a_hyphen() {
        for (names, expected) in [
            (vec!["group-01", "group-02"], "group-"),
            (vec!["arm-wave-a", "arm-punch-b"], "arm-"),
            (vec!["jab", "hook"], ""),
            (vec!["group-01", "wave"], ""),
            (vec![], ""),
        ] {
            let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
            assert_eq!(common_prefix(&names), expected, "{names:?}");
        }
    }
}
