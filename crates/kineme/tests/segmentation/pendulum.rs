//! Swings of analytic chains.

use std::f64::consts::{PI, TAU};

use kineme::segmentation::pendulum::{self, Limb, Pendulum};
use kineme::segmentation::{Signal, Span, SpanKind, movements};

use crate::{RATE, chain, check_cover, check_cuts, limb, sampled};

fn swings(values: &[f64], dims: usize) -> Vec<Span> {
    pendulum::segment(&[limb(values, dims)], &Pendulum::default()).unwrap()
}

#[test]
fn pendulum_cuts_at_the_reversals_of_a_chain() {
    // Reversals at the extremes of the sine: a quarter period in, then every half.
    for (amplitude, period) in [(0.5, 1.0), (0.9, 0.8), (0.3, 0.65), (1.2, 1.7)] {
        let values = sampled(4.0 * period, RATE, |t| {
            chain(amplitude * (TAU * t / period).sin())
        });
        let expected: Vec<f64> = (0..8).map(|k| period * (0.25 + 0.5 * k as f64)).collect();
        let spans = swings(&values, 3);
        check_cover(&spans, values.len() / 3);
        check_cuts(&spans, values.len() / 3, &expected);
    }
}

#[test]
fn pendulum_finds_reversals_to_a_fraction_of_a_frame() {
    let period = 1.013;
    let values = sampled(3.0, RATE, |t| chain(0.6 * (TAU * t / period).sin()));
    let cuts = pendulum::cuts(&[limb(&values, 3)], &Pendulum::default()).unwrap();
    assert!(cuts.len() >= 5);
    for (k, cut) in cuts.iter().enumerate() {
        let expected = RATE * period * (0.25 + 0.5 * k as f64);
        assert!(
            (cut.time_frames - expected).abs() < 0.3,
            "{cut:?} for {expected}"
        );
        assert!(cut.frame.abs_diff(expected.round() as usize) <= 1);
        assert!(cut.swing > 0.1);
    }
}

/// Strokes of a second, each on in the same direction so that the distance from a start only grows, and holds.
fn held(hold_secs: f64) -> Vec<f64> {
    let cycle = 1.0 + hold_secs;
    sampled(4.0 * cycle, RATE, |t| {
        let (step, inside) = ((t / cycle).floor(), (t % cycle).min(1.0));
        let x = step + 0.5 * (1.0 - (PI * inside).cos());
        [0.8 * x, 0.1 * x, 0.0]
    })
}

#[test]
fn a_hold_is_a_rest_between_two_movements() {
    let values = held(1.0);
    let frames = values.len() / 3;
    let spans = swings(&values, 3);
    check_cover(&spans, frames);
    assert_eq!(movements(&spans).count(), 4, "{spans:?}");
    let rests: Vec<&Span> = spans.iter().filter(|s| s.kind == SpanKind::Rest).collect();
    for (k, rest) in rests.iter().filter(|r| r.start > 20).enumerate() {
        // The second half of each cycle of two seconds, and the slow ends of the strokes around it.
        let middle = (rest.start + rest.end) as f64 / 2.0 / RATE;
        let expected = 2.0 * k as f64 + 1.5;
        if rest.end < frames {
            assert!((middle - expected).abs() < 0.05, "{middle} for {expected}");
        }
        assert!(rest.len() as f64 / RATE >= 0.9);
    }
    assert!(movements(&spans).all(|s| (0.6..1.05).contains(&(s.len() as f64 / RATE))));
    // Without splitting at rests all four would be one.
    let no_rests = Pendulum {
        rest_speed: 0.0,
        ..Pendulum::default()
    };
    let one = pendulum::segment(&[limb(&values, 3)], &no_rests).unwrap();
    assert_eq!(one, [Span::movement(0, frames)]);
}

#[test]
fn a_short_pause_at_the_turn_is_cut_in_its_middle() {
    // 0.2 s at the extreme: too short for a rest.
    let values = sampled(1.2, RATE, |t| {
        let phase = if t < 0.5 { t } else { (t - 0.2).max(0.5) };
        chain(-0.6 * (TAU * phase).cos())
    });
    // The bob is slow for longer than it stands, so ask for a longer rest.
    let config = Pendulum {
        rest_secs: 0.6,
        ..Pendulum::default()
    };
    let spans = pendulum::segment(&[limb(&values, 3)], &config).unwrap();
    check_cuts(&spans, values.len() / 3, &[0.6]);
}

#[test]
fn what_stands_still_or_fidgets_is_one_rest() {
    let still = sampled(2.0, RATE, |_| [0.3, 0.1]);
    let fidget = sampled(2.0, RATE, |t| [0.04 * (TAU * 3.0 * t).sin(), 0.0]);
    for values in [still, fidget] {
        assert_eq!(swings(&values, 2), [Span::rest(0, values.len() / 2)]);
    }
    assert_eq!(swings(&[1.0, 2.0], 2), [Span::rest(0, 1)], "a single frame");
}

