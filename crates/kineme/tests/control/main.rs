//! Laws of moving a body along courses: nothing jumps, nothing is lost, every movement comes to its end.

mod arbitration;
mod feedback;
mod plans;
mod vocabulary;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use kineme::choreography::perform;
use kineme::control::{
    Command, Entry, Inertialization, Manner, Pace, State, Synthesis, Synthesizer,
};
use kineme::math::rotation::exp;
use kineme::{Course, Root, Skeleton};
use nalgebra::Vector3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use vocabulary::{WALK_M_S, WALK_RAD_S, course, gap, of_adonis, of_ares, posture, raise};

/// Fine enough that a jump in velocity cannot hide in the acceleration.
const FINE_HZ: f64 = 1000.0;
/// The greatest curvature of the hyperbolic tangent, by which smooth limits bend.
const TANH_BENDS: f64 = 0.77;

/// Holds every coordinate to its limits.
fn within_limits(body: &Skeleton, pose: &[f64]) {
    for (j, joint) in body.joints().iter().enumerate() {
        let at = &pose[body.coordinates(j)];
        let axes = [joint.axes.flexion, joint.axes.abduction, joint.axes.axial];
        for (k, range) in body.limits(j).iter().enumerate() {
            let x = if at.len() == 3 {
                axes[k].dot(&Vector3::from_column_slice(at))
            } else {
                at[0]
            };
            let slack = 1e-9;
            assert!(
                x >= range.low - slack && x <= range.high + slack,
                "{}: {x}",
                joint.name
            );
        }
    }
}

/// The greatest speed and acceleration of any joint on a course by itself.
fn own(course: &Course, speed: f64) -> [f64; 2] {
    let n = 2000;
    let h = course.duration_secs() / f64::from(n);
    let velocity = |k: i32| {
        let s = course.sample(course.phase_at(h * f64::from(k)));
        let v: Vec<f64> = s.slope.iter().map(|v| v / s.secs_per_phase).collect();
        v
    };
    let mut most = [0.0_f64; 2];
    let mut before = velocity(0);
    for k in 1..n {
        let now = velocity(k);
        most[0] = most[0].max(now.iter().fold(0.0, |m, v| m.max(v.abs())));
        most[1] = most[1].max(gap(&before, &now) / h);
        before = now;
    }
    [most[0] * speed, most[1] * speed * speed]
}

/// What the documentation states: the speed and acceleration that a body may have while it joins a course.
fn stated(settings: &Inertialization, course: &Course, speed: f64, before: &Command) -> [f64; 2] {
    let [v, a] = own(course, speed);
    let apart = v + before.velocity.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let s = settings.blend_secs;
    let fade = 5.78 / 1.875 * settings.max_speed / s;
    let most = v + settings.max_speed + apart;
    // A course that is shorter than the blend, or nearly over, waits in less time.
    let waits = 0.75 / s.min(0.5 * course.duration_secs() / speed);
    [most, a + fade + 3.95 * apart / s + waits * v]
}

/// Steps on, holding everything to the bounds; the last command.
fn run(
    synthesizer: &mut Synthesizer,
    bounds: [f64; 2],
    mut until: impl FnMut(&Command) -> bool,
    what: &str,
) -> Command {
    let body = Arc::clone(synthesizer.body());
    let h = 1.0 / synthesizer.rate_hz();
    let [speed, acceleration] = bounds;
    let mut before = synthesizer.command().clone();
    for _ in 0..(20.0 / h) as usize {
        let now = synthesizer.step().clone();
        within_limits(&body, &now.pose);
        let limited = now.limited + before.limited > 0;
        // Limits bend: a transition of 3 degrees, of vertebrae less.
        let bends = if limited {
            TANH_BENDS * speed * speed / 0.012
        } else {
            0.0
        };
        let jump = gap(&now.pose, &before.pose);
        assert!(
            jump <= speed * h,
            "{what}: a jump of {jump} at {}",
            now.phase
        );
        let kick = gap(&now.velocity, &before.velocity) / h;
        assert!(
            kick <= acceleration + bends,
            "{what}: {kick} > {acceleration} at {}",
            now.phase
        );
        let mean: Vec<f64> = now
            .velocity
            .iter()
            .zip(&before.velocity)
            .map(|(a, b)| 0.5 * (a + b) * h)
            .collect();
        let moved: Vec<f64> = now
            .pose
            .iter()
            .zip(&before.pose)
            .map(|(a, b)| a - b)
            .collect();
        assert!(
            gap(&mean, &moved) <= 0.25 * (acceleration + bends) * h * h + 1e-12,
            "{what}"
        );
        before = now;
        if until(&before) {
            return before;
        }
    }
    panic!("{what}: never came to an end");
}

