//! Laws of behaviours that share a body: who moves which joint, and that nothing jumps when that changes.

use std::sync::Arc;

use kineme::control::{
    Active, Aiming, Arbitration, Command, Connection, ControlSettings, Controller, Effect, Entry,
    Manner, Percept, Place, Plan, Planned, Rule, State, Synthesis,
};
use kineme::{Course, Motion, Root, Vocabulary};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::plans::plan;
use crate::vocabulary::{course, gap, of_adonis, of_ares, posture, vocabulary_of};

const WHOLE: [&str; 6] = [
    "left_arm",
    "right_arm",
    "trunk",
    "head",
    "left_leg",
    "right_leg",
];

fn parts(names: &[&str]) -> Vec<String> {
    names.iter().map(|n| n.to_string()).collect()
}

fn resting(vocabulary: &Vocabulary) -> State {
    State::resting(vocabulary.body().neutral(), Root::ORIGIN)
}

fn controller<'v>(
    vocabulary: &'v Vocabulary,
    plan: &Plan,
    start: &State,
    settings: &ControlSettings,
) -> Controller<'v> {
    Controller::new(vocabulary, plan, start, settings).expect("a plan")
}

/// The commands of a plan to its end, the first the one it begins with.
fn run(vocabulary: &Vocabulary, plan: &Plan, start: &State) -> Vec<Command> {
    let mut c = controller(vocabulary, plan, start, &ControlSettings::default());
    let mut commands = vec![c.command().clone()];
    while !c.finished() {
        commands.push(c.tick(None, None).clone());
    }
    commands
}

fn coordinates(vocabulary: &Vocabulary, names: &[&str]) -> Vec<usize> {
    let body = vocabulary.body();
    let of = |name: &&str| body.coordinates(body.joint(name).expect("a joint"));
    names.iter().flat_map(of).collect()
}

#[test]
fn one_behavior_on_the_whole_body_is_its_synthesis_bit_for_bit() {
    let mut random = Pcg64::seed_from_u64(5);
    for primitives in [of_adonis(), of_ares()] {
        let vocabulary = vocabulary_of(primitives);
        for primitive in primitives {
            for afar in [false, true] {
                let made = course(primitive, 0.3);
                let start = if afar {
                    State::resting(posture(vocabulary.body(), &mut random), Root::ORIGIN)
                } else {
                    State::on_course(&made, 0.0, 1.0)
                };
                let planned = Planned {
                    joints: parts(&WHOLE),
                    aim: Aiming::Parameters(vec![0.3]),
                    repeat: 1,
                    ..Planned::new(primitive.name())
                };
                let mut asked = plan(vec![planned]);
                asked.seconds = 9.0;
                let synthesis = Synthesis {
                    from: Some(start.clone()),
                    manner: Manner {
                        entry: if made.is_cyclic() {
                            Entry::MATCHED
                        } else {
                            Entry::Start
                        },
                        ..Manner::default()
                    },
                    ..Synthesis::default()
                };
                let motion: Motion = synthesis.motion("m", &made).expect("a motion").motion;
                let commands = run(&vocabulary, &asked, &start);
                let what = format!("{} of {}", primitive.name(), vocabulary.body().name());
                for (f, command) in commands[..motion.frames()].iter().enumerate() {
                    assert_eq!(command.pose, motion.pose(f), "{what}, frame {f}");
                    assert_eq!(command.root, *motion.root(f), "{what}, frame {f}");
                    let ends = f + 1 == motion.frames() || f == 0;
                    assert_eq!(command.finished, ends, "{what}, frame {f}");
                }
                let end = &commands[commands.len() - 1];
                assert!(end.finished && end.velocity.iter().all(|v| *v == 0.0));
            }
        }
    }
}

#[test]
fn behaviors_on_other_joints_do_not_disturb_one_another_and_the_rest_holds() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let wave = || Planned::new("wave");
    let raise = || Planned {
        start_secs: 0.3,
        ..Planned::new("raise")
    };
    let right = coordinates(
        &vocabulary,
        &["right_shoulder", "right_elbow", "right_wrist"],
    );
    let left = coordinates(&vocabulary, &["left_shoulder", "left_elbow", "left_wrist"]);
    for arbitration in [Arbitration::Priority, Arbitration::Superposition] {
        let with = |behaviors| Plan {
            arbitration,
            seconds: 2.0,
            ..plan(behaviors)
        };
        let both = run(&vocabulary, &with(vec![wave(), raise()]), &start);
        let alone = [
            run(&vocabulary, &with(vec![wave()]), &start),
            run(&vocabulary, &with(vec![raise()]), &start),
        ];
        for (f, command) in both.iter().enumerate() {
            for c in 0..start.pose.len() {
                let wanted = if right.contains(&c) {
                    alone[0][f].pose[c]
                } else if left.contains(&c) {
                    alone[1][f].pose[c]
                } else {
                    start.pose[c]
                };
                assert_eq!(command.pose[c], wanted, "coordinate {c}, frame {f}");
            }
        }
    }
}

