//! Plans of behaviours, as people write them and as they get them wrong.

use kineme::control::{self, Aiming, Arbitration, Fault, Plan, Planned, Rule};
use kineme_formats::plan::parse;
use kineme_formats::{FormatError, Place};
use proptest::prelude::*;

const PLAN: &str = r#"
rate_hz = 100
seconds = 12.0
arbiter = "superposition"
[observe]
motion = "attacker.bvh"
[[behavior]]
primitive = "horizontal-wave"
start = 0.5
repeat = 3
joints = ["left_arm"]
parameters = [0.2]
weight = 2.5
priority = 1
[[behavior]]
primitive = "jab"
reach = { effector = "right_hand", at = [0.5, 0.1, 0.2] }
pace = 1.5
[[rule]]
when = "jab"
then = { primitive = "shield", priority = 5 }
"#;

fn refused(text: &str) -> FormatError {
    match parse("plan.toml", text.as_bytes()) {
        Ok(plan) => panic!("read as {plan:?}:\n{text}"),
        Err(error) => error,
    }
}

#[test]
fn a_plan_says_what_is_done_when_and_what_it_leaves_out_is_usual() {
    let file = parse("plan.toml", PLAN.as_bytes()).expect("a plan");
    let wave = Planned {
        start_secs: 0.5,
        repeat: 3,
        joints: vec!["left_arm".into()],
        aim: Aiming::Parameters(vec![0.2]),
        weight: 2.5,
        priority: 1,
        ..Planned::new("horizontal-wave")
    };
    let jab = Planned {
        aim: Aiming::Reach {
            effector: "right_hand".into(),
            at: [0.5, 0.1, 0.2],
        },
        pace: 1.5,
        ..Planned::new("jab")
    };
    let shield = Planned {
        priority: 5,
        ..Planned::new("shield")
    };
    let wanted = Plan {
        rate_hz: 100.0,
        seconds: 12.0,
        arbitration: Arbitration::Superposition,
        observed: Some("attacker.bvh".into()),
        behaviors: vec![wave, jab],
        rules: vec![Rule {
            when: "jab".into(),
            then: shield,
        }],
    };
    assert_eq!(file.plan, wanted);
    let least = "seconds = 1\n[[behavior]]\nprimitive = \"jab\"";
    let least = parse("plan.toml", least.as_bytes()).expect("a plan").plan;
    assert_eq!((least.rate_hz, least.observed), (120.0, None));
    assert_eq!(least.arbitration, Arbitration::Priority);
    assert_eq!(least.behaviors, [Planned::new("jab")]);
}

#[test]
fn what_no_vocabulary_can_do_is_told_with_its_line() {
    let file = parse("plan.toml", PLAN.as_bytes()).expect("a plan");
    for (place, told) in [
        (control::Place::Plan, Place::File),
        (control::Place::Behavior(0), Place::Line(7)),
        (control::Place::Behavior(1), Place::Line(15)),
        (control::Place::Rule(0), Place::Line(19)),
        (control::Place::Rule(7), Place::File),
    ] {
        let message = "unknown primitive `jba`".to_string();
        let error = file.fault(&Fault { place, message });
        assert_eq!(error.place, told, "{place}");
        assert_eq!(
            (error.file.as_str(), error.found.as_str()),
            ("plan.toml", "unknown primitive `jba`")
        );
    }
}