#[test]
fn from_any_posture_every_movement_is_reached_and_completed() {
    let settings = Inertialization::default();
    let mut random = Pcg64::seed_from_u64(7);
    for (primitives, postures, rate) in [(of_adonis(), 100, 250.0), (of_ares(), 10, FINE_HZ)] {
        let body = primitives[0].body();
        for primitive in primitives {
            let course = course(primitive, 0.3);
            for n in 0..postures {
                let what = format!("{} on {} from {n}", primitive.name(), body.name());
                let root = Root {
                    position: Vector3::new(1.0, -2.0, 0.8),
                    yaw: 2.0,
                };
                let from = State::resting(posture(body, &mut random), root);
                let mut s =
                    Synthesizer::new(Arc::clone(body), rate, &from, settings).expect("a body");
                assert_eq!(s.command().pose.len(), body.dof());
                let entry = [Entry::Start, Entry::MATCHED][n % 2];
                let manner = Manner {
                    entry,
                    cycles: Some(1),
                    ..Manner::default()
                };
                s.start(Arc::clone(&course), &manner).expect("a start");
                let entered = s.command().phase;
                assert!(entered <= 0.5 || course.is_cyclic());
                let bounds = stated(&settings, &course, 1.0, s.command());
                let mut phase = entered;
                let mut secs = 0.0;
                let end = run(
                    &mut s,
                    bounds,
                    |c| {
                        assert!(
                            c.phase >= phase || course.is_cyclic(),
                            "{what}: phase went back"
                        );
                        phase = c.phase;
                        secs += 1.0 / rate;
                        c.finished
                    },
                    &what,
                );
                // From the farthest corner of a shoulder's limits, five radians away.
                assert!(secs <= course.duration_secs() + 2.4, "{what}: {secs} s");
                let last = if course.is_cyclic() { entered } else { 1.0 };
                let mut wanted = course.pose(last);
                body.limited(&mut wanted);
                assert!(gap(&end.pose, &wanted) < 2.0 * bounds[0] / rate, "{what}");
                // And it stays there.
                let mut left = rate as usize;
                let held = run(
                    &mut s,
                    bounds,
                    |_| {
                        left -= 1;
                        left == 0
                    },
                    &what,
                );
                assert!(gap(&held.pose, &wanted) < 1e-12 && held.finished, "{what}");
                assert!(held.velocity.iter().all(|v| *v == 0.0), "{what}");
            }
        }
    }
}

#[test]
fn any_movement_follows_any_other_at_any_moment() {
    let settings = Inertialization::default();
    let mut random = Pcg64::seed_from_u64(11);
    for primitives in [of_adonis(), of_ares()] {
        let body = primitives[0].body();
        for first in primitives {
            for second in primitives {
                for entry in [Entry::Start, Entry::MATCHED] {
                    let what = format!(
                        "{} after {} on {}",
                        second.name(),
                        first.name(),
                        body.name()
                    );
                    let (a, b) = (
                        course(first, random.random()),
                        course(second, random.random()),
                    );
                    let from = State::on_course(&a, 0.0, 1.0);
                    let mut s = Synthesizer::new(Arc::clone(body), FINE_HZ, &from, settings)
                        .expect("a body");
                    s.start(Arc::clone(&a), &Manner::default())
                        .expect("a start");
                    let switch = random.random_range(0.05..0.95);
                    let mut bounds = stated(&settings, &a, 1.0, s.command());
                    run(&mut s, bounds, |c| c.phase >= switch, &what);
                    let speed = random.random_range(0.6..1.5);
                    let manner = Manner {
                        entry,
                        pace: Pace::Times(speed),
                        cycles: Some(1),
                    };
                    let before = s.command().clone();
                    s.start(Arc::clone(&b), &manner).expect("a start");
                    bounds = stated(&settings, &b, speed, &before);
                    run(&mut s, bounds, |c| c.finished, &what);
                }
            }
        }
    }
}

