//! [`Tree`]: boxes in a hierarchy, so that a posture meets few of them.

use super::cells::Cells;

/// Boxes of a leaf.
const LEAF: usize = 8;

/// A posture as a tree asks for it.
#[derive(Debug, Clone)]
pub(super) struct Query {
    /// Coordinates of the boxes; NaN, which lies outside of nothing, where not seen.
    pub at: Vec<f32>,
    /// Of each part, how far what the boxes do not hold is off, in tolerances.
    pub gaps: Vec<f32>,
}

impl Query {
    /// The parts that are farther off than so many tolerances, whatever the boxes hold.
    fn beyond(&self, most: f32) -> u64 {
        let far = |(part, gap): (usize, &f32)| u64::from(*gap > most) << part;
        self.gaps.iter().enumerate().map(far).sum()
    }
}

/// A box that a posture lies in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// The cell.
    pub cell: u32,
    /// The parts that lie outside, one bit each.
    pub outside: u64,
}

/// Boxes of cells, found by a posture: a bounding tree split at medians of the coordinate that varies most.
///
/// A posture lies in a box if at most `faults` parts of the body are farther from it than the tolerance.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    /// Coordinates of a box, the most discriminative first: columns of the query.
    dims: usize,
    part_of: Vec<usize>,
    delta: f32,
    faults: u32,
    /// Cells in the order of the leaves.
    cells: Vec<u32>,
    /// Least and greatest values of the same, cells x coordinates.
    boxes: Vec<[f32; 2]>,
    nodes: Vec<Node>,
    /// The boxes around those of a node.
    node_boxes: Vec<[f32; 2]>,
    /// What the boxes of a node have in common; least above greatest where they have nothing.
    node_cores: Vec<[f32; 2]>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    first: usize,
    end: usize,
    /// The second child; the first is the next node. 0 for a leaf.
    second: usize,
}

impl Tree {
    /// The tree of cells, by these coordinates of theirs in this order; `part_of` names the part of each.
    pub fn new(
        cells: &Cells,
        columns: &[usize],
        part_of: &[usize],
        delta: f64,
        faults: usize,
    ) -> Self {
        let dims = columns.len();
        let of = |cell: usize| {
            columns.iter().map(move |&c| {
                let at = cell * cells.dims + c;
                [cells.low[at], cells.high[at]]
            })
        };
        let mut tree = Self {
            dims,
            part_of: part_of.to_vec(),
            delta: delta as f32,
            faults: faults as u32,
            cells: (0..cells.count() as u32).collect(),
            boxes: (0..cells.count()).flat_map(of).collect(),
            nodes: Vec::new(),
            node_boxes: Vec::new(),
            node_cores: Vec::new(),
        };
        let unsorted = tree.boxes.clone();
        let mut order = std::mem::take(&mut tree.cells);
        let count = order.len();
        tree.split(&unsorted, &mut order, 0, count);
        tree.boxes = order
            .iter()
            .flat_map(|&c| &unsorted[c as usize * dims..(c as usize + 1) * dims])
            .copied()
            .collect();
        tree.cells = order;
        tree
    }

