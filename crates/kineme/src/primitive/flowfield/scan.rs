//! The nearest courses to a posture, by a flat scan.
//!
//! The scan visits every course within a window of phases, so its time has a bound that no posture can exceed; trees over
//! postures are faster on the manifold and slower than a flat scan off it. A look at one phase, and how fast courses move,
//! tell which of them cannot be near: those are left out, and the answer is the same.

use pulp::{Arch, Simd, WithSimd};

use super::samples::{
    LANES, Lane, MOST_AXES, MOST_BLOCKS, MOST_PIECES, Match, Matches, Prior, Samples, Window,
};

impl Samples {
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
            prior: None,
            courses,
            places,
        })
    }

    /// As [`Self::nearest`], places costing what `prior` says.
    pub fn nearest_to(
        &self,
        query: &[f64; MOST_AXES],
        window: Window,
        most: usize,
        courses: impl Fn(usize) -> Lane,
        prior: Prior,
    ) -> Matches {
        Arch::new().dispatch(Scan {
            samples: self,
            query,
            window,
            most,
            prior: Some(prior),
            courses,
            places: self.places(prior),
        })
    }

    /// What places cost by a prior.
    fn places(&self, prior: Prior) -> impl Fn(usize, i64) -> Lane {
        let pieces = self.pieces() as f64;
        move |_, place| {
            let off = place as f64 / pieces - prior.phase;
            [prior.stiffness * off * off; LANES]
        }
    }
}

