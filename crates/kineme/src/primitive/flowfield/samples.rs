//! [`Samples`]: postures of many courses at many phases in few coordinates, scanned flat.
//!
//! The scan visits every course within a window of phases, so its time has a bound that no posture can exceed; trees over
//! postures are faster on the manifold and slower than a flat scan off it.

use pulp::{Arch, Simd, WithSimd};

/// Courses scanned together.
pub(super) const LANES: usize = 8;
/// Coordinates at most.
pub(super) const MOST_AXES: usize = 16;
/// Pieces of phase at most.
pub(super) const MOST_PIECES: usize = 128;
/// Neighbours at most: one more bounds their kernel.
pub(super) const MOST_NEIGHBOURS: usize = 31;

/// One number of each of [`LANES`] courses.
pub(super) type Lane = [f64; LANES];

/// Postures by course, phase and coordinate.
#[derive(Debug, Clone)]
pub(super) struct Samples {
    courses: usize,
    /// Phases of each course: one more than pieces, or as many where the last is the first.
    phases: usize,
    axes: usize,
    pieces: usize,
    cyclic: bool,
    /// `[block][phase][axis]` of lanes; lanes without a course are infinitely far.
    values: Vec<Lane>,
}

/// Places in phase that are looked at, as numbers of pieces that in a cycle need not be within it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub first: i64,
    pub last: i64,
}

/// The place on a course that is nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Match {
    pub course: usize,
    /// Squared distance, with what its phase costs.
    pub cost: f64,
    /// The middle one of three samples ...
    pub centre: i64,
    /// ... and the place between them, from -1 to 1.
    pub offset: f64,
}

/// The nearest courses, nearest first.
#[derive(Debug, Clone)]
pub(super) struct Matches {
    list: [Match; MOST_NEIGHBOURS + 1],
    len: usize,
    most: usize,
}

impl Matches {
    pub fn new(most: usize) -> Self {
        let none = Match {
            course: usize::MAX,
            cost: f64::INFINITY,
            centre: 0,
            offset: 0.0,
        };
        Self {
            list: [none; MOST_NEIGHBOURS + 1],
            len: 0,
            most: most.min(MOST_NEIGHBOURS + 1),
        }
    }

    pub fn as_slice(&self) -> &[Match] {
        &self.list[..self.len]
    }

    /// Puts a match in its place; of equals the one that came first stays first.
    pub fn offer(&mut self, new: Match) {
        if self.len == self.most {
            if new.cost >= self.list[self.len - 1].cost {
                return;
            }
            self.len -= 1;
        }
        let mut at = self.len;
        while at > 0 && self.list[at - 1].cost > new.cost {
            self.list[at] = self.list[at - 1];
            at -= 1;
        }
        self.list[at] = new;
        self.len += 1;
    }
}

impl Samples {
    /// Samples whose coordinates `value(course, phase, axis)` tells.
    pub fn new(
        [courses, pieces, axes]: [usize; 3],
        cyclic: bool,
        value: impl Fn(usize, usize, usize) -> f64,
    ) -> Self {
        let phases = pieces + usize::from(!cyclic);
        let blocks = courses.div_ceil(LANES);
        let mut values = Vec::with_capacity(blocks * phases * axes);
        for block in 0..blocks {
            for phase in 0..phases {
                for axis in 0..axes {
                    let of = |lane: usize| {
                        let course = block * LANES + lane;
                        if course < courses {
                            value(course, phase, axis)
                        } else {
                            f64::INFINITY
                        }
                    };
                    values.push(std::array::from_fn(of));
                }
            }
        }
        Self {
            courses,
            phases,
            axes,
            pieces,
            cyclic,
            values,
        }
    }

    pub fn courses(&self) -> usize {
        self.courses
    }

    pub fn blocks(&self) -> usize {
        self.courses.div_ceil(LANES)
    }

    pub fn pieces(&self) -> usize {
        self.pieces
    }

    /// All phases; of a cycle with one more on either side, so that each has its neighbours.
    pub fn everywhere(&self) -> Window {
        let last = self.pieces as i64;
        match self.cyclic {
            true => Window { first: -1, last },
            false => Window { first: 0, last },
        }
    }

    /// The window from a little behind a phase to a little ahead of it, at least three samples.
    pub fn around(&self, phase: f64, [behind, ahead]: [f64; 2]) -> Window {
        let pieces = self.pieces as f64;
        let mut first = ((phase - behind) * pieces).floor() as i64;
        let mut last = ((phase + ahead) * pieces).ceil() as i64;
        if !self.cyclic {
            let end = self.pieces as i64;
            last = last.clamp(2, end);
            first = first.clamp(0, last - 2);
        } else if last < first + 2 {
            last = first + 2;
        }
        Window { first, last }
    }

    /// The row of a place in phase.
    pub fn row(&self, place: i64) -> usize {
        if self.cyclic {
            place.rem_euclid(self.pieces as i64) as usize
        } else {
            place as usize
        }
    }

    /// Coordinates of [`LANES`] courses at a place.
    pub fn lanes(&self, block: usize, place: i64) -> &[Lane] {
        let first = (block * self.phases + self.row(place)) * self.axes;
        &self.values[first..first + self.axes]
    }

    /// The phase of a match, as the window counts.
    pub fn phase(&self, found: &Match) -> f64 {
        (found.centre as f64 + found.offset) / self.pieces as f64
    }

    /// The coordinates of a match.
    pub fn posture(&self, found: &Match, posture: &mut [f64; MOST_AXES]) {
        let (block, lane) = (found.course / LANES, found.course % LANES);
        let u = found.offset;
        let basis = [0.5 * u * (u - 1.0), 1.0 - u * u, 0.5 * u * (u + 1.0)];
        *posture = [0.0; MOST_AXES];
        for (step, share) in (-1..=1).zip(basis) {
            let row = self.lanes(block, found.centre + step);
            for (x, lanes) in posture.iter_mut().zip(row) {
                *x += share * lanes[lane];
            }
        }
    }

