//! Cycles: which sequences are periodic as a whole, one cycle cut from each in step with the others; and
//! exemplars whose structure no warp can change.

use std::f64::consts::TAU;

use kineme::alignment::{Cycle, Mismatch, Registration, cycle, cycles, period};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

mod items;
use items::check;

/// Numbers a frame of the walker: forward and height of the left foot, of the right foot, and the head's height.
const DIMS: usize = 5;

/// A walker at a phase, whose left foot is foremost at phase 0; stride in metres.
fn walker(phase: f64, stride: f64) -> [f64; DIMS] {
    let foot = |p: f64| {
        let lift = (TAU * p).sin().max(0.0);
        (0.5 * stride * (TAU * p).cos(), 0.1 * lift * lift)
    };
    let (left, right) = (foot(phase), foot(phase + 0.5));
    let head = 1.6 + 0.02 * (2.0 * TAU * phase).cos();
    [left.0, left.1, right.0, right.1, head]
}

/// A walk of so many cycles from a phase on, `period` frames each.
fn walk(from: f64, turns: f64, period: f64, stride: f64, noise: f64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64((from * 100.0) as u64);
    (0..=(turns * period) as usize)
        .flat_map(|f| walker(from + f as f64 / period, stride))
        .map(|v| v + noise * random.random_range(-1.0..1.0))
        .collect()
}

/// Left and right exchanged.
fn mirrored(sequence: &[f64]) -> Vec<f64> {
    let swap = |f: &[f64]| [f[2], f[3], f[0], f[1], f[4]];
    sequence.chunks_exact(DIMS).flat_map(swap).collect()
}

/// A hand: raised in 0.3 s, waved so often, lowered; 30 Hz.
fn wave(times: f64) -> Vec<f64> {
    let last = 18.0 + 15.0 * times;
    (0..=last as usize)
        .flat_map(|f| {
            let f = f as f64;
            let raised = (f / 9.0).min((last - f) / 9.0).min(1.0);
            let side = (TAU * (f - 9.0) / 15.0).sin();
            [0.2 * raised * side, 0.9 * raised * raised]
        })
        .collect()
}

fn of_places(frames: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..frames)
        .map(|k| f(k as f64 / (frames - 1) as f64))
        .collect()
}

#[test]
fn whole_periodic_sequences_have_their_period() {
    for (from, turns, frames, rate, noise) in [
        (0.0, 2.0, 30.0, 30.0, 0.0),
        (0.3, 4.5, 33.4, 30.0, 0.01),
        (0.5, 3.2, 101.0, 120.0, 0.01),
        (0.9, 9.7, 22.5, 30.0, 0.0),
        (0.1, 2.3, 140.3, 60.0, 0.0),
    ] {
        let sequence = walk(from, turns, frames, 0.7, noise);
        let found = period(&sequence, DIMS, rate).unwrap().expect("a period");
        // A frame at the rate of comparison holds several of a fast camera.
        assert!(
            (found.frames - frames).abs() < 0.02 * frames,
            "{frames}: {found:?}"
        );
        assert!(
            found.regularity > 0.8 && found.regularity <= 1.0,
            "{found:?}"
        );
    }
    // Getting slower by a tenth on the way is periodic still.
    let slowing = of_places(150, |s| (TAU * (5.0 * s - 0.25 * s * s)).sin());
    assert!(period(&slowing, 1, 30.0).unwrap().is_some());
}

#[test]
fn strokes_and_gestures_with_raising_and_lowering_have_none() {
    let mut random = Pcg64::seed_from_u64(9);
    let rest_between: Vec<f64> = [
        walk(0.0, 1.5, 30.0, 0.7, 0.0),
        vec![0.0; 40 * DIMS],
        walk(0.0, 1.5, 30.0, 0.7, 0.0),
    ]
    .concat();
    for (what, sequence, dims) in [
        ("reach", of_places(60, |s| (0.5 * TAU * s).cos()), 1),
        (
            "out and back",
            of_places(60, |s| (0.5 * TAU * s).sin().powi(2)),
            1,
        ),
        ("two waves", wave(2.0), 2),
        ("six waves", wave(6.0), 2),
        ("fifteen waves", wave(15.0), 2),
        ("one cycle and a half", walk(0.0, 1.6, 40.0, 0.7, 0.0), DIMS),
        ("a rest between", rest_between, DIMS),
        ("still", vec![1.0; 90], 1),
        ("two frames", vec![1.0, 2.0], 1),
        (
            "noise",
            (0..200).map(|_| random.random_range(-1.0..1.0)).collect(),
            2,
        ),
    ] {
        assert_eq!(period(&sequence, dims, 30.0).unwrap(), None, "{what}");
    }
}

/// Phase of the walker at which a cycle begins, when its sequence begins at `from` with cycles of `frames`.
fn begins(cycle: &Cycle, from: f64, frames: f64) -> f64 {
    (from + cycle.frame(0.0) / frames).rem_euclid(1.0)
}

