//! [`Cells`]: a primitive cut into patches of its manifold, each with the box of its postures.

use rayon::prelude::*;

use crate::error::Result;
use crate::perception::parts::Parts;
use crate::perception::rows::{MOST_DIMS, is_inside, lattice, own_places};
use crate::primitive::{Course, Primitive};

/// A lattice of cells over (p, τ): rows of parameters times pieces of phase.
///
/// A cell is a patch of the manifold and not a point of it: its box holds the postures of all (p, τ) in it, so that
/// nothing falls between cells. Over phase, where f is cubic between knots, the box is that of the control points of
/// its pieces (convex hull property of Bézier curves), which is exact. Over parameters it is that of the patch's
/// corners and middles, widened by a quarter of the bend between them, which is exact where f is quadratic in p.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    /// Pieces of phase.
    pub pieces: usize,
    /// Whether the last piece is followed by the first.
    pub cyclic: bool,
    /// The number of parameters.
    pub params: usize,
    /// The middle of each row's patch of parameters, rows x parameters.
    pub points: Vec<f64>,
    /// Half of its length along each parameter, rows x parameters; 0 where the row is a single place.
    pub reach: Vec<f64>,
    /// The number of rows.
    pub rows: usize,
    /// Coordinates of a box.
    pub dims: usize,
    /// Least values, cells x coordinates, cell `row * pieces + piece`.
    pub low: Vec<f32>,
    /// Greatest values.
    pub high: Vec<f32>,
}

/// Boxes of one course, pieces x coordinates.
struct Strip {
    low: Vec<f32>,
    high: Vec<f32>,
}

impl Cells {
    /// Cuts a primitive: `across` patches along each of one, two or three parameters, `pieces` of phase.
    pub fn of(
        primitive: &Primitive,
        parts: &Parts,
        across: &[usize; MOST_DIMS],
        pieces: usize,
    ) -> Result<Self> {
        let params = primitive.parameters().dims();
        let knots = primitive.fitted().knots;
        let strip = |p: &Vec<f64>| {
            let course = primitive.at(p)?;
            Ok(strip(&course, parts, knots, pieces))
        };
        let mut cells = Self {
            pieces,
            cyclic: primitive.is_cyclic(),
            params,
            points: Vec::new(),
            reach: Vec::new(),
            rows: 0,
            dims: parts.dims(),
            low: Vec::new(),
            high: Vec::new(),
        };
        if (1..=MOST_DIMS).contains(&params) {
            let patches = across[params - 1];
            let nodes = 2 * patches + 1;
            let places = lattice(params, nodes);
            let strips: Vec<Strip> = places.par_iter().map(strip).collect::<Result<_>>()?;
            let inside: Vec<bool> = places.par_iter().map(|p| is_inside(primitive, p)).collect();
            let strides: Vec<usize> = (0..params)
                .map(|d| nodes.pow((params - 1 - d) as u32))
                .collect();
            let corners = lattice(params, patches);
            let index = |p: &Vec<f64>| -> usize {
                let step = |x: &f64| (x * (patches.max(2) - 1) as f64).round() as usize;
                p.iter().zip(&strides).map(|(x, s)| 2 * step(x) * s).sum()
            };
            let offsets = offsets(&strides);
            let used: Vec<usize> = corners
                .iter()
                .map(index)
                .filter(|c| offsets.iter().any(|(o, _)| inside[c + o]))
                .collect();
            let boxes: Vec<Strip> = used
                .par_iter()
                .map(|&c| patch(&strips, c, &strides, &offsets))
                .collect();
            let middle: usize = strides.iter().sum();
            for (corner, strip) in used.iter().zip(boxes) {
                cells.points.extend(&places[corner + middle]);
                cells
                    .reach
                    .extend((0..params).map(|_| 0.5 / patches as f64));
                cells.push(strip);
            }
        } else if params == 0 {
            cells.push(strip(&Vec::new())?);
        }
        for p in own_places(primitive) {
            let strip = strip(&p)?;
            cells.points.extend(&p);
            cells.reach.extend(p.iter().map(|_| 0.0));
            cells.push(strip);
        }
        Ok(cells)
    }

