//! The judging of models: its arithmetic on made-up numbers, its repeatability on a few recordings.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::interpolation::Method;
use kineme::primitive::Memory;
use kineme::{Role, ares};
use kineme_paper::interpolation_table::write_interpolation;
use kineme_paper::intervals::interval;
use kineme_paper::model_table::left_out;
use kineme_paper::models::{Fold, Judged, folds};
use kineme_paper::out_and_back::{Return, follow_waves, waves};
use kineme_paper::postures::{Errors, Postures};
use kineme_paper::sets::{LabelledSet, index, load};
use nalgebra::{UnitQuaternion, Vector3};

#[test]
fn an_interval_is_about_the_mean_of_class_means() {
    let cases: [(&[Vec<f64>], f64, bool); 4] = [
        (&[vec![1.0, 3.0], vec![10.0]], 6.0, true),
        (&[vec![2.0; 4], vec![], vec![4.0; 9]], 3.0, false),
        (&[vec![5.0]], 5.0, false),
        (&[vec![0.0, 1.0, 2.0, 3.0, 4.0]], 2.0, true),
    ];
    for (classes, mean, wide) in cases {
        let i = interval(classes);
        assert!((i.mean - mean).abs() < 1e-12, "{classes:?}: {i:?}");
        assert!(i.low <= i.mean && i.mean <= i.high, "{classes:?}: {i:?}");
        assert_eq!(i.low < i.high, wide, "{classes:?}: {i:?}");
        assert_eq!(i, interval(classes), "drawn alike each time");
    }
}

#[test]
fn posture_errors_are_those_of_the_joints_that_turned() {
    let body = Arc::new(ares().expect("a body"));
    let rest = body.neutral();
    let of = |pose: &[f64]| Postures::of_poses(&body, pose.to_vec()).expect("postures");
    let check = |role: Role, degrees: f64, wrists: bool| {
        let mut bent = rest.clone();
        let joint = body.joints_of(role)[0];
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), degrees.to_radians());
        let turned = body.rotation(joint, &rest[body.coordinates(joint)]) * turn;
        body.set_rotation(&mut bent, joint, &turned, Some(&rest));
        let e = of(&bent).against(&of(&rest));
        let expected = degrees / 15.0_f64.sqrt();
        assert!((e.joint_deg - expected).abs() < 1e-6, "{role:?}: {e:?}");
        assert_eq!(e.wrist_cm > 0.1, wrists, "{role:?}: {e:?}");
        assert!(e.landmark_cm > 0.0, "{role:?}: {e:?}");
    };
    let at = |pose: &[f64]| of(pose).against(&of(&rest));
    assert!(at(&rest).values().iter().all(|e| *e < 1e-12));
    check(Role::LeftLowerLeg, 20.0, false);
    check(Role::RightFoot, 10.0, false);
    check(Role::LeftLowerArm, 30.0, true);
}

/// What a clip of `class` would be, every rival `error` off but the last, which is half as far.
fn judged(class: usize, error: f64) -> Judged {
    let of = |e: f64| Errors {
        joint_deg: e,
        wrist_cm: 2.0 * e,
        landmark_cm: 3.0 * e,
    };
    let mut errors = [of(error); 6];
    errors[5] = of(0.5 * error);
    Judged {
        class,
        errors,
        cyclic: class == 1,
        foreign: 1,
        method: Method::Shepard { power: 2.0 },
        dims: 2,
    }
}

