//! The table of floors, and the manifests held against it.

use std::collections::BTreeSet;

use super::{ARCHITECTURE, Findings, Tree};

/// The crate whose top modules are the rooms of the lower floors.
pub const CORE: &str = "kineme";
/// Where its rooms are.
pub const ROOMS: &str = "crates/kineme/src";

/// The lines of a fenced block that `accepts` knows by its first line, each with its number in the file.
pub fn fenced_block(text: &str, accepts: impl Fn(&str) -> bool) -> Vec<(usize, &str)> {
    let mut block: Option<Vec<(usize, &str)>> = None;
    for (number, line) in text.lines().enumerate() {
        let fence = line.trim_start().starts_with("```");
        block = match (block, fence) {
            (None, true) => Some(Vec::new()),
            (None, false) => None,
            (Some(lines), true) => {
                if lines.first().is_some_and(|(_, first)| accepts(first)) {
                    return lines;
                }
                None
            }
            (Some(mut lines), false) => {
                if !line.trim().is_empty() {
                    lines.push((number + 1, line));
                }
                Some(lines)
            }
        };
    }
    Vec::new()
}

#[derive(Debug)]
struct Place {
    name: String,
    floor: u32,
    /// Neighbours on one floor that may see one another share a chain, in the order of their sight.
    chain: usize,
    position: usize,
}

/// Which room or crate stands on which floor.
///
/// The table is the fenced block of ARCHITECTURE.md whose lines begin with a number: `2  a | b <- c  # why`.
/// Here `a` and `b` are strangers and `c` may use `b`.
#[derive(Debug, Default)]
pub struct Floors(Vec<Place>);

impl Floors {
    pub fn parse(architecture: &str, violations: &mut Vec<String>) -> Self {
        let begins_with_number =
            |line: &str| line.trim_start().starts_with(|c: char| c.is_ascii_digit());
        let mut floors = Self::default();
        let mut chains = 0;
        for (number, line) in fenced_block(architecture, begins_with_number) {
            let row = line.split('#').next().unwrap_or_default().trim();
            let (floor, names) = row.split_once(char::is_whitespace).unwrap_or((row, ""));
            let Ok(floor) = floor.parse() else {
                violations.push(format!(
                    "{ARCHITECTURE}:{number}: a floor begins with its number"
                ));
                continue;
            };
            for chain in names.split('|') {
                chains += 1;
                for (position, name) in chain.split("<-").map(str::trim).enumerate() {
                    let well_formed = !name.is_empty() && !name.contains(char::is_whitespace);
                    if !well_formed || floors.place(name).is_some() {
                        violations.push(format!(
                            "{ARCHITECTURE}:{number}: `{name}` is no name, or stands on two floors"
                        ));
                        continue;
                    }
                    let name = name.to_owned();
                    floors.0.push(Place {
                        name,
                        floor,
                        chain: chains,
                        position,
                    });
                }
            }
        }
        if floors.0.is_empty() {
            violations.push(format!(
                "{ARCHITECTURE}: no table of floors in a fenced block"
            ));
        }
        floors
    }

    fn place(&self, name: &str) -> Option<&Place> {
        self.0.iter().find(|place| place.name == name)
    }

    pub fn knows(&self, name: &str) -> bool {
        self.place(name).is_some()
    }

    /// Why `from` may not use `to`; `None` where it may, or where the table lacks one of them.
    pub fn objection(&self, from: &str, to: &str) -> Option<&'static str> {
        let (from, to) = (self.place(from)?, self.place(to)?);
        let in_sight = from.chain == to.chain && to.position <= from.position;
        if to.floor > from.floor {
            Some("upward")
        } else if to.floor == from.floor && !in_sight {
            Some("sideways")
        } else {
            None
        }
    }

    /// Whether a path lies in a room or crate that the table names and nobody has built yet.
    pub fn is_planned(&self, tree: &Tree, path: &str) -> bool {
        let parts: Vec<&str> = path.trim_end_matches('/').split('/').collect();
        match parts.as_slice() {
            ["crates", CORE, "src", room, ..] => {
                let room = room.trim_end_matches(".rs");
                self.knows(room) && !is_built(tree, room)
            }
            ["crates", name, ..] => self.knows(name) && !is_built(tree, name),
            _ => false,
        }
    }
}

fn is_built(tree: &Tree, name: &str) -> bool {
    name == "xtask" && tree.has("xtask")
        || tree.has(&format!("crates/{name}"))
        || tree.has(&format!("{ROOMS}/{name}"))
        || tree.has(&format!("{ROOMS}/{name}.rs"))
}

/// The room of the core crate that a file belongs to; `None` for the crate's root and for other crates.
pub fn room_of(path: &str) -> Option<&str> {
    let inside = path.strip_prefix(ROOMS)?.strip_prefix('/')?;
    let room = inside.split('/').next()?;
    let room = room.strip_suffix(".rs").unwrap_or(room);
    (room != "lib").then_some(room)
}

/// Every room and crate stands on a floor; names that nobody has built yet are worth a note.
pub fn check_rooms(tree: &Tree, floors: &Floors, findings: &mut Findings) {
    let rooms = tree.sources().filter_map(|(path, _)| room_of(path));
    let crates = tree.files().filter_map(|(path, _)| crate_of_manifest(path));
    let named: BTreeSet<&str> = rooms.chain(crates.filter(|name| *name != CORE)).collect();
    for name in named {
        if !floors.knows(name) {
            let message = format!("{ARCHITECTURE}: `{name}` stands on no floor of the table");
            findings.violations.push(message);
        }
    }
    let unbuilt: Vec<&str> = floors
        .0
        .iter()
        .map(|place| place.name.as_str())
        .filter(|name| !is_built(tree, name))
        .collect();
    if !unbuilt.is_empty() {
        let names = unbuilt.join(", ");
        findings
            .notes
            .push(format!("on the table of floors and not built: {names}"));
    }
}

fn crate_of_manifest(path: &str) -> Option<&str> {
    match path {
        "xtask/Cargo.toml" => Some("xtask"),
        _ => path
            .strip_prefix("crates/")?
            .strip_suffix("/Cargo.toml")
            .filter(|name| !name.contains('/')),
    }
}

/// Dependencies between the crates go downward; tests and build scripts are no exception.
pub fn check_manifests(tree: &Tree, floors: &Floors, violations: &mut Vec<String>) {
    for (path, text) in tree.files() {
        let Some(name) = crate_of_manifest(path) else {
            continue;
        };
        let manifest: toml::Table = match text.parse() {
            Ok(table) => table,
            Err(error) => {
                violations.push(format!("{path}: {}", error.message()));
                continue;
            }
        };
        for dependency in dependencies(&manifest) {
            // The core crate is the floors below all crates: it may name none of them.
            let is_crate = tree.has(&format!("crates/{dependency}/Cargo.toml"));
            let objection = match (name, dependency.as_str()) {
                (_, CORE) => None,
                (CORE, _) if is_crate => Some("upward"),
                (name, dependency) => floors.objection(name, dependency),
            };
            if let Some(direction) = objection {
                violations.push(format!("{path}: depends {direction} on `{dependency}`"));
            }
        }
    }
}

fn dependencies(manifest: &toml::Table) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut collect = |table: &toml::Table| {
        for section in ["dependencies", "dev-dependencies", "build-dependencies"] {
            if let Some(toml::Value::Table(section)) = table.get(section) {
                names.extend(section.keys().cloned());
            }
        }
    };
    collect(manifest);
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    for target in targets.into_iter().flat_map(|t| t.values()) {
        target.as_table().into_iter().for_each(&mut collect);
    }
    names
}
