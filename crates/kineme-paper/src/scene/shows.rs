//! The demo's show on a page.

use kineme::interaction::Performance;
use kineme::primitive::Reading;
use kineme::{Motion, Vocabulary};
use kineme_report::scene::{Actor, Class, Floats, Scene, Shares, Stretch, Take, Track};

use super::takes::{actor, thinned};
use crate::show::{PartRead, Show};

/// Frames and moments a second on the page.
const FRAMES_HZ: f64 = 30.0;
const MOMENTS_HZ: f64 = 15.0;
/// How far apart bodies stand that do the same, metres.
const ASIDE_M: f64 = 1.1;

/// What was performed, as takes: the routine, the bout, and the routine read by its hands.
pub fn takes_of_show(scene: &mut Scene, show: &Show) -> Vec<Take> {
    vec![
        routine(scene, show),
        bout(scene, show),
        encoded(scene, show),
    ]
}

fn routine(scene: &mut Scene, show: &Show) -> Take {
    let [adonis, ares] = &show.routine;
    let moving = |p: &Performance| {
        let body = p.done.skeleton();
        format!(
            "{} ({} degrees of freedom) within {:.2}\u{b0}",
            capital(body.name()),
            body.dof(),
            p.tracking.rms_rad.to_degrees()
        )
    };
    let physics = match show.physics {
        true => format!(
            "In physics, pelvis held: {}, {} of what they were told (root mean square).",
            moving(adonis),
            moving(ares)
        ),
        false => "Without physics: the bodies are where they are told to be.".into(),
    };
    let mut left = actor(scene, "Adonis", &adonis.done, FRAMES_HZ);
    left.wears = Some(0);
    left.aside = [0.0, 0.5 * ASIDE_M, 0.0];
    let mut right = actor(scene, "Ares", &ares.done, FRAMES_HZ);
    right.wears = Some(0);
    right.aside = [0.0, -0.5 * ASIDE_M, 0.0];
    let recognised = |of: &str, vocabulary: &Vocabulary, readings: &[Reading]| {
        let (whole, rate_hz) = (&show.movements, ares.done.rate_hz());
        let title = format!("Recognised: {of}");
        posterior(&title, vocabulary, whole, readings, rate_hz)
    };
    let part = |part: &PartRead| {
        let of = part.names.join(" and ").replace('_', " ");
        recognised(&of, &part.vocabulary, &part.readings)
    };
    let mut tracks = vec![ran("Plan, as it ran", ares, &show.movements)];
    tracks.extend(show.parts.iter().map(part));
    tracks.push(recognised("whole body", &show.movements, &show.readings));
    tracks.push(error("Adonis", adonis));
    Take {
        name: "A routine".into(),
        note: format!(
            "One plan, two bodies: movements one after the other, two at a time, one that interrupts another, one to a \
             point. {physics} What Ares did is recognised, by its joint angles, with the same primitives that moved it. \
             Of two movements at a time each is found by its part; for the whole body the two together are none of \
             them. While one movement takes over from another, for about half a second, the body does neither and is \
             read as whatever that resembles; trunk and head do much the same in several of the blows."
        ),
        secs: ares.done.duration_secs(),
        actors: vec![left, right],
        tracks,
    }
}

fn bout(scene: &mut Scene, show: &Show) -> Take {
    let attacks = show.attacker.attacks.iter().map(|attack| Stretch {
        start: attack.start_secs,
        end: attack.end_secs,
        name: attack.primitive.clone(),
        colour: colour(&show.boxing, &attack.primitive),
        detail: String::new(),
    });
    let attacks = Track::Spans {
        title: "Attacks".into(),
        spans: attacks.collect(),
    };
    let seen = show.attacker.seen.motion();
    let mut take = take_of_performance(scene, &show.boxing, &show.bout, Some((seen, &show.heard)));
    take.name = "Sparring".into();
    if let Some(watched) = take.actors.last_mut() {
        watched.name = "Attacker".into();
    }
    take.note =
        "Adonis watches the attacker's joints, recognises the attack and answers with a shield."
            .into();
    take.tracks.insert(0, attacks);
    // The track before the others: everybody's is one further on, and the attacker does what it tells.
    for actor in &mut take.actors {
        actor.wears = Some(actor.wears.map_or(0, |track| track + 1));
    }
    take
}

/// What a body did by a plan, and what it watched meanwhile with what was thought of it, frame by frame.
pub fn take_of_performance(
    scene: &mut Scene,
    vocabulary: &Vocabulary,
    performance: &Performance,
    watched: Option<(&Motion, &[Reading])>,
) -> Take {
    let done = &performance.done;
    let name = capital(done.skeleton().name());
    let mut take = Take {
        name: "What was done".into(),
        secs: done.duration_secs(),
        actors: vec![actor(scene, &name, done, FRAMES_HZ)],
        ..Take::default()
    };
    take.actors[0].wears = Some(usize::from(watched.is_some()));
    if let Some((seen, readings)) = watched {
        let other = actor(scene, "Watched", seen, FRAMES_HZ);
        take.actors.push(other);
        take.secs = take.secs.max(seen.duration_secs());
        take.tracks.push(posterior(
            "Recognised of who is watched",
            vocabulary,
            vocabulary,
            readings,
            seen.rate_hz(),
        ));
    }
    take.tracks.push(ran("Behaviors", performance, vocabulary));
    take.tracks.push(error(&name, performance));
    take
}

