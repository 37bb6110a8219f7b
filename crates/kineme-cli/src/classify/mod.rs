//! `kineme classify`: movements recognised by joint angles, as wholes, moment by moment, or as a stream.

mod stream;
mod told;

use kineme::Vocabulary;
use kineme::perception::Restriction;
use kineme::primitive::{Recogniser, readings};
use kineme_formats::input::Entry;

use crate::args::{ClassifierName, ClassifyArgs, Global};
use crate::failure::{Failure, complain, print};
use crate::observed::observe;
use crate::recognisers::classifier;
use crate::source::{Source, print_warnings};
use crate::vocabularies::to_recognise;
use told::{MOTION_COLUMNS, Teller};

/// What came of a motion.
struct Answered {
    motion: String,
    warnings: Vec<String>,
    /// Whether it is one of the primitives.
    is_known: bool,
    /// Lines of stdout; or rows of the table of motions.
    text: String,
    rows: Vec<Vec<String>>,
}

pub fn run(args: &ClassifyArgs, global: &Global) -> Result<u8, Failure> {
    let streamed = args.inputs.iter().any(|input| input.as_os_str() == "-");
    if streamed && args.inputs.len() > 1 {
        return Err(Failure::usage(
            "a stream on stdin is answered row by row, and alone",
        ));
    }
    if streamed && args.vocabulary.as_os_str() == "-" {
        return Err(Failure::usage(
            "stdin cannot be both the vocabulary and the stream",
        ));
    }
    let vocabulary = to_recognise(&args.vocabulary)?;
    let source = match streamed {
        true => None,
        false => Some(Source::open(&args.inputs, &args.read)?),
    };
    let restriction = restriction(&vocabulary, args)?;
    let known = restriction.as_ref().map(Restriction::vocabulary);
    let mut recogniser = classifier(args.method, &args.classifier, known.unwrap_or(&vocabulary))?;
    if let Some(restriction) = &restriction {
        recogniser = Box::new(restriction.recogniser(recogniser));
    }
    let teller = Teller::new(
        &*recogniser,
        args.classifier.lag.unwrap_or(0.0),
        global.json,
    );
    let Some(source) = source else {
        return stream::run(&*recogniser, &teller);
    };
    let entries: Vec<&Entry> = source.inputs.entries.iter().collect();
    let read = source.each(&entries, "recognising", |_, entry| {
        answer(&*recogniser, &teller, &source, entry, args.frames)
    });
    print_warnings(
        read.items
            .iter()
            .map(|a| (a.motion.as_str(), a.warnings.as_slice())),
    );
    let mut text: String = read.items.iter().map(|a| a.text.as_str()).collect();
    let rows: Vec<Vec<String>> = read.items.iter().flat_map(|a| a.rows.clone()).collect();
    if !rows.is_empty() {
        text.push_str(&crate::table::aligned(&MOTION_COLUMNS, &rows));
    }
    print(text.as_bytes())?;
    if !global.json && !read.items.is_empty() {
        hint(&read.items, args);
    }
    Ok(read.unless_failed()?.print_skipped())
}

/// The part of the body that is looked at, where it is not the whole.
fn restriction(
    vocabulary: &Vocabulary,
    args: &ClassifyArgs,
) -> Result<Option<Restriction>, Failure> {
    if args.joints.is_empty() {
        return Ok(None);
    }
    let restriction = Restriction::new(vocabulary, &args.joints).map_err(|e| {
        Failure::usage(format!("--joints: {e}"))
            .hint("such as --joints right_arm, or --joints trunk,head")
    })?;
    Ok(Some(match args.method {
        ClassifierName::Filter => restriction.calibrated()?,
        ClassifierName::Frame | ClassifierName::Paper => restriction,
    }))
}

fn answer(
    recogniser: &dyn Recogniser,
    teller: &Teller,
    source: &Source,
    entry: &Entry,
    frames: bool,
) -> Result<Answered, Failure> {
    let (seen, warnings) = observe(recogniser.vocabulary().body(), source, entry)?;
    let motion = entry.name().to_owned();
    let blamed = |e: kineme::Error| Failure::from(e).at(&motion);
    let (mut text, mut rows, mut is_known) = (String::new(), Vec::new(), false);
    if frames {
        let readings = readings(recogniser, &seen).map_err(blamed)?;
        is_known = readings.iter().any(|r| r.posterior.best().is_some());
        text.push_str(&teller.frames_head(&motion));
        for (f, reading) in readings.iter().enumerate() {
            text.push_str(&teller.frame(&motion, (0.0, seen.at(f).secs), reading)?);
        }
        text.push_str(teller.frames_end());
    } else {
        let recognition = recogniser.recognise(&seen).map_err(blamed)?;
        is_known |= recognition.posterior.best().is_some();
        match teller.json {
            true => text = teller.motion_line(&motion, &recognition)?,
            false => rows = teller.motion_rows(&motion, &recognition),
        }
    }
    Ok(Answered {
        motion,
        warnings,
        is_known,
        text,
        rows,
    })
}

/// What a person might do next.
fn hint(answered: &[Answered], args: &ClassifyArgs) {
    let shown = args.vocabulary.display();
    let strange = answered.iter().filter(|a| !a.is_known).count();
    if strange > 0 {
        let which = match (strange, answered.len()) {
            (1, 1) => "it is at rest or none of the primitives".into(),
            (n, all) => format!("{n} of {all} motions are at rest or none of the primitives"),
        };
        complain(&format!(
            "note: {which}; `kineme show {shown}` lists these, `kineme edit {shown} -o OUT --add MANIFEST.csv` gives them \
             more exemplars"
        ));
    }
    if !args.frames {
        complain(
            "note: --frames tells every moment; `kineme evaluate` how far to trust the answers",
        );
    }
}
