//! Distances between items, dense or of the nearest candidates alone. Whoever measures them (time warping,
//! Euclidean points) fills these; embedding and clustering read them.

use rayon::prelude::*;

use crate::error::{Error, Result};

/// A symmetric matrix of distances with a zero diagonal.
///
/// Held as the upper triangle in f64: 4 n^2 bytes, as much as the full matrix in f32 (256 MB at 8,000 items), exactly
/// symmetric and without loss. Above about 8,000 items use [`Neighbours`] and landmarks.
/// A distance may be infinite (not reachable), never negative or NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceMatrix {
    len: usize,
    upper: Vec<f64>,
}

impl DistanceMatrix {
    /// The matrix of `len` items from its upper triangle, row by row: (0,1), (0,2), ..., (1,2), ...
    ///
    /// # Errors
    /// When there are not `len * (len - 1) / 2` values, or one is negative or NaN.
    pub fn from_upper(len: usize, upper: Vec<f64>) -> Result<Self> {
        let pairs = pair_count(len);
        if upper.len() != pairs {
            return Err(Error::invalid(format!(
                "{len} items have {pairs} pairs, found {} distances",
                upper.len()
            )));
        }
        if let Some(bad) = upper.iter().find(|d| d.is_nan() || **d < 0.0) {
            return Err(Error::invalid(format!(
                "a distance is zero or more, found {bad}"
            )));
        }
        Ok(Self { len, upper })
    }

    /// The matrix of `distance(i, j)` for every `i < j`, rows in parallel.
    ///
    /// # Errors
    /// When a distance is negative or NaN.
    pub fn from_fn(len: usize, distance: impl Fn(usize, usize) -> f64 + Sync) -> Result<Self> {
        let mut matrix = Self::filled(len, 0.0);
        matrix
            .upper_rows_mut()
            .into_par_iter()
            .enumerate()
            .for_each(|(i, row)| {
                for (value, j) in row.iter_mut().zip(i + 1..) {
                    *value = distance(i, j);
                }
            });
        Self::from_upper(len, matrix.upper)
    }

    /// Euclidean distances of points, row-major in `dimension` columns.
    ///
    /// # Errors
    /// When the values are no whole number of points, or not finite.
    pub fn euclidean(points: &[f64], dimension: usize) -> Result<Self> {
        let len = count_points(points, dimension)?;
        let at = |i: usize| &points[i * dimension..(i + 1) * dimension];
        Self::from_fn(len, |i, j| {
            let squares: f64 = at(i).iter().zip(at(j)).map(|(a, b)| (a - b).powi(2)).sum();
            squares.sqrt()
        })
    }

    pub(crate) fn filled(len: usize, value: f64) -> Self {
        Self {
            len,
            upper: vec![value; pair_count(len)],
        }
    }

    /// The number of items.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True without items.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The distance of two items, in either order; zero to itself.
    ///
    /// # Panics
    /// When an index is not below [`Self::len`].
    pub fn get(&self, i: usize, j: usize) -> f64 {
        assert!(i < self.len && j < self.len, "({i}, {j}) of {}", self.len);
        match i.cmp(&j) {
            std::cmp::Ordering::Less => self.upper[self.start(i) + j - i - 1],
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => self.upper[self.start(j) + i - j - 1],
        }
    }

    /// Distances of item `i` to the items after it.
    ///
    /// # Panics
    /// When `i` is not below [`Self::len`].
    pub fn upper_row(&self, i: usize) -> &[f64] {
        let start = self.start(i);
        &self.upper[start..start + self.len - i - 1]
    }

    /// Writes the distances of item `i` to all items, itself included, into `row`.
    ///
    /// # Panics
    /// When `i` is not below [`Self::len`] or `row` has another length.
    pub fn row_into(&self, i: usize, row: &mut [f64]) {
        assert_eq!(row.len(), self.len, "one distance an item");
        // Down column i the stored index grows by len - j - 2 from row j to the next.
        let mut place = i.wrapping_sub(1);
        for (j, value) in row[..i].iter_mut().enumerate() {
            *value = self.upper[place];
            place = place.wrapping_add(self.len - j - 2);
        }
        row[i] = 0.0;
        row[i + 1..].copy_from_slice(self.upper_row(i));
    }

    /// All distances, each pair once, row by row of the upper triangle.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The matrix of some of the items, in the order given.
    ///
    /// # Panics
    /// When an index is not below [`Self::len`].
    pub fn subset(&self, items: &[usize]) -> Self {
        let mut subset = Self::filled(items.len(), 0.0);
        subset
            .upper_rows_mut()
            .into_par_iter()
            .enumerate()
            .for_each(|(a, row)| {
                for (value, &j) in row.iter_mut().zip(&items[a + 1..]) {
                    *value = self.get(items[a], j);
                }
            });
        subset
    }