#[test]
fn a_cycle_begins_at_the_event_of_the_reference_whatever_foot_comes_first() {
    let reference = walk(0.0, 1.0, 64.0, 0.7, 0.0);
    for (from, turns, frames) in [
        (0.0, 3.0, 30.0),
        (0.5, 3.0, 30.0),
        (0.27, 5.3, 41.3),
        (0.8, 2.0, 110.0),
        (0.5, 1.0, 40.0),
        (0.2, 1.2, 37.0),
    ] {
        let sequence = walk(from, turns, frames, 0.7, 0.0);
        let found = cycle(&sequence, DIMS, frames, Some(&reference)).unwrap();
        let what = format!("{from} {turns} {frames}: {found:?}");
        let off = (begins(&found, from, frames) + 0.5).rem_euclid(1.0) - 0.5;
        assert!(off.abs() < 0.03, "begins at {off}; {what}");
        assert!((found.frames - frames).abs() < 0.04 * frames, "{what}");
        assert!(
            found.start >= 0.0
                && found.start + found.frames <= (sequence.len() / DIMS - 1) as f64 + 1e-9
        );
        assert!(found.gap < 0.1 && found.cost < 0.05, "{what}");
        // Only a sequence without room for a whole cycle from there is read round its end.
        assert_eq!(found.shift != 0.0, turns < 1.7, "{what}");
        let sampled = found.sample(&sequence, DIMS, 33).unwrap();
        let (first, last) = (&sampled[..DIMS], &sampled[32 * DIMS..]);
        for (a, b) in first.iter().zip(last) {
            check("closed", *a, *b, 1e-12);
        }
        check("left foot foremost", first[0], 0.35, 0.02);
        // Read from the middle on without a reference, the opposite foot is where it is: half a cycle away.
        let opposite = mirrored(&reference);
        let other = cycle(&sequence, DIMS, frames, Some(&opposite)).unwrap();
        let off = (begins(&other, from, frames)).rem_euclid(1.0) - 0.5;
        assert!(off.abs() < 0.03, "opposite begins at {off}; {what}");
    }
}

#[test]
fn a_group_is_cyclic_by_majority_or_by_word_and_its_cycles_are_in_step() {
    let walks: Vec<Vec<f64>> = [(0.0, 2.2), (0.5, 3.0), (0.7, 4.1), (0.33, 2.6), (0.1, 1.2)]
        .iter()
        .enumerate()
        .map(|(i, &(from, turns))| walk(from, turns, 30.0 + i as f64, 0.6 + 0.05 * i as f64, 0.002))
        .collect();
    let views: Vec<&[f64]> = walks.iter().map(Vec::as_slice).collect();
    let rates = [30.0; 5];
    let found = cycles(&views, DIMS, &rates, None).unwrap().expect("cyclic");
    assert_eq!(cycles(&views, DIMS, &rates, Some(false)).unwrap(), None);
    let sampled: Vec<Vec<f64>> = found
        .iter()
        .zip(&views)
        .map(|(c, s)| c.sample(s, DIMS, 64).unwrap())
        .collect();
    let cut: Vec<&[f64]> = sampled.iter().map(Vec::as_slice).collect();
    let settings = Registration {
        cyclic: true,
        ..Registration::default()
    };
    let registered = settings.register(&cut, DIMS).unwrap();
    assert!(
        registered.costs.iter().all(|c| *c < 0.06),
        "{:?}",
        registered.costs
    );
    assert!(
        registered
            .warps
            .iter()
            .all(|w| w.is_closed() && w.slope(0.0) == w.slope(1.0))
    );
    assert_eq!(registered.mean[..DIMS], registered.mean[63 * DIMS..]);
    // The order of the group decides nothing.
    let order = [3, 0, 4, 2, 1];
    let turned: Vec<&[f64]> = order.iter().map(|&i| views[i]).collect();
    let again = cycles(&turned, DIMS, &rates, None)
        .unwrap()
        .expect("cyclic");
    assert!(order.iter().zip(&again).all(|(&i, c)| found[i] == *c));

    let strokes: Vec<Vec<f64>> = (2..7).map(|k| wave(f64::from(k))).collect();
    let views: Vec<&[f64]> = strokes.iter().map(Vec::as_slice).collect();
    assert_eq!(cycles(&views, 2, &rates, None).unwrap(), None);
    // Single cycles that nobody could know to be such, but are told to be.
    let single: Vec<Vec<f64>> = [0.0, 0.4, 0.6]
        .iter()
        .map(|&f| walk(f, 1.0, 30.0, 0.7, 0.0))
        .collect();
    let views: Vec<&[f64]> = single.iter().map(Vec::as_slice).collect();
    assert_eq!(cycles(&views, DIMS, &rates[..3], None).unwrap(), None);
    let told = cycles(&views, DIMS, &rates[..3], Some(true))
        .unwrap()
        .expect("told");
    let begins: Vec<f64> = told
        .iter()
        .zip([0.0, 0.4, 0.6])
        .map(|(c, f)| begins(c, f, 30.0))
        .collect();
    for b in &begins {
        let off = (b - begins[0] + 0.5).rem_euclid(1.0) - 0.5;
        assert!(off.abs() < 0.05, "{begins:?}");
    }
}