#[test]
fn the_root_changes_its_velocity_without_a_jump() {
    let primitives = of_adonis();
    let walk = course(&primitives[3], 0.5);
    let reach = course(&primitives[0], 0.5);
    let settings = Inertialization::default();
    let from = State::resting(
        reach.pose(0.0),
        Root {
            position: Vector3::new(0.0, 0.0, 0.7),
            yaw: 1.0,
        },
    );
    let mut s =
        Synthesizer::new(Arc::clone(walk.body()), FINE_HZ, &from, settings).expect("a body");
    let mut roots = vec![s.command().root];
    for (course, steps) in [
        (&walk, 1700),
        (&reach, 300),
        (&walk, 220),
        (&walk, 1300),
        (&reach, 2500),
    ] {
        // Told twice is told once.
        for _ in 0..2 {
            s.start(Arc::clone(course), &Manner::default())
                .expect("a start");
        }
        roots.extend((0..steps).map(|_| s.step().root));
    }
    let h = 1.0 / FINE_HZ;
    let mut before: Option<(Vector3<f64>, f64)> = None;
    for pair in roots.windows(2) {
        let speed = (pair[1].position - pair[0].position) / h;
        let turn = (pair[1].yaw - pair[0].yaw) / h;
        if let Some((v, w)) = before {
            // 1.2 m/s in 0.4 s, a metre's rise a second, and a bob of 2 cm twice a second.
            let bound = 1.875 * 1.3 / 0.4 + 31.0 * 0.3 + 2.0 * 0.02 * (2.0 * TAU).powi(2);
            assert!(
                (speed - v).norm() / h < bound,
                "{} m/s^2",
                (speed - v).norm() / h
            );
            assert!((turn - w).abs() / h < 1.9 * WALK_RAD_S / 0.4);
        }
        before = Some((speed, turn));
    }
    let last = roots[roots.len() - 1];
    assert_eq!(roots[roots.len() - 2], last, "a reach does not walk");
}

#[test]
fn walking_walks() {
    let walk = course(&of_adonis()[3], 0.0);
    let cycles = 4;
    for (rate, speed) in [(30.0, 1.0), (120.0, 1.0), (120.0, 1.6)] {
        let synthesis = Synthesis {
            rate_hz: rate,
            manner: Manner {
                cycles: Some(cycles),
                pace: Pace::Times(speed),
                ..Manner::default()
            },
            ..Synthesis::default()
        };
        let motion = synthesis.motion("walk", &walk).expect("a motion").motion;
        let secs = motion.duration_secs();
        assert!((secs - f64::from(cycles) * walk.duration_secs() / speed).abs() <= 1.0 / rate);
        let root = motion.root(motion.frames() - 1);
        let yaw = WALK_RAD_S * secs * speed;
        let radius = WALK_M_S / WALK_RAD_S;
        let wanted = Vector3::new(
            radius * yaw.sin(),
            radius * (1.0 - yaw.cos()),
            root.position.z,
        );
        assert!((root.yaw - yaw).abs() < 0.02, "{} {yaw}", root.yaw);
        assert!(
            (root.position - wanted).norm() < 0.02 * radius * yaw,
            "{root:?} {wanted:?}"
        );
        let heights = motion.roots().iter().map(|r| r.position.z);
        let (low, high) = heights.fold((9.0_f64, 0.0_f64), |(l, h), z| (l.min(z), h.max(z)));
        assert!(
            (low - 0.88).abs() < 2e-3 && (high - 0.92).abs() < 2e-3,
            "{low} {high}"
        );
    }
}

#[test]
fn from_its_own_start_a_course_is_followed_as_it_is() {
    for primitives in [of_adonis(), of_ares()] {
        for primitive in primitives {
            for (rate, pace) in [
                (30.0, Pace::Times(1.0)),
                (97.0, Pace::Times(0.7)),
                (120.0, Pace::Secs(1.35)),
            ] {
                let course = course(primitive, 0.4);
                let manner = Manner {
                    pace,
                    ..Manner::default()
                };
                let synthesis = Synthesis {
                    rate_hz: rate,
                    manner,
                    ..Synthesis::default()
                };
                let made = synthesis.motion("m", &course).expect("a motion").motion;
                let secs = course.duration_secs();
                let speed = match pace {
                    Pace::Times(speed) => speed,
                    Pace::Secs(s) => secs / s,
                };
                for f in 0..made.frames() {
                    let at = f as f64 / rate * speed;
                    if at > secs + 1e-9 {
                        assert_eq!(f, made.frames() - 1);
                        continue;
                    }
                    let mut wanted = course.pose(course.phase_at(at));
                    course.body().limited(&mut wanted);
                    let off = gap(made.pose(f), &wanted);
                    assert!(off < 1e-9, "{} {f}: {off}", primitive.name());
                }
                assert!(made.duration_secs() * speed >= secs - 1e-9);
            }
        }
    }
}

