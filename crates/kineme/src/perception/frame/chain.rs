//! Postures that follow one another on one course: a hidden Markov chain over phase, parameters held.

/// What cells explain a posture, and how well: cells ascending, `row * pieces + piece`.
pub(super) type Explained = Vec<(u32, f64)>;

/// The shape of a lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub rows: usize,
    pub pieces: usize,
    pub cyclic: bool,
}

impl Shape {
    /// The chance of a phase after another one: uniform over those not before it; of a cycle, over the half of it that
    /// comes next.
    #[cfg(test)]
    pub fn transition(&self, from: usize, to: usize) -> f64 {
        if self.cyclic {
            let ahead = (to + self.pieces - from) % self.pieces;
            f64::from(ahead < self.half()) / self.half() as f64
        } else {
            f64::from(to >= from) / (self.pieces - from) as f64
        }
    }

    /// Pieces of half a cycle.
    fn half(&self) -> usize {
        self.pieces.div_ceil(2)
    }

    /// The joint density of cell and first posture: every cell is as likely.
    pub fn begin(&self, first: &Explained) -> Explained {
        let cells = (self.rows * self.pieces) as f64;
        first.iter().map(|&(c, e)| (c, e / cells)).collect()
    }

    /// The joint density of cell and all postures, one posture later: phase does not decrease, parameters stay. Linear
    /// in the number of cells, by sums of each row.
    pub fn advance(&self, before: &Explained, next: &Explained) -> Explained {
        let pieces = self.pieces as u32;
        let mut after = Vec::new();
        let mut from = 0;
        let mut at = 0;
        let mut sums = Vec::new();
        while at < next.len() {
            let row = next[at].0 / pieces;
            let end = at + next[at..].partition_point(|(c, _)| c / pieces == row);
            from += before[from..].partition_point(|(c, _)| c / pieces < row);
            let until = from + before[from..].partition_point(|(c, _)| c / pieces == row);
            let own = &before[from..until];
            if !own.is_empty() {
                self.advance_row(row * pieces, own, &next[at..end], &mut sums, &mut after);
            }
            (from, at) = (until, end);
        }
        after
    }

    /// One row, whose first cell is `start`.
    fn advance_row(
        &self,
        start: u32,
        own: &[(u32, f64)],
        next: &[(u32, f64)],
        sums: &mut Vec<f64>,
        after: &mut Explained,
    ) {
        let shares = |piece: u32| match self.cyclic {
            true => 1.0 / self.half() as f64,
            false => 1.0 / (self.pieces - piece as usize) as f64,
        };
        sums.clear();
        sums.push(0.0);
        let mut sum = 0.0;
        for &(cell, a) in own {
            sum += a * shares(cell - start);
            sums.push(sum);
        }
        // The sum over the pieces from one to before another; no difference of equal sums where there is none of them.
        let between = |low: u32, high: u32| {
            let [i, j] = [low, high].map(|p| own.partition_point(|(c, _)| c - start < p));
            if i < j { sums[j] - sums[i] } else { 0.0 }
        };
        let pieces = self.pieces as u32;
        for &(cell, e) in next {
            let after_it = cell - start + 1;
            let half = self.half() as u32;
            let reached = match self.cyclic {
                false => between(0, after_it),
                true if after_it >= half => between(after_it - half, after_it),
                true => between(0, after_it) + between(after_it + pieces - half, pieces),
            };
            if reached > 0.0 {
                after.push((cell, e * reached));
            }
        }
    }
}

/// The product of what explains two postures: a cell that does not move.
pub(super) fn hold(before: &Explained, next: &Explained) -> Explained {
    let mut after = Vec::new();
    let mut rest = before.as_slice();
    for &(cell, e) in next {
        let skip = rest.partition_point(|(c, _)| *c < cell);
        rest = &rest[skip..];
        if let Some(&(c, a)) = rest.first()
            && c == cell
        {
            after.push((cell, a * e));
        }
    }
    after
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    #[test]
    fn the_chain_equals_the_plain_sums_over_all_paths() {
        let mut rng = Pcg64::seed_from_u64(7);
        for case in 0..200 {
            let shape = Shape {
                rows: 3,
                pieces: 5 + case % 4,
                cyclic: case % 2 == 1,
            };
            let mut explained = || -> Explained {
                (0..(shape.rows * shape.pieces) as u32)
                    .map(|c| (c, rng.random_range(-1.0..1.0)))
                    .filter(|(_, e)| *e > 0.0)
                    .collect()
            };
            let seen = [explained(), explained(), explained()];
            let alpha = shape.begin(&seen[0]);
            let two = shape.advance(&alpha, &seen[1]);
            let three = shape.advance(&two, &seen[2]);
            let first = 1.0 / (shape.rows * shape.pieces) as f64;
            let step = |a: u32, b: u32| {
                let n = shape.pieces as u32;
                match a / n == b / n {
                    true => shape.transition((a % n) as usize, (b % n) as usize),
                    false => 0.0,
                }
            };
            let (mut plain_two, mut plain_three) = (0.0, 0.0);
            for &(a, x) in &seen[0] {
                for &(b, y) in &seen[1] {
                    let path = first * x * step(a, b) * y;
                    plain_two += path;
                    for &(c, z) in &seen[2] {
                        plain_three += path * step(b, c) * z;
                    }
                }
            }
            let total = |e: &Explained| e.iter().map(|(_, v)| v).sum::<f64>();
            assert!((total(&two) - plain_two).abs() < 1e-12, "{shape:?}");
            assert!((total(&three) - plain_three).abs() < 1e-12, "{shape:?}");
        }
    }

    #[test]
    fn of_postures_that_tell_nothing_the_chain_tells_nothing() {
        for cyclic in [false, true] {
            let shape = Shape {
                rows: 2,
                pieces: 7,
                cyclic,
            };
            let all: Explained = (0..14).map(|c| (c, 1.0)).collect();
            let alpha = shape.advance(&shape.advance(&shape.begin(&all), &all), &all);
            let total: f64 = alpha.iter().map(|(_, v)| v).sum();
            assert!((total - 1.0).abs() < 1e-12, "{cyclic}: {total}");
        }
    }
}
