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

/// A box that a posture lies in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// The cell.
    pub cell: u32,
    /// The parts that lie outside, one bit each.
    pub outside: u64,
    /// How far the posture is from the box, in tolerances: of the part that is farthest but for those forgiven.
    pub distance: f32,
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
    /// The same of nodes.
    node_boxes: Vec<[f32; 2]>,
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
        let start = self.node_boxes.len();
        self.nodes.push(Node {
            first,
            end,
            second: 0,
        });
        let row = |cell: u32| &boxes[cell as usize * self.dims..(cell as usize + 1) * self.dims];
        let mut bounds = vec![[f32::INFINITY, f32::NEG_INFINITY]; self.dims];
        let mut middles = bounds.clone();
        for &cell in &order[first..end] {
            for ((b, m), x) in bounds.iter_mut().zip(&mut middles).zip(row(cell)) {
                *b = [b[0].min(x[0]), b[1].max(x[1])];
                let middle = x[0] + x[1];
                *m = [m[0].min(middle), m[1].max(middle)];
            }
        }
        self.node_boxes.extend(bounds);
        debug_assert_eq!(start, node * self.dims);
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

    /// The parts of a posture that are farther from a box than the tolerance; `None` as soon as they are too many.
    fn outside(&self, bounds: &[[f32; 2]], query: &Query, mut outside: u64) -> Option<u64> {
        for ((b, x), &part) in bounds.iter().zip(&query.at).zip(&self.part_of) {
            if b[0] - x > self.delta || x - b[1] > self.delta {
                outside |= 1 << part;
                if outside.count_ones() > self.faults {
                    return None;
                }
            }
        }
        Some(outside)
    }

    /// How far a posture is from a box, in tolerances, the farthest parts forgiven.
    fn distance(&self, bounds: &[[f32; 2]], query: &Query, gaps: &mut [f32]) -> f32 {
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

    /// All cells whose box a posture lies in, in the order of cells.
    pub fn hits(&self, query: &Query) -> Vec<Hit> {
        let mut hits = Vec::new();
        let mut off = 0u64;
        for (part, &gap) in query.gaps.iter().enumerate() {
            if gap > 1.0 {
                off |= 1 << part;
            }
        }
        if off.count_ones() > self.faults || self.cells.is_empty() {
            return hits;
        }
        let mut gaps = vec![0.0; query.gaps.len()];
        let mut stack = vec![0];
        while let Some(n) = stack.pop() {
            if self.outside(self.node_box(n), query, off).is_none() {
                continue;
            }
            let node = self.nodes[n];
            if node.second != 0 {
                stack.push(node.second);
                stack.push(n + 1);
                continue;
            }
            for at in node.first..node.end {
                let bounds = self.cell_box(at);
                if let Some(outside) = self.outside(bounds, query, off) {
                    hits.push(Hit {
                        cell: self.cells[at],
                        outside,
                        distance: self.distance(bounds, query, &mut gaps),
                    });
                }
            }
        }
        hits.sort_unstable_by_key(|h| h.cell);
        hits
    }

    /// How far a posture is from the nearest box, in tolerances, or `most` where no box is nearer than that.
    pub fn nearest(&self, query: &Query, most: f32) -> f32 {
        if self.cells.is_empty() {
            return most;
        }
        let mut gaps = vec![0.0; query.gaps.len()];
        let mut best = most;
        let mut stack = vec![(0, self.distance(self.node_box(0), query, &mut gaps))];
        while let Some((n, least)) = stack.pop() {
            if least >= best {
                continue;
            }
            let node = self.nodes[n];
            if node.second == 0 {
                for at in node.first..node.end {
                    best = best.min(self.distance(self.cell_box(at), query, &mut gaps));
                }
                continue;
            }
            let mut children = [n + 1, node.second]
                .map(|c| (c, self.distance(self.node_box(c), query, &mut gaps)));
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            stack.extend(children);
        }
        best
    }
}
