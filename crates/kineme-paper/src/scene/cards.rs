//! Primitives as cards of a page.

use kineme::primitive::{ParameterSource, Sample};
use kineme::{Primitive, Root, Vocabulary};
use kineme_report::LOW_COHERENCE;
use kineme_report::scene::{Axis, Card, CardExemplar, Excerpt, Floats, Places, Scene};
use nalgebra::{Rotation2, Vector2, Vector3};
use rayon::prelude::*;

use super::flesh::Shape;
use super::flow::flow;
use super::{BYTES_PER_POINT, body_index, differ, ground};

/// How finely primitives are shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CardBudget {
    /// Bytes of page for all of them together.
    pub bytes: usize,
    /// Exemplars of each at most.
    pub exemplars: usize,
}

impl Default for CardBudget {
    fn default() -> Self {
        Self {
            bytes: 5_000_000,
            // A grid of three by three, as choreographies have it.
            exemplars: 9,
        }
    }
}

/// How a card is read: what stands above the cards of primitives.
pub const HOW_TO_READ: &str = "Left: the exemplars, one over the other. Right: f(p, \u{3c4}), their blend at the \
     parameters p of the sliders, whose marks are the exemplars. Left-out error: how far the wrists miss an exemplar, \
     on average, that is predicted from the others.";

/// Nodes along each axis of the grid that are tried, for one, two and three parameters.
const NODES: [&[usize]; 3] = [&[9, 5, 3], &[6, 5, 4, 3], &[4, 3]];
/// Bytes below which a card would show nothing well.
const LEAST_BYTES: usize = 30_000;

/// The cards of a vocabulary's primitives in their order, and how many there was no room for.
///
/// # Errors
/// When a primitive refuses its own parameters.
pub fn cards(
    scene: &mut Scene,
    vocabulary: &Vocabulary,
    budget: &CardBudget,
) -> kineme::Result<(Vec<Card>, usize)> {
    let shape = Shape::of(vocabulary.body());
    let all = vocabulary.primitives();
    let shown = all.len().min((budget.bytes / LEAST_BYTES).max(1));
    let each = CardBudget {
        bytes: budget.bytes / shown.max(1),
        ..*budget
    };
    let body = body_index(scene, &shape.body);
    let cards: kineme::Result<Vec<Card>> = all[..shown]
        .par_iter()
        .enumerate()
        .map(|(i, primitive)| {
            let card = card(primitive, &shape, &each)?;
            let mut facts = card.facts;
            facts.extend(behavior(vocabulary, primitive.name()));
            Ok(Card {
                facts,
                colour: i,
                body,
                ..card
            })
        })
        .collect();
    Ok((cards?, all.len() - shown))
}

fn card(primitive: &Primitive, shape: &Shape, budget: &CardBudget) -> kineme::Result<Card> {
    let secs = primitive.at(&primitive.middle())?.duration_secs();
    let phases = ((secs * 24.0).round() as usize).clamp(20, 48) + 1;
    let row_bytes = phases * shape.body.points * BYTES_PER_POINT;
    let nodes = nodes(
        primitive.parameters().dims(),
        6 * budget.bytes / 10 / row_bytes,
    );
    let axes = axes(primitive, &nodes);
    let left = (budget.bytes / row_bytes).saturating_sub(nodes.iter().product::<usize>());
    let exemplars = primitive.exemplars().len();
    let shown = exemplars.min(budget.exemplars).min(left.max(2));

    let mut sampled = Sampled::default();
    for place in grid(primitive, &nodes) {
        let course = primitive.at(&place)?;
        sampled.add(primitive, shape, phases, |phase| course.sample(phase));
    }
    let mut exemplary = Sampled::default();
    // Spread over all of them: those that stand together in a list are often of one person.
    let chosen: Vec<usize> = (0..shown).map(|k| k * exemplars / shown).collect();
    for &i in &chosen {
        exemplary.add(primitive, shape, phases, |phase| {
            primitive.registered(i, phase)
        });
    }
    let placed = differ(sampled.heights.iter().chain(&exemplary.heights).copied());
    ground(&mut sampled.places, placed);
    ground(&mut exemplary.places, placed);
    let flow = flow(&sampled.poses, &exemplary.poses);
    Ok(Card {
        name: primitive.name().into(),
        facts: facts(primitive, secs),
        doubt: doubt(primitive),
        cyclic: primitive.is_cyclic(),
        axes,
        phases,
        lattice: Places::pack(&sampled.places),
        clock: Floats::pack(sampled.clock),
        exemplars: chosen.iter().map(|&i| exemplar(primitive, i)).collect(),
        paths: Places::pack(&exemplary.places),
        more: exemplars - shown,
        flow,
        sources: (0..exemplars).map(|i| source(primitive, i)).collect(),
        ..Card::default()
    })
}

/// The nodes of the grid along each parameter that is shown: as many as there is room for.
fn nodes(dims: usize, room: usize) -> Vec<usize> {
    // Beyond three parameters a grid would be all that a page can hold.
    (1..=dims.min(NODES.len()))
        .rev()
        .find_map(|m| {
            let fits = |n: &&usize| n.pow(m as u32) <= room;
            let n = NODES[m - 1].iter().find(fits)?;
            Some(vec![*n; m])
        })
        .unwrap_or_default()
}

