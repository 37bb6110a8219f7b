//! The five vocabularies of `choreography/` as models: what is asked of primitives, on exemplars written by hand.

use std::path::Path;
use std::sync::{Arc, LazyLock};
use std::time::Instant;

use kineme::{Modelling, Primitive, Vocabulary, ares};
use rand::{Rng, RngExt, SeedableRng};

const SCRIPTS: [(&str, &str, usize); 5] = [
    ("boxing", "right_hand", 5),
    ("punching", "right_hand", 2),
    ("vertical-waving", "right_hand", 2),
    ("horizontal-waving", "right_hand", 2),
    ("twist", "right_hand", 2),
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
