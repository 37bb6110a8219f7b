//! Kineme: motor primitives from motion capture.
//!
//! A *primitive* is a class of movements that are alike in structure and differ in style; a *vocabulary* is a set of
//! primitives of one body. This crate derives vocabularies from motion automatically, after Drumwright, Jenkins and
//! Matarić, "Exemplar-Based Primitives for Humanoid Movement Classification and Control" (ICRA 2004): recordings are
//! cut into segments, segments are compared by time warping and embedded by spatio-temporal Isomap, and groups of
//! like segments become primitives.
//!
//! The crate computes and does nothing else: it opens no file, reads no clock and draws no unseeded random number, so
//! the same input gives the same bytes on one thread or many. Files are the matter of `kineme-formats`.
//!
//! # First program
//!
//! A person raises the right arm, then the left, six times over. Nobody says so; the derivation finds it out.
//!
//! ```
//! use std::collections::BTreeMap;
//! use std::sync::Arc;
//!
//! use kineme::choreography::{Key, perform};
//! use kineme::derivation::{Cut, Derivation};
//! use kineme::segmentation::Segmenter;
//! use kineme::{Modelling, Role, adonis};
//!
//! # fn main() -> kineme::Result<()> {
//! // Key postures in degrees: the arms in turn, each time to another height, with rests between.
//! let arms = [Role::RightUpperArm, Role::LeftUpperArm];
//! let mut keys = vec![Key { time: 0.0, angles: BTreeMap::new() }];
//! for k in 0..12 {
//!     let start = 0.6 + 2.4 * k as f64;
//!     let height = 70.0 + 3.0 * (k % 5) as f64;
//!     for (after, flexion) in [(0.0, 0.0), (0.4, height / 2.0), (0.8, height), (1.2, height / 2.0), (1.6, 0.0), (1.9, 0.0)] {
//!         let angles = BTreeMap::from([(arms[k % 2], vec![flexion])]);
//!         keys.push(Key { time: start + after, angles });
//!     }
//! }
//! let body = Arc::new(adonis()?);
//! let session = vec![perform("session", &keys, &body, 60.0)?];
//!
//! // Cut it where limbs come to the end of a swing, and group what is alike.
//! let cut = Cut::Segmenter { segmenter: Segmenter::default(), target_secs: None };
//! let derived = Derivation::new(cut).run(&session, &mut |_stage| {})?;
//! assert_eq!(derived.groups.len(), 4); // either arm, up and down
//!
//! // Groups become primitives; those that alternate become a behavior.
//! let vocabulary = derived.vocabulary(&session, &Modelling::default(), &|_| None)?;
//! for primitive in vocabulary.primitives() {
//!     let first = &primitive.exemplars()[0].provenance;
//!     println!("{}: {} exemplars, as at {:.1} s", primitive.name(), primitive.exemplars().len(), first.start_secs);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # A primitive, asked and followed
//!
//! Four reaches of one hand, to two heights and two sides, are a primitive of two parameters. Between them it makes
//! reaches that nobody wrote, brings the hand to a point, and goes on from any posture.
//!
//! ```
//! # use std::collections::BTreeMap;
//! # use std::sync::Arc;
//! use kineme::choreography::{Key, Script, ScriptExemplar};
//! use kineme::primitive::{FlowSettings, Flowfield};
//! use kineme::{Modelling, Role, Synthesis, adonis};
//!
//! # fn main() -> kineme::Result<()> {
//! let key = |time: f64, arm: [f64; 3], elbow: f64| Key {
//!     time,
//!     angles: BTreeMap::from([(Role::RightUpperArm, arm.to_vec()), (Role::RightLowerArm, vec![elbow])]),
//! };
//! let reach = |height: f64, side: f64| ScriptExemplar {
//!     primitive: "reach".into(),
//!     parameters: BTreeMap::from([("height".into(), height), ("side".into(), side)]),
//!     keys: vec![
//!         key(0.0, [10.0, 5.0, 0.0], 90.0),
//!         key(0.5, [40.0 + 60.0 * height, 5.0 + 40.0 * side, 0.0], 15.0),
//!         key(1.0, [10.0, 5.0, 0.0], 90.0),
//!     ],
//! };
//! let script = Script {
//!     body: "adonis".into(),
//!     exemplars: vec![reach(0.0, 0.0), reach(0.0, 1.0), reach(1.0, 0.0), reach(1.0, 1.0)],
//!     animations: vec![],
//! };
//! let body = Arc::new(adonis()?);
//! let vocabulary = script.vocabulary(&body, &Modelling::default(), ("reaches", None))?;
//! let primitive = vocabulary.primitive("reach")?;
//!
//! let course = Arc::new(primitive.at(&[0.3, 0.6])?); // f(p, .)
//! let halfway: Vec<f64> = course.pose(0.5); // f(p, 0.5), one number a coordinate
//! assert_eq!(halfway.len(), body.dof());
//!
//! let aim = primitive.aim("right_hand")?;
//! let target = aim.position(&[0.7, 0.2], aim.extreme(&[0.7, 0.2])?)?;
//! assert!(aim.at(&target).miss_m < 1e-3);
//!
//! let field = Flowfield::of(primitive, &FlowSettings::default())?;
//! let ahead = field.predict(&field.enter(&course.pose(0.2))?, 0.3, 60.0)?;
//! assert_eq!(ahead.len(), 18);
//!
//! let made = Synthesis::default().motion("a reach", &course)?; // the fold of a robot's steps
//! assert!((made.motion.duration_secs() - course.duration_secs()).abs() < 0.01);
//! # Ok(())
//! # }
//! ```
//!
//! # From recordings
//!
//! A file becomes a [`Recording`]: its own skeleton, in metres with z up, gaps included. [`retargeting::retarget`]
//! expresses it in the joints of a body, [`ares`] or [`adonis`], which gives a [`Motion`]: one rate, one pose a frame,
//! complete and finite. A [`derivation::Derivation`] takes motions of one body and gives a [`derivation::Derived`],
//! every step of it kept for whoever wants to look; [`derivation::Derived::vocabulary`] makes the [`Vocabulary`].
//!
//! Every default can be changed by a field of a plain struct: how recordings are cut ([`derivation::Cut`]), what
//! segments are compared by ([`derivation::Features`]), the neighbourhood, the smallest group, the clustering.
//!
//! # The rooms
//!
//! A module imports from modules below it and from none beside it:
//! [`math`], [`error`]; [`skeleton`], [`motion`]; [`segmentation`], [`alignment`], [`embedding`], [`clustering`],
//! [`interpolation`], [`retargeting`]; [`primitive`]; [`derivation`], [`choreography`]; [`control`], [`perception`], [`evaluation`].

pub mod alignment;
pub mod choreography;
pub mod clustering;
pub mod control;
pub mod derivation;
pub mod embedding;
pub mod error;
pub mod evaluation;
pub mod interaction;
pub mod interpolation;
pub mod math;
pub mod motion;
pub mod perception;
pub mod primitive;
pub mod retargeting;
pub mod segmentation;
pub mod skeleton;

pub use control::{Synthesis, Synthesizer};
pub use error::{Error, Result};
pub use motion::{Format, Motion, Observed, Placement, RecordedJoint, Recording, Source, Track};
pub use primitive::{
    Behavior, Course, Exemplar, Modelling, Primitive, Provenance, Transitions, Vocabulary,
};
pub use skeleton::{Role, Root, Skeleton, adonis, ares, body};
