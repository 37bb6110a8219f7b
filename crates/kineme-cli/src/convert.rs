//! `kineme convert`: motions as BVH, CSV, Parquet or NPZ, as they are or on another body.

use std::path::PathBuf;
use std::sync::Arc;

use kineme::{Format, Motion, Recording, Skeleton, Source as Origin};
use kineme_formats::input::Entry;
use kineme_formats::positions::Frame;
use kineme_formats::tables::body_angles;
use kineme_formats::{bvh, npz, output, positions};
use kineme_paper::figures::counted;
use serde_json::json;

use crate::args::{ConvertArgs, Global, Written};
use crate::bodies;
use crate::failure::{Failure, print};
use crate::outputs::{existing, mirrored, refuse_existing, unwritten};
use crate::source::{Source, print_warnings};

/// What is asked of every motion.
struct Job<'a> {
    source: &'a Source,
    body: Option<Arc<Skeleton>>,
    rate_hz: Option<f64>,
    what: What,
}

/// What is written of it.
#[derive(Debug, Clone, Copy)]
enum What {
    Bvh,
    /// A table of a body's joint angles, as CSV or Parquet.
    Angles(Table),
    /// Rotations or joint angles, and positions, as NPZ.
    Arrays,
    /// A table of positions, as CSV or Parquet.
    Positions(Frame, Table),
    /// Positions as NPZ.
    PositionArrays(Frame),
}

/// How a table is written.
#[derive(Debug, Clone, Copy)]
enum Table {
    Csv,
    Parquet,
}

/// What was made of a motion.
struct Made {
    motion: String,
    bytes: Vec<u8>,
    frames: usize,
    rate_hz: f64,
    warnings: Vec<String>,
}

pub fn run(args: &ConvertArgs, global: &Global) -> Result<u8, Failure> {
    let format = format(args)?;
    let what = what(args, format)?;
    let body = args.body.as_deref().map(bodies::any).transpose()?;
    let source = Source::open(std::slice::from_ref(&args.input), &args.read)?;
    let job = Job {
        source: &source,
        body,
        rate_hz: args.rate,
        what,
    };
    let entries: Vec<&Entry> = source.inputs.entries.iter().collect();
    let names: Vec<&str> = entries.iter().map(|e| e.name()).collect();
    let shown = args.input.to_string_lossy();
    let shown = shown.trim_end_matches(['/', '\\']);
    let to_stdout = args.out.as_os_str() == "-";
    if names == [shown] {
        return one(&job, entries[0], args, global);
    }
    if to_stdout {
        return Err(Failure::usage(format!(
            "`{shown}` holds {} motions, which one stream cannot",
            names.len()
        ))
        .hint("give a folder for OUT"));
    }
    if Written::of(&args.out).is_some() {
        return Err(Failure::usage(format!(
            "`{shown}` is a folder or an archive, and so must OUT be a folder, not `{}`",
            args.out.display()
        )));
    }
    many(
        &job,
        &entries,
        &mirrored(&names, shown, format.extension()),
        args,
        global,
    )
}

/// One motion to one file, or to stdout.
fn one(job: &Job, entry: &Entry, args: &ConvertArgs, global: &Global) -> Result<u8, Failure> {
    let to_stdout = args.out.as_os_str() == "-";
    if to_stdout && global.json {
        return Err(Failure::usage(
            "stdout cannot hold both the motion and --json",
        ));
    }
    if !to_stdout {
        refuse_existing([args.out.as_path()], global)?;
    }
    let made = job.make(entry)?;
    print_warnings([(made.motion.as_str(), made.warnings.as_slice())]);
    if to_stdout {
        print(&made.bytes)?;
        return Ok(0);
    }
    output::write_bytes(&args.out, existing(global), &made.bytes).map_err(unwritten)?;
    tell(&[(made, args.out.clone())], global)?;
    Ok(0)
}

/// Every motion to a file of its own.
fn many(
    job: &Job,
    entries: &[&Entry],
    paths: &[PathBuf],
    args: &ConvertArgs,
    global: &Global,
) -> Result<u8, Failure> {
    let paths: Vec<PathBuf> = paths.iter().map(|p| args.out.join(p)).collect();
    refuse_existing(paths.iter().map(PathBuf::as_path), global)?;
    let read = job.source.each(entries, "converting", |i, entry| {
        let mut made = job.make(entry)?;
        let path = paths[i].clone();
        output::write_bytes(&path, existing(global), &made.bytes).map_err(unwritten)?;
        made.bytes = Vec::new();
        Ok((made, path))
    });
    print_warnings(
        read.items
            .iter()
            .map(|(made, _)| (made.motion.as_str(), made.warnings.as_slice())),
    );
    tell(&read.items, global)?;
    Ok(read.unless_failed()?.print_skipped())
}

/// Says what was written.
fn tell(written: &[(Made, PathBuf)], global: &Global) -> Result<(), Failure> {
    let mut text = String::new();
    for (made, path) in written {
        let out = path.display().to_string();
        if global.json {
            let line = json!({"motion": made.motion, "out": out, "frames": made.frames});
            text.push_str(&format!("{line}\n"));
        } else {
            let rate = (1000.0 * made.rate_hz).round() / 1000.0;
            text.push_str(&format!(
                "{out}: {} at {rate} Hz\n",
                counted(made.frames, "frame")
            ));
        }
    }
    print(text.as_bytes())
}

