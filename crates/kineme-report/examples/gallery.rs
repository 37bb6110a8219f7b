//! Writes every figure, on made-up results of three sizes, and the page with them: to look at after a change.
//!
//! `cargo run -p kineme-report --example gallery -- target/gallery`

#[path = "../tests/made_up/mod.rs"]
mod made_up;

use std::path::PathBuf;

use kineme_report as report;

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args().nth(1).map(PathBuf::from) else {
        eprintln!("usage: gallery FOLDER");
        std::process::exit(2);
    };
    std::fs::create_dir_all(&folder)?;
    let residuals = [
        0.41, 0.19, 0.07, 0.045, 0.038, 0.035, 0.033, 0.032, 0.031, 0.031,
    ];
    for (size, groups, segments) in [("small", 5, 80), ("usual", 17, 600), ("large", 60, 3000)] {
        let made = made_up::made_up(groups, segments);
        let embedding = report::Embedding {
            points: &made.points,
            groups: &made.groups,
            names: &made.names,
            recordings: &made.recordings,
        };
        let figures = [
            ("embedding", report::embedding(&embedding)),
            ("hand-paths", report::hand_paths(&made.paths)),
            ("timeline", report::timeline(&made.rows, &made.names)),
            (
                "transitions",
                report::transitions(&made.names, &made.transitions),
            ),
            ("residual", report::residual_variance(&residuals, 3)),
        ];
        let mut shown = Vec::new();
        for (name, svg) in figures {
            std::fs::write(folder.join(format!("{size}-{name}.svg")), &svg)?;
            let caption =
                format!("The figure `{name}` on {segments} made-up segments in {groups} groups.");
            shown.push(report::Figure {
                title: name.to_owned(),
                caption,
                svg,
            });
        }
        let summary = [
            format!("{segments} segments fall into {groups} groups; one in nine belongs to none."),
            "Everything here is made up, to look at the figures.".to_owned(),
        ];
        let page = report::Page {
            title: format!("A {size} vocabulary"),
            summary: summary.to_vec(),
            sections: vec![report::Section {
                title: "Figures".to_owned(),
                figures: shown,
                ..report::Section::default()
            }],
            ..report::Page::default()
        };
        std::fs::write(folder.join(format!("{size}.html")), page.html())?;
    }
    Ok(())
}