struct Scan<'a, C, P> {
    samples: &'a Samples,
    query: &'a [f64; MOST_AXES],
    window: Window,
    most: usize,
    /// What `places` say, where it allows to leave out blocks.
    prior: Option<Prior>,
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
        let mut bounds = [f64::NEG_INFINITY; MOST_BLOCKS];
        let enough = match self.prior {
            Some(prior) => self.bounds(prior, &mut bounds),
            None => f64::INFINITY,
        };
        for block in 0..self.samples.blocks() {
            if bounds[block.min(MOST_BLOCKS - 1)] > enough {
                continue;
            }
            let own = (self.courses)(block);
            let (mut least, mut at) = ([f64::INFINITY; LANES], [0.0; LANES]);
            for (row, cost) in costs[..rows].iter_mut().enumerate() {
                let place = first + row as i64;
                let sum = self.add_distance(block, place, add(own, (self.places)(block, place)));
                *cost = sum;
                for lane in 0..LANES {
                    let nearer = sum[lane] < least[lane];
                    least[lane] = if nearer { sum[lane] } else { least[lane] };
                    at[lane] = if nearer { row as f64 } else { at[lane] };
                }
            }
            for (lane, &row) in at[..self.samples.width(block)].iter().enumerate() {
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

impl<C: Fn(usize) -> Lane, P: Fn(usize, i64) -> Lane> Scan<'_, C, P> {
    #[inline(always)]
    fn add_distance(&self, block: usize, place: i64, mut sum: Lane) -> Lane {
        for (q, lanes) in self.query.iter().zip(self.samples.lanes(block, place)) {
            for (s, x) in sum.iter_mut().zip(lanes) {
                *s += (q - x) * (q - x);
            }
        }
        sum
    }

    /// What the courses of each block cost at least, and what is enough to be among the nearest: both from the postures
    /// at the phase that is expected.
    ///
    /// A course d away there, that moves by L a unit of phase, is d - L t away at t from there, where a place costs s t^2:
    /// together never less than d^2 s / (L^2 + s). The vertex of a parabola lies below its samples by an eighth of its
    /// second difference at most, which d and L bound, too.
    #[inline(always)]
    fn bounds(&self, prior: Prior, bounds: &mut [f64; MOST_BLOCKS]) -> f64 {
        let Window { first, last } = self.window;
        let piece = 1.0 / self.samples.pieces() as f64;
        let middle = (prior.phase / piece).round() as i64;
        let middle = middle.clamp(first, last);
        if self.samples.blocks() > MOST_BLOCKS {
            return f64::INFINITY;
        }
        let mut nearest = Matches::new(self.most);
        for (block, bound) in bounds[..self.samples.blocks()].iter_mut().enumerate() {
            let own = (self.courses)(block);
            let there = (self.places)(block, middle);
            let squared = self.add_distance(block, middle, [0.0; LANES]);
            let ways = (first..last).map(|place| self.samples.ways_at(block, place));
            let way = ways.fold(0.0, f64::max);
            let speed = way / piece;
            let share = prior.stiffness / (speed * speed + prior.stiffness);
            let bend = way * way + prior.stiffness * piece * piece;
            *bound = f64::INFINITY;
            for lane in 0..self.samples.width(block) {
                let far = (squared[lane].sqrt() - 0.5 * way).max(0.0);
                let least = far * far * share;
                let below = 0.25 * (2.0 * (least.sqrt() + way) * way + bend);
                *bound = bound.min(own[lane] + least - below);
                nearest.offer(Match {
                    course: lane,
                    cost: own[lane] + there[lane] + squared[lane],
                    centre: 0,
                    offset: 0.0,
                });
            }
        }
        match nearest.as_slice() {
            all if all.len() == self.most => all[all.len() - 1].cost,
            _ => f64::INFINITY,
        }
    }
}

#[inline(always)]
fn add(mut a: Lane, b: Lane) -> Lane {
    for (a, b) in a.iter_mut().zip(&b) {
        *a += b;
    }
    a
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

    /// Courses that wander smoothly, as movements do.
    fn wandering(random: &mut Pcg64Mcg, [courses, phases, axes]: [usize; 3]) -> Vec<f64> {
        let mut values = Vec::new();
        for _ in 0..courses {
            let parts: Vec<[f64; 3]> = (0..axes)
                .map(|_| [0, 1, 2].map(|_| random.random_range(-0.5..0.5)))
                .collect();
            for b in 0..phases {
                let turn = std::f64::consts::TAU * b as f64 / (phases - 1) as f64;
                values.extend(
                    parts
                        .iter()
                        .map(|[a, b, c]| a + b * turn.sin() + c * turn.cos()),
                );
            }
        }
        values
    }

    /// Every course at every place, sorted: what the scan should find.
    fn plain(
        value: &dyn Fn(usize, usize, usize) -> f64,
        [courses, pieces, axes]: [usize; 3],
        query: &[f64; MOST_AXES],
        window: Window,
        extra: &dyn Fn(usize, i64) -> [f64; 2],
    ) -> Vec<Match> {
        let mut all: Vec<Match> = (0..courses)
            .map(|course| {
                let cost = |place: i64| {
                    let row = place.rem_euclid(pieces as i64 + 1) as usize;
                    let [own, there] = extra(course, place);
                    let mut sum = own + there;
                    for (a, q) in query[..axes].iter().enumerate() {
                        let gap = q - value(course, row, a);
                        sum += gap * gap;
                    }
                    [sum; LANES]
                };
                let costs: Vec<Lane> = (window.first..=window.last).map(cost).collect();
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
        all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        all
    }

    #[test]
    fn the_scan_in_lanes_equals_the_plain_scan_whatever_it_leaves_out() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut left_out = 0;
        for (courses, cyclic) in [(1, false), (7, true), (8, false), (29, true), (400, false)] {
            let (pieces, axes, most) = (24, 5, 6);
            // A cycle's last phase is its first.
            let phases = if cyclic { pieces } else { pieces + 1 };
            let values = wandering(&mut random, [courses, pieces + 1, axes]);
            let value = |c: usize, p: usize, a: usize| values[(c * (pieces + 1) + p) * axes + a];
            let samples = Samples::new([courses, pieces, axes], cyclic, value);
            let wrapped = |c: usize, p: usize, a: usize| value(c, p % phases, a);
            let own = |course: usize| 1e-3 * (course % 50) as f64;
            let lanes = |block: usize| std::array::from_fn(|lane| own(block * LANES + lane));
            for round in 0..200 {
                let mut query = [0.0; MOST_AXES];
                for q in &mut query[..axes] {
                    *q = random.random_range(-1.0..1.0);
                }
                let prior = Prior {
                    phase: random.random_range(0.1..0.7),
                    stiffness: [0.4, 11.0, 100.0][round % 3],
                };
                let window = samples.around(prior.phase, [0.1, 0.2]);
                let places = samples.places(prior);
                let wanted = plain(
                    &wrapped,
                    [courses, pieces, axes],
                    &query,
                    window,
                    &|c, at| [own(c), places(0, at)[0]],
                );
                let whole = samples.nearest(&query, window, most, lanes, samples.places(prior));
                let found = samples.nearest_to(&query, window, most, lanes, prior);
                assert_eq!(whole.as_slice(), found.as_slice());
                for (f, w) in found.as_slice().iter().zip(&wanted) {
                    assert!(f.course == w.course && (f.cost - w.cost).abs() < 1e-12);
                }
                let scan = Scan {
                    samples: &samples,
                    query: &query,
                    window,
                    most,
                    prior: Some(prior),
                    courses: lanes,
                    places: samples.places(prior),
                };
                let mut bounds = [f64::NEG_INFINITY; MOST_BLOCKS];
                let enough = scan.bounds(prior, &mut bounds);
                left_out += bounds[..samples.blocks()]
                    .iter()
                    .filter(|b| **b > enough)
                    .count();
            }
        }
        assert!(left_out > 1000, "{left_out}");
    }
}