#[test]
fn weights_superpose_what_each_behavior_would_do_alone() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let one = |name: &str, weight: f64| Planned {
        joints: parts(&["right_arm"]),
        weight,
        repeat: 4,
        ..Planned::new(name)
    };
    let with = |behaviors| Plan {
        arbitration: Arbitration::Superposition,
        ..plan(behaviors)
    };
    let both = run(
        &vocabulary,
        &with(vec![one("reach", 1.0), one("wave", 3.0)]),
        &start,
    );
    let reach = run(&vocabulary, &with(vec![one("reach", 1.0)]), &start);
    let wave = run(&vocabulary, &with(vec![one("wave", 3.0)]), &start);
    let shoulder = coordinates(&vocabulary, &["right_shoulder", "right_elbow"]);
    let mut apart = 0.0_f64;
    for f in 0..both.len() {
        for &c in &shoulder {
            let mean =
                |of: fn(&Command) -> &Vec<f64>| 0.25 * of(&reach[f])[c] + 0.75 * of(&wave[f])[c];
            assert!((both[f].pose[c] - mean(|c| &c.pose)).abs() < 1e-12);
            assert!((both[f].velocity[c] - mean(|c| &c.velocity)).abs() < 1e-12);
            apart = apart.max((reach[f].pose[c] - wave[f].pose[c]).abs());
        }
    }
    assert!(apart > 0.5, "nothing was superposed");
}

#[test]
fn a_movement_that_is_interrupted_is_resumed_and_completed() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    for (name, repeat, moment) in [("wave", 2, 0.6), ("wave", 1, 1.0), ("walk", 3, 1.7)] {
        let asked = Plan {
            seconds: 8.0,
            ..plan(vec![
                Planned {
                    joints: parts(&["right_arm"]),
                    repeat,
                    ..Planned::new(name)
                },
                Planned {
                    start_secs: moment,
                    priority: 1,
                    ..Planned::new("reach")
                },
            ])
        };
        let mut c = controller(&vocabulary, &asked, &start, &ControlSettings::default());
        let mut phases = [0.0, 0.0];
        while !c.finished() {
            let before: Vec<Active> = c.active();
            c.tick(None, None);
            if before.len() == 1 && c.active().len() == 2 {
                phases[0] = before[0].phase;
                assert_eq!(c.active()[0].weight, 0.0, "the reach has the arm");
                assert_eq!(c.active()[1].weight, 1.0, "the reach has the arm");
            }
            if before.len() == 2 && c.active().len() == 1 {
                phases[1] = c.active()[0].phase;
            }
        }
        let ran: Vec<(&str, bool)> = c
            .ran()
            .iter()
            .map(|r| (r.primitive.as_str(), r.completed))
            .collect();
        assert_eq!(ran, [(name, false), ("reach", true), (name, true)]);
        let [first, reach, last] = c.ran() else {
            panic!("three stretches");
        };
        assert_eq!(first.planned, Place::Behavior(0));
        assert_eq!(first.end_secs, reach.start_secs);
        assert!((reach.start_secs - moment).abs() <= 1.0 / 120.0);
        assert_eq!(last.start_secs, reach.end_secs);
        assert!(last.end_secs < 8.0 && last.joints == ["right_arm"]);
        if name == "wave" {
            assert!(
                phases[1] <= phases[0] + 0.02,
                "nothing is left out: {phases:?}"
            );
        }
    }
}

