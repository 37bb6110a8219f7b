//! Vocabularies of the command line: read, written, modelled.

use std::io::Read as _;
use std::path::Path;

use kineme::primitive::{Interpolation, Mismatched, Parameterisation};
use kineme::{Exemplar, Modelling, Primitive, Provenance, Skeleton, Vocabulary};
use kineme_formats::{FormatError, Place, output, vocabulary};
use rayon::prelude::*;

use crate::args::{Global, InterpolationName, ModelArgs, Parameters};
use crate::failure::{Failure, print};
use crate::outputs::{existing, refuse_existing, unwritten};
use crate::progress;
use crate::warnings::Warnings;

/// How notes of a primitive begin that tell of an exemplar it does without.
const LEFT_OUT: &str = "left out: ";

/// The bytes of a file that is no motion, and its name for messages; `-` is stdin.
pub fn read_bytes(path: &Path, expected: &str) -> Result<(String, Vec<u8>), Failure> {
    let shown = path.display().to_string();
    let read = if shown == "-" {
        let mut bytes = Vec::new();
        let read = std::io::stdin().lock().read_to_end(&mut bytes);
        read.map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    match read {
        Ok(bytes) => Ok((shown, bytes)),
        Err(e) => {
            Err(FormatError::new(&shown, Place::File, kineme_formats::told(&e), expected).into())
        }
    }
}

/// The vocabulary in a file.
pub fn read(path: &Path) -> Result<Vocabulary, Failure> {
    let (shown, bytes) = read_bytes(path, "a vocabulary file")?;
    Ok(vocabulary::read(&shown, &bytes)?)
}

/// The vocabulary in a file, by which movement is to be recognised: no primitive is called what an answer is called.
pub fn to_recognise(path: &Path) -> Result<Vocabulary, Failure> {
    let vocabulary = read(path)?;
    check_names(&vocabulary).map_err(|(name, failure)| {
        failure.hint(format!(
            "`kineme edit {} -o OUT --rename {name}=NAME` gives it another",
            path.display()
        ))
    })?;
    Ok(vocabulary)
}

/// The first primitive whose name an answer bears, and what to say of it.
fn check_names(vocabulary: &Vocabulary) -> Result<(), (String, Failure)> {
    let mut names = vocabulary.primitives().iter().map(|p| p.name());
    match names.find(|name| ["rest", "none"].contains(name)) {
        None => Ok(()),
        Some(name) => {
            let message = format!("the primitive `{name}` bears the name of an answer");
            Err((name.to_owned(), Failure::failed(message)))
        }
    }
}

/// The primitive of this name; an unknown one is the command line's fault.
pub fn primitive<'a>(vocabulary: &'a Vocabulary, name: &str) -> Result<&'a Primitive, Failure> {
    let found = vocabulary.primitive(name);
    found.map_err(|e| Failure::usage(e.to_string()))
}

/// Refuses, before any work, to overwrite a file or to send two things to stdout.
pub fn check_out(out: &Path, what: &str, global: &Global) -> Result<(), Failure> {
    if out.as_os_str() != "-" {
        return refuse_existing([out], global);
    }
    if global.json {
        return Err(Failure::usage(format!(
            "stdout cannot hold both the {what} and --json"
        )));
    }
    Ok(())
}

/// Writes a vocabulary and then what there is to tell of it, unless stdout holds the vocabulary.
pub fn write(
    vocabulary: &Vocabulary,
    out: &Path,
    told: &str,
    global: &Global,
) -> Result<(), Failure> {
    let shown = out.display().to_string();
    let bytes = vocabulary::write(vocabulary, &shown).map_err(unwritten)?;
    if shown == "-" {
        return print(&bytes);
    }
    output::write_bytes(out, existing(global), &bytes).map_err(unwritten)?;
    print(told.as_bytes())?;
    if !global.json {
        print(format!("\nwritten: {shown}\n").as_bytes())?;
    }
    Ok(())
}

/// The vocabulary with what recognisers learn of it; what they knew of the primitives of `before` they keep.
pub fn calibrated(
    vocabulary: Vocabulary,
    before: Option<&Vocabulary>,
) -> Result<Vocabulary, Failure> {
    check_names(&vocabulary).map_err(|(_, failure)| {
        failure
            .hint("recognisers answer `rest` and `none` where no primitive is: choose another name")
    })?;
    let spinner = progress::spinner();
    spinner.set_message("calibrating recognition");
    let calibrated = kineme::perception::calibrated(vocabulary, before);
    spinner.finish_and_clear();
    Ok(calibrated?)
}

