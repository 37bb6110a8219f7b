//! Imports between the rooms of the core crate, read from the source.
//!
//! A scanner, not a parser: it drops comments and strings, then follows every path (`crate::motion::Motion`,
//! `use super::super::{a, b::c}`). That finds all imports that people write; macros that paste names it does not see.

use std::collections::BTreeMap;

use super::Tree;
use super::floors::{Floors, ROOMS, room_of};

/// What the core crate may not touch, so that the same input always gives the same bytes.
const OUTSIDE: [&[&str]; 9] = [
    &["std", "fs"],
    &["std", "net"],
    &["std", "env"],
    &["std", "process"],
    &["std", "time", "Instant"],
    &["std", "time", "SystemTime"],
    &["rand", "rng"],
    &["rand", "random"],
    &["rand", "rngs", "SysRng"],
];

/// A path of a source file, its `use` trees flattened, and the line where it begins.
#[derive(Debug, PartialEq, Eq)]
pub struct PathUse {
    pub line: usize,
    pub parts: Vec<String>,
}

/// No room imports from a higher floor or from a neighbour, and none reaches outside the computation.
pub fn check(tree: &Tree, floors: &Floors, violations: &mut Vec<String>) {
    let root = format!("{ROOMS}/lib.rs");
    let exported = re_exports(tree.text(&root));
    for (path, text) in tree.sources() {
        let Some(from) = room_of(path) else { continue };
        let module = module_of(path);
        for PathUse { line, parts } in paths(text) {
            let outside = OUTSIDE.iter().find(|banned| {
                parts.len() >= banned.len() && banned.iter().zip(&parts).all(|(a, b)| a == b)
            });
            if let Some(banned) = outside {
                let name = banned.join("::");
                violations.push(format!("{path}:{line}: the core crate knows no `{name}`"));
            }
            let Some(name) = first_below_root(&parts, &module) else {
                continue;
            };
            if name == "*" && parts[0] == "crate" {
                violations.push(format!("{path}:{line}: `crate::*` hides the room: name it"));
                continue;
            }
            let to = exported.get(&name).unwrap_or(&name);
            if let Some(direction) = floors.objection(from, to) {
                violations.push(format!(
                    "{path}:{line}: `{from}` imports {direction} from `{to}`"
                ));
            }
        }
    }
}

/// The module that a file is, from the crate's root: `["motion", "recording"]`.
fn module_of(path: &str) -> Vec<String> {
    let inside = path.trim_start_matches(ROOMS).trim_start_matches('/');
    let inside = inside.strip_suffix(".rs").unwrap_or(inside);
    let inside = inside.strip_suffix("/mod").unwrap_or(inside);
    inside.split('/').map(str::to_owned).collect()
}

/// The first name below the crate's root in a path that begins with `crate` or climbs there by `super`.
///
/// A `super` in an inline module is taken as if it stood in the file. That climbs one step too far, to a name which is
/// then either the room's own or none of the table's.
fn first_below_root(parts: &[String], module: &[String]) -> Option<String> {
    let first = parts.first()?.as_str();
    if first == "crate" || first == "$crate" {
        return parts.get(1).cloned();
    }
    let climbs = parts.iter().take_while(|part| *part == "super").count();
    (climbs >= module.len() && climbs > 0)
        .then(|| parts.get(climbs).cloned())
        .flatten()
}

/// Names that the crate's root re-exports, with the room each comes from.
fn re_exports(root: &str) -> BTreeMap<String, String> {
    let mut names = BTreeMap::new();
    for PathUse { parts, .. } in paths(root) {
        let parts: Vec<&String> = parts
            .iter()
            .skip_while(|p| *p == "crate" || *p == "self")
            .collect();
        if let [room, .., name] = parts.as_slice()
            && name.as_str() != "*"
        {
            names.insert((*name).clone(), (*room).clone());
        }
    }
    names
}

/// Every path of at least two parts in a Rust source.
pub fn paths(source: &str) -> Vec<PathUse> {
    let tokens = tokens(source);
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at].text.starts_with(is_name) {
            at = follow(&tokens, at, &mut Vec::new(), &mut found);
        } else {
            at += 1;
        }
    }
    found.retain(|path| path.parts.len() > 1);
    found
}