impl Job<'_> {
    fn make(&self, entry: &Entry) -> Result<Made, Failure> {
        let recording = self.source.read(entry)?;
        match &self.body {
            Some(body) => self.on_body(&recording, body),
            None => self.as_it_is(recording),
        }
    }

    fn as_it_is(&self, recording: Recording) -> Result<Made, Failure> {
        let recording = match self.rate_hz {
            Some(rate) => recording
                .resampled(rate)
                .map_err(|e| Failure::failed(format!("{}: {e}", recording.name())))?,
            None => recording,
        };
        Ok(Made {
            motion: recording.name().into(),
            bytes: self.written(&recording)?,
            frames: recording.frames(),
            rate_hz: recording.rate_hz(),
            warnings: recording.source().warnings.clone(),
        })
    }

    fn on_body(&self, recording: &Recording, body: &Arc<Skeleton>) -> Result<Made, Failure> {
        let (motion, warnings) = self.source.retarget(recording, body)?;
        let motion = match self.rate_hz {
            Some(rate) => motion
                .resampled(rate)
                .map_err(|e| Failure::failed(format!("{}: {e}", recording.name())))?,
            None => motion,
        };
        let bytes = match self.what {
            What::Angles(Table::Csv) => body_angles::table(&motion)
                .write(motion.name())
                .map_err(unwritten)?,
            What::Angles(Table::Parquet) => body_angles::table(&motion)
                .write_parquet(motion.name())
                .map_err(unwritten)?,
            What::Arrays => npz::write(&motion).map_err(unwritten)?,
            _ => self.written(&as_recording(&motion, recording)?)?,
        };
        Ok(Made {
            motion: motion.name().into(),
            bytes,
            frames: motion.frames(),
            rate_hz: motion.rate_hz(),
            warnings,
        })
    }

    fn written(&self, recording: &Recording) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        match self.what {
            What::Positions(frame, Table::Csv) => {
                positions::write(recording, frame, &mut bytes).map_err(unwritten)?;
            }
            What::Positions(frame, Table::Parquet) => {
                bytes = positions::write_parquet(recording, frame).map_err(unwritten)?;
            }
            What::PositionArrays(frame) => {
                bytes = npz::write_positions(recording, frame).map_err(unwritten)?;
            }
            What::Arrays => bytes = npz::write_recording(recording).map_err(unwritten)?,
            What::Bvh | What::Angles(_) => bvh::write(recording, &mut bytes).map_err(|e| {
                unwritten(e)
                    .hint("--body ares gives positions a skeleton; --positions writes them as CSV")
            })?,
        }
        Ok(bytes)
    }
}

/// A motion of a body as a recording in the axes and the unit of the file that it came from.
fn as_recording(motion: &Motion, from: &Recording) -> Result<Recording, Failure> {
    let origin = Origin {
        format: Format::Synthetic,
        up: from.source().up,
        unit_metres: from.source().unit_metres,
        warnings: Vec::new(),
    };
    Ok(Recording::from_motion(motion).with_source(origin)?)
}

/// The format to write: said by `--to`, else by OUT's name, else BVH for a folder or stdout.
fn format(args: &ConvertArgs) -> Result<Written, Failure> {
    let extension = args
        .out
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    if let Some(to) = args.to {
        return Ok(to);
    }
    if let Some(format) = Written::of(&args.out) {
        return Ok(format);
    }
    let is_one_file = args.input.is_file()
        && kineme_formats::detect::by_extension(&args.input.to_string_lossy())
            != Some(kineme_formats::detect::Kind::Zip);
    match extension {
        Some(other) if is_one_file => Err(Failure::usage(format!(
            "`{}`: `.{other}` is no format that can be written",
            args.out.display()
        ))
        .hint("write .bvh, .csv, .parquet or .npz, or say --to bvh, --to csv, --to parquet or --to npz")),
        _ => Ok(Written::Bvh),
    }
}

fn what(args: &ConvertArgs, format: Written) -> Result<What, Failure> {
    let frame = if args.native {
        Frame::Native
    } else {
        Frame::Metres
    };
    let table = match format {
        Written::Parquet => Table::Parquet,
        _ => Table::Csv,
    };
    match (format, args.positions) {
        (Written::Npz, true) => Ok(What::PositionArrays(frame)),
        (Written::Npz, false) => Ok(What::Arrays),
        (Written::Csv | Written::Parquet, true) => Ok(What::Positions(frame, table)),
        (Written::Csv | Written::Parquet, false) if args.body.is_some() => Ok(What::Angles(table)),
        (Written::Csv | Written::Parquet, false) => Err(Failure::usage(
            "a table of joint angles needs a body to have the joints of",
        )
        .hint("--body ares for joint angles, or --positions for where the joints are")),
        (Written::Bvh, false) => Ok(What::Bvh),
        (Written::Bvh, true) => Err(Failure::usage("BVH holds rotations, not positions")
            .hint("write .csv or .parquet with --positions")),
    }
}
