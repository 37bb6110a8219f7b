//! `kineme synthesize`: a motion of a primitive.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::control::{Entry, Manner, Pace, State, Synthesis};
use kineme::primitive::Reached;
use kineme::{Primitive, Skeleton};
use kineme_formats::output;
use kineme_paper::figures::counted;
use nalgebra::Vector3;
use serde::Serialize;

use crate::args::{Global, ReadArgs, SynthesizeArgs, Target, Written};
use crate::describe::short;
use crate::failure::{Failure, complain, print};
use crate::outputs::{existing, unwritten};
use crate::source::{Source, print_warnings};
use crate::vocabularies::{check_out, primitive, read};

/// A miss from here on is warned of, metres: more than a fist is wide to either side.
const FAR_M: f64 = 0.03;

/// What was written, as `--json` tells it.
#[derive(Serialize)]
struct Told<'a> {
    primitive: &'a str,
    parameters: &'a [f64],
    phase: Option<f64>,
    reach: Option<Aimed<'a>>,
    duration: f64,
    frames: usize,
    rate: f64,
}

/// Metres in the thorax frame.
#[derive(Serialize)]
struct Aimed<'a> {
    effector: &'a str,
    target: [f64; 3],
    position: [f64; 3],
    miss: f64,
}

pub fn run(args: &SynthesizeArgs, global: &Global) -> Result<u8, Failure> {
    let format = format(args)?;
    check_out(&args.out, "motion", global)?;
    let vocabulary = read(&args.vocabulary)?;
    let primitive = primitive(&vocabulary, &args.primitive)?;
    if args.cycles.is_some() && !primitive.is_cyclic() {
        return Err(Failure::usage(format!(
            "`{}` is a stroke, which has no cycles",
            primitive.name()
        )));
    }
    let from = args.from_pose.as_deref();
    let from = from
        .map(|from| start(from, vocabulary.body(), &args.read))
        .transpose()?;
    let reached = args
        .reach
        .as_ref()
        .map(|target| reach(primitive, target))
        .transpose()?;
    let asked = match (&args.at, &reached) {
        (Some(values), _) => {
            let space = primitive.parameters();
            let unit = space.to_unit(&values.0);
            unit.map_err(|e| {
                Failure::usage(format!("--at: `{}`: {e}", primitive.name()))
                    .hint("`kineme show VOCAB` prints parameters and their ranges")
            })?
        }
        (None, Some(reached)) => reached.parameters.clone(),
        (None, None) => primitive.middle(),
    };
    let course = Arc::new(primitive.at(&asked)?);
    let parameters = primitive.parameters().from_unit(course.parameters());
    let moved = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-9;
    if asked.iter().zip(course.parameters()).any(moved) {
        complain(&format!(
            "warning: the exemplars do not reach that far: {} instead",
            named(primitive, &parameters)
        ));
    }
    let manner = Manner {
        // A cycle may be joined anywhere; of a stroke the whole was asked for.
        entry: match (primitive.is_cyclic(), &from) {
            (true, Some(_)) => Entry::MATCHED,
            _ => Entry::Start,
        },
        pace: args.duration.map_or(Pace::Times(1.0), Pace::Secs),
        cycles: args.cycles.map(|n| u32::try_from(n).unwrap_or(u32::MAX)),
    };
    let synthesis = Synthesis {
        rate_hz: args.rate,
        from,
        manner,
        ..Synthesis::default()
    };
    let made = synthesis
        .motion(primitive.name(), &course)
        .map_err(|e| match args.duration {
            Some(_) if e.is_invalid() => Failure::usage(format!("--duration: {e}")),
            _ => e.into(),
        })?;
    let motion = &made.motion;
    if made.limited_frames > 0 {
        complain(&format!(
            "note: joint limits hold the movement back in {} of {} frames",
            made.limited_frames,
            motion.frames()
        ));
    }
    if let (Some(target), Some(reached)) = (&args.reach, &reached) {
        tell_reached(primitive, target, reached, &parameters);
    }
    let bytes = format.bytes(motion)?;
    if args.out.as_os_str() == "-" {
        print(&bytes)?;
        return Ok(0);
    }
    output::write_bytes(&args.out, existing(global), &bytes).map_err(unwritten)?;
    let told = Told {
        primitive: primitive.name(),
        parameters: &parameters,
        phase: reached.as_ref().map(|r| r.phase),
        reach: args
            .reach
            .as_ref()
            .zip(reached.as_ref())
            .map(|(t, r)| Aimed {
                effector: &t.effector,
                target: t.place,
                position: r.position.into(),
                miss: r.miss_m,
            }),
        duration: motion.duration_secs(),
        frames: motion.frames(),
        rate: motion.rate_hz(),
    };
    print(text(&told, primitive, &args.out, global)?.as_bytes())?;
    Ok(0)
}

