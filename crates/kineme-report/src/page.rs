//! One page of HTML: movement in three dimensions, figures and tables. Opens from a file, offline.

use std::io::Write as _;
use std::ops::Range;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

use crate::names::short_names;
use crate::palette::{COLOURS, colour};
use crate::scene::{Card, Excerpt, Scene};
use crate::strip::strip;
use crate::svg::escape;
use crate::table::Table;
use crate::viewer::{HOW_TO_BUILD, viewer};

/// A figure on the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// What to call it where it cannot be seen.
    pub title: String,
    /// What it shows and how to read it: plain text.
    pub caption: String,
    /// The figure, as the functions of this crate give it; put in as it is.
    pub svg: String,
}

/// What a page shows, from top to bottom.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// Paragraphs of plain text, above what is on the stage.
    pub summary: Vec<String>,
    /// What moves: takes on the stage, primitives in the sections.
    pub scene: Scene,
    /// What stands below the stage.
    pub sections: Vec<Section>,
}

/// A part of a page under a heading of its own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Paragraphs of plain text.
    pub text: Vec<String>,
    /// Which of the scene's primitives have their cards here.
    pub cards: Range<usize>,
    /// Lists that are opened by who wants them, such as what is in no primitive.
    pub listings: Vec<Listing>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Still figures.
    pub figures: Vec<Figure>,
}

/// Excerpts of motions under a heading, which play on the stage where it has them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Listing {
    /// What they are.
    pub title: String,
    /// Which.
    pub excerpts: Vec<Excerpt>,
}

const STYLE: &str = include_str!("page.css");
/// Nothing is loaded from anywhere, whatever the data say.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";
/// Postures in the strip of a primitive.
const POSTURES: usize = 9;
/// Cards that are seen at a glance; more have an index.
const AT_A_GLANCE: usize = 6;

impl Page {
    /// The page. Nothing is loaded from elsewhere: styles, figures, data and, where it was built, the viewer are in it.
    /// Without the viewer it has still pictures and says what would make them move.
    pub fn html(&self) -> String {
        self.html_with(viewer())
    }

