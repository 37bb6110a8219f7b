//! The inverse law, and laws of the filter, on the vocabularies of `choreography/`.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use kineme::perception::{Filter, FilterSettings, calibrated};
use kineme::primitive::{Modelling, Observations, Posterior, Recogniser, Transitions, readings};
use kineme::{Motion, Root, Vocabulary, adonis};
use kineme_paper::inverse::inverse;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const SCRIPTS: [&str; 6] = [
    "boxing",
    "punching",
    "vertical-waving",
    "horizontal-waving",
    "twist",
    "greeting",
];

static VOCABULARIES: LazyLock<Vec<Vocabulary>> = LazyLock::new(|| SCRIPTS.map(vocabulary).into());

fn vocabulary(name: &str) -> Vocabulary {
    let file = format!("{name}.toml");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../choreography");
    let bytes = std::fs::read(folder.join(&file)).expect("a script");
    let script = kineme_formats::script::parse(&file, &bytes).expect("a valid script");
    let body = Arc::new(adonis().expect("adonis"));
    let made = script.vocabulary(&body, &Modelling::default(), (&file, None));
    calibrated(made.expect("a vocabulary"), None).expect("calibrated")
}

fn filter(vocabulary: &Vocabulary) -> Filter<'_> {
    Filter::new(vocabulary, &FilterSettings::default()).expect("a filter")
}

/// A jab that no exemplar is, with its rests.
fn jab(vocabulary: &Vocabulary) -> Motion {
    let course = vocabulary.primitives()[0]
        .at(&[0.4, 0.6])
        .expect("a course");
    let frames = (course.duration_secs() * 60.0) as usize + 1;
    let poses = (0..frames).flat_map(|f| course.pose(course.phase_at(f as f64 / 60.0)));
    Motion::new(
        "a jab",
        Arc::clone(vocabulary.body()),
        60.0,
        poses.collect(),
        vec![Root::ORIGIN; frames],
    )
    .expect("a motion")
}

fn check_sum(posterior: &Posterior, of: &str) {
    let all = posterior
        .primitives
        .iter()
        .chain([&posterior.rest, &posterior.none]);
    assert!(
        all.clone().all(|p| (0.0..=1.0 + 1e-12).contains(p)),
        "{of}: {posterior:?}"
    );
    let sum: f64 = all.sum();
    assert!((sum - 1.0).abs() < 1e-9, "{of}: {sum}");
}

#[test]
fn what_a_primitive_makes_is_recognised_as_that_primitive_with_phase_and_parameters() {
    let (mut all, mut label, mut phase) = (0usize, 0usize, 0usize);
    let (mut told, mut parameters) = (0usize, 0usize);
    for vocabulary in VOCABULARIES.iter() {
        let recovered = inverse(&filter(vocabulary), 8, 7).expect("places");
        for place in recovered.iter().flatten() {
            all += 1;
            label += usize::from(place.label);
            phase += usize::from(place.phase <= 0.05);
            told += usize::from(place.parameters.is_some());
            parameters += usize::from(place.parameters.is_some_and(|off| off <= 0.1));
        }
    }
    println!("{label} labels, {phase} phases of {all}; {parameters} parameters of {told}");
    // Eight places a primitive: the share asked for, give or take two misses.
    assert!(label + 2 >= (all * 99).div_ceil(100), "{label} of {all}");
    assert!(phase + 3 >= (all * 99).div_ceil(100), "{phase} of {all}");
    assert!(
        parameters + 3 >= (told * 99).div_ceil(100),
        "{parameters} of {told}"
    );
}

