//! Which part of a recording is the movement, whose it is, and which set of primitives says it at the lowest cost.

use kineme::motion::Motion;
use kineme::perception::encoding::{
    EffectorPaths, Encoder, EncodingMethod, EncodingSettings, Extent,
};
use kineme::primitive::Posterior;
use kineme::skeleton::Skeleton;
use nalgebra::Vector3;

use super::SETS;
use super::answers::Costs;
use crate::sets::Result;

/// The hand of the primitives.
const HAND: &str = "right_hand";
/// Both, in the order of the encoder's defaults.
const HANDS: [&str; 2] = ["left_hand", HAND];

/// A hand that gets less far than this from where it begins, in reaches, is compared in this size.
const SMALLEST: f64 = 0.6;
/// What there is to say of a movement at least, in units of the encoder, when it is asked how much of it is not said.
const LEAST: f64 = 0.2;

/// A body whose hands are where its fingers begin. Who greets turns the wrist, and the wrist's centre hardly moves.
///
/// # Errors
/// Never for a body that has been made.
pub fn knuckled(body: &Skeleton) -> Result<Skeleton> {
    let mut effectors = body.effectors().to_vec();
    for e in effectors
        .iter_mut()
        .filter(|e| HANDS.contains(&e.name.as_str()))
    {
        e.point = body.joints()[e.joint].tip;
    }
    Ok(Skeleton::new(
        body.name(),
        body.joints().to_vec(),
        effectors,
    )?)
}

/// A recording, and what of it is the movement.
#[derive(Debug, Clone, PartialEq)]
pub struct Movement {
    /// How far the hands reach in the whole recording, metres.
    pub reach_m: f64,
    /// Every hand that moves.
    pub hands: Vec<Hand>,
    /// Both hands while one of them performs; in the mirror if the left one moves more.
    pub both: EffectorPaths,
}

/// What a hand did, as of the right hand: the left is in the mirror.
#[derive(Debug, Clone, PartialEq)]
pub struct Hand {
    /// While it was away from rest.
    pub away: EffectorPaths,
    /// While it performed: to and fro, from its first turning point to its last, or else all the while it was away.
    pub performed: EffectorPaths,
}

impl Movement {
    /// By the hands' own kinematics: [`EffectorPaths::moving`] says which hands, [`EffectorPaths::away`] and
    /// [`EffectorPaths::performed`] when.
    ///
    /// # Errors
    /// When the body has no hands or shoulders.
    pub fn of(motion: &Motion) -> Result<Self> {
        let names = HANDS.map(String::from);
        let heading_secs = EncodingSettings::default().heading_secs;
        Self::of_paths(&EffectorPaths::of_motion(motion, &names, heading_secs)?)
    }

    /// The same of the paths of the left and the right hand.
    ///
    /// # Errors
    /// When the paths are not of the two hands.
    pub fn of_paths(paths: &EffectorPaths) -> Result<Self> {
        let paths = &paths.only(&HANDS)?;
        let mirrored = paths.mirrored()?;
        let lengths = paths.lengths_m();
        let left = lengths[0] > lengths[1];
        let moving = paths.moving();
        let mut spans = Vec::new();
        let mut hands = Vec::new();
        for (hand, seen) in [&mirrored, paths].into_iter().enumerate() {
            if moving[hand] {
                let span = paths.performed(hand);
                let one = seen.only(&[HAND])?;
                hands.push(Hand {
                    away: one.slice(paths.away(hand))?,
                    performed: one.slice(span.clone())?,
                });
                spans.push(span);
            }
        }
        let start = spans.iter().map(|s| s.start).min().unwrap_or(0);
        let end = spans.iter().map(|s| s.end).max().unwrap_or(paths.frames());
        let both = if left { &mirrored } else { paths };
        Ok(Self {
            reach_m: paths.reach_m().unwrap_or(1.0),
            hands,
            both: both.slice(start..end)?,
        })
    }
}

/// How a hand is compared with the primitives: another's, choreographed, of other size, place and tempo. Directions
/// count more than places and lengths, decisions are shorter than the strokes of a quick wave, and paces go from a
/// quarter to four. Chosen on the tuning half.
pub fn one_handed() -> EncodingSettings {
    EncodingSettings {
        effectors: vec![HAND.into()],
        extent: Extent::Stream,
        decision_secs: 0.1,
        horizon_secs: 0.1,
        position: 0.2,
        displacement: 0.3,
        direction: 1.0,
        softness: 0.2,
        rates: vec![0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0],
        entry_cost: 0.1,
        entry_phase: 1.0,
        end_cost: 0.1,
        switch_cost: 0.1,
        ..EncodingSettings::default()
    }
}

/// The published method on one hand.
pub fn one_handed_paper() -> EncodingSettings {
    EncodingSettings {
        effectors: vec![HAND.into()],
        method: EncodingMethod::Paper,
        ..EncodingSettings::default()
    }
}

/// What a movement costs: the mean over the hands that move, by how long they perform, each enlarged to the size of the
/// primitives. `None` where no hand moves.
///
/// # Errors
/// When the encoder looks at something else than the right hand.
pub fn costs(encoder: &Encoder<'_>, movement: &Movement, sets: &[usize]) -> Result<Option<Costs>> {
    let mut sums = [0.0; SETS.len()];
    let (mut held, mut all) = (0.0, 0.0);
    for hand in &movement.hands {
        let secs = hand.performed.duration_secs();
        let paths = enlarged(&hand.performed, SMALLEST * movement.reach_m)?;
        held += secs * encoder.held(&paths)?;
        for (set, sum) in sums.iter_mut().enumerate() {
            let own: Vec<usize> = (0..sets.len()).filter(|p| sets[*p] == set).collect();
            *sum += secs * encoder.explained(&paths, &own)?.cost;
        }
        all += secs;
    }
    let least = sums.into_iter().fold(f64::INFINITY, f64::min);
    Ok((all > 0.0).then(|| Costs {
        sets: sums.map(|s| s / all),
        unsaid: least / (held + LEAST * all),
    }))
}

/// The paths of a hand, enlarged about the mean of its places until it gets so far, metres, from where it begins.
///
/// # Errors
/// Never for finite places.
pub fn enlarged(hand: &EffectorPaths, far_m: f64) -> Result<EffectorPaths> {
    let places = || (0..hand.frames()).flat_map(|f| hand.at(f)).flatten();
    let Some(first) = places().next() else {
        return Ok(hand.clone());
    };
    let far = places().map(|p| (p - first).norm()).fold(0.0, f64::max);
    if far <= 0.0 || far >= far_m {
        return Ok(hand.clone());
    }
    let mean = places().sum::<Vector3<f64>>() / places().count() as f64;
    let grown = |p: &Option<Vector3<f64>>| p.map(|p| mean + far_m / far * (p - mean));
    let points = (0..hand.frames()).flat_map(|f| hand.at(f).iter().map(grown));
    Ok(EffectorPaths::new(
        hand.rate_hz(),
        hand.effectors().to_vec(),
        points.collect(),
    )?)
}

/// What the published method says of a movement.
///
/// # Errors
/// When the encoder looks at something else than both hands.
pub fn posterior(encoder: &Encoder<'_>, movement: &Movement) -> Result<Posterior> {
    Ok(encoder.encode("movement", &movement.both)?.posterior)
}
