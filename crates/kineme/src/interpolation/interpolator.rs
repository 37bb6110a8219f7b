//! The one type that callers hold: points, a method, and weights for a query.

use super::cardinal::{Cardinal, System};
use super::hull::{self, HULL_MARGIN};
use super::kernel::distance;
use super::method::Method;
use super::shepard::{self, COINCIDENT};
use crate::error::{Error, Result};

/// Points nearer than this share of the extent of all are one place.
const SAME_PLACE: f64 = 1e-9;
/// Parameters beyond this are refused: their powers would overflow.
const LARGEST: f64 = 1e100;

/// Weights over n exemplars as functions of their parameters. Valid by construction; equal points and method give an
/// equal interpolator, so these two are all that needs to be kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpolator {
    points: Vec<f64>,
    n: usize,
    dims: usize,
    method: Method,
    /// The places, coinciding points merged; row-major.
    places: Vec<f64>,
    /// The place of each point, never above the point's own number.
    place: Vec<usize>,
    /// Of its place's weight, the share that a point has.
    share: Vec<f64>,
    rule: Rule,
    notes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    /// One place.
    Constant,
    Shepard {
        power: f64,
    },
    Cardinal(Cardinal),
}

impl Interpolator {
    /// Fits `method` to `n` exemplars at `points` (n x `dims`, row-major, any units; `dims` may be 0, which makes the
    /// weights constant). Degenerate points are no error: what was done about them stands in [`Self::notes`].
    ///
    /// # Errors
    /// Without points, with a number of values other than n x dims, a value that is not finite or beyond 1e100, a
    /// setting of `method` out
    /// of its range, or a kernel other than Wendland's whose matrix is singular for these points.
    pub fn new(points: &[f64], n: usize, dims: usize, method: &Method) -> Result<Self> {
        method.check()?;
        if n == 0 || n.checked_mul(dims) != Some(points.len()) {
            return Err(Error::invalid(format!(
                "an interpolation needs {n} x {dims} parameters of at least one exemplar, found {}",
                points.len()
            )));
        }
        if let Some(i) = points
            .iter()
            .position(|x| !x.is_finite() || x.abs() > LARGEST)
        {
            return Err(Error::invalid(format!(
                "parameter {} of exemplar {} is {:e}, not a number of at most {LARGEST:e}",
                i % dims,
                i / dims,
                points[i]
            )));
        }
        let (places, place, count) = merge(points, n, dims);
        let mut notes = Vec::new();
        if dims == 0 {
            notes.push("no parameters: every exemplar has the same weight".into());
        } else if count.len() == 1 {
            notes.push("one place only: the weights are constant".into());
        } else if count.len() < n {
            notes.push(format!(
                "{n} points are in {} places: those that coincide share one weight equally",
                count.len()
            ));
        }
        let rule = match *method {
            _ if count.len() == 1 => Rule::Constant,
            Method::Shepard { power } => Rule::Shepard { power },
            Method::Cardinal {
                kernel,
                tail,
                nugget,
            } => {
                let system = System {
                    points: &places,
                    n: count.len(),
                    dims,
                    kernel,
                    tail,
                    nugget,
                };
                Rule::Cardinal(Cardinal::fit(&system, &mut notes)?)
            }
        };
        Ok(Self {
            points: points.to_vec(),
            n,
            dims,
            method: *method,
            places,
            share: place.iter().map(|&g| 1.0 / count[g] as f64).collect(),
            place,
            rule,
            notes,
        })
    }

