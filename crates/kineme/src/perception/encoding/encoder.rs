//! [`Encoder`]: trajectory encoding over a vocabulary.

use super::chains::{Ends, FAR, chain, class_costs, shares};
use super::cost::{Block, Instants, blocks, instants};
use super::extrapolation::background;
use super::literal::Literal;
use super::outline::{Outlines, sums};
use super::paths::EffectorPaths;
use super::rejection::{Evidence, Rejection};
use super::rows::{Row, rows};
use super::settings::{EncodingMethod, EncodingSettings, Extent, REACH_UNITS};
use super::track::{Leg, Tracker};
use crate::error::{Error, Result};
use crate::math::statistics::median;
use crate::primitive::{Posterior, Vocabulary};
use crate::skeleton::{Role, Skeleton};

/// A clip lasts at most this many times as long as the longest exemplar.
const LONGEST_CLIP: f64 = 2.0;
/// An observation is at most so many instants: hours.
const MOST_INSTANTS: f64 = 1e6;
/// Slower than this (reaches a second, and reaches at all) is rest.
const STILL: [f64; 2] = [0.05, 0.02];

/// Recognises movement from the paths of effectors alone, and says it again in the joints of the vocabulary's body
/// (paper, section V-B).
///
/// A hypothesis is an exemplar and a phase. It predicts where the effectors go next; how far that is from what is seen,
/// in place, displacement and direction, is what it costs. Dynamic programming follows the hypotheses, at paces from half
/// to double, from decision to decision.
#[derive(Debug, Clone)]
pub struct Encoder<'a> {
    pub(super) vocabulary: &'a Vocabulary,
    pub(super) settings: EncodingSettings,
    pub(super) rows: Vec<Row>,
    /// What clips cost rows beside their chains.
    outlines: Option<Outlines>,
    pub(super) rejection: Rejection,
    pub(super) literal: Option<Literal>,
    /// The stretched-out hand from between the shoulders of the body, metres.
    body_reach_m: f64,
}

/// An observation, ready to be compared.
pub(super) struct Seen {
    pub instants: Instants,
    pub blocks: Vec<Block>,
    /// Which of the blocks nothing moves in.
    pub still: Vec<bool>,
    /// Metres of the instants that are a unit; `None`: as many as of the row.
    unit_m: Option<f64>,
    /// What the outline of a clip costs each row; `None` of streams, and where there is none to compare.
    outlines: Option<Vec<f64>>,
    pub duration_secs: f64,
}

impl Seen {
    /// Metres of the instants that are a unit of a row.
    pub fn unit_m(&self, row: &Row) -> f64 {
        self.unit_m.unwrap_or(row.unit_m)
    }
}

/// What a span costs each primitive.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretch {
    /// Its blocks.
    pub blocks: std::ops::Range<usize>,
    /// Its primitive; `None` for rest and for the unknown.
    pub primitive: Option<usize>,
    pub rest: bool,
    /// The cost of each primitive, begun and ended anywhere.
    pub costs: Vec<f64>,
}

/// What is thought of an observation.
pub(super) struct Verdict {
    pub posterior: Posterior,
    /// The cost of each primitive as the whole.
    pub costs: Vec<f64>,
    pub novelty: f64,
    pub legs: Vec<Leg>,
    pub stretches: Vec<Stretch>,
}

impl<'a> Encoder<'a> {
    /// An encoder over a vocabulary. Its rejection is the one kept with the vocabulary, where that was fitted with such
    /// settings, or else fitted now to the exemplars: a second of work or two for a hundred of them.
    ///
    /// # Errors
    /// When what is kept with the vocabulary is no rejection.
    /// When a setting is outside of its range, the vocabulary has no primitive, or its body lacks an effector or
    /// shoulders.
    pub fn new(vocabulary: &'a Vocabulary, settings: &EncodingSettings) -> Result<Self> {
        let (rows, outlines) = checked_rows(vocabulary, settings)?;
        let rejection = match Rejection::kept(vocabulary, settings)? {
            Some(kept) => kept,
            None => Rejection::fit(vocabulary, (&rows, outlines.as_ref()), settings, &[])?,
        };
        Self::of(vocabulary, settings, (rows, outlines), rejection)
    }

