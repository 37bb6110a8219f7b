//! Flowfields: laws of following a primitive from any posture.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use kineme::choreography::{Key, perform};
use kineme::primitive::{FlowSettings, FlowState, Flowfield, Memory};
use kineme::skeleton::JointKind;
use kineme::{Error, ares};
use kineme::{Exemplar, Modelling, Motion, Primitive, Role, Root, Skeleton, adonis};
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

fn grid(name: &str, body: &Arc<Skeleton>, keys: impl Fn(f64, f64) -> Vec<Key>) -> Primitive {
    let mut exemplars = Vec::new();
    for h in 0..3 {
        for s in 0..3 {
            let (height, side) = (f64::from(h) / 2.0, f64::from(s) / 2.0);
            let motion = perform(&format!("{name}-{h}{s}"), &keys(height, side), body, 120.0);
            exemplars.push(Exemplar::whole(
                motion.expect("keys"),
                Some(vec![height, side]),
            ));
        }
    }
    Primitive::learn(name, exemplars, &Modelling::default()).expect("a primitive")
}

/// Reaching with the right arm to nine places, and back another way.
fn reach(body: &Arc<Skeleton>) -> Primitive {
    grid("reach", body, |height, side| {
        let secs = 0.8 + 0.2 * height + 0.1 * side;
        let out = [40.0 + 70.0 * height, 5.0 + 20.0 * side, -10.0 + 20.0 * side];
        vec![
            key(0.0, [15.0, 8.0, 0.0], 100.0, 0.0),
            key(0.2 * secs, [10.0, 10.0, 0.0], 110.0, -6.0),
            key(0.55 * secs, out, 15.0, 25.0 - 20.0 * side),
            key(secs, [15.0, 8.0, 0.0], 100.0, 0.0),
        ]
    })
}

/// A horizontal wave, across and back through the same postures: one class, at nine heights and widths.
fn wave(body: &Arc<Skeleton>) -> Primitive {
    grid("wave", body, |height, width| {
        let arm = |share: f64| {
            [
                60.0 + 30.0 * height,
                -20.0 + share * (50.0 + 20.0 * width),
                0.0,
            ]
        };
        let secs = 1.6;
        let place = |t: f64| 0.5 - 0.5 * (TAU * t).cos();
        let mut keys = vec![key(0.0, arm(0.0), 60.0, 0.0)];
        for k in 1..=8 {
            let t = f64::from(k) / 8.0;
            keys.push(key(secs * t, arm(place(t)), 60.0, 0.0));
        }
        keys
    })
}

/// An endless circling of the right arm, at three sizes: cut where it is whole.
fn circling(body: &Arc<Skeleton>) -> Primitive {
    let rate = 100.0;
    let exemplars = (0..3).map(|i| {
        let size = 0.5 + 0.25 * f64::from(i);
        let frames = 100 + 10 * i as usize;
        let mut poses = Vec::new();
        for f in 0..=frames {
            let turn = TAU * f as f64 / frames as f64;
            let mut pose = body.neutral();
            let arm = [
                60.0 + 40.0 * size * turn.cos(),
                20.0 + 30.0 * size * turn.sin(),
                0.0,
            ];
            body.set_clinical(&mut pose, Role::RightUpperArm, &arm)
                .expect("an arm");
            body.set_clinical(&mut pose, Role::RightLowerArm, &[40.0 + 10.0 * turn.sin()])
                .expect("an elbow");
            poses.extend(pose);
        }
        let roots = vec![Root::ORIGIN; frames + 1];
        let motion = Motion::new(format!("circle-{i}"), Arc::clone(body), rate, poses, roots);
        Exemplar::whole(motion.expect("a motion"), Some(vec![size]))
    });
    let modelling = Modelling {
        cyclic: Some(true),
        ..Modelling::default()
    };
    Primitive::learn("circling", exemplars.collect(), &modelling).expect("a primitive")
}

fn field(primitive: &Primitive) -> Flowfield {
    Flowfield::of(primitive, &FlowSettings::default()).expect("a field")
}

