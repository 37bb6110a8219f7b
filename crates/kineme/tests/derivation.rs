//! The automatic derivation on movements made by hand: what is known to be there is found, and nothing is chained
//! that never followed.

use std::sync::Arc;

use kineme::derivation::{
    Clustering, Cut, Derivation, Derived, Features, MAX_EXEMPLARS, Mark, SecondLevel, Segment,
    alternation, cut, feature_dims, transitions,
};
use kineme::math::statistics::{agreement, noise_as_singletons};
use kineme::segmentation::Segmenter;
use kineme::{Error, Modelling, Motion, Role, Root, Skeleton, Transitions};
use nalgebra::Vector3;
use proptest::prelude::*;

const RATE: f64 = 60.0;

fn body() -> Arc<Skeleton> {
    Arc::new(kineme::ares().expect("Ares"))
}

/// Degrees of some roles as a function of phase in [0, 1].
type Course = dyn Fn(f64) -> Vec<(Role, Vec<f64>)>;

fn motion(name: &str, body: &Arc<Skeleton>, secs: f64, course: &Course) -> Motion {
    let frames = (secs * RATE) as usize + 1;
    let mut poses = Vec::new();
    for f in 0..frames {
        let mut pose = body.neutral();
        for (role, degrees) in course(f as f64 / (frames - 1) as f64) {
            body.set_clinical(&mut pose, role, &degrees)
                .expect("a role of Ares");
        }
        poses.extend(pose);
    }
    Motion::new(
        name,
        Arc::clone(body),
        RATE,
        poses,
        vec![Root::ORIGIN; frames],
    )
    .expect("a motion")
}

/// A smooth rise from 0 to 1.
fn rise(phase: f64) -> f64 {
    0.5 - 0.5 * (phase * std::f64::consts::PI).cos()
}

/// Twenty clips of four movements with varied amplitude, and their classes.
fn four_movements(body: &Arc<Skeleton>) -> (Vec<Motion>, Vec<usize>) {
    let mut motions = Vec::new();
    let mut truth = Vec::new();
    for take in 0..8 {
        let size = 0.85 + 0.04 * f64::from(take);
        let courses: [Box<Course>; 4] = [
            Box::new(move |t| vec![(Role::RightUpperArm, vec![90.0 * size * rise(t), 0.0, 0.0])]),
            Box::new(move |t| vec![(Role::LeftUpperArm, vec![0.0, 95.0 * size * rise(t), 0.0])]),
            Box::new(move |t| vec![(Role::Chest, vec![0.0, 0.0, 50.0 * size * rise(t)])]),
            Box::new(move |t| {
                let bend = 80.0 * size * rise(t);
                vec![
                    (Role::RightUpperLeg, vec![bend]),
                    (Role::RightLowerLeg, vec![bend]),
                ]
            }),
        ];
        for (class, course) in courses.iter().enumerate() {
            let name = format!("take-{take}-{class}");
            motions.push(motion(&name, body, 0.8 + 0.05 * f64::from(take), course));
            truth.push(class);
        }
    }
    (motions, truth)
}

fn run(settings: &Derivation, motions: &[Motion]) -> Derived {
    settings.run(motions, &mut |_| {}).expect("a derivation")
}

fn ari(derived: &Derived, truth: &[usize]) -> f64 {
    agreement(&noise_as_singletons(&derived.labels), truth).ari
}

#[test]
fn four_kinds_of_clips_become_four_primitives() {
    let (motions, truth) = four_movements(&body());
    let derived = run(&Derivation::new(Cut::Clips), &motions);
    assert_eq!(ari(&derived, &truth), 1.0, "{:?}", derived.labels);
    for group in &derived.groups {
        assert_eq!(group.segments.len(), 8, "{}", group.name);
        assert!(group.coherence.is_some_and(|c| c > 0.5), "{group:?}");
    }
    let names: Vec<&str> = derived.groups.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["group-01", "group-02", "group-03", "group-04"]);
    // Separate clips never follow one another.
    assert!(derived.transitions.counts.iter().all(|&c| c == 0));
    assert_eq!(derived.behaviors.items.len(), 4);
}

