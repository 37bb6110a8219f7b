//! Which format a file is, told by content and extension, and the one place that sends it to its reader.

use kineme::Recording;

use crate::error::Result;
use crate::tables::{body_angles, msr, positions};
use crate::text::{Blame, Lines, number, quoted, words};
use crate::{amc, asf, bvh, c3d, deepmimic, parquet};

/// Bytes from the beginning of a file that suffice to tell its format.
pub const HEAD: usize = 1 << 16;

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Biovision hierarchy.
    Bvh,
    /// Acclaim skeleton: no motion, but motions need it.
    Asf,
    /// Acclaim motion.
    Amc,
    /// DeepMimic clip.
    DeepMimic,
    /// Table of joint positions with a `frame` column: no time base.
    Positions,
    /// Table of joint positions with a `time` column.
    TimedPositions,
    /// MSR-Action3D skeleton text.
    Msr,
    /// Joint-angle table, as `convert` writes it.
    Angles,
    /// Parquet of which the columns, at its end, have not been seen yet or cannot be read.
    Parquet,
    /// Marker file of biomechanics.
    C3d,
    /// Archive that acts as a folder.
    Zip,
}

impl Kind {
    /// The name as people write it in `--input-rate FORMAT=HZ`.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Bvh => "bvh",
            Kind::Asf => "asf",
            Kind::Amc => "amc",
            Kind::DeepMimic => "deepmimic",
            Kind::Positions | Kind::TimedPositions => "positions",
            Kind::Msr => "msr",
            Kind::Angles => "angles",
            Kind::Parquet => "parquet",
            Kind::C3d => "c3d",
            Kind::Zip => "zip",
        }
    }

    /// Frames a second that are assumed where the format has no time base and nobody says another.
    pub fn default_rate_hz(self) -> Option<f64> {
        match self {
            Kind::Amc => Some(amc::DEFAULT_RATE_HZ),
            Kind::Positions => Some(30.0),
            Kind::Msr => Some(15.0),
            _ => None,
        }
    }
}

/// The kind of a file of this name that begins with `head` (at most [`HEAD`] bytes are looked at); `None` for what is
/// no motion format. Of Parquet, [`by_columns`] tells more.
///
/// An extension that only motions have decides, so that a damaged motion is an error and not ignored; else
/// the content does.
pub fn detect(name: &str, head: &[u8]) -> Option<Kind> {
    by_extension(name).or_else(|| by_content(&head[..head.len().min(HEAD)]))
}

/// The kind that an extension promises, in any case; `None` for extensions shared with other things.
pub fn by_extension(name: &str) -> Option<Kind> {
    let (_, extension) = name.rsplit_once('.')?;
    match extension.to_ascii_lowercase().as_str() {
        "bvh" => Some(Kind::Bvh),
        "asf" => Some(Kind::Asf),
        "amc" => Some(Kind::Amc),
        "c3d" => Some(Kind::C3d),
        "zip" => Some(Kind::Zip),
        _ => None,
    }
}

/// The kind that the beginning of a file shows.
fn by_content(head: &[u8]) -> Option<Kind> {
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Some(Kind::Zip);
    }
    if c3d::sniff(head) {
        return Some(Kind::C3d);
    }
    if parquet::begins(head) {
        return Some(Kind::Parquet);
    }
    let mut lines = Lines::new(head);
    let (_, first) = lines.next_full()?;
    if first.eq_ignore_ascii_case(b"HIERARCHY") {
        return Some(Kind::Bvh);
    }
    if first.starts_with(b"{") {
        let frames = head.windows(8).any(|w| w == b"\"Frames\"");
        return frames.then_some(Kind::DeepMimic);
    }
    if first.starts_with(b"#") || first.starts_with(b":") {
        return Lines::new(head).find_map(|(_, line)| {
            let line = line.to_ascii_lowercase();
            match line.as_slice() {
                b":fully-specified" => Some(Kind::Amc),
                b":bonedata" => Some(Kind::Asf),
                _ => None,
            }
        });
    }
    if let Some(kind) = std::str::from_utf8(first)
        .ok()
        .and_then(|t| table(&cells(t)))
    {
        return Some(kind);
    }
    let four = |line: &[u8]| {
        let mut count = 0;
        words(line).all(|w| {
            count += 1;
            number(w).is_some()
        }) && count == 4
    };
    let second = lines.next_full().map(|(_, line)| line);
    (four(first) && second.is_some_and(four)).then_some(Kind::Msr)
}

/// What a Parquet file is by its columns: a table of motion, none, or [`Kind::Parquet`] where it is damaged, so that
/// this is an error and not ignored. `end(n)` gives its last n bytes, or all where it has fewer.
pub fn by_columns(end: impl Fn(usize) -> Option<Vec<u8>>) -> Option<Kind> {
    match parquet::column_names(end) {
        Some(names) => table(&names),
        None => Some(Kind::Parquet),
    }
}