/// Distance from a posture to the manifold itself, by descent over parameters and phase: the field is not asked.
fn off_manifold(primitive: &Primitive, field: &Flowfield, state: &FlowState) -> f64 {
    let update = field.update(state);
    let (mut p, mut phase) = (update.parameters, update.phase);
    let far = |p: &[f64], phase: f64| {
        field.distance_rad(&primitive.pose(p, phase).expect("a pose"), state.pose())
    };
    let mut best = far(&p, phase);
    let mut size = 0.05;
    while size > 1e-5 {
        let mut moved = false;
        for d in 0..=p.len() {
            for by in [-size, size] {
                let (mut q, mut at) = (p.clone(), phase);
                match q.get_mut(d) {
                    Some(v) => *v += by,
                    None => at = (at + by).clamp(0.0, 1.0),
                }
                let found = far(&q, at);
                if found < best {
                    (p, phase, best, moved) = (q, at, found, true);
                }
            }
        }
        if !moved {
            size *= 0.5;
        }
    }
    best
}

#[test]
fn what_starts_on_the_manifold_stays_on_it_and_follows_its_course() {
    for body in [adonis(), ares()] {
        let body = Arc::new(body.expect("a body"));
        for primitive in [reach(&body), wave(&body), circling(&body)] {
            let field = field(&primitive);
            let (mut off, mut astray): (f64, f64) = (0.0, 0.0);
            for at in [[0.31, 0.72], [0.5, 0.5], [0.05, 0.9], [1.0, 0.0]] {
                let course = primitive
                    .at(&at[..field_dims(&primitive)])
                    .expect("a course");
                let from = 0.1;
                let state = field.enter_at(&course.pose(from), from).expect("a state");
                let state = state
                    .with_parameters(course.parameters())
                    .expect("parameters");
                let states = field.predict(&state, 0.7 * course.duration_secs(), 60.0);
                for (k, state) in states.expect("a flow").iter().enumerate() {
                    let phase = course.advance(from, (k + 1) as f64 / 60.0);
                    astray = astray.max(field.distance_rad(&course.pose(phase), state.pose()));
                    if k % 5 == 0 {
                        off = off.max(off_manifold(&primitive, &field, state));
                    }
                }
            }
            let name = format!("{} of {}", primitive.name(), body.name());
            println!("{name}: {off:.1e} rad off the manifold, {astray:.1e} off the course");
            assert!(off < 1e-3, "{name}: {off}");
            assert!(astray < 1e-2, "{name}: {astray}");
        }
    }
}

fn field_dims(primitive: &Primitive) -> usize {
    primitive.parameters().dims()
}

/// A direction at right angles to the movement and to what parameters change, `length` long.
fn sideways(
    primitive: &Primitive,
    field: &Flowfield,
    p: &[f64],
    phase: f64,
    length: f64,
) -> Vec<f64> {
    let dof = field.body().dof();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let inner = |a: &[f64], b: &[f64]| -> f64 {
        a.iter()
            .zip(b)
            .zip(field.weights())
            .map(|((a, b), w)| w * a * b)
            .sum()
    };
    let (_, rows) = primitive.pose_gradient(p, phase).expect("a gradient");
    let mut spanned: Vec<Vec<f64>> = rows.chunks_exact(dof).map(<[f64]>::to_vec).collect();
    spanned.push(primitive.sample(p, phase).expect("a sample").slope);
    let mut rng = Pcg64::seed_from_u64(7);
    spanned.push((0..dof).map(|_| rng.random_range(-1.0..1.0)).collect());
    for mut v in spanned {
        for b in &basis {
            let share = inner(&v, b);
            v.iter_mut().zip(b).for_each(|(v, b)| *v -= share * b);
        }
        let norm = inner(&v, &v).sqrt().max(1e-12);
        basis.push(v.iter().map(|v| v / norm).collect());
    }
    let last = basis.pop().expect("a direction");
    last.iter().map(|v| v * length).collect()
}