#[test]
fn cycles_follow_one_another_without_a_seam() {
    let walk = course(&of_ares()[3], 0.7);
    let settings = Inertialization::default();
    let from = State::on_course(&walk, 0.0, 1.0);
    let mut s =
        Synthesizer::new(Arc::clone(walk.body()), FINE_HZ, &from, settings).expect("a body");
    s.start(Arc::clone(&walk), &Manner::default())
        .expect("a start");
    let [speed, acceleration] = own(&walk, 1.0);
    let mut seams = 0;
    let mut phase = 0.0;
    run(
        &mut s,
        [1.01 * speed, 1.1 * acceleration],
        |c| {
            seams += usize::from(c.phase < phase);
            phase = c.phase;
            seams == 5 && phase > 0.3
        },
        "walk",
    );
    assert!(!s.command().finished, "nobody said how often");
    s.finish();
    let bounds = stated(&settings, &walk, 1.0, s.command());
    let mut steps = 0;
    run(
        &mut s,
        bounds,
        |c| {
            steps += 1;
            c.finished
        },
        "walk",
    );
    let left = 0.7 * walk.duration_secs();
    assert!(
        (f64::from(steps) / FINE_HZ - left).abs() < 0.1,
        "{steps} steps to the end of the cycle"
    );
}

#[test]
fn a_duration_is_met_exactly() {
    let mut random = Pcg64::seed_from_u64(3);
    for primitive in of_adonis() {
        let course = course(primitive, 0.8);
        for secs in [0.25, 0.8, 2.0, 5.0] {
            for from_afar in [false, true] {
                let from = from_afar
                    .then(|| State::resting(posture(course.body(), &mut random), Root::ORIGIN));
                let synthesis = Synthesis {
                    rate_hz: 100.0,
                    from,
                    manner: Manner {
                        pace: Pace::Secs(secs),
                        ..Manner::default()
                    },
                    ..Synthesis::default()
                };
                let made = synthesis.motion("m", &course).expect("a motion").motion;
                let what = format!("{} in {secs} s", primitive.name());
                assert_eq!(made.frames(), (100.0 * secs) as usize + 1, "{what}");
                let mut end = course.pose(if course.is_cyclic() { 0.0 } else { 1.0 });
                course.body().limited(&mut end);
                let last = made.pose(made.frames() - 1);
                assert!(gap(last, &end) < 1e-9, "{what}: {}", gap(last, &end));
            }
        }
    }
}

#[test]
fn a_movement_under_way_is_joined_where_it_is() {
    for primitive in [&of_adonis()[2], &of_adonis()[3], &of_ares()[0]] {
        let course = course(primitive, 0.6);
        let latest = if course.is_cyclic() { 0.99 } else { 0.5 };
        for phase in [0.0, 0.004, 0.1, 0.31, latest] {
            let from = State::on_course(&course, phase, 1.0);
            let mut s = Synthesizer::new(
                Arc::clone(course.body()),
                120.0,
                &from,
                Inertialization::default(),
            )
            .expect("a body");
            let manner = Manner {
                entry: Entry::MATCHED,
                ..Manner::default()
            };
            s.start(Arc::clone(&course), &manner).expect("a start");
            let found = s.command().phase;
            let off = (found - phase + 0.5).rem_euclid(1.0) - 0.5;
            assert!(
                off.abs() < 1e-4,
                "{}: {phase}, found {found}",
                primitive.name()
            );
            let first = s.command().pose.clone();
            let wanted = course.pose(course.advance(phase, 1.0 / 120.0));
            assert!(
                gap(&s.step().pose, &wanted) < 1e-3 && gap(&first, &course.pose(phase)) < 1e-12
            );
        }
    }
    // The same way back: only the velocity tells the phase.
    let wave = course(&of_adonis()[2], 0.5);
    let mut back = State::on_course(&wave, 0.2, 1.0);
    for v in &mut back.velocity {
        *v = -*v;
    }
    let mut s = Synthesizer::new(
        Arc::clone(wave.body()),
        120.0,
        &back,
        Inertialization::default(),
    )
    .expect("a body");
    let manner = Manner {
        entry: Entry::Matched { latest: 0.9 },
        ..Manner::default()
    };
    s.start(wave, &manner).expect("a start");
    assert!(s.command().phase > 0.55, "{}", s.command().phase);
}

