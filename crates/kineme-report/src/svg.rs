//! A drawing that grows mark by mark: escaping, numbers, text, and the colours of light and dark.

use std::fmt::Write as _;

/// Colours by role. Plain attributes would fix them; classes let the reader's setting choose, and a viewer
/// that does not know the question shows the light ones.
const STYLE: &str = "\
svg.kineme{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif;font-variant-numeric:tabular-nums}\
.kineme .paper{fill:#fff}.kineme .ink{fill:#22262b}.kineme .soft{fill:#5f6872}\
.kineme .panel{fill:#f6f7f8}.kineme .frame{fill:none;stroke:#8a929b;stroke-width:1}\
.kineme .grid{fill:none;stroke:#dde1e5;stroke-width:1}.kineme .axis{fill:none;stroke:#5f6872;stroke-width:1}\
.kineme .noise{fill:#a7aeb6}.kineme .chain{fill:none;stroke:#5f6872;stroke-width:.7}\
.kineme .halo{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}\
.kineme .right{stroke:#17365c}.kineme .left{stroke:#e08e2b}.kineme .right-end{fill:#17365c}.kineme .left-end{fill:#e08e2b}\
.kineme .on-dark{fill:#fff}.kineme .on-light{fill:#000}.kineme .on-heat{fill:#fff}\
.kineme .heat{fill:#0072b2}.kineme .accent{fill:#d55e00}.kineme .accent-line{fill:none;stroke:#d55e00}\
@media (prefers-color-scheme:dark){\
.kineme .paper{fill:#15181c}.kineme .ink{fill:#e4e7ea}.kineme .soft{fill:#a0a8b1}\
.kineme .panel{fill:#1c2025}.kineme .frame{stroke:#6b747e}\
.kineme .grid{stroke:#2c3239}.kineme .axis{stroke:#8a929b}\
.kineme .noise{fill:#6b747e}.kineme .chain{stroke:#a0a8b1}\
.kineme .halo{stroke:#15181c}\
.kineme .on-heat{fill:#000}.kineme .right{stroke:#cfe2fa}.kineme .left{stroke:#b8701c}.kineme .right-end{fill:#cfe2fa}.kineme .left-end{fill:#b8701c}\
.kineme .heat{fill:#3fa0dc}.kineme .accent{fill:#f0803c}.kineme .accent-line{stroke:#f0803c}}";

/// Where a text stands to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks: class for its colour, size in pixels, whether it is bold.
#[derive(Debug, Clone, Copy)]
pub struct Type {
    pub class: &'static str,
    pub size: f64,
    pub bold: bool,
}

/// The figure's title.
pub const TITLE: Type = Type {
    class: "ink",
    size: 15.0,
    bold: true,
};
/// The title of a panel.
pub const HEAD: Type = Type {
    class: "ink",
    size: 12.0,
    bold: true,
};
/// Names in legends and on rows.
pub const LABEL: Type = Type {
    class: "ink",
    size: 11.0,
    bold: false,
};
/// Numbers at axes, and remarks.
pub const SMALL: Type = Type {
    class: "soft",
    size: 10.5,
    bold: false,
};

/// An SVG in the making; lengths in pixels, y downward.
#[derive(Debug, Clone)]
pub struct Svg {
    width: f64,
    height: f64,
    title: String,
    body: String,
}