#[test]
fn the_paper_s_clustering_is_there_beside_the_default() {
    let (motions, truth) = four_movements(&body());
    let mut settings = Derivation::new(Cut::Clips);
    settings.clustering = Clustering::SweepAndPrune;
    let derived = run(&settings, &motions);
    assert_eq!(
        derived.labels.iter().flatten().max(),
        derived.sweep.labels.iter().flatten().max()
    );
    assert!(ari(&derived, &truth) > 0.5);
    assert!((-1.0..=1.0).contains(&derived.sweep.stability));
}

/// One recording in which the right arm rises and falls, then the left, in turn, with a rest after each swing.
fn strokes(body: &Arc<Skeleton>) -> Motion {
    motion("strokes", body, 24.0, &|t| {
        let cycle = t * 12.0;
        let swing = 80.0
            * ((cycle.fract() / 0.8).min(1.0) * std::f64::consts::PI)
                .sin()
                .powi(2);
        match (cycle as usize / 3) % 2 {
            0 => vec![(Role::RightUpperArm, vec![swing])],
            _ => vec![(Role::LeftUpperArm, vec![0.0, swing])],
        }
    })
}

#[test]
fn strokes_out_and_back_alternate_into_behaviours() {
    let body = body();
    let segmenter = Segmenter::named("pendulum").expect("a segmenter");
    let pendulum = Cut::Segmenter {
        segmenter,
        target_secs: None,
    };
    let motions = [strokes(&body)];
    let derived = run(&Derivation::new(pendulum.clone()), &motions);
    // Twelve swings, each out and back.
    assert!(
        (22..=26).contains(&derived.segments.len()),
        "{} segments",
        derived.segments.len()
    );
    let side = |s: &Segment| {
        let middle = (s.frames.start + s.frames.end) / 2;
        (middle as f64 / RATE / 2.0) as usize / 3 % 2
    };
    // No behaviour mixes the arms.
    for (i, a) in derived.segments.iter().enumerate() {
        for (j, b) in derived.segments.iter().enumerate() {
            let behavior = |k: usize| derived.labels[k].map(|g| derived.behaviors.of_group[g]);
            if behavior(i).is_some() && behavior(i) == behavior(j) {
                assert_eq!(side(a), side(b), "segments {i} and {j}");
            }
        }
    }
    let merged = derived
        .behaviors
        .items
        .iter()
        .filter(|b| b.primitives.len() > 1);
    assert!(merged.count() >= 1, "{:?}", derived.behaviors);
    let mut none = Derivation::new(pendulum);
    none.second_level = SecondLevel::None;
    let plain = run(&none, &motions);
    assert!(
        plain
            .behaviors
            .items
            .iter()
            .all(|b| b.primitives.len() == 1)
    );
}

#[test]
fn a_target_duration_serves_in_place_of_thresholds() {
    let motions = [strokes(&body())];
    for name in ["pendulum", "zfunction", "changepoint"] {
        let of = |target_secs| {
            let segmenter = Segmenter::named(name).expect("a segmenter");
            cut(
                &motions,
                &Cut::Segmenter {
                    segmenter,
                    target_secs,
                },
            )
            .expect("segments")
        };
        let few = of(Some(2.0));
        assert!(!few.is_empty(), "{name}");
        let mut lengths: Vec<usize> = few.iter().map(|s| s.frames.len()).collect();
        lengths.sort_unstable();
        let median = lengths[lengths.len() / 2] as f64 / RATE;
        assert!((0.5..=4.0).contains(&median), "{name}: {median} s");
    }
}

fn segments(chains: &[usize]) -> Vec<Segment> {
    let mut all = Vec::new();
    for (motion, &length) in chains.iter().enumerate() {
        for i in 0..length {
            let next = all.len() + 1;
            all.push(Segment {
                motion,
                frames: 10 * i..10 * i + 10,
                successor: (i + 1 < length).then_some(next),
            });
        }
    }
    all
}

#[test]
fn only_successions_inside_one_recording_count() {
    // Labels of two recordings: 0 1 0 | 1 0.
    let labels = [0, 1, 0, 1, 0].map(Some);
    let counted = transitions(&segments(&[3, 2]), &labels, 2);
    assert_eq!(counted.counts, [0, 1, 2, 0]);
    // Noise between two segments is no succession.
    let broken = [Some(0), None, Some(1), Some(1), Some(0)];
    assert_eq!(
        transitions(&segments(&[5]), &broken, 2).counts,
        [0, 0, 1, 1]
    );
}

