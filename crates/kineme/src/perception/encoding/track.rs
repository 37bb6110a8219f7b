//! The best path through all rows: movements that follow one another, rests between them, and what is none of them.

use super::chains::{FAR, advance};
use super::cost::Block;
use super::rows::Row;
use super::settings::EncodingSettings;

/// What a decision at rest costs, as a share of what an unknown movement costs.
const REST_SHARE: f64 = 0.25;

/// Where a path is at the end of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Node {
    /// A row and a cell of it.
    At(usize, usize),
    /// A body at rest.
    Rest,
    /// A movement that is no primitive.
    None,
}

/// What a path did during a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Leg {
    /// Went along a row from a cell at a pace; whether it had begun just there.
    Along {
        row: usize,
        from: usize,
        rate: f64,
        begun: bool,
    },
    Rest,
    None,
}

/// How one hypothesis came to be.
#[derive(Debug, Clone, Copy)]
struct Way {
    row: u32,
    to: u32,
    from: u32,
    rate: u16,
    begun: bool,
}

/// All ways through one block.
#[derive(Debug, Clone)]
struct Step {
    /// In the order of rows and cells.
    ways: Vec<Way>,
    /// Where whoever began a row, or fell to rest or into the unknown, came from.
    before: Option<Node>,
    /// Whether rest and the unknown are gone on with.
    stayed: [bool; 2],
}

/// Hypotheses about the present moment (Viterbi 1967, with a beam).
#[derive(Debug, Clone)]
pub(super) struct Tracker<'a> {
    rows: &'a [Row],
    settings: &'a EncodingSettings,
    /// What a decision of the unknown costs.
    unknown: f64,
    /// Of each row, what its cells cost.
    reached: Vec<Vec<f64>>,
    rest: f64,
    none: f64,
    history: Option<Vec<Step>>,
    begun: bool,
    /// What the last block cost the best path.
    last_cost: f64,
}

impl<'a> Tracker<'a> {
    /// Before the first block. With `history` the whole path can be told.
    pub fn new(
        rows: &'a [Row],
        settings: &'a EncodingSettings,
        unknown: f64,
        history: bool,
    ) -> Self {
        Self {
            rows,
            settings,
            unknown,
            reached: rows.iter().map(|r| vec![FAR; r.cells()]).collect(),
            rest: FAR,
            none: FAR,
            history: history.then(Vec::new),
            begun: false,
            last_cost: 0.0,
        }
    }

    /// What the last block cost the best path: that of a whole decision.
    pub fn last_cost(&self) -> f64 {
        self.last_cost
    }

    /// What it costs to leave a node, and the cheapest one to leave; `None` before the first block.
    fn leaving(&self) -> (f64, Option<Node>) {
        if !self.begun {
            return (0.0, None);
        }
        let mut least = (self.none, Node::None);
        if self.rest <= least.0 {
            least = (self.rest, Node::Rest);
        }
        for (r, (row, reached)) in self.rows.iter().zip(&self.reached).enumerate() {
            for (c, &cost) in reached.iter().enumerate() {
                if cost < least.0 {
                    let cost = cost + self.settings.end_cost * row.missing(c);
                    if cost < least.0 {
                        least = (cost, Node::At(r, c));
                    }
                }
            }
        }
        (least.0, Some(least.1))
    }

    /// Takes every hypothesis over a block; `unit_m` gives the metres of the observation that are a unit of a row. A
    /// still block may be rest.
    pub fn step(&mut self, block: &Block, still: bool, unit_m: impl Fn(&Row) -> f64) {
        let s = self.settings;
        let (left, before) = self.leaving();
        let enter = left + if self.begun { s.switch_cost } else { 0.0 };
        let mut ways = Vec::new();
        let mut costs = Vec::new();
        for (r, row) in self.rows.iter().enumerate() {
            let mut begun = vec![false; row.cells()];
            let reached = &mut self.reached[r];
            for c in 0..row.cells() {
                let share = row.share(c);
                if share > s.entry_phase {
                    break;
                }
                let cost = enter + s.entry_cost * share;
                if cost < reached[c] {
                    reached[c] = cost;
                    begun[c] = true;
                }
            }
            let mut next = vec![FAR; row.cells()];
            let mut by: Vec<(u32, u16)> = vec![(0, 0); row.cells()];
            let along = (block, unit_m(row));
            advance(
                row,
                along,
                reached,
                s,
                &mut costs,
                |to, cost, from, rate| {
                    if cost < next[to] {
                        next[to] = cost;
                        by[to] = (from as u32, rate as u16);
                    }
                },
            );
            if self.history.is_some() {
                let alive = next.iter().enumerate().filter(|(_, c)| **c < FAR);
                ways.extend(alive.map(|(to, _)| Way {
                    row: r as u32,
                    to: to as u32,
                    from: by[to].0,
                    rate: by[to].1,
                    begun: begun[by[to].0 as usize],
                }));
            }
            *reached = next;
        }
        let unknown = if block.is_blind() { 0.0 } else { self.unknown };
        let resting = if still { REST_SHARE * unknown } else { FAR };
        let stayed = [self.rest <= enter, self.none <= enter];
        self.rest = (self.rest.min(enter) + block.weight * resting).min(FAR);
        self.none = (self.none.min(enter) + block.weight * unknown).min(FAR);
        self.begun = true;
        let cut = self.pruned();
        if let Some(history) = &mut self.history {
            ways.retain(|w| self.reached[w.row as usize][w.to as usize] <= cut);
            history.push(Step {
                ways,
                before,
                stayed,
            });
        }
        self.rebase();
    }

