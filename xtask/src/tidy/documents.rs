//! What documents promise: paths that exist, a map of all code, a heading for the version, nobody's machine.

use super::floors::{Floors, ROOMS, fenced_block};
use super::{ARCHITECTURE, Findings, Tree, is_source};

/// Top folders whose name begins a path; a room such as `motion/recording.rs` is a word and not a path.
const TOP: [&str; 9] = [
    ".cargo",
    ".ci",
    ".github",
    "choreography",
    "crates",
    "docs",
    "fuzz",
    "viewer",
    "xtask",
];

fn is_document(path: &str) -> bool {
    path.ends_with(".md") && (!path.contains('/') || path.starts_with("docs/"))
}

/// Every path in backticks and every relative link of a document leads somewhere.
pub fn check_paths(tree: &Tree, floors: &Floors, findings: &mut Findings) {
    for (document, text) in tree.files().filter(|(path, _)| is_document(path)) {
        for (number, line) in prose(text) {
            let links = links(line).filter_map(|link| beside(document, link));
            let spans = backticked(line).filter(|span| looks_like_path(span));
            for path in spans.map(str::to_owned).chain(links) {
                if !tree.has(&path) && !floors.is_planned(tree, &path) {
                    let message = format!("{document}:{number}: there is no `{path}`");
                    findings.violations.push(message);
                }
            }
        }
    }
}

/// The lines outside fenced blocks, with their numbers.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut fenced = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        (!fenced && !fence).then_some((index + 1, line))
    })
}

fn backticked(line: &str) -> impl Iterator<Item = &str> {
    // A span that the line does not close is none: the last piece is always outside.
    let closed = line.matches('`').count() / 2;
    line.split('`').skip(1).step_by(2).take(closed)
}

fn looks_like_path(span: &str) -> bool {
    let is_pattern = span.contains(['*', '{', '<', ' ', '$', ':', '=']);
    let (top, below) = span.split_once('/').unwrap_or((span, ""));
    let is_root_file = !span.contains('/')
        && (span.ends_with(".md") || span.starts_with("LICENSE-") || span.starts_with("Cargo."));
    !is_pattern
        && (is_root_file || (TOP.contains(&top) && (!below.is_empty() || span.ends_with('/'))))
}

fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .map(|link| link.split('#').next().unwrap_or_default())
        .filter(|link| !link.is_empty() && !link.contains(':'))
}

/// A link of a document as a path from the root; `None` where it leaves the project.
fn beside(document: &str, link: &str) -> Option<String> {
    let mut parts: Vec<&str> = document.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

/// The code map of ARCHITECTURE.md (the fenced block whose lines begin with `crates/` or `xtask/`) shows every source
/// file, and nothing that is not there.
pub fn check_code_map(tree: &Tree, floors: &Floors, findings: &mut Findings) {
    let is_map = |line: &str| line.starts_with("crates/") || line.starts_with("xtask/");
    let map: Vec<(usize, &str)> = fenced_block(tree.text(ARCHITECTURE), is_map)
        .into_iter()
        .filter_map(|(number, line)| Some((number, line.split_whitespace().next()?)))
        .collect();
    if map.is_empty() {
        let message = format!("{ARCHITECTURE}: no code map in a fenced block");
        findings.violations.push(message);
    }
    for (number, path) in &map {
        if !tree.has(path) && !floors.is_planned(tree, path) {
            let message =
                format!("{ARCHITECTURE}:{number}: the map shows `{path}`, which is not there");
            findings.violations.push(message);
        }
    }
    for (path, _) in tree.sources() {
        if !map
            .iter()
            .any(|(_, entry)| shows(entry.trim_end_matches('/'), path))
        {
            let message = format!("{path}: not on the code map of {ARCHITECTURE}");
            findings.violations.push(message);
        }
    }
}

/// A map's entry shows a file if it is the file, or a folder of its crate's `src` or below. The core's `src` itself
/// shows only what stands right in it: each of its rooms wants an entry.
fn shows(entry: &str, file: &str) -> bool {
    let Some(inside) = file.strip_prefix(entry) else {
        return false;
    };
    let Some(below) = inside.strip_prefix('/') else {
        return inside.is_empty();
    };
    let in_sources = is_source(&format!("{entry}/x.rs"));
    in_sources && (entry != ROOMS || !below.contains('/'))
}

/// CHANGELOG.md has a heading for the workspace's version.
pub fn check_changelog(tree: &Tree, violations: &mut Vec<String>) {
    let manifest: toml::Table = tree.text("Cargo.toml").parse().unwrap_or_default();
    let version = manifest
        .get("workspace")
        .and_then(|w| w.get("package")?.get("version")?.as_str());
    let Some(version) = version else {
        violations.push("Cargo.toml: no workspace.package.version".to_owned());
        return;
    };
    let headed = tree.text("CHANGELOG.md").lines().any(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some("##")
            && words.next().map(|w| w.trim_matches(['[', ']'])) == Some(version)
    });
    if !headed {
        violations.push(format!("CHANGELOG.md: no heading `## {version}`"));
    }
}

