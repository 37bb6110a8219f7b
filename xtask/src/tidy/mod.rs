//! `cargo xtask tidy`: the rules of the house that no compiler knows.

mod documents;
mod floors;
mod imports;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::Path;

use floors::Floors;

/// The file whose fenced tables tidy reads.
const ARCHITECTURE: &str = "ARCHITECTURE.md";
/// The longest source file, in lines; tests may be half as long again.
const LONGEST_SOURCE: usize = 600;
const LONGEST_TEST: usize = 900;

/// What tidy found.
#[derive(Debug, Default)]
struct Findings {
    /// Broken rules, as `file:line: what is wrong`. One is a failure.
    violations: Vec<String>,
    /// What is not wrong but worth a line.
    notes: Vec<String>,
}

/// Every file of the project with its text, by path from the root with `/`.
///
/// Files that are no text have an empty one.
#[derive(Debug, Default)]
struct Tree(BTreeMap<String, String>);

impl Tree {
    fn read(root: &Path) -> std::io::Result<Self> {
        let mut tree = Self::default();
        tree.add(root, "")?;
        Ok(tree)
    }

    fn add(&mut self, folder: &Path, prefix: &str) -> std::io::Result<()> {
        for entry in std::fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let kind = entry.file_type()?;
            let skipped = [".git", "target", "node_modules"].contains(&name.as_str());
            if skipped || kind.is_symlink() {
                continue;
            }
            let path = format!("{prefix}{name}");
            if kind.is_dir() {
                self.add(&entry.path(), &format!("{path}/"))?;
            } else {
                let text = String::from_utf8(std::fs::read(entry.path())?).unwrap_or_default();
                self.0.insert(path, text);
            }
        }
        Ok(())
    }

    /// A file's text, empty where there is no such file.
    fn text(&self, path: &str) -> &str {
        self.0.get(path).map_or("", String::as_str)
    }

    /// Whether there is a file of this path, or a folder with a file in it.
    fn has(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        let inside = format!("{path}/");
        self.0.contains_key(path)
            || self
                .0
                .range(inside.clone()..)
                .next()
                .is_some_and(|(found, _)| found.starts_with(&inside))
    }

    fn files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(p, t)| (p.as_str(), t.as_str()))
    }

    /// Rust sources of the crates and of xtask, without their tests and examples.
    fn sources(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files().filter(|(path, _)| is_source(path))
    }
}

fn is_source(path: &str) -> bool {
    let parts: Vec<&str> = path.split('/').collect();
    let inside = matches!(
        parts.as_slice(),
        ["crates", _, "src", ..] | ["xtask", "src", ..]
    );
    inside && path.ends_with(".rs")
}

/// Checks the project at `root`, prints what it finds, and fails on a broken rule.
pub fn run(root: &Path) -> Result<(), String> {
    let tree = Tree::read(root).map_err(|e| format!("tidy: {}: {e}", root.display()))?;
    let findings = inspect(&tree);
    for note in &findings.notes {
        println!("note: {note}");
    }
    if findings.violations.is_empty() {
        println!("tidy: {} files, nothing to remark", tree.0.len());
        return Ok(());
    }
    let count = findings.violations.len();
    Err(format!(
        "{}\ntidy: {count} to put right",
        findings.violations.join("\n")
    ))
}

fn inspect(tree: &Tree) -> Findings {
    let mut findings = Findings::default();
    let floors = Floors::parse(tree.text(ARCHITECTURE), &mut findings.violations);
    floors::check_rooms(tree, &floors, &mut findings);
    floors::check_manifests(tree, &floors, &mut findings.violations);
    imports::check(tree, &floors, &mut findings.violations);
    check_lengths(tree, &mut findings.violations);
    documents::check_paths(tree, &floors, &mut findings);
    documents::check_code_map(tree, &floors, &mut findings);
    documents::check_paper(tree, &mut findings.violations);
    documents::check_changelog(tree, &mut findings.violations);
    documents::check_machine_paths(tree, &mut findings.violations);
    findings
}

fn check_lengths(tree: &Tree, violations: &mut Vec<String>) {
    for (path, text) in tree.files().filter(|(path, _)| path.ends_with(".rs")) {
        let is_test = !is_source(path) || path.ends_with("/tests.rs") || path.contains("/tests/");
        let longest = if is_test {
            LONGEST_TEST
        } else {
            LONGEST_SOURCE
        };
        let lines = text.lines().count();
        if lines > longest {
            violations.push(format!(
                "{path}: {lines} lines, where {longest} are the most"
            ));
        }
    }
}
