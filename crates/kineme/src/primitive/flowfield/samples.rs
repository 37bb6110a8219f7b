//! [`Samples`]: postures of many courses at many phases in few coordinates.

/// Courses scanned together.
pub(super) const LANES: usize = 8;
/// Coordinates at most.
pub(super) const MOST_AXES: usize = 16;
/// Pieces of phase at most.
pub(super) const MOST_PIECES: usize = 128;
/// Neighbours at most: one more bounds their kernel.
pub(super) const MOST_NEIGHBOURS: usize = 31;

/// Blocks of courses at most.
pub(super) const MOST_BLOCKS: usize = 128;

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
    /// Greatest way of a block's courses from each phase to the next.
    ways: Vec<f64>,
}

/// What is known of the phase: places cost `stiffness` times their squared distance from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Prior {
    pub phase: f64,
    pub stiffness: f64,
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
        let mut samples = Self {
            courses,
            phases,
            axes,
            pieces,
            cyclic,
            values,
            ways: Vec::new(),
        };
        samples.ways = (0..blocks * phases)
            .map(|i| samples.way(i / phases, i % phases))
            .collect();
        samples
    }

    /// The greatest way of a block's courses from a phase to the next.
    fn way(&self, block: usize, phase: usize) -> f64 {
        if !self.cyclic && phase + 1 == self.phases {
            return 0.0;
        }
        let here = self.lanes(block, phase as i64);
        let next = self.lanes(block, phase as i64 + 1);
        let mut most = 0.0;
        for lane in 0..self.width(block) {
            let gaps = here.iter().zip(next).map(|(a, b)| b[lane] - a[lane]);
            most = f64::max(most, gaps.map(|g| g * g).sum());
        }
        most.sqrt()
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

    /// Courses of a block.
    pub fn width(&self, block: usize) -> usize {
        (self.courses - block * LANES).min(LANES)
    }

    pub fn ways_at(&self, block: usize, place: i64) -> f64 {
        self.ways[block * self.phases + self.row(place)]
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
}