fn error(name: &str, performance: &Performance) -> Track {
    let (_, rate_hz) = thinned(
        performance.done.frames(),
        performance.done.rate_hz(),
        MOMENTS_HZ,
    );
    Track::Line {
        title: format!("{name}, degrees off what it was told"),
        rate_hz,
        start_secs: 0.0,
        values: Floats::pack(off(&performance.commanded, &performance.done)),
    }
}

fn encoded(scene: &mut Scene, show: &Show) -> Take {
    let observed = &show.routine[1].done;
    let hands = Actor {
        wears: Some(0),
        aside: [0.0, 0.5 * ASIDE_M, 0.0],
        ..actor(scene, "Observed", observed, FRAMES_HZ)
    };
    let ghost = Actor {
        ghost: true,
        wears: Some(1),
        aside: [0.0, -0.5 * ASIDE_M, 0.0],
        ..actor(scene, "Encoded", &show.encoding.motion, FRAMES_HZ)
    };
    let name = |k: usize| show.movements.primitives()[k].name();
    let spans = show.encoding.spans.iter().filter_map(|span| {
        let k = span.primitive?;
        Some(Stretch {
            start: span.start_secs,
            end: span.end_secs,
            name: name(k).into(),
            colour: Some(k),
            detail: format!("similarity {:.2}", span.similarity),
        })
    });
    Take {
        name: "Read by the hands alone".into(),
        note: "Only the paths of the hands were seen of Ares. The figure seen through is its movement said again in the joints of the \
               vocabulary, by the primitives that predict those paths best."
            .into(),
        secs: observed.duration_secs(),
        actors: vec![hands, ghost],
        tracks: vec![
            ran("Plan, as it ran", &show.routine[1], &show.movements),
            Track::Spans {
                title: "Encoded as".into(),
                spans: spans.collect(),
            },
        ],
    }
}

fn ran(title: &str, performance: &Performance, vocabulary: &Vocabulary) -> Track {
    let spans = performance.ran.iter().map(|ran| Stretch {
        start: ran.start_secs,
        end: ran.end_secs,
        name: ran.primitive.clone(),
        colour: colour(vocabulary, &ran.primitive),
        detail: ran.joints.join(", "),
    });
    Track::Spans {
        title: title.into(),
        spans: spans.collect(),
    }
}

/// Of all primitives those that are ever more probable than a tenth, rest, and everything else; in the colours that they
/// have in the `whole` vocabulary.
fn posterior(
    title: &str,
    vocabulary: &Vocabulary,
    whole: &Vocabulary,
    readings: &[Reading],
    rate_hz: f64,
) -> Track {
    let (moments, moments_hz) = thinned(readings.len(), rate_hz, MOMENTS_HZ);
    let of = |f: usize| &readings[f].posterior;
    let shown: Vec<usize> = (0..vocabulary.primitives().len())
        .filter(|&k| moments.iter().any(|&f| of(f).primitives[k] > 0.1))
        .collect();
    let mut classes: Vec<Class> = shown
        .iter()
        .map(|&k| vocabulary.primitives()[k].name())
        .map(|name| Class {
            name: name.into(),
            colour: colour(whole, name),
        })
        .collect();
    classes.extend(["at rest", "none of them"].map(|name| Class {
        name: name.into(),
        colour: None,
    }));
    let shares = moments.iter().flat_map(|&f| {
        let known = shown.iter().map(move |&k| of(f).primitives[k]);
        let sum: f64 = known.clone().sum();
        let rest = of(f).rest;
        known.chain([rest, (1.0 - sum - rest).max(0.0)])
    });
    Track::Bands {
        title: title.into(),
        classes,
        rate_hz: moments_hz,
        start_secs: 0.0,
        shares: Shares::pack(shares),
    }
}

fn colour(vocabulary: &Vocabulary, primitive: &str) -> Option<usize> {
    let mut primitives = vocabulary.primitives().iter();
    primitives.position(|p| p.name() == primitive)
}

/// Root mean square angle between joints told and done, degrees.
fn off(told: &Motion, done: &Motion) -> Vec<f64> {
    let body = told.skeleton();
    let (frames, _) = thinned(done.frames(), done.rate_hz(), MOMENTS_HZ);
    let moving: Vec<usize> = (0..body.joints().len())
        .filter(|&j| !body.coordinates(j).is_empty())
        .collect();
    let angle = |f: usize, j: usize| {
        let at = body.coordinates(j);
        let there = body.rotation(j, &told.pose(f)[at.clone()]);
        there.angle_to(&body.rotation(j, &done.pose(f)[at]))
    };
    let rms = |&f: &usize| {
        let squares = moving.iter().map(|&j| angle(f, j).powi(2));
        (squares.sum::<f64>() / moving.len() as f64).sqrt()
    };
    frames.iter().map(|f| rms(f).to_degrees()).collect()
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}