#[test]
fn small_classes_are_listed_and_not_averaged() {
    let classes = ["few".to_string(), "many".to_string()];
    let mut all: Vec<Judged> = (0..3).map(|_| judged(0, 100.0)).collect();
    all.extend((0..8).map(|_| judged(1, 8.0)));
    let mut text = String::new();
    write_interpolation(&mut text, "Set", &classes, &all).expect("written");
    for line in [
        "### Set, interpolation: joint error, degrees",
        "| few | 3 | 100.0 | 100.0 | 100.0 | 100.0 | 100.0 | 50.0 |",
        "| many (cycle) | 8 | 8.0 | 8.0 | 8.0 | 8.0 | 8.0 | 4.0 |",
        "| many (cycle) | 8 | 24.0 | 24.0 | 24.0 | 24.0 | 24.0 | 12.0 |",
        "| many | 0 | 0 | 8 | 2.0 | 1.0 |",
    ] {
        assert!(text.contains(line), "no `{line}` in\n{text}");
    }
    let mean = text.lines().find(|l| l.contains("mean over classes"));
    assert!(mean.is_some_and(|l| l.contains("**8.00** (8.00 to 8.00)") && l.contains("**4.00**")));
}

#[test]
fn waves_go_out_and_come_back() {
    for back in [Return::Choreographed, Return::Reversed] {
        let waves = waves(back).expect("waves");
        assert_eq!(waves.len(), 9);
        for wave in &waves {
            let m = &wave.motion;
            let last = m.frames() - 1;
            let gap = |a: usize, b: usize| -> f64 {
                let pairs = m.pose(a).iter().zip(m.pose(b));
                pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
            };
            let most = (0..m.frames()).map(|f| gap(f, 0)).fold(0.0, f64::max);
            assert!(gap(0, last) < 0.05 * most, "{back:?} {:?}", wave.adverbs);
            if back == Return::Reversed {
                assert!(gap(last / 4, last - last / 4) < 0.05 * most);
            }
        }
    }
}

#[test]
fn a_field_with_phase_completes_every_wave() {
    let phase = follow_waves(Return::Reversed, Memory::Phase).expect("followed");
    assert_eq!(phase.completed, phase.followed, "{phase:?}");
    let paper = follow_waves(Return::Reversed, Memory::None).expect("followed");
    assert!(paper.completed < paper.followed, "{paper:?}");
}

fn corpus() -> Option<PathBuf> {
    let data = match std::env::var_os("KINEME_DATA") {
        Some(data) => PathBuf::from(data),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
    };
    let corpus = data.join("mocap");
    let there = corpus.join("index.csv").exists();
    if !there {
        println!("skipped: no recordings at {}", corpus.display());
    }
    there.then_some(corpus)
}

/// Three classes' first clips of one actor.
fn few(corpus: &Path) -> LabelledSet {
    let body = Arc::new(ares().expect("a body"));
    let rows = index(corpus).expect("an index");
    let mut picked = Vec::new();
    for label in ["throw", "jog"] {
        let own = rows
            .iter()
            .filter(|r| r.archive == "hdm05.zip" && r.format == "amc" && r.label == label);
        picked.extend(own.take(4));
    }
    load(corpus, &picked, &body, None, &|r| r.label.clone()).expect("recordings")
}

#[test]
fn judging_is_the_same_on_one_thread_and_on_many() {
    let Some(corpus) = corpus() else { return };
    let set = few(&corpus);
    let all = folds(&set);
    assert_eq!(all.len(), set.motions.len());
    for fold in &all {
        assert!(!fold.others.contains(&fold.left_out));
        assert!(fold.others.iter().all(|&i| set.labels[i] == fold.class));
    }
    let some: Vec<Fold> = vec![all[0].clone(), all[all.len() - 1].clone()];
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| left_out(&set, &some).expect("judged"))
    };
    let (judged, followed) = run(1);
    assert_eq!((judged.clone(), followed.clone()), run(4));
    for (j, f) in judged.iter().zip(&followed) {
        let best = j.errors[2].landmark_cm;
        assert!(
            j.errors[1].landmark_cm >= best,
            "no single exemplar is better than the best"
        );
        assert!(
            j.errors
                .iter()
                .all(|e| e.joint_deg > 0.0 && e.joint_deg < 90.0)
        );
        assert!(f.starts > 0);
        // Nobody knows less the later it is.
        assert!(f.errors[0][0].landmark_cm < f.errors[0][2].landmark_cm);
    }
}
