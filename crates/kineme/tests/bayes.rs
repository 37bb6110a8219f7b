//! The frame classifiers: laws of the exact one, and what the paper's does otherwise.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use kineme::choreography::{Key, perform};
use kineme::perception::{Frame, FrameSettings, Paper, PaperSettings};
use kineme::primitive::{Observation, Observations, Posterior, Recogniser, readings};
use kineme::{Exemplar, Modelling, Motion, Primitive, Result, Role, Root, Skeleton};
use kineme::{Transitions, Vocabulary, adonis};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn key(time: f64, arm: [f64; 3], elbow: f64, chest: f64) -> Key {
    Key {
        time,
        angles: BTreeMap::from([
            (Role::RightUpperArm, arm.to_vec()),
            (Role::RightLowerArm, vec![elbow]),
            (Role::Chest, vec![0.0, 0.0, chest]),
        ]),
    }
}

fn primitive(name: &str, adverbs: bool, keys: impl Fn(f64, f64) -> Vec<Key>) -> Primitive {
    let body = &*BODY;
    let places = (0..9).map(|i| (f64::from(i / 3) / 2.0, f64::from(i % 3) / 2.0));
    let exemplars = places.map(|(a, b)| {
        let motion = perform(name, &keys(a, b), body, 120.0).expect("keys");
        Exemplar::whole(motion, adverbs.then(|| vec![a, b]))
    });
    Primitive::learn(name, exemplars.collect(), &Modelling::default()).expect("a primitive")
}

static BODY: LazyLock<Arc<Skeleton>> = LazyLock::new(|| Arc::new(adonis().expect("adonis")));

const GUARD: ([f64; 3], f64) = ([15.0, 8.0, 0.0], 100.0);

/// Three strokes from one guard to places given by two parameters each, none coming back the way it went.
static VOCABULARY: LazyLock<Vocabulary> = LazyLock::new(|| {
    let ends = |secs: f64| [0.0, secs].map(|t| key(t, GUARD.0, GUARD.1, 0.0));
    let reach = primitive("reach", true, |a, b| {
        let [start, end] = ends(1.0);
        let out = [60.0 + 50.0 * a, 5.0 + 30.0 * b, 0.0];
        let low = [30.0, 30.0 + 20.0 * b, 10.0];
        vec![
            start,
            key(0.4, out, 20.0, 25.0),
            key(0.7, low, 40.0, 20.0),
            end,
        ]
    });
    let cross = primitive("cross", true, |a, b| {
        let [start, end] = ends(1.2);
        let out = [70.0 + 40.0 * a, -25.0 - 15.0 * b, 20.0];
        let high = [110.0 + 20.0 * a, -5.0, 30.0];
        vec![
            start,
            key(0.5, out, 50.0, -30.0),
            key(0.9, high, 90.0, -20.0),
            end,
        ]
    });
    // Nobody says what its parameters are.
    let raise = primitive("raise", false, |a, b| {
        let [start, end] = ends(1.1);
        let side = [50.0 * a, 60.0 + 30.0 * b, 0.0];
        let back = [-10.0 - 20.0 * a, 40.0 + 10.0 * b, -20.0];
        vec![
            start,
            key(0.4, side, 70.0, 5.0),
            key(0.7, back, 30.0, 0.0),
            end,
        ]
    });
    vocabulary(vec![reach, cross, raise])
});

fn vocabulary(primitives: Vec<Primitive>) -> Vocabulary {
    let body = Arc::clone(primitives[0].body());
    let transitions = Transitions::none(primitives.len());
    Vocabulary::new(body, primitives, Vec::new(), transitions).expect("a vocabulary")
}

/// Small lattices, no residual: quick to make, and tolerances are what they are said to be.
fn frame_settings() -> FrameSettings {
    FrameSettings {
        n: 1,
        residual: 0.0,
        patches: [8, 6, 4],
        pieces: 32,
        ..FrameSettings::default()
    }
}

fn paper_settings() -> PaperSettings {
    PaperSettings {
        n: 1,
        residual: 0.0,
        samples: [16, 7, 4],
        pieces: 64,
        ..PaperSettings::default()
    }
}

static FRAME: LazyLock<Frame<'static>> =
    LazyLock::new(|| Frame::new(&VOCABULARY, &frame_settings()).expect("a recogniser"));