fn axes(primitive: &Primitive, nodes: &[usize]) -> Vec<Axis> {
    let space = primitive.parameters();
    let start = space.from_unit(&primitive.middle());
    let unit = match space.source() {
        ParameterSource::Effector { .. } => "m",
        ParameterSource::Adverbs | ParameterSource::Principal { .. } => "",
    };
    let axes = space.axes().iter().zip(start).zip(nodes);
    axes.map(|((axis, start), &nodes)| Axis {
        name: axis.name.clone(),
        unit: unit.into(),
        low: axis.low,
        high: axis.high,
        nodes,
        start: start.clamp(axis.low, axis.high),
    })
    .collect()
}

/// The parameters of the grid's nodes in [0, 1]^m, the last parameter fastest.
fn grid(primitive: &Primitive, nodes: &[usize]) -> Vec<Vec<f64>> {
    let mut places = vec![Vec::new()];
    for &n in nodes {
        let along = |k: usize| k as f64 / (n - 1) as f64;
        places = places
            .into_iter()
            .flat_map(|p: Vec<f64>| (0..n).map(move |k| [p.as_slice(), &[along(k)]].concat()))
            .collect();
    }
    let middle = primitive.middle();
    for place in &mut places {
        place.extend(&middle[place.len()..]);
    }
    places
}

/// Movements at evenly spaced phases.
#[derive(Default)]
struct Sampled {
    places: Vec<Vec<[f64; 3]>>,
    poses: Vec<Vec<f64>>,
    heights: Vec<f64>,
    clock: Vec<f64>,
}

impl Sampled {
    /// Adds a movement. A stroke goes where it goes; a cycle stays on its spot, so that it can go on.
    fn add(
        &mut self,
        primitive: &Primitive,
        shape: &Shape,
        phases: usize,
        at: impl Fn(f64) -> Sample,
    ) {
        let body = primitive.body();
        let (mut secs, mut place, mut yaw) = (0.0, Vector2::zeros(), 0.0);
        let mut before: Option<Sample> = None;
        for k in 0..phases {
            let sample = at(k as f64 / (phases - 1) as f64);
            if let Some(b) = &before {
                let step = 0.5 * (b.secs_per_phase + sample.secs_per_phase) / (phases - 1) as f64;
                secs += step;
                if !primitive.is_cyclic() {
                    let mean = |of: fn(&Sample) -> f64| 0.5 * (of(b) + of(&sample));
                    let ahead = Vector2::new(mean(|s| s.travel.forward), mean(|s| s.travel.left));
                    let turn = step * mean(|s| s.travel.yaw_rate);
                    place += Rotation2::new(yaw + 0.5 * turn) * ahead * step;
                    yaw += turn;
                }
            }
            let root = Root {
                position: Vector3::new(place.x, place.y, sample.travel.height),
                yaw,
            };
            self.places
                .push(shape.of_frames(&body.frames(&sample.pose, &root)));
            self.poses.push(sample.pose.clone());
            self.heights.push(sample.travel.height);
            self.clock.push(secs);
            before = Some(sample);
        }
    }
}

fn exemplar(primitive: &Primitive, i: usize) -> CardExemplar {
    let exemplar = &primitive.exemplars()[i];
    let used = &primitive.fitted().used[i];
    let from = &exemplar.provenance;
    let (start, end) = (from.start_secs, from.end_secs);
    CardExemplar {
        name: format!("{}, {start:.2} to {end:.2} s", from.motion),
        secs: (used.end - used.start) / exemplar.motion.rate_hz(),
        parameters: primitive.parameters().from_unit(primitive.point(i)),
    }
}

fn source(primitive: &Primitive, i: usize) -> Excerpt {
    let from = &primitive.exemplars()[i].provenance;
    Excerpt {
        motion: from.motion.clone(),
        start: from.start_secs,
        end: from.end_secs,
        take: None,
    }
}

/// What is known of a primitive, in a few words each.
fn facts(primitive: &Primitive, secs: f64) -> Vec<[String; 2]> {
    let mut facts = Vec::new();
    let mut fact = |name: &str, value: String| facts.push([name.to_owned(), value]);
    let kind = if primitive.is_cyclic() {
        "cycle"
    } else {
        "length"
    };
    fact(kind, format!("{secs:.2} s"));
    let exemplars = primitive.exemplars().len();
    let group = primitive.group();
    match group.filter(|g| g.members != exemplars) {
        Some(group) => fact(
            "exemplars",
            format!("{exemplars} of {} segments", group.members),
        ),
        None => fact("exemplars", exemplars.to_string()),
    }
    if let Some(coherence) = group.and_then(|g| g.coherence) {
        fact("coherence", format!("{coherence:.2}"));
    }
    if let Some(error) = &primitive.fitted().error {
        let cm = 100.0 * error.wrist_m;
        fact("left-out error", format!("{cm:.1} cm"));
    }
    facts
}

/// Which primitives alternate with one.
fn behavior(vocabulary: &Vocabulary, name: &str) -> Option<[String; 2]> {
    let mut behaviors = vocabulary.behaviors().iter();
    let of =
        behaviors.find(|b| b.primitives.len() > 1 && b.primitives.iter().any(|p| p == name))?;
    let others = of.primitives.iter().filter(|p| *p != name);
    let others: Vec<&str> = others.map(String::as_str).collect();
    Some([
        "alternates with".into(),
        format!("{} ({})", others.join(", "), of.name),
    ])
}

/// Why a group may be one that nobody meant.
fn doubt(primitive: &Primitive) -> String {
    let coherence = primitive.group().and_then(|g| g.coherence);
    match coherence.filter(|c| *c < LOW_COHERENCE) {
        Some(_) => "low coherence: perhaps a mixture".into(),
        None => String::new(),
    }
}
