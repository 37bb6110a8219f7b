//! Figure 7: trajectory encoding, decision by decision.

use std::sync::Arc;

use kineme::control::{Inertialization, Manner, State, Synthesizer};
use kineme::perception::encoding::{
    Decided, EffectorPaths, Encoder, EncodingMethod, EncodingSettings, Matching,
};
use kineme::{Motion, Vocabulary};
use kineme_report::paper::{EncodedDecision, EncodedPaths};
use nalgebra::Vector3;

use super::{all_sets, vocabulary};
use crate::sets::Result;

/// What is done: primitive and parameters, none of them an exemplar's.
const DONE: [(&str, [f64; 2]); 6] = [
    ("punch-out", [0.7, 0.3]),
    ("punch-return", [0.7, 0.3]),
    ("wave-across", [0.8, 0.4]),
    ("wave-return", [0.8, 0.4]),
    ("wave-across", [0.6, 0.7]),
    ("wave-return", [0.6, 0.7]),
];
/// Frames a second of what is observed.
const RATE_HZ: f64 = 60.0;

/// A movement encoded in the paper's way.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoded {
    /// What is drawn.
    pub paths: EncodedPaths,
    /// The decisions, as the encoder took them.
    pub decisions: Vec<Decided>,
}

/// Encodes a movement that Adonis makes in the primitives of all four sets on Ares, by the hands' paths alone: another
/// body, and parameters that no exemplar has.
///
/// # Errors
/// When a step fails.
pub fn encoded() -> Result<Encoded> {
    let ares = Arc::new(kineme::ares()?);
    let known = vocabulary(&all_sets(), &ares)?;
    let (motion, truth) = done(&known)?;
    let settings = EncodingSettings {
        method: EncodingMethod::Paper,
        matching: Matching::Displacement,
        ..EncodingSettings::default()
    };
    let encoder = Encoder::new(&known, &settings)?;
    let seen = EffectorPaths::of_motion(&motion, &settings.effectors, settings.heading_secs)?;
    let decisions = encoder.decisions(&seen)?;
    let hand = settings.effectors.iter().position(|e| e == "right_hand");
    let hand = hand.ok_or("no right hand")?;
    Ok(Encoded {
        paths: drawn(&known, &decisions, truth, hand),
        decisions,
    })
}

/// From when to when, seconds, and which primitive.
type Stretch = (f64, f64, usize);

/// The movement of Adonis, and what it is when: from, to, primitive.
fn done(known: &Vocabulary) -> Result<(Motion, Vec<Stretch>)> {
    let adonis = Arc::new(kineme::adonis()?);
    let moves = vocabulary(&["punching.toml", "horizontal-waving.toml"], &adonis)?;
    let course =
        |name: &str, p: &[f64]| Ok::<_, kineme::Error>(Arc::new(moves.primitive(name)?.at(p)?));
    let (first, p) = DONE[0];
    let state = State::on_course(course(first, &p)?.as_ref(), 0.0, 1.0);
    let mut body = Synthesizer::new(
        Arc::clone(&adonis),
        RATE_HZ,
        &state,
        Inertialization::default(),
    )?;
    let (mut poses, mut roots, mut truth) = (Vec::new(), Vec::new(), Vec::new());
    for (name, p) in DONE {
        body.start(course(name, &p)?, &Manner::default())?;
        let start = roots.len();
        while !body.command().finished || roots.len() == start {
            poses.extend_from_slice(&body.command().pose);
            roots.push(body.command().root);
            body.step();
        }
        let index = known.primitives().iter().position(|k| k.name() == name);
        let index = index.ok_or_else(|| format!("no primitive `{name}`"))?;
        truth.push((start as f64 / RATE_HZ, roots.len() as f64 / RATE_HZ, index));
    }
    Ok((
        Motion::new("observed", adonis, RATE_HZ, poses, roots)?,
        truth,
    ))
}

/// One hand of it: forward over time, and from above.
fn drawn(
    known: &Vocabulary,
    decisions: &[Decided],
    truth: Vec<(f64, f64, usize)>,
    hand: usize,
) -> EncodedPaths {
    let places = |points: &[Vec<Option<Vector3<f64>>>]| -> Vec<Vector3<f64>> {
        points
            .iter()
            .filter_map(|p| p.get(hand).copied().flatten())
            .collect()
    };
    // From above, as a map: forward is up, to the right is right.
    let above = |p: &Vector3<f64>| [-p.y, p.x];
    let timed = |d: &Decided, points: &[Vector3<f64>]| -> Vec<[f64; 2]> {
        let at = |i: usize| d.start_secs + i as f64 * d.step_secs;
        points
            .iter()
            .enumerate()
            .map(|(i, p)| [at(i), p.x])
            .collect()
    };
    let mut paths = EncodedPaths {
        title: "Figure 7. Trajectory encoding".into(),
        subtitle: "Adonis moves, Ares encodes by the paths of the hands alone. At each decision (dot) every primitive \
                   predicts from the encoded posture; the likest takes the interval."
            .into(),
        names: known.primitives().iter().map(|p| p.name().to_string()).collect(),
        over_time: "right hand, forward (m)".into(),
        view_axes: ["from above: to the right (m)".into(), "forward (m)".into()],
        truth,
        ..EncodedPaths::default()
    };
    let mut agreed = 0.0;
    for d in decisions {
        let own = d.instants() + 1;
        let seen = places(&d.seen);
        let winner = places(&d.predicted[d.winner]);
        paths
            .observed
            .extend(timed(d, &seen[..own.min(seen.len())]));
        paths
            .encoded
            .extend(timed(d, &winner[..own.min(winner.len())]));
        paths.observed_view.extend(seen.iter().take(own).map(above));
        paths
            .encoded_view
            .extend(winner.iter().take(own).map(above));
        let predicted: Vec<Vec<Vector3<f64>>> = d.predicted.iter().map(|p| places(p)).collect();
        paths.decisions.push(EncodedDecision {
            start: d.start_secs,
            end: d.end_secs,
            winner: d.winner,
            similarities: d.similarities.clone(),
            predicted: predicted.iter().map(|p| timed(d, p)).collect(),
            predicted_view: predicted
                .iter()
                .map(|p| p.iter().map(above).collect())
                .collect(),
        });
        let same = paths.truth.iter().filter(|t| t.2 == d.winner);
        agreed += same
            .map(|t| (t.1.min(d.end_secs) - t.0.max(d.start_secs)).max(0.0))
            .sum::<f64>();
    }
    let whole = decisions.last().map_or(1.0, |d| d.end_secs);
    paths.remark = format!(
        "The primitive that was really done takes {:.0} % of the time. Lengths are scaled to the reach of Ares; the \
         encoder looks at both hands, the right one is drawn.",
        100.0 * agreed / whole
    );
    paths
}
