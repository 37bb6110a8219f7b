//! A made-up scene: a simple body that waves, with everything that a page can show of it.

use kineme_report::scene::{
    Actor, Axis, Body, Bone, Card, CardExemplar, Class, Excerpt, Floats, Flow, Places, Scene,
    Shares, Stretch, Take, Track,
};

const SECS: f64 = 6.0;
const RATE_HZ: f64 = 30.0;
const PHASES: usize = 25;
const NODES: usize = 5;

/// Pelvis, chest, head, and per side shoulder, elbow, hand, hip, knee, foot, toes.
fn body() -> Body {
    let mut parents = vec![None, Some(0), Some(1)];
    let mut bones = vec![
        ([0, 1], [0.11, 0.10]),
        ([1, 2], [0.05, 0.05]),
        ([2, 2], [0.1, 0.1]),
    ];
    for side in [3, 10] {
        let hangs = [1, side, side + 1, 0, side + 3, side + 4, side + 5];
        parents.extend(hangs.map(Some));
        bones.extend([
            ([1, side], [0.06, 0.055]),
            ([side, side + 1], [0.05, 0.04]),
            ([side + 1, side + 2], [0.04, 0.03]),
            ([0, side + 3], [0.1, 0.085]),
            ([side + 3, side + 4], [0.085, 0.055]),
            ([side + 4, side + 5], [0.055, 0.04]),
            ([side + 5, side + 6], [0.04, 0.025]),
        ]);
    }
    Body {
        name: "made up".into(),
        points: 17,
        centre: 0,
        parents,
        bones: bones
            .into_iter()
            .map(|(ends, radii)| Bone { ends, radii })
            .collect(),
        tips: vec![5, 12],
    }
}

/// The body with its right arm raised by an angle, `x` metres ahead.
fn posture(lift: f64, x: f64) -> Vec<[f64; 3]> {
    let mut points = vec![[x, 0.0, 0.95], [x, 0.0, 1.35], [x, 0.0, 1.62]];
    for (sign, angle) in [(1.0, 0.15), (-1.0, lift)] {
        let along = |from: [f64; 3], length: f64| {
            [
                from[0] + 0.1 * angle,
                from[1] + sign * length * f64::sin(angle),
                from[2] - length * f64::cos(angle),
            ]
        };
        let shoulder = [x, 0.2 * sign, 1.42];
        let elbow = along(shoulder, 0.29);
        let (hip, knee, foot) = (
            [x, 0.1 * sign, 0.9],
            [x + 0.02, 0.11 * sign, 0.48],
            [x, 0.12 * sign, 0.08],
        );
        points.extend([
            shoulder,
            elbow,
            along(elbow, 0.27),
            hip,
            knee,
            foot,
            [x + 0.18, 0.13 * sign, 0.03],
        ]);
    }
    points
}

fn actor(name: &str, late: f64) -> Actor {
    let frames = (0..=(SECS * RATE_HZ) as usize).map(|f| {
        let secs = f as f64 / RATE_HZ - late;
        posture(1.4 - 1.2 * (2.0 * secs).cos(), 0.25 * secs)
    });
    Actor {
        name: name.into(),
        rate_hz: RATE_HZ,
        frames: Places::pack(&frames.collect::<Vec<_>>()),
        ..Actor::default()
    }
}

fn stretch(start: f64, end: f64, group: Option<usize>) -> Stretch {
    Stretch {
        start,
        end,
        name: group.map_or("nothing known".into(), |g| format!("wave-{g}")),
        colour: group,
        detail: String::new(),
    }
}