    /// The same with a rejection that was fitted to this vocabulary with these settings.
    ///
    /// # Errors
    /// As [`Self::new`], and when the rejection is of another vocabulary.
    pub fn with_rejection(
        vocabulary: &'a Vocabulary,
        settings: &EncodingSettings,
        rejection: Rejection,
    ) -> Result<Self> {
        let known = checked_rows(vocabulary, settings)?;
        Self::of(vocabulary, settings, known, rejection.checked(vocabulary)?)
    }

    fn of(
        vocabulary: &'a Vocabulary,
        settings: &EncodingSettings,
        (rows, outlines): (Vec<Row>, Option<Outlines>),
        rejection: Rejection,
    ) -> Result<Self> {
        let literal = match settings.method {
            EncodingMethod::Paper => Some(Literal::of(vocabulary)?),
            EncodingMethod::Hypotheses => None,
        };
        Ok(Self {
            body_reach_m: body_reach_m(vocabulary.body()),
            vocabulary,
            settings: settings.clone(),
            rows,
            outlines,
            rejection,
            literal,
        })
    }

    /// The primitives that it knows.
    pub fn vocabulary(&self) -> &'a Vocabulary {
        self.vocabulary
    }

    /// How it encodes.
    pub fn settings(&self) -> &EncodingSettings {
        &self.settings
    }

    /// When it rejects.
    pub fn rejection(&self) -> &Rejection {
        &self.rejection
    }

    /// How far the body's stretched-out hand is from between the shoulders, metres: its [`EncodingSettings::reach_m`].
    pub fn body_reach_m(&self) -> f64 {
        self.body_reach_m
    }

    /// Paths as they are compared.
    pub(super) fn seen(&self, paths: &EffectorPaths) -> Result<Seen> {
        let s = &self.settings;
        if paths.effectors() != s.effectors.as_slice() {
            return Err(Error::invalid(format!(
                "paths of {}, but the encoder looks at {}",
                paths.effectors().join(", "),
                s.effectors.join(", ")
            )));
        }
        let secs = paths.duration_secs();
        if secs / s.sample_secs() > MOST_INSTANTS {
            return Err(Error::invalid(format!(
                "paths of {secs:.0} s at {} Hz; the encoder compares {MOST_INSTANTS:.0} instants of {:.3} s at most",
                paths.rate_hz(),
                s.sample_secs()
            )));
        }
        let (scale, unit_m) = match s.reach_m {
            Some(reach) => (self.body_reach_m / reach, None),
            None => (1.0, Some(paths.reach_m().unwrap_or(1.0) / REACH_UNITS)),
        };
        let instants = instants(paths, scale, s);
        let blocks = blocks(&instants, s);
        let reach = unit_m.map_or(self.body_reach_m, |u| u * REACH_UNITS);
        let still = blocks.iter().map(|b| self.is_still(b, reach)).collect();
        let secs = paths.duration_secs();
        let unit = unit_m.unwrap_or_else(|| self.usual_row_m()) / scale;
        let outlines = self.outlines.as_ref().filter(|_| self.is_clip(secs));
        Ok(Seen {
            outlines: outlines.and_then(|o| o.costs(paths, unit)),
            instants,
            blocks,
            still,
            unit_m,
            duration_secs: secs,
        })
    }

    /// Whether nothing moves in a block, of one who reaches so far.
    pub(super) fn is_still(&self, block: &Block, reach_m: f64) -> bool {
        let slow = STILL[0] * block.secs(&self.settings);
        block.farthest_m() <= reach_m * slow.max(STILL[1])
    }

    /// Whether an observation is taken for one movement.
    pub(super) fn is_clip(&self, secs: f64) -> bool {
        let cells = self.rows.iter().map(Row::cells).max().unwrap_or(0);
        let longest = cells as f64 * self.settings.cell_secs();
        match self.settings.extent {
            Extent::Clip => true,
            Extent::Stream => false,
            Extent::Automatic => secs <= LONGEST_CLIP * longest,
        }
    }

    /// What an observation is, by hypotheses.
    pub(super) fn judge(&self, seen: &Seen) -> Verdict {
        let s = &self.settings;
        let primitives = self.vocabulary.primitives().len();
        let mut tracker = Tracker::new(&self.rows, s, self.rejection.limit, true);
        for (block, still) in seen.blocks.iter().zip(&seen.still) {
            tracker.step(block, *still, |row| seen.unit_m(row));
        }
        let clip = self.is_clip(seen.duration_secs);
        let legs = tracker.path(clip);
        let chains = clip.then(|| self.chains(seen, 0..seen.blocks.len(), Ends::Whole));
        let whole = chains.as_ref().map(|chains| self.of_clip(seen, chains));
        let mut stretches = self.stretches(seen, &legs, whole.as_deref());
        let all: f64 = seen.blocks.iter().map(|b| b.weight).sum();
        let blind = seen.blocks.iter().all(Block::is_blind);
        if blind {
            // Of what was not seen nothing is known.
            return Verdict {
                posterior: Posterior {
                    primitives: vec![0.0; primitives],
                    rest: 0.0,
                    none: 1.0,
                },
                costs: vec![FAR; primitives],
                novelty: 0.0,
                legs,
                stretches,
            };
        }
        let costs = whole.unwrap_or_else(|| weighted(&stretches, seen, primitives));
        // Whether it is any of them is told by what chains cost alone, as that of streams is.
        let evidence = Evidence {
            background: background(&seen.instants, &seen.blocks, self.usual_unit_m(seen), s),
            costs: match &chains {
                Some(chains) => self.class_costs(chains),
                None => costs.clone(),
            },
        };
        let posterior = if seen.still.iter().all(|s| *s) {
            Posterior {
                primitives: vec![0.0; primitives],
                rest: 1.0,
                none: 0.0,
            }
        } else if clip {
            let none = self.rejection.none(&evidence);
            let known = self.rejection.confidence.shares(&costs);
            Posterior {
                primitives: known.into_iter().map(|p| (1.0 - none) * p).collect(),
                rest: 0.0,
                none,
            }
        } else {
            self.mixed(seen, &stretches, all)
        };
        // A clip that is rejected as a whole has no part that is known.
        if clip && posterior.best().is_none() {
            for stretch in &mut stretches {
                stretch.primitive = None;
            }
        }
        let leading = evidence.best();
        let novelty = leading.map_or(0.0, |k| evidence.costs[k] / self.rejection.limits[k]);
        Verdict {
            posterior,
            costs,
            novelty,
            legs,
            stretches,
        }
    }

    /// What each row costs over some blocks.
    fn chains(&self, seen: &Seen, of: std::ops::Range<usize>, ends: Ends) -> Vec<f64> {
        let chain = |row: &Row| {
            let blocks = (&seen.blocks[of.clone()], seen.unit_m(row));
            chain(row, blocks, ends, &self.settings)
        };
        self.rows.iter().map(chain).collect()
    }

    /// The cost of each primitive, of what its rows cost.
    fn class_costs(&self, of_rows: &[f64]) -> Vec<f64> {
        let primitives = self.vocabulary.primitives().len();
        let temperature = self.settings.temperature;
        class_costs(&self.rows, of_rows, primitives, temperature, |_| true)
    }

    /// The cost of each primitive as the whole: of its rows' chains and outlines.
    fn of_clip(&self, seen: &Seen, chains: &[f64]) -> Vec<f64> {
        match &seen.outlines {
            Some(outlines) => self.class_costs(&sums(chains, outlines)),
            None => self.class_costs(chains),
        }
    }

    /// The cost of each primitive over some blocks.
    pub(super) fn costs(&self, seen: &Seen, of: std::ops::Range<usize>, ends: Ends) -> Vec<f64> {
        self.class_costs(&self.chains(seen, of, ends))
    }

    /// Metres of an observation that are a unit of no row in particular.
    pub(super) fn usual_unit_m(&self, seen: &Seen) -> f64 {
        seen.unit_m.unwrap_or_else(|| self.usual_row_m())
    }

    /// Metres on the body that are a unit of the middle row.
    pub(super) fn usual_row_m(&self) -> f64 {
        let units: Vec<f64> = self.rows.iter().map(|r| r.unit_m).collect();
        median(&units).unwrap_or(1.0)
    }

    /// The legs of a path that are one stroke, one rest, one unknown movement; `whole` is what a clip costs that has no
    /// parts.
    fn stretches(&self, seen: &Seen, legs: &[Leg], whole: Option<&[f64]>) -> Vec<Stretch> {
        let mut stretches: Vec<Stretch> = Vec::new();
        for (b, leg) in legs.iter().enumerate() {
            let (primitive, rest, begun) = match *leg {
                Leg::Along { row, begun, .. } => (Some(self.rows[row].primitive), false, begun),
                Leg::Rest => (None, true, false),
                Leg::None => (None, false, false),
            };
            match stretches.last_mut() {
                Some(last) if (last.primitive, last.rest) == (primitive, rest) && !begun => {
                    last.blocks.end = b + 1;
                }
                _ => stretches.push(Stretch {
                    blocks: b..b + 1,
                    primitive,
                    rest,
                    costs: Vec::new(),
                }),
            }
        }
        if let (Some(whole), [only]) = (whole, stretches.as_mut_slice()) {
            only.costs = whole.to_vec();
            return stretches;
        }
        for stretch in &mut stretches {
            stretch.costs = self.costs(seen, stretch.blocks.clone(), Ends::Free);
        }
        stretches
    }

    /// The posterior of a stream: that of its stretches, by how long they last.
    fn mixed(&self, seen: &Seen, stretches: &[Stretch], all: f64) -> Posterior {
        let mut mixed = Posterior {
            primitives: vec![0.0; self.vocabulary.primitives().len()],
            rest: 0.0,
            none: 0.0,
        };
        for stretch in stretches {
            let blocks = &seen.blocks[stretch.blocks.clone()];
            let share = blocks.iter().map(|b| b.weight).sum::<f64>() / all.max(1e-9);
            match (stretch.primitive, stretch.rest) {
                (Some(_), _) => {
                    let known = shares(&stretch.costs, self.rejection.temperature);
                    for (m, p) in mixed.primitives.iter_mut().zip(known) {
                        *m += share * p;
                    }
                }
                (None, true) => mixed.rest += share,
                (None, false) => mixed.none += share,
            }
        }
        mixed
    }
}