    /// The nearest place of each course to `query` within the window, the `most` nearest of them. `courses(block)` is what
    /// courses cost beside the distance, `places(block, place)` what places do.
    pub fn nearest(
        &self,
        query: &[f64; MOST_AXES],
        window: Window,
        most: usize,
        courses: impl Fn(usize) -> Lane,
        places: impl Fn(usize, i64) -> Lane,
    ) -> Matches {
        Arch::new().dispatch(Scan {
            samples: self,
            query,
            window,
            most,
            courses,
            places,
        })
    }
}

struct Scan<'a, C, P> {
    samples: &'a Samples,
    query: &'a [f64; MOST_AXES],
    window: Window,
    most: usize,
    courses: C,
    places: P,
}

impl<C: Fn(usize) -> Lane, P: Fn(usize, i64) -> Lane> WithSimd for Scan<'_, C, P> {
    type Output = Matches;

    // Inlined into a function compiled for the machine's vector instructions; the loops over lanes vectorise there.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Matches {
        let Window { first, last } = self.window;
        let rows = (last - first + 1) as usize;
        let mut costs = [[0.0; LANES]; MOST_PIECES + 2];
        let mut matches = Matches::new(self.most);
        for block in 0..self.samples.blocks() {
            let own = (self.courses)(block);
            let (mut least, mut at) = ([f64::INFINITY; LANES], [0.0; LANES]);
            for (row, cost) in costs[..rows].iter_mut().enumerate() {
                let place = first + row as i64;
                let mut sum = (self.places)(block, place);
                for (s, c) in sum.iter_mut().zip(&own) {
                    *s += c;
                }
                for (q, lanes) in self.query.iter().zip(self.samples.lanes(block, place)) {
                    for (s, x) in sum.iter_mut().zip(lanes) {
                        *s += (q - x) * (q - x);
                    }
                }
                *cost = sum;
                for lane in 0..LANES {
                    let nearer = sum[lane] < least[lane];
                    least[lane] = if nearer { sum[lane] } else { least[lane] };
                    at[lane] = if nearer { row as f64 } else { at[lane] };
                }
            }
            let courses = (self.samples.courses - block * LANES).min(LANES);
            for (lane, &row) in at[..courses].iter().enumerate() {
                let (centre, offset, cost) = vertex(&costs[..rows], lane, row as usize);
                matches.offer(Match {
                    course: block * LANES + lane,
                    cost,
                    centre: first + centre as i64,
                    offset,
                });
            }
        }
        matches
    }
}

/// The least value of the parabola through the three costs round the least one: exact where a course is straight and
/// even. The row in the middle, the place from it in rows, the cost.
fn vertex(costs: &[Lane], lane: usize, least: usize) -> (usize, f64, f64) {
    let centre = least.clamp(1, costs.len() - 2);
    let [before, here, after] = [-1, 0, 1].map(|d: i64| costs[(centre as i64 + d) as usize][lane]);
    let bend = before - 2.0 * here + after;
    let slope = 0.5 * (after - before);
    if bend <= 0.0 {
        return (centre, least as f64 - centre as f64, costs[least][lane]);
    }
    let offset = (-slope / bend).clamp(-1.0, 1.0);
    let cost = here + offset * (slope + 0.5 * offset * bend);
    (centre, offset, cost.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn the_scan_in_lanes_equals_the_plain_scan() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        for (courses, cyclic) in [(1, false), (7, true), (8, false), (29, true), (100, false)] {
            let (pieces, axes) = (24, 5);
            let values: Vec<f64> = (0..courses * (pieces + 1) * axes)
                .map(|_| random.random_range(-1.0..1.0))
                .collect();
            let value = |c: usize, p: usize, a: usize| values[(c * (pieces + 1) + p) * axes + a];
            let samples = Samples::new([courses, pieces, axes], cyclic, value);
            for _ in 0..50 {
                let mut query = [0.0; MOST_AXES];
                for q in &mut query[..axes] {
                    *q = random.random_range(-1.0..1.0);
                }
                let phase = random.random_range(0.0..1.0);
                let window = samples.around(phase, [0.1, 0.2]);
                let extra = |_: usize, place: i64| {
                    let off = place as f64 / pieces as f64 - phase;
                    [off * off; LANES]
                };
                let own = |block: usize| std::array::from_fn(|l| 1e-3 * (block * LANES + l) as f64);
                let found = samples.nearest(&query, window, 6, own, extra);
                let mut plain: Vec<Match> = (0..courses)
                    .map(|course| {
                        let costs: Vec<Lane> = (window.first..=window.last)
                            .map(|place| {
                                let row = if cyclic {
                                    place.rem_euclid(pieces as i64)
                                } else {
                                    place
                                };
                                let mut sum = extra(0, place)[0] + 1e-3 * course as f64;
                                for (a, q) in query[..axes].iter().enumerate() {
                                    let gap = q - value(course, row as usize, a);
                                    sum += gap * gap;
                                }
                                [sum; LANES]
                            })
                            .collect();
                        let least = (0..costs.len())
                            .min_by(|a, b| costs[*a][0].total_cmp(&costs[*b][0]))
                            .expect("rows");
                        let (centre, offset, cost) = vertex(&costs, 0, least);
                        Match {
                            course,
                            cost,
                            centre: window.first + centre as i64,
                            offset,
                        }
                    })
                    .collect();
                plain.sort_by(|a, b| a.cost.total_cmp(&b.cost));
                plain.truncate(6);
                assert_eq!(found.as_slice(), plain);
            }
        }
    }
}