static PAPER: LazyLock<Paper<'static>> =
    LazyLock::new(|| Paper::new(&VOCABULARY, &paper_settings()).expect("a recogniser"));

/// Parameters of an exemplar or between two.
fn random_place(primitive: &Primitive, rng: &mut Pcg64) -> Vec<f64> {
    let n = primitive.exemplars().len();
    let [a, b] = [0, 1].map(|_| primitive.point(rng.random_range(0..n)));
    let share = rng.random_range(0.0..1.0);
    let between = a.iter().zip(b).map(|(x, y)| x + share * (y - x));
    between.collect()
}

/// The movement at 60 Hz, and its phases.
fn performed(primitive: &Primitive, p: &[f64]) -> (Motion, Vec<f64>) {
    let course = primitive.at(p).expect("parameters");
    let frames = (course.duration_secs() * 60.0) as usize;
    let phases: Vec<f64> = (0..=frames)
        .map(|f| course.phase_at(f as f64 / 60.0))
        .collect();
    let poses = phases.iter().flat_map(|&t| course.pose(t)).collect();
    (motion(primitive.body(), poses), phases)
}

fn motion(body: &Arc<Skeleton>, poses: Vec<f64>) -> Motion {
    let frames = poses.len() / body.dof();
    let roots = vec![Root::ORIGIN; frames];
    Motion::new("observed", Arc::clone(body), 60.0, poses, roots).expect("a motion")
}

/// What a recogniser says to a single posture.
fn ask(recogniser: &dyn Recogniser, pose: &[f64], missing: &[bool]) -> Posterior {
    ask_all(recogniser, &[pose], missing)
}

/// What it says to the last of several.
fn ask_all(recogniser: &dyn Recogniser, poses: &[&[f64]], missing: &[bool]) -> Posterior {
    let mut listener = recogniser.listen();
    let mut answer = None;
    for (f, pose) in poses.iter().enumerate() {
        let seen = Observation {
            secs: f as f64 / 60.0,
            pose,
            root: None,
            missing,
        };
        answer = Some(listener.hear(&seen).expect("a posture").posterior);
    }
    answer.expect("postures")
}

/// Root mean square distance of a posture from the guard, radians.
fn from_guard(pose: &[f64]) -> f64 {
    let guard = VOCABULARY.primitives()[0].registered(0, 0.0).pose;
    let square: f64 = pose.iter().zip(&guard).map(|(a, b)| (a - b).powi(2)).sum();
    (square / pose.len() as f64).sqrt()
}

/// A posture of a primitive, shaken by up to so many radians; which one, and its phase.
fn shaken(rng: &mut Pcg64, by: f64) -> (usize, f64, Vec<f64>) {
    let k = rng.random_range(0..VOCABULARY.primitives().len());
    let p = &VOCABULARY.primitives()[k];
    let phase = rng.random_range(0.0..1.0);
    let mut pose = p.pose(&random_place(p, rng), phase).expect("a posture");
    for x in &mut pose {
        *x += rng.random_range(-1.0..=1.0) * by;
    }
    (k, phase, pose)
}

fn close(a: &Posterior, b: &Posterior, to: f64) -> bool {
    let all = |p: &Posterior| [p.primitives.clone(), vec![p.rest, p.none]].concat();
    all(a).iter().zip(all(b)).all(|(x, y)| (x - y).abs() <= to)
}