    /// How many exemplars there are, at least one.
    #[expect(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        self.n
    }

    /// How many parameters there are, 0 or more.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The method it was made with.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// The exemplars' parameters as given, n x dims, row-major.
    pub fn points(&self) -> &[f64] {
        &self.points
    }

    /// What was done about degenerate points, one sentence each: coinciding ones merged, the linear part confined to
    /// what they span, an ill-conditioned system. Empty when all is well.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// True when the weights at each exemplar's parameters are 1 for it and 0 for the others: without a nugget, without
    /// coinciding points, and where the system could be solved to working precision.
    pub fn is_exact(&self) -> bool {
        let single = self.share.iter().all(|s| *s == 1.0);
        single
            && match &self.rule {
                Rule::Constant | Rule::Shepard { .. } => true,
                Rule::Cardinal(c) => c.exact,
            }
    }

    /// The weights of the exemplars at `p`; they sum to one, and may be negative unless the method is Shepard's. A `p`
    /// that is not finite gives weights that are not.
    ///
    /// # Panics
    /// When `p` has not [`Self::dims`] values or `weights` not [`Self::len`].
    pub fn weights(&self, p: &[f64], weights: &mut [f64]) {
        self.check_lengths(p, weights);
        let at_places = &mut weights[..self.place_count()];
        match &self.rule {
            Rule::Constant => at_places.fill(1.0),
            Rule::Shepard { power } => {
                shepard::weights(&self.places, *power, p, at_places);
            }
            Rule::Cardinal(c) => c.weights(&self.places, p, at_places),
        }
        self.spread(weights, 1);
    }

    /// The weights, and their `gradient` d w_i / d p_l (n x dims, row-major). It is analytic; at exemplars it is zero for
    /// Shepard's method and, there only, without the kink of the linear kernel.
    ///
    /// # Panics
    /// When a slice has not the length said.
    pub fn weights_and_gradient(&self, p: &[f64], weights: &mut [f64], gradient: &mut [f64]) {
        self.check_lengths(p, weights);
        assert_eq!(gradient.len(), self.n * self.dims, "n x dims gradient");
        let count = self.place_count();
        let at_places = &mut weights[..count];
        let slopes = &mut gradient[..count * self.dims];
        match &self.rule {
            Rule::Constant => {
                at_places.fill(1.0);
                slopes.fill(0.0);
            }
            Rule::Shepard { power } => {
                shepard::weights_and_gradient(&self.places, *power, p, at_places, slopes);
            }
            Rule::Cardinal(c) => {
                c.weights(&self.places, p, at_places);
                c.gradient(&self.places, p, slopes);
            }
        }
        self.spread(weights, 1);
        self.spread(gradient, self.dims);
    }

    /// With [`super::Tail::None`], the weight at `p` that the kernel gives to no exemplar and that [`Self::weights`] has
    /// divided among all places alike; it grows from 0 at the exemplars to 1 far from them. 0 for all other methods. The
    /// kernel's own weights, k(p)' K^-1, are the weights less this over their number (where no points coincide).
    ///
    /// # Panics
    /// When `p` has not [`Self::dims`] values.
    pub fn deficit(&self, p: &[f64]) -> f64 {
        assert_eq!(p.len(), self.dims, "one value a parameter");
        match &self.rule {
            Rule::Cardinal(c) => c.deficit(&self.places, p),
            Rule::Constant | Rule::Shepard { .. } => 0.0,
        }
    }

    /// The interpolator of all exemplars but `i`, in their order, by the same method.
    ///
    /// # Errors
    /// When there is no exemplar `i`, or no other; or as [`Self::new`] does.
    pub fn left_out(&self, i: usize) -> Result<Self> {
        if i >= self.n || self.n == 1 {
            return Err(Error::invalid(format!(
                "exemplar {i} of {} cannot be left out",
                self.n
            )));
        }
        let mut points = self.points.clone();
        points.drain(i * self.dims..(i + 1) * self.dims);
        Self::new(&points, self.n - 1, self.dims, &self.method)
    }

    /// The point nearest to `p` of the exemplars' convex hull, dilated by [`HULL_MARGIN`] about its centre, which is the
    /// mean of their places. `p` itself where it is inside. Beyond it the linear part grows without anything to show for it.
    ///
    /// # Panics
    /// When `p` has not [`Self::dims`] values.
    pub fn clamped(&self, p: &[f64]) -> Vec<f64> {
        assert_eq!(p.len(), self.dims, "one value a parameter");
        if self.dims == 0 {
            return Vec::new();
        }
        let count = self.place_count() as f64;
        let centre: Vec<f64> = (0..self.dims)
            .map(|l| self.places[l..].iter().step_by(self.dims).sum::<f64>() / count)
            .collect();
        let dilate = |(i, x): (usize, &f64)| {
            let c = centre[i % self.dims];
            c + (1.0 + HULL_MARGIN) * (x - c)
        };
        let dilated: Vec<f64> = self.places.iter().enumerate().map(dilate).collect();
        hull::nearest(&dilated, p)
    }

    fn place_count(&self) -> usize {
        match self.rule {
            Rule::Constant => 1,
            Rule::Shepard { .. } | Rule::Cardinal(_) => self.places.len() / self.dims,
        }
    }

    fn check_lengths(&self, p: &[f64], weights: &[f64]) {
        assert_eq!(p.len(), self.dims, "one value a parameter");
        assert_eq!(weights.len(), self.n, "one weight an exemplar");
    }

    /// From rows at places, which fill the front of `rows`, to rows at points, in place: a place's number is never above
    /// its points', so that going backwards nothing is overwritten before it was read.
    fn spread(&self, rows: &mut [f64], width: usize) {
        if self.place_count() == self.n {
            return;
        }
        for (i, (&from, share)) in self.place.iter().zip(&self.share).enumerate().rev() {
            for l in 0..width {
                rows[i * width + l] = rows[from * width + l] * share;
            }
        }
    }
}

/// The places, the place of each point, and how many points each has.
type Merged = (Vec<f64>, Vec<usize>, Vec<usize>);

/// Puts points that coincide together.
fn merge(points: &[f64], n: usize, dims: usize) -> Merged {
    let row = |i: usize| &points[i * dims..(i + 1) * dims];
    let extent = (0..n).map(|i| distance(row(i), row(0))).fold(0.0, f64::max);
    let same_place = (SAME_PLACE * extent).max(COINCIDENT);
    let mut firsts: Vec<usize> = Vec::new();
    let mut count: Vec<usize> = Vec::new();
    let mut place = Vec::with_capacity(n);
    for i in 0..n {
        let same = |&f: &usize| distance(row(i), row(f)) <= same_place;
        let found = firsts.iter().position(same).unwrap_or(firsts.len());
        if found == firsts.len() {
            firsts.push(i);
            count.push(0);
        }
        count[found] += 1;
        place.push(found);
    }
    let places = firsts.iter().flat_map(|&i| row(i)).copied().collect();
    (places, place, count)
}