#[test]
fn a_perturbation_decays_at_the_rate_of_the_correction() {
    let body = Arc::new(adonis().expect("adonis"));
    for primitive in [reach(&body), wave(&body), circling(&body)] {
        let field = field(&primitive);
        let p = &[0.4, 0.6][..field_dims(&primitive)];
        let course = primitive.at(p).expect("a course");
        let phase = 0.25;
        let off = sideways(&primitive, &field, p, phase, 0.2);
        let pose: Vec<f64> = course
            .pose(phase)
            .iter()
            .zip(&off)
            .map(|(x, o)| x + o)
            .collect();
        let state = field.enter_at(&pose, phase).expect("a state");
        let state = state.with_parameters(p).expect("parameters");
        let before = field.update(&state).distance_rad;
        assert!(
            (before - 0.2).abs() < 0.01,
            "{}: {before}",
            primitive.name()
        );
        let secs = 0.25;
        let after = field.predict(&state, secs, 100.0).expect("a flow");
        let after = field.update(after.last().expect("a state")).distance_rad;
        let rate = (before / after).ln() / secs;
        println!("{}: decays at {rate:.2} /s", primitive.name());
        let wanted = field.settings().correction;
        assert!(
            (rate / wanted - 1.0).abs() < 0.1,
            "{}: {rate}",
            primitive.name()
        );
    }
}

/// Phase, unwrapped, may only rise.
fn check_rising(states: &[FlowState], cyclic: bool, name: &str) {
    for pair in states.windows(2) {
        let mut risen = pair[1].phase() - pair[0].phase();
        if cyclic && risen < -0.5 {
            risen += 1.0;
        }
        assert!(
            risen >= 0.0,
            "{name}: {} to {}",
            pair[0].phase(),
            pair[1].phase()
        );
    }
}

/// A posture with every coordinate somewhere in its range.
fn anywhere(body: &Skeleton, rng: &mut Pcg64) -> Vec<f64> {
    let mut pose = Vec::new();
    for joint in body.joints() {
        match &joint.kind {
            JointKind::Fixed => {}
            JointKind::Hinge { range, .. } => pose.push(rng.random_range(range.low..range.high)),
            JointKind::Ball { ranges, .. } => pose.extend(ranges.iter().map(|r| {
                let half = 0.5 * (r.high - r.low);
                rng.random_range(-half..half)
            })),
        }
    }
    pose
}

#[test]
fn from_any_posture_every_movement_comes_to_its_end_and_phase_never_falls() {
    let body = Arc::new(adonis().expect("adonis"));
    let mut rng = Pcg64::seed_from_u64(3);
    for primitive in [reach(&body), wave(&body)] {
        let field = field(&primitive);
        let longest = primitive.exemplars().iter();
        let longest = longest
            .map(|e| e.motion.duration_secs())
            .fold(0.0, f64::max);
        for _ in 0..100 {
            let pose = anywhere(&body, &mut rng);
            let state = field.enter(&pose).expect("a state");
            let states = field
                .predict(&state, 2.5 * longest + 2.0, 30.0)
                .expect("a flow");
            check_rising(&states, false, primitive.name());
            let end = states.last().expect("a state");
            let update = field.update(end);
            assert!(update.finished, "{}: {}", primitive.name(), end.phase());
            assert!(
                update.distance_rad < 0.02,
                "{}: {}",
                primitive.name(),
                update.distance_rad
            );
            let speed = update.velocity.iter().map(|v| v.abs()).fold(0.0, f64::max);
            assert!(speed < 0.1, "{}: still at {speed} rad/s", primitive.name());
        }
    }
}

/// Share of starts from which a movement stands still before it has come to its end.
fn stalls(primitive: &Primitive, settings: &FlowSettings) -> f64 {
    let field = Flowfield::of(primitive, settings).expect("a field");
    let mut stalled = 0;
    let mut starts = 0;
    for height in 0..4 {
        for width in 0..4 {
            let p = [f64::from(height) / 3.0, f64::from(width) / 3.0];
            let course = primitive.at(&p).expect("a course");
            for k in 0..4 {
                let from = 0.04 + 0.1 * f64::from(k);
                let state = field.enter_at(&course.pose(from), from).expect("a state");
                let secs = 2.0 * course.duration_secs();
                let states = field.predict(&state, secs, 30.0).expect("a flow");
                let end = field.update(states.last().expect("a state"));
                starts += 1;
                // It has been across and come back.
                let far = course.pose(0.5);
                let across = states.iter().map(|s| field.distance_rad(s.pose(), &far));
                let crossed = across.fold(f64::INFINITY, f64::min) < 0.1;
                if !(end.finished && crossed) {
                    stalled += 1;
                }
            }
        }
    }
    f64::from(stalled) / f64::from(starts)
}

