//! [`table1`]: every row.

use std::path::PathBuf;
use std::sync::Arc;

use kineme::Vocabulary;
use kineme::perception::calibrated;
use kineme::primitive::Recogniser;
use rayon::prelude::*;

use super::beside::{disturbed, left, timing};
use super::captured::{Captured, recorded};
use super::clip::{Altered, Clip, animations};
use super::mode::Mode;
use super::movements::{MovementSettings, movements, ready_made};
use super::row::{Row, Table};
use super::tally::Tally;
use crate::choreographies::{SCRIPTS, choreography};
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

/// The ways of deciding of the main table; those that share their answers stand side by side.
const MODES: [Mode; 9] = [
    Mode::Never,
    Mode::Paper { n: 1, stride: 1 },
    Mode::Paper { n: 2, stride: 1 },
    Mode::Frame { n: 1, stride: 1 },
    FRAME,
    Mode::FILTER,
    Mode::HINDSIGHT,
    Mode::Filter {
        lag_secs: 0.1,
        held_secs: 0.1,
    },
    Mode::Spans,
];
pub(super) const FRAME: Mode = Mode::Frame { n: 2, stride: 4 };
/// Those of everything beside it.
pub(super) const FEW: [Mode; 3] = [Mode::Paper { n: 1, stride: 1 }, FRAME, Mode::FILTER];

/// The names of the three sets.
pub(super) const SETS: [&str; 3] = [
    "Ares movements",
    "Choreographed animations",
    "Motion capture",
];

/// What decides, and for how many behaviours.
pub(super) struct Judge<'v> {
    pub(super) mode: Mode,
    pub(super) recogniser: Option<Box<dyn Recogniser + 'v>>,
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

    /// The tallies of a clip, one for each of the ways that share this judge's answers.
    fn tally(&self, clip: &Clip, ways: &[Mode]) -> Result<Vec<Tally>> {
        let classes = self.vocabulary.primitives().len();
        let recogniser = self.recogniser.as_deref();
        let answered = self.mode.answered(recogniser, classes, &clip.seen)?;
        let rate_hz = clip.motion().rate_hz();
        let one = |way: &Mode| {
            let decisions = way.held(answered.clone(), classes, rate_hz);
            Tally::of(clip, &decisions, classes)
        };
        ways.iter().map(one).collect()
    }

    /// The tallies of all clips by each of the ways that share this judge's answers.
    fn tallies_by(
        &self,
        clips: &[&Clip],
        altered: Altered,
        ways: &[Mode],
    ) -> Result<Vec<Vec<Tally>>> {
        let one = |clip: &&Clip| self.tally(&altered.of(clip, self.vocabulary)?, ways);
        let all: Vec<Vec<Tally>> = clips.par_iter().map(one).collect::<Result<_>>()?;
        let of = |way: usize| all.iter().map(|own| own[way].clone()).collect();
        Ok((0..ways.len()).map(of).collect())
    }

    pub(super) fn tallies(&self, clips: &[&Clip], altered: Altered) -> Result<Vec<Tally>> {
        Ok(self.tallies_by(clips, altered, &[self.mode])?.concat())
    }

    /// The rows of ways that share this judge's answers.
    fn rows(
        &self,
        set: &str,
        clips: &[&Clip],
        altered: Altered,
        ways: &[Mode],
    ) -> Result<Vec<Row>> {
        let tallies = self.tallies_by(clips, altered, ways)?;
        let of = |(way, own): (&Mode, &Vec<Tally>)| Row::of(set, *way, altered, own);
        ways.iter().zip(&tallies).map(of).collect()
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
    for ways in MODES.chunk_by(|a, b| a.shares(*b)) {
        let judge = Judge::new(ways[0], &vocabulary)?;
        let names: Vec<String> = ways.iter().map(|way| way.name()).collect();
        let mut found = Vec::new();
        for (set, clips, altered) in filled() {
            watch(&format!("{}: {set}", names.join("; ")));
            found.push(judge.rows(set, clips, *altered, ways)?.into_iter());
        }
        // Way by way, each in all sets.
        for _ in ways {
            table
                .rows
                .extend(found.iter_mut().filter_map(Iterator::next));
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
