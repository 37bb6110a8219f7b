//! Aligned columns for people.

/// Which side a column's cells stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A table with a header, columns two spaces apart, no space at the ends of lines.
pub fn aligned(header: &[(&str, Side)], rows: &[Vec<String>]) -> String {
    let width = |text: &str| text.chars().count();
    let widths: Vec<usize> = header
        .iter()
        .enumerate()
        .map(|(i, (name, _))| {
            let cells = rows.iter().filter_map(|row| row.get(i)).map(|c| width(c));
            cells.max().unwrap_or(0).max(width(name))
        })
        .collect();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let mut line = String::new();
        for ((cell, (_, side)), wide) in cells.zip(header).zip(&widths) {
            let gap = " ".repeat(wide - width(cell).min(*wide));
            match side {
                Side::Left => line.extend([cell, &gap, "  "]),
                Side::Right => line.extend([&gap, cell, "  "]),
            }
        }
        format!("{}\n", line.trim_end())
    };
    let mut text = line(&mut header.iter().map(|(name, _)| *name));
    for row in rows {
        text.push_str(&line(&mut row.iter().map(String::as_str)));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Side, aligned};

    #[test]
    fn words_stand_left_and_numbers_right() {
        let header = [("name", Side::Left), ("n", Side::Right)];
        let rows = [
            vec!["gehen".to_string(), "7".to_string()],
            vec!["läuft".to_string(), "120".to_string()],
        ];
        let wanted = "name     n\ngehen    7\nläuft  120\n";
        assert_eq!(aligned(&header, &rows), wanted);
    }
}