#[test]
fn alternation_joins_what_goes_both_ways_often_enough() {
    // Name, counts of successions, sizes of the groups, the behaviour of each.
    type Case = (&'static str, [u32; 9], [usize; 3], [usize; 3]);
    let cases: [Case; 5] = [
        (
            "out and back",
            [0, 4, 0, 4, 0, 0, 0, 0, 0],
            [5, 5, 5],
            [0, 0, 1],
        ),
        (
            "one way only",
            [0, 9, 0, 0, 0, 9, 0, 0, 0],
            [9, 9, 9],
            [0, 1, 2],
        ),
        (
            "once back",
            [0, 4, 0, 1, 0, 0, 0, 0, 0],
            [5, 5, 5],
            [0, 1, 2],
        ),
        ("chains", [0, 2, 0, 2, 0, 2, 0, 2, 0], [4, 4, 4], [0, 0, 0]),
        (
            "chance among many",
            [0, 2, 0, 2, 0, 0, 0, 0, 0],
            [40, 40, 40],
            [0, 1, 2],
        ),
    ];
    for (name, counts, sizes, expected) in cases {
        let transitions = Transitions {
            counts: counts.to_vec(),
            n: 3,
        };
        assert_eq!(alternation(&transitions, &sizes), expected, "{name}");
    }
}

#[test]
fn marks_chain_by_recording_in_their_own_order_else_by_time() {
    let body = body();
    let clip = |name: &str| {
        motion(name, &body, 4.0, &|t| {
            vec![(Role::Chest, vec![30.0 * rise(t)])]
        })
    };
    let motions = [clip("a"), clip("b")];
    let mark = |motion, start_secs: f64, recording: Option<&str>| Mark {
        motion,
        start_secs,
        end_secs: start_secs + 1.0,
        recording: recording.map(Into::into),
    };
    let successors = |marks: Vec<Mark>| -> Vec<Option<usize>> {
        let found = cut(&motions, &Cut::Marks(marks)).expect("segments");
        found.iter().map(|s| s.successor).collect()
    };
    let named = vec![
        mark(1, 2.0, Some("x")),
        mark(0, 0.0, Some("y")),
        mark(0, 1.0, Some("x")),
    ];
    assert_eq!(successors(named), [Some(2), None, None]);
    let plain = vec![mark(0, 2.0, None), mark(0, 0.0, None), mark(1, 0.0, None)];
    assert_eq!(successors(plain), [None, Some(0), None]);
    for wrong in [
        mark(0, 9.0, None),
        mark(7, 0.0, None),
        mark(0, f64::NAN, None),
    ] {
        assert!(
            cut(&motions, &Cut::Marks(vec![wrong.clone()])).is_err(),
            "{wrong:?}"
        );
    }
}

#[test]
fn a_vocabulary_holds_the_most_central_segments_as_they_were() {
    let body = body();
    let (mut motions, _) = four_movements(&body);
    for extra in 0..60 {
        let size = 60.0 + 0.5 * f64::from(extra);
        let name = format!("extra-{extra}");
        let course = move |t: f64| {
            vec![(
                Role::LeftUpperLeg,
                vec![0.0, size.min(45.0) * rise(t) + 0.02 * size],
            )]
        };
        motions.push(motion(&name, &body, 0.9, &course));
    }
    let derived = run(&Derivation::new(Cut::Clips), &motions);
    let vocabulary = derived
        .vocabulary(&motions, &Modelling::default(), &|m| {
            Some(format!("hash-{m}"))
        })
        .expect("a vocabulary");
    assert_eq!(vocabulary.primitives().len(), derived.groups.len());
    for (primitive, group) in vocabulary.primitives().iter().zip(&derived.groups) {
        let known = primitive.group().expect("derived");
        assert_eq!(known.members, group.segments.len());
        assert_eq!(
            primitive.exemplars().len(),
            group.segments.len().min(MAX_EXEMPLARS)
        );
        for (exemplar, &s) in primitive.exemplars().iter().zip(&group.segments) {
            let segment = &derived.segments[s];
            let whole = motions[segment.motion]
                .slice(segment.frames.clone())
                .expect("frames");
            assert_eq!(exemplar.motion, whole);
            let hash = format!("hash-{}", segment.motion);
            assert_eq!(exemplar.provenance.blake3.as_deref(), Some(hash.as_str()));
        }
    }
    assert!(vocabulary.primitive("group-01").is_ok());
    assert!(
        vocabulary
            .primitive("group-99")
            .is_err_and(|e| e.is_unknown_name())
    );
}

#[test]
fn one_thread_or_two_give_the_same_bits() {
    let (motions, _) = four_movements(&body());
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| run(&Derivation::new(Cut::Clips), &motions))
    };
    let (one, two) = (on(1), on(2));
    assert_eq!(one.embedding, two.embedding);
    assert_eq!(one.distances, two.distances);
    assert_eq!((one.labels, one.groups), (two.labels, two.groups));
}

