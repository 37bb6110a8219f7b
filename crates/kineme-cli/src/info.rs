//! `kineme info`: what motion files hold.

use kineme::Recording;
use kineme::math::rotation::Axis;
use kineme::retargeting::RoleMap;
use serde::Serialize;

use crate::args::{Global, InfoArgs};
use crate::failure::{Failure, print};
use crate::source::{Jointed, Source, print_warnings};
use crate::table::{Side, aligned};

/// A motion, as `--json` tells it.
#[derive(Debug, Serialize)]
struct Facts {
    motion: String,
    format: &'static str,
    joints: usize,
    dof: usize,
    frames: usize,
    rate: f64,
    duration: f64,
    warnings: Vec<String>,
    #[serde(skip)]
    axes: Axes,
}

/// What people also want to know.
#[derive(Debug)]
struct Axes {
    up: &'static str,
    unit: String,
    profile: String,
}

pub fn run(args: &InfoArgs, global: &Global) -> Result<u8, Failure> {
    let source = Source::open(&args.inputs, &args.read)?;
    let entries: Vec<_> = source.inputs.entries.iter().collect();
    let read = source.each(&entries, "reading", |_, entry| {
        let recording = source.read(entry)?;
        let profile = profile(&source.jointed(&recording)?);
        Ok(facts(&recording, profile))
    });
    if global.json {
        let mut lines = Vec::new();
        for facts in &read.items {
            serde_json::to_writer(&mut lines, facts).map_err(|e| Failure::failed(e.to_string()))?;
            lines.push(b'\n');
        }
        print(&lines)?;
    } else {
        if !read.items.is_empty() {
            print(text(&read.items).as_bytes())?;
        }
        print_warnings(
            read.items
                .iter()
                .map(|f| (f.motion.as_str(), f.warnings.as_slice())),
        );
    }
    Ok(read.unless_failed()?.print_skipped())
}

/// The profile that finds all roles that are needed.
fn profile(jointed: &Jointed<'_>) -> Option<String> {
    let joints = jointed.recording.joints().iter();
    let names: Vec<&str> = joints.map(|j| j.name.as_str()).collect();
    let map = match &jointed.profile {
        Some(given) => given.matched(&names),
        None => RoleMap::detect(&names).ok()?,
    };
    map.missing().is_empty().then_some(map.profile)
}

fn facts(recording: &Recording, profile: Option<String>) -> Facts {
    // Rates are written as frame times of few digits: 1/0.0083333 means 120.
    let rounded = |value: f64| (1000.0 * value).round() / 1000.0;
    let from = recording.source();
    Facts {
        motion: recording.name().into(),
        format: from.format.name(),
        joints: recording.joints().len(),
        dof: recording.dof(),
        frames: recording.frames(),
        rate: rounded(recording.rate_hz()),
        duration: rounded(recording.duration_secs()),
        warnings: from.warnings.clone(),
        axes: Axes {
            up: match from.up {
                Axis::X => "x",
                Axis::Y => "y",
                Axis::Z => "z",
            },
            unit: unit(from.unit_metres),
            profile: profile.unwrap_or_else(|| "-".into()),
        },
    }
}

/// A unit of length by its name, else in metres.
fn unit(metres: f64) -> String {
    const NAMED: [(f64, &str); 4] = [(1.0, "m"), (0.01, "cm"), (0.001, "mm"), (0.0254, "in")];
    let named = NAMED.iter().find(|(size, _)| *size == metres);
    named.map_or_else(|| format!("{metres:.4} m"), |(_, name)| (*name).into())
}

fn text(items: &[Facts]) -> String {
    let header = [
        ("motion", Side::Left),
        ("format", Side::Left),
        ("joints", Side::Right),
        ("dof", Side::Right),
        ("frames", Side::Right),
        ("rate", Side::Right),
        ("seconds", Side::Right),
        ("up", Side::Left),
        ("unit", Side::Left),
        ("profile", Side::Left),
    ];
    let rows: Vec<Vec<String>> = items
        .iter()
        .map(|f| {
            vec![
                f.motion.clone(),
                f.format.into(),
                f.joints.to_string(),
                f.dof.to_string(),
                f.frames.to_string(),
                format!("{}", f.rate),
                format!("{:.2}", f.duration),
                f.axes.up.into(),
                f.axes.unit.clone(),
                f.axes.profile.clone(),
            ]
        })
        .collect();
    let mut text = aligned(&header, &rows);
    if items.len() > 1 {
        let seconds: f64 = items.iter().map(|f| f.duration).sum();
        let frames: usize = items.iter().map(|f| f.frames).sum();
        text.push_str(&format!(
            "\n{} motions, {frames} frames, {seconds:.1} s\n",
            items.len()
        ));
    }
    text
}