fn text(
    told: &Told,
    primitive: &Primitive,
    out: &Path,
    global: &Global,
) -> Result<String, Failure> {
    if global.json {
        let line = serde_json::to_string(told).map_err(|e| Failure::failed(e.to_string()))?;
        return Ok(format!("{line}\n"));
    }
    let with = match told.parameters {
        [] => String::new(),
        parameters => format!(" at {}", named(primitive, parameters)),
    };
    Ok(format!(
        "{}: {}{with}, {:.2} s, {} at {} Hz\n",
        out.display(),
        told.primitive,
        told.duration,
        counted(told.frames, "frame"),
        short(told.rate)
    ))
}

/// `height 0.5, side 0.2`.
fn named(primitive: &Primitive, parameters: &[f64]) -> String {
    let axes = primitive.parameters().axes().iter().zip(parameters);
    let told: Vec<String> = axes
        .map(|(a, v)| format!("{} {}", a.name, short(*v)))
        .collect();
    told.join(", ")
}

fn format(args: &SynthesizeArgs) -> Result<Written, Failure> {
    if let Some(format) = args.to.or_else(|| Written::of(&args.out)) {
        return Ok(format);
    }
    let message = match args.out.to_str() {
        Some("-") => "stdout says no format".into(),
        _ => format!(
            "`{}` says no format that can be written",
            args.out.display()
        ),
    };
    Err(Failure::usage(message).hint(
        "write .bvh, .csv, .parquet or .npz, or say --to bvh, --to csv, --to parquet or --to npz",
    ))
}

fn reach(primitive: &Primitive, target: &Target) -> Result<Reached, Failure> {
    let aim = primitive
        .aim(&target.effector)
        .map_err(|e| Failure::usage(format!("--reach: {e}")))?;
    Ok(aim.at(&Vector3::from(target.place)))
}

/// Says on stderr where the effector comes, and when that is not where it was sent.
fn tell_reached(primitive: &Primitive, target: &Target, reached: &Reached, parameters: &[f64]) {
    let place = |p: &[f64]| {
        let numbers: Vec<String> = p.iter().map(|v| format!("{v:.3}")).collect();
        format!("({})", numbers.join(", "))
    };
    let with = match parameters {
        [] => "it has no parameters".into(),
        _ => format!("with {}", named(primitive, parameters)),
    };
    let far = reached.miss_m > FAR_M;
    complain(&format!(
        "{}: {} comes to {} m at phase {:.2}, {:.1} cm from {}, {with}{}",
        if far { "warning" } else { "note" },
        target.effector,
        place(reached.position.as_slice()),
        reached.phase,
        100.0 * reached.miss_m,
        place(&target.place),
        if far {
            "; its exemplars lead no nearer"
        } else {
            ""
        }
    ));
}

/// The posture that `FILE[@SECS]` names, on the body.
fn start(from: &str, body: &Arc<Skeleton>, args: &ReadArgs) -> Result<State, Failure> {
    let (file, secs) = match from.rsplit_once('@') {
        Some((file, secs)) if !Path::new(from).exists() => match secs.parse::<f64>() {
            Ok(secs) if secs.is_finite() && secs >= 0.0 => (file, secs),
            _ => {
                return Err(Failure::usage(format!(
                    "--from-pose: `{secs}` are no seconds from 0 on"
                )));
            }
        },
        _ => (from, 0.0),
    };
    let path: PathBuf = Path::new(file).components().collect();
    let (source, mut entries) = Source::one_by_one(&[(path, None)], args)?;
    // One path leads to one entry, or to why there is none.
    let entry = entries.swap_remove(0)?;
    let recording = source.read(&entry)?;
    let (motion, warnings) = source.retarget(&recording, body)?;
    print_warnings([(motion.name(), warnings.as_slice())]);
    let frame = (secs * motion.rate_hz()).round();
    if frame >= motion.frames() as f64 {
        return Err(Failure::usage(format!(
            "--from-pose: {secs} s is behind the end of `{file}`, at {:.3} s",
            motion.duration_secs()
        )));
    }
    Ok(State::at_frame(&motion, frame as usize)?)
}
