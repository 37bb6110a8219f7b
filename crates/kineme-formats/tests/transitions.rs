//! Behaviours of the six vocabularies of `choreography/` on one body: any follows any other at any moment, some at a
//! time, one interrupts another.

use std::path::Path;
use std::sync::{Arc, LazyLock};
use std::time::Instant;

use kineme::control::{
    Aiming, Arbitration, ControlSettings, Controller, Plan, Planned, Sensed, State,
};
use kineme::primitive::{Modelling, Transitions};
use kineme::{Primitive, Root, Skeleton, Vocabulary, adonis, ares};
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

static ADONIS: LazyLock<Vocabulary> = LazyLock::new(|| all(adonis().expect("adonis")));
static ARES: LazyLock<Vocabulary> = LazyLock::new(|| all(ares().expect("ares")));

/// The primitives of all scripts as one vocabulary.
fn all(body: Skeleton) -> Vocabulary {
    let body = Arc::new(body);
    let mut primitives: Vec<Primitive> = Vec::new();
    for name in SCRIPTS {
        let file = format!("{name}.toml");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../choreography");
        let bytes = std::fs::read(folder.join(&file)).expect("a script");
        let script = kineme_formats::script::parse(&file, &bytes).expect("a valid script");
        let made = script.vocabulary(&body, &Modelling::default(), (&file, None));
        primitives.extend_from_slice(made.expect("a vocabulary").primitives());
    }
    let transitions = Transitions::none(primitives.len());
    Vocabulary::new(body, primitives, Vec::new(), transitions).expect("distinct names")
}

fn resting(vocabulary: &Vocabulary) -> State {
    State::resting(vocabulary.body().neutral(), Root::ORIGIN)
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    let far = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    far.fold(0.0, f64::max)
}

fn plan(rate_hz: f64, seconds: f64, behaviors: Vec<Planned>) -> Plan {
    Plan {
        rate_hz,
        seconds,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors,
        rules: Vec::new(),
    }
}

fn controller<'v>(vocabulary: &'v Vocabulary, plan: &Plan) -> Controller<'v> {
    let start = resting(vocabulary);
    Controller::new(vocabulary, plan, &start, &ControlSettings::default()).expect("a plan")
}

/// The greatest speed and acceleration of a primitive by itself at its middle.
fn own(primitive: &Primitive) -> [f64; 2] {
    let course = primitive.at(&primitive.middle()).expect("the middle");
    let h = 1e-3;
    let velocity = |k: usize| -> Vec<f64> {
        let s = course.sample(course.phase_at(h * k as f64));
        s.slope.iter().map(|v| v / s.secs_per_phase).collect()
    };
    let mut most = [0.0_f64; 2];
    let mut before = velocity(0);
    for k in 1..(course.duration_secs() / h) as usize {
        let now = velocity(k);
        most[0] = now.iter().fold(most[0], |m, v| m.max(v.abs()));
        most[1] = most[1].max(gap(&before, &now) / h);
        before = now;
    }
    most
}

