//! f(p, τ): laws of primitives over choreographed exemplars.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use kineme::choreography::{Key, perform};
use kineme::primitive::{Interpolation, Parameterisation};
use kineme::{Exemplar, Modelling, Primitive, Role, Skeleton, Transitions, adonis, ares};
use nalgebra::Vector3;
use proptest::prelude::*;

/// A reach with the right arm: up to `height`, turned by `side`, over `secs`; out and back.
fn reach_keys(height: f64, side: f64, secs: f64) -> Vec<Key> {
    let key = |share: f64, arm: [f64; 3], elbow: f64, chest: f64| Key {
        time: secs * share,
        angles: BTreeMap::from([
            (Role::RightUpperArm, arm.to_vec()),
            (Role::RightLowerArm, vec![elbow]),
            (Role::Chest, vec![0.0, 0.0, chest]),
        ]),
    };
    let out = [40.0 + 70.0 * height, 5.0 + 20.0 * side, -10.0 + 20.0 * side];
    vec![
        key(0.0, [15.0, 8.0, 0.0], 100.0, 0.0),
        key(0.2, [10.0, 10.0, 0.0], 110.0, -6.0),
        key(0.55, out, 15.0, 25.0 - 20.0 * side),
        key(1.0, [15.0, 8.0, 0.0], 100.0, 0.0),
    ]
}

fn exemplar(body: &Arc<Skeleton>, name: &str, keys: &[Key], adverbs: Option<Vec<f64>>) -> Exemplar {
    let motion = perform(name, keys, body, 120.0).expect("keys");
    Exemplar::whole(motion, adverbs)
}

fn grid(body: &Arc<Skeleton>, adverbs: bool) -> Vec<Exemplar> {
    let mut exemplars = Vec::new();
    for h in 0..3 {
        for s in 0..3 {
            let (height, side) = (f64::from(h) / 2.0, f64::from(s) / 2.0);
            let keys = reach_keys(height, side, 0.8 + 0.2 * height + 0.1 * side);
            let said = adverbs.then(|| vec![height, side]);
            exemplars.push(exemplar(body, &format!("reach-{h}{s}"), &keys, said));
        }
    }
    exemplars
}

fn learned(body: &Arc<Skeleton>, modelling: &Modelling, adverbs: bool) -> Primitive {
    Primitive::learn("reach", grid(body, adverbs), modelling).expect("a primitive")
}

fn with(interpolation: Interpolation) -> Modelling {
    Modelling {
        interpolation,
        ..Modelling::default()
    }
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, f64::max)
}

#[test]
fn an_exact_interpolator_returns_the_registered_exemplar_at_its_own_parameters() {
    for body in [
        Arc::new(adonis().expect("adonis")),
        Arc::new(ares().expect("ares")),
    ] {
        for method in [Interpolation::VerbsAndAdverbs, Interpolation::Shepard] {
            let p = learned(&body, &with(method), true);
            assert!(p.interpolator().is_exact());
            for i in 0..9 {
                let course = p.at(p.point(i)).expect("a course");
                for k in 0..=50 {
                    let phase = f64::from(k) / 50.0;
                    let wanted = p.registered(i, phase);
                    let found = course.sample(phase);
                    assert!(
                        gap(&found.pose, &wanted.pose) < 1e-9,
                        "{method:?} {i} {phase}"
                    );
                    let pace = found.secs_per_phase / wanted.secs_per_phase - 1.0;
                    assert!(pace.abs() < 1e-9);
                }
                let real = p.exemplars()[i].motion.duration_secs();
                assert!((course.duration_secs() - real).abs() < 0.02 * real, "{i}");
            }
        }
    }
}

