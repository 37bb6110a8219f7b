//! `kineme choreograph`: movements written by hand to a vocabulary.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::choreography::{Script, perform};
use kineme::{Behavior, Exemplar, Modelling, Motion, Provenance, Transitions, Vocabulary};
use kineme_formats::{output, script};
use serde_json::json;

use crate::args::{ChoreographArgs, Global, Written};
use crate::bodies::built_in;
use crate::describe;
use crate::failure::{Failure, print};
use crate::outputs::{existing, mirrored, refuse_existing, unwritten};
use crate::vocabularies::{
    self, Lesson, calibrated, check_cyclic, check_out, learn, modelling, print_notes, read_bytes,
};

/// The manifest beside the motions.
const MANIFEST: &str = "manifest.csv";

/// A motion of the script.
struct Performed {
    /// The primitive that it is an exemplar of; `None` for an animation.
    primitive: Option<String>,
    /// `jab-01`, `swat-bees`.
    name: String,
    motion: Motion,
    /// In the order of their names.
    adverbs: Vec<(String, f64)>,
}

pub fn run(args: &ChoreographArgs, global: &Global) -> Result<u8, Failure> {
    if let Some(out) = &args.out {
        check_out(out, "vocabulary", global)?;
    }
    let (shown, bytes) = read_bytes(&args.script, "a readable script")?;
    let script = script::parse(&shown, &bytes)?;
    if args.out.is_some() && script.exemplars.is_empty() {
        return Err(Failure::usage(format!(
            "`{shown}` has animations and no exemplar, which no vocabulary can be made of"
        ))
        .hint("leave -o out; --motions DIR writes the animations"));
    }
    let body = built_in(args.body.as_deref().unwrap_or(&script.body))?;
    let performed = performed(&script, &shown, &body, args.rate)?;
    let paths = args
        .motions
        .as_deref()
        .map(|folder| files(&performed, folder));
    if let Some(paths) = &paths {
        refuse_existing(paths.iter().map(PathBuf::as_path), global)?;
    }

    let mut lessons = lessons(&performed, &blake3::hash(&bytes).to_hex());
    let names: Vec<&str> = lessons.iter().map(|l| l.name.as_str()).collect();
    check_cyclic(&args.model, &names)?;
    let wanted = modelling(&args.model, &body)?;
    for lesson in &mut lessons {
        lesson.modelling = Modelling {
            adverbs: std::mem::take(&mut lesson.modelling.adverbs),
            cyclic: args.model.cyclic.contains(&lesson.name).then_some(true),
            ..wanted.clone()
        };
    }
    let mut vocabulary = None;
    if let Some(out) = &args.out {
        let (primitives, _) = learn(lessons, false)?;
        print_notes(&primitives, true);
        let behaviors = primitives.iter().map(|p| Behavior {
            name: p.name().into(),
            primitives: vec![p.name().into()],
        });
        let behaviors = behaviors.collect();
        let transitions = Transitions::none(primitives.len());
        let made = Vocabulary::new(Arc::clone(&body), primitives, behaviors, transitions)?;
        vocabulary = Some((out, calibrated(made, None)?));
    }
    if let (Some(folder), Some(paths)) = (&args.motions, &paths) {
        write_motions(&performed, folder, paths, global)?;
        // Beside a vocabulary on stdout, or a document of it, there is no room.
        let held = |out: &Path| global.json || out.as_os_str() == "-";
        if !args.out.as_deref().is_some_and(held) {
            print(told(&performed, folder, global).as_bytes())?;
        }
    }
    if let Some((out, vocabulary)) = vocabulary {
        let told = describe::all(&vocabulary, &out.display().to_string(), global)?;
        vocabularies::write(&vocabulary, out, &told, global)?;
    }
    Ok(0)
}

/// Every exemplar and animation, in the order of the script. Exemplars are numbered within their primitive.
fn performed(
    script: &Script,
    shown: &str,
    body: &Arc<kineme::Skeleton>,
    rate_hz: f64,
) -> Result<Vec<Performed>, Failure> {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut all = Vec::new();
    for exemplar in &script.exemplars {
        let number = numbers.entry(&exemplar.primitive).or_insert(0);
        *number += 1;
        let name = format!("{}-{number:02}", exemplar.primitive);
        let adverbs = exemplar.parameters.iter();
        all.push(Performed {
            primitive: Some(exemplar.primitive.clone()),
            motion: perform(&format!("{shown}/{name}"), &exemplar.keys, body, rate_hz)?,
            name,
            adverbs: adverbs
                .map(|(name, value)| (name.clone(), *value))
                .collect(),
        });
    }
    for animation in &script.animations {
        all.push(Performed {
            primitive: None,
            motion: perform(
                &format!("{shown}/{}", animation.name),
                &animation.keys,
                body,
                rate_hz,
            )?,
            name: animation.name.clone(),
            adverbs: Vec::new(),
        });
    }
    Ok(all)
}

