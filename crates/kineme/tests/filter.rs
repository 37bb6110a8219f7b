//! Laws of the filter at work on a stream.

#[path = "control/vocabulary.rs"]
#[allow(dead_code, reason = "every test uses its part")]
mod vocabulary;

use std::collections::BTreeMap;
use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::perception::{Filter, FilterSettings};
use kineme::primitive::{Observations, Posterior, readings};
use kineme::{Exemplar, Modelling, Motion, Primitive, Role, Root, Skeleton, Vocabulary};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use vocabulary::{of_adonis, vocabulary_of};

fn posteriors(vocabulary: &Vocabulary, seen: &Motion) -> Vec<Posterior> {
    let filter = Filter::new(vocabulary, &FilterSettings::default()).expect("a filter");
    let answers = readings(&filter, &Observations::complete(seen.clone())).expect("readings");
    answers.into_iter().map(|a| a.posterior).collect()
}

fn motion(body: &Arc<Skeleton>, rate_hz: f64, poses: Vec<f64>) -> Motion {
    let roots = vec![Root::ORIGIN; poses.len() / body.dof()];
    Motion::new("seen", Arc::clone(body), rate_hz, poses, roots).expect("a motion")
}

/// A primitive carried out at this rate, with a second of standing still before and after it.
fn carried_out(primitive: &Primitive, p: &[f64], rate_hz: f64) -> Motion {
    let course = primitive.at(p).expect("parameters");
    let secs = course.duration_secs();
    let frames = ((2.0 + secs) * rate_hz) as usize;
    let at = |f: usize| course.phase_at((f as f64 / rate_hz - 1.0).clamp(0.0, secs));
    let poses = (0..frames).flat_map(|f| course.pose(at(f))).collect();
    motion(primitive.body(), rate_hz, poses)
}

#[test]
fn what_is_believed_is_a_distribution_whatever_the_order_of_primitives() {
    let vocabulary = vocabulary_of(of_adonis());
    let others: Vec<Primitive> = of_adonis().iter().rev().cloned().collect();
    let turned = vocabulary_of(&others);
    let seen = carried_out(&of_adonis()[0], &[0.3], 60.0);
    let pairs = posteriors(&vocabulary, &seen);
    for (one, other) in pairs.iter().zip(&posteriors(&turned, &seen)) {
        let all = [one.rest, one.none];
        let all = all.iter().chain(&one.primitives);
        assert!(all.clone().all(|p| (0.0..=1.0).contains(p)), "{one:?}");
        assert!((all.sum::<f64>() - 1.0).abs() < 1e-9, "{one:?}");
        let pairs = one.primitives.iter().zip(other.primitives.iter().rev());
        assert!(
            pairs.clone().all(|(a, b)| (a - b).abs() < 1e-9),
            "{one:?} {other:?}"
        );
    }
}

#[test]
fn who_stands_where_a_movement_begins_has_not_begun_it() {
    let vocabulary = vocabulary_of(&of_adonis()[..3]);
    for primitive in vocabulary.primitives() {
        for rate_hz in [30.0, 60.0, 120.0] {
            let seen = carried_out(primitive, &[0.4], rate_hz);
            let believed = posteriors(&vocabulary, &seen);
            // The first looks know no displacement.
            for (f, p) in believed.iter().enumerate().take(rate_hz as usize) {
                let begun: f64 = p.primitives.iter().sum();
                let secs = f as f64 / rate_hz;
                assert!(
                    secs < 0.1 || begun < 0.1,
                    "{} at {rate_hz} Hz, {secs} s: {p:?}",
                    primitive.name()
                );
            }
        }
    }
}

/// The same motion with even noise on every joint, of this standard deviation.
fn jittering(seen: &Motion, deg: f64, random: &mut Pcg64) -> Motion {
    let most = 3f64.sqrt() * deg.to_radians();
    let mut noisy = |v: &f64| v + most * random.random_range(-1.0..1.0);
    let poses = seen.poses().iter().map(&mut noisy).collect();
    motion(seen.skeleton(), seen.rate_hz(), poses)
}

#[test]
fn what_jitters_is_found_and_who_stands_and_jitters_is_seldom_taken_for_moving() {
    let vocabulary = vocabulary_of(&of_adonis()[..3]);
    let mut random = Pcg64::seed_from_u64(6);
    // Degrees on every joint, and shares of the moving frames that are found and of the standing ones that are taken for
    // movement.
    for (deg, least, most) in [(0.0, 0.95, 0.01), (1.0, 0.85, 0.04), (2.0, 0.78, 0.05)] {
        let (mut found, mut moving, mut alarmed, mut standing) = (0, 0, 0, 0);
        for (k, primitive) in vocabulary.primitives().iter().enumerate() {
            let seen = carried_out(primitive, &[0.4], 120.0);
            let seen = jittering(&seen, deg, &mut random);
            for (f, p) in posteriors(&vocabulary, &seen).iter().enumerate() {
                // The first looks know no displacement, and what ends is heard a little late.
                let last = seen.frames() - 120;
                if (120..last).contains(&f) {
                    moving += 1;
                    found += usize::from(p.primitives[k] > 0.5);
                } else if (24..120).contains(&f) || f >= last + 24 {
                    standing += 1;
                    alarmed += usize::from(p.primitives.iter().any(|p| *p > 0.5));
                }
            }
        }
        let found = found as f64 / moving as f64;
        let alarmed = alarmed as f64 / standing as f64;
        assert!(found >= least, "{deg} degrees: found {found}");
        assert!(alarmed <= most, "{deg} degrees: alarmed {alarmed}");
    }
}

/// Somebody raises the left arm to the side and lets it sink, each in a way of his own.
fn somebody(body: &Arc<Skeleton>, random: &mut Pcg64) -> Motion {
    let mut own = |usual: f64, by: f64| usual + by * random.random_range(-1.0..1.0);
    let (height, before, elbow, secs) = (
        own(95.0, 12.0),
        own(10.0, 12.0),
        own(25.0, 12.0),
        own(1.6, 0.3),
    );
    let key = |share: f64, side: f64, elbow: f64| Key {
        time: share * secs,
        angles: BTreeMap::from([
            (Role::LeftUpperArm, vec![before, side, 0.0]),
            (Role::LeftLowerArm, vec![elbow]),
        ]),
    };
    let keys = [
        key(0.0, 10.0, elbow),
        key(0.5, height, 0.5 * elbow),
        key(1.0, 10.0, elbow),
    ];
    perform("raising", &keys, body, 60.0).expect("keys")
}

#[test]
fn people_beside_written_primitives_are_heard_though_they_move_evenly() {
    let written = &of_adonis()[..2];
    let body = Arc::clone(written[0].body());
    let mut random = Pcg64::seed_from_u64(5);
    let exemplars = (0..8).map(|_| Exemplar::whole(somebody(&body, &mut random), None));
    let people = Primitive::learn("raising", exemplars.collect(), &Modelling::default());
    let people = people.expect("a primitive");
    let mixed = vocabulary_of(&[&[people], written].concat());
    let (mut heard, mut all) = (0, 0);
    for _ in 0..6 {
        let seen = somebody(&body, &mut random);
        for p in posteriors(&mixed, &seen) {
            all += 1;
            heard += usize::from(p.best() == Some(0));
        }
    }
    assert!(2 * heard > all, "{heard} of {all}");
}
