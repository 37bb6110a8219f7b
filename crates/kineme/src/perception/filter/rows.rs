//! Rows: each primitive's manifold as courses at single parameters, sampled evenly in time.

use rayon::prelude::*;

use crate::error::Result;
use crate::motion::Motion;
use crate::perception::rows::manifold;
use crate::primitive::{Course, Primitive, Sample, Travel, Vocabulary};

/// Moments a second at which a course is sampled, as far as [`FEWEST`] and [`MOST`] allow.
const RATE_HZ: f64 = 30.0;
const FEWEST: usize = 12;
const MOST: usize = 40;
/// The same for whole recordings of cycles, which last longer.
const MOST_WHOLE: usize = 64;
/// A manifold that bodies follow to the millimetre is sampled so many times as finely: in a thirtieth of a second a hand
/// leaves the tangent by more.
const FINER: f64 = 3.0;
/// Seconds of standing still before and after a movement that is no cycle: as long as displacements look back.
const STILL_SECS: f64 = super::features::WINDOW_SECS;
/// Phases at which a course's pace is read to know when it is where.
const PACE_STEPS: usize = 128;
/// Grid points a parameter, by the number of parameters, where parameters are a grid's to choose.
const GRID: [usize; 3] = [9, 5, 3];

/// A course: a primitive at fixed parameters.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// The primitive, an index into the vocabulary.
    pub primitive: usize,
    /// The exemplar whose own registered movement it is; `None` where it is interpolated.
    pub exemplar: Option<usize>,
    /// Its parameters in [0, 1]^m.
    pub parameters: Vec<f64>,
    /// Whether its end joins its beginning.
    pub cyclic: bool,
    /// Seconds from one moment to the next.
    pub step_secs: f64,
    /// Seconds for which the body stands still before phase 0 and after phase 1.
    pub still_secs: f64,
    /// How far along the row each moment is: from 0 to 1, of a cycle to just before 1.
    pub progress: Vec<f64>,
    /// The primitive's phase at each moment.
    pub phases: Vec<f64>,
    /// Whether it is a recording as it was, beside the cycle that was found in it.
    whole: bool,
}

/// What moves along a row.
pub(super) enum Path<'a> {
    /// A registered exemplar.
    Exemplar(&'a Primitive, usize),
    /// A course of the interpolated primitive.
    Course(Course),
    /// A recording as it was, over its share.
    Whole(&'a Motion),
}

impl Path<'_> {
    fn is_cyclic(&self) -> bool {
        match self {
            Self::Exemplar(primitive, _) => primitive.is_cyclic(),
            Self::Course(course) => course.is_cyclic(),
            Self::Whole(_) => false,
        }
    }

    pub fn sample(&self, phase: f64) -> Sample {
        match self {
            Self::Exemplar(primitive, i) => primitive.registered(*i, phase),
            Self::Course(course) => course.sample(phase),
            Self::Whole(motion) => sample_of(motion, phase),
        }
    }
}

/// Phase over time along a path.
pub(super) struct Clock {
    /// Seconds at evenly spaced phases.
    secs: Vec<f64>,
    cyclic: bool,
}

impl Clock {
    pub fn of(path: &Path<'_>, cyclic: bool) -> Self {
        let mut secs = vec![0.0; PACE_STEPS + 1];
        for k in 0..PACE_STEPS {
            // The middle of each piece stands for it.
            let phase = (k as f64 + 0.5) / PACE_STEPS as f64;
            secs[k + 1] = secs[k] + path.sample(phase).secs_per_phase / PACE_STEPS as f64;
        }
        Self { secs, cyclic }
    }

    pub fn duration_secs(&self) -> f64 {
        self.secs[PACE_STEPS]
    }

    /// Whether the movement is under way at a time.
    pub fn runs(&self, secs: f64) -> bool {
        self.cyclic || (secs > 0.0 && secs < self.duration_secs())
    }