#[test]
fn out_and_back_completes_with_phase_and_stalls_without() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = wave(&body);
    let with_phase = stalls(&primitive, &FlowSettings::default());
    let without = stalls(&primitive, &FlowSettings::paper());
    println!("stall rate: {with_phase:.2} with phase, {without:.2} without");
    assert_eq!(with_phase, 0.0);
    assert!(without > 0.0);
}

#[test]
fn a_cycle_wraps_and_never_ends() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = circling(&body);
    assert!(primitive.is_cyclic());
    let field = field(&primitive);
    let course = primitive.at(&[0.5]).expect("a course");
    let state = field.enter_at(&course.pose(0.9), 0.9).expect("a state");
    let turns = 5.0;
    let states = field
        .predict(&state, turns * course.duration_secs(), 60.0)
        .expect("a flow");
    check_rising(&states, true, "circling");
    let wraps = states
        .windows(2)
        .filter(|s| s[1].phase() < s[0].phase())
        .count();
    assert_eq!(wraps, 5);
    let end = states.last().expect("a state");
    let off = field.distance_rad(end.pose(), &course.pose(0.9));
    println!("after {turns} turns {off:.1e} rad off");
    assert!(off < 0.1 && !field.update(end).finished, "{off}");
    // Just before and just after the seam the field is the same.
    let before = field.update(
        &field
            .enter_at(&course.pose(0.0), 0.999_999)
            .expect("a state"),
    );
    let after = field.update(
        &field
            .enter_at(&course.pose(0.0), 0.000_001)
            .expect("a state"),
    );
    let gap = before
        .velocity
        .iter()
        .zip(&after.velocity)
        .map(|(a, b)| (a - b).abs());
    assert!(gap.fold(0.0, f64::max) < 1e-3);
}

#[test]
fn a_posture_is_entered_where_it_is_and_its_velocity_tells_out_from_back() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = wave(&body);
    let field = field(&primitive);
    let p = [0.7, 0.3];
    let course = primitive.at(&p).expect("a course");
    for k in 1..=9 {
        let phase = f64::from(k) / 10.0;
        let sample = course.sample(phase);
        let velocity: Vec<f64> = sample
            .slope
            .iter()
            .map(|s| s / sample.secs_per_phase)
            .collect();
        let state = field
            .enter_moving(&sample.pose, &velocity)
            .expect("a state");
        assert!(
            (state.phase() - phase).abs() < 0.04,
            "{phase}: {}",
            state.phase()
        );
    }
    let start = field.enter(&course.pose(1.0)).expect("a state");
    assert!(start.phase() < 0.05, "{}", start.phase());
    let last = field.update(&field.enter_at(&course.pose(1.0), 1.0).expect("a state"));
    assert!(last.finished && last.phase_rate == 0.0);
}

#[test]
fn what_is_out_of_the_basin_is_told_and_led_back_without_a_jump() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = reach(&body);
    let field = field(&primitive);
    let inside = primitive.pose(&[0.5, 0.5], 0.3).expect("a pose");
    let update = field.update(&field.enter(&inside).expect("a state"));
    assert!(!update.out_of_basin && update.distance_rad < 0.01);
    let outside: Vec<f64> = inside.iter().map(|x| x + 0.9).collect();
    assert!(
        field
            .update(&field.enter(&outside).expect("a state"))
            .out_of_basin
    );
    let velocity = vec![0.3; body.dof()];
    let way = field.approach(&outside, &velocity).expect("a way");
    let secs = way.duration_secs();
    let speed = |at: f64| -> Vec<f64> {
        let (a, b) = (way.pose(at - 1e-6), way.pose(at + 1e-6));
        a.iter().zip(&b).map(|(a, b)| (b - a) / 2e-6).collect()
    };
    let gap = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    assert!(gap(&way.pose(0.0), &outside) < 1e-12);
    assert!(gap(&way.pose(secs), way.target().pose()) < 1e-12);
    assert!(gap(&speed(2e-6), &velocity) < 1e-3);
    assert!(gap(&speed(secs - 2e-6), &field.update(way.target()).velocity) < 1e-3);
    assert!(!field.update(way.target()).out_of_basin);
}