impl Svg {
    /// A drawing of this size. The title is what a screen reader says, and the heading at its top left.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let mut svg = Self {
            width,
            height,
            title: escape(title),
            body: String::new(),
        };
        svg.text(MARGIN, 26.0, Anchor::Start, TITLE, title);
        svg
    }

    /// The whole text. The height may have become known only now.
    pub fn finish(self, height: Option<f64>) -> String {
        let (w, h) = (number(self.width), number(height.unwrap_or(self.height)));
        let label = match self.title.as_str() {
            "" => "A figure without a title",
            title => title,
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"kineme\" role=\"img\" aria-label=\"{}\" \
             width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\">\n<style>{STYLE}</style>\n\
             <rect class=\"paper\" width=\"{w}\" height=\"{h}\"/>\n{}</svg>\n",
            label, self.body
        )
    }

    /// Opens a group of marks with these attributes (already escaped), and a tooltip if it is not empty.
    pub fn open(&mut self, attributes: &str, tooltip: &str) {
        let _ = write!(self.body, "<g {attributes}>");
        if !tooltip.is_empty() {
            let _ = write!(self.body, "<title>{}</title>", escape(tooltip));
        }
        self.body.push('\n');
    }

    /// Closes the group opened last.
    pub fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// A text at its baseline.
    pub fn text(&mut self, x: f64, y: f64, anchor: Anchor, look: Type, text: &str) {
        self.text_turned(x, y, anchor, look, 0.0, text);
    }

    /// A text turned about its point, degrees clockwise.
    pub fn text_turned(
        &mut self,
        x: f64,
        y: f64,
        anchor: Anchor,
        look: Type,
        turn: f64,
        text: &str,
    ) {
        let (x, y) = (number(x), number(y));
        let Type { class, size, bold } = look;
        let _ = write!(
            self.body,
            "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" font-size=\"{}\"",
            number(size)
        );
        match anchor {
            Anchor::Start => {}
            Anchor::Middle => self.body.push_str(" text-anchor=\"middle\""),
            Anchor::End => self.body.push_str(" text-anchor=\"end\""),
        }
        if bold {
            self.body.push_str(" font-weight=\"600\"");
        }
        if turn != 0.0 {
            let _ = write!(self.body, " transform=\"rotate({} {x} {y})\"", number(turn));
        }
        let _ = writeln!(self.body, ">{}</text>", escape(text));
    }

    /// A straight line.
    pub fn line(&mut self, class: &str, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
        let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(number);
        let _ = writeln!(
            self.body,
            "<line class=\"{class}\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>"
        );
    }

    /// A line through points; fewer than two draw nothing.
    pub fn polyline(&mut self, attributes: &str, points: &[[f64; 2]]) {
        if points.len() < 2 {
            return;
        }
        let _ = write!(self.body, "<polyline {attributes} points=\"");
        for (i, [x, y]) in points.iter().enumerate() {
            let space = if i == 0 { "" } else { " " };
            let _ = write!(self.body, "{space}{},{}", tenth(*x), tenth(*y));
        }
        self.body.push_str("\"/>\n");
    }

    /// A rectangle; its tooltip is left out where empty.
    pub fn rectangle(
        &mut self,
        attributes: &str,
        [x, y]: [f64; 2],
        [w, h]: [f64; 2],
        tooltip: &str,
    ) {
        let [x, y, w, h] = [x, y, w.max(0.0), h.max(0.0)].map(number);
        let _ = write!(
            self.body,
            "<rect {attributes} x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\""
        );
        self.end_with_tooltip("rect", tooltip);
    }

    /// A disc.
    pub fn disc(&mut self, attributes: &str, [x, y]: [f64; 2], radius: f64) {
        let [x, y, r] = [x, y, radius].map(number);
        let _ = writeln!(
            self.body,
            "<circle {attributes} cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>"
        );
    }

    /// A path of given data.
    pub fn path(&mut self, attributes: &str, data: &str) {
        let _ = writeln!(self.body, "<path {attributes} d=\"{data}\"/>");
    }

    fn end_with_tooltip(&mut self, element: &str, tooltip: &str) {
        if tooltip.is_empty() {
            self.body.push_str("/>\n");
        } else {
            let _ = writeln!(self.body, "><title>{}</title></{element}>", escape(tooltip));
        }
    }
}

/// Space left free at the edges, pixels.
pub const MARGIN: f64 = 20.0;

/// A figure without data: its title and one line that says why it is empty.
pub fn nothing(title: &str, why: &str) -> String {
    let mut svg = Svg::new(480.0, 72.0, title);
    svg.text(MARGIN, 50.0, Anchor::Start, LABEL, why);
    svg.finish(None)
}

/// Text as XML content or attribute value. Signs that XML forbids become U+FFFD.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A length with at most two decimals, without a tail of zeros or a negative zero.
pub fn number(value: f64) -> String {
    trimmed(format!("{value:.2}"))
}

/// A length with at most one decimal: enough for the points of a path.
pub fn tenth(value: f64) -> String {
    trimmed(format!("{value:.1}"))
}

fn trimmed(text: String) -> String {
    let short = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if short == "-0" {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}

/// About how wide a text is, pixels: fonts differ, so this is a little generous.
pub fn text_width(text: &str, size: f64) -> f64 {
    let units: f64 =
        text.chars()
            .map(|c| match c {
                'i' | 'j' | 'l' | 't' | 'f' | 'r' | 'I' | '.' | ',' | ':' | ';' | '|' | '\''
                | ' ' => 0.34,
                'm' | 'w' | 'M' | 'W' | '@' => 0.92,
                'A'..='Z' => 0.70,
                c if c.is_ascii() => 0.59,
                _ => 1.0,
            })
            .sum();
    units * size
}

/// The text, shortened in its middle by an ellipsis until it is no wider than `width` pixels.
pub fn fitted(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let chars: Vec<char> = text.chars().collect();
    // What tells names apart stands at their ends: `group-01`, `walk/left`.
    (1..chars.len())
        .rev()
        .map(|kept| {
            let tail = kept / 2;
            let (head, end) = (&chars[..kept - tail], &chars[chars.len() - tail..]);
            head.iter()
                .chain(['…'].iter())
                .chain(end)
                .collect::<String>()
        })
        .find(|short| text_width(short, size) <= width)
        .unwrap_or_else(|| "…".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.001, "0"),
            (1.5, "1.5"),
            (100.0, "100"),
            (1.0 / 3.0, "0.33"),
        ] {
            assert_eq!(number(value), expected);
        }
    }

    #[test]
    fn a_fitted_text_keeps_its_ends_and_its_width() {
        assert_eq!(fitted("group-01", 10.0, 200.0), "group-01");
        let short = fitted("a-very-long-name-of-a-group-17", 10.0, 80.0);
        assert!(short.starts_with("a-") && short.ends_with("17"), "{short}");
        assert!(text_width(&short, 10.0) <= 80.0);
        assert_eq!(fitted("wide", 10.0, 0.0), "…");
    }
}