    fn split(&mut self, boxes: &[[f32; 2]], order: &mut [u32], first: usize, end: usize) {
        let node = self.nodes.len();
        self.nodes.push(Node {
            first,
            end,
            second: 0,
        });
        let row = |cell: u32| &boxes[cell as usize * self.dims..(cell as usize + 1) * self.dims];
        let mut bounds = vec![[f32::INFINITY, f32::NEG_INFINITY]; self.dims];
        let mut middles = bounds.clone();
        let mut cores = vec![[f32::NEG_INFINITY, f32::INFINITY]; self.dims];
        for &cell in &order[first..end] {
            for (c, x) in row(cell).iter().enumerate() {
                let middle = x[0] + x[1];
                bounds[c] = [bounds[c][0].min(x[0]), bounds[c][1].max(x[1])];
                cores[c] = [cores[c][0].max(x[0]), cores[c][1].min(x[1])];
                middles[c] = [middles[c][0].min(middle), middles[c][1].max(middle)];
            }
        }
        self.node_boxes.extend(bounds);
        self.node_cores.extend(cores);
        if end - first <= LEAF || self.dims == 0 {
            return;
        }
        let mut widest = 0;
        for c in 1..self.dims {
            if middles[c][1] - middles[c][0] > middles[widest][1] - middles[widest][0] {
                widest = c;
            }
        }
        let key = |&cell: &u32| {
            let x = boxes[cell as usize * self.dims + widest];
            x[0] + x[1]
        };
        order[first..end].sort_unstable_by(|a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let half = first + (end - first) / 2;
        self.split(boxes, order, first, half);
        self.nodes[node].second = self.nodes.len();
        self.split(boxes, order, half, end);
    }

    fn node_box(&self, node: usize) -> &[[f32; 2]] {
        &self.node_boxes[node * self.dims..(node + 1) * self.dims]
    }

    fn cell_box(&self, at: usize) -> &[[f32; 2]] {
        &self.boxes[at * self.dims..(at + 1) * self.dims]
    }

    /// The parts of a posture that are farther than `reach` from a box, those in `outside` among them; `None` as soon as
    /// they are too many.
    fn outside(
        &self,
        bounds: &[[f32; 2]],
        query: &Query,
        reach: f32,
        mut outside: u64,
    ) -> Option<u64> {
        for ((b, x), &part) in bounds.iter().zip(&query.at).zip(&self.part_of) {
            if b[0] - x > reach || x - b[1] > reach {
                outside |= 1 << part;
                if outside.count_ones() > self.faults {
                    return None;
                }
            }
        }
        Some(outside)
    }

    /// How far a posture is from a box, in tolerances, the farthest parts forgiven; infinite where that is more than
    /// `most`, `off` being the parts of which the query says so.
    fn distance(
        &self,
        bounds: &[[f32; 2]],
        query: &Query,
        most: f32,
        off: u64,
        gaps: &mut [f32],
    ) -> f32 {
        if self
            .outside(bounds, query, most * self.delta, off)
            .is_none()
        {
            return f32::INFINITY;
        }
        gaps.copy_from_slice(&query.gaps);
        for ((b, x), &part) in bounds.iter().zip(&query.at).zip(&self.part_of) {
            let gap = (b[0] - x).max(x - b[1]) / self.delta;
            if gap > gaps[part] {
                gaps[part] = gap;
            }
        }
        let forgiven = self.faults as usize;
        if forgiven >= gaps.len() {
            return 0.0;
        }
        let (_, farthest, _) = gaps.select_nth_unstable_by(forgiven, |a, b| b.total_cmp(a));
        farthest.max(0.0)
    }

    /// Whether a posture lies within the tolerance of every box of a node.
    fn is_core(&self, node: usize, query: &Query) -> bool {
        let cores = &self.node_cores[node * self.dims..(node + 1) * self.dims];
        let mut pairs = cores.iter().zip(&query.at);
        pairs.all(|(b, x)| !(b[0] - x > self.delta || x - b[1] > self.delta))
    }

    /// The box of each cell by its number, all coordinates in the order of the columns.
    pub fn boxes(&self) -> Vec<&[[f32; 2]]> {
        let mut boxes: Vec<&[[f32; 2]]> = vec![&[]; self.cells.len()];
        for (at, &cell) in self.cells.iter().enumerate() {
            boxes[cell as usize] = self.cell_box(at);
        }
        boxes
    }

    /// All cells whose box a posture lies in, in the order of cells.
    pub fn hits(&self, query: &Query) -> Vec<Hit> {
        let mut hits = Vec::new();
        let off = query.beyond(1.0);
        if off.count_ones() > self.faults || self.cells.is_empty() {
            return hits;
        }
        let mut stack = vec![0];
        while let Some(n) = stack.pop() {
            let Some(outside) = self.outside(self.node_box(n), query, self.delta, off) else {
                continue;
            };
            let node = self.nodes[n];
            let cells = &self.cells[node.first..node.end];
            if outside == off && self.is_core(n, query) {
                let all = cells.iter().map(|&cell| Hit { cell, outside });
                hits.extend(all);
            } else if node.second != 0 {
                stack.push(node.second);
                stack.push(n + 1);
            } else {
                for (at, &cell) in (node.first..).zip(cells) {
                    if let Some(outside) = self.outside(self.cell_box(at), query, self.delta, off) {
                        hits.push(Hit { cell, outside });
                    }
                }
            }
        }
        hits.sort_unstable_by_key(|h| h.cell);
        hits
    }

    /// How far a posture is from the nearest box, in tolerances: exact where it is at most 1. Farther off, where bounds
    /// of many coordinates exclude little, the nearest of `visits` boxes looked at, the likeliest first.
    pub fn nearest(&self, query: &Query, visits: usize) -> f32 {
        if self.cells.is_empty() {
            return f32::INFINITY;
        }
        let mut gaps = vec![0.0; query.gaps.len()];
        let (mut best, mut off) = (f32::INFINITY, 0);
        let mut visited = 0;
        let mut stack = vec![(0, 0.0)];
        while let Some((n, least)) = stack.pop() {
            // What may hold a posture is looked at, however many went before.
            if least >= best || (least > 1.0 && visited >= visits) {
                continue;
            }
            let node = self.nodes[n];
            if node.second == 0 {
                for at in node.first..node.end {
                    let bounds = self.cell_box(at);
                    let distance = self.distance(bounds, query, best, off, &mut gaps);
                    if distance < best {
                        best = distance;
                        off = query.beyond(best);
                    }
                }
                visited += node.end - node.first;
                continue;
            }
            let mut children = [n + 1, node.second].map(|c| {
                let bounds = self.node_box(c);
                (c, self.distance(bounds, query, best, off, &mut gaps))
            });
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            visited += 2;
            stack.extend(children);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    const DIMS: usize = 5;
    const PARTS: usize = 3;
    const PART_OF: [usize; DIMS] = [0, 0, 1, 2, 2];

    /// Boxes along a curve in five dimensions, two coordinates each of two parts, one of a third.
    fn cells(rng: &mut Pcg64) -> Cells {
        let (rows, pieces) = (7, 20);
        let (mut low, mut high) = (Vec::new(), Vec::new());
        for row in 0..rows {
            for piece in 0..pieces {
                for c in 0..DIMS {
                    let t = piece as f32 / 20.0 * (1.0 + c as f32) + 0.3 * row as f32;
                    low.push(t.sin());
                    high.push(t.sin() + rng.random_range(0.0..0.2));
                }
            }
        }
        Cells {
            pieces,
            cyclic: false,
            params: 0,
            points: Vec::new(),
            reach: Vec::new(),
            rows,
            dims: DIMS,
            low,
            high,
        }
    }

    /// How far each part of a posture is from the box of a cell, in tolerances.
    fn gaps(cells: &Cells, cell: usize, query: &Query, delta: f32) -> Vec<f32> {
        let mut gaps = query.gaps.clone();
        for c in 0..DIMS {
            let (low, high) = (cells.low[cell * DIMS + c], cells.high[cell * DIMS + c]);
            let x = query.at[c];
            let off = (low - x).max(x - high);
            if !x.is_nan() && off > 0.0 {
                gaps[PART_OF[c]] = gaps[PART_OF[c]].max(off / delta);
            }
        }
        gaps
    }

    #[test]
    fn the_tree_finds_what_looking_at_every_cell_finds() {
        let mut rng = Pcg64::seed_from_u64(11);
        let (mut found, mut far) = (0, 0);
        for _ in 0..400 {
            let cells = cells(&mut rng);
            let delta = rng.random_range(0.05..0.8);
            let faults = rng.random_range(0..3);
            let columns = [3, 0, 4, 2, 1];
            let part_of = columns.map(|c| PART_OF[c]);
            let tree = Tree::new(&cells, &columns, &part_of, delta, faults);
            let at: Vec<f32> = (0..DIMS)
                .map(|_| match rng.random_bool(0.15) {
                    true => f32::NAN,
                    false => rng.random_range(-1.3..1.4),
                })
                .collect();
            let plain = Query {
                at,
                gaps: (0..PARTS).map(|_| rng.random_range(0.0..1.2)).collect(),
            };
            let query = Query {
                at: columns.iter().map(|&c| plain.at[c]).collect(),
                gaps: plain.gaps.clone(),
            };
            let mut expected = Vec::new();
            let mut nearest = f32::INFINITY;
            for cell in 0..cells.count() {
                let mut gaps = gaps(&cells, cell, &plain, delta as f32);
                let outside: u64 = (0..PARTS).map(|p| u64::from(gaps[p] > 1.0) << p).sum();
                if outside.count_ones() as usize <= faults {
                    let cell = cell as u32;
                    expected.push(Hit { cell, outside });
                }
                gaps.sort_by(|a, b| b.total_cmp(a));
                nearest = nearest.min(gaps[faults]);
            }
            assert_eq!(tree.hits(&query), expected);
            assert!((tree.nearest(&query, usize::MAX) - nearest).abs() < 1e-5);
            let quick = tree.nearest(&query, 20);
            assert!(quick > nearest - 1e-5);
            assert!((quick - nearest).abs() < 1e-5 || nearest > 1.0 - 1e-5);
            found += usize::from(!expected.is_empty());
            far += usize::from(expected.is_empty());
        }
        assert!(found > 50 && far > 50, "{found} {far}");
    }
}