#[test]
fn what_was_cut_out_of_one_recording_tells_what_followed_what() {
    let body = Arc::new(ares().expect("a body"));
    // Recording, first and last second of each exemplar of two primitives.
    let learned = |name: &str, cut: &[(&str, f64, f64)]| {
        let placed = |&(motion, start_secs, end_secs): &(&str, f64, f64)| {
            let mut placed = exemplar(&body, motion, &reach_keys(0.5, 0.5, 1.0), None);
            let from = &mut placed.provenance;
            (from.start_secs, from.end_secs) = (start_secs, end_secs);
            placed
        };
        let exemplars = cut.iter().map(placed).collect();
        Primitive::learn(name, exemplars, &Modelling::default()).expect("a primitive")
    };
    let again = [("day", 0.0, 1.0), ("day", 1.0, 2.0), ("day", 2.05, 3.0)];
    let primitives = [
        learned("again", &again),
        learned("after", &[("day", 3.0, 4.0), ("night", 1.0, 2.0)]),
    ];
    let observed = Transitions::observed(&primitives);
    assert_eq!((observed.n, observed.counts), (2, vec![2, 1, 0, 0]));
    // Files of their own all begin at 0, and a gap is no succession.
    let apart = [
        learned("a", &[("a", 0.0, 1.0), ("b", 0.0, 1.0)]),
        learned("b", &[("a", 1.2, 2.0), ("c", 1.0, 2.0)]),
    ];
    assert_eq!(Transitions::observed(&apart), Transitions::none(2));
}

#[test]
fn registered_exemplars_are_the_exemplars() {
    let body = Arc::new(ares().expect("ares"));
    let p = learned(&body, &Modelling::default(), true);
    let fit = p.fitted();
    for (i, e) in p.exemplars().iter().enumerate() {
        let used = fit.used[i];
        for k in 0..=20 {
            let phase = f64::from(k) / 20.0;
            let frame = used.start + (used.end - used.start) * fit.warps[i].place(phase);
            let at = frame.round();
            if (frame - at).abs() > 0.02 {
                continue;
            }
            let off = gap(&p.registered(i, phase).pose, e.motion.pose(at as usize));
            assert!(off < 2e-3, "{i} {phase}: {off}");
        }
    }
}

#[test]
fn time_and_phase_are_inverse_and_rise() {
    let body = Arc::new(adonis().expect("adonis"));
    let course = learned(&body, &Modelling::default(), true)
        .at(&[0.3, 0.8])
        .expect("a course");
    let mut before = -1.0;
    for k in 0..=1000 {
        let secs = course.duration_secs() * f64::from(k) / 1000.0;
        let phase = course.phase_at(secs);
        assert!(phase > before && (0.0..=1.0).contains(&phase));
        assert!((course.secs_at(phase) - secs).abs() < 1e-9);
        before = phase;
    }
    assert_eq!(course.phase_at(course.duration_secs()), 1.0);
    assert_eq!(course.advance(1.0, 0.5), 1.0);
}

#[test]
fn slopes_and_gradients_are_the_derivatives() {
    let body = Arc::new(ares().expect("ares"));
    for method in [Interpolation::VerbsAndAdverbs, Interpolation::Shepard] {
        let p = learned(&body, &with(method), true);
        let (at, phase, h) = ([0.37, 0.61], 0.43, 1e-6);
        let sample = p.sample(&at, phase).expect("a sample");
        let (pose, rows) = p.pose_gradient(&at, phase).expect("a gradient");
        assert!(gap(&pose, &p.pose(&at, phase).expect("a pose")) < 1e-12);
        let ahead = p.pose(&at, phase + h).expect("a pose");
        let behind = p.pose(&at, phase - h).expect("a pose");
        let dof = body.dof();
        for c in 0..dof {
            let slope = (ahead[c] - behind[c]) / (2.0 * h);
            assert!((slope - sample.slope[c]).abs() < 1e-5, "{c}");
        }
        for d in 0..2 {
            let moved = |by: f64| {
                let mut q = at;
                q[d] += by;
                p.pose(&q, phase).expect("a pose")
            };
            let (ahead, behind) = (moved(h), moved(-h));
            for c in 0..dof {
                let slope = (ahead[c] - behind[c]) / (2.0 * h);
                assert!((slope - rows[d * dof + c]).abs() < 1e-5, "{d} {c}");
            }
        }
    }
}