/// The rows of a vocabulary and their outlines.
pub(super) fn checked_rows(
    vocabulary: &Vocabulary,
    settings: &EncodingSettings,
) -> Result<(Vec<Row>, Option<Outlines>)> {
    settings.check()?;
    if vocabulary.primitives().is_empty() {
        return Err(Error::invalid("an encoder needs a primitive"));
    }
    let rows = rows(vocabulary, settings)?;
    let outlines = Outlines::new(vocabulary, &rows, settings)?;
    Ok((rows, outlines))
}

/// The mean over the stretches, by how long they last.
fn weighted(stretches: &[Stretch], seen: &Seen, primitives: usize) -> Vec<f64> {
    let mut sums = vec![0.0; primitives];
    let mut all = 0.0;
    for stretch in stretches {
        let blocks = &seen.blocks[stretch.blocks.clone()];
        let weight: f64 = blocks.iter().map(|b| b.weight).sum();
        for (sum, cost) in sums.iter_mut().zip(&stretch.costs) {
            *sum += weight * cost;
        }
        all += weight;
    }
    sums.into_iter().map(|s| s / f64::max(all, 1e-9)).collect()
}

/// Half the width of the shoulders, upper arm and forearm.
fn body_reach_m(body: &Skeleton) -> f64 {
    let first = |role: Role| body.joints_of(role).first().copied();
    let rest = body.frames(&body.neutral(), &crate::skeleton::Root::ORIGIN);
    let places = [
        Role::RightUpperArm,
        Role::LeftUpperArm,
        Role::LeftLowerArm,
        Role::LeftHand,
    ];
    let [Some(right), Some(left), Some(elbow), Some(hand)] = places.map(first) else {
        return 1.0;
    };
    let far = |a: usize, b: usize| (rest[a].position - rest[b].position).norm();
    0.5 * far(right, left) + far(left, elbow) + far(elbow, hand)
}