#[test]
fn answers_are_probabilities_and_ignore_the_order_of_the_vocabulary() {
    let vocabulary = &VOCABULARIES[0];
    let motion = Observations::complete(jab(vocabulary));
    let mut turned = vocabulary.primitives().to_vec();
    turned.reverse();
    let n = turned.len();
    let other = Vocabulary::new(
        Arc::clone(vocabulary.body()),
        turned,
        Vec::new(),
        Transitions::none(n),
    )
    .expect("a vocabulary");
    let plain = Vocabulary::new(
        Arc::clone(vocabulary.body()),
        vocabulary.primitives().to_vec(),
        Vec::new(),
        Transitions::none(n),
    )
    .expect("a vocabulary");
    let (one, two) = (filter(&plain), filter(&other));
    let pairs = readings(&one, &motion).expect("answers").into_iter();
    for (a, b) in pairs.zip(readings(&two, &motion).expect("answers")) {
        check_sum(&a.posterior, "a frame");
        for (p, q) in a
            .posterior
            .primitives
            .iter()
            .zip(b.posterior.primitives.iter().rev())
        {
            assert!((p - q).abs() < 1e-6, "{p} and {q}");
        }
    }
    let whole = one.recognise(&motion).expect("an answer");
    check_sum(&whole.posterior, "the clip");
    assert_eq!(whole.posterior.best(), Some(0));
    assert_eq!(whole.spans.first().map(|s| s.start_secs), Some(0.0));
}

#[test]
fn one_lost_joint_does_not_hide_the_movement() {
    let vocabulary = &VOCABULARIES[0];
    let filter = filter(vocabulary);
    let motion = jab(vocabulary);
    let (body, frames) = (motion.skeleton(), motion.frames());
    let joints = body.joints().len();
    for lost in (0..joints).filter(|&j| !body.coordinates(j).is_empty()) {
        let missing = (0..frames * joints).map(|k| k % joints == lost).collect();
        let seen = Observations::with_missing(motion.clone(), missing).expect("as many flags");
        let answer = filter.recognise(&seen).expect("an answer").posterior;
        let name = &body.joints()[lost].name;
        // Without the shoulder that strikes, nothing is left to see of a jab.
        let needed = name.contains("right_shoulder") || name.contains("right_upper_arm");
        assert!(
            answer.leading().map(|(k, _)| k) == Some(0) || needed,
            "{name}: {answer:?}"
        );
    }
}

#[test]
fn what_is_unseen_does_not_matter() {
    let vocabulary = &VOCABULARIES[0];
    let filter = filter(vocabulary);
    let motion = jab(vocabulary);
    let joints = motion.skeleton().joints().len();
    let lost = motion.skeleton().joints_of(kineme::Role::LeftUpperArm)[0];
    let missing: Vec<bool> = (0..motion.frames() * joints)
        .map(|k| k % joints == lost)
        .collect();
    let of = |motion: &Motion| {
        let seen = Observations::with_missing(motion.clone(), missing.clone()).expect("flags");
        filter.recognise(&seen).expect("an answer")
    };
    let own = motion.skeleton().coordinates(lost);
    let mut poses = motion.poses().to_vec();
    for pose in poses.chunks_exact_mut(motion.skeleton().dof()) {
        pose[own.clone()].fill(1.0);
    }
    let body = Arc::clone(motion.skeleton());
    let other = Motion::new("other", body, 60.0, poses, motion.roots().to_vec()).expect("a motion");
    assert_eq!(of(&motion), of(&other));
}

#[test]
fn a_punch_played_backward_is_no_punch() {
    let vocabulary = &VOCABULARIES[1];
    let filter = filter(vocabulary);
    for (k, primitive) in vocabulary.primitives().iter().enumerate() {
        let course = primitive.at(&primitive.middle()).expect("a course");
        let frames = (course.duration_secs() * 60.0) as usize + 1;
        let last = frames - 1;
        let poses =
            (0..frames).flat_map(|f| course.pose(course.phase_at((last - f) as f64 / 60.0)));
        let body = Arc::clone(vocabulary.body());
        let roots = vec![Root::ORIGIN; frames];
        let motion = Motion::new("backward", body, 60.0, poses.collect(), roots).expect("a motion");
        let answers = readings(&filter, &Observations::complete(motion)).expect("answers");
        let fooled = answers
            .iter()
            .filter(|r| r.posterior.primitives[k] > 0.5)
            .count();
        assert!(
            10 * fooled <= frames,
            "{}: {fooled} of {frames}",
            primitive.name()
        );
    }
}