#[test]
fn degenerate_exemplars_are_served_and_told() {
    let body = Arc::new(adonis().expect("adonis"));
    let one = |i: usize, adverbs: Option<Vec<f64>>| {
        let mut e = grid(&body, false).swap_remove(i);
        e.adverbs = adverbs;
        e
    };
    let line = |t: f64| Some(vec![t, 2.0 * t]);
    let cases: [(&str, Vec<Exemplar>, usize); 6] = [
        ("one", vec![one(0, None)], 0),
        ("one with adverbs", vec![one(0, line(1.0))], 0),
        ("two", vec![one(0, None), one(8, None)], 1),
        (
            "collinear",
            vec![one(0, line(0.0)), one(4, line(0.5)), one(8, line(1.0))],
            2,
        ),
        (
            "duplicate",
            vec![one(0, line(0.0)), one(1, line(0.0)), one(8, line(1.0))],
            2,
        ),
        ("too few", vec![one(0, line(0.0)), one(8, line(1.0))], 2),
    ];
    for (name, exemplars, dims) in cases {
        let n = exemplars.len();
        let p = Primitive::learn(name, exemplars, &Modelling::default()).expect(name);
        assert_eq!(p.parameters().dims(), dims, "{name}");
        let course = p.at(&p.middle()).expect("a course");
        assert!(course.duration_secs() > 0.5, "{name}");
        let told: Vec<&str> = p.notes().collect();
        assert_eq!(told.is_empty(), name == "two", "{name}: {told:?}");
        assert_eq!(p.fitted().error.is_some(), n > 1, "{name}");
    }
}

#[test]
fn what_cannot_be_a_primitive_is_refused_by_name() {
    let body = Arc::new(adonis().expect("adonis"));
    let other = Arc::new(ares().expect("ares"));
    let check = |exemplars: Vec<Exemplar>, says: &str| {
        let told = Primitive::learn("reach", exemplars, &Modelling::default());
        let told = told.expect_err(says).to_string();
        assert!(told.contains(says), "{told}");
    };
    check(Vec::new(), "no exemplar");
    let mut mixed = grid(&body, false);
    mixed.push(grid(&other, false).remove(0));
    check(mixed, "`adonis` and `ares`");
    let mut short = grid(&body, false);
    short[4].motion = short[4].motion.slice(0..1).expect("a frame");
    check(short, "reach-11");
    let mut unequal = grid(&body, true);
    unequal[3].adverbs = Some(vec![0.5]);
    check(unequal, "reach-10");
    let mut infinite = grid(&body, true);
    infinite[2].adverbs = Some(vec![0.5, f64::NAN]);
    check(infinite, "reach-02");
}

#[test]
fn parameters_out_of_range_are_brought_to_the_exemplars() {
    let body = Arc::new(adonis().expect("adonis"));
    let p = learned(&body, &Modelling::default(), true);
    let far = p.at(&[7.0, -3.0]).expect("a course");
    assert!(far.parameters().iter().all(|v| (-0.11..=1.11).contains(v)));
    assert!(
        p.at(&[0.5])
            .is_err_and(|e| e.to_string().contains("p1, p2"))
    );
    assert!(p.at(&[0.5, f64::NAN]).is_err());
}