    /// The phase at a time: held at both ends, or round and round.
    pub fn phase(&self, secs: f64) -> f64 {
        let whole = self.duration_secs();
        let secs = match self.cyclic {
            true => secs.rem_euclid(whole),
            false => secs.clamp(0.0, whole),
        };
        let k = self
            .secs
            .partition_point(|&s| s <= secs)
            .clamp(1, PACE_STEPS)
            - 1;
        let share = (secs - self.secs[k]) / (self.secs[k + 1] - self.secs[k]);
        ((k as f64 + share) / PACE_STEPS as f64).clamp(0.0, 1.0)
    }
}

/// The rows of a vocabulary, primitive by primitive; of each at most `most`, evenly taken among its exemplars.
///
/// Exemplars are rows as they are. Where a person named the parameters, or an effector's place is them, a grid of
/// interpolated courses stands between: there the manifold is known. Principal coordinates of a few people span no grid
/// worth believing, and on real people an exemplar itself is recognised by better than a blend. `finely`: the former
/// are sampled for who follows them to the millimetre.
pub(super) fn rows(vocabulary: &Vocabulary, most: usize, finely: bool) -> Result<Vec<Row>> {
    let of = |(i, p): (usize, &Primitive)| {
        let finer = if finely && manifold(p) { FINER } else { 1.0 };
        rows_of(i, p, most, finer)
    };
    let all: Vec<Vec<Row>> = vocabulary
        .primitives()
        .par_iter()
        .enumerate()
        .map(of)
        .collect::<Result<_>>()?;
    Ok(all.into_iter().flatten().collect())
}

fn rows_of(index: usize, primitive: &Primitive, most: usize, finer: f64) -> Result<Vec<Row>> {
    let n = primitive.exemplars().len();
    let taken = n.min(most.max(1));
    let mut rows: Vec<Row> = (0..taken)
        .map(|k| k * n / taken)
        .map(|i| {
            let path = Path::Exemplar(primitive, i);
            let p = primitive.point(i).to_vec();
            row(index, &path, Some(i), p, finer)
        })
        .collect();
    // What a recording does beside its cycle (a turn on the way) would else be forgotten.
    if primitive.is_cyclic() {
        let whole: Vec<Row> = rows.iter().map(|row| whole(primitive, row)).collect();
        rows.extend(whole);
    }
    for p in grid(primitive) {
        let near = |row: &Row| {
            let pairs = row.parameters.iter().zip(&p);
            pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() < 1e-6
        };
        let course = primitive.at(&p)?;
        // Outside of the exemplars' hull a course is that of its nearest point.
        let moved = course.parameters().iter().zip(&p);
        let outside = moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 1e-6;
        if rows.len() < most.max(taken) && !outside && !rows.iter().any(near) {
            let path = Path::Course(course);
            rows.push(row(index, &path, None, p, finer));
        }
    }
    Ok(rows)
}

/// How far apart the grid's points lie, of `m` parameters; `None` where there is no grid.
pub(super) fn spacing(m: usize) -> Option<f64> {
    let count = GRID.get(m.checked_sub(1)?)?;
    Some(1.0 / (count - 1) as f64)
}

/// Points of [0, 1]^m between the exemplars; none where parameters are principal coordinates.
fn grid(primitive: &Primitive) -> Vec<Vec<f64>> {
    let m = primitive.parameters().dims();
    let Some(&count) = m.checked_sub(1).and_then(|m| GRID.get(m)) else {
        return Vec::new();
    };
    if !manifold(primitive) {
        return Vec::new();
    }
    let place = |mut at: usize| {
        let mut p = Vec::with_capacity(m);
        for _ in 0..m {
            p.push((at % count) as f64 / (count - 1) as f64);
            at /= count;
        }
        p
    };
    (0..count.pow(m as u32)).map(place).collect()
}

fn row(
    index: usize,
    path: &Path<'_>,
    exemplar: Option<usize>,
    parameters: Vec<f64>,
    finer: f64,
) -> Row {
    let cyclic = path.is_cyclic();
    let clock = Clock::of(path, cyclic);
    let whole = clock.duration_secs();
    let most = (MOST as f64 * finer) as usize;
    let moments = ((whole * RATE_HZ * finer).round() as usize).clamp(FEWEST, most);
    // The last moment of a cycle is the first of the next.
    let step_secs = whole / (moments - usize::from(!cyclic)) as f64;
    let still = if cyclic {
        0
    } else {
        (STILL_SECS / step_secs).ceil() as usize
    };
    let still_secs = still as f64 * step_secs;
    let phases: Vec<f64> = (0..moments + 2 * still)
        .map(|k| clock.phase(k as f64 * step_secs - still_secs))
        .collect();
    Row {
        primitive: index,
        exemplar,
        parameters,
        cyclic,
        step_secs,
        still_secs,
        progress: phases.clone(),
        phases,
        whole: false,
    }
}