/// The first third of a jab, the way to where hooks begin within `secs`, and a hook: with the frames at which the way and the hook
/// begin.
fn jab_way_hook(vocabulary: &Vocabulary, secs: f64) -> (Motion, usize, usize) {
    let [jab, hook] = [(0, [0.4, 0.6]), (1, [0.6, 0.3])]
        .map(|(k, p)| vocabulary.primitives()[k].at(&p).expect("a course"));
    let mut poses = Vec::new();
    let way = (jab.secs_at(0.35) * 60.0) as usize;
    for f in 0..way {
        poses.push(jab.pose(jab.phase_at(f as f64 / 60.0)));
    }
    let (from, to) = (poses[way - 1].clone(), hook.pose(0.0));
    let frames = (secs * 60.0) as usize;
    for f in 1..frames {
        let s = f as f64 / frames as f64;
        let s = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        poses.push(from.iter().zip(&to).map(|(a, b)| a + s * (b - a)).collect());
    }
    let begins = poses.len();
    for f in 0..=(hook.duration_secs() * 60.0) as usize {
        poses.push(hook.pose(hook.phase_at(f as f64 / 60.0)));
    }
    let roots = vec![Root::ORIGIN; poses.len()];
    let body = Arc::clone(vocabulary.body());
    let motion = Motion::new("jab, hook", body, 60.0, poses.concat(), roots).expect("a motion");
    (motion, way, begins)
}

#[test]
fn a_movement_that_interrupts_another_is_told_from_nearly_its_beginning_and_no_later_with_hindsight()
 {
    let vocabulary = &VOCABULARIES[0];
    let (motion, way, begins) = jab_way_hook(vocabulary, 0.6);
    let ends = motion.frames();
    let seen = Observations::complete(motion);
    let affirmed = |lag_secs: f64| -> Vec<Option<usize>> {
        let settings = FilterSettings {
            lag_secs,
            ..FilterSettings::default()
        };
        let filter = Filter::new(vocabulary, &settings).expect("a filter");
        let answers = readings(&filter, &seen).expect("answers");
        let lag = (60.0 * lag_secs) as usize;
        let of = |f: usize| {
            let told = &answers[(f + lag).min(ends - 1)].posterior.primitives;
            told.iter().position(|p| *p > 0.5)
        };
        (0..ends).map(of).collect()
    };
    for lag_secs in [0.0, 0.1] {
        let affirmed = affirmed(lag_secs);
        let share = |from: usize, until: usize, what: Option<usize>| {
            let right = affirmed[from..until].iter().filter(|a| **a == what).count();
            right as f64 / (until - from) as f64
        };
        assert!(share(6, way, Some(0)) > 0.9, "the jab: {affirmed:?}");
        assert!(
            share(begins + 9, ends - 3, Some(1)) > 0.95,
            "the hook: {affirmed:?}"
        );
    }
    let late = |affirmed: &[Option<usize>]| {
        let hook = affirmed[begins..].iter().position(|a| *a == Some(1));
        hook.expect("a hook")
    };
    let [at_once, later] = [0.0, 0.1].map(|lag_secs| late(&affirmed(lag_secs)));
    assert!(at_once <= 2 && later <= at_once, "{at_once}, {later}");
}

#[test]
fn noise_of_half_a_degree_hides_few_movements() {
    let vocabulary = &VOCABULARIES[0];
    let mut random = Pcg64::seed_from_u64(7);
    let (mut poses, mut truth) = (Vec::new(), Vec::new());
    for _ in 0..3 {
        for (k, primitive) in vocabulary.primitives().iter().enumerate() {
            let course = primitive.at(&primitive.middle()).expect("a course");
            for f in 0..=(course.duration_secs() * 120.0) as usize {
                // Uniform noise of this deviation on every coordinate.
                let mut noise =
                    || 0.5f64.to_radians() * 12f64.sqrt() * (random.random::<f64>() - 0.5);
                let pose = course.pose(course.phase_at(f as f64 / 120.0));
                poses.extend(pose.iter().map(|x| x + noise()));
                truth.push(k);
            }
        }
    }
    let body = Arc::clone(vocabulary.body());
    let roots = vec![Root::ORIGIN; truth.len()];
    let motion = Motion::new("noisy", body, 120.0, poses, roots).expect("a motion");
    let filter = Filter::new(vocabulary, &FilterSettings::default()).expect("a filter");
    let answers = readings(&filter, &Observations::complete(motion)).expect("answers");
    let pairs = answers.iter().zip(&truth);
    let right = pairs
        .filter(|(r, k)| r.posterior.primitives[**k] > 0.5)
        .count();
    assert!(10 * right >= 8 * truth.len(), "{right} of {}", truth.len());
}
