//! [`Performance`]: what a robot was told to do and what it did.

use std::sync::Arc;

use crate::control::{Effort, Ran};
use crate::error::Result;
use crate::motion::Motion;
use crate::skeleton::{Root, Skeleton};

/// A movement that was noticed in what was watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noticed {
    /// When, seconds.
    pub secs: f64,
    /// Which primitive of the vocabulary that recognises; `None` when the one before was over.
    pub primitive: Option<usize>,
}

/// How far a body was from what it was told, as angles by which joints were turned away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// Root mean square over the joints that move at all, and over ticks, radians.
    pub rms_rad: f64,
    /// The greatest, radians.
    pub max_rad: f64,
}

/// What came of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Performance {
    /// What the robot was told, in its own joints.
    pub commanded: Motion,
    /// What it did.
    pub done: Motion,
    /// How far one was from the other.
    pub tracking: Tracking,
    /// What the motors had to give.
    pub effort: Effort,
    /// Which behaviours ran, from when to when.
    pub ran: Vec<Ran>,
    /// What was noticed, where something was watched.
    pub noticed: Vec<Noticed>,
}

/// Ticks as they come.
#[derive(Debug, Clone)]
pub(super) struct Record {
    body: Arc<Skeleton>,
    rate_hz: f64,
    commanded: Vec<f64>,
    done: Vec<f64>,
    roots: Vec<Root>,
    squares: f64,
    angles: usize,
    max_rad: f64,
    pub noticed: Vec<Noticed>,
}

impl Record {
    pub fn new(body: Arc<Skeleton>, rate_hz: f64) -> Self {
        Self {
            body,
            rate_hz,
            commanded: Vec::new(),
            done: Vec::new(),
            roots: Vec::new(),
            squares: 0.0,
            angles: 0,
            max_rad: 0.0,
            noticed: Vec::new(),
        }
    }

    /// What was told and what was done by the end of a tick.
    pub fn tick(&mut self, commanded: &[f64], done: &[f64], root: Root) {
        for joint in 0..self.body.joints().len() {
            let at = self.body.coordinates(joint);
            if at.is_empty() {
                continue;
            }
            let told = self.body.rotation(joint, &commanded[at.clone()]);
            let angle = told.angle_to(&self.body.rotation(joint, &done[at]));
            self.squares += angle * angle;
            self.angles += 1;
            self.max_rad = self.max_rad.max(angle);
        }
        self.commanded.extend_from_slice(commanded);
        self.done.extend_from_slice(done);
        self.roots.push(root);
    }

    /// All of it.
    pub fn performance(self, name: &str, ran: Vec<Ran>, effort: Effort) -> Result<Performance> {
        let motion = |name: &str, poses| {
            Motion::new(
                name,
                Arc::clone(&self.body),
                self.rate_hz,
                poses,
                self.roots.clone(),
            )
        };
        Ok(Performance {
            commanded: motion(&format!("{name}, commanded"), self.commanded)?,
            done: motion(name, self.done)?,
            tracking: Tracking {
                rms_rad: (self.squares / self.angles.max(1) as f64).sqrt(),
                max_rad: self.max_rad,
            },
            effort,
            ran,
            noticed: self.noticed,
        })
    }
}