fn take() -> Take {
    let encoded = Actor {
        colour: Some(1),
        ghost: true,
        aside: [0.0, 1.1, 0.0],
        ..actor("encoded", 0.15)
    };
    let moments = (SECS * 10.0) as usize;
    let shares = (0..=moments).flat_map(|i| {
        let wave = 0.5 + 0.5 * (0.3 * i as f64).sin();
        [0.8 * wave, 0.8 - 0.8 * wave, 0.2]
    });
    let classes = [("wave-0", Some(0)), ("wave-1", Some(1)), ("none", None)];
    Take {
        name: "</script> & a wave".into(),
        note: "shown at 30 of 120 frames a second".into(),
        secs: SECS,
        actors: vec![actor("observed", 0.0), encoded],
        tracks: vec![
            Track::Bands {
                title: "Posterior".into(),
                classes: classes
                    .into_iter()
                    .map(|(name, colour)| Class {
                        name: name.into(),
                        colour,
                    })
                    .collect(),
                rate_hz: 10.0,
                start_secs: 0.0,
                shares: Shares::pack(shares),
            },
            Track::Spans {
                title: "Plan".into(),
                spans: vec![
                    stretch(0.2, 2.0, Some(0)),
                    stretch(1.5, 3.5, Some(1)),
                    stretch(4.0, 6.0, None),
                ],
            },
            Track::Line {
                title: "Tracking error, rad".into(),
                rate_hz: 10.0,
                start_secs: 0.0,
                values: Floats::pack((0..=moments).map(|i| 0.01 + 0.01 * (0.5 * i as f64).sin())),
            },
        ],
    }
}

/// Heights to which the arm is raised at the nodes of the grid.
fn lifts() -> impl Iterator<Item = f64> {
    (0..NODES).map(|n| 0.8 + 0.5 * n as f64)
}

fn card(name: &str, colour: usize) -> Card {
    let lift = |height: f64, k: usize| {
        height * (std::f64::consts::PI * k as f64 / (PHASES - 1) as f64).sin()
    };
    let rows = |heights: &[f64]| {
        let rows = heights
            .iter()
            .flat_map(|&h| (0..PHASES).map(move |k| posture(lift(h, k), 0.0)));
        Places::pack(&rows.collect::<Vec<_>>())
    };
    let flow = |heights: &[f64]| {
        let rows = heights.iter().flat_map(|&h| {
            (0..PHASES).flat_map(move |k| [lift(h, k), 0.3 * (0.3 * k as f64).sin() * h, 0.1 * h])
        });
        Floats::pack(rows)
    };
    let nodes: Vec<f64> = lifts().collect();
    let exemplars = [1.0, 1.9, 2.6];
    let clock = nodes
        .iter()
        .flat_map(|h| (0..PHASES).map(move |k| (0.8 + 0.2 * h) * k as f64 / (PHASES - 1) as f64));
    Card {
        name: name.into(),
        facts: vec![
            ["length".into(), "1.20 s".into()],
            ["coherence".into(), "0.41".into()],
        ],
        doubt: if colour == 0 {
            String::new()
        } else {
            "low coherence: perhaps a mixture".into()
        },
        colour,
        axes: vec![Axis {
            name: "height".into(),
            unit: "m".into(),
            low: 0.8,
            high: 2.8,
            nodes: NODES,
            start: 1.8,
        }],
        phases: PHASES,
        lattice: rows(&nodes),
        clock: Floats::pack(clock),
        exemplars: exemplars
            .iter()
            .map(|&h| CardExemplar {
                name: format!("raised by {h}"),
                secs: 1.2,
                parameters: vec![h],
            })
            .collect(),
        paths: rows(&exemplars),
        more: 4,
        flow: Some(Flow {
            explained: [0.71, 0.2, 0.05],
            lattice: flow(&nodes),
            exemplars: flow(&exemplars),
        }),
        sources: vec![
            Excerpt {
                motion: "takes/</a> & one.bvh".into(),
                start: 1.5,
                end: 2.75,
                take: Some(1),
            },
            Excerpt {
                motion: "takes/elsewhere.bvh".into(),
                start: 0.0,
                end: 1.0,
                take: None,
            },
        ],
        ..Card::default()
    }
}

/// The scene.
pub fn scene() -> Scene {
    let other = Take {
        name: "another".into(),
        actors: vec![actor("observed", 1.0)],
        tracks: Vec::new(),
        ..take()
    };
    Scene {
        bodies: vec![body()],
        takes: vec![take(), other],
        primitives: vec![card("wave", 0), card("<wave> too", 1)],
        vocabulary: "made up.kineme".into(),
    }
}
