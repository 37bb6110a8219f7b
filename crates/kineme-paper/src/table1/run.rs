//! [`table1`]: every row.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use kineme::Vocabulary;
use kineme::evaluation::Estimate;
use kineme::math::statistics::quantile;
use kineme::perception::calibrated;
use kineme::primitive::Recogniser;
use rayon::prelude::*;

use super::captured::{Captured, recorded};
use super::clip::{Altered, Clip, animations};
use super::disturbed::{cut_out, hybrids, reversed};
use super::measures::{MEASURES, Measure, garwood, measures};
use super::mode::Mode;
use super::movements::{MovementSettings, movements, ready_made};
use super::tally::Tally;
use crate::choreographies::{SCRIPTS, choreography};
use crate::recognition::damage::Damage;
use crate::sets::Result;

/// What is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct TableSettings {
    /// The first data set.
    pub movements: MovementSettings,
    /// The corpus of the third data set; without one there is none.
    pub corpus: Option<PathBuf>,
    /// One in so many recordings is read.
    pub every: usize,
    /// One in so many recordings of those is put to every number of postures and every stride.
    pub grid_every: usize,
    /// Numbers of postures, and frames between them.
    pub postures: Vec<(usize, usize)>,
    /// Whether decisions are timed.
    pub timings: bool,
}

impl Default for TableSettings {
    fn default() -> Self {
        let mut postures = vec![(1, 1)];
        for n in [2, 3, 5, 10] {
            postures.extend([1, 4, 8].map(|stride| (n, stride)));
        }
        Self {
            movements: MovementSettings {
                clips: 24,
                movements: 12,
                seed: 0,
            },
            corpus: None,
            every: 1,
            grid_every: 8,
            postures,
            timings: false,
        }
    }
}

/// One row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The data set.
    pub set: String,
    /// How was decided.
    pub mode: Mode,
    /// What was altered before.
    pub altered: Altered,
    /// Its clips, frames and hours.
    pub clips: usize,
    /// Frames.
    pub frames: u64,
    /// Hours.
    pub hours: f64,
    /// False alarms.
    pub alarms: u64,
    /// Movements shown, and those never affirmed.
    pub spans: u64,
    /// Movements never affirmed.
    pub missed: u64,
    /// In the order of [`MEASURES`].
    pub measures: [Option<Estimate>; MEASURES.len()],
}

impl Row {
    /// A row of these clips' tallies.
    ///
    /// # Errors
    /// Without clips.
    pub fn of(set: &str, mode: Mode, altered: Altered, tallies: &[Tally]) -> Result<Self> {
        let sum = |of: fn(&Tally) -> u64| tallies.iter().map(of).sum::<u64>();
        Ok(Self {
            set: set.into(),
            mode,
            altered,
            clips: tallies.len(),
            frames: sum(|t| t.frames),
            hours: tallies.iter().map(|t| t.secs).sum::<f64>() / 3600.0,
            alarms: sum(|t| t.alarms),
            spans: sum(|t| t.spans),
            missed: sum(|t| t.missed),
            measures: measures(tallies)?,
        })
    }

    /// One of its measures.
    pub fn measure(&self, which: Measure) -> Option<Estimate> {
        let at = MEASURES.iter().position(|(m, _)| *m == which)?;
        self.measures[at]
    }

    /// False alarms an hour with their interval.
    pub fn alarms_an_hour(&self) -> [f64; 3] {
        let (low, high) = garwood(self.alarms);
        [self.alarms as f64, low, high].map(|n| n / self.hours)
    }
}

/// How long decisions take, microseconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// How is decided.
    pub mode: Mode,
    /// Frames that were timed.
    pub frames: usize,
    /// The median of all five decisions of a frame.
    pub median_us: f64,
    /// What 99 in 100 stay below.
    pub p99_us: f64,
}