#[test]
fn every_primitive_takes_over_from_every_other_without_a_jump() {
    let rate_hz = 250.0;
    for (vocabulary, phases) in [(&*ADONIS, &[0.2, 0.5, 0.8][..]), (&*ARES, &[0.45][..])] {
        let own: Vec<[f64; 2]> = vocabulary.primitives().iter().map(own).collect();
        let mut most = (0.0_f64, 0.0_f64, 0.0_f64);
        for (i, first) in vocabulary.primitives().iter().enumerate() {
            for (k, second) in vocabulary.primitives().iter().enumerate() {
                for phase in phases {
                    let secs =
                        |p: &Primitive| p.at(&p.middle()).expect("the middle").duration_secs();
                    let start_secs = phase * secs(first);
                    let seconds = start_secs + secs(first) + secs(second) + 3.5;
                    let asked = plan(
                        rate_hz,
                        seconds,
                        vec![
                            Planned::new(first.name()),
                            Planned {
                                start_secs,
                                priority: 1,
                                ..Planned::new(second.name())
                            },
                        ],
                    );
                    let mut c = controller(vocabulary, &asked);
                    let what = format!(
                        "{} after {:.0} % of {}",
                        second.name(),
                        100.0 * phase,
                        first.name()
                    );
                    // Documented: the flow's own, what waiting adds, twice what joining adds.
                    let v = own[i][0].max(own[k][0]);
                    let apart = 2.0 * v + 4.0;
                    let bound =
                        own[i][1].max(own[k][1]) + 0.75 / 0.4 * v + 2.0 * (31.0 + 9.9 * apart);
                    let speed = v + 2.0 * (4.0 + apart);
                    let mut before = c.command().clone();
                    while !c.finished() {
                        let now = c.tick(None, None).clone();
                        let kick = gap(&now.velocity, &before.velocity) * rate_hz;
                        let limited = now.limited + before.limited > 0;
                        let bends = if limited {
                            0.77 * speed * speed / 0.012
                        } else {
                            0.0
                        };
                        assert!(kick <= bound + bends, "{what}: {kick} rad/s^2, not {bound}");
                        let jump = gap(&now.pose, &before.pose) * rate_hz;
                        assert!(jump <= speed, "{what}: {jump} rad/s");
                        if !limited {
                            most = (most.0.max(kick), most.1.max(kick / bound), most.2);
                        } else {
                            most.2 = most.2.max(kick);
                        }
                        before = now;
                    }
                    let done: Vec<&str> = c
                        .ran()
                        .iter()
                        .filter(|r| r.completed)
                        .map(|r| r.primitive.as_str())
                        .collect();
                    assert!(done.len() == 2, "{what}: {done:?} came to their ends");
                }
            }
        }
        println!(
            "{}: at most {:.0} rad/s^2, {:.2} of the bound; {:.0} where limits bend",
            vocabulary.body().name(),
            most.0,
            most.1,
            most.2
        );
    }
}

#[test]
fn from_a_hundred_postures_every_primitive_reaches_its_flow_and_completes() {
    let vocabulary = &*ADONIS;
    let body = vocabulary.body();
    let mut random = Pcg64::seed_from_u64(23);
    for n in 0..100 {
        let mut pose: Vec<f64> = (0..body.dof())
            .map(|_| random.random_range(-2.5..2.5))
            .collect();
        body.limited(&mut pose);
        let start = State::resting(pose, Root::ORIGIN);
        for primitive in vocabulary.primitives() {
            let asked = plan(60.0, 8.0, vec![Planned::new(primitive.name())]);
            let course = primitive.at(&primitive.middle()).expect("the middle");
            let made = Controller::new(vocabulary, &asked, &start, &ControlSettings::default());
            let mut c = made.expect("a plan");
            let mut on_it = 0;
            let mut check = |pose: &[f64], phase: f64| {
                let mut wanted = course.pose(phase);
                body.limited(&mut wanted);
                for (c, (x, goal)) in pose.iter().zip(&wanted).enumerate() {
                    // Joints that it does not move stay where they were.
                    let held = (x - start.pose[c]).abs() < 0.03;
                    let off = (x - goal).abs();
                    assert!(
                        off < 1e-9 || held,
                        "{n}: {} {phase} {off}",
                        primitive.name()
                    );
                }
                on_it += 1;
            };
            while !c.finished() {
                let command = c.tick(None, None).clone();
                let runs = c.active().first().is_some_and(|a| a.weight == 1.0);
                // A course has run for 0.4 s when it has been joined.
                if runs && course.secs_at(command.phase) > 0.41 {
                    check(&command.pose, command.phase);
                }
            }
            check(&c.command().pose, 1.0);
            assert!(
                c.ran().len() == 1 && c.ran()[0].completed,
                "{n}: {}",
                primitive.name()
            );
            assert!(
                on_it > 1 || course.duration_secs() < 0.45,
                "{n}: {}",
                primitive.name()
            );
        }
    }
}

#[test]
fn one_arm_waves_while_the_trunk_twists() {
    let vocabulary = &*ADONIS;
    let body = vocabulary.body();
    let wave = Planned {
        joints: vec!["right_arm".into()],
        priority: 1,
        ..Planned::new("wave-up")
    };
    let twist = Planned {
        joints: vec!["trunk".into(), "head".into()],
        ..Planned::new("twist-left")
    };
    let run = |behaviors: Vec<Planned>| {
        let mut c = controller(vocabulary, &plan(120.0, 3.0, behaviors));
        let mut poses = Vec::new();
        while !c.finished() {
            poses.push(c.tick(None, None).pose.clone());
        }
        poses
    };
    let (both, waving, twisting) = (
        run(vec![wave.clone(), twist.clone()]),
        run(vec![wave]),
        run(vec![twist]),
    );
    let of = |j: usize, from: &[Vec<f64>], f: usize| from[f][body.coordinates(j)].to_vec();
    let (mut waved, mut twisted) = (0.0_f64, 0.0_f64);
    for f in 0..both.len() {
        for j in 0..body.joints().len() {
            let name = body.joints()[j].name.as_str();
            let from = if name.starts_with("right") {
                &waving
            } else {
                &twisting
            };
            assert_eq!(of(j, &both, f), of(j, from, f), "{name}, frame {f}");
        }
        let shoulder = body.joint("right_shoulder").expect("a shoulder");
        let waist = body.joint("waist").expect("a waist");
        waved = waved.max(gap(&of(shoulder, &both, f), &of(shoulder, &both, 0)));
        twisted = twisted.max(gap(&of(waist, &both, f), &of(waist, &both, 0)));
    }
    assert!(waved > 0.5 && twisted > 0.3, "{waved} {twisted}");
}