    /// Gives up all but the best hypotheses; returns the cost of the last one kept.
    fn pruned(&mut self) -> f64 {
        let mut alive: Vec<f64> = self
            .reached
            .iter()
            .flatten()
            .copied()
            .filter(|c| *c < FAR)
            .collect();
        let beam = self.settings.beam;
        if alive.len() <= beam {
            return FAR;
        }
        let (_, cut, _) = alive.select_nth_unstable_by(beam - 1, f64::total_cmp);
        let cut = *cut;
        for cost in self.reached.iter_mut().flatten() {
            if *cost > cut {
                *cost = FAR;
            }
        }
        cut
    }

    /// Keeps costs small however long a stream is: only differences matter.
    fn rebase(&mut self) {
        let least = self.least();
        self.last_cost = least;
        let nodes = self.reached.iter_mut().flatten();
        for cost in nodes.chain([&mut self.rest, &mut self.none]) {
            if *cost < FAR {
                *cost -= least;
            }
        }
    }

    fn least(&self) -> f64 {
        let nodes = self
            .reached
            .iter()
            .flatten()
            .chain([&self.rest, &self.none]);
        nodes.copied().fold(FAR, f64::min)
    }

    /// What each primitive costs now, beside rest and the unknown; the best of all is 0.
    pub fn standing(&self, primitives: usize) -> (Vec<f64>, f64, f64) {
        let mut costs = vec![FAR; primitives];
        for (row, reached) in self.rows.iter().zip(&self.reached) {
            let best = reached.iter().copied().fold(FAR, f64::min);
            costs[row.primitive] = costs[row.primitive].min(best);
        }
        (costs, self.rest, self.none)
    }

    /// What the cells of each row cost now.
    pub fn reached(&self) -> &[Vec<f64>] {
        &self.reached
    }

    /// The best path, block by block. `closed`: ends of rows that are missing count, for nothing follows.
    pub fn path(&self, closed: bool) -> Vec<Leg> {
        let Some(history) = &self.history else {
            return Vec::new();
        };
        let mut node = self.last(closed);
        let mut legs = Vec::with_capacity(history.len());
        for step in history.iter().rev() {
            let (leg, before) = step.back(node, &self.settings.rates);
            legs.push(leg);
            match before {
                Some(before) => node = before,
                None => break,
            }
        }
        legs.reverse();
        legs
    }

    fn last(&self, closed: bool) -> Node {
        if closed {
            return self.leaving().1.unwrap_or(Node::None);
        }
        let mut least = (self.none, Node::None);
        if self.rest <= least.0 {
            least = (self.rest, Node::Rest);
        }
        for (r, reached) in self.reached.iter().enumerate() {
            for (c, &cost) in reached.iter().enumerate() {
                if cost < least.0 {
                    least = (cost, Node::At(r, c));
                }
            }
        }
        least.1
    }
}

impl Step {
    /// What led to a node, and the node before.
    fn back(&self, node: Node, rates: &[f64]) -> (Leg, Option<Node>) {
        match node {
            Node::At(row, cell) => {
                let key = (row as u32, cell as u32);
                let found = self.ways.binary_search_by_key(&key, |w| (w.row, w.to));
                let Ok(way) = found.map(|i| self.ways[i]) else {
                    return (Leg::None, self.before);
                };
                let from = way.from as usize;
                let leg = Leg::Along {
                    row,
                    from,
                    rate: rates[usize::from(way.rate)],
                    begun: way.begun,
                };
                let before = match way.begun {
                    true => self.before,
                    false => Some(Node::At(row, from)),
                };
                (leg, before)
            }
            Node::Rest if self.stayed[0] => (Leg::Rest, Some(Node::Rest)),
            Node::Rest => (Leg::Rest, self.before),
            Node::None if self.stayed[1] => (Leg::None, Some(Node::None)),
            Node::None => (Leg::None, self.before),
        }
    }
}
