//! Laws of recognising what a part of the body does.

#[path = "control/vocabulary.rs"]
#[allow(dead_code, reason = "every test uses its part")]
mod vocabulary;

use std::sync::Arc;

use kineme::perception::{Filter, FilterSettings, Frame, FrameSettings, Restriction};
use kineme::primitive::{Observations, Reading, Recogniser, readings};
use kineme::skeleton::{JointSet, PARTS};
use kineme::{Motion, Root, Skeleton, Vocabulary};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use vocabulary::{course, of_adonis, of_ares, posture, vocabulary_of};

const RATE_HZ: f64 = 60.0;
/// When movements begin, seconds.
const BEGINS: [f64; 2] = [0.6, 0.9];

/// Reach and wave with the right arm, raise the left one.
fn arms() -> Vocabulary {
    vocabulary_of(&of_adonis()[..3])
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|n| n.to_string()).collect()
}

fn restricted(vocabulary: &Vocabulary, parts: &[&str]) -> Restriction {
    let made = Restriction::new(vocabulary, &names(parts)).expect("a restriction");
    made.calibrated().expect("calibrated")
}

fn read(restriction: &Restriction, seen: &Observations) -> Vec<Reading> {
    let filter = Filter::new(restriction.vocabulary(), &FilterSettings::default());
    let whole = restriction.recogniser(Box::new(filter.expect("a filter")));
    readings(&whole, seen).expect("readings")
}

/// A motion of joints that follow primitives, each from its time on and still before and after; the others are neutral.
fn superposed(vocabulary: &Vocabulary, moved: &[(&str, &str, f64)]) -> Motion {
    let body = vocabulary.body();
    let frames = 160;
    let mut poses = body.neutral().repeat(frames);
    for (name, part, begins) in moved {
        let primitive = vocabulary.primitive(name).expect("a primitive");
        let course = course(primitive, 0.4);
        let joints = JointSet::named(body, &names(&[part])).expect("a part");
        for (f, pose) in poses.chunks_mut(body.dof()).enumerate() {
            let secs = f as f64 / RATE_HZ - begins;
            let phase = course.phase_at(secs.clamp(0.0, course.duration_secs()));
            let whole = course.pose(phase);
            for j in (0..body.joints().len()).filter(|&j| joints.holds(j)) {
                let own = body.coordinates(j);
                pose[own.clone()].copy_from_slice(&whole[own]);
            }
        }
    }
    motion(body, poses)
}

fn motion(body: &Arc<Skeleton>, poses: Vec<f64>) -> Motion {
    let frames = poses.len() / body.dof();
    Motion::new(
        "seen",
        Arc::clone(body),
        RATE_HZ,
        poses,
        vec![Root::ORIGIN; frames],
    )
    .expect("a motion")
}

#[test]
fn of_two_movements_at_a_time_each_is_read_by_its_part() {
    let vocabulary = arms();
    let moved = [
        ("wave", "right_arm", BEGINS[0]),
        ("raise", "left_arm", BEGINS[1]),
    ];
    let seen = Observations::complete(superposed(&vocabulary, &moved));
    for (name, part, begins) in moved {
        let restriction = restricted(&vocabulary, &[part]);
        let known = restriction.vocabulary();
        let lasts = course(known.primitive(name).expect("kept"), 0.4).duration_secs();
        let read = read(&restriction, &seen);
        let (mut under_way, mut right) = (0, 0);
        for (f, reading) in read.iter().enumerate() {
            let secs = f as f64 / RATE_HZ - begins;
            let best = reading
                .posterior
                .best()
                .map(|k| known.primitives()[k].name());
            // A slow beginning and a slow end are as good as rest.
            if secs > 0.15 && secs < lasts - 0.1 {
                under_way += 1;
                right += usize::from(best == Some(name));
                if let (Some(place), true) = (&reading.place, secs > 0.3) {
                    assert!(
                        (place.parameters[0] - 0.4).abs() < 0.15,
                        "{part} {secs}: {place:?}"
                    );
                }
            } else if !(-0.05..lasts + 0.1).contains(&secs) {
                assert!(best.is_none(), "{part} stands still at {secs}: {best:?}");
            }
        }
        assert!(
            10 * right >= 9 * under_way,
            "{name}: {right} of {under_way}"
        );
    }
}