    fn html_with(&self, viewer: Option<(&str, &str)>) -> String {
        let title = escape(&self.title);
        let moving = viewer.filter(|_| !self.scene.is_empty());
        let more_style = moving.map_or("", |(_, style)| style);
        let mut html = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{title}</title>\n<style>\n{STYLE}{more_style}</style>\n</head>\n<body>\n<main>\n\
             <header>\n<h1>{title}</h1>\n{}{}</header>\n",
            self.contents(),
            paragraphs(&self.summary)
        );
        if !self.scene.is_empty() {
            html.push_str(&self.stage(moving.is_some()));
        }
        for (i, section) in self.sections.iter().enumerate() {
            html.push_str(&self.section(i, section));
        }
        html.push_str("</main>\n");
        if let Some((script, _)) = moving {
            html.push_str(&format!(
                "<script type=\"application/gzip;base64\" id=\"scene\">{}</script>\n<script>\n{script}</script>\n",
                data(&self.scene)
            ));
        }
        html.push_str("</body>\n</html>\n");
        html
    }

    /// Where the viewer puts the stage, or why there is none.
    fn stage(&self, built: bool) -> String {
        let mut html = String::new();
        if built {
            html.push_str(
                "<noscript><p class=\"notice\">The bodies on this page move by a script, which this browser does \
                 not run.</p></noscript>\n",
            );
        } else {
            html.push_str(&format!(
                "<p class=\"notice\">Still pictures only: the viewer was not built into this program. <code>{HOW_TO_BUILD}\
                 </code> builds it (node is needed), and the next build of kineme puts it into its pages.</p>\n"
            ));
        }
        if built && !self.scene.takes.is_empty() {
            html.push_str(
                "<section id=\"stage\" aria-label=\"Movement in three dimensions\"></section>\n",
            );
        }
        html
    }

    /// Where to find what, where there is enough to be lost in.
    fn contents(&self) -> String {
        if self.sections.len() < 2 {
            return String::new();
        }
        let link = |(i, section): (usize, &Section)| {
            format!("<a href=\"#section-{i}\">{}</a>\n", escape(&section.title))
        };
        let links: String = self.sections.iter().enumerate().map(link).collect();
        format!("<nav aria-label=\"On this page\">\n{links}</nav>\n")
    }

    fn section(&self, number: usize, section: &Section) -> String {
        let title = escape(&section.title);
        let mut html = format!(
            "<section id=\"section-{number}\" aria-label=\"{title}\">\n<h2>{title}</h2>\n{}",
            paragraphs(&section.text)
        );
        let cards = self.scene.primitives.get(section.cards.clone());
        if let Some(cards) = cards.filter(|cards| !cards.is_empty()) {
            if cards.len() > AT_A_GLANCE {
                html.push_str(&index(section.cards.clone().zip(cards), &title));
            }
            html.push_str("<div class=\"cards\">\n");
            for (i, card) in section.cards.clone().zip(cards) {
                html.push_str(&self.card(i, card));
            }
            html.push_str("</div>\n");
        }
        html.extend(
            section
                .listings
                .iter()
                .map(|l| listing(&l.title, &l.excerpts)),
        );
        html.extend(section.tables.iter().map(Table::html));
        html.extend(section.figures.iter().map(Figure::html));
        html.push_str("</section>\n");
        html
    }

    /// A primitive as it is seen without the viewer, which puts what moves into its card: in the middle of its
    /// parameters, phase by phase.
    fn card(&self, number: usize, card: &Card) -> String {
        let name = escape(&card.name);
        let mut html = format!(
            "<article class=\"card\" id=\"primitive-{number}\" data-card=\"{number}\" style=\"--hue:{}\">\n\
             <div class=\"head\"><h3>{name}</h3></div>\n",
            colour(card.colour)
        );
        if !card.doubt.is_empty() {
            html.push_str(&format!("<p class=\"doubt\">{}</p>\n", escape(&card.doubt)));
        }
        if let Some(body) = self.scene.bodies.get(card.body) {
            let node = middle(card);
            let last = card.phases.saturating_sub(1);
            let row = |i: usize| node * card.phases + i * last / (POSTURES - 1);
            let rows: Vec<usize> = (0..POSTURES).map(row).collect();
            let title = format!("{}: postures from its beginning to its end", card.name);
            let strip = strip(&title, body, &card.lattice, &rows, &colour(card.colour));
            html.push_str(&format!("<div class=\"strip\">\n{strip}</div>\n"));
        }
        html.push_str("<dl>");
        for [name, value] in &card.facts {
            html.push_str(&format!(
                "<div><dt>{}</dt><dd>{}</dd></div>",
                escape(name),
                escape(value)
            ));
        }
        html.push_str("</dl>\n");
        if !card.sources.is_empty() {
            let n = card.sources.len();
            let title = format!(
                "Where {} from",
                if n == 1 { "it comes" } else { "they come" }
            );
            html.push_str(&listing(&title, &card.sources));
        }
        html.push_str("</article>\n");
        html
    }
}

impl Figure {
    fn html(&self) -> String {
        let (title, caption) = (escape(&self.title), escape(&self.caption));
        format!(
            "<figure aria-label=\"{title}\">\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" \
             aria-label=\"{title}\">\n{}</div>\n<figcaption>{caption}</figcaption>\n</figure>\n",
            self.svg
        )
    }
}

fn paragraphs(texts: &[String]) -> String {
    let paragraph = |text: &String| format!("<p>{}</p>\n", escape(text));
    texts.iter().map(paragraph).collect()
}

/// A list of excerpts that is opened by who wants it. What the stage shows is a link that plays it there.
fn listing(title: &str, excerpts: &[Excerpt]) -> String {
    let names: Vec<&str> = excerpts.iter().map(|e| e.motion.as_str()).collect();
    let mut html = format!(
        "<details class=\"listing\">\n<summary>{}</summary>\n<ol>\n",
        escape(title)
    );
    for (excerpt, short) in excerpts.iter().zip(short_names(&names)) {
        let Excerpt {
            start, end, take, ..
        } = excerpt;
        let text = format!(
            "{} <small>{start:.2}\u{2013}{end:.2} s</small>",
            escape(&short)
        );
        let name = escape(&excerpt.motion);
        html.push_str(&match take {
            Some(take) => format!(
                "<li><a href=\"#stage\" data-take=\"{take}\" data-secs=\"{start:.3}\" title=\"{name}\">{text}</a></li>\n"
            ),
            None => format!("<li title=\"{name}\">{text}</li>\n"),
        });
    }
    html.push_str("</ol>\n</details>\n");
    html
}