#[test]
fn too_little_motion_is_an_error_that_says_so() {
    let body = body();
    let still = motion("still", &body, 3.0, &|_| Vec::new());
    let failed = |motions: &[Motion], cut: Cut| -> Error {
        let settings = Derivation::new(cut);
        settings.run(motions, &mut |_| {}).expect_err("too little")
    };
    assert!(failed(&[], Cut::Clips).is_invalid());
    assert!(failed(std::slice::from_ref(&still), Cut::Clips).is_unsupported());
    let pendulum = Cut::Segmenter {
        segmenter: Segmenter::default(),
        target_secs: None,
    };
    assert!(
        failed(std::slice::from_ref(&still), pendulum)
            .to_string()
            .contains("0 segments")
    );
    let other = Arc::new(kineme::adonis().expect("Adonis"));
    let foreign = motion("foreign", &other, 1.0, &|_| Vec::new());
    assert!(failed(&[still, foreign], Cut::Clips).is_invalid());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn features_ignore_where_the_body_stands_and_faces(
        x in -5.0..5.0f64, y in -5.0..5.0f64, z in -1.0..1.0f64, yaw in -7.0..7.0f64,
    ) {
        let body = body();
        let here = motion("here", &body, 0.5, &|t| vec![(Role::LeftUpperArm, vec![60.0 * t, 20.0, 0.0])]);
        let root = Root { position: Vector3::new(x, y, z), yaw };
        let roots = vec![root; here.frames()];
        let there = Motion::new("there", Arc::clone(&body), RATE, here.poses().to_vec(), roots).unwrap();
        let (a, b) = (Features::default().of(&here), Features::default().of(&there));
        prop_assert_eq!(a.len(), here.frames() * feature_dims(&body));
        for (u, v) in a.iter().zip(&b) {
            prop_assert!((u - v).abs() < 1e-9, "{u} {v}");
        }
    }

    #[test]
    fn all_shape_removed_leaves_no_mean(shape in 0.0..=1.0f64, offset in -2.0..2.0f64) {
        let features = Features { shape, ..Features::default() };
        let sequence: Vec<f64> = (0..40).map(|i| offset + f64::from(i % 7)).collect();
        let out = features.segment(&sequence, 1, 3..40);
        let plain = Features::default().segment(&sequence, 1, 3..40);
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        prop_assert!((mean(&out) - (1.0 - shape) * mean(&plain)).abs() < 1e-9);
        prop_assert!((out[0] - (plain[0] - shape * mean(&plain))).abs() < 1e-9);
    }

    #[test]
    fn successors_are_likely_in_proportion_and_sum_to_one(counts in prop::collection::vec(0u32..50, 9)) {
        let transitions = Transitions { counts, n: 3 };
        for from in 0..3 {
            let sum: f64 = (0..3).map(|to| transitions.probability(from, to)).sum();
            prop_assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_second_isomap_joins_only_whole_groups() {
    let motions = [strokes(&body())];
    let mut settings = Derivation::new(Cut::Segmenter {
        segmenter: Segmenter::default(),
        target_secs: None,
    });
    settings.second_level = SecondLevel::Isomap;
    let derived = run(&settings, &motions);
    let named: usize = derived
        .behaviors
        .items
        .iter()
        .map(|b| b.primitives.len())
        .sum();
    assert_eq!(named, derived.groups.len());
    for (group, &behavior) in derived.groups.iter().zip(&derived.behaviors.of_group) {
        let item = &derived.behaviors.items[behavior];
        assert!(
            item.primitives.contains(&group.name),
            "{} in {item:?}",
            group.name
        );
    }
}
