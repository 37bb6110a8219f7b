//! [`Script`]: choreography as people write it, key postures at times, before any body is asked.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::{Error, Result};
use crate::skeleton::Role;

/// A choreography: exemplars of primitives and motions that are no primitive, for one body.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// The body that the angles are meant for: `ares`, `adonis`, or a file's name.
    pub body: String,
    /// Exemplars of primitives, in the order written.
    pub exemplars: Vec<ScriptExemplar>,
    /// Motions that are no primitive, in the order written.
    pub animations: Vec<ScriptAnimation>,
}

/// One exemplar of a primitive.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptExemplar {
    /// The primitive's name.
    pub primitive: String,
    /// Where the exemplar lies in the primitive's parameter space; may be empty.
    pub parameters: BTreeMap<String, f64>,
    /// At least two key postures, in order of time.
    pub keys: Vec<Key>,
}

/// A motion that is no primitive: a negative for recognition.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptAnimation {
    /// Its name, unique in the script.
    pub name: String,
    /// At least two key postures, in order of time.
    pub keys: Vec<Key>,
}

/// A key posture: what it does not name keeps its last value, first the neutral one.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Seconds from the start of the motion, not negative.
    pub time: f64,
    /// Degrees by role: `[flexion, abduction, axial rotation]` of a ball joint, `[flexion]` of a hinge.
    pub angles: BTreeMap<Role, Vec<f64>>,
}

impl Script {
    /// Checks every part, and that the parts agree.
    ///
    /// # Errors
    /// When the body has no name, when there is neither exemplar nor animation, when a part breaks its
    /// own rules, when exemplars of one primitive name different parameters, when two animations share a name.
    pub fn validate(&self) -> Result<()> {
        named("the body", &self.body)?;
        if self.exemplars.is_empty() && self.animations.is_empty() {
            return Err(Error::invalid(
                "a script needs at least one exemplar or animation",
            ));
        }
        let mut first_of: BTreeMap<&str, &ScriptExemplar> = BTreeMap::new();
        for exemplar in &self.exemplars {
            exemplar.validate()?;
            let first = first_of.entry(&exemplar.primitive).or_insert(exemplar);
            exemplar.agrees_with(first)?;
        }
        let mut names = BTreeSet::new();
        for animation in &self.animations {
            animation.validate()?;
            if !names.insert(animation.name.as_str()) {
                return Err(Error::invalid(format!(
                    "two animations are named `{}`",
                    animation.name
                )));
            }
        }
        Ok(())
    }
}

impl ScriptExemplar {
    /// Checks the exemplar by itself.
    ///
    /// # Errors
    /// When the primitive or a parameter has no name, when a parameter is not finite, when the keys are invalid.
    pub fn validate(&self) -> Result<()> {
        named("the primitive", &self.primitive)?;
        for (name, value) in &self.parameters {
            named("a parameter", name)?;
            if !value.is_finite() {
                return Err(Error::invalid(format!(
                    "parameter `{name}` of `{}` is {value}; parameters are finite",
                    self.primitive
                )));
            }
        }
        validate_keys(&self.primitive, &self.keys)
    }

    /// Checks that another exemplar of the same primitive lies in the same parameter space.
    ///
    /// # Errors
    /// When the names of the parameters differ.
    pub fn agrees_with(&self, other: &ScriptExemplar) -> Result<()> {
        if self.parameters.keys().eq(other.parameters.keys()) {
            return Ok(());
        }
        let names = |e: &ScriptExemplar| {
            let names: Vec<&str> = e.parameters.keys().map(String::as_str).collect();
            names.join(", ")
        };
        Err(Error::invalid(format!(
            "exemplars of `{}` have different parameters: [{}] and [{}]",
            self.primitive,
            names(other),
            names(self)
        )))
    }
}

impl ScriptAnimation {
    /// Checks the animation by itself.
    ///
    /// # Errors
    /// When it has no name or its keys are invalid.
    pub fn validate(&self) -> Result<()> {
        named("an animation", &self.name)?;
        validate_keys(&self.name, &self.keys)
    }
}

/// No key is later than an hour: what is written by hand is a movement.
const LATEST_SECS: f64 = 3600.0;

impl Key {
    /// Checks the key by itself and against the one before it.
    ///
    /// # Errors
    /// When the time is negative, later than an hour, not finite or not after `previous`, when a role has neither one nor three
    /// angles, when an angle is not finite.
    pub fn validate(&self, previous: Option<&Key>) -> Result<()> {
        if !(self.time.is_finite() && self.time >= 0.0) {
            return Err(Error::invalid(format!(
                "a key's time is {} s; times are finite and not negative",
                self.time
            )));
        }
        if self.time > LATEST_SECS {
            return Err(Error::invalid(format!(
                "a key's time is {} s; a movement ends within {LATEST_SECS} s",
                self.time
            )));
        }
        if let Some(previous) = previous
            && self.time <= previous.time
        {
            return Err(Error::invalid(format!(
                "a key at {} s follows one at {} s; times rise",
                self.time, previous.time
            )));
        }
        for (role, angles) in &self.angles {
            if !matches!(angles.len(), 1 | 3) {
                return Err(Error::invalid(format!(
                    "`{}` has {} angles; a hinge has one, a ball joint three",
                    role.name(),
                    angles.len()
                )));
            }
            if let Some(angle) = angles.iter().find(|a| !a.is_finite()) {
                return Err(Error::invalid(format!(
                    "an angle of `{}` is {angle}; angles are finite",
                    role.name()
                )));
            }
        }
        Ok(())
    }
}

fn named(what: &str, name: &str) -> Result<()> {
    if name.trim().is_empty() {
        return Err(Error::invalid(format!("{what} has no name")));
    }
    Ok(())
}

fn validate_keys(owner: &str, keys: &[Key]) -> Result<()> {
    if keys.len() < 2 {
        return Err(Error::invalid(format!(
            "`{owner}` has {} keys; a motion needs at least two",
            keys.len()
        )));
    }
    for (i, key) in keys.iter().enumerate() {
        let previous = i.checked_sub(1).map(|p| &keys[p]);
        key.validate(previous)
            .map_err(|e| Error::invalid(format!("`{owner}`, key {}: {e}", i + 1)))?;
    }
    Ok(())
}
