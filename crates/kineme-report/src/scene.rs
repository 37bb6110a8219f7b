//! What a page can show in three dimensions, as plain data: metres, seconds, z up.
//!
//! A body is points and the round cones between them; whoever makes the scene says where the points are, frame by frame.
//! So nothing that draws needs to know of joints or angles, and bare positions are shown as what they are.

use serde::{Deserialize, Serialize};

pub use crate::packed::{Floats, Places, Shares};

/// All that moves on a page.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Scene {
    /// The bodies that actors and primitives refer to by index.
    pub bodies: Vec<Body>,
    /// What is played on the stage, one at a time.
    pub takes: Vec<Take>,
    /// A card for each primitive.
    pub primitives: Vec<Card>,
    /// The file of the primitives, as a command line names it, where they may be renamed, merged and removed; else empty.
    pub vocabulary: String,
}

impl Scene {
    /// Whether there is nothing to see.
    pub fn is_empty(&self) -> bool {
        self.takes.is_empty() && self.primitives.is_empty()
    }
}

/// The shape of a body.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// How many points it has.
    pub points: usize,
    /// The point that a camera follows.
    pub centre: usize,
    /// The point that each point hangs on: it turns about it and keeps its distance between two frames. `None` for one
    /// that goes its own way.
    pub parents: Vec<Option<usize>>,
    /// What is drawn between the points.
    pub bones: Vec<Bone>,
    /// Points whose path is worth a line: the hands.
    pub tips: Vec<usize>,
}

/// A round cone: all spheres between one at each end.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Bone {
    /// The points at its ends.
    pub ends: [usize; 2],
    /// The radii there, metres.
    pub radii: [f64; 2],
}

/// Something that happened: bodies that move at the same time, and what is known of that time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Take {
    /// Its name.
    pub name: String,
    /// What to know of it, such as that frames were left out; may be empty.
    pub note: String,
    /// How long it lasts, seconds.
    pub secs: f64,
    /// Who moves.
    pub actors: Vec<Actor>,
    /// What is drawn over its time, top to bottom.
    pub tracks: Vec<Track>,
}

/// A body that moves.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Actor {
    /// What it is: `observed`, `encoded`.
    pub name: String,
    /// Its body, an index into the scene's.
    pub body: usize,
    /// Its colour, as a group's; `None` is the neutral one.
    pub colour: Option<usize>,
    /// Whether it is seen through.
    pub ghost: bool,
    /// The track of the take, one of spans, whose colour of the moment it wears.
    pub wears: Option<usize>,
    /// Frames a second.
    pub rate_hz: f64,
    /// When its first frame is, seconds.
    pub start_secs: f64,
    /// Where it stands when actors stand side by side, metres from where it was.
    pub aside: [f64; 3],
    /// Its points, a row a frame.
    pub frames: Places,
}

/// A strip over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Track {
    /// Shares that add up to one at each moment, such as a posterior: stacked bands.
    Bands {
        /// What they are shares of.
        title: String,
        /// The classes, bottom to top.
        classes: Vec<Class>,
        /// Moments a second.
        rate_hz: f64,
        /// When the first moment is, seconds.
        start_secs: f64,
        /// Moment-major: a share for each class.
        shares: Shares,
    },
    /// Things that last for a while; those at the same time are drawn below one another.
    Spans {
        /// What they are.
        title: String,
        /// The spans, in any order.
        spans: Vec<Stretch>,
    },
    /// A quantity.
    Line {
        /// What it is, with its unit.
        title: String,
        /// Values a second.
        rate_hz: f64,
        /// When the first value is, seconds.
        start_secs: f64,
        /// The values.
        values: Floats,
    },
}

/// A class of a posterior.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Class {
    /// Its name.
    pub name: String,
    /// Its colour, as a group's; `None` is the neutral one.
    pub colour: Option<usize>,
}

/// Something that lasts for a while.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Stretch {
    /// When it begins, seconds.
    pub start: f64,
    /// When it ends, seconds.
    pub end: f64,
    /// What it is.
    pub name: String,
    /// Its colour, as a group's; `None` is the neutral one.
    pub colour: Option<usize>,
    /// More to say of it; may be empty.
    pub detail: String,
}

/// A primitive: its exemplars, and f(p, phase) sampled on a grid of parameters.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Card {
    /// Its name.
    pub name: String,
    /// What is known of it, name and value.
    pub facts: Vec<[String; 2]>,
    /// Why it may be a group that nobody meant; empty where there is no doubt.
    pub doubt: String,
    /// Its colour, as a group's.
    pub colour: usize,
    /// Its body, an index into the scene's.
    pub body: usize,
    /// Whether its end joins its beginning.
    pub cyclic: bool,
    /// Its parameters, slowest first in the grid. Parameters beyond these stay in the middle.
    pub axes: Vec<Axis>,
    /// Phases at which it is sampled, from 0 to 1.
    pub phases: usize,
    /// Its points: a row a phase, phases of a node of the grid together.
    pub lattice: Places,
    /// Seconds from phase 0, as many as rows.
    pub clock: Floats,
    /// Its exemplars, or some of them.
    pub exemplars: Vec<CardExemplar>,
    /// Their points: a row a phase, phases of an exemplar together.
    pub paths: Places,
    /// Exemplars that are not among these.
    pub more: usize,
    /// Its flowfield, where there is one to show.
    pub flow: Option<Flow>,
    /// Where all its exemplars come from; told by the page, not by what draws.
    #[serde(skip)]
    pub sources: Vec<Excerpt>,
}

/// A stretch of a motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Excerpt {
    /// The motion's name.
    pub motion: String,
    /// From when, seconds.
    pub start: f64,
    /// Until when, seconds.
    pub end: f64,
    /// The take that shows it, an index into the scene's; `None` where none does.
    pub take: Option<usize>,
}

/// A parameter of a primitive.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Axis {
    /// Its name.
    pub name: String,
    /// Its unit; may be empty.
    pub unit: String,
    /// The value at the grid's first node.
    pub low: f64,
    /// The value at the grid's last node.
    pub high: f64,
    /// The nodes of the grid along it, two or more.
    pub nodes: usize,
    /// Where to begin.
    pub start: f64,
}

/// An exemplar of a primitive.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CardExemplar {
    /// Where it comes from.
    pub name: String,
    /// How long it takes, seconds.
    pub secs: f64,
    /// Its parameters, in the axes' own units.
    pub parameters: Vec<f64>,
}

/// The flowfield of a primitive in three principal coordinates of posture.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Flow {
    /// The share of the postures' variance along each coordinate.
    pub explained: [f64; 3],
    /// The coordinates of the lattice's rows.
    pub lattice: Floats,
    /// The coordinates of the exemplars' rows.
    pub exemplars: Floats,
}