#[test]
fn mirrored_and_out_of_step_exemplars_are_told_and_others_are_not() {
    // Strokes of a left hand of several sizes and paces, the right hand still; some mirrored.
    let stroke = |size: f64, pace: f64| -> Vec<f64> {
        (0..40)
            .flat_map(|f| {
                let s = f64::from(f) / 39.0;
                let s = s + pace * s * (1.0 - s);
                let up = (0.5 * TAU * s).sin().powi(2);
                [size * up, size * s, 0.1, 0.02 * up, 1.6]
            })
            .collect()
    };
    let plain: Vec<Vec<f64>> = (0..9)
        .map(|i| stroke(0.4 + 0.03 * f64::from(i), 0.1 * f64::from(i % 4) - 0.2))
        .collect();
    let settings = Registration::default();
    let judged = |sequences: &[Vec<f64>], settings: &Registration| -> Vec<Option<Mismatch>> {
        let mirrors: Vec<Vec<f64>> = sequences.iter().map(|s| mirrored(s)).collect();
        let views: Vec<&[f64]> = sequences.iter().map(Vec::as_slice).collect();
        let mirrors: Vec<&[f64]> = mirrors.iter().map(Vec::as_slice).collect();
        let all = settings.register(&views, DIMS).unwrap();
        let found = settings.structures(&views, &mirrors, &all, DIMS).unwrap();
        found.into_iter().map(|f| f.1).collect()
    };
    assert_eq!(judged(&plain, &settings), [None; 9]);
    for wrong in [vec![4], vec![0, 8], vec![1, 2, 5, 7]] {
        let mut mixed = plain.clone();
        for &i in &wrong {
            mixed[i] = mirrored(&mixed[i]);
        }
        for (i, found) in judged(&mixed, &settings).into_iter().enumerate() {
            let expected = wrong.contains(&i).then_some(Mismatch::Mirrored);
            assert_eq!(found, expected, "{i} of {wrong:?}");
        }
    }
    let mut odd = plain.clone();
    // Both hands downward: its mirror image is no nearer.
    odd[3] = stroke(-0.6, 0.0)
        .chunks_exact(DIMS)
        .flat_map(|f| [f[0], f[1], f[0], f[1], f[4]])
        .collect();
    let found = judged(&odd, &settings);
    assert_eq!(found[3], Some(Mismatch::Outlier));
    assert_eq!(found.iter().flatten().count(), 1);

    // Cycles: a limp makes left and right differ, so that out of step is not mirrored.
    let limping = |from: f64, stride: f64| -> Vec<f64> {
        let mut cycle = walk(from, 1.0, 48.0, stride, 0.0);
        cycle
            .chunks_exact_mut(DIMS)
            .for_each(|f| f[2] = 0.6 * f[2] + 0.1);
        cycle
    };
    let cyclic = Registration {
        cyclic: true,
        ..settings
    };
    let mut gaits: Vec<Vec<f64>> = (0..7)
        .map(|i| limping(0.0, 0.6 + 0.02 * f64::from(i)))
        .collect();
    assert_eq!(judged(&gaits, &cyclic), [None; 7]);
    gaits[2] = limping(0.5, 0.65);
    gaits[5] = mirrored(&limping(0.0, 0.65));
    let found = judged(&gaits, &cyclic);
    assert_eq!(
        (found[2], found[5]),
        (Some(Mismatch::OutOfStep), Some(Mismatch::Mirrored))
    );
    assert_eq!(found.iter().flatten().count(), 2, "{found:?}");
}

#[test]
fn refuses_what_holds_no_cycle() {
    let good = walk(0.0, 2.0, 20.0, 0.7, 0.0);
    for (sequence, dims, period, reference) in [
        (&good[..7], DIMS, 20.0, None),
        (&good[..], 0, 20.0, None),
        (&good[..2 * DIMS], DIMS, 2.0, None),
        (&good[..], DIMS, 1.0, None),
        (&good[..], DIMS, f64::NAN, None),
        (&good[..], DIMS, 20.0, Some(&good[..DIMS])),
        (&good[..], DIMS, 20.0, Some(&good[..3])),
    ] {
        assert!(cycle(sequence, dims, period, reference).is_err_and(|e| e.is_invalid()));
    }
    assert!(period(&good, DIMS, 0.0).is_err() && period(&[f64::NAN], 1, 30.0).is_err());
    assert!(cycles(&[&good], DIMS, &[], None).is_err());
    assert_eq!(cycles(&[], DIMS, &[], Some(true)).unwrap(), None);
    let found = cycle(&good, DIMS, 20.0, None).unwrap();
    assert!(found.sample(&good, DIMS, 1).is_err());
    assert!(found.sample(&good[..3 * DIMS], DIMS, 9).is_err());
    // A period longer than the sequence is the sequence.
    assert!(cycle(&good[..9 * DIMS], DIMS, 50.0, None).unwrap().frames <= 8.0);
    let views = [&good[..]];
    let settings = Registration::default();
    let all = settings.register(&views, DIMS).unwrap();
    assert!(settings.structures(&views, &[], &all, DIMS).is_err());
}
