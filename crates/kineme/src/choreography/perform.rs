//! From key postures to motion: splines through what the keys say.

use std::sync::Arc;

use super::script::Key;
use crate::error::{Error, Result};
use crate::math::spline::ClampedSpline;
use crate::motion::Motion;
use crate::skeleton::{Role, Root, Skeleton};

/// Frames that keys may make: hours at the rate of any camera.
const MOST_FRAMES: f64 = 1e6;

/// One angle that the keys move: a role and the place in its list of degrees.
struct Channel {
    role: Role,
    place: usize,
    spline: ClampedSpline,
}

/// The motion that `keys` describe on `body`: every angle follows a spline through the keys, twice continuously
/// differentiable and at rest at both ends; what a key does not name keeps its last value, first the neutral one.
///
/// # Errors
/// Without keys, when times do not rise, when the body lacks a role that a key names, when the rate is not positive, or
/// would make more than a million frames.
pub fn perform(name: &str, keys: &[Key], body: &Arc<Skeleton>, rate_hz: f64) -> Result<Motion> {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else {
        return Err(Error::invalid(format!("`{name}` has no keys")));
    };
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Error::invalid(format!(
            "a rate must be positive, found {rate_hz} Hz"
        )));
    }
    let channels = channels(name, keys)?;
    let count = ((last.time - first.time) * rate_hz + 1e-9).floor() + 1.0;
    if count > MOST_FRAMES {
        return Err(Error::invalid(format!(
            "`{name}`: {:.0} s at {rate_hz} Hz would be {count:.0} frames, more than {MOST_FRAMES:.0}",
            last.time - first.time
        )));
    }
    let count = count as usize;
    let neutral = body.neutral();
    let mut poses = Vec::with_capacity(count * body.dof());
    for f in 0..count {
        let time = first.time + f as f64 / rate_hz;
        let mut pose = neutral.clone();
        for role in roles(&channels) {
            let degrees: Vec<f64> = channels
                .iter()
                .filter(|c| c.role == role)
                .map(|c| c.spline.at(time))
                .collect();
            body.set_clinical(&mut pose, role, &degrees)?;
        }
        poses.extend(pose);
    }
    Motion::new(
        name,
        Arc::clone(body),
        rate_hz,
        poses,
        vec![Root::ORIGIN; count],
    )
}

/// The roles that channels move, in order.
fn roles(channels: &[Channel]) -> Vec<Role> {
    let mut roles: Vec<Role> = channels.iter().map(|c| c.role).collect();
    roles.dedup();
    roles
}

/// One spline for each angle that any key names, ordered by role.
fn channels(name: &str, keys: &[Key]) -> Result<Vec<Channel>> {
    let times: Vec<f64> = keys.iter().map(|k| k.time).collect();
    let mut channels = Vec::new();
    for &role in Role::ALL {
        let places = keys
            .iter()
            .filter_map(|k| k.angles.get(&role))
            .map(Vec::len)
            .max();
        for place in 0..places.unwrap_or(0) {
            let mut value = 0.0;
            let values: Vec<f64> = keys
                .iter()
                .map(|k| {
                    value = k
                        .angles
                        .get(&role)
                        .map_or(value, |a| a.get(place).copied().unwrap_or(0.0));
                    value
                })
                .collect();
            let spline = ClampedSpline::new(&times, &values)
                .map_err(|e| Error::invalid(format!("`{name}`, {}: {e}", role.name())))?;
            channels.push(Channel {
                role,
                place,
                spline,
            });
        }
    }
    channels.sort_by_key(|c| (c.role, c.place));
    Ok(channels)
}
