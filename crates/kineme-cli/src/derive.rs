//! `kineme derive`: from recordings to a vocabulary.

use std::path::{Path, PathBuf};
use std::time::Instant;

use kineme::derivation::{Clustering, Cut, Derivation, Derived, Mark, SecondLevel, Stage};
use kineme::segmentation::Segmenter;
use kineme::{Modelling, Motion, Vocabulary};
use kineme_formats::input::Entry;
use kineme_formats::{FormatError, Place, marks, output, vocabulary};
use kineme_paper::figures::{Report, counted, summary};

use crate::args::{ClusteringName, DeriveArgs, Global, SecondLevelName, SegmenterName};
use crate::bodies::built_in;
use crate::failure::{Failure, complain, print};
use crate::findings::{self, Seconds};
use crate::outputs::{existing, refuse_existing, unwritten};
use crate::progress;
use crate::source::{Source, print_warnings};
use crate::vocabularies::{calibrated, print_notes};

/// A motion of the body, and where it came from.
struct Taken {
    motion: Motion,
    blake3: String,
    warnings: Vec<String>,
}

pub fn run(args: &DeriveArgs, global: &Global) -> Result<u8, Failure> {
    let to_stdout = args.out.as_os_str() == "-";
    if to_stdout && global.json {
        return Err(Failure::usage(
            "stdout cannot hold both the vocabulary and --json",
        ));
    }
    let mut written: Vec<PathBuf> = Vec::new();
    if !to_stdout {
        written.push(args.out.clone());
    }
    if let Some(folder) = &args.report {
        written.extend(Report::names().map(|name| folder.join(name)));
    }
    refuse_existing(written.iter().map(PathBuf::as_path), global)?;
    let mut settings = settings(args, global)?;
    let marks = args.marks.as_deref().map(read_marks).transpose()?;
    let body = built_in(&args.body)?;

    let begun = Instant::now();
    let source = Source::open(&args.inputs, &args.read)?;
    let mut entries: Vec<&Entry> = source.inputs.entries.iter().collect();
    if let Some((file, marks)) = &marks {
        entries = marked(&entries, file, marks)?;
    }
    let read = source.each(&entries, "reading", |_, entry| {
        let (recording, blake3) = source.read_hashed(entry)?;
        let (motion, warnings) = source.retarget(&recording, &body)?;
        Ok(Taken {
            motion,
            blake3,
            warnings,
        })
    });
    print_warnings(
        read.items
            .iter()
            .map(|t| (t.motion.name(), t.warnings.as_slice())),
    );
    let mut read = read.unless_failed()?;
    let taken = std::mem::take(&mut read.items);
    let (motions, hashes): (Vec<Motion>, Vec<String>) =
        taken.into_iter().map(|t| (t.motion, t.blake3)).unzip();
    if let Some((file, marks)) = &marks {
        settings.cut = Cut::Marks(placed(&motions, file, marks)?);
    }
    let mut clock = Clock::new(begun);
    let derived = derive(&settings, &motions, &mut clock)?;
    let vocabulary = if derived.groups.is_empty() {
        None
    } else {
        let source = |i: usize| hashes.get(i).cloned();
        let vocabulary = modelled(&derived, &motions, &source, &mut clock)?;
        clock.step(Some(Step::Calibration));
        let vocabulary = calibrated(vocabulary, None)?;
        clock.step(None);
        Some(vocabulary)
    };
    let seconds = args.timings.then(|| clock.seconds());

    let found = findings::Findings {
        derived: &derived,
        motions: &motions,
        seconds,
    };
    let told = if global.json {
        found.json()?
    } else {
        found.text()
    };
    let Some(vocabulary) = vocabulary else {
        print(told.as_bytes())?;
        read.print_skipped();
        return Err(Failure::failed(format!(
            "none of the {} segments are alike enough to make a group: no vocabulary written",
            derived.segments.len()
        ))
        .hint("give more motion, a smaller --min-size, or another --segmenter or --duration"));
    };
    let shown = args.out.display().to_string();
    let bytes = vocabulary::write(&vocabulary, &shown).map_err(unwritten)?;
    if let Some(folder) = &args.report {
        let title = format!(
            "{} from {}",
            counted(derived.groups.len(), "primitive"),
            counted(motions.len(), "motion")
        );
        let summary = summary(&derived, &motions);
        let file = if to_stdout { "" } else { shown.as_str() };
        Report::of(&derived, &motions, &vocabulary, (&title, &summary), file)?
            .write(folder, existing(global))
            .map_err(unwritten)?;
    }
    if to_stdout {
        print(&bytes)?;
        return Ok(read.print_skipped());
    }
    output::write_bytes(&args.out, existing(global), &bytes).map_err(unwritten)?;
    print(told.as_bytes())?;
    if !global.json {
        print(next(args, &shown).as_bytes())?;
    }
    Ok(read.print_skipped())
}

