//! Partitions of items: union-find, labels in the order of first appearance.

/// Disjoint sets of items with union by size and path halving (Tarjan 1975).
#[derive(Debug, Clone)]
pub struct UnionFind {
    parents: Vec<usize>,
    sizes: Vec<usize>,
}

impl UnionFind {
    /// `len` items, each a set of its own.
    pub fn new(len: usize) -> Self {
        Self {
            parents: (0..len).collect(),
            sizes: vec![1; len],
        }
    }

    /// The representative of the item's set.
    pub fn find(&mut self, mut item: usize) -> usize {
        while self.parents[item] != item {
            self.parents[item] = self.parents[self.parents[item]];
            item = self.parents[item];
        }
        item
    }

    /// Joins the sets of two items; false when they are one already.
    pub fn join(&mut self, a: usize, b: usize) -> bool {
        let (mut a, mut b) = (self.find(a), self.find(b));
        if a == b {
            return false;
        }
        if self.sizes[a] < self.sizes[b] {
            std::mem::swap(&mut a, &mut b);
        }
        self.parents[b] = a;
        self.sizes[a] += self.sizes[b];
        true
    }

    /// The set of every item, numbered from 0 in the order of first appearance.
    pub fn labels(&mut self) -> Vec<usize> {
        let sets: Vec<Option<usize>> = (0..self.parents.len())
            .map(|i| Some(self.find(i)))
            .collect();
        renumbered(&sets).into_iter().flatten().collect()
    }
}

/// The same partition with labels 0, 1, ... in the order of first appearance; items without a label stay without.
pub fn renumbered(labels: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut known = std::collections::HashMap::new();
    labels
        .iter()
        .map(|label| {
            label.map(|l| {
                let next = known.len();
                *known.entry(l).or_insert(next)
            })
        })
        .collect()
}

/// The size of each cluster of labels 0, 1, ...; items without a label are not counted.
pub fn cluster_sizes(labels: &[Option<usize>]) -> Vec<usize> {
    let count = labels.iter().flatten().max().map_or(0, |m| m + 1);
    let mut sizes = vec![0; count];
    for &label in labels.iter().flatten() {
        sizes[label] += 1;
    }
    sizes
}
