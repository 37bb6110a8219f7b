//! Tables of a page.

use crate::svg::escape;

/// A table with its caption.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// What it shows and how to read it: plain text.
    pub caption: String,
    /// The columns' heads.
    pub header: Vec<String>,
    /// The rows, a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The table as HTML. Columns in which every cell is a number stand right.
    pub fn html(&self) -> String {
        let numbers: Vec<bool> = (0..self.header.len())
            .map(|c| {
                let mut cells = self.rows.iter().filter_map(|row| row.get(c)).peekable();
                cells.peek().is_some() && cells.all(|cell| is_number(cell))
            })
            .collect();
        let cell = |tag: &str, c: usize, text: &str| {
            let class = if numbers.get(c) == Some(&true) {
                " class=\"number\""
            } else {
                ""
            };
            format!("<{tag}{class}>{}</{}>", escape(text), &tag[..2])
        };
        let mut html =
            "<figure class=\"table\">\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table\"><table>\n<thead><tr>"
                .to_owned();
        for (c, head) in self.header.iter().enumerate() {
            html.push_str(&cell("th scope=\"col\"", c, head));
        }
        html.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            html.push_str("<tr>");
            for (c, text) in row.iter().enumerate() {
                html.push_str(&cell("td", c, text));
            }
            html.push_str("</tr>\n");
        }
        html.push_str(&format!(
            "</tbody>\n</table></div>\n<figcaption>{}</figcaption>\n</figure>\n",
            escape(&self.caption)
        ));
        html
    }
}

/// A number, perhaps with a unit sign, or a dash for none.
fn is_number(cell: &str) -> bool {
    let cell = cell.trim();
    let bare = cell.trim_end_matches([' ', '%', 's', '°']);
    matches!(cell, "" | "-" | "–") || bare.replace('−', "-").parse::<f64>().is_ok()
}