/// The derivation that the command line asks for; marks come later.
fn settings(args: &DeriveArgs, global: &Global) -> Result<Derivation, Failure> {
    let segmenter = match args.segmenter {
        SegmenterName::Pendulum => "pendulum",
        SegmenterName::Zfunction => "zfunction",
        SegmenterName::Changepoint => "changepoint",
        SegmenterName::Clips => "clips",
    };
    let cut = match (&args.marks, args.segmenter) {
        (Some(_), _) => Cut::Marks(Vec::new()),
        (None, SegmenterName::Clips) if args.duration.is_some() => {
            return Err(Failure::usage(
                "--duration does not go with clips, which stay whole",
            ));
        }
        (None, SegmenterName::Clips) => Cut::Clips,
        (None, _) => Cut::Segmenter {
            segmenter: Segmenter::named(segmenter)?,
            target_secs: args.duration,
        },
    };
    let mut settings = Derivation::new(cut);
    if let Some(shape) = args.shape {
        settings.features.shape = shape;
    }
    settings.neighbours = args.neighbours;
    settings.min_group = args.min_size;
    settings.clustering = match args.clustering {
        ClusteringName::Hdbscan => Clustering::Hdbscan,
        ClusteringName::SweepAndPrune => Clustering::SweepAndPrune,
    };
    settings.second_level = match args.second_level {
        SecondLevelName::Alternation => SecondLevel::Alternation,
        SecondLevelName::Isomap => SecondLevel::Isomap,
        SecondLevelName::None => SecondLevel::None,
    };
    settings.seed = global.seed;
    Ok(settings)
}

/// Runs the procedure with a line on the terminal.
fn derive(
    settings: &Derivation,
    motions: &[Motion],
    clock: &mut Clock,
) -> Result<Derived, Failure> {
    let spinner = progress::spinner();
    clock.step(None);
    let derived = settings.run(motions, &mut |stage| {
        clock.step(Some(Step::Deriving(stage)));
        spinner.set_message(stage.name());
    });
    clock.step(None);
    spinner.finish_and_clear();
    Ok(derived?)
}

/// Makes primitives of the groups with a line on the terminal, and tells what there is to know of them.
fn modelled(
    derived: &Derived,
    motions: &[Motion],
    source: &(dyn Fn(usize) -> Option<String> + Sync),
    clock: &mut Clock,
) -> Result<Vocabulary, Failure> {
    let spinner = progress::spinner();
    spinner.set_message("primitives");
    clock.step(Some(Step::Primitives));
    let vocabulary = derived.vocabulary(motions, &Modelling::default(), source);
    clock.step(None);
    spinner.finish_and_clear();
    let vocabulary = vocabulary?;
    print_notes(vocabulary.primitives(), true);
    Ok(vocabulary)
}

type Marks = (String, Vec<marks::Mark>);

fn read_marks(path: &Path) -> Result<Marks, Failure> {
    let shown = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| {
        FormatError::new(
            &shown,
            Place::File,
            kineme_formats::told(&e),
            "a readable table of marks",
        )
    })?;
    let marks = marks::parse(&shown, &bytes)?;
    Ok((shown, marks))
}

/// The place among `names` of the motion that a mark names: all of a name, or the end of just one.
fn named(names: &[&str], file: &str) -> Option<usize> {
    names.iter().position(|name| *name == file).or_else(|| {
        let end = format!("/{file}");
        let mut ending = (0..names.len()).filter(|&i| names[i].ends_with(&end));
        ending.next().filter(|_| ending.next().is_none())
    })
}