#[test]
fn what_is_no_plan_is_refused_with_the_line_of_the_fault() {
    for (old, new, line, found) in [
        ("rate_hz = 100", "rate = 100", 2, "unknown key `rate`"),
        (
            "rate_hz = 100",
            "rate_hz = \"fast\"",
            2,
            "a value of type string",
        ),
        ("seconds = 12.0", "seconds = nan", 3, "`nan`"),
        ("\"superposition\"", "\"voting\"", 4, "`voting`"),
        ("motion =", "movie =", 6, "unknown key `movie`"),
        ("primitive = \"horizontal-wave\"", "", 7, "no `primitive`"),
        ("start = 0.5", "start = true", 9, "a value of type boolean"),
        ("repeat = 3", "repeat = -3", 10, "`-3`"),
        ("repeat = 3", "repeat = 2.5", 10, "a value of type float"),
        (
            "repeat = 3",
            "repeat = 99999999999999999999",
            10,
            "`99999999999999999999`",
        ),
        ("[\"left_arm\"]", "[]", 11, "no joint"),
        (
            "[\"left_arm\"]",
            "\"left_arm\"",
            11,
            "a value of type string",
        ),
        ("[0.2]", "[0.2, inf]", 12, "`inf`"),
        ("priority = 1", "urgency = 1", 14, "unknown key `urgency`"),
        ("[0.5, 0.1, 0.2]", "[0.5, 0.1]", 17, "2 numbers"),
        ("effector =", "hand =", 17, "unknown key `hand`"),
        (
            "pace = 1.5",
            "parameters = [1]",
            17,
            "both `parameters` and `reach`",
        ),
        ("when = \"jab\"", "when = \"\"", 20, "an empty string"),
        ("then = {", "then = { when = 1,", 21, "unknown key `when`"),
        ("then = {", "than = {", 21, "unknown key `than`"),
    ] {
        assert!(PLAN.contains(old), "{old}");
        let error = refused(&PLAN.replacen(old, new, 1));
        assert_eq!(error.place, Place::Line(line), "{new}: {error}");
        assert_eq!(error.found, found, "{new}: {error}");
    }
    assert_eq!(refused("seconds = 3").found, "nothing planned");
    assert_eq!(
        refused("[[behavior]]\nprimitive = \"jab\"").found,
        "no `seconds`"
    );
    assert!(matches!(refused("seconds = = 3").place, Place::Line(1)));
}

fn behavior() -> impl Strategy<Value = Planned> {
    let name = "[a-z][a-z0-9-]{0,8}";
    let finite = -1e3..1e3;
    let aim = prop_oneof![
        Just(Aiming::Middle),
        prop::collection::vec(finite.clone(), 0..3).prop_map(Aiming::Parameters),
        (name, [finite.clone(), finite.clone(), finite.clone()])
            .prop_map(|(effector, at)| Aiming::Reach { effector, at }),
    ];
    let joints = prop::collection::vec(name, 0..3);
    (
        name,
        finite.clone(),
        any::<u32>(),
        joints,
        aim,
        (finite.clone(), finite, any::<i32>()),
    )
        .prop_map(
            |(primitive, start_secs, repeat, joints, aim, (pace, weight, priority))| Planned {
                primitive,
                start_secs,
                repeat,
                joints,
                aim,
                pace,
                weight,
                priority,
            },
        )
}

/// A behaviour as an inline table.
fn written(b: &Planned) -> String {
    let mut text = format!(
        "{{ primitive = {:?}, start = {:?}, repeat = {}, pace = {:?}, weight = {:?}, priority = {}",
        b.primitive, b.start_secs, b.repeat, b.pace, b.weight, b.priority
    );
    if !b.joints.is_empty() {
        text += &format!(", joints = {:?}", b.joints);
    }
    match &b.aim {
        Aiming::Middle => {}
        Aiming::Parameters(values) => text += &format!(", parameters = {values:?}"),
        Aiming::Reach { effector, at } => {
            text += &format!(", reach = {{ effector = {effector:?}, at = {at:?} }}");
        }
    }
    text + " }"
}

proptest! {
    #[test]
    fn what_is_written_is_read(
        behaviors in prop::collection::vec(behavior(), 0..3),
        then in behavior(),
        seconds in 0.0..1e3,
    ) {
        let listed: Vec<String> = behaviors.iter().map(written).collect();
        let text = format!(
            "seconds = {seconds:?}\nbehavior = [{}]\nrule = [{{ when = \"x\", then = {} }}]",
            listed.join(", "),
            written(&then),
        );
        let plan = parse("plan", text.as_bytes()).unwrap_or_else(|e| panic!("{e}\n{text}")).plan;
        prop_assert_eq!(plan.behaviors, behaviors);
        prop_assert_eq!(plan.seconds, seconds);
        prop_assert_eq!(&plan.rules[0].then, &then);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse("bytes", &bytes);
    }

    #[test]
    fn a_damaged_plan_is_read_or_refused(at in 0..PLAN.len(), byte in any::<u8>(), cut in any::<bool>()) {
        let mut bytes = PLAN.as_bytes().to_vec();
        bytes[at] = byte;
        if cut {
            bytes.truncate(at);
        }
        let _ = parse("damaged", &bytes);
    }
}