/// The exemplars of each primitive, primitives in the order in which they first appear.
fn lessons(performed: &[Performed], blake3: &str) -> Vec<Lesson> {
    let mut lessons: Vec<Lesson> = Vec::new();
    for p in performed {
        let Some(name) = &p.primitive else {
            continue;
        };
        let at = lessons.iter().position(|l| l.name == *name);
        let at = at.unwrap_or_else(|| {
            lessons.push(Lesson {
                name: name.clone(),
                exemplars: Vec::new(),
                places: Vec::new(),
                modelling: Modelling {
                    adverbs: p.adverbs.iter().map(|(name, _)| name.clone()).collect(),
                    ..Modelling::default()
                },
            });
            lessons.len() - 1
        });
        let values: Vec<f64> = p.adverbs.iter().map(|(_, value)| *value).collect();
        lessons[at].exemplars.push(Exemplar {
            provenance: Provenance {
                motion: p.motion.name().into(),
                start_secs: 0.0,
                end_secs: p.motion.frames() as f64 / p.motion.rate_hz(),
                blake3: Some(blake3.into()),
            },
            motion: p.motion.clone(),
            adverbs: (!values.is_empty()).then_some(values),
        });
        lessons[at].places.push(None);
    }
    lessons
}

/// Where motions go, and last their manifest.
fn files(performed: &[Performed], folder: &Path) -> Vec<PathBuf> {
    let names: Vec<&str> = performed.iter().map(|p| p.name.as_str()).collect();
    // A name may hold a dot, which is no extension.
    let names: Vec<String> = names.iter().map(|n| format!("{n}.bvh")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut paths: Vec<PathBuf> = mirrored(&names, "", Written::Bvh.extension())
        .iter()
        .map(|p| folder.join(p))
        .collect();
    paths.push(folder.join(MANIFEST));
    paths
}

/// Writes all motions, and then the manifest that says what they are.
fn write_motions(
    performed: &[Performed],
    folder: &Path,
    paths: &[PathBuf],
    global: &Global,
) -> Result<(), Failure> {
    for (p, path) in performed.iter().zip(paths) {
        let bytes = Written::Bvh.bytes(&p.motion)?;
        output::write_bytes(path, existing(global), &bytes).map_err(unwritten)?;
    }
    let broken = |e: csv::Error| Failure::failed(format!("{MANIFEST}: {e}"));
    let most = performed.iter().map(|p| p.adverbs.len()).max().unwrap_or(0);
    let mut table = csv::Writer::from_writer(Vec::new());
    let header = ["file", "label"].map(String::from);
    let numbered = (1..=most).map(|i| format!("p{i}"));
    table
        .write_record(header.into_iter().chain(numbered))
        .map_err(broken)?;
    for (p, path) in performed.iter().zip(paths) {
        let file = path.strip_prefix(folder).unwrap_or(path);
        let file = file.to_string_lossy().replace('\\', "/");
        let label = p.primitive.clone().unwrap_or_default();
        let values = p.adverbs.iter().map(|(_, value)| value.to_string());
        let cells = [file, label].into_iter().chain(values);
        let padding = std::iter::repeat_n(String::new(), most - p.adverbs.len());
        table.write_record(cells.chain(padding)).map_err(broken)?;
    }
    let bytes = table
        .into_inner()
        .map_err(|e| Failure::failed(format!("{MANIFEST}: {e}")))?;
    output::write_bytes(&folder.join(MANIFEST), existing(global), &bytes).map_err(unwritten)
}

/// What was written into the folder.
fn told(performed: &[Performed], folder: &Path, global: &Global) -> String {
    let exemplars = performed.iter().filter(|p| p.primitive.is_some()).count();
    let animations = performed.len() - exemplars;
    if global.json {
        let out = folder.display().to_string();
        let line = json!({"out": out, "exemplars": exemplars, "animations": animations});
        return format!("{line}\n");
    }
    format!(
        "{}: {exemplars} exemplars and {animations} animations as BVH, and {MANIFEST}\n",
        folder.display()
    )
}