/// No file names a folder of somebody's machine.
pub fn check_machine_paths(tree: &Tree, violations: &mut Vec<String>) {
    let banned = ["home", "work", "root", "Users"].map(|folder| format!("/{folder}/"));
    for (path, text) in tree.files() {
        for (index, line) in text.lines().enumerate() {
            let found = banned.iter().find(|folder| {
                line.match_indices(folder.as_str()).any(|(at, _)| {
                    // Behind a word it is a folder of the project or of an address.
                    !line[..at].ends_with(|c: char| c.is_alphanumeric() || "._-~}".contains(c))
                })
            });
            if let Some(folder) = found {
                let number = index + 1;
                violations.push(format!(
                    "{path}:{number}: a path of somebody's machine, `{folder}`"
                ));
            }
        }
    }
}

/// The document that says where each statement of the paper is built and tested.
const PAPER: &str = "docs/paper.md";

/// Rows `| the paper | module | test |` of the paper's page name code that is there: identifiers of the second cell
/// occur in sources, words of the third name files of tests, and what is in backticks there is a test's function.
pub fn check_paper(tree: &Tree, violations: &mut Vec<String>) {
    let code: Vec<(&str, &str)> = tree.files().filter(|(p, _)| p.ends_with(".rs")).collect();
    let said = |name: &str| code.iter().any(|(_, text)| is_word(text, name));
    let is_function = |name: &str| {
        let head = format!("fn {name}(");
        code.iter().any(|(_, text)| text.contains(&head))
    };
    let is_test_file = |name: &str| {
        let [file, folder] = [format!("/tests/{name}.rs"), format!("/tests/{name}/")];
        let holds = |(path, _): &(&str, &str)| path.ends_with(&file) || path.contains(&folder);
        name == "unit" || code.iter().any(holds)
    };
    let mut inside = false;
    for (number, line) in prose(tree.text(PAPER)) {
        let is_head = line == "| the paper | module | test |";
        inside = is_head || (inside && line.starts_with('|'));
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let &["", _, module, test, ""] = cells.as_slice() else {
            continue;
        };
        if !inside || is_head || test.starts_with("---") {
            continue;
        }
        let mut missing = Vec::new();
        for span in backticked(module).filter(|span| is_identifier(span)) {
            missing.extend(span.split("::").filter(|part| !said(part)));
        }
        // Which crate a file of tests belongs to stands in brackets.
        let bare: String = test
            .split('(')
            .enumerate()
            .map(|(i, part)| {
                if i == 0 {
                    part
                } else {
                    part.split_once(')').map_or("", |p| p.1)
                }
            })
            .collect();
        missing.extend(backticked(&bare).filter(|name| !is_function(name)));
        let words = bare.split('`').step_by(2).flat_map(str::split_whitespace);
        let words = words.map(|word| word.trim_matches([',', ';', ':', '*']));
        missing.extend(words.filter(|word| !word.is_empty() && !is_test_file(word)));
        for name in missing {
            violations.push(format!("{PAPER}:{number}: no code is called `{name}`"));
        }
    }
}

/// A path of Rust such as `Flowfield::of`.
fn is_identifier(span: &str) -> bool {
    let part = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_alphabetic())
            && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    span.split("::").all(part)
}

/// Whether a text holds a name, not as a part of another.
fn is_word(text: &str, name: &str) -> bool {
    let outside = |c: char| !(c.is_alphanumeric() || c == '_');
    text.match_indices(name).any(|(at, _)| {
        text[..at].chars().next_back().is_none_or(outside)
            && text[at + name.len()..].chars().next().is_none_or(outside)
    })
}
