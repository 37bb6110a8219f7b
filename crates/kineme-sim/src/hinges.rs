//! [`Hinges`]: between the coordinates of a body and the angles of the hinges that a simulation moves.

use kineme::math::rotation::{exp, log_near, right_jacobian};
use kineme::skeleton::JointKind;
use kineme::{Result, Skeleton};
use nalgebra::Vector3;

use crate::triple::Triple;

/// A joint of the body and the hinges that move it.
#[derive(Debug, Clone, PartialEq)]
enum Joint {
    /// A coordinate that is one hinge's angle less an offset.
    Hinge {
        coordinate: usize,
        hinge: usize,
        offset: f64,
    },
    /// Three coordinates from `first`, the rotation vector that three hinges make.
    Ball {
        first: usize,
        hinges: [usize; 3],
        triple: Triple,
    },
}

/// Which hinges move which coordinates of a body; angles, radians, and their rates to and fro.
#[derive(Debug, Clone, PartialEq)]
pub struct Hinges {
    joints: Vec<Joint>,
    count: usize,
}

/// The axes of the hinges of a joint; `None` for one that is no ball.
pub fn triple(body: &Skeleton, joint: usize) -> Option<Triple> {
    let joint = &body.joints()[joint];
    match &joint.kind {
        JointKind::Ball { reference, ranges } => {
            Some(Triple::between(reference, &joint.axes, ranges))
        }
        _ => None,
    }
}

/// The names of a joint's hinges: its own, with `.1`, `.2` and `.3` where it is a ball.
pub fn names(body: &Skeleton, joint: usize) -> Vec<String> {
    let joint = &body.joints()[joint];
    match joint.kind {
        JointKind::Fixed => vec![],
        JointKind::Hinge { .. } => vec![joint.name.clone()],
        JointKind::Ball { .. } => (1..=3).map(|i| format!("{}.{i}", joint.name)).collect(),
    }
}

impl Hinges {
    /// The hinges of a body whose every ball is a [`Triple`]; `index` gives the place of a hinge of [`names`].
    ///
    /// # Errors
    /// When `index` has one.
    pub(crate) fn of(body: &Skeleton, index: impl Fn(&str) -> Result<usize>) -> Result<Self> {
        let mut joints = Vec::new();
        for j in 0..body.joints().len() {
            let at = body.coordinates(j);
            let hinges: Vec<usize> = names(body, j)
                .iter()
                .map(|name| index(name))
                .collect::<Result<_>>()?;
            match (&hinges[..], triple(body, j)) {
                (&[one, two, three], Some(triple)) => joints.push(Joint::Ball {
                    first: at.start,
                    hinges: [one, two, three],
                    triple,
                }),
                (&[hinge], _) => joints.push(Joint::Hinge {
                    coordinate: at.start,
                    hinge,
                    offset: 0.0,
                }),
                _ => {}
            }
        }
        Ok(Self {
            joints,
            count: body.dof(),
        })
    }

    /// One hinge a coordinate: the place of each, and its angle (radians) where the coordinate is zero, among `count`.
    pub(crate) fn single(hinges: &[(usize, f64)], count: usize) -> Self {
        let joint = |(coordinate, &(hinge, offset))| Joint::Hinge {
            coordinate,
            hinge,
            offset,
        };
        Self {
            joints: hinges.iter().enumerate().map(joint).collect(),
            count,
        }
    }

    /// How many hinges there are, those that move no coordinate included.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Writes the angles of the hinges and their rates at a pose (radians) that moves so (radians a second). What
    /// `angles` holds before says from where they go on without a jump; hinges of no coordinate keep what they have.
    ///
    /// # Panics
    /// When a slice is shorter than the coordinates or the hinges.
    pub fn angles(&self, pose: &[f64], velocity: &[f64], angles: &mut [f64], rates: &mut [f64]) {
        for joint in &self.joints {
            match joint {
                Joint::Hinge {
                    coordinate,
                    hinge,
                    offset,
                } => {
                    angles[*hinge] = pose[*coordinate] + offset;
                    rates[*hinge] = velocity[*coordinate];
                }
                Joint::Ball {
                    first,
                    hinges,
                    triple,
                } => {
                    let v = Vector3::from_column_slice(&pose[*first..first + 3]);
                    let moves = Vector3::from_column_slice(&velocity[*first..first + 3]);
                    let turned = triple.angles(&exp(&v), hinges.map(|h| angles[h]));
                    let turning = triple.rates_of(turned, &(right_jacobian(&v) * moves));
                    for (i, &h) in hinges.iter().enumerate() {
                        (angles[h], rates[h]) = (turned[i], turning[i]);
                    }
                }
            }
        }
    }

    /// Writes the pose (radians) and its velocity (radians a second) at these angles of the hinges and their rates.
    /// What `pose` holds before says from where a ball's coordinates go on without a jump.
    ///
    /// # Panics
    /// When a slice is shorter than the coordinates or the hinges.
    pub fn pose(&self, angles: &[f64], rates: &[f64], pose: &mut [f64], velocity: &mut [f64]) {
        for joint in &self.joints {
            match joint {
                Joint::Hinge {
                    coordinate,
                    hinge,
                    offset,
                } => {
                    pose[*coordinate] = angles[*hinge] - offset;
                    velocity[*coordinate] = rates[*hinge];
                }
                Joint::Ball {
                    first,
                    hinges,
                    triple,
                } => {
                    let turned = hinges.map(|h| angles[h]);
                    let before = Vector3::from_column_slice(&pose[*first..first + 3]);
                    let v = log_near(&triple.rotation(turned), &before);
                    let angular = triple.rates(turned) * Vector3::from(hinges.map(|h| rates[h]));
                    // Singular only a full turn away from the reference rotation, where no human joint comes.
                    let moves = right_jacobian(&v)
                        .try_inverse()
                        .map_or(angular, |inverse| inverse * angular);
                    pose[*first..first + 3].copy_from_slice(v.as_slice());
                    velocity[*first..first + 3].copy_from_slice(moves.as_slice());
                }
            }
        }
    }
}