/// Reads a path, or a `use` tree, that begins at `at`; gives the place after it.
fn follow(
    tokens: &[Token],
    mut at: usize,
    prefix: &mut Vec<String>,
    found: &mut Vec<PathUse>,
) -> usize {
    let depth = prefix.len();
    let line = tokens[at].line;
    loop {
        prefix.push(tokens[at].text.clone());
        at += 1;
        let joined = tokens.get(at).is_some_and(|t| t.text == "::");
        match tokens.get(at + 1).map(|t| t.text.as_str()) {
            Some("{") if joined => {
                at += 2;
                while at < tokens.len() && tokens[at].text != "}" {
                    if tokens[at].text == "*" || tokens[at].text.starts_with(is_name) {
                        at = follow(tokens, at, prefix, found);
                    } else {
                        at += 1;
                    }
                }
                at += 1;
                break;
            }
            Some(next) if joined && (next == "*" || next.starts_with(is_name)) => at += 1,
            _ => {
                let parts = prefix.clone();
                found.push(PathUse { line, parts });
                break;
            }
        }
    }
    prefix.truncate(depth);
    at
}

#[derive(Debug)]
struct Token {
    line: usize,
    text: String,
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

/// Names, `::` and single signs, without comments, strings and characters.
fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let mut tokens: Vec<Token> = Vec::new();
    let (mut at, mut line) = (0, 1);
    while at < chars.len() {
        let rest = &chars[at..];
        let length = match rest {
            ['/', '/', ..] => rest.iter().take_while(|c| **c != '\n').count(),
            ['/', '*', ..] => block_comment(rest),
            ['"', ..] => quoted(rest, 0),
            ['r' | 'b' | 'c', ..] if raw_string(rest).is_some() => raw_string(rest).unwrap_or(1),
            ['\'', '\\', ..] => 2 + quoted_character(&rest[2..]),
            ['\'', _, '\'', ..] => 3,
            [':', ':', ..] => 2,
            [c, ..] if is_name(*c) => rest.iter().take_while(|c| is_name(**c)).count(),
            _ => 1,
        };
        let length = length.clamp(1, rest.len());
        let word: String = rest[..length].iter().collect();
        let is_text = matches!(rest[0], '"' | '\'')
            || word.contains('"')
            || word.starts_with("/*")
            || word.starts_with("//");
        if !is_text && !word.trim().is_empty() {
            tokens.push(Token {
                line,
                text: word.clone(),
            });
        }
        line += word.matches('\n').count();
        at += length;
    }
    tokens
}

fn block_comment(chars: &[char]) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < chars.len() {
        match &chars[at..] {
            ['/', '*', ..] => (depth, at) = (depth + 1, at + 2),
            ['*', '/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

/// The length of a string whose opening quote stands at `quote`.
fn quoted(chars: &[char], quote: usize) -> usize {
    let mut at = quote + 1;
    while at < chars.len() && chars[at] != '"' {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// What is left of an escaped character after its backslash.
fn quoted_character(chars: &[char]) -> usize {
    // The escaped sign itself may be a quote.
    1 + chars.iter().skip(1).take_while(|c| **c != '\'').count() + 1
}

/// The length of `"`, `b"`, `r#"..."#` and their like; `None` where a name begins.
fn raw_string(chars: &[char]) -> Option<usize> {
    let letters = chars
        .iter()
        .take_while(|c| matches!(c, 'r' | 'b' | 'c'))
        .count();
    let raw = chars[..letters].contains(&'r');
    let hashes = chars[letters..].iter().take_while(|c| **c == '#').count();
    let quote = letters + hashes;
    if letters > 2 || chars.get(quote) != Some(&'"') || (hashes > 0 && !raw) {
        return None;
    }
    if !raw {
        return Some(quoted(chars, quote));
    }
    let closes = |at: &usize| {
        chars[*at] == '"' && chars[at + 1..].iter().take_while(|c| **c == '#').count() >= hashes
    };
    let end = (quote + 1..chars.len()).find(closes)?;
    Some(end + 1 + hashes)
}