/// All of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The names of the behaviours.
    pub behaviors: Vec<String>,
    /// Whether Ares was simulated.
    pub physics: bool,
    /// The table: the three sets, each way of deciding.
    pub rows: Vec<Row>,
    /// The same decided as the paper and exactly, with other numbers of postures and strides; of the third set a part.
    pub grid: Vec<Row>,
    /// Sets two and three with other joints altered.
    pub altered: Vec<Row>,
    /// The first set with noise and lost joints.
    pub damaged: Vec<(String, Row)>,
    /// Movements cut out, played backward, and hybrids: in which share of the frames any behaviour is affirmed.
    pub impossible: Vec<(String, Mode, f64, usize)>,
    /// Recordings that left the third set, by archive and label: in how many of their clips a behaviour is affirmed.
    pub left: Vec<(String, Mode, usize, usize)>,
    /// The files among them.
    pub left_files: Vec<String>,
    /// Times of decisions, where asked for.
    pub timings: Vec<Timing>,
}

/// The ways of deciding of the main table.
const MODES: [Mode; 9] = [
    Mode::Never,
    Mode::Paper { n: 1, stride: 1 },
    Mode::Paper { n: 2, stride: 1 },
    Mode::Frame { n: 1, stride: 1 },
    FRAME,
    Mode::FILTER,
    Mode::Filter {
        lag_secs: 0.1,
        held_secs: 0.0,
    },
    Mode::Filter {
        lag_secs: 0.1,
        held_secs: 0.1,
    },
    Mode::Spans,
];
pub(super) const FRAME: Mode = Mode::Frame { n: 2, stride: 4 };
/// Those of everything beside it.
const FEW: [Mode; 3] = [Mode::Paper { n: 1, stride: 1 }, FRAME, Mode::FILTER];
/// A behaviour counts as affirmed in a recording when it is for so long, seconds.
const AFFIRMED_SECS: f64 = 0.1;
/// Hybrids of each primitive.
const HYBRIDS: usize = 20;

/// Damage to the first set.
const DAMAGES: [Damage; 7] = [
    Damage::NoiseDeg(1.0),
    Damage::NoiseDeg(2.0),
    Damage::NoiseDeg(3.0),
    Damage::NoiseDeg(4.0),
    Damage::NoiseDeg(5.0),
    Damage::Lost,
    Damage::Stuck,
];

/// The names of the three sets.
pub(super) const SETS: [&str; 3] = [
    "Ares movements",
    "Choreographed animations",
    "Motion capture",
];

/// What decides, and for how many behaviours.
pub(super) struct Judge<'v> {
    mode: Mode,
    recogniser: Option<Box<dyn Recogniser + 'v>>,
    vocabulary: &'v Vocabulary,
}

impl<'v> Judge<'v> {
    pub(super) fn new(mode: Mode, vocabulary: &'v Vocabulary) -> Result<Self> {
        Ok(Self {
            recogniser: mode.over(vocabulary)?,
            mode,
            vocabulary,
        })
    }

    fn tally(&self, clip: &Clip) -> Result<Tally> {
        let classes = self.vocabulary.primitives().len();
        let recogniser = self.recogniser.as_deref();
        let decisions = self.mode.decide(recogniser, classes, &clip.seen)?;
        Tally::of(clip, &decisions, classes)
    }

    fn tallies(&self, clips: &[&Clip], altered: Altered) -> Result<Vec<Tally>> {
        let one = |clip: &&Clip| self.tally(&altered.of(clip, self.vocabulary)?);
        clips.par_iter().map(one).collect()
    }

    pub(super) fn row(&self, set: &str, clips: &[&Clip], altered: Altered) -> Result<Row> {
        Row::of(set, self.mode, altered, &self.tallies(clips, altered)?)
    }
}

/// The five behaviours of the boxer on Ares, with what recognisers learn of them.
///
/// # Errors
/// Never for the embedded script.
pub fn boxer() -> Result<Vocabulary> {
    let (name, text) = SCRIPTS[0];
    let body = Arc::new(kineme::ares()?);
    Ok(calibrated(choreography(name, text, &body)?, None)?)
}

