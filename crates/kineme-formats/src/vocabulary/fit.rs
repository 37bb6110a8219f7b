//! What was fitted to the exemplars of a primitive, as the document says it, and the library's words for the same.

use kineme::alignment::Warp;
use kineme::interpolation::{Kernel, Method, Tail};
use kineme::primitive::{
    Fit, LeaveOneOut, ParameterAxis, ParameterSource, ParameterSpace, Trial, Used,
};
use serde::{Deserialize, Serialize};

use super::{FitTensors, PrincipalTensors};

/// What was fitted to the exemplars of a primitive, but for rows of numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitMeta {
    /// Whether the end joins the beginning: phase wraps.
    pub cyclic: bool,
    /// Knots of the curves over phase.
    pub knots: u64,
    /// The parameters in order; none for a movement that always looks the same.
    pub parameters: Vec<ParameterMeta>,
    /// Where the parameters' values come from.
    pub source: SourceMeta,
    /// How exemplars are weighted.
    pub method: MethodMeta,
    /// The interpolators that were tried, the chosen one first.
    pub trials: Vec<TrialMeta>,
    /// Leave-one-out error of the chosen one; `None` with a single exemplar.
    pub error: Option<ErrorMeta>,
    /// What was noted for people.
    pub notes: Vec<String>,
}

/// A parameter: what 0 and 1 stand for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterMeta {
    /// Its name.
    pub name: String,
    /// The value that is 0 in the unit cube.
    pub low: f64,
    /// The value that is 1, above `low`.
    pub high: f64,
}

/// Where the parameters' values come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum SourceMeta {
    /// A person said them.
    Adverbs,
    /// Principal coordinates of the registered exemplars: two more tensors.
    Principal,
    /// Where an effector is at its extreme, metres in the thorax frame.
    Effector {
        /// Its name.
        name: String,
        /// For each parameter which coordinate it is: 0 forward, 1 left, 2 up.
        coordinates: Vec<usize>,
    },
}

/// How exemplars are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum MethodMeta {
    /// Inverse distances.
    Shepard {
        /// The exponent.
        power: f64,
    },
    /// Verbs and Adverbs.
    Cardinal {
        /// The radial part.
        kernel: KernelMeta,
        /// The polynomial part.
        tail: TailMeta,
        /// What is added to the kernel's diagonal.
        nugget: f64,
    },
}

/// A radial basis function.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum KernelMeta {
    /// Wendland's C2 function.
    Wendland {
        /// Where it vanishes.
        support: f64,
    },
    /// `-r`.
    Linear,
    /// `r^3`.
    Cubic,
    /// `r^2 ln r`.
    ThinPlate,
}

/// The polynomial part of Verbs and Adverbs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TailMeta {
    /// None.
    None,
    /// Least squares first.
    LeastSquares,
    /// Solved together with the radial part.
    Augmented,
}

/// An interpolator that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialMeta {
    /// The interpolator.
    pub method: MethodMeta,
    /// How many parameters it had.
    pub parameters: u64,
    /// Its leave-one-out error, metres.
    pub error_m: f64,
}

/// Leave-one-out errors: each exemplar predicted from the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorMeta {
    /// Of joint rotations, radians.
    pub joint_rad: f64,
    /// Of the wrists, metres.
    pub wrist_m: f64,
    /// Of landmarks by the nearest exemplar, metres.
    pub nearest_m: f64,
    /// Of landmarks by the others' mean, metres.
    pub mean_m: f64,
}

impl From<&Fit> for FitMeta {
    fn from(fit: &Fit) -> Self {
        let axes = fit.space.axes().iter();
        Self {
            cyclic: fit.cyclic,
            knots: fit.knots as u64,
            parameters: axes
                .map(|axis| ParameterMeta {
                    name: axis.name.clone(),
                    low: axis.low,
                    high: axis.high,
                })
                .collect(),
            source: match fit.space.source() {
                ParameterSource::Adverbs => SourceMeta::Adverbs,
                ParameterSource::Principal { .. } => SourceMeta::Principal,
                ParameterSource::Effector {
                    effector,
                    coordinates,
                } => SourceMeta::Effector {
                    name: effector.clone(),
                    coordinates: coordinates.clone(),
                },
            },
            method: fit.method.into(),
            trials: fit
                .trials
                .iter()
                .map(|t| TrialMeta {
                    method: t.method.into(),
                    parameters: t.dims as u64,
                    error_m: t.error_m,
                })
                .collect(),
            error: fit.error.map(|e| ErrorMeta {
                joint_rad: e.joint_rad,
                wrist_m: e.wrist_m,
                nearest_m: e.nearest_m,
                mean_m: e.mean_m,
            }),
            notes: fit.notes.clone(),
        }
    }
}