/// The kind of a Parquet file that is here as a whole.
fn by_own_columns(bytes: &[u8]) -> Option<Kind> {
    by_columns(|most| Some(bytes[bytes.len().saturating_sub(most)..].to_vec()))
}

/// What a file of no motion format seems to be, and what would be right in its place.
pub(crate) fn unknown(bytes: &[u8]) -> (String, String) {
    const MOTIONS: &str =
        "BVH, AMC, C3D, DeepMimic JSON, a position or joint-angle table, or MSR-Action3D text";
    // A safetensors container begins with the length of its header, which is JSON.
    if bytes.get(8..10) == Some(b"{\"") {
        let motion = "a motion; `kineme show` and `kineme view` look at vocabularies";
        return ("a vocabulary".into(), motion.into());
    }
    let (what, columns) = if parquet::begins(bytes) {
        let names = parquet::column_names(|_| Some(bytes.to_vec()));
        ("a Parquet table whose columns begin", names)
    } else {
        let mut lines = Lines::new(&bytes[..bytes.len().min(HEAD)]);
        let Some((_, first)) = lines.next_full() else {
            return ("an empty file".into(), MOTIONS.into());
        };
        let columns = std::str::from_utf8(first).ok().map(cells);
        let columns = columns.filter(|columns| columns.len() > 1);
        ("a table whose header begins", columns)
    };
    match columns {
        Some(columns) => {
            let named: Vec<String> = columns
                .iter()
                .take(4)
                .map(|c| quoted(c.as_bytes()))
                .collect();
            let more = if columns.len() > 4 { ", ..." } else { "" };
            (
                format!("{what} {}{more}", named.join(", ")),
                "`frame` or `time` and then `<joint>_x`, `<joint>_y`, `<joint>_z` joint by joint (metres), or \
                 `time,root_x,root_y,root_z,root_yaw` and joint angles"
                    .into(),
            )
        }
        None => ("no motion format".into(), MOTIONS.into()),
    }
}

/// The names in the header of a table.
fn cells(header: &str) -> Vec<String> {
    let cells = header.split(',').map(|c| c.trim().trim_matches('"'));
    cells.map(str::to_owned).collect()
}

/// A table's kind by the names of its columns.
fn table(columns: &[String]) -> Option<Kind> {
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let (&key, columns) = columns.split_first()?;
    if key == "time" && columns.starts_with(&["root_x", "root_y", "root_z", "root_yaw"]) {
        return Some(Kind::Angles);
    }
    let triple = |three: &[&str]| match three {
        [x, y, z] => x
            .strip_suffix("_x")
            .is_some_and(|j| y.strip_suffix("_y") == Some(j) && z.strip_suffix("_z") == Some(j)),
        _ => false,
    };
    let positions = !columns.is_empty() && columns.chunks(3).all(triple);
    match key {
        "frame" if positions => Some(Kind::Positions),
        "time" if positions => Some(Kind::TimedPositions),
        _ => None,
    }
}

/// Reads the bytes of a motion of a known kind. `rate_hz` serves formats without a time base; `skeleton` is the one
/// that an AMC belongs to.
///
/// # Errors
/// [`crate::FormatError`] of the format's reader; for an archive or a skeleton, which are no motions.
pub fn parse(
    kind: Kind,
    name: &str,
    bytes: &[u8],
    rate_hz: Option<f64>,
    skeleton: Option<&asf::Skeleton>,
) -> Result<Recording> {
    match kind {
        Kind::Bvh => bvh::parse(name, bytes),
        Kind::DeepMimic => deepmimic::parse(name, bytes),
        Kind::Amc => match skeleton {
            Some(skeleton) => amc::parse(name, bytes, skeleton, rate_hz),
            None => Err(Blame(name).file("an AMC without its ASF", "a skeleton file beside it")),
        },
        Kind::Asf => Err(Blame(name).file("a skeleton", "a motion (`.amc`) of it")),
        Kind::Positions | Kind::TimedPositions => positions::parse(name, bytes, rate_hz),
        Kind::Msr => msr::parse(name, bytes, rate_hz),
        Kind::Angles => body_angles::parse(name, bytes),
        Kind::Parquet => match by_own_columns(bytes) {
            // Its reader tells what is wrong.
            Some(Kind::Parquet) => body_angles::parse(name, bytes),
            Some(kind) => parse(kind, name, bytes, rate_hz, skeleton),
            None => {
                let (found, expected) = unknown(bytes);
                Err(Blame(name).file(found, expected))
            }
        },
        Kind::C3d => c3d::parse(name, bytes),
        Kind::Zip => Err(Blame(name).file("an archive inside an archive", "a motion")),
    }
}