/// Links to the cards of a section.
fn index<'a>(cards: impl Iterator<Item = (usize, &'a Card)>, title: &str) -> String {
    let link = |(number, card): (usize, &Card)| {
        format!(
            "<a href=\"#primitive-{number}\" style=\"--hue:{}\"{}>{}</a>\n",
            colour(card.colour),
            if card.doubt.is_empty() {
                ""
            } else {
                " class=\"doubted\""
            },
            escape(&card.name)
        )
    };
    let links: String = cards.map(link).collect();
    format!("<nav class=\"index\" aria-label=\"{title}\">\n{links}</nav>\n")
}

/// The node of the grid nearest to where the sliders begin.
fn middle(card: &Card) -> usize {
    card.axes.iter().fold(0, |node, axis| {
        let share = ((axis.start - axis.low) / (axis.high - axis.low)).clamp(0.0, 1.0);
        let last = axis.nodes.saturating_sub(1);
        node * axis.nodes + (share * last as f64).round() as usize
    })
}

/// The scene with the colours that its numbers mean.
#[derive(Serialize)]
struct Data<'a> {
    palette: Vec<String>,
    #[serde(flatten)]
    scene: &'a Scene,
}

/// The scene as JSON, packed, in letters that may stand in a script element: none can end it.
fn data(scene: &Scene) -> String {
    let data = Data {
        palette: (0..COLOURS).map(colour).collect(),
        scene,
    };
    // Plain structs of numbers and text always become JSON, and writing to memory does not fail.
    let json = serde_json::to_vec(&data).unwrap_or_default();
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    let written = packed.write_all(&json).and_then(|()| packed.finish());
    STANDARD.encode(written.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use flate2::read::GzDecoder;

    use super::*;
    use crate::scene::{Actor, Body, Bone, Places, Take};

    const SCRIPT: &str = "console.log('moved')";

    fn page() -> Page {
        let body = Body {
            name: "stick".into(),
            points: 2,
            bones: vec![Bone {
                ends: [0, 1],
                radii: [0.1, 0.1],
            }],
            ..Body::default()
        };
        let actor = Actor {
            name: "</script><script>alert(1)</script>".into(),
            rate_hz: 30.0,
            frames: Places::pack(&[vec![[0.0; 3], [0.0, 0.0, 1.0]]]),
            ..Actor::default()
        };
        Page {
            title: "</title><b>".into(),
            scene: Scene {
                bodies: vec![body],
                takes: vec![Take {
                    name: "<!--".into(),
                    actors: vec![actor],
                    ..Take::default()
                }],
                vocabulary: String::new(),
                primitives: vec![Card {
                    name: "<jab>".into(),
                    phases: 2,
                    lattice: Places::pack(&[
                        vec![[0.0; 3], [0.0, 0.0, 1.0]],
                        vec![[0.0; 3], [0.0, 1.0, 0.0]],
                    ]),
                    ..Card::default()
                }],
            },
            sections: vec![Section {
                title: "<!-- primitives".into(),
                cards: 0..1,
                ..Section::default()
            }],
            summary: Vec::new(),
        }
    }

    #[test]
    fn no_name_ends_an_element() {
        let html = page().html_with(Some((SCRIPT, "")));
        assert_eq!(html.matches("<script").count(), 2, "data and viewer");
        assert_eq!(html.matches("</script>").count(), 2);
        assert_eq!(html.matches("</title>").count(), 1);
        assert!(!html.contains("<!--") && !html.contains("<jab>"));
    }

    #[test]
    fn the_data_are_the_scene() {
        let page = page();
        let html = page.html_with(Some((SCRIPT, "")));
        let (_, rest) = html.split_once("id=\"scene\">").expect("data");
        let (json, _) = rest.split_once("</script>").expect("its end");
        let packed = STANDARD.decode(json).expect("base64");
        let json = std::io::read_to_string(GzDecoder::new(packed.as_slice())).expect("gzip");
        let read: Scene = serde_json::from_str(&json).expect("JSON");
        assert_eq!(read, page.scene);
        assert!(json.contains("\"palette\":[\"#0072b2\""));
    }

    #[test]
    fn without_the_viewer_the_page_says_so_and_has_still_pictures() {
        let html = page().html_with(None);
        assert!(html.contains(HOW_TO_BUILD) && html.contains("class=\"strip\""));
        assert!(!html.contains("<script") && !html.contains("id=\"stage\""));
    }

    #[test]
    fn a_page_without_movement_needs_no_viewer() {
        let html = Page::default().html_with(Some((SCRIPT, "")));
        assert!(!html.contains("<script") && !html.contains(HOW_TO_BUILD));
    }
}
