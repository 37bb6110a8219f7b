//! Rules of a choreography script.

use std::collections::BTreeMap;

use kineme::Role;
use kineme::choreography::{Key, Script, ScriptAnimation, ScriptExemplar};

fn key(time: f64, degrees: &[f64]) -> Key {
    Key {
        time,
        angles: BTreeMap::from([(Role::Chest, degrees.to_vec())]),
    }
}

fn script() -> Script {
    let keys = vec![key(0.0, &[1.0, 2.0, 3.0]), key(0.5, &[4.0])];
    let exemplar = |height| ScriptExemplar {
        primitive: "jab".to_string(),
        parameters: BTreeMap::from([("height".to_string(), height)]),
        keys: keys.clone(),
    };
    let animation = |name: &str| ScriptAnimation {
        name: name.to_string(),
        keys: keys.clone(),
    };
    Script {
        body: "ares".to_string(),
        exemplars: vec![exemplar(0.0), exemplar(1.0)],
        animations: vec![animation("swat-bees"), animation("stretch")],
    }
}

#[test]
fn each_rule_is_kept_by_a_valid_script_and_told_when_broken() {
    script().validate().unwrap();
    type Break = fn(&mut Script);
    let cases: &[(&str, Break, &str)] = &[
        ("body", |s| s.body.clear(), "body"),
        (
            "nothing",
            |s| (s.exemplars.clear(), s.animations.clear()).1,
            "at least one",
        ),
        (
            "primitive",
            |s| s.exemplars[0].primitive = " ".to_string(),
            "primitive",
        ),
        (
            "parameter's name",
            |s| s.exemplars[0].parameters.extend([(String::new(), 1.0)]),
            "parameter",
        ),
        (
            "parameter",
            |s| {
                s.exemplars[0]
                    .parameters
                    .extend([("height".to_string(), f64::NAN)])
            },
            "finite",
        ),
        (
            "parameters",
            |s| s.exemplars[1].parameters.clear(),
            "[height] and []",
        ),
        (
            "animation's name",
            |s| s.animations[0].name.clear(),
            "animation",
        ),
        (
            "animation twice",
            |s| s.animations[1].name = "swat-bees".to_string(),
            "`swat-bees`",
        ),
        (
            "one key",
            |s| drop(s.animations[1].keys.pop()),
            "at least two",
        ),
        (
            "time stands",
            |s| s.exemplars[1].keys[1].time = 0.0,
            "key 2: ",
        ),
        (
            "time before 0",
            |s| s.exemplars[1].keys[0].time = -1.0,
            "key 1: ",
        ),
        (
            "time",
            |s| s.exemplars[1].keys[1].time = f64::INFINITY,
            "inf",
        ),
        (
            "no angle",
            |s| s.animations[0].keys[0] = key(0.0, &[]),
            "0 angles",
        ),
        (
            "two angles",
            |s| s.animations[0].keys[0] = key(0.0, &[1.0, 2.0]),
            "2 angles",
        ),
        (
            "angle",
            |s| s.animations[0].keys[0] = key(0.0, &[f64::NAN]),
            "`chest`",
        ),
    ];
    for (what, damage, word) in cases {
        let mut script = script();
        damage(&mut script);
        let error = script.validate().expect_err(what);
        assert!(
            error.is_invalid() && error.to_string().contains(word),
            "{what}: {error}"
        );
    }
}

#[test]
fn parameters_agree_within_a_primitive_only() {
    let mut script = script();
    script.exemplars[1].primitive = "hook".to_string();
    script.exemplars[1].parameters.clear();
    script.validate().unwrap();
}
