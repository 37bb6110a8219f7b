//! The continuous form: window distances against the plain double loop, the laws of nontrivial neighbours, and the
//! loops and curves that spatio-temporal Isomap was made for.

use std::f64::consts::TAU;

use kineme::embedding::{
    Continuous, EmbedOptions, Embedding, Frames, NeighbourGraph, embed, nontrivial_neighbours,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn options(window: usize, exclusion: usize, neighbours: usize) -> Continuous {
    Continuous {
        window,
        exclusion,
        neighbours,
        radius: None,
        ..Continuous::default()
    }
}

/// A walk that wanders and returns, in recordings of these lengths.
fn walk(lengths: &[usize], seed: u64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(seed);
    let len: usize = lengths.iter().sum();
    let mut at = [0.0f64; 2];
    (0..len)
        .flat_map(|_| {
            for a in &mut at {
                *a = 0.95 * *a + random.random_range(-0.2..0.2);
            }
            at
        })
        .collect()
}

/// The definition, written out.
fn by_double_loop(points: &[f64], lengths: &[usize], o: &Continuous) -> Vec<Vec<(usize, f64)>> {
    let ranges: Vec<(usize, usize)> = lengths
        .iter()
        .scan(0, |end, n| {
            *end += n;
            Some((*end - n, *end))
        })
        .collect();
    let of = |x: usize| *ranges.iter().find(|(s, e)| (*s..*e).contains(&x)).unwrap();
    let distance = |x: usize, y: usize| {
        let count = o.window.min(of(x).1 - x).min(of(y).1 - y);
        let squares: f64 = (0..count)
            .flat_map(|k| (0..2).map(move |d| (k, d)))
            .map(|(k, d)| (points[2 * (x + k) + d] - points[2 * (y + k) + d]).powi(2))
            .sum();
        (squares / count as f64).sqrt()
    };
    let len = points.len() / 2;
    let neighbours = |x: usize| {
        let mut minima: Vec<(usize, f64)> = (0..len)
            .filter(|&y| {
                let (start, end) = of(y);
                let here = distance(x, y);
                (y == start || here < distance(x, y - 1))
                    && (y + 1 == end || here < distance(x, y + 1))
            })
            .filter(|&y| of(x) != of(y) || x.abs_diff(y) > o.exclusion)
            .map(|y| (y, distance(x, y)))
            .collect();
        minima.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut taken: Vec<(usize, f64)> = Vec::new();
        for (y, d) in minima {
            let near = |t: &(usize, f64)| of(t.0) == of(y) && t.0.abs_diff(y) <= o.exclusion;
            if taken.len() < o.neighbours && !taken.iter().any(near) {
                taken.push((y, d));
            }
        }
        taken
    };
    (0..len).map(neighbours).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn the_recurrence_equals_the_double_loop(
        seed in 0u64..1000,
        lengths in prop::collection::vec(1usize..60, 1..4),
        window in 1usize..12,
        exclusion in 0usize..15,
    ) {
        let lengths = [lengths, vec![2]].concat();
        let points = walk(&lengths, seed);
        let options = options(window, exclusion, 3);
        let frames = Frames::new(&points, 2, &lengths).unwrap();
        let found = nontrivial_neighbours(&frames, &options).unwrap();
        let expected = by_double_loop(&points, &lengths, &options);
        for (x, list) in expected.iter().enumerate() {
            let items = |l: &[(usize, f64)]| l.iter().map(|n| n.0).collect::<Vec<_>>();
            prop_assert_eq!(items(found.of(x)), items(list), "item {}", x);
            for (a, b) in found.of(x).iter().zip(list) {
                prop_assert!((a.1 - b.1).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn nontrivial_neighbours_keep_their_distance_in_time(
        seed in 0u64..1000,
        window in 1usize..10,
        exclusion in 1usize..20,
    ) {
        let lengths = [70, 50];
        let frames = Frames::new(&walk(&lengths, seed), 2, &lengths).unwrap();
        let found = nontrivial_neighbours(&frames, &options(window, exclusion, 4)).unwrap();
        let recording = |x: usize| usize::from(x >= 70);
        for x in 0..120 {
            let mut all: Vec<usize> = found.of(x).iter().map(|n| n.0).collect();
            prop_assert!(all.len() <= 4);
            all.push(x);
            for (i, &a) in all.iter().enumerate() {
                for &b in &all[..i] {
                    prop_assert!(recording(a) != recording(b) || a.abs_diff(b) > exclusion);
                }
            }
        }
    }
}

#[test]
fn restarts_keep_long_recordings_exact() {
    let lengths = [700, 300];
    let points = walk(&lengths, 2);
    let options = options(10, 20, 3);
    let frames = Frames::new(&points, 2, &lengths).unwrap();
    let found = nontrivial_neighbours(&frames, &options).unwrap();
    for (x, list) in by_double_loop(&points, &lengths, &options)
        .iter()
        .enumerate()
    {
        for (a, b) in found.of(x).iter().zip(list) {
            assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-9, "{x}: {a:?} {b:?}");
        }
    }
}

#[test]
fn holding_still_adds_no_neighbours() {
    // Five passes of one stroke; then the same with every pass held for 40 frames in its middle.
    let pass = |held: usize| {
        let stroke = (0..60).map(|i| f64::from(i) / 60.0);
        let middle = vec![0.5; held];
        stroke
            .clone()
            .take(30)
            .chain(middle)
            .chain(stroke.skip(30))
            .collect::<Vec<_>>()
    };
    for held in [0, 40] {
        let length = 60 + held;
        let points: Vec<f64> = (0..5).flat_map(|_| pass(held)).collect();
        let frames = Frames::new(&points, 1, &[length; 5]).unwrap();
        let found = nontrivial_neighbours(&frames, &options(5, 10, 8)).unwrap();
        assert_eq!(found.of(30).len(), 4, "held for {held} frames");
    }
}

fn distance(e: &Embedding, i: usize, j: usize) -> f64 {
    let squares = e
        .point(i)
        .iter()
        .zip(e.point(j))
        .map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Spatio-temporal Isomap of one recording of points of the plane.
fn embedded(points: &[f64], c_ctn: f64, dimension: usize) -> Embedding {
    let frames = Frames::new(points, 2, &[points.len() / 2]).unwrap();
    let options = Continuous {
        c_ctn,
        ..options(10, 20, 3)
    };
    let graph = NeighbourGraph::continuous(&frames, &options).unwrap();
    let options = EmbedOptions {
        dimension: Some(dimension),
        ..EmbedOptions::default()
    };
    embed(&graph, &options).unwrap().0
}

#[test]
fn a_figure_eight_becomes_one_loop() {
    let (period, passes) = (100, 6);
    let mut random = Pcg64::seed_from_u64(3);
    let points: Vec<f64> = (0..period * passes)
        .flat_map(|i| {
            let turn = TAU * i as f64 / period as f64;
            let mut near = |v: f64| v + random.random_range(-0.01..0.01);
            [near(turn.sin()), near((2.0 * turn).sin())]
        })
        .collect();
    let e = embedded(&points, 1e3, 2);
    let widest = (0..period)
        .map(|i| distance(&e, 200, 200 + i))
        .fold(0.0, f64::max);
    // The middle passes: at the ends of the recording windows are cut.
    for phase in 0..period {
        let first = 2 * period + phase;
        let gap = distance(&e, first, first + period);
        assert!(gap < 0.05 * widest, "passes apart at {phase}: {gap}");
    }
    // The crossing is met twice, half a period apart: one point of the plane, opposite points of the loop.
    let apart = distance(&e, 200, 250);
    assert!(apart > 0.5 * widest, "{apart} of {widest}");
    // One loop: its phases in order all around the middle, once.
    let angle = |i: usize| f64::atan2(e.point(i)[1], e.point(i)[0]);
    let turns: f64 = (200..300)
        .map(|i| {
            let step = angle(i + 1) - angle(i);
            step - TAU * (step / TAU).round()
        })
        .sum();
    assert!((turns.abs() - TAU).abs() < 0.6, "{turns}");
}

#[test]
fn a_curve_walked_to_and_fro_keeps_both_directions_apart() {
    let (period, passes) = (160, 5);
    let mut random = Pcg64::seed_from_u64(4);
    let points: Vec<f64> = (0..period * passes)
        .flat_map(|i| {
            let turn = TAU * i as f64 / period as f64;
            let along = -turn.cos();
            let mut near = |v: f64| v + random.random_range(-0.01..0.01);
            [near((2.0 * along).sin()), near(along)]
        })
        .collect();
    // Halfway out and halfway back: one place, two directions.
    let (out, back, next_out) = (200, 280, 360);
    let parted = |c_ctn: f64| {
        let e = embedded(&points, c_ctn, 2);
        let widest = (0..period)
            .map(|i| distance(&e, out, out + i))
            .fold(0.0, f64::max);
        (
            distance(&e, out, back) / widest,
            distance(&e, out, next_out) / widest,
        )
    };
    let (directions, passes) = parted(1e3);
    assert!(directions > 0.5, "{directions}");
    assert!(passes < 0.05, "{passes}");
}

#[test]
fn recordings_without_common_movement_are_bridged() {
    // Two strokes far from each other: within the radius no frame of one is like any of the other.
    let mut points: Vec<f64> = (0..80).map(|i| f64::from(i) * 0.01).collect();
    points.extend((0..90).map(|i| 50.0 + f64::from(i) * 0.01));
    let frames = Frames::new(&points, 1, &[80, 90]).unwrap();
    let options = Continuous {
        radius: Some(0.5),
        ..options(5, 10, 2)
    };
    let graph = NeighbourGraph::continuous(&frames, &options).unwrap();
    assert_eq!(graph.components().iter().max(), Some(&1));
    let (embedding, _) = embed(&graph, &EmbedOptions::default()).unwrap();
    let edges = &embedding.synthetic_edges;
    assert_eq!(edges.len(), 1);
    // From the end of the first, whose window is cut to one frame, to the start of the second.
    assert!((edges[0].length - 49.21).abs() < 1e-9, "{edges:?}");
}

#[test]
fn threads_do_not_matter() {
    let lengths = [300, 500, 100];
    let points = walk(&lengths, 7);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let frames = Frames::new(&points, 2, &lengths).unwrap();
            let options = Continuous::at_rate(60.0);
            NeighbourGraph::continuous(&frames, &options)
                .unwrap()
                .edges()
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn broken_input_is_refused() {
    let frames = |points: &[f64], lengths: &[usize]| Frames::new(points, 1, lengths).err();
    let good = Frames::new(&[0.0, 1.0, 2.0], 1, &[3]).unwrap();
    let with = |change: fn(&mut Continuous)| {
        let mut options = Continuous::default();
        change(&mut options);
        NeighbourGraph::continuous(&good, &options).err()
    };
    let results = [
        ("lengths do not add up", frames(&[0.0; 3], &[2])),
        ("an empty recording", frames(&[0.0; 3], &[3, 0])),
        ("one frame", frames(&[0.0], &[1])),
        ("lengths beyond count", frames(&[0.0; 3], &[usize::MAX, 4])),
        ("not finite", frames(&[0.0, f64::INFINITY], &[2])),
        ("no window", with(|o| o.window = 0)),
        ("no neighbours", with(|o| o.neighbours = 0)),
        ("small factor", with(|o| o.c_atn = 0.0)),
    ];
    for (what, error) in results {
        assert!(error.is_some_and(|e| e.is_invalid()), "{what}");
    }
}