#[test]
fn a_jab_interrupts_a_wave_which_is_resumed() {
    for vocabulary in [&*ADONIS, &*ARES] {
        let jab = vocabulary.primitive("jab").expect("a jab");
        let aim = jab.aim("right_hand").expect("a hand");
        let p = [0.35, 0.6];
        let target = aim
            .position(&p, aim.extreme(&p).expect("an extreme"))
            .expect("a place");
        let reach = Aiming::Reach {
            effector: "right_hand".into(),
            at: target.into(),
        };
        let asked = plan(
            120.0,
            6.0,
            vec![
                Planned {
                    joints: vec!["right_arm".into()],
                    repeat: 2,
                    ..Planned::new("wave-up")
                },
                Planned {
                    aim: reach,
                    start_secs: 1.0,
                    priority: 3,
                    ..Planned::new("jab")
                },
            ],
        );
        let mut c = controller(vocabulary, &asked);
        while !c.finished() {
            c.tick(None, None);
        }
        let ran: Vec<(&str, bool)> = c
            .ran()
            .iter()
            .map(|r| (r.primitive.as_str(), r.completed))
            .collect();
        assert_eq!(ran, [("wave-up", false), ("jab", true), ("wave-up", true)]);
        let miss = c.ran()[1].miss_m.expect("a target");
        assert!(miss < 1e-3 && c.ran()[0].miss_m.is_none(), "{miss}");
    }
}

/// What a tick costs: of several runs the least time of each tick, so that what else the machine does is left out.
/// Timing decides nothing here: `cargo test --release -p kineme-formats --test transitions cost -- --nocapture` prints it.
#[test]
fn the_cost_of_ticks() {
    const RUNS: usize = 8;
    for vocabulary in [&*ADONIS, &*ARES] {
        let one = |name: &str, joints: &[&str], start_secs: f64| Planned {
            repeat: 8,
            joints: joints.iter().map(|j| j.to_string()).collect(),
            start_secs,
            ..Planned::new(name)
        };
        let interrupts = Planned {
            priority: 1,
            start_secs: 2.0,
            ..Planned::new("jab")
        };
        for arbitration in [Arbitration::Priority, Arbitration::Superposition] {
            let asked = Plan {
                arbitration,
                ..plan(
                    120.0,
                    9.0,
                    vec![
                        one("wave-up", &["right_arm"], 0.0),
                        one("jab", &["left_arm", "right_arm"], 0.1),
                        one(
                            "twist-left",
                            &["trunk", "head", "left_leg", "right_leg"],
                            0.2,
                        ),
                        interrupts.clone(),
                    ],
                )
            };
            let mut least = vec![f64::INFINITY; 1080];
            for _ in 0..RUNS {
                let mut c = controller(vocabulary, &asked);
                let mut sensed = Sensed {
                    pose: c.command().pose.clone(),
                    velocity: c.command().velocity.clone(),
                };
                for least in &mut least {
                    let before = Instant::now();
                    c.tick(Some(&sensed), None);
                    *least = least.min(before.elapsed().as_secs_f64() * 1e6);
                    // Always somewhat away, so that feedback has to work.
                    sensed.pose.clone_from(&c.command().pose);
                    sensed.pose.iter_mut().for_each(|x| *x += 0.1);
                }
            }
            least.sort_by(f64::total_cmp);
            println!(
                "{} {arbitration:?}: median {:.1} us, 99 % {:.1}, longest {:.1}",
                vocabulary.body().name(),
                least[least.len() / 2],
                least[least.len() * 99 / 100],
                least[least.len() - 1],
            );
        }
    }
}
