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
//! [`interpolation`], [`retargeting`]; [`primitive`]; [`derivation`], [`choreography`]; [`control`].

pub mod alignment;
pub mod choreography;
pub mod clustering;
pub mod control;
pub mod derivation;
pub mod embedding;
pub mod error;
pub mod interpolation;
pub mod math;
pub mod motion;
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
