//! Motions and recordings as takes of a page.

use kineme::derivation::Derived;
use kineme::retargeting::RoleMap;
use kineme::{Motion, Recording};
use kineme_report::scene::{Actor, Places, Scene, Stretch, Take, Track};

use super::flesh::Shape;
use super::{BYTES_PER_POINT, body_index, differ, ground};

/// How much of motions a page shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Frames a second at most.
    pub rate_hz: f64,
    /// How many of the motions, from the first.
    pub takes: usize,
}

impl Shown {
    /// What fits into so many bytes of page: of all motions (seconds and points of a frame each) at 30 frames a second,
    /// of fewer frames, or in the end of fewer motions.
    pub fn within(bytes: usize, motions: &[(f64, usize)]) -> Self {
        const RATES: [f64; 4] = [30.0, 20.0, 15.0, 10.0];
        let takes = motions.len();
        let size = |rate: f64, (secs, points): &(f64, usize)| {
            (secs * rate + 1.0) * (points * BYTES_PER_POINT) as f64
        };
        let whole = |rate: f64| motions.iter().map(|m| size(rate, m)).sum::<f64>();
        if let Some(rate_hz) = RATES.into_iter().find(|r| whole(*r) <= bytes as f64) {
            return Self { rate_hz, takes };
        }
        let rate_hz = RATES[RATES.len() - 1];
        let mut sum = 0.0;
        let fits = motions.iter().take_while(|m| {
            sum += size(rate_hz, m);
            sum <= bytes as f64
        });
        Self {
            rate_hz,
            takes: fits.count().max(1).min(takes),
        }
    }
}

/// Which frames of a motion are shown, and how many of them a second: every n-th, so that none is made up.
pub fn thinned(frames: usize, rate_hz: f64, most_hz: f64) -> (Vec<usize>, f64) {
    // Frame times of few digits make 30 frames a second 30.0003.
    let stride = (rate_hz / most_hz - 0.01).ceil().max(1.0);
    let chosen = (0..frames).step_by(stride as usize).collect();
    (chosen, rate_hz / stride)
}

/// A motion of a body as an actor.
pub fn actor(scene: &mut Scene, name: &str, motion: &Motion, most_hz: f64) -> Actor {
    let shape = Shape::of(motion.skeleton());
    let (frames, rate_hz) = thinned(motion.frames(), motion.rate_hz(), most_hz);
    let mut rows: Vec<_> = frames
        .iter()
        .map(|&f| shape.of_frames(&motion.frames_at(f)))
        .collect();
    ground(
        &mut rows,
        differ(motion.roots().iter().map(|r| r.position.z)),
    );
    Actor {
        name: name.into(),
        body: body_index(scene, &shape.body),
        rate_hz,
        frames: Places::pack(&rows),
        ..Actor::default()
    }
}

/// A recording in its own skeleton as an actor; `roles` says which joint is which, as far as that is known.
pub fn actor_of_recording(
    scene: &mut Scene,
    name: &str,
    recording: &Recording,
    roles: Option<&RoleMap>,
    most_hz: f64,
) -> Actor {
    let shape = Shape::of_recording(recording, roles);
    let (frames, rate_hz) = thinned(recording.frames(), recording.rate_hz(), most_hz);
    let mut placed = Vec::new();
    let mut rows: Vec<_> = frames
        .iter()
        .map(|&f| {
            recording.place(f, &mut placed);
            shape.places(&placed)
        })
        .collect();
    ground(&mut rows, true);
    Actor {
        name: name.into(),
        body: body_index(scene, &shape.body),
        rate_hz,
        frames: Places::pack(&rows),
        ..Actor::default()
    }
}

/// What was derived of a motion, as tracks: its groups, and its behaviors where groups alternate.
pub fn spans(derived: &Derived, motions: &[Motion], motion: usize) -> Vec<Track> {
    let rate = motions[motion].rate_hz();
    let mut segments: Vec<usize> = (0..derived.segments.len())
        .filter(|&i| derived.segments[i].motion == motion)
        .collect();
    segments.sort_by_key(|&i| (derived.segments[i].frames.start, i));
    let mut groups: Vec<Stretch> = Vec::with_capacity(segments.len());
    let mut behaviors: Vec<Stretch> = Vec::new();
    for i in segments {
        let frames = &derived.segments[i].frames;
        let (start, end) = (frames.start as f64 / rate, frames.end as f64 / rate);
        let label = derived.labels[i];
        groups.push(Stretch {
            start,
            end,
            name: label.map_or("in no group".into(), |g| derived.groups[g].name.clone()),
            colour: label,
            detail: String::new(),
        });
        let behavior = label.map(|g| &derived.behaviors.items[derived.behaviors.of_group[g]]);
        // A behavior of one group would only repeat its name.
        let Some(behavior) = behavior.filter(|b| b.primitives.len() > 1) else {
            continue;
        };
        match behaviors.last_mut() {
            Some(last) if last.name == behavior.name && start - last.end < 0.3 => last.end = end,
            _ => behaviors.push(Stretch {
                start,
                end,
                name: behavior.name.clone(),
                colour: None,
                detail: behavior.primitives.join(", "),
            }),
        }
    }
    let mut tracks = vec![Track::Spans {
        title: "Groups".into(),
        spans: groups,
    }];
    if !behaviors.is_empty() {
        tracks.push(Track::Spans {
            title: "Behaviors".into(),
            spans: behaviors,
        });
    }
    tracks
}

/// A motion with what was derived of it.
pub fn take_of_derived(
    scene: &mut Scene,
    derived: &Derived,
    motions: &[Motion],
    motion: usize,
    most_hz: f64,
) -> Take {
    let of = &motions[motion];
    Take {
        name: of.name().into(),
        note: String::new(),
        secs: of.duration_secs(),
        actors: vec![Actor {
            wears: Some(0),
            ..actor(scene, of.skeleton().name(), of, most_hz)
        }],
        tracks: spans(derived, motions, motion),
    }
}