/// Table I, and what stands beside it. `watch` is told what is being done.
///
/// # Errors
/// When the corpus lacks a file, or a simulation fails.
pub fn table1(settings: &TableSettings, watch: &mut dyn FnMut(&str)) -> Result<Table> {
    watch("learning the behaviours");
    let vocabulary = boxer()?;
    let body = vocabulary.body();
    watch("Ares moves");
    let own = movements(&vocabulary, &settings.movements, &|| ready_made(body))?;
    let animated = animations(body)?;
    watch("reading motion capture");
    let captured = match &settings.corpus {
        Some(corpus) => recorded(corpus, body, settings.every)?,
        None => Captured::default(),
    };
    let sets: [(&str, Vec<&Clip>, Altered); 3] = [
        (SETS[0], own.iter().collect(), Altered::Nothing),
        (SETS[1], animated.iter().collect(), Altered::Hands),
        (SETS[2], captured.negatives.iter().collect(), Altered::Hands),
    ];
    let filled = || sets.iter().filter(|(_, clips, _)| !clips.is_empty());
    let mut table = Table {
        behaviors: vocabulary
            .primitives()
            .iter()
            .map(|p| p.name().into())
            .collect(),
        physics: ready_made(body)?.is_physical(),
        rows: Vec::new(),
        grid: Vec::new(),
        altered: Vec::new(),
        damaged: Vec::new(),
        impossible: Vec::new(),
        left: Vec::new(),
        left_files: captured.left.iter().map(|(c, ..)| c.name.clone()).collect(),
        timings: Vec::new(),
    };
    for mode in MODES {
        let judge = Judge::new(mode, &vocabulary)?;
        for (set, clips, altered) in filled() {
            watch(&format!("{}: {set}", mode.name()));
            table.rows.push(judge.row(set, clips, *altered)?);
        }
    }
    for mode in FEW {
        let judge = Judge::new(mode, &vocabulary)?;
        for (set, clips, _) in filled().skip(1) {
            for altered in [Altered::Nothing, Altered::Unmoved] {
                watch(&format!("{}, {}: {set}", mode.name(), altered.name()));
                table.altered.push(judge.row(set, clips, altered)?);
            }
        }
    }
    let paper = |&(n, stride): &(usize, usize)| Mode::Paper { n, stride };
    let frame = |&(n, stride): &(usize, usize)| Mode::Frame { n, stride };
    let grid = settings.postures.iter();
    for mode in grid.clone().map(paper).chain(grid.map(frame)) {
        let judge = Judge::new(mode, &vocabulary)?;
        for (set, clips, altered) in filled() {
            let every = if *set == SETS[2] {
                settings.grid_every
            } else {
                1
            };
            let some: Vec<&Clip> = clips.iter().copied().step_by(every.max(1)).collect();
            watch(&format!("{} {:?}: {set}", mode.name(), mode.postures()));
            table.grid.push(judge.row(set, &some, *altered)?);
        }
    }
    disturbed(
        &mut table,
        &vocabulary,
        &own,
        settings.movements.seed,
        watch,
    )?;
    left(&mut table, &vocabulary, &captured, watch)?;
    if settings.timings {
        for mode in FEW {
            table
                .timings
                .push(timing(&Judge::new(mode, &vocabulary)?, &own[0])?);
        }
    }
    Ok(table)
}

