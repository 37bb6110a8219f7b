//! Tidy on made-up trees: a good one has no remark, and each rule has a tree that breaks it alone.

use super::imports::paths;
use super::{Tree, inspect};

const TABLE: &str = "\
# Architecture

```text
9  report
7  formats
2  segmentation | embedding
1  skeleton <- motion   # a motion is of a skeleton
0  error <- math
```

```text
crates/kineme/src/lib.rs
crates/kineme/src/error.rs
crates/kineme/src/math/          rotations
crates/kineme/src/skeleton/
crates/kineme/src/motion/
crates/kineme/src/segmentation/
crates/formats/src/              readers
crates/report/src/
```
";

/// A project without fault; `embedding` stands on the table and is not built yet.
const GOOD: [(&str, &str); 16] = [
    ("Cargo.toml", "[workspace.package]\nversion = \"0.1.0\"\n"),
    ("ARCHITECTURE.md", TABLE),
    ("CHANGELOG.md", "# Changelog\n\n## 0.1.0 (unreleased)\n"),
    (
        "README.md",
        "See `docs/words.md`, [words](docs/words.md#pose), `crates/kineme/src/embedding/mod.rs` and `a/b`.\n",
    ),
    ("docs/words.md", "Back to [the front](../README.md).\n"),
    (
        "crates/kineme/src/lib.rs",
        "pub mod motion;\npub use motion::{Motion, recording::Recording};\n",
    ),
    (
        "crates/kineme/src/error.rs",
        "mod tests { use super::*; }\n",
    ),
    (
        "crates/kineme/src/math/mod.rs",
        "use crate::error::Error;\n",
    ),
    (
        "crates/kineme/src/skeleton/mod.rs",
        "use crate::math::rotation;\n",
    ),
    (
        "crates/kineme/src/motion/mod.rs",
        "use crate::{error::Error, skeleton::{Joint, Pose}};\n",
    ),
    (
        "crates/kineme/src/segmentation/centroid/bob.rs",
        "// use crate::embedding::X;\nconst A: &str = \"crate::embedding::X\";\nuse super::super::super::motion::Motion;\n",
    ),
    ("crates/kineme/Cargo.toml", "[package]\nname = \"kineme\"\n"),
    (
        "crates/formats/Cargo.toml",
        "[dependencies]\nkineme.workspace = true\n",
    ),
    (
        "crates/report/Cargo.toml",
        "[dev-dependencies]\nformats = { path = \"../formats\" }\n",
    ),
    ("crates/report/src/lib.rs", "fn f(kineme: u8) {}\n"),
    ("crates/formats/src/lib.rs", ""),
];

fn good() -> Tree {
    let own = |(path, text): (&str, &str)| (path.to_owned(), text.to_owned());
    Tree(GOOD.into_iter().map(own).collect())
}

/// Puts `text` at `path` of the good tree and expects exactly this one remark (or none, for `""`).
fn check(path: &str, text: &str, expected: &str) {
    let mut tree = good();
    tree.0.insert(path.to_owned(), text.to_owned());
    let found = inspect(&tree).violations;
    let expected: Vec<&str> = Some(expected)
        .filter(|e| !e.is_empty())
        .into_iter()
        .collect();
    assert_eq!(found, expected, "with {path}:\n{text}");
}

#[test]
fn a_good_tree_has_no_remark_but_names_what_is_not_built() {
    let findings = inspect(&good());
    assert_eq!(findings.violations, Vec::<String>::new());
    assert_eq!(
        findings.notes,
        ["on the table of floors and not built: embedding"]
    );
}

#[test]
fn an_import_goes_down_or_to_the_left_of_an_arrow() {
    let up = "crates/kineme/src/skeleton/mod.rs:1: `skeleton` imports upward from `segmentation`";
    let right = "crates/kineme/src/skeleton/mod.rs:1: `skeleton` imports sideways from `motion`";
    let file = "crates/kineme/src/skeleton/mod.rs";
    for (text, expected) in [
        ("use crate::segmentation::Cut;", up),
        ("use crate::{math::{self, spline}, segmentation as s};", up),
        ("fn f() { crate::segmentation::cut(); }", up),
        ("use super::segmentation::Cut;", up),
        ("use crate::motion::Motion;", right),
        ("use crate::Recording;", right),
        ("use crate::{error::Error, math};", ""),
        (
            "use crate::*;",
            "crates/kineme/src/skeleton/mod.rs:1: `crate::*` hides the room: name it",
        ),
    ] {
        check(file, text, expected);
    }
    check(
        "crates/kineme/src/segmentation/mod.rs",
        "\n\nuse crate::embedding::Graph;",
        "crates/kineme/src/segmentation/mod.rs:3: `segmentation` imports sideways from `embedding`",
    );
}

#[test]
fn the_core_touches_nothing_outside_the_computation() {
    for (text, name) in [
        ("use std::{fmt, fs::File};", "std::fs"),
        (
            "fn f() { std::time::Instant::now(); }",
            "std::time::Instant",
        ),
        ("use rand::rng;", "rand::rng"),
    ] {
        let file = "crates/kineme/src/math/mod.rs";
        check(
            file,
            text,
            &format!("{file}:1: the core crate knows no `{name}`"),
        );
    }
    check("crates/report/src/lib.rs", "use std::fs;", "");
    check(
        "crates/kineme/src/math/mod.rs",
        "use std::time::Duration; use rand::Rng;",
        "",
    );
}