#[test]
fn a_circle_falls_into_halves() {
    let values = sampled(4.0, RATE, |t| [0.4 * (PI * t).cos(), 0.4 * (PI * t).sin()]);
    // Two seconds a turn; the last half has no successor to confirm its end.
    check_cuts(&swings(&values, 2), values.len() / 2, &[1.0, 2.0, 3.0]);
}

#[test]
fn pendulum_ignores_where_the_limb_is_how_it_is_turned_and_its_units() {
    let values = sampled(5.0, RATE, |t| {
        chain(0.7 * (TAU * t).sin() + 0.3 * (TAU * 0.37 * t).sin())
    });
    let expected = swings(&values, 3);
    assert!(expected.len() > 6);
    let turn = kineme::math::rotation::exp(&nalgebra::Vector3::new(0.3, -1.1, 0.7));
    let moved: Vec<f64> = values
        .chunks(3)
        .flat_map(|p| {
            let v = turn * nalgebra::Vector3::from_row_slice(p)
                + nalgebra::Vector3::new(9.0, -4.0, 2.0);
            [v.x, v.y, v.z]
        })
        .collect();
    assert_eq!(swings(&moved, 3), expected);
    let inches: Vec<f64> = values.iter().map(|v| v / 0.0254).collect();
    let long = Limb {
        bob: Signal::new(&inches, 3, RATE).unwrap(),
        length: 1.0 / 0.0254,
    };
    assert_eq!(
        pendulum::segment(&[long], &Pendulum::default()).unwrap(),
        expected
    );
}

#[test]
fn a_recoil_belongs_to_its_swing() {
    // A stroke of one limb length and back again by 0.08: too little for a swing of its own, or 0.3: enough.
    for (recoil, count) in [(0.08, 1), (0.3, 2)] {
        let values = sampled(1.3, RATE, |t| {
            let ease = |u: f64| 0.5 * (1.0 - (PI * u.clamp(0.0, 1.0)).cos());
            [ease(t) - recoil * ease((t - 1.0) / 0.3)]
        });
        let config = Pendulum {
            rest_secs: 1.0,
            ..Pendulum::default()
        };
        let spans = pendulum::segment(&[limb(&values, 1)], &config).unwrap();
        assert_eq!(movements(&spans).count(), count, "{recoil}: {spans:?}");
    }
}

#[test]
fn of_two_cuts_too_near_the_lesser_one_goes() {
    // Up by 1, down by 0.2 within a tenth of a second, up by 0.6, and down at leisure.
    let places = [(0.0, 0.0), (0.5, 1.0), (0.6, 0.8), (0.9, 1.4), (1.5, 0.0)];
    let values = sampled(1.5, RATE, |t| {
        let k = places.partition_point(|p| p.0 <= t).min(4);
        let ((t0, x0), (t1, x1)) = (places[k - 1], places[k]);
        [x0 + (x1 - x0) * 0.5 * (1.0 - (PI * (t - t0) / (t1 - t0)).cos())]
    });
    let config = Pendulum {
        rest_secs: 1.0,
        smooth_secs: 0.0,
        ..Pendulum::default()
    };
    let spans = |min_secs| {
        pendulum::segment(&[limb(&values, 1)], &Pendulum { min_secs, ..config }).unwrap()
    };
    check_cuts(&spans(0.05), values.len(), &[0.5, 0.6, 0.9]);
    check_cuts(&spans(0.15), values.len(), &[0.5, 0.9]);
}

#[test]
fn cuts_of_limbs_near_in_time_become_one() {
    let swing = |delay: f64| sampled(4.0, RATE, move |t| chain(0.6 * (TAU * (t - delay)).sin()));
    let first = swing(0.0);
    for (delay, merged) in [(0.05, true), (0.2, false)] {
        let second = swing(delay);
        let limbs = [limb(&first, 3), limb(&second, 3)];
        let cuts = pendulum::cuts(&limbs, &Pendulum::default()).unwrap();
        let spans = pendulum::segment(&limbs, &Pendulum::default()).unwrap();
        check_cover(&spans, first.len() / 3);
        assert_eq!(spans.len(), cuts.len() + 1);
        if merged {
            assert!((7..=9).contains(&cuts.len()), "{cuts:?}");
            let between = RATE * (0.25 + 0.5 * delay);
            assert!(
                (cuts[0].time_frames - between).abs() <= 1.5,
                "{:?}",
                cuts[0]
            );
        } else {
            assert!(cuts.len() >= 14, "{cuts:?}");
            assert!(cuts.iter().any(|c| c.limb == 0) && cuts.iter().any(|c| c.limb == 1));
        }
    }
}

#[test]
fn a_limb_at_rest_is_no_rest_while_another_moves() {
    let moving = sampled(4.0, RATE, |t| chain(0.6 * (TAU * t).sin()));
    let still = sampled(4.0, RATE, |_| chain(0.2));
    let config = Pendulum::default();
    let both = pendulum::segment(&[limb(&still, 3), limb(&moving, 3)], &config).unwrap();
    assert_eq!(both, swings(&moving, 3));
}
