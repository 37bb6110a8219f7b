//! Floor 2: weights over exemplars from the parameters that are asked for.
//!
//! An [`Interpolator`] knows the parameter vectors of n exemplars and answers a query p with n weights that sum to one,
//! by the [`Method`] chosen: Shepard's inverse distances, or Verbs and Adverbs in its cardinal form, which with a
//! nugget is kriging. It knows no poses: whatever the exemplars are, they are blended with the same weights.

mod cardinal;
mod hull;
mod interpolator;
mod kernel;
mod method;
mod shepard;
mod trend;

pub use hull::HULL_MARGIN;
pub use interpolator::Interpolator;
pub use kernel::{Kernel, wendland_support};
pub use method::{Method, Tail};