#[test]
fn a_crate_depends_downward() {
    check(
        "crates/formats/Cargo.toml",
        "[dev-dependencies]\nreport = \"1\"\n",
        "crates/formats/Cargo.toml: depends upward on `report`",
    );
    check(
        "crates/kineme/Cargo.toml",
        "[target.'cfg(unix)'.dependencies]\nformats = \"1\"\n",
        "crates/kineme/Cargo.toml: depends upward on `formats`",
    );
}

#[test]
fn every_room_and_crate_stands_on_one_floor() {
    check(
        "crates/viewer/Cargo.toml",
        "",
        "ARCHITECTURE.md: `viewer` stands on no floor of the table",
    );
    check(
        "ARCHITECTURE.md",
        &TABLE.replace("<- math", "<- math | motion"),
        "ARCHITECTURE.md:8: `motion` is no name, or stands on two floors",
    );
    let mut tree = good();
    tree.0.insert("ARCHITECTURE.md".into(), String::new());
    let missing = "ARCHITECTURE.md: no table of floors in a fenced block".to_owned();
    assert!(inspect(&tree).violations.contains(&missing));
}

#[test]
fn a_source_file_is_short_and_a_test_not_much_longer() {
    let file = "crates/report/src/lib.rs";
    check(file, &"\n".repeat(600), "");
    check(
        file,
        &"\n".repeat(601),
        "crates/report/src/lib.rs: 601 lines, where 600 are the most",
    );
    let file = "crates/report/tests/figures.rs";
    check(file, &"\n".repeat(900), "");
    check(
        file,
        &"\n".repeat(901),
        "crates/report/tests/figures.rs: 901 lines, where 900 are the most",
    );
}

#[test]
fn a_path_in_a_document_leads_somewhere() {
    for (text, expected) in [
        (
            "a\n`docs/lost.md`",
            "docs/guide.md:2: there is no `docs/lost.md`",
        ),
        (
            "[a](lost.md)",
            "docs/guide.md:1: there is no `docs/lost.md`",
        ),
        ("`NOTICE.md`", "docs/guide.md:1: there is no `NOTICE.md`"),
        ("```\n`docs/lost.md`\n```", ""),
        (
            "`crates/*/src`, `docs/{a,b}.md`, `motion/x.rs`, [w](https://example.org/a)",
            "",
        ),
        ("`crates/report` and `crates/report/src/`", ""),
    ] {
        check("docs/guide.md", text, expected);
    }
}

#[test]
fn the_code_map_shows_all_code_and_nothing_else() {
    check("crates/formats/src/readers/bvh.rs", "", "");
    let only_top = TABLE.replace("crates/kineme/src/math/ ", "crates/kineme/src/ ");
    let missed = "crates/kineme/src/math/mod.rs: not on the code map of ARCHITECTURE.md";
    check("ARCHITECTURE.md", &only_top, missed);
    check("crates/kineme/src/motion/deep/er.rs", "", "");
    check(
        "ARCHITECTURE.md",
        &TABLE.replace(
            "crates/report/src/\n",
            "crates/report/src/\ncrates/report/old.rs\n",
        ),
        "ARCHITECTURE.md:20: the map shows `crates/report/old.rs`, which is not there",
    );
}

#[test]
fn the_changelog_has_a_heading_for_the_version() {
    let missing = "CHANGELOG.md: no heading `## 0.1.0`";
    check("CHANGELOG.md", "## [0.1.0]\n", "");
    check("CHANGELOG.md", "Of 0.1.0\n## 0.1\n", missing);
}

#[test]
fn no_file_names_somebodys_machine() {
    let folder = ["", "home", ""].join("/");
    let expected = format!("docs/a.txt:1: a path of somebody's machine, `{folder}`");
    check("docs/a.txt", &format!("see {folder}me"), &expected);
    check("docs/a.txt", &format!("see set.zip{folder}me"), "");
}

#[test]
fn the_scanner_reads_paths_and_skips_text() {
    let source = r##"
        /* crate::a::b /* nested */ crate::c::d */
        let x = r#"crate::e::f"#; let c = '"'; let d = '\''; let l: &'static str = b"crate::g::h";
        use crate::{i::{j, k::*}, l};
        $crate::m::n::<u8>();
    "##;
    let found: Vec<String> = paths(source).iter().map(|p| p.parts.join("::")).collect();
    let expected = ["crate::i::j", "crate::i::k::*", "crate::l", "$crate::m::n"];
    assert_eq!(found, expected);
    assert_eq!(paths(source)[0].line, 4);
}

#[test]
fn the_papers_page_names_code_and_tests_that_are_there() {
    let page = |row: &str| {
        format!(
            "| the paper | module | test |\n| --- | --- | --- |\n{row}\n\n| figure | x | `y` |\n"
        )
    };
    let file = "docs/paper.md";
    let mut tree = good();
    let test = "#[test]\nfn a_law() {}\n".to_owned();
    tree.0.insert("crates/report/tests/laws.rs".into(), test);
    let source = "pub struct Flow;\nimpl Flow { fn of() {} }\n".to_owned();
    tree.0.insert("crates/report/src/lib.rs".into(), source);
    for (row, missing) in [
        (
            "| \"a\" | `Flow::of`, kept | laws (`report`): `a_law` |",
            None,
        ),
        ("| \"a\" | `Flow::to` | laws |", Some("to")),
        ("| \"a\" | `Flow` | lows |", Some("lows")),
        ("| \"a\" | `Flow` | laws: `a_lore` |", Some("a_lore")),
    ] {
        tree.0.insert(file.into(), page(row));
        let expected: Vec<String> = missing
            .map(|name| format!("{file}:3: no code is called `{name}`"))
            .into_iter()
            .collect();
        assert_eq!(inspect(&tree).violations, expected, "{row}");
    }
}