#[test]
fn what_loses_some_joints_goes_on_and_what_loses_most_waits() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let low = |name: &str| Planned {
        repeat: 4,
        ..Planned::new(name)
    };
    let high = |name: &str| Planned {
        priority: 1,
        start_secs: 0.4,
        ..Planned::new(name)
    };
    let with = |behaviors| Plan {
        seconds: 7.0,
        ..plan(behaviors)
    };
    let right = coordinates(
        &vocabulary,
        &["right_shoulder", "right_elbow", "right_wrist"],
    );
    // Walking loses one arm of two: the other goes on as if nothing were, and the one that is given back joins it.
    let both = run(&vocabulary, &with(vec![low("walk"), high("wave")]), &start);
    let alone = run(&vocabulary, &with(vec![low("walk")]), &start);
    let mut parted = 0.0_f64;
    for (f, (a, b)) in both.iter().zip(&alone).enumerate() {
        for c in 0..start.pose.len() {
            if right.contains(&c) {
                parted = parted.max((a.pose[c] - b.pose[c]).abs());
            } else {
                assert_eq!(a.pose[c], b.pose[c], "frame {f}");
            }
        }
        assert_eq!(a.root, b.root, "frame {f}");
        if f > 3 * 120 {
            assert_eq!(a.pose, b.pose, "frame {f}");
        }
    }
    assert!(parted > 0.3);
    // A reach without its arm is none: its trunk waits, too.
    let later = Planned {
        start_secs: 1.2,
        ..high("wave")
    };
    let both = run(&vocabulary, &with(vec![low("reach"), later]), &start);
    let waist = coordinates(&vocabulary, &["waist"]);
    let turned = |from: usize, to: usize| {
        let turned = waist
            .iter()
            .map(|&c| (both[from].pose[c] - both[to].pose[c]).abs());
        turned.fold(0.0, f64::max)
    };
    assert!((0..144).any(|f| turned(0, f) > 0.02));
    assert_eq!(turned(200, 250), 0.0);
    let end = &both[both.len() - 1].pose;
    assert!(
        gap(
            end,
            &run(&vocabulary, &with(vec![low("reach")]), &start)[800].pose
        ) < 1e-9
    );
}

#[test]
fn the_winner_has_the_whole_body() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let one = |name: &str, weight: f64, start_secs: f64| Planned {
        weight,
        start_secs,
        ..Planned::new(name)
    };
    // Challengers of other joints than the wave's: too weak, strong enough.
    for (weight, wins) in [(1.05, false), (1.2, true)] {
        let asked = Plan {
            arbitration: Arbitration::Winner,
            seconds: 6.0,
            ..plan(vec![one("wave", 1.0, 0.0), one("raise", weight, 0.3)])
        };
        let mut c = controller(&vocabulary, &asked, &start, &ControlSettings::default());
        let mut idle = 0;
        while !c.finished() {
            c.tick(None, None);
            let moving = c.active().iter().filter(|a| a.weight > 0.0).count();
            assert!(moving <= 1);
            idle += usize::from(moving == 0 && !c.active().is_empty());
        }
        assert!(idle <= 1, "nobody moves for {idle} ticks");
        let ran: Vec<&str> = c.ran().iter().map(|r| r.primitive.as_str()).collect();
        let wanted: &[&str] = if wins {
            &["wave", "raise", "wave"]
        } else {
            &["wave", "raise"]
        };
        assert_eq!(ran, wanted, "{weight}");
        let challenge = c.ran()[1].start_secs;
        assert!(!wins || (challenge - 0.4).abs() < 0.02, "{challenge}");
    }
}

#[test]
fn a_rule_answers_once_each_time_that_something_is_newly_recognised() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let [reach, raise] = [Some(0), Some(1)];
    let seen = |primitive| Some(Percept { primitive });
    // What is seen at which tick, and at which ticks the answer (0.05 s later) begins.
    let check = |percepts: &[(u64, Option<Percept>)], answers: &[u64]| {
        let mut asked = plan(Vec::new());
        asked.seconds = 5.0;
        asked.rules.push(Rule {
            when: "raise".into(),
            then: Planned {
                start_secs: 0.05,
                pace: 3.0,
                ..Planned::new("wave")
            },
        });
        let mut c = controller(&vocabulary, &asked, &start, &ControlSettings::default());
        for tick in 0..500 {
            let seen = percepts
                .iter()
                .find(|(at, _)| *at == tick)
                .and_then(|(_, p)| *p);
            c.tick(None, seen.as_ref());
        }
        let began: Vec<u64> = c
            .ran()
            .iter()
            .map(|r| (r.start_secs * 120.0).round() as u64)
            .collect();
        assert_eq!(began, answers, "{percepts:?}");
        assert!(c.ran().iter().all(|r| r.planned == Place::Rule(0)));
    };
    check(&[], &[]);
    check(&[(3, seen(reach)), (9, seen(None))], &[]);
    check(&[(3, seen(raise))], &[9]);
    // Seen on and on, or nothing new: one answer.
    check(
        &[(3, seen(raise)), (4, seen(raise)), (200, seen(raise))],
        &[9],
    );
    check(
        &[(3, seen(raise)), (200, seen(None)), (300, seen(raise))],
        &[9, 306],
    );
    check(
        &[(3, seen(raise)), (200, seen(reach)), (300, seen(raise))],
        &[9, 306],
    );
    // Again while the answer is under way: it begins again.
    check(
        &[(3, seen(raise)), (20, seen(None)), (25, seen(raise))],
        &[9, 31],
    );
}

