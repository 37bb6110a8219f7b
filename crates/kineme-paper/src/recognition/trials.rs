//! Which clips are learned from and which are asked, in every row of the tables: shared with the programs of others.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use super::corpora::{Corpus, Split};

/// Halves of the classes that are drawn.
pub const HALVES: u64 = 10;
/// Draws of few exemplars, a split.
pub const DRAWS: u64 = 3;
/// One clip in so many is asked in a draw, other ones in the next.
const ASKED: usize = 3;
/// Exemplars a class where there are few.
pub const SHOTS: [usize; 3] = [1, 3, 5];

/// The splits of a row whose scores are averaged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trials {
    /// The row's name.
    pub row: String,
    /// Whether clips of classes that are not learned are asked.
    pub open: bool,
    /// Learned and asked.
    pub splits: Vec<Split>,
}

/// The clips of a split that are asked in a draw.
fn asked(split: &Split, seed: u64) -> Vec<usize> {
    let first = seed as usize % ASKED;
    split
        .test
        .iter()
        .copied()
        .skip(first)
        .step_by(ASKED)
        .collect()
}

/// Every split of a set with half of its classes unlearned, ten times.
pub fn halves(corpus: &Corpus) -> Trials {
    let draw = |seed: u64| {
        let mut classes: Vec<usize> = (0..corpus.set.classes.len()).collect();
        classes.shuffle(&mut Pcg64::seed_from_u64(seed));
        classes.truncate(classes.len() / 2);
        classes
    };
    let splits = (0..HALVES).flat_map(|seed| {
        let classes = draw(seed);
        corpus.splits.iter().map(move |split| Split {
            train: (split.train.iter().copied())
                .filter(|&i| classes.contains(&corpus.set.labels[i]))
                .collect(),
            test: asked(split, seed),
        })
    });
    Trials {
        row: format!("{}, half unknown", corpus.name),
        open: true,
        splits: splits.collect(),
    }
}

/// Every split of a set with so many exemplars a class, drawn three times.
pub fn few(corpus: &Corpus, shots: usize) -> Trials {
    let splits = (0..DRAWS).flat_map(|seed| {
        let mut random = Pcg64::seed_from_u64(seed);
        let draw = move |split: &Split| {
            let mut order = split.train.clone();
            order.shuffle(&mut random);
            let mut counts = vec![0; corpus.set.classes.len()];
            order.retain(|&i| {
                counts[corpus.set.labels[i]] += 1;
                counts[corpus.set.labels[i]] <= shots
            });
            order.sort_unstable();
            Split {
                train: order,
                test: asked(split, seed),
            }
        };
        corpus.splits.iter().map(draw)
    });
    Trials {
        row: format!("{}, {shots} a class", corpus.name),
        open: false,
        splits: splits.collect(),
    }
}
