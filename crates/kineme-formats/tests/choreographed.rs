//! The six vocabularies of `choreography/` as models: what is asked of primitives, on exemplars written by hand.

use std::path::Path;
use std::sync::{Arc, LazyLock};
use std::time::Instant;

use kineme::math::rotation::{exp, log};
use kineme::{Modelling, Primitive, Vocabulary, ares};
use nalgebra::{UnitQuaternion, Vector3};
use rand::{Rng, RngExt, SeedableRng};

const SCRIPTS: [(&str, &str, usize); 6] = [
    ("boxing", "right_hand", 5),
    ("punching", "right_hand", 2),
    ("vertical-waving", "right_hand", 2),
    ("horizontal-waving", "right_hand", 2),
    ("twist", "right_hand", 2),
    ("greeting", "right_hand", 2),
];

static VOCABULARIES: LazyLock<Vec<Vocabulary>> = LazyLock::new(|| {
    let body = Arc::new(ares().expect("ares"));
    SCRIPTS
        .iter()
        .map(|(name, _, _)| {
            let file = format!("{name}.toml");
            let path = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../../choreography")
                .join(&file);
            let bytes = std::fs::read(path).expect("a script");
            let script = kineme_formats::script::parse(&file, &bytes).expect("a valid script");
            script
                .vocabulary(&body, &Modelling::default(), (&file, None))
                .expect("a vocabulary")
        })
        .collect()
});

fn random(primitive: &Primitive, rng: &mut impl Rng) -> Vec<f64> {
    (0..primitive.parameters().dims())
        .map(|_| rng.random_range(0.0..1.0))
        .collect()
}

#[test]
fn every_script_makes_its_primitives() {
    for ((name, _, count), vocabulary) in SCRIPTS.iter().zip(VOCABULARIES.iter()) {
        assert_eq!(vocabulary.primitives().len(), *count, "{name}");
        for p in vocabulary.primitives() {
            assert!(p.exemplars().len() >= 9, "{name} {}", p.name());
            assert_eq!(p.parameters().dims(), 2, "{name} {}", p.name());
            assert!(!p.is_cyclic(), "{name} {}", p.name());
            let fit = p.fitted();
            println!(
                "{name:18} {:14} {:?} {:?} {:?}",
                p.name(),
                fit.method,
                fit.error.map(|e| [
                    e.joint_rad.to_degrees(),
                    100.0 * e.wrist_m,
                    100.0 * e.nearest_m,
                    100.0 * e.mean_m
                ]),
                p.notes().collect::<Vec<_>>()
            );
            for t in &fit.trials {
                println!("    {:?} {:.2} cm", t.method, 100.0 * t.error_m);
            }
        }
    }
}

#[test]
fn targets_taken_from_a_primitive_are_reached() {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(3);
    for ((name, effector, _), vocabulary) in SCRIPTS.iter().zip(VOCABULARIES.iter()).take(3) {
        let mut secs = Vec::new();
        let mut worst: f64 = 0.0;
        for p in vocabulary.primitives() {
            let aim = p.aim(effector).expect("an effector");
            for _ in 0..1000 / vocabulary.primitives().len() {
                let from = random(p, &mut rng);
                let phase = aim.extreme(&from).expect("a phase");
                let target = aim.position(&from, phase).expect("a place");
                let begun = Instant::now();
                let reached = aim.at(&target);
                secs.push(begun.elapsed().as_secs_f64());
                worst = worst.max(reached.miss_m);
                assert!(
                    reached.miss_m < 1e-3,
                    "{name} {} {from:?}: {reached:?}",
                    p.name()
                );
            }
        }
        secs.sort_by(f64::total_cmp);
        println!(
            "{name}: worst {worst:.1e} m, median {:.0} us",
            1e6 * secs[secs.len() / 2]
        );
    }
}

/// The weighted intrinsic mean of rotations: Newton's steps from the heaviest.
fn intrinsic_mean(turns: &[UnitQuaternion<f64>], weights: &[f64]) -> UnitQuaternion<f64> {
    let heaviest = (0..turns.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]));
    let mut mean = turns[heaviest.expect("exemplars")];
    for _ in 0..20 {
        let step: Vector3<f64> = turns
            .iter()
            .zip(weights)
            .map(|(q, w)| log(&(mean.inverse() * q)) * *w)
            .sum();
        mean *= exp(&step);
    }
    mean
}

#[test]
fn blending_in_coordinates_is_near_the_intrinsic_mean_of_rotations() {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(5);
    let mut worst: f64 = 0.0;
    let mut angles = Vec::new();
    for p in VOCABULARIES.iter().flat_map(|v| v.primitives()) {
        let body = p.body();
        for _ in 0..20 {
            let at = random(p, &mut rng);
            let phase = rng.random_range(0.0..1.0);
            let pose = p.pose(&at, phase).expect("a pose");
            let mut weights = vec![0.0; p.exemplars().len()];
            p.interpolator().weights(&at, &mut weights);
            let exemplars: Vec<Vec<f64>> = (0..weights.len())
                .map(|i| p.registered(i, phase).pose)
                .collect();
            for joint in 0..body.joints().len() {
                let turn = |pose: &[f64]| body.rotation(joint, &pose[body.coordinates(joint)]);
                let turns: Vec<_> = exemplars.iter().map(|e| turn(e)).collect();
                let apart = turn(&pose)
                    .angle_to(&intrinsic_mean(&turns, &weights))
                    .to_degrees();
                worst = worst.max(apart);
                angles.push(apart);
            }
        }
    }
    angles.sort_by(f64::total_cmp);
    println!(
        "median {:.4}, 99 % {:.3}, greatest {worst:.2} degrees",
        angles[angles.len() / 2],
        angles[angles.len() * 99 / 100]
    );
    assert!(worst < 2.0, "{worst}");
}
