//! What a page shows is what the model says: between the nodes of its grid, on the ground, with nothing made up.

use std::sync::Arc;

use kineme::{Modelling, Motion, Root, Vocabulary, ares};
use kineme_formats::script;
use kineme_paper::scene::{CardBudget, Shape, Shown, actor, cards, thinned};
use kineme_report::scene::{Card, Scene};
use nalgebra::Vector3;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;

const BOXING: &str = include_str!("../../../choreography/boxing.toml");

fn vocabulary() -> Vocabulary {
    let script = script::parse("boxing.toml", BOXING.as_bytes()).expect("a script");
    let body = Arc::new(ares().expect("Ares"));
    let made = script.vocabulary(&body, &Modelling::default(), ("boxing", None));
    made.expect("a vocabulary")
}

/// A row of a card's places, from the body's centre: what the page's program makes between the grid's nodes.
fn shown(
    card: &Card,
    places: &[Vec<Option<[f64; 3]>>],
    values: &[f64],
    phase: usize,
) -> Vec<Vector3<f64>> {
    let mut nodes = vec![(0, 1.0)];
    for (axis, value) in card.axes.iter().zip(values) {
        let at = (value - axis.low) / (axis.high - axis.low) * (axis.nodes - 1) as f64;
        let low = (at.floor() as usize).min(axis.nodes - 2);
        let share = at - low as f64;
        nodes = nodes
            .into_iter()
            .flat_map(|(n, w)| {
                let first = n * axis.nodes + low;
                [(first, w * (1.0 - share)), (first + 1, w * share)]
            })
            .collect();
    }
    let points = places[0].len();
    let sum = |i: usize| {
        let part = |&(n, w): &(usize, f64)| {
            let place = places[n * card.phases + phase][i].expect("every point is there");
            Vector3::from(place) * w
        };
        nodes.iter().map(part).sum::<Vector3<f64>>()
    };
    (0..points).map(sum).collect()
}

#[test]
fn between_the_nodes_a_card_shows_the_primitive() {
    let vocabulary = vocabulary();
    let shape = Shape::of(vocabulary.body());
    let mut scene = Scene::default();
    let (cards, left_out) = cards(&mut scene, &vocabulary, &CardBudget::default()).expect("cards");
    assert_eq!((cards.len(), left_out), (vocabulary.primitives().len(), 0));
    let mut random = Pcg64::seed_from_u64(5);
    let mut errors = Vec::new();
    for (card, primitive) in cards.iter().zip(vocabulary.primitives()) {
        assert_eq!(
            card.axes.len(),
            primitive.parameters().dims().min(3),
            "{}",
            card.name
        );
        let places = card.lattice.unpack();
        for _ in 0..20 {
            let mut place = primitive.middle();
            for p in place.iter_mut().take(card.axes.len()) {
                *p = random.random_range(0.0..1.0);
            }
            let values = primitive.parameters().from_unit(&place);
            let phase = random.random_range(0..card.phases);
            let sample = primitive
                .sample(&place, phase as f64 / (card.phases - 1) as f64)
                .expect("a posture");
            let frames = vocabulary.body().frames(&sample.pose, &Root::ORIGIN);
            let wanted = shape.of_frames(&frames);
            let found = shown(card, &places, &values, phase);
            let centre = shape.body.centre;
            for (found, wanted) in found.iter().map(|p| p - found[centre]).zip(
                wanted
                    .iter()
                    .map(|p| Vector3::from(*p) - Vector3::from(wanted[centre])),
            ) {
                errors.push((found - wanted).norm());
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let (middle, worst) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    println!(
        "between nodes: median {:.2} mm, worst {:.2} mm",
        1e3 * middle,
        1e3 * worst
    );
    assert!(
        middle < 1e-3 && worst < 0.03,
        "{middle} m, at worst {worst} m"
    );
}

#[test]
fn a_card_is_the_same_each_time_and_keeps_within_its_room() {
    let vocabulary = vocabulary();
    let make = |bytes| {
        let mut scene = Scene::default();
        let budget = CardBudget {
            bytes,
            ..CardBudget::default()
        };
        cards(&mut scene, &vocabulary, &budget).expect("cards").0
    };
    assert!(make(5_000_000) == make(5_000_000));
    let size = |cards: &[Card]| -> usize {
        let one = |c: &Card| c.lattice.data.len() + c.paths.data.len();
        cards.iter().map(one).sum()
    };
    let (large, small) = (size(&make(5_000_000)), size(&make(400_000)));
    assert!(
        large <= 5_000_000 && small <= 500_000 && small < large,
        "{large} {small}"
    );
}

#[test]
fn who_was_never_placed_stands_on_the_ground() {
    let body = Arc::new(ares().expect("Ares"));
    let poses = body.neutral();
    let motion = Motion::new("still", body, 60.0, poses, vec![Root::ORIGIN]).expect("a motion");
    let mut scene = Scene::default();
    let actor = actor(&mut scene, "still", &motion, 30.0);
    let rows = actor.frames.unpack();
    let heights = rows[0].iter().flatten().map(|p| p[2]);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    assert!((0.0..0.05).contains(&lowest), "{lowest}");
    assert_eq!(scene.bodies.len(), 1);
}

#[test]
fn thinning_takes_every_nth_frame() {
    for (frames, rate, most, kept, rate_kept) in [
        (10, 30.0, 30.0, 10, 30.0),
        (10, 30.0003, 30.0, 10, 30.0003),
        (10, 60.0, 30.0, 5, 30.0),
        (10, 100.0, 30.0, 3, 25.0),
        (1, 120.0, 10.0, 1, 10.0),
    ] {
        let (chosen, hz) = thinned(frames, rate, most);
        assert_eq!((chosen.len(), chosen[0]), (kept, 0), "{rate} Hz");
        assert!((hz - rate_kept).abs() < 1e-9, "{rate} Hz");
    }
}

#[test]
fn what_is_too_much_loses_frames_first_and_motions_last() {
    let minute = (60.0, 40);
    for (bytes, motions, rate_hz, takes) in [
        (1_000_000, 1, 30.0, 1),
        (1_000_000, 2, 20.0, 2),
        (1_000_000, 4, 10.0, 4),
        (1_000_000, 9, 10.0, 5),
        (10, 3, 10.0, 1),
        (10, 0, 30.0, 0),
    ] {
        let shown = Shown::within(bytes, &vec![minute; motions]);
        assert_eq!(
            shown,
            Shown { rate_hz, takes },
            "{motions} motions in {bytes} bytes"
        );
    }
}
