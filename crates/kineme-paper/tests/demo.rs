//! The demo: its session is sound, and the derivation finds what was choreographed.

use std::sync::LazyLock;

use kineme_formats::output::Existing;
use kineme_paper::demo::{Demo, DemoSettings, Step, run};
use kineme_paper::figures::PAGE;

/// A table of few movements: how well they are recognised is the table's own test.
const SETTINGS: DemoSettings = DemoSettings {
    seed: 0,
    table: [1, 2, 40],
};

static MADE: LazyLock<(Demo, Vec<Step>)> = LazyLock::new(|| {
    let mut steps = Vec::new();
    let demo = run(&SETTINGS, &mut |step| steps.push(step)).expect("a demo");
    (demo, steps)
});

#[test]
fn bodies_do_the_routine_and_what_they_do_is_recognised() {
    let (demo, steps) = &*MADE;
    assert_eq!(steps.len(), 10, "four stages, four acts, table, figures");
    let show = &demo.show;
    assert_eq!(show.physics, cfg!(feature = "sim"));
    for performance in &show.routine {
        let done = performance.ran.iter().filter(|ran| ran.completed).count();
        assert_eq!(done, 12, "{:?}", performance.ran);
        assert!(performance.tracking.rms_rad.to_degrees() < 2.0);
    }
    // Every attack is answered, while it lasts.
    assert_eq!(show.attacker.attacks.len(), 4);
    for attack in &show.attacker.attacks {
        let span = attack.start_secs..attack.end_secs;
        let answers = show
            .bout
            .ran
            .iter()
            .filter(|ran| span.contains(&ran.start_secs));
        assert!(answers.count() >= 1, "{attack:?}: {:?}", show.bout.ran);
    }
    let ares = &show.routine[1];
    assert_eq!(show.readings.len(), ares.done.frames());
    assert_eq!(show.parts.len(), 2, "right arm, trunk and head");
    for part in &show.parts {
        assert_eq!(part.readings.len(), ares.done.frames());
        let own = ares.ran.iter().filter(|ran| ran.joints == part.names);
        let (mut right_frames, mut all_frames) = (0, 0);
        // What a part does by itself is read as that, but for the first movement, into which it goes from standing.
        for ran in own.skip(1) {
            let frame = |secs: f64| (secs * ares.done.rate_hz()) as usize;
            let frames = &part.readings[frame(ran.start_secs)..frame(ran.end_secs)];
            let right = frames.iter().filter(|reading| {
                let best = reading.posterior.best();
                best.is_some_and(|k| part.vocabulary.primitives()[k].name() == ran.primitive)
            });
            let right = right.count();
            right_frames += right;
            all_frames += frames.len();
            // A wave that is broken off for the next movement is not read from its beginning to its end.
            let share = right as f64 / frames.len() as f64;
            assert!(
                share > 0.6,
                "{} of {:?}: {share:.2}",
                ran.primitive,
                part.names
            );
        }
        let share = right_frames as f64 / all_frames as f64;
        assert!(share > 0.8, "{:?}: {share:.2}", part.names);
    }
    assert!(
        show.encoding
            .spans
            .iter()
            .any(|span| span.primitive.is_some())
    );
}

#[test]
fn the_choreographed_movements_are_found() {
    let demo = &MADE.0.found;
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
    let again = run(&SETTINGS, &mut |_| {}).expect("a demo");
    for (place, demo) in places.iter().zip([&MADE.0, &again]) {
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