    /// The rows of the upper triangle, to be filled in parallel.
    pub(crate) fn upper_rows_mut(&mut self) -> Vec<&mut [f64]> {
        let mut rows = Vec::with_capacity(self.len);
        let mut rest = self.upper.as_mut_slice();
        for i in 0..self.len {
            let (row, after) = rest.split_at_mut(self.len - i - 1);
            rows.push(row);
            rest = after;
        }
        rows
    }

    fn start(&self, i: usize) -> usize {
        i * (2 * self.len - i - 1) / 2
    }
}

/// For each item some other items and their distances, nearest first: the K nearest, or the candidates that a search
/// has found among very many items.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbours {
    lists: Vec<Vec<(usize, f64)>>,
}

impl Neighbours {
    /// Candidates `(item, distance)` of each item in any order; the lists need not be symmetric.
    ///
    /// # Errors
    /// When a candidate is the item itself, named twice or no item at all, or a distance is negative or not finite.
    pub fn new(mut lists: Vec<Vec<(usize, f64)>>) -> Result<Self> {
        let len = lists.len();
        for (i, list) in lists.iter_mut().enumerate() {
            if let Some((j, d)) = list
                .iter()
                .find(|(j, d)| *j >= len || *j == i || !d.is_finite() || *d < 0.0)
            {
                return Err(Error::invalid(format!(
                    "item {i} of {len}: a neighbour is another item at a finite distance, found {j} at {d}"
                )));
            }
            list.sort_unstable_by_key(|(j, _)| *j);
            if let Some(twice) = list.windows(2).find(|w| w[0].0 == w[1].0) {
                return Err(Error::invalid(format!(
                    "item {i} names its neighbour {} twice",
                    twice[0].0
                )));
            }
            list.sort_unstable_by(by_distance);
        }
        Ok(Self { lists })
    }

    /// The `k` nearest other items of each item at finite distance; equal distances in the order of the items.
    pub fn nearest(distances: &DistanceMatrix, k: usize) -> Self {
        let lists = (0..distances.len())
            .into_par_iter()
            .map_init(
                || vec![0.0; distances.len()],
                |row, i| {
                    distances.row_into(i, row);
                    k_nearest(row, k, Some(i))
                },
            )
            .collect();
        Self { lists }
    }

    /// The number of items.
    pub fn len(&self) -> usize {
        self.lists.len()
    }

    /// True without items.
    pub fn is_empty(&self) -> bool {
        self.lists.is_empty()
    }

    /// The neighbours of an item, nearest first.
    ///
    /// # Panics
    /// When `i` is not below [`Self::len`].
    pub fn of(&self, i: usize) -> &[(usize, f64)] {
        &self.lists[i]
    }

    /// True when `j` is among the neighbours of `i`.
    pub fn contains(&self, i: usize, j: usize) -> bool {
        self.lists[i].iter().any(|(n, _)| *n == j)
    }

    /// The distance of two items if either names the other.
    pub fn distance(&self, i: usize, j: usize) -> Option<f64> {
        let named = |a: usize, b: usize| self.lists[a].iter().find(|(n, _)| *n == b).map(|n| n.1);
        named(i, j).or_else(|| named(j, i))
    }

    /// Each list cut to its `k` nearest.
    pub fn truncated(&self, k: usize) -> Self {
        let cut = |list: &Vec<(usize, f64)>| list.iter().take(k).copied().collect();
        Self {
            lists: self.lists.iter().map(cut).collect(),
        }
    }
}

/// The `k` nearest of a row of distances, `without` one item, nearest first, ties in the order of the items.
pub(crate) fn k_nearest(row: &[f64], k: usize, without: Option<usize>) -> Vec<(usize, f64)> {
    let mut list: Vec<(usize, f64)> = Vec::with_capacity(k.min(row.len()));
    for (j, &d) in row.iter().enumerate() {
        let farthest = list.last().map_or(f64::INFINITY, |n| n.1);
        let full = list.len() == k;
        if Some(j) == without || !d.is_finite() || (full && d >= farthest) || k == 0 {
            continue;
        }
        if full {
            list.pop();
        }
        list.insert(list.partition_point(|n| n.1 <= d), (j, d));
    }
    list
}

/// The number of points in row-major values.
pub(crate) fn count_points(points: &[f64], dimension: usize) -> Result<usize> {
    if dimension == 0 || !points.len().is_multiple_of(dimension) {
        return Err(Error::invalid(format!(
            "{} values are no whole number of points of dimension {dimension}",
            points.len()
        )));
    }
    if points.iter().any(|v| !v.is_finite()) {
        return Err(Error::invalid("points need finite coordinates"));
    }
    Ok(points.len() / dimension)
}

fn by_distance(a: &(usize, f64), b: &(usize, f64)) -> std::cmp::Ordering {
    a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))
}

fn pair_count(len: usize) -> usize {
    len * len.saturating_sub(1) / 2
}
