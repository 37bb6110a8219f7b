//! `kineme encode`: movements recognised from the paths of effectors, and said in the vocabulary's joints.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kineme::Vocabulary;
use kineme::perception::encoding::{
    EffectorPaths, Encoder, Encoding, EncodingMethod, EncodingSettings,
};
use kineme_formats::input::Entry;
use kineme_formats::output;
use serde::Serialize;

use crate::args::{EncodeArgs, EncodeMethod, Global, Written};
use crate::failure::{Failure, complain, print};
use crate::json::line;
use crate::outputs::{existing, mirrored, refuse_existing, unwritten};
use crate::source::{Source, print_warnings};
use crate::vocabularies::to_recognise;

/// A motion, as `--json` tells it.
#[derive(Serialize)]
struct Told {
    motion: String,
    label: Option<String>,
    scores: BTreeMap<String, f64>,
    posterior: BTreeMap<String, f64>,
    spans: Vec<ToldSpan>,
    rmse: Option<f64>,
    #[serde(skip)]
    warnings: Vec<String>,
}

/// Seconds, and likeness in [0, 1].
#[derive(Serialize)]
struct ToldSpan {
    start: f64,
    end: f64,
    primitive: Option<String>,
    similarity: f64,
    margin: f64,
}

pub fn run(args: &EncodeArgs, global: &Global) -> Result<u8, Failure> {
    let vocabulary = to_recognise(&args.vocabulary)?;
    let settings = settings(args, &vocabulary)?;
    let source = Source::open(&args.inputs, &args.read)?;
    let entries: Vec<&Entry> = source.inputs.entries.iter().collect();
    let outputs = outputs(args, &entries, global)?;
    let encoder = Encoder::new(&vocabulary, &settings).map_err(|e| {
        if e.is_invalid() || e.is_unknown_name() {
            Failure::usage(e.to_string())
        } else {
            e.into()
        }
    })?;
    let read = source.each(&entries, "encoding", |i, entry| {
        let recording = source.read(entry)?;
        let jointed = source.jointed(&recording)?;
        let paths = EffectorPaths::of_recording(
            &jointed.recording,
            jointed.profile.as_deref(),
            &settings.effectors,
            settings.heading_secs,
        )
        .map_err(|e| Failure::unreadable(format!("{}: {e}", recording.name())))?;
        let encoding = encoder.encode(recording.name(), &paths)?;
        if let Some((path, format)) = outputs.get(i) {
            let bytes = format.bytes(&encoding.motion)?;
            output::write_bytes(path, existing(global), &bytes).map_err(unwritten)?;
        }
        Ok(told(&recording, &encoding, &vocabulary))
    });
    print_warnings(
        read.items
            .iter()
            .map(|t| (t.motion.as_str(), t.warnings.as_slice())),
    );
    let mut lines = String::new();
    for told in &read.items {
        if global.json {
            lines.push_str(&line(told)?);
        } else {
            lines.push_str(&text(told));
        }
    }
    print(lines.as_bytes())?;
    if !global.json && read.items.len() > 1 && read.items.iter().all(|t| t.label.is_none()) {
        complain(
            "note: no motion is one of the vocabulary's; --method paper names the likest all the same",
        );
    }
    Ok(read.unless_failed()?.print_skipped())
}

fn settings(args: &EncodeArgs, vocabulary: &Vocabulary) -> Result<EncodingSettings, Failure> {
    for name in &args.effectors {
        let known = vocabulary.body().effector(name);
        known.map_err(|e| Failure::usage(format!("--effectors: {e}")))?;
    }
    Ok(EncodingSettings {
        effectors: args.effectors.clone(),
        method: match args.method {
            EncodeMethod::Default => EncodingMethod::Hypotheses,
            EncodeMethod::Paper => EncodingMethod::Paper,
        },
        decision_secs: args.interval,
        horizon_secs: args.horizon.unwrap_or(2.0 * args.interval),
        ..EncodingSettings::default()
    })
}

