//! [`ParameterSpace`]: what the parameters of a primitive mean, and how they become numbers in [0, 1].

use crate::error::{Error, Result};

/// One parameter, an adverb: its name and the values between which the exemplars lie.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterAxis {
    /// Its name, unique in the space.
    pub name: String,
    /// The value that becomes 0.
    pub low: f64,
    /// The value that becomes 1, above `low`.
    pub high: f64,
}

/// Where the values of parameters come from.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterSource {
    /// A person said them, exemplar by exemplar.
    Adverbs,
    /// Coordinates along the directions in which the registered exemplars vary most.
    Principal {
        /// Mean landmarks of the exemplars at [`super::SHAPE_PHASES`] phases, joined, metres.
        mean: Vec<f64>,
        /// One direction of unit length a parameter, joined.
        directions: Vec<f64>,
    },
    /// Where an effector is at its extreme, metres in the thorax frame: forward, left, up.
    Effector {
        /// The effector's name.
        effector: String,
        /// Which of the three coordinates the parameters are.
        coordinates: Vec<usize>,
    },
}

/// What the parameters of a primitive mean. Inside they lie in [0, 1]^m (the paper's mixing parameters); outside each
/// has a name and values of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSpace {
    axes: Vec<ParameterAxis>,
    source: ParameterSource,
}

impl ParameterSpace {
    /// A space of these axes; none is a primitive that always looks the same.
    ///
    /// # Errors
    /// When names repeat or are empty, a bound is not finite or `high` not above `low`, when principal directions or
    /// effector coordinates are not as many as axes.
    pub fn new(axes: Vec<ParameterAxis>, source: ParameterSource) -> Result<Self> {
        for (i, axis) in axes.iter().enumerate() {
            if axis.name.is_empty() || axes[..i].iter().any(|a| a.name == axis.name) {
                return Err(Error::invalid(format!(
                    "parameters need distinct names, found `{}` twice or empty",
                    axis.name
                )));
            }
            let width = axis.high - axis.low;
            if !(axis.low.is_finite() && axis.high.is_finite() && width > 0.0) {
                return Err(Error::invalid(format!(
                    "parameter `{}` needs a range, found {} to {}",
                    axis.name, axis.low, axis.high
                )));
            }
        }
        let agree = match &source {
            ParameterSource::Adverbs => true,
            ParameterSource::Principal { mean, directions } => {
                directions.len() == axes.len() * mean.len()
                    && mean.iter().chain(directions).all(|v| v.is_finite())
            }
            ParameterSource::Effector { coordinates, .. } => {
                coordinates.len() == axes.len() && coordinates.iter().all(|&c| c < 3)
            }
        };
        if !agree {
            return Err(Error::invalid(format!(
                "the transform of the parameters does not give {} numbers",
                axes.len()
            )));
        }
        Ok(Self { axes, source })
    }

    /// The number of parameters.
    pub fn dims(&self) -> usize {
        self.axes.len()
    }

    /// The parameters in order.
    pub fn axes(&self) -> &[ParameterAxis] {
        &self.axes
    }

    /// Where values come from.
    pub fn source(&self) -> &ParameterSource {
        &self.source
    }

    /// Values in the parameters' own units as places in the unit cube; beyond the exemplars they pass 0 or 1.
    ///
    /// # Errors
    /// When there are not as many as parameters (the message names them), or one is not finite.
    pub fn to_unit(&self, values: &[f64]) -> Result<Vec<f64>> {
        if values.len() != self.dims() {
            let names: Vec<&str> = self.axes.iter().map(|a| a.name.as_str()).collect();
            return Err(Error::invalid(match names.len() {
                0 => format!("no parameters are taken here, found {}", values.len()),
                n => format!(
                    "{n} parameters ({}), found {}",
                    names.join(", "),
                    values.len()
                ),
            }));
        }
        if let Some(v) = values.iter().find(|v| !v.is_finite()) {
            return Err(Error::invalid(format!("parameters are finite, found {v}")));
        }
        let place = |(axis, v): (&ParameterAxis, &f64)| (v - axis.low) / (axis.high - axis.low);
        Ok(self.axes.iter().zip(values).map(place).collect())
    }

    /// Places in the unit cube as values in the parameters' own units.
    pub fn from_unit(&self, places: &[f64]) -> Vec<f64> {
        let value = |(axis, p): (&ParameterAxis, &f64)| axis.low + p * (axis.high - axis.low);
        self.axes.iter().zip(places).map(value).collect()
    }
}