/// How the command line wants exemplars modelled.
pub fn modelling(args: &ModelArgs, body: &Skeleton) -> Result<Modelling, Failure> {
    let interpolation = match args.interpolation {
        InterpolationName::Automatic => Interpolation::Automatic,
        InterpolationName::VerbsAndAdverbs => Interpolation::VerbsAndAdverbs,
        InterpolationName::Shepard => Interpolation::Shepard,
    };
    let parameterisation = match &args.parameters {
        None | Some(Parameters::Automatic) => Parameterisation::Automatic,
        Some(Parameters::Principal) => Parameterisation::Principal,
        Some(Parameters::Effector(name)) => {
            body.effector(name).map_err(|e| {
                Failure::usage(format!(
                    "--parameters automatic, principal or an effector: {e}"
                ))
            })?;
            Parameterisation::Effector(name.clone())
        }
    };
    Ok(Modelling {
        parameterisation,
        interpolation,
        mismatched: Mismatched::LeaveOut,
        ..Modelling::default()
    })
}

/// Refuses names of `--cyclic` that are none of the primitives to be modelled.
pub fn check_cyclic(args: &ModelArgs, names: &[&str]) -> Result<(), Failure> {
    match args.cyclic.iter().find(|c| !names.contains(&c.as_str())) {
        Some(unknown) => {
            let known = names.iter().copied();
            let error = kineme::Error::unknown_name("primitive to model", unknown, known);
            Err(Failure::usage(format!("--cyclic: {error}")))
        }
        None => Ok(()),
    }
}

/// Exemplars that are to become a primitive.
pub struct Lesson {
    /// The primitive's name.
    pub name: String,
    /// Its exemplars.
    pub exemplars: Vec<Exemplar>,
    /// Where somebody said so of each, as messages name the place: `labels.csv:7`; `None` where nobody did.
    pub places: Vec<Option<String>>,
    /// How they are modelled.
    pub modelling: Modelling,
}

/// What came of it.
pub struct Learned {
    /// The primitive.
    pub primitive: Primitive,
    /// Why exemplars were left out of it.
    pub left_out: Vec<Failure>,
}

impl Lesson {
    fn learn(self) -> Result<Learned, Failure> {
        let given: Vec<Provenance> = self
            .exemplars
            .iter()
            .map(|e| e.provenance.clone())
            .collect();
        let labels: Vec<String> = self.exemplars.iter().map(Exemplar::label).collect();
        let primitive =
            Primitive::learn(&self.name, self.exemplars, &self.modelling).map_err(|e| {
                let failure = Failure::from(e.clone());
                let named = format!("`{}`", self.name);
                if e.to_string().contains(&named) {
                    failure
                } else {
                    failure.at(&named)
                }
            })?;
        let mut kept = primitive
            .exemplars()
            .iter()
            .map(|e| &e.provenance)
            .peekable();
        let mut left_out = Vec::new();
        for ((given, label), place) in given.iter().zip(labels).zip(self.places) {
            if kept.next_if_eq(&given).is_some() {
                continue;
            }
            let told = primitive.notes().find_map(|note| {
                let note = note.strip_prefix(LEFT_OUT)?;
                note.starts_with(&label).then(|| note.to_owned())
            });
            let told = told.unwrap_or_else(|| format!("{label} is of another structure"));
            let failure = Failure::failed(format!("{told}: no exemplar of `{}`", self.name));
            left_out.push(match place {
                Some(place) => failure.at(&place),
                None => failure,
            });
        }
        Ok(Learned {
            primitive,
            left_out,
        })
    }
}

/// Makes primitives, in order, on all threads. An exemplar of another structure than the others ends the run, or is
/// left out and told in the second list.
pub fn learn(
    lessons: Vec<Lesson>,
    keep_going: bool,
) -> Result<(Vec<Primitive>, Vec<Failure>), Failure> {
    let bar = progress::bar(lessons.len(), "modelling");
    let learned: Vec<Result<Learned, Failure>> = lessons
        .into_par_iter()
        .with_max_len(1)
        .map(|lesson| {
            let learned = lesson.learn();
            bar.inc(1);
            learned
        })
        .collect();
    bar.finish_and_clear();
    let (mut primitives, mut left_out) = (Vec::new(), Vec::new());
    for learned in learned {
        let learned = learned?;
        if let (false, Some(first)) = (keep_going, learned.left_out.first()) {
            return Err(first
                .clone()
                .hint("give such a movement a name of its own, or take it out"));
        }
        primitives.push(learned.primitive);
        left_out.extend(learned.left_out);
    }
    Ok((primitives, left_out))
}

/// Tells the notes of primitives on stderr, each kind once; those on exemplars that were left out only where nothing
/// else lists these.
pub fn print_notes<'a>(primitives: impl IntoIterator<Item = &'a Primitive>, with_left_out: bool) {
    let mut warnings = Warnings::default();
    for primitive in primitives {
        for note in primitive.notes() {
            if with_left_out || !note.starts_with(LEFT_OUT) {
                warnings.add(primitive.name(), note);
            }
        }
    }
    warnings.print();
}