/// Where each motion's encoding goes, and in which format; nothing without `-o`.
fn outputs(
    args: &EncodeArgs,
    entries: &[&Entry],
    global: &Global,
) -> Result<Vec<(PathBuf, Written)>, Failure> {
    let Some(out) = &args.out else {
        return Ok(Vec::new());
    };
    if out.as_os_str() == "-" {
        return Err(Failure::usage("stdout tells what was recognised")
            .hint("give a file or a folder for the encoded motion"));
    }
    let format = Written::of(out);
    let paths = match (entries, format) {
        ([_], Some(format)) => vec![(out.clone(), format)],
        (_, Some(_)) => {
            return Err(Failure::usage(format!(
                "{} motions cannot go into one file, `{}`",
                entries.len(),
                out.display()
            ))
            .hint("give a folder"));
        }
        (_, None) => {
            let root = match args.inputs.as_slice() {
                [one] => one
                    .to_string_lossy()
                    .trim_end_matches(['/', '\\'])
                    .to_owned(),
                _ => String::new(),
            };
            let names: Vec<&str> = entries.iter().map(|e| e.name()).collect();
            let format = Written::Bvh;
            // A single file in a folder keeps its name.
            let root = if names == [root.as_str()] {
                Path::new(&root)
                    .parent()
                    .unwrap_or(Path::new(""))
                    .to_string_lossy()
                    .into_owned()
            } else {
                root
            };
            mirrored(&names, &root, format.extension())
                .into_iter()
                .map(|path| (out.join(path), format))
                .collect()
        }
    };
    refuse_existing(paths.iter().map(|(p, _)| p.as_path()), global)?;
    Ok(paths)
}

fn told(recording: &kineme::Recording, encoding: &Encoding, vocabulary: &Vocabulary) -> Told {
    let name = |k: usize| vocabulary.primitives()[k].name().to_owned();
    let named = |values: &[f64]| -> BTreeMap<String, f64> {
        let pairs = values.iter().enumerate();
        pairs.map(|(k, v)| (name(k), *v)).collect()
    };
    let mut posterior = named(&encoding.posterior.primitives);
    posterior.insert("rest".into(), encoding.posterior.rest);
    posterior.insert("none".into(), encoding.posterior.none);
    Told {
        motion: recording.name().into(),
        label: encoding.label().map(name),
        scores: named(&encoding.scores),
        posterior,
        spans: encoding
            .spans
            .iter()
            .map(|s| ToldSpan {
                start: s.start_secs,
                end: s.end_secs,
                primitive: s.primitive.map(name),
                similarity: s.similarity,
                margin: s.margin,
            })
            .collect(),
        rmse: encoding.rmse_m,
        warnings: recording.source().warnings.clone(),
    }
}

/// `take.bvh: punch .97; 0.0-0.4 s -, 0.4-1.6 s punch; hands within 4.1 cm`.
fn text(told: &Told) -> String {
    let of = |name: &str| told.posterior.get(name).copied().unwrap_or(0.0);
    let (label, certainty) = match &told.label {
        Some(label) => (label.as_str(), of(label)),
        None if of("rest") > of("none") => ("at rest", of("rest")),
        None => ("nothing known", of("none")),
    };
    let spans: Vec<String> = told
        .spans
        // Nothing known twice in a row is nothing known for longer.
        .chunk_by(|a, b| a.primitive.is_none() && b.primitive.is_none())
        .map(|run| {
            let what = run[0].primitive.as_deref().unwrap_or("-");
            format!("{:.1}-{:.1} s {what}", run[0].start, run[run.len() - 1].end)
        })
        .collect();
    let rmse = match told.rmse {
        Some(rmse) => format!("; within {:.1} cm", 100.0 * rmse),
        None => String::new(),
    };
    format!(
        "{}: {label} {:.0} %; {}{rmse}\n",
        told.motion,
        100.0 * certainty,
        spans.join(", ")
    )
}