/// Damage to the first set, movements played backward, and hybrids.
fn disturbed(
    table: &mut Table,
    vocabulary: &Vocabulary,
    own: &[Clip],
    seed: u64,
    watch: &mut dyn FnMut(&str),
) -> Result<()> {
    let judges: Vec<Judge> = FEW
        .iter()
        .map(|mode| Judge::new(*mode, vocabulary))
        .collect::<Result<_>>()?;
    for damage in DAMAGES {
        watch(&format!("{}: {}", SETS[0], damage.name()));
        let damaged = |(k, clip): (usize, &Clip)| -> Result<Clip> {
            Ok(Clip {
                seen: damage.of(seed ^ k as u64, clip.motion())?,
                ..clip.clone()
            })
        };
        let clips: Vec<Clip> = own.iter().enumerate().map(damaged).collect::<Result<_>>()?;
        let clips: Vec<&Clip> = clips.iter().collect();
        for judge in &judges {
            let row = judge.row(SETS[0], &clips, Altered::Nothing)?;
            table.damaged.push((damage.name(), row));
        }
    }
    let cut: Vec<Clip> = own
        .iter()
        .map(cut_out)
        .collect::<Result<Vec<_>>>()?
        .concat();
    let back: Vec<Clip> = cut.iter().map(reversed).collect::<Result<_>>()?;
    for (name, clips) in [
        ("movements, cut out", cut),
        ("the same backward", back),
        (
            "hybrids: another execution's left arm",
            hybrids(vocabulary, HYBRIDS, seed)?,
        ),
    ] {
        watch(name);
        let clips: Vec<&Clip> = clips.iter().collect();
        for judge in &judges {
            let tallies = judge.tallies(&clips, Altered::Nothing)?;
            let affirmed: u64 = tallies
                .iter()
                .map(|t| t.any.hits + t.any.false_alarms)
                .sum();
            let frames: u64 = tallies.iter().map(|t| t.frames).sum();
            let share = affirmed as f64 / frames as f64;
            table
                .impossible
                .push((name.into(), judge.mode, share, clips.len()));
        }
    }
    Ok(())
}

/// Recordings that left the third set, hands altered: in how many a behaviour is affirmed.
fn left(
    table: &mut Table,
    vocabulary: &Vocabulary,
    captured: &Captured,
    watch: &mut dyn FnMut(&str),
) -> Result<()> {
    let mut kinds: Vec<&str> = captured
        .left
        .iter()
        .map(|(_, kind, _)| kind.as_str())
        .collect();
    kinds.sort_unstable();
    kinds.dedup();
    for mode in FEW {
        watch(&format!("{}: people who strike or wave", mode.name()));
        let judge = Judge::new(mode, vocabulary)?;
        let classes = vocabulary.primitives().len();
        let affirmed = |(clip, kind, _): &(Clip, String, _)| -> Result<(String, bool)> {
            let seen = Altered::Hands.of(clip, vocabulary)?;
            let decided = mode.decide(judge.recogniser.as_deref(), classes, &seen.seen)?;
            let least = (AFFIRMED_SECS * clip.motion().rate_hz()).round().max(1.0);
            let long = |k: usize| {
                let own: Vec<bool> = decided
                    .affirmed
                    .iter()
                    .skip(k)
                    .step_by(classes)
                    .copied()
                    .collect();
                own.chunk_by(|a, b| a == b)
                    .any(|run| run[0] && run.len() as f64 >= least)
            };
            Ok((kind.clone(), (0..classes).any(long)))
        };
        let answers: Vec<(String, bool)> = captured
            .left
            .par_iter()
            .map(affirmed)
            .collect::<Result<_>>()?;
        for kind in &kinds {
            let own = || answers.iter().filter(|(k, _)| k == kind);
            let yes = own().filter(|(_, yes)| *yes).count();
            table.left.push(((*kind).into(), mode, yes, own().count()));
        }
    }
    Ok(())
}

/// How long the decisions of each frame take, one after the other.
fn timing(judge: &Judge, clip: &Clip) -> Result<Timing> {
    let mut micros = Vec::new();
    if let Some(recogniser) = &judge.recogniser {
        let mut listener = recogniser.listen();
        for f in 0..clip.motion().frames() {
            let begun = Instant::now();
            listener.hear(&clip.seen.at(f))?;
            micros.push(begun.elapsed().as_secs_f64() * 1e6);
        }
    }
    let at = |q| quantile(&micros, q).unwrap_or(f64::NAN);
    Ok(Timing {
        mode: judge.mode,
        frames: micros.len(),
        median_us: at(0.5),
        p99_us: at(0.99),
    })
}