#[test]
fn a_body_in_step_with_a_course_changes_its_pace_smoothly() {
    let settings = Inertialization::default();
    for primitive in [&of_adonis()[2], &of_ares()[3]] {
        let course = course(primitive, 0.2);
        let from = State::on_course(&course, 0.3, 1.0);
        let mut s =
            Synthesizer::new(Arc::clone(course.body()), FINE_HZ, &from, settings).expect("a body");
        let manner = Manner {
            entry: Entry::MATCHED,
            pace: Pace::Secs(1.8),
            cycles: Some(1),
        };
        s.start(Arc::clone(&course), &manner).expect("a start");
        assert!((s.command().phase - 0.3).abs() < 0.1);
        let bounds = stated(&settings, &course, 1.0, s.command());
        assert!((s.remaining_secs() - 1.8).abs() < 1e-9);
        let mut steps = 0;
        let mut count = |c: &Command| {
            steps += 1;
            c.finished
        };
        run(&mut s, bounds, &mut count, primitive.name());
        assert_eq!(steps, 1800, "{}", primitive.name());
    }
}

#[test]
fn a_joint_whose_rotation_has_two_names_turns_the_short_way() {
    let reach = course(&of_ares()[0], 0.5);
    let body = Arc::clone(reach.body());
    let pelvis = body.coordinates(0);
    let mut from = State::resting(reach.pose(0.0), Root::ORIGIN);
    // Turned by more than half a turn to the left: less than half a turn to the right.
    from.pose[pelvis.clone()].copy_from_slice(&[0.1, 0.0, 1.15 * PI]);
    from.velocity[pelvis.clone()].copy_from_slice(&[0.5, -0.3, 0.2]);
    let rate = FINE_HZ;
    let mut s = Synthesizer::new(body, rate, &from, Inertialization::default()).expect("a body");
    let turn = |c: &Command| exp(&Vector3::from_column_slice(&c.pose[pelvis.clone()]));
    let mut before = turn(s.command());
    let held = turn(s.step());
    let first = held * before.inverse();
    s.start(reach, &Manner::default()).expect("a start");
    let mut previous = first;
    let mut whole = 0.0;
    before = held;
    while !s.command().finished {
        let now = turn(s.step());
        let step = now * before.inverse();
        assert!(
            step.angle_to(&previous) < 120.0 / (rate * rate),
            "{}",
            step.angle_to(&previous) * rate * rate
        );
        whole += step.angle();
        (previous, before) = (step, now);
    }
    assert!(whole < 0.9 * PI, "{whole}");
}

#[test]
fn a_limited_joint_under_its_other_name_is_taken_for_what_it_is() {
    let reach = course(&of_ares()[0], 0.5);
    let body = Arc::clone(reach.body());
    let shoulder = body.coordinates(body.joint("right_shoulder").expect("a shoulder"));
    // Within the limits, and its other name not a long way beyond a half turn.
    let angle: f64 = 0.85 * PI;
    let mut within = vec![0.0; body.dof()];
    for axis in [
        Vector3::x(),
        Vector3::y(),
        Vector3::z(),
        -Vector3::x(),
        -Vector3::y(),
        -Vector3::z(),
    ] {
        let mut pose = within.clone();
        pose[shoulder.clone()].copy_from_slice((axis * angle).as_slice());
        if body.limited(&mut pose.clone()) == 0 {
            within = pose;
            break;
        }
    }
    assert!(
        within[shoulder.clone()].iter().any(|v| *v != 0.0),
        "no such posture"
    );
    let mut other = within.clone();
    for v in &mut other[shoulder] {
        *v *= (angle - TAU) / angle;
    }
    let from = State::resting(other, Root::ORIGIN);
    let s = Synthesizer::new(body, 120.0, &from, Inertialization::default()).expect("a body");
    assert!(gap(&s.command().pose, &within) < 1e-12);
    assert_eq!(s.command().limited, 0);
}

#[test]
fn the_pose_of_a_file_begins_the_motion() {
    let wave = course(&of_adonis()[2], 0.5);
    let body = Arc::clone(wave.body());
    let file = perform("file", &raise(0.3), &body, 60.0).expect("keys");
    let synthesis = Synthesis {
        from: Some(State::at_frame(&file, 20).expect("a frame")),
        ..Synthesis::default()
    };
    let made = synthesis.motion("m", &wave).expect("a motion");
    assert_eq!(made.motion.rate_hz(), 120.0);
    let mut first = file.pose(20).to_vec();
    let limited = body.limited(&mut first);
    assert_eq!(made.motion.pose(0), first);
    assert_eq!(made.motion.root(0), file.root(20));
    assert!((made.limited_frames > 0) >= (limited > 0));
    assert!(State::at_frame(&file, file.frames()).is_err_and(|e| e.is_invalid()));
}