#[test]
fn what_the_rest_of_the_body_does_changes_nothing() {
    let vocabulary = arms();
    let body = vocabulary.body();
    let plain = superposed(&vocabulary, &[("wave", "right_arm", BEGINS[0])]);
    let arm = JointSet::named(body, &names(&["right_arm"])).expect("a part");
    let mut random = Pcg64::seed_from_u64(3);
    let mut poses = Vec::new();
    for f in 0..plain.frames() {
        let mut pose = posture(body, &mut random);
        for j in (0..body.joints().len()).filter(|&j| arm.holds(j)) {
            pose[body.coordinates(j)].copy_from_slice(&plain.pose(f)[body.coordinates(j)]);
        }
        poses.extend(pose);
    }
    let others = (0..body.joints().len()).map(|j| !arm.holds(j));
    let unseen: Vec<bool> = others.collect::<Vec<_>>().repeat(plain.frames());
    let wild = motion(body, poses);
    let restriction = restricted(&vocabulary, &["right_arm"]);
    let frame = Frame::new(restriction.vocabulary(), &FrameSettings::default()).expect("frame");
    let frame = restriction.recogniser(Box::new(frame));
    let filter = Filter::new(restriction.vocabulary(), &FilterSettings::default());
    let filter = restriction.recogniser(Box::new(filter.expect("a filter")));
    let plain = Observations::complete(plain);
    let others = [
        Observations::complete(wild.clone()),
        Observations::with_missing(wild, unseen).expect("flags"),
    ];
    for recogniser in [&filter as &dyn Recogniser, &frame] {
        let expected = readings(recogniser, &plain).expect("readings");
        let whole = recogniser.recognise(&plain).expect("an answer");
        let wave = recogniser
            .vocabulary()
            .primitives()
            .iter()
            .position(|p| p.name() == "wave");
        assert!(whole.spans.iter().any(|s| s.primitive == wave), "{whole:?}");
        for other in &others {
            assert_eq!(readings(recogniser, other).expect("readings"), expected);
            assert_eq!(recogniser.recognise(other).expect("an answer"), whole);
        }
    }
}

#[test]
fn restricted_to_the_whole_body_everything_is_as_it_was() {
    for primitives in [of_adonis(), of_ares()] {
        let vocabulary = vocabulary_of(primitives);
        let body = vocabulary.body();
        let restriction = Restriction::new(&vocabulary, &names(&PARTS)).expect("a restriction");
        assert_eq!(restriction.vocabulary(), &vocabulary, "{}", body.name());
        let walk = &vocabulary.primitive("walk").expect("walk").exemplars()[0].motion;
        assert_eq!(&restriction.motion(walk).expect("of the body"), walk);
    }
}

#[test]
fn a_part_keeps_its_own_movement_phase_and_parameters() {
    let vocabulary = vocabulary_of(of_ares());
    let body = vocabulary.body();
    let restriction = Restriction::new(&vocabulary, &names(&["right_arm"])).expect("a part");
    let arm = JointSet::named(body, &names(&["right_arm"])).expect("a part");
    let neutral = body.neutral();
    let shown: Vec<&str> = restriction
        .vocabulary()
        .primitives()
        .iter()
        .map(|p| p.name())
        .collect();
    assert_eq!(
        shown,
        ["reach", "wave", "walk"],
        "the left arm alone is raised"
    );
    for part in restriction.vocabulary().primitives() {
        let whole = vocabulary.primitive(part.name()).expect("the whole");
        assert_eq!(part.parameters(), whole.parameters());
        for phase in [0.0, 0.3, 0.8] {
            let (own, of) = (part.sample(&[0.3], phase), whole.sample(&[0.3], phase));
            let (own, of) = (own.expect("a posture"), of.expect("a posture"));
            assert_eq!(own.secs_per_phase, of.secs_per_phase);
            assert_eq!([own.travel.forward, own.travel.yaw_rate], [0.0; 2]);
            for j in 0..body.joints().len() {
                let wanted = if arm.holds(j) { &of.pose } else { &neutral };
                let at = body.coordinates(j);
                assert!(vocabulary::gap(&own.pose[at.clone()], &wanted[at]) < 1e-12);
            }
        }
    }
}

#[test]
fn what_is_no_part_and_what_nothing_moves_is_refused() {
    let vocabulary = vocabulary_of(&of_ares()[..3]);
    let refused = |part: &str| Restriction::new(&vocabulary, &names(&[part])).expect_err(part);
    let unknown = refused("right_arms");
    assert!(unknown.is_unknown_name(), "{unknown}");
    for words in ["`right_arms`", "nearest: `right_arm`", "left_leg, "] {
        assert!(unknown.to_string().contains(words), "{unknown}");
    }
    let still = refused("left_leg").to_string();
    assert_eq!(
        still,
        "no primitive moves left_leg; the vocabulary's move left_arm, right_arm, trunk"
    );
    assert!(Restriction::new(&vocabulary, &[]).is_err(), "nothing");
    let other = of_adonis()[0].exemplars()[0].motion.clone();
    let restriction = Restriction::new(&vocabulary, &names(&["left_arm"])).expect("a part");
    assert!(restriction.motion(&other).is_err(), "another body");
}
