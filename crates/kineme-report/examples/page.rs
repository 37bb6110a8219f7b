//! Writes a page of made-up movement to the file given: what the viewer's tests look at.

#[path = "../tests/made_up/scene.rs"]
mod scene;

use kineme_report::{Page, Section, Table};

fn main() -> std::io::Result<()> {
    let file = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "page.html".into());
    let page = Page {
        title: "A made-up page".into(),
        summary: vec!["Everything here is made up, to try the viewer.".into()],
        scene: scene::scene(),
        sections: vec![
            Section {
                title: "Primitives".into(),
                cards: 0..2,
                ..Section::default()
            },
            Section {
                title: "Numbers".into(),
                tables: vec![Table {
                    caption: "Numbers that mean nothing.".into(),
                    header: vec!["what".into(), "value".into()],
                    rows: vec![
                        vec!["first".into(), "1.25".into()],
                        vec!["second".into(), "-".into()],
                    ],
                }],
                ..Section::default()
            },
        ],
    };
    std::fs::write(file, page.html())
}