/// The whole recording of a row's exemplar, in step with its cycle.
fn whole(primitive: &Primitive, row: &Row) -> Row {
    let exemplar = row.exemplar.unwrap_or(0);
    let motion = &primitive.exemplars()[exemplar].motion;
    let fit = primitive.fitted();
    let (used, warp) = (&fit.used[exemplar], &fit.warps[exemplar]);
    let secs = motion.duration_secs().max(row.step_secs);
    let moments = ((secs * RATE_HZ).round() as usize).clamp(FEWEST, MOST_WHOLE);
    let progress: Vec<f64> = (0..moments)
        .map(|k| k as f64 / (moments - 1) as f64)
        .collect();
    let phase = |share: &f64| {
        let frame = share * (motion.frames() - 1) as f64;
        let place = (frame - used.start) / (used.end - used.start) - used.shift;
        warp.phase(place.rem_euclid(1.0)).rem_euclid(1.0)
    };
    Row {
        cyclic: false,
        step_secs: secs / (moments - 1) as f64,
        still_secs: 0.0,
        phases: progress.iter().map(phase).collect(),
        progress,
        whole: true,
        ..row.clone()
    }
}

/// The posture and travel of a motion at a share of it.
fn sample_of(motion: &Motion, share: f64) -> Sample {
    let last = motion.frames() - 1;
    let at = share.clamp(0.0, 1.0) * last as f64;
    let (i, j) = (at as usize, (at as usize + 1).min(last));
    let s = at - i as f64;
    let pairs = motion.pose(i).iter().zip(motion.pose(j));
    let pose: Vec<f64> = pairs.map(|(a, b)| a + s * (b - a)).collect();
    let (from, to) = (i.saturating_sub(1), (i + 2).min(last));
    let (a, b) = (motion.root(from), motion.root(to));
    let secs = (to - from).max(1) as f64 / motion.rate_hz();
    let (p, (sin, cos)) = (b.position - a.position, motion.root(i).yaw.sin_cos());
    Sample {
        slope: vec![0.0; pose.len()],
        pose,
        secs_per_phase: motion.duration_secs().max(1.0 / motion.rate_hz()),
        travel: Travel {
            forward: (cos * p.x + sin * p.y) / secs,
            left: (cos * p.y - sin * p.x) / secs,
            height: motion.root(i).position.z,
            yaw_rate: (b.yaw - a.yaw) / secs,
        },
    }
}

impl Row {
    /// How much of a moment the body stands still, before the movement or after it: these moments are the first and the
    /// last, many times. Half of the one with which the movement begins, and of the one with which it ends.
    pub fn rests(&self, k: usize) -> f64 {
        let ends = self.progress[k] == 0.0 || self.progress[k] == 1.0;
        match (self.cyclic, ends) {
            (false, true) if self.stands(k) => 1.0,
            (false, true) => 0.5,
            _ => 0.0,
        }
    }

    /// Whether the body stands still throughout a moment.
    pub fn stands(&self, k: usize) -> bool {
        let last = self.progress.len() - 1;
        let like =
            |share: f64, beside: usize| self.progress[k] == share && self.progress[beside] == share;
        !self.cyclic && (like(0.0, (k + 1).min(last)) || like(1.0, k.saturating_sub(1)))
    }

    /// What moves along the row.
    pub fn path<'a>(&self, vocabulary: &'a Vocabulary) -> Result<Path<'a>> {
        let primitive = &vocabulary.primitives()[self.primitive];
        Ok(match self.exemplar {
            Some(i) if self.whole => Path::Whole(&primitive.exemplars()[i].motion),
            Some(i) => Path::Exemplar(primitive, i),
            None => Path::Course(primitive.at(&self.parameters)?),
        })
    }
}