#[test]
fn observation_brings_phase_and_posture_to_what_is_seen() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = wave(&body);
    let field = field(&primitive);
    let course = primitive.at(&[0.9, 0.1]).expect("a course");
    // The movement is seen at 0.7 of its speed, from a state that is wrong in parameters.
    let mut state = field.enter_at(&course.pose(0.0), 0.0).expect("a state");
    let mut phase = 0.0;
    for frame in 0..45 {
        field.step(&mut state, 1.0 / 30.0);
        phase = course.advance(phase, 0.7 / 30.0);
        field
            .observe(&mut state, &course.pose(phase), 0.5)
            .expect("a pose");
        let off = (state.phase() - phase).abs();
        assert!(off < if frame < 20 { 0.1 } else { 0.05 }, "{phase}: {off}");
    }
    assert!((state.pace() - 0.7).abs() < 0.15, "{}", state.pace());
    assert!(field.distance_rad(state.pose(), &course.pose(phase)) < 0.05);
    let gap: f64 = state
        .parameters()
        .iter()
        .zip([0.9, 0.1])
        .map(|(a, b)| (a - b).abs())
        .sum();
    assert!(gap < 0.3, "{:?}", state.parameters());
}

#[test]
fn the_same_primitive_gives_the_same_bytes_on_one_thread_or_two() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = reach(&body);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let field = field(&primitive);
            let pose = primitive.pose(&[0.2, 0.8], 0.2).expect("a pose");
            let state = field.enter(&pose).expect("a state");
            let flow = field.predict(&state, 0.5, 60.0).expect("a flow");
            // A prediction is the fold of steps.
            let mut stepped = state;
            let folded: Vec<FlowState> = (0..30)
                .map(|_| {
                    field.step(&mut stepped, 1.0 / 60.0);
                    stepped.clone()
                })
                .collect();
            assert_eq!(flow, folded);
            flow
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn what_is_no_posture_and_no_setting_is_refused() {
    let body = Arc::new(adonis().expect("adonis"));
    let primitive = reach(&body);
    let field = field(&primitive);
    let pose = body.neutral();
    let mut state = field.enter(&pose).expect("a state");
    let mut broken = pose.clone();
    broken[3] = f64::NAN;
    let refused: [(&str, Result<(), Error>); 8] = [
        ("short", field.enter(&pose[1..]).map(drop)),
        ("not finite", field.enter(&broken).map(drop)),
        ("velocity", field.enter_moving(&pose, &broken).map(drop)),
        ("phase", field.enter_at(&pose, f64::INFINITY).map(drop)),
        ("gain", field.observe(&mut state, &pose, 1.5)),
        ("horizon", field.predict(&state, f64::NAN, 30.0).map(drop)),
        ("rate", field.predict(&state, 1e9, 1e9).map(drop)),
        (
            "parameters",
            state.clone().with_parameters(&[0.1]).map(drop),
        ),
    ];
    for (name, result) in refused {
        assert!(result.is_err_and(|e| e.is_invalid()), "{name}");
    }
    let default = FlowSettings::default;
    let settings = [
        FlowSettings {
            pieces: 4,
            ..default()
        },
        FlowSettings {
            neighbours: 0,
            ..default()
        },
        FlowSettings {
            courses: Some(513),
            ..default()
        },
        FlowSettings {
            correction: f64::NAN,
            ..default()
        },
        FlowSettings {
            window: [0.1, 0.6],
            ..default()
        },
    ];
    for wrong in settings {
        assert!(Flowfield::of(&primitive, &wrong).is_err(), "{wrong:?}");
    }
    assert_eq!(FlowSettings::paper().memory, Memory::None);
}