#[test]
fn a_posterior_is_a_distribution() {
    let mut rng = Pcg64::seed_from_u64(1);
    let joints = BODY.joints().len();
    for round in 0..400 {
        let (_, _, pose) = shaken(&mut rng, f64::from(round % 5) * 0.05);
        let missing: Vec<bool> = (0..joints).map(|_| rng.random_bool(0.2)).collect();
        let p = ask(&*FRAME, &pose, &missing);
        let all = [p.primitives.clone(), vec![p.rest, p.none]].concat();
        assert!(all.iter().all(|x| (0.0..=1.0).contains(x)), "{p:?}");
        assert!((all.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{p:?}");
        let p = ask(&*PAPER, &pose, &missing);
        assert!(
            p.primitives.iter().all(|x| (0.0..=1.0).contains(x)),
            "{p:?}"
        );
    }
    // Of a posture of which nothing is known, nothing is said beyond what was probable before.
    let p = ask(&*FRAME, &vec![0.0; BODY.dof()], &vec![true; joints]);
    let fifth = Posterior {
        primitives: vec![0.2; 3],
        rest: 0.2,
        none: 0.2,
    };
    assert!(close(&p, &fifth, 1e-9), "{p:?}");
}

#[test]
fn nothing_falls_between_cells() {
    let settings = FrameSettings {
        delta_rad: 1e-3,
        faults: 0,
        ..frame_settings()
    };
    let frame = Frame::new(&VOCABULARY, &settings).expect("a recogniser");
    let mut rng = Pcg64::seed_from_u64(2);
    for _ in 0..2000 {
        let (k, phase, pose) = shaken(&mut rng, 0.0);
        let p = ask(&frame, &pose, &[]);
        assert!(p.primitives[k] > 0.0, "{k} at {phase}: {p:?}");
    }
}

#[test]
fn the_order_of_primitives_is_irrelevant() {
    let order = [2, 0, 1];
    let primitives = order.map(|k| VOCABULARY.primitives()[k].clone());
    let other = vocabulary(primitives.to_vec());
    let frame = Frame::new(&other, &frame_settings()).expect("a recogniser");
    let mut rng = Pcg64::seed_from_u64(3);
    for _ in 0..200 {
        let (_, _, pose) = shaken(&mut rng, 0.05);
        let a = ask(&*FRAME, &pose, &[]);
        let mut b = ask(&frame, &pose, &[]);
        b.primitives = (0..3)
            .map(|k| b.primitives[order.iter().position(|&o| o == k).expect("one")])
            .collect();
        assert!(close(&a, &b, 1e-12), "{a:?} {b:?}");
    }
}

/// The body with siblings the other way round, and for each of its coordinates the one of the body as it is.
fn renumbered(body: &Skeleton) -> (Skeleton, Vec<usize>) {
    let joints = body.joints();
    let mut depth = vec![0; joints.len()];
    for (j, joint) in joints.iter().enumerate() {
        depth[j] = joint.parent.map_or(0, |p| depth[p] + 1);
    }
    let mut order: Vec<usize> = (0..joints.len()).collect();
    order.sort_by_key(|&j| (depth[j], std::cmp::Reverse(j)));
    let new = |j: usize| order.iter().position(|&o| o == j).expect("a joint");
    let renamed = order.iter().map(|&j| {
        let mut joint = joints[j].clone();
        joint.parent = joint.parent.map(new);
        joint
    });
    let effectors = body.effectors().iter().cloned().map(|mut e| {
        e.joint = new(e.joint);
        e
    });
    let coordinates = order.iter().flat_map(|&j| body.coordinates(j)).collect();
    let other = Skeleton::new("renumbered", renamed.collect(), effectors.collect());
    (other.expect("a body"), coordinates)
}

#[test]
fn the_order_of_joints_is_irrelevant() -> Result<()> {
    let (body, from) = renumbered(&BODY);
    assert!(from.windows(2).any(|w| w[1] < w[0]));
    let body = Arc::new(body);
    let turned = |pose: &[f64]| -> Vec<f64> { from.iter().map(|&c| pose[c]).collect() };
    // The landmarks of both bodies are the same, so what was fitted to them is.
    let primitives = VOCABULARY.primitives().iter().map(|p| {
        let exemplars = p.exemplars().iter().map(|e| {
            let m = &e.motion;
            let poses = (0..m.frames()).flat_map(|f| turned(m.pose(f))).collect();
            let motion = Motion::new("m", Arc::clone(&body), 120.0, poses, m.roots().to_vec());
            Ok(Exemplar {
                motion: motion?,
                ..e.clone()
            })
        });
        let exemplars = exemplars.collect::<Result<Vec<_>>>()?;
        Primitive::from_fit(p.name(), exemplars, p.fitted().clone(), None)
    });
    let other = vocabulary(primitives.collect::<Result<_>>()?);
    let frame = Frame::new(&other, &frame_settings())?;
    let paper = Paper::new(&other, &paper_settings())?;
    let mut rng = Pcg64::seed_from_u64(4);
    for _ in 0..200 {
        let (_, _, pose) = shaken(&mut rng, 0.05);
        let (a, b) = (ask(&*FRAME, &pose, &[]), ask(&frame, &turned(&pose), &[]));
        assert!(close(&a, &b, 1e-9), "{a:?} {b:?}");
        // The chain is ordered by what joints tell, not by their numbers.
        let (a, b) = (ask(&*PAPER, &pose, &[]), ask(&paper, &turned(&pose), &[]));
        assert!(close(&a, &b, 1e-9), "{a:?} {b:?}");
    }
    Ok(())
}

#[test]
fn a_missing_joint_is_its_marginal() {
    // A tolerance far wider than cells, so that a box is as wide as its tolerance but for little.
    let settings = FrameSettings {
        delta_rad: 0.3,
        faults: 0,
        patches: [8, 12, 4],
        pieces: 96,
        ..frame_settings()
    };
    let first = vocabulary(VOCABULARY.primitives()[..2].to_vec());
    let frame = Frame::new(&first, &settings).expect("a recogniser");
    let elbow = BODY.joints_of(Role::RightLowerArm)[0];
    let at = BODY.coordinates(elbow).start;
    let limits = BODY.limits(elbow)[0];
    let (low, high) = (
        limits.low - settings.limits_rad,
        limits.high + settings.limits_rad,
    );
    let mut missing = vec![false; BODY.joints().len()];
    missing[elbow] = true;
    // Densities over that of the background.
    let odds = |p: &Posterior| {
        p.primitives
            .iter()
            .chain([&p.rest])
            .map(|x| x / p.none)
            .collect::<Vec<_>>()
    };
    for (k, phase) in [(0, 0.3), (0, 0.8), (1, 0.5)] {
        let primitive = &first.primitives()[k];
        let mut pose = primitive.pose(&[0.4, 0.7], phase).expect("a posture");
        let marginal = odds(&ask(&frame, &pose, &missing));
        let steps = 400;
        let mut mean = [0.0; 3];
        for i in 0..steps {
            pose[at] = low + (high - low) * (f64::from(i) + 0.5) / f64::from(steps);
            for (m, o) in mean.iter_mut().zip(odds(&ask(&frame, &pose, &[]))) {
                *m += o / f64::from(steps);
            }
        }
        for (m, o) in mean.iter().zip(&marginal) {
            let off = (m / o).ln().abs();
            assert!(*o == 0.0 && *m == 0.0 || off < 0.1, "{k} {phase}: {m} {o}");
        }
        assert!(marginal[k] > 1.0);
    }
}

#[test]
fn what_the_exact_model_can_produce_the_paper_accepts() {
    // Within a cell coordinates are taken from anywhere: the paper's tolerance covers a cell's width, too.
    let delta = 0.06;
    for n in [1, 2] {
        let exact = FrameSettings {
            n,
            stride: 1,
            delta_rad: delta,
            faults: 0,
            patches: [32, 16, 6],
            pieces: 128,
            ..frame_settings()
        };
        let paper = PaperSettings {
            n,
            delta_rad: delta + 0.08,
            ..paper_settings()
        };
        let exact = Frame::new(&VOCABULARY, &exact).expect("a recogniser");
        let paper = Paper::new(&VOCABULARY, &paper).expect("a recogniser");
        let mut rng = Pcg64::seed_from_u64(5);
        let (mut accepted, mut refused) = (0, 0);
        for round in 0..600 {
            let shake = 0.05 * f64::from(round % 4);
            let (_, _, a) = shaken(&mut rng, shake);
            let mut b = a.clone();
            for x in &mut b {
                *x += rng.random_range(-0.03..0.03);
            }
            let seen: Vec<&[f64]> = [a.as_slice(), b.as_slice()][..n].to_vec();
            let (e, p) = (ask_all(&exact, &seen, &[]), ask_all(&paper, &seen, &[]));
            for (e, p) in e.primitives.iter().zip(&p.primitives) {
                assert!(*e == 0.0 || *p > 0.0, "n {n}, shaken by {shake}: {e} {p}");
                accepted += usize::from(*e > 0.0);
                refused += usize::from(*e == 0.0);
            }
        }
        assert!(accepted > 300 && refused > 300, "{accepted} {refused}");
    }
}

#[test]
fn played_backward_a_movement_is_refused_where_frames_are_far_apart() {
    const TUBE_RAD: f64 = 0.25;
    let mut rng = Pcg64::seed_from_u64(6);
    for stride in [4, 8] {
        let settings = FrameSettings {
            n: 2,
            stride,
            patches: [32, 12, 8],
            pieces: 64,
            ..frame_settings()
        };
        let frame = Frame::new(&VOCABULARY, &settings).expect("a recogniser");
        let (mut frames, mut forward, mut backward) = (0, 0, 0);
        for _ in 0..16 {
            let k = rng.random_range(0..3);
            let primitive = &VOCABULARY.primitives()[k];
            let (seen, _) = performed(primitive, &random_place(primitive, &mut rng));
            let last = seen.frames() - 1;
            let poses = (0..=last).rev().flat_map(|f| seen.pose(f).to_vec());
            let reversed = motion(&BODY, poses.collect());
            let answers = |m: &Motion| {
                let seen = Observations::complete(m.clone());
                readings(&frame, &seen).expect("readings")
            };
            let (there, back) = (answers(&seen), answers(&reversed));
            for f in stride..=last {
                // Away from rest, and farther apart than the tube of tolerance and cell is wide.
                let away = |m: &Motion| {
                    let (a, b) = (m.pose(f - stride), m.pose(f));
                    let gaps = a.iter().zip(b).map(|(x, y)| (x - y).abs());
                    let apart = gaps.fold(0.0, f64::max);
                    from_guard(a).min(from_guard(b)) > 10_f64.to_radians() && apart > TUBE_RAD
                };
                if away(&seen) && away(&reversed) {
                    frames += 1;
                    forward += usize::from(there[f].posterior.best() == Some(k));
                    backward += usize::from(back[f].posterior.best() == Some(k));
                }
            }
        }
        assert!(frames > 80, "{frames}");
        assert_eq!(forward, frames, "stride {stride}");
        assert!(
            10 * backward <= frames,
            "stride {stride}: {backward} of {frames}"
        );
    }
}

#[test]
fn hybrids_pass_the_paper_and_not_the_exact_model() {
    let mut rng = Pcg64::seed_from_u64(7);
    let (mut paper, mut exact, mut all) = (0, 0, 0);
    for _ in 0..600 {
        let k = rng.random_range(0..2);
        let primitive = &VOCABULARY.primitives()[k];
        let phase = rng.random_range(0.3..0.8);
        // Every coordinate at the same phase, each of another execution.
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        let own = corners.map(|p| primitive.pose(&p, phase).expect("a posture"));
        let hybrid: Vec<f64> = (0..BODY.dof())
            .map(|c| own[rng.random_range(0..4)][c])
            .collect();
        let distance = |p: &[f64]| {
            let pose = primitive.pose(p, phase).expect("a posture");
            let gaps = pose.iter().zip(&hybrid).map(|(a, b)| (a - b).abs());
            gaps.fold(0.0, f64::max)
        };
        let places =
            (0..21).flat_map(|i| (0..21).map(move |j| [i, j].map(|x| f64::from(x) / 20.0)));
        // Those that happen to be near a true posture are no hybrids.
        if places.map(|p| distance(&p)).fold(f64::INFINITY, f64::min) < 0.25 {
            continue;
        }
        all += 1;
        paper += usize::from(ask(&*PAPER, &hybrid, &[]).primitives[k] > 0.5);
        exact += usize::from(ask(&*FRAME, &hybrid, &[]).primitives[k] > 0.5);
    }
    assert!(all >= 20, "{all}");
    assert_eq!(paper, all);
    assert!(10 * exact <= all, "{exact} of {all}");
}

#[test]
fn one_lost_joint_collapses_the_paper_only() {
    let elbow = BODY.joints_of(Role::RightLowerArm)[0];
    let at = BODY.coordinates(elbow).start;
    let forgiving = FrameSettings {
        faults: 1,
        ..frame_settings()
    };
    let forgiving = Frame::new(&VOCABULARY, &forgiving).expect("a recogniser");
    let mut missing = vec![false; BODY.joints().len()];
    missing[elbow] = true;
    let mut rng = Pcg64::seed_from_u64(8);
    let (mut away, mut right, mut announced, mut paper) = (0, 0, 0, 0);
    for k in 0..3 {
        let primitive = &VOCABULARY.primitives()[k];
        let (seen, _) = performed(primitive, &random_place(primitive, &mut rng));
        for f in 0..seen.frames() {
            if from_guard(seen.pose(f)) < 10_f64.to_radians() {
                continue;
            }
            // The sensor sticks near the end of its range.
            let mut pose = seen.pose(f).to_vec();
            pose[at] = 2.5;
            away += 1;
            right += usize::from(ask(&forgiving, &pose, &[]).best() == Some(k));
            announced += usize::from(ask(&*FRAME, &pose, &missing).best() == Some(k));
            paper += usize::from(ask(&*PAPER, &pose, &[]).best().is_some());
        }
    }
    assert!(away > 60, "{away}");
    assert!(20 * right >= 19 * away, "{right} of {away}");
    assert!(20 * announced >= 19 * away, "{announced} of {away}");
    assert_eq!(paper, 0, "of {away}");
}

#[test]
fn what_a_primitive_makes_is_told_with_phase_and_parameters() {
    let mut rng = Pcg64::seed_from_u64(9);
    let recognisers: [(&dyn Recogniser, f64); 2] = [(&*FRAME, 0.08), (&*PAPER, 0.1)];
    for (recogniser, phase_to) in recognisers {
        let (mut error, mut places) = (0.0, 0.0);
        for _ in 0..8 {
            let k = rng.random_range(0..3);
            let primitive = &VOCABULARY.primitives()[k];
            let p = random_place(primitive, &mut rng);
            let (seen, phases) = performed(primitive, &p);
            let answers = readings(recogniser, &Observations::complete(seen.clone()));
            for (f, answer) in answers.expect("readings").iter().enumerate() {
                assert!(answer.novelty <= 1.0, "{}", answer.novelty);
                if from_guard(seen.pose(f)) < 15_f64.to_radians() {
                    continue;
                }
                assert!(answer.posterior.primitives[k] > 0.9, "{k} {f} {answer:?}");
                let Some(place) = answer.place.as_ref().filter(|p| p.primitive == k) else {
                    continue;
                };
                let off = (place.phase - phases[f]).abs();
                assert!(off < phase_to, "{k} {}: {place:?}", phases[f]);
                assert!(off < 4.0 * place.phase_deviation, "{place:?} {}", phases[f]);
                let deviations = place.parameters_deviation.iter();
                for ((a, b), d) in place.parameters.iter().zip(&p).zip(deviations) {
                    let off = (a - b).abs();
                    assert!(off < 4.0 * d + 0.05, "{p:?} {place:?}");
                    error += off;
                    places += 1.0;
                }
            }
        }
        assert!(places > 200.0 && error < 0.15 * places, "{error} {places}");
    }
}

#[test]
fn a_motion_is_told_apart_into_what_was_done_when() {
    let guard = VOCABULARY.primitives()[0].registered(0, 0.0).pose;
    let mut poses = Vec::new();
    let mut truth = Vec::new();
    let mut add = |own: Vec<f64>, label: Option<usize>| {
        truth.extend(vec![label; own.len() / guard.len()]);
        poses.extend(own);
    };
    for k in [Some(0), None, Some(2), Some(1)] {
        add(guard.repeat(30), None);
        match k {
            Some(k) => {
                let primitive = &VOCABULARY.primitives()[k];
                let middle = primitive.middle();
                add(performed(primitive, &middle).0.poses().to_vec(), Some(k));
            }
            None => {
                let keys = [0.0, 0.5, 1.0].map(|t| {
                    let left = 140.0 * (1.0 - (2.0 * t - 1.0_f64).abs());
                    let mut key = key(t, GUARD.0, GUARD.1, 0.0);
                    key.angles.insert(Role::LeftUpperArm, vec![left, 0.0, 0.0]);
                    key
                });
                let other = perform("other", &keys, &BODY, 60.0).expect("keys");
                add(other.poses().to_vec(), None);
            }
        }
    }
    let seen = Observations::complete(motion(&BODY, poses));
    let told = FRAME.recognise(&seen).expect("an answer");
    let last = (truth.len() - 1) as f64 / 60.0;
    assert_eq!(told.spans[0].start_secs, 0.0);
    assert_eq!(told.spans[told.spans.len() - 1].end_secs, last);
    for pair in told.spans.windows(2) {
        assert_eq!(pair[0].end_secs, pair[1].start_secs);
        assert_ne!(pair[0].primitive, pair[1].primitive);
    }
    let label = |f: usize| {
        let t = f as f64 / 60.0;
        let mut at = told.spans.iter().filter(|s| s.start_secs <= t);
        at.next_back().expect("no gap").primitive
    };
    let right = (0..truth.len()).filter(|&f| label(f) == truth[f]).count();
    assert!(
        10 * right >= 9 * truth.len(),
        "{right} of {}: {:?}",
        truth.len(),
        told.spans
    );
    let done: Vec<usize> = told.spans.iter().filter_map(|s| s.primitive).collect();
    assert_eq!(done, [0, 2, 1]);
    let short = FrameSettings {
        dwell_secs: 100.0,
        ..frame_settings()
    };
    let frame = Frame::new(&VOCABULARY, &short).expect("a recogniser");
    assert_eq!(frame.recognise(&seen).expect("an answer").spans.len(), 1);
}

#[test]
fn clips_are_named_and_rest_is_rest() {
    for k in 0..3 {
        let primitive = &VOCABULARY.primitives()[k];
        let (seen, _) = performed(primitive, &primitive.middle());
        let seen = Observations::complete(seen);
        let told = FRAME.recognise(&seen).expect("an answer");
        assert_eq!(told.posterior.best(), Some(k), "{told:?}");
        assert_eq!(told.parameters.len(), primitive.parameters().dims());
        let told = PAPER.recognise(&seen).expect("an answer");
        assert_eq!(told.posterior.best(), Some(k), "{told:?}");
    }
    let guard = VOCABULARY.primitives()[0].registered(0, 0.0).pose;
    let still = Observations::complete(motion(&BODY, guard.repeat(60)));
    let told = FRAME.recognise(&still).expect("an answer").posterior;
    assert!(told.rest > 0.5 && told.best().is_none(), "{told:?}");
    // The paper cannot tell whose rest it is: every primitive claims it.
    let told = PAPER.recognise(&still).expect("an answer").posterior;
    assert!(told.primitives.iter().all(|p| *p > 0.5), "{told:?}");
}

#[test]
fn priors_scale_odds() {
    let settings = FrameSettings {
        prior_rest: 3.0,
        ..frame_settings()
    };
    let frame = Frame::new(&VOCABULARY, &settings).expect("a recogniser");
    let mut rng = Pcg64::seed_from_u64(10);
    for _ in 0..50 {
        let p = &VOCABULARY.primitives()[0];
        let phase = rng.random_range(0.0..0.1);
        let pose = p
            .pose(&random_place(p, &mut rng), phase)
            .expect("a posture");
        let (a, b) = (ask(&*FRAME, &pose, &[]), ask(&frame, &pose, &[]));
        let odds = |p: &Posterior| p.rest / p.primitives[0];
        assert!(
            (odds(&b) / odds(&a) - 3.0).abs() < 1e-9 || a.rest == 0.0,
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn what_is_no_posture_of_the_body_is_refused() {
    let pose = VOCABULARY.primitives()[0].registered(0, 0.5).pose;
    let recognisers: [&dyn Recogniser; 2] = [&*FRAME, &*PAPER];
    for recogniser in recognisers {
        let hear = |secs: [f64; 2], pose: &[f64], missing: &[bool]| {
            let mut listener = recogniser.listen();
            let seen = |secs| Observation {
                secs,
                pose,
                root: None,
                missing,
            };
            listener.hear(&seen(secs[0]))?;
            listener.hear(&seen(secs[1]))
        };
        let mut broken = pose.clone();
        broken[0] = f64::NAN;
        let mut missing = vec![false; BODY.joints().len()];
        assert!(hear([0.0, 0.1], &pose, &missing).is_ok());
        assert!(hear([0.1, 0.1], &pose, &[]).is_err());
        assert!(hear([0.0, 0.1], &pose[1..], &[]).is_err());
        assert!(hear([0.0, 0.1], &pose, &missing[1..]).is_err());
        assert!(hear([0.0, 0.1], &broken, &[]).is_err());
        let moved = (0..missing.len()).find(|&j| BODY.coordinates(j).contains(&0));
        missing[moved.expect("a joint")] = true;
        assert!(hear([0.0, 0.1], &broken, &missing).is_ok());
        let other = Arc::new(kineme::ares().expect("ares"));
        let other = motion(&other, other.neutral());
        assert!(
            recogniser
                .recognise(&Observations::complete(other))
                .is_err()
        );
    }
    let wrong = FrameSettings {
        pieces: 0,
        ..FrameSettings::default()
    };
    assert!(Frame::new(&VOCABULARY, &wrong).is_err());
    let wrong = PaperSettings {
        delta_rad: f64::NAN,
        ..PaperSettings::default()
    };
    assert!(Paper::new(&VOCABULARY, &wrong).is_err());
}