#[test]
fn what_cannot_be_run_is_refused() {
    let reach = course(&of_adonis()[0], 0.5);
    let body = Arc::clone(reach.body());
    let good = State::on_course(&reach, 0.0, 1.0);
    let settings = Inertialization::default();
    let new = |rate: f64, state: &State, settings| {
        Synthesizer::new(Arc::clone(&body), rate, state, settings)
    };
    let short = State {
        pose: vec![0.0],
        ..good.clone()
    };
    let nan = State {
        rise: f64::NAN,
        ..good.clone()
    };
    let still = Inertialization {
        max_speed: 0.0,
        ..settings
    };
    for (made, says) in [
        (new(0.0, &good, settings), "rate"),
        (new(f64::INFINITY, &good, settings), "rate"),
        (new(60.0, &short, settings), "coordinates"),
        (new(60.0, &nan, settings), "finite"),
        (new(60.0, &good, still), "max_speed"),
    ] {
        assert!(
            made.is_err_and(|e| e.is_invalid() && e.to_string().contains(says)),
            "{says}"
        );
    }
    let mut s = new(60.0, &good, settings).expect("a body");
    let manner = Manner::default();
    for (manner, says) in [
        (
            Manner {
                pace: Pace::Times(f64::NAN),
                ..manner
            },
            "pace",
        ),
        (
            Manner {
                pace: Pace::Secs(0.0),
                ..manner
            },
            "pace",
        ),
        (
            Manner {
                pace: Pace::Secs(1e-4),
                ..manner
            },
            "own pace",
        ),
        (
            Manner {
                pace: Pace::Times(1e6),
                ..manner
            },
            "own pace",
        ),
        (
            Manner {
                cycles: Some(0),
                ..manner
            },
            "cycle",
        ),
        (
            Manner {
                entry: Entry::Matched { latest: 1.5 },
                ..manner
            },
            "latest",
        ),
    ] {
        let before = s.clone().step().clone();
        let told = s.start(Arc::clone(&reach), &manner);
        assert!(told.is_err_and(|e| e.to_string().contains(says)), "{says}");
        assert_eq!(*s.clone().step(), before, "a refusal changes nothing");
    }
    let foreign = s.start(course(&of_ares()[0], 0.5), &Manner::default());
    assert!(foreign.is_err_and(|e| e.to_string().contains("`ares`")));
    let endless = Synthesis {
        rate_hz: 1e7,
        ..Synthesis::default()
    };
    assert!(
        endless
            .motion("m", &reach)
            .is_err_and(|e| e.to_string().contains("frames"))
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_motion_is_the_fold_of_its_steps_to_the_last_bit(
        which in 0..4_usize, p in 0.0..1.0, rate in 20.0..240.0, secs in 0.3..3.0, afar: bool, matched: bool, seed: u64,
    ) {
        let course = course(&of_adonis()[which], p);
        let from = if afar {
            State::resting(posture(course.body(), &mut Pcg64::seed_from_u64(seed)), Root::ORIGIN)
        } else {
            State::on_course(&course, 0.2, 1.0)
        };
        let entry = if matched { Entry::MATCHED } else { Entry::Start };
        let manner = Manner { entry, pace: Pace::Secs(secs), cycles: None };
        let settings = Inertialization::default();
        let synthesis = Synthesis { rate_hz: rate, from: Some(from.clone()), manner, settings };
        let made = synthesis.motion("m", &course).expect("a motion");
        prop_assert_eq!(&made, &synthesis.motion("m", &course).expect("a motion"));
        let mut s = Synthesizer::new(Arc::clone(course.body()), rate, &from, settings).expect("a body");
        s.start(Arc::clone(&course), &manner).expect("a start");
        let mut frame = 0;
        loop {
            prop_assert_eq!(made.motion.pose(frame), &s.command().pose[..]);
            prop_assert_eq!(made.motion.root(frame), &s.command().root);
            if s.command().finished {
                break;
            }
            s.step();
            frame += 1;
        }
        prop_assert_eq!(frame + 1, made.motion.frames());
        prop_assert!((secs * rate..secs * rate + 1.0).contains(&(frame as f64 + 1e-6)));
    }
}