    fn push(&mut self, strip: Strip) {
        self.rows += 1;
        self.low.extend(strip.low);
        self.high.extend(strip.high);
    }

    /// The number of cells.
    pub fn count(&self) -> usize {
        self.rows * self.pieces
    }

    /// The least and greatest value of each coordinate.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        let mut bounds = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.dims];
        let rows = self
            .low
            .chunks_exact(self.dims)
            .zip(self.high.chunks_exact(self.dims));
        for (low, high) in rows {
            for (b, (l, h)) in bounds.iter_mut().zip(low.iter().zip(high)) {
                *b = [b[0].min(f64::from(*l)), b[1].max(f64::from(*h))];
            }
        }
        bounds
    }
}

/// Places of a patch's nodes from its first, three along each parameter, with their digits.
fn offsets(strides: &[usize]) -> Vec<(usize, Vec<usize>)> {
    lattice(strides.len(), 3)
        .into_iter()
        .map(|p| {
            let digits: Vec<usize> = p.iter().map(|x| (2.0 * x).round() as usize).collect();
            let at = digits.iter().zip(strides).map(|(d, s)| d * s).sum();
            (at, digits)
        })
        .collect()
}

/// The boxes of the patch that begins at node `corner`.
fn patch(
    strips: &[Strip],
    corner: usize,
    strides: &[usize],
    offsets: &[(usize, Vec<usize>)],
) -> Strip {
    let size = strips[corner].low.len();
    let mut low = vec![f32::INFINITY; size];
    let mut high = vec![f32::NEG_INFINITY; size];
    for (o, _) in offsets {
        let node = &strips[corner + o];
        for i in 0..size {
            low[i] = low[i].min(node.low[i]);
            high[i] = high[i].max(node.high[i]);
        }
    }
    // A parabola leaves the chord of half a patch by a quarter of what it leaves that of the whole.
    let mut bend = vec![0.0f32; size];
    for (d, stride) in strides.iter().enumerate() {
        bend.fill(0.0);
        for (o, _) in offsets.iter().filter(|(_, digits)| digits[d] == 0) {
            let [a, b, c] = [0, 1, 2].map(|k| &strips[corner + o + k * stride]);
            for (i, bend) in bend.iter_mut().enumerate() {
                let below = (b.low[i] - 0.5 * (a.low[i] + c.low[i])).abs();
                let above = (b.high[i] - 0.5 * (a.high[i] + c.high[i])).abs();
                *bend = bend.max(below).max(above);
            }
        }
        for i in 0..size {
            low[i] -= 0.25 * bend[i];
            high[i] += 0.25 * bend[i];
        }
    }
    Strip { low, high }
}

/// The boxes of a course.
fn strip(course: &Course, parts: &Parts, knots: usize, pieces: usize) -> Strip {
    let dims = parts.dims();
    let mut strip = Strip {
        low: vec![f32::INFINITY; pieces * dims],
        high: vec![f32::NEG_INFINITY; pieces * dims],
    };
    // Where pieces and knots begin, in units of 1 / (pieces * (knots - 1)) of phase.
    let spans = knots - 1;
    let mut ends: Vec<usize> = (0..=pieces)
        .map(|i| i * spans)
        .chain((0..=spans).map(|k| k * pieces))
        .collect();
    ends.sort_unstable();
    ends.dedup();
    let all = (pieces * spans) as f64;
    // A closed course at phase 1 is asked at 0, which is the same posture and slope.
    let samples: Vec<(Vec<f64>, Vec<f64>)> = ends
        .iter()
        .map(|&e| {
            let s = course.sample(e as f64 / all);
            (parts.place(&s.pose), parts.place(&s.slope))
        })
        .collect();
    for (span, pair) in ends.windows(2).zip(samples.windows(2)) {
        let third = (span[1] - span[0]) as f64 / all / 3.0;
        let row = span[0] / spans * dims;
        for c in 0..dims {
            let (x, y) = (pair[0].0[c], pair[1].0[c]);
            for v in [x, x + third * pair[0].1[c], y - third * pair[1].1[c], y] {
                strip.low[row + c] = strip.low[row + c].min(v as f32);
                strip.high[row + c] = strip.high[row + c].max(v as f32);
            }
        }
    }
    strip
}
