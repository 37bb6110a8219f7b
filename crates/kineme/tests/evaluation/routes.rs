//! Movements of one posture that lead to different places.

use std::collections::BTreeMap;
use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::evaluation::{NearestDtw, NearestDtwSettings};
use kineme::perception::{Filter, FilterSettings};
use kineme::primitive::{Observations, Recogniser};
use kineme::{Motion, Role, Root, Skeleton, Transitions, Vocabulary, adonis};
use nalgebra::Vector3;

use crate::learned;

const KINDS: [(&str, f64); 3] = [("left", 1.5), ("right", -1.5), ("ahead", 0.0)];

/// An arm is raised and lowered while the body goes 2 m and turns so far in all.
fn led(body: &Arc<Skeleton>, height: f64, turn: f64, secs: f64) -> Motion {
    let key = |time: f64, angle: f64| Key {
        time,
        angles: BTreeMap::from([(Role::RightUpperArm, vec![angle])]),
    };
    let keys = [key(0.0, 5.0), key(0.5 * secs, height), key(secs, 5.0)];
    let motion = perform("led", &keys, body, 60.0).expect("a motion");
    let frames = motion.frames();
    let mut position = Vector3::new(0.0, 0.0, 1.0);
    let step = 2.0 / frames as f64;
    let roots = (0..frames).map(|f| {
        let yaw = turn * f as f64 / (frames - 1) as f64;
        position += step * Vector3::new(yaw.cos(), yaw.sin(), 0.0);
        Root { position, yaw }
    });
    let (poses, roots) = (motion.poses().to_vec(), roots.collect());
    Motion::new("led", Arc::clone(body), 60.0, poses, roots).expect("a motion")
}

fn vocabulary(body: &Arc<Skeleton>) -> Vocabulary {
    let primitives = KINDS.map(|(name, turn)| {
        let of = |k: f64| led(body, 60.0 + 10.0 * k, turn + 0.1 * k, 1.2 + 0.1 * k);
        learned(name, (0..4).map(|k| of(f64::from(k))))
    });
    let (primitives, none) = (primitives.to_vec(), Transitions::none(3));
    let vocabulary = Vocabulary::new(Arc::clone(body), primitives, vec![], none).expect("three");
    let learned = Filter::calibration(&vocabulary, &[None, None, None]).expect("learned");
    vocabulary.calibrated(learned).expect("calibrated")
}

#[test]
fn what_differs_by_its_route_alone_is_told_apart() {
    let body = Arc::new(adonis().expect("a body"));
    let vocabulary = vocabulary(&body);
    let filter = Filter::new(&vocabulary, &FilterSettings::default()).expect("a filter");
    let told_routes = NearestDtwSettings {
        route: true,
        ..NearestDtwSettings::default()
    };
    let routed = NearestDtw::new(&vocabulary, &told_routes).expect("a baseline");
    let blind = NearestDtw::new(&vocabulary, &NearestDtwSettings::default()).expect("a baseline");
    for (k, (name, turn)) in KINDS.into_iter().enumerate() {
        for (height, secs) in [(65.0, 1.25), (85.0, 1.5)] {
            let seen = Observations::complete(led(&body, height, turn + 0.15, secs));
            let told = |recogniser: &dyn Recogniser| {
                let told = recogniser.recognise(&seen).expect("an answer");
                told.posterior.primitives
            };
            let case = format!("{name} at {height}");
            for recogniser in [&filter as &dyn Recogniser, &routed] {
                let p = told(recogniser);
                assert!(
                    (0..3).all(|other| other == k || p[k] > p[other]),
                    "{case}: {p:?}"
                );
            }
            let p = told(&filter);
            assert!(p[k] > 0.5, "{case}: {p:?}");
            let alike = told(&blind);
            assert!((alike[0] - alike[1]).abs() < 0.2, "{case}: {alike:?}");
        }
    }
}