impl FitTensors {
    /// The rows of numbers of a fit, but for those of single exemplars.
    pub(super) fn of(fit: &Fit) -> Self {
        Self {
            points: fit.points.clone(),
            reference: fit.reference.clone(),
            principal: match fit.space.source() {
                ParameterSource::Principal { mean, directions } => Some(PrincipalTensors {
                    mean: mean.clone(),
                    directions: directions.clone(),
                }),
                ParameterSource::Adverbs | ParameterSource::Effector { .. } => None,
            },
        }
    }
}

impl FitMeta {
    /// The fit with its rows of numbers, and the parts used and warps of its exemplars.
    ///
    /// # Errors
    /// When a warp or the parameter space is none.
    pub(super) fn with(
        self,
        tensors: FitTensors,
        used: Vec<Used>,
        warps: Vec<Vec<f64>>,
    ) -> kineme::Result<Fit> {
        let warp = if self.cyclic { Warp::closed } else { Warp::new };
        let axes = self.parameters.into_iter().map(|p| ParameterAxis {
            name: p.name,
            low: p.low,
            high: p.high,
        });
        let source = match self.source {
            SourceMeta::Adverbs => ParameterSource::Adverbs,
            SourceMeta::Principal => {
                let (mean, directions) = tensors
                    .principal
                    .map_or_else(Default::default, |p| (p.mean, p.directions));
                ParameterSource::Principal { mean, directions }
            }
            SourceMeta::Effector { name, coordinates } => ParameterSource::Effector {
                effector: name,
                coordinates,
            },
        };
        Ok(Fit {
            cyclic: self.cyclic,
            used,
            warps: warps.into_iter().map(warp).collect::<kineme::Result<_>>()?,
            reference: tensors.reference,
            // A number that does not fit is refused for being too many.
            knots: usize::try_from(self.knots).unwrap_or(usize::MAX),
            space: ParameterSpace::new(axes.collect(), source)?,
            points: tensors.points,
            method: self.method.into(),
            trials: self.trials.into_iter().map(TrialMeta::into).collect(),
            error: self.error.map(|e| LeaveOneOut {
                joint_rad: e.joint_rad,
                wrist_m: e.wrist_m,
                nearest_m: e.nearest_m,
                mean_m: e.mean_m,
            }),
            notes: self.notes,
        })
    }
}

impl From<TrialMeta> for Trial {
    fn from(trial: TrialMeta) -> Self {
        Self {
            method: trial.method.into(),
            dims: trial.parameters as usize,
            error_m: trial.error_m,
        }
    }
}

impl From<Method> for MethodMeta {
    fn from(method: Method) -> Self {
        match method {
            Method::Shepard { power } => Self::Shepard { power },
            Method::Cardinal {
                kernel,
                tail,
                nugget,
            } => Self::Cardinal {
                kernel: match kernel {
                    Kernel::Wendland { support } => KernelMeta::Wendland { support },
                    Kernel::Linear => KernelMeta::Linear,
                    Kernel::Cubic => KernelMeta::Cubic,
                    Kernel::ThinPlate => KernelMeta::ThinPlate,
                },
                tail: match tail {
                    Tail::None => TailMeta::None,
                    Tail::LeastSquares => TailMeta::LeastSquares,
                    Tail::Augmented => TailMeta::Augmented,
                },
                nugget,
            },
        }
    }
}

impl From<MethodMeta> for Method {
    fn from(method: MethodMeta) -> Self {
        match method {
            MethodMeta::Shepard { power } => Self::Shepard { power },
            MethodMeta::Cardinal {
                kernel,
                tail,
                nugget,
            } => Self::Cardinal {
                kernel: match kernel {
                    KernelMeta::Wendland { support } => Kernel::Wendland { support },
                    KernelMeta::Linear => Kernel::Linear,
                    KernelMeta::Cubic => Kernel::Cubic,
                    KernelMeta::ThinPlate => Kernel::ThinPlate,
                },
                tail: match tail {
                    TailMeta::None => Tail::None,
                    TailMeta::LeastSquares => Tail::LeastSquares,
                    TailMeta::Augmented => Tail::Augmented,
                },
                nugget,
            },
        }
    }
}

impl MethodMeta {
    /// Its settings.
    pub(super) fn numbers(&self) -> [f64; 2] {
        match *self {
            Self::Shepard { power } => [power, 0.0],
            Self::Cardinal { kernel, nugget, .. } => match kernel {
                KernelMeta::Wendland { support } => [support, nugget],
                KernelMeta::Linear | KernelMeta::Cubic | KernelMeta::ThinPlate => [0.0, nugget],
            },
        }
    }
}