/// The inputs that marks name, in the order of the inputs; the others are not read.
fn marked<'a>(
    entries: &[&'a Entry],
    file: &str,
    marks: &[marks::Mark],
) -> Result<Vec<&'a Entry>, Failure> {
    let names: Vec<&str> = entries.iter().map(|e| e.name()).collect();
    let mut wanted = vec![false; entries.len()];
    for mark in marks {
        let at = named(&names, &mark.file).ok_or_else(|| {
            let found = format!("`{}`", mark.file);
            let expected = "the name of one of the motions given";
            Failure::from(FormatError::new(
                file,
                Place::Line(mark.line),
                found,
                expected,
            ))
            .hint("`kineme info` prints the motions' names")
        })?;
        wanted[at] = true;
    }
    let kept = entries.iter().zip(wanted).filter(|(_, w)| *w);
    Ok(kept.map(|(e, _)| *e).collect())
}

/// Marks on the motions that could be read; those on others go with them.
fn placed(motions: &[Motion], file: &str, marks: &[marks::Mark]) -> Result<Vec<Mark>, Failure> {
    let names: Vec<&str> = motions.iter().map(|m| m.name()).collect();
    let mut placed = Vec::new();
    for mark in marks {
        let Some(motion) = named(&names, &mark.file) else {
            continue;
        };
        let rate = motions[motion].rate_hz();
        let lasts = motions[motion].frames() as f64 / rate;
        if mark.start + 0.5 / rate >= lasts || mark.end > lasts + 1.0 / rate {
            return Err(FormatError::new(
                file,
                Place::Line(mark.line),
                format!("{} s to {} s", mark.start, mark.end),
                format!("a span of `{}`, which lasts {lasts:.3} s", mark.file),
            )
            .into());
        }
        placed.push(Mark {
            motion,
            start_secs: mark.start,
            end_secs: mark.end,
            recording: mark.recording.clone(),
        });
    }
    if placed.len() < marks.len() {
        complain(&format!(
            "warning: {} of {} marks are on motions that were skipped",
            marks.len() - placed.len(),
            marks.len()
        ));
    }
    Ok(placed)
}

/// What to do now.
fn next(args: &DeriveArgs, vocabulary: &str) -> String {
    let page = kineme_paper::figures::PAGE;
    let look = match &args.report {
        Some(folder) => format!("to look at: {}", folder.join(page).display()),
        None => {
            format!("to look at what was found: the same with --report DIR, then open DIR/{page}")
        }
    };
    format!("\nwritten: {vocabulary}\n{look}\nwhat its primitives are: kineme show {vocabulary}\n")
}

/// What is timed.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// A stage of the derivation.
    Deriving(Stage),
    /// Making primitives of groups.
    Primitives,
    /// What recognisers learn of them.
    Calibration,
}

/// Times of the steps.
struct Clock {
    begun: Instant,
    since: Instant,
    step: Option<Step>,
    seconds: Seconds,
}

impl Clock {
    /// A clock whose reading began at `begun` and ends now.
    fn new(begun: Instant) -> Self {
        Self {
            begun,
            since: Instant::now(),
            step: None,
            seconds: Seconds {
                reading: begun.elapsed().as_secs_f64(),
                ..Seconds::default()
            },
        }
    }

    /// Ends a step and begins the next.
    fn step(&mut self, next: Option<Step>) {
        let took = self.since.elapsed().as_secs_f64();
        let of = &mut self.seconds;
        match self.step {
            Some(Step::Deriving(Stage::Segmentation)) => of.segmentation += took,
            Some(Step::Deriving(Stage::Distances)) => of.distances += took,
            Some(Step::Deriving(Stage::Embedding)) => of.embedding += took,
            Some(Step::Deriving(Stage::Clustering)) => of.clustering += took,
            Some(Step::Primitives) => of.primitives += took,
            Some(Step::Calibration) => of.calibration += took,
            None => {}
        }
        of.total = self.begun.elapsed().as_secs_f64();
        self.since = Instant::now();
        self.step = next;
    }

    fn seconds(&self) -> Seconds {
        self.seconds
    }
}