#[test]
fn behaviors_inhibit_suppress_select_and_aim_others() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let [first, second] = [Place::Behavior(0), Place::Behavior(1)];
    // The wave runs on the right arm; the raise, on the left, begins at 0.3 s and lasts some 0.7 s.
    let asked = Plan {
        seconds: 6.0,
        ..plan(vec![
            Planned {
                repeat: 2,
                ..Planned::new("wave")
            },
            Planned {
                start_secs: 0.3,
                ..Planned::new("raise")
            },
        ])
    };
    let run = |connections: Vec<Connection>| {
        let settings = ControlSettings {
            connections,
            ..ControlSettings::default()
        };
        let mut c = controller(&vocabulary, &asked, &start, &settings);
        let mut moved = vec![c.command().pose.clone()];
        while !c.finished() {
            moved.push(c.tick(None, None).pose.clone());
        }
        (moved, c.ran().to_vec())
    };
    let right = coordinates(&vocabulary, &["right_shoulder"]);
    let arm = |row: &[f64]| -> Vec<f64> { right.iter().map(|&c| row[c]).collect() };
    let at = |secs: f64| (secs * 120.0) as usize;
    let (free, ran) = run(Vec::new());
    assert_eq!(ran.len(), 2);

    let connect = |from, to, effect| vec![Connection { from, to, effect }];
    let (moved, ran) = run(connect(second, first, Effect::Inhibit));
    assert_eq!(moved[at(0.29)], free[at(0.29)]);
    assert!(
        gap(&arm(&moved[at(0.9)]), &arm(&moved[at(0.95)])) < 1e-9,
        "not heard"
    );
    assert!(gap(&arm(&free[at(0.9)]), &arm(&free[at(0.95)])) > 1e-3);
    // It has run on unheard, and is heard again where it would be.
    assert_eq!(ran.len(), 2);
    assert!(gap(&moved[at(2.2)], &free[at(2.2)]) < 1e-12);

    let (moved, ran) = run(connect(second, first, Effect::Suppress { secs: 0.8 }));
    assert!(
        gap(&arm(&moved[at(0.9)]), &arm(&moved[at(0.95)])) < 1e-9,
        "stands still"
    );
    let waves: Vec<_> = ran.iter().filter(|r| r.planned == first).collect();
    assert!(waves.len() == 2 && (waves[1].start_secs - 1.1).abs() < 0.02);
    assert!(!waves[0].completed && waves[1].completed);

    let (_, ran) = run(connect(second, first, Effect::Select));
    let waves: Vec<_> = ran.iter().filter(|r| r.planned == first).collect();
    let raise = ran.iter().find(|r| r.planned == second).expect("a raise");
    assert!(waves.len() == 2 && waves[1].start_secs == raise.end_secs);
    assert!(!waves[0].completed && waves[1].completed);

    let high = Effect::Aim(Aiming::Parameters(vec![1.0]));
    let (moved, ran) = run(connect(second, first, high));
    assert_eq!((ran.len(), &moved[at(0.29)]), (2, &free[at(0.29)]));
    // The second wave is all higher.
    let wave: Arc<Course> = course(&of_adonis()[2], 1.0);
    let most = (at(1.3)..at(2.5)).map(|f| {
        let nearest =
            (0..=200).map(|k| gap(&arm(&moved[f]), &arm(&wave.pose(f64::from(k) / 200.0))));
        nearest.fold(f64::INFINITY, f64::min)
    });
    let most = most.fold(0.0, f64::max);
    assert!(most < 0.02, "{most}");
}

