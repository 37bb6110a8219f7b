//! Which group follows which.

use crate::svg::{Anchor, LABEL, MARGIN, SMALL, Svg, Type, fitted, nothing, text_width};

const GROUPS: usize = 60;
const CELLS: f64 = 620.0;

/// The transition model as a heat map: a row for each group that was left, a column for each that followed.
///
/// A cell is as dark as the share of its row's transitions (rows sum to one), and carries the count where there is
/// room. `counts[from][to]`; what is missing, negative or not finite counts as zero. Of more than 60 groups those
/// with the most transitions are shown, and the shares are still of all transitions.
pub fn transitions(names: &[String], counts: &[Vec<f64>]) -> String {
    const TITLE: &str = "Transitions between groups";
    let count = |from: usize, to: usize| -> f64 {
        let value = counts
            .get(from)
            .and_then(|row| row.get(to))
            .copied()
            .unwrap_or(0.0);
        if value.is_finite() {
            value.max(0.0)
        } else {
            0.0
        }
    };
    let n = names.len();
    let left_at: Vec<f64> = (0..n).map(|i| (0..n).map(|j| count(i, j)).sum()).collect();
    let entered: Vec<f64> = (0..n).map(|j| (0..n).map(|i| count(i, j)).sum()).collect();
    if left_at.iter().sum::<f64>() == 0.0 {
        return nothing(TITLE, "No segment follows another.");
    }
    let mut shown: Vec<usize> = (0..n).collect();
    let traffic = |i: usize| left_at[i] + entered[i];
    shown.sort_by(|a, b| traffic(*b).total_cmp(&traffic(*a)).then(a.cmp(b)));
    shown.truncate(GROUPS);
    shown.sort_unstable();

    let cell = (CELLS / shown.len() as f64).clamp(10.0, 34.0);
    let look = Type {
        size: (cell * 0.92).min(LABEL.size),
        ..LABEL
    };
    let widest = shown
        .iter()
        .map(|i| text_width(&names[*i], look.size))
        .fold(0.0, f64::max);
    let name_room = (widest + 10.0).clamp(40.0, 190.0);
    let (left, top) = (MARGIN + name_room + 18.0, 48.0 + 0.9 * name_room);
    let side = cell * shown.len() as f64;
    // Close columns leave no room for names that lean.
    let lean = if cell < 16.0 { -90.0 } else { -60.0 };
    // Names of columns lean to the right: the last one needs room, too.
    let width = (left + side + 0.72 * name_room + MARGIN).max(420.0);
    let mut svg = Svg::new(width, 0.0, TITLE);
    svg.rectangle("class=\"panel\"", [left, top], [side, side], "");
    for (k, &i) in shown.iter().enumerate() {
        let name = fitted(&names[i], look.size, name_room - 6.0);
        let along = k as f64 * cell + 0.5 * cell;
        svg.text(
            left - 6.0,
            top + along + 0.35 * look.size,
            Anchor::End,
            look,
            &name,
        );
        let x = left + along + 0.35 * look.size;
        svg.text_turned(x, top - 6.0, Anchor::Start, look, lean, &name);
        if k % 5 == 0 && shown.len() > 12 {
            let edge = k as f64 * cell;
            svg.line("grid", [left, top + edge], [left + side, top + edge]);
            svg.line("grid", [left + edge, top], [left + edge, top + side]);
        }
    }
    for (row, &from) in shown.iter().enumerate() {
        for (column, &to) in shown.iter().enumerate() {
            let value = count(from, to);
            if value > 0.0 {
                let place = [left + column as f64 * cell, top + row as f64 * cell];
                let tooltip = format!(
                    "{} \u{2192} {}: {value}, {:.0} % of its row",
                    names[from],
                    names[to],
                    100.0 * value / left_at[from]
                );
                draw_cell(
                    &mut svg,
                    place,
                    cell,
                    value,
                    value / left_at[from],
                    &tooltip,
                );
            }
        }
    }
    svg.rectangle("class=\"frame\"", [left, top], [side, side], "");
    let middle = top + 0.5 * side;
    svg.text_turned(MARGIN + 2.0, middle, Anchor::Middle, SMALL, -90.0, "from");
    svg.text(left - 6.0, top - 8.0, Anchor::End, SMALL, "to \u{2192}");
    let bottom = draw_key(&mut svg, [left, top + side + 22.0], n, shown.len());
    svg.finish(Some(bottom))
}

fn draw_cell(svg: &mut Svg, [x, y]: [f64; 2], cell: f64, value: f64, share: f64, tooltip: &str) {
    // The least share is still seen.
    let strength = 0.12 + 0.88 * share;
    let gap = if cell > 16.0 { 1.0 } else { 0.4 };
    let fill = format!("class=\"heat\" fill-opacity=\"{strength:.2}\"");
    svg.rectangle(
        &fill,
        [x + gap, y + gap],
        [cell - 2.0 * gap, cell - 2.0 * gap],
        tooltip,
    );
    let text = format!("{}", (value * 10.0).round() / 10.0);
    let size = (0.42 * cell).min(SMALL.size);
    if size >= 8.0 && text_width(&text, size) <= cell - 4.0 {
        let class = if strength > 0.6 { "on-heat" } else { "ink" };
        let look = Type {
            class,
            size,
            bold: false,
        };
        svg.text(
            x + 0.5 * cell,
            y + 0.5 * cell + 0.36 * size,
            Anchor::Middle,
            look,
            &text,
        );
    }
}

fn draw_key(svg: &mut Svg, [left, top]: [f64; 2], all: usize, shown: usize) -> f64 {
    svg.text(left, top + 11.0, Anchor::Start, SMALL, "share of the row");
    for step in 0..=4 {
        let share = f64::from(step) / 4.0;
        let x = left + 100.0 + f64::from(step) * 34.0;
        let fill = format!("class=\"heat\" fill-opacity=\"{:.2}\"", 0.12 + 0.88 * share);
        svg.rectangle(&fill, [x, top], [32.0, 13.0], "");
        let label = format!("{:.0} %", 100.0 * share);
        svg.text(x + 16.0, top + 27.0, Anchor::Middle, SMALL, &label);
    }
    if all > shown {
        let remark = format!("The {shown} groups with the most transitions, of {all}.");
        svg.text(left, top + 48.0, Anchor::Start, SMALL, &remark);
        return top + 60.0;
    }
    top + 42.0
}
