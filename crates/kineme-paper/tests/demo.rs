//! The demo: its session is sound, and the derivation finds what was choreographed.

use kineme_formats::output::Existing;
use kineme_paper::demo::{Demo, run};
use kineme_paper::figures::PAGE;

#[test]
fn the_choreographed_movements_are_found() {
    let mut stages = Vec::new();
    let demo = run(0, &mut |stage| stages.push(stage)).expect("a demo");
    assert_eq!(stages.len(), 4);
    assert_eq!((demo.motions.len(), demo.movements.kinds), (4, 8));
    for motion in &demo.motions {
        let secs = motion.duration_secs();
        assert!((20.0..45.0).contains(&secs), "{}: {secs} s", motion.name());
    }
    // A stroke out and one back at least for each of the eight movements, and not a group an occurrence.
    let groups = demo.derived.groups.len();
    assert!((16..=32).contains(&groups), "{groups} groups");
    let left_over = demo.derived.labels.iter().filter(|l| l.is_none()).count();
    assert!(
        left_over * 10 < demo.derived.labels.len(),
        "{left_over} left over"
    );
    assert!(demo.strokes.purity > 0.9, "{:?}", demo.strokes);
    assert!(demo.strokes.ari > 0.7, "{:?}", demo.strokes);
    assert!(demo.movements.purity > 0.9, "{:?}", demo.movements);
    assert!(demo.movements.ari > 0.55, "{:?}", demo.movements);
    assert_eq!(demo.vocabulary.primitives().len(), groups);
    let kinds: std::collections::BTreeSet<&str> = demo
        .names
        .iter()
        .filter_map(|(n, _)| n.split(' ').next())
        .collect();
    for movement in [
        "jab", "hook", "wave", "raise", "twist", "squat", "kick", "drink",
    ] {
        assert!(kinds.contains(movement), "{movement} among {kinds:?}");
    }
}

#[test]
fn the_demo_writes_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let places = ["a", "b"].map(|name| folder.path().join(name));
    for place in &places {
        let demo = run(0, &mut |_| {}).expect("a demo");
        let page = demo.write(place, Existing::Keep).expect("written");
        assert_eq!(page, place.join(PAGE));
        assert!(demo.write(place, Existing::Keep).is_err(), "kept");
    }
    for name in Demo::files() {
        let [a, b] = places
            .each_ref()
            .map(|p| std::fs::read(p.join(name)).expect(name));
        assert!(a == b, "{name}");
    }
}