#[test]
fn joints_that_nobody_wants_go_back_to_rest_if_told_to() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = resting(&vocabulary);
    let asked = Plan {
        seconds: 5.0,
        ..plan(vec![Planned::new("raise")])
    };
    for rest_secs in [None, Some(1.0)] {
        let settings = ControlSettings {
            rest_secs,
            ..ControlSettings::default()
        };
        let mut c = controller(&vocabulary, &asked, &start, &settings);
        let mut secs = [0.0; 2];
        while !c.finished() {
            let before = c.command().pose.clone();
            c.tick(None, None);
            assert!(gap(&before, &c.command().pose) < 0.1);
            if c.command().finished && secs[0] == 0.0 {
                secs[0] = c.secs();
            }
            let later = secs[0] > 0.0 && c.secs() > secs[0] + 0.5;
            if later && secs[1] == 0.0 && gap(&before, &c.command().pose) > 1e-6 {
                secs[1] = c.secs();
            }
        }
        let away = gap(&c.command().pose, &start.pose);
        if rest_secs.is_some() {
            assert!((secs[1] - secs[0] - 1.0).abs() < 0.05, "{secs:?}");
            assert!(away < 1e-12, "{away}");
        } else {
            assert!(secs[1] == 0.0 && away > 0.5, "{secs:?} {away}");
        }
    }
}

/// The greatest speed and acceleration of the primitives by themselves.
fn own(vocabulary: &Vocabulary) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for primitive in vocabulary.primitives() {
        for p in [0.0, 0.5, 1.0] {
            let course = course(primitive, p);
            let h = 1e-3;
            let steps = (course.duration_secs() / h) as usize;
            let velocity = |k: usize| -> Vec<f64> {
                let s = course.sample(course.phase_at(h * k as f64));
                s.slope.iter().map(|v| v / s.secs_per_phase).collect()
            };
            for k in 1..steps {
                let (a, b) = (velocity(k - 1), velocity(k));
                most[0] = most[0].max(b.iter().fold(0.0, |m, v| m.max(v.abs())));
                most[1] = most[1].max(gap(&a, &b) / h);
            }
        }
    }
    most
}

fn planned() -> impl Strategy<Value = Planned> {
    let joints = prop_oneof![
        2 => Just(vec![]),
        1 => Just(parts(&["right_arm", "left_arm"])),
        1 => Just(parts(&WHOLE)),
    ];
    (
        (0..4_usize, 0.0..2.0, 1..3_u32),
        joints,
        (0.0..1.0, 0.7..1.4, 0.2..2.0, -1..2_i32),
    )
        .prop_map(
            |((k, start_secs, repeat), joints, (p, pace, weight, priority))| Planned {
                primitive: ["reach", "raise", "wave", "walk"][k].into(),
                start_secs,
                repeat,
                joints,
                aim: Aiming::Parameters(vec![p]),
                pace,
                weight,
                priority,
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn whatever_is_planned_no_command_jumps(
        behaviors in prop::collection::vec(planned(), 1..6),
        kind in 0..3_usize,
        seed in 0..1000_u64,
    ) {
        let vocabulary = vocabulary_of(of_adonis());
        let body = vocabulary.body();
        let start = State::resting(posture(body, &mut Pcg64::seed_from_u64(seed)), Root::ORIGIN);
        let rate_hz = 500.0;
        let asked = Plan {
            rate_hz,
            seconds: 6.0,
            arbitration: [Arbitration::Priority, Arbitration::Winner, Arbitration::Superposition][kind],
            ..plan(behaviors)
        };
        let commands = run(&vocabulary, &asked, &start);
        let [v, a] = own(&vocabulary).map(|x| 1.4 * 1.4 * x);
        // The documented bound: the flow's own, what waiting adds, and twice what joining adds.
        let apart = 2.0 * v + 4.0;
        let bound = a + 0.75 / 0.4 * v + 2.0 * (31.0 + 9.9 * apart);
        let speed = v + 2.0 * (4.0 + apart);
        for pair in commands.windows(2) {
            let limited = pair[0].limited + pair[1].limited > 0;
            let bends = if limited { 0.77 * speed * speed / 0.05 } else { 0.0 };
            prop_assert!(gap(&pair[0].pose, &pair[1].pose) <= speed / rate_hz);
            let kick = gap(&pair[0].velocity, &pair[1].velocity) * rate_hz;
            prop_assert!(kick <= bound + bends, "{} > {}", kick, bound);
            let told = pair[0].velocity.iter().zip(&pair[1].velocity).map(|(a, b)| 0.5 * (a + b) / rate_hz);
            let moved: Vec<f64> = pair[0].pose.iter().zip(&pair[1].pose).map(|(a, b)| b - a).collect();
            let told: Vec<f64> = told.collect();
            prop_assert!(gap(&told, &moved) <= 0.25 * (bound + bends) / (rate_hz * rate_hz) + 1e-12);
        }
        prop_assert_eq!(&commands, &run(&vocabulary, &asked, &start), "the same again");
    }
}
