//! The choice of a segmenter, its settings, and wanted durations.

use std::f64::consts::TAU;

use kineme::segmentation::changepoint::{self, ChangePoint};
use kineme::segmentation::pendulum::{self, Limb, Pendulum};
use kineme::segmentation::zfunction::{self, Threshold, ZFunction};
use kineme::segmentation::{Segmenter, Signal, Span, Views, duration};

use crate::changepoint::wandering;
use crate::{RATE, chain, check_cover, limb, noise, sampled};

#[test]
fn a_wanted_duration_is_reached() {
    // Strokes of half a second with a smaller, faster beat upon them.
    let values = sampled(16.0, RATE, |t| {
        chain(0.7 * (TAU * t).sin() + 0.25 * (TAU * 2.9 * t).sin())
    });
    let bob = [limb(&values, 3)];
    let short = duration::pendulum(&bob, &Pendulum::default(), 0.2).unwrap();
    let long = duration::pendulum(&bob, &Pendulum::default(), 0.5).unwrap();
    assert!(
        (short.median_secs.unwrap() / 0.2).ln().abs() < 0.3,
        "{:?}",
        short.median_secs
    );
    assert!(
        (long.median_secs.unwrap() / 0.5).ln().abs() < 0.1,
        "{:?}",
        long.median_secs
    );
    assert!(long.scale > short.scale);

    let features = wandering(2000, 3, 0.08, 5);
    let features = Signal::new(&features, 3, 100.0).unwrap();
    for target in [0.25, 0.5, 1.0, 2.0] {
        let got = duration::changepoint(&features, &ChangePoint::default(), target).unwrap();
        check_cover(&got.spans, 2000);
        let reached = got.median_secs.unwrap();
        assert!(
            (reached / target).ln().abs() < 0.3,
            "{reached} for {target}"
        );
    }

    // Bumps of activity of one second whose width depends on the threshold.
    let angles = sampled(20.0, RATE, |t| [t + 0.9 * (TAU * t).sin() / TAU]);
    let angles = Signal::new(&angles, 1, RATE).unwrap();
    for target in [0.45, 0.6] {
        let got = duration::zfunction(&angles, &[], &ZFunction::default(), target).unwrap();
        let reached = got.median_secs.unwrap();
        assert!(
            (reached / target).ln().abs() < 0.15,
            "{reached} for {target}"
        );
    }
    // What cannot be reached is told.
    let still = vec![0.0; 300];
    let still = Signal::new(&still, 1, RATE).unwrap();
    let none = duration::zfunction(&still, &[], &ZFunction::default(), 0.5).unwrap();
    assert_eq!(none.median_secs, None);
    assert_eq!(none.spans, [Span::rest(0, 300)]);
}

#[test]
fn a_segmenter_takes_the_view_that_it_needs() {
    let values = sampled(4.0, RATE, |t| chain(0.6 * (TAU * t).sin()));
    let frames = values.len() / 3;
    let limbs = [limb(&values, 3)];
    let signal = limbs[0].bob;
    let views = Views {
        limbs: &limbs,
        angles: Some(signal),
        features: Some(signal),
        ..Views::new(frames, RATE)
    };
    for name in ["pendulum", "zfunction", "changepoint", "clips"] {
        let segmenter = Segmenter::named(name).unwrap();
        assert_eq!(segmenter.name(), name);
        let got = segmenter.segment(&views, None).unwrap();
        check_cover(&got.spans, frames);
        assert_eq!(got.scale, 1.0);
        let empty = segmenter.segment(&Views::new(frames, RATE), None);
        assert_eq!(empty.is_err(), name != "clips");
        let other = Views {
            frames: frames + 1,
            ..views
        };
        assert_eq!(segmenter.segment(&other, None).is_err(), name != "clips");
        if name != "clips" {
            assert!(segmenter.segment(&views, Some(0.0)).is_err(), "{name}");
            assert!(
                segmenter
                    .segment(&views, Some(0.4))
                    .unwrap()
                    .median_secs
                    .is_some()
            );
        }
    }
    assert_eq!(Segmenter::default().name(), "pendulum");
    assert!(Segmenter::named("pendulums").unwrap_err().is_unknown_name());
}

#[test]
fn settings_out_of_range_are_refused() {
    let values = noise(60, 2);
    let signal = Signal::new(&values, 2, RATE).unwrap();
    let limb = Limb {
        bob: signal,
        length: 1.0,
    };
    let p = Pendulum::default();
    let bad_length = Limb {
        length: 0.0,
        ..limb
    };
    assert!(pendulum::segment(&[], &p).is_err());
    assert!(pendulum::segment(&[bad_length], &p).is_err());
    for bad in [
        Pendulum {
            min_swing: 0.0,
            ..p
        },
        Pendulum { fall: -1.0, ..p },
        Pendulum {
            fall_share: 1.0,
            ..p
        },
        Pendulum {
            min_secs: f64::NAN,
            ..p
        },
        Pendulum {
            rest_secs: -1.0,
            ..p
        },
    ] {
        assert!(pendulum::segment(&[limb], &bad).is_err(), "{bad:?}");
    }
    // Durations beyond all measure are odd but no error: nothing is that long.
    let endless = Pendulum {
        min_secs: 1e300,
        rest_secs: 1e300,
        merge_secs: 1e300,
        smooth_secs: 1e300,
        ..p
    };
    assert_eq!(
        pendulum::segment(&[limb], &endless).unwrap(),
        [Span::rest(0, 30)]
    );
    let endless = ChangePoint {
        min_secs: 1e300,
        ..ChangePoint::default()
    };
    assert_eq!(
        changepoint::segment(&signal, &endless).unwrap(),
        [Span::movement(0, 30)]
    );
    let z = ZFunction::default();
    for bad in [
        ZFunction {
            threshold: Threshold::Share(0.0),
            ..z
        },
        ZFunction {
            off_share: 1.5,
            ..z
        },
        ZFunction { max_secs: 0.1, ..z },
        ZFunction {
            smooth_secs: -0.1,
            ..z
        },
    ] {
        assert!(zfunction::segment(&signal, &[], &bad).is_err(), "{bad:?}");
    }
    assert!(zfunction::segment(&signal, &[1.0], &z).is_err());
    assert!(zfunction::segment(&signal, &[1.0, -1.0], &z).is_err());
    let c = ChangePoint {
        penalty: 0.0,
        ..ChangePoint::default()
    };
    assert!(changepoint::segment(&signal, &c).is_err());
    for (values, dims, rate_hz) in [
        (vec![], 1, 1.0),
        (vec![1.0], 0, 1.0),
        (vec![1.0; 3], 2, 1.0),
        (vec![1.0], 1, 0.0),
        (vec![f64::INFINITY], 1, 1.0),
    ] {
        assert!(Signal::new(&values, dims, rate_hz).is_err());
    }
}