#[test]
fn parameters_that_nobody_gave_tell_exemplars_apart() {
    let body = Arc::new(adonis().expect("adonis"));
    for parameterisation in [
        Parameterisation::Principal,
        Parameterisation::Effector("right_hand".into()),
    ] {
        let modelling = Modelling {
            parameterisation: parameterisation.clone(),
            ..Modelling::default()
        };
        let p = learned(&body, &modelling, false);
        assert!(p.parameters().dims() >= 2, "{parameterisation:?}");
        for i in 0..9 {
            let again = p
                .parameters_of(&p.exemplars()[i].motion)
                .expect("parameters");
            assert!(
                gap(&again, p.point(i)) < 0.1,
                "{parameterisation:?} {i}: {again:?} {:?}",
                p.point(i)
            );
        }
    }
    let p = learned(&body, &Modelling::default(), true);
    assert!(
        p.parameters_of(&p.exemplars()[0].motion)
            .is_err_and(|e| e.is_unsupported())
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_target_taken_from_the_primitive_is_reached(height in 0.0..1.0, side in 0.0..1.0) {
        static REACH: LazyLock<Primitive> = LazyLock::new(|| {
            learned(&Arc::new(ares().expect("ares")), &Modelling::default(), true)
        });
        let aim = REACH.aim("right_hand").expect("an effector");
        let from = [height, side];
        let target = aim.position(&from, aim.extreme(&from).expect("a phase")).expect("a place");
        let reached = aim.at(&target);
        prop_assert!(reached.miss_m < 1e-3, "{reached:?}");
        let again = aim.position(&reached.parameters, reached.phase).expect("a place");
        prop_assert!((again - target).norm() < 1e-3);
    }
}

#[test]
fn a_target_out_of_reach_is_missed_by_what_is_said() {
    let body = Arc::new(adonis().expect("adonis"));
    let p = learned(&body, &Modelling::default(), true);
    let aim = p.aim("right_hand").expect("an effector");
    let reached = aim.at(&Vector3::new(2.0, 0.0, 0.0));
    assert!(reached.miss_m > 1.0);
    assert!(
        (reached.miss_m - (Vector3::new(2.0, 0.0, 0.0) - reached.position).norm()).abs() < 1e-12
    );
    assert!(p.aim("tail").is_err_and(|e| e.is_unknown_name()));
}

/// Both arms swinging in turn, `cycles` times, begun at `from` of a cycle.
fn marching(
    body: &Arc<Skeleton>,
    name: &str,
    cycles: f64,
    from: f64,
    secs: f64,
    swing: f64,
) -> Exemplar {
    let rate = 60.0;
    let frames = (cycles * secs * rate) as usize + 1;
    let mut poses = Vec::new();
    let mut roots = Vec::new();
    for f in 0..frames {
        let turn = std::f64::consts::TAU * (from + f as f64 / (secs * rate));
        let mut pose = body.neutral();
        for (role, sign) in [(Role::LeftUpperArm, 1.0), (Role::RightUpperArm, -1.0)] {
            let flexion = 10.0 + sign * swing * (turn.sin() + 0.2 * (2.0 * turn).sin());
            body.set_clinical(&mut pose, role, &[flexion, 8.0])
                .expect("an arm");
        }
        poses.extend(pose);
        roots.push(kineme::Root {
            position: Vector3::new(1.2 * f as f64 / rate, 0.0, 0.9),
            yaw: 0.0,
        });
    }
    let motion = kineme::Motion::new(name, Arc::clone(body), rate, poses, roots).expect("a motion");
    Exemplar::whole(motion, None)
}

#[test]
fn a_cycle_is_found_closed_and_begun_at_one_event() {
    let body = Arc::new(adonis().expect("adonis"));
    let exemplars: Vec<Exemplar> = (0..6)
        .map(|i| {
            let i = f64::from(i);
            marching(
                &body,
                &format!("march-{i}"),
                2.6 + 0.2 * i,
                0.17 * i,
                0.9 + 0.04 * i,
                20.0 + 3.0 * i,
            )
        })
        .collect();
    let p = Primitive::learn("march", exemplars, &Modelling::default()).expect("a cycle");
    assert!(p.is_cyclic());
    for i in 0..6 {
        let (start, end) = (p.registered(i, 0.0), p.registered(i, 1.0 - 1e-12));
        assert!(gap(&start.pose, &end.pose) < 1e-9);
        assert!(gap(&start.slope, &end.slope) < 1e-6);
        let secs = p.at(p.point(i)).expect("a course").duration_secs();
        assert!(secs > 0.7 && secs < 1.3, "{secs}");
        assert!((p.registered(i, 0.3).travel.forward - 1.2).abs() < 0.02);
        // In step: at every phase the exemplars differ by their swing alone.
        for k in 0..10 {
            let phase = f64::from(k) / 10.0;
            let off = gap(&p.registered(i, phase).pose, &p.registered(0, phase).pose);
            assert!(off < 0.45, "{i} {phase} {off}");
        }
    }
    let declared = Modelling {
        cyclic: Some(false),
        ..Modelling::default()
    };
    let strokes = (0..3)
        .map(|i| marching(&body, &format!("march-{i}"), 2.0, 0.0, 1.0, 20.0))
        .collect();
    assert!(
        !Primitive::learn("march", strokes, &declared)
            .expect("a stroke")
            .is_cyclic()
    );
}

#[test]
fn a_mirrored_exemplar_is_refused_by_name() {
    let body = Arc::new(ares().expect("ares"));
    let mut exemplars = grid(&body, false);
    exemplars[5].motion = exemplars[5].motion.mirrored().expect("mirrored");
    let told = Primitive::learn("reach", exemplars, &Modelling::default());
    let told = told.expect_err("the other arm").to_string();
    assert!(
        told.contains("reach-12") && told.contains("mirror"),
        "{told}"
    );
}
