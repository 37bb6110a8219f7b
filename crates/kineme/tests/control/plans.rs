//! What a plan may not ask for, and what a robot does not take.

use std::sync::Arc;

use kineme::Root;
use kineme::control::{
    Aiming, Arbitration, Connection, ControlSettings, Controller, Effect, Feedback, KinematicRobot,
    Place, Plan, Planned, Robot, Rule, State,
};

use crate::vocabulary::{of_adonis, vocabulary_of};

/// A plan of these behaviours for a second.
pub fn plan(behaviors: Vec<Planned>) -> Plan {
    Plan {
        rate_hz: 120.0,
        seconds: 1.0,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors,
        rules: Vec::new(),
    }
}

#[test]
fn what_no_plan_may_ask_for_is_refused_with_its_place() {
    let vocabulary = vocabulary_of(of_adonis());
    let check = |change: &dyn Fn(&mut Plan), place: Place, says: &str| {
        let mut asked = plan(vec![Planned::new("reach"), Planned::new("wave")]);
        asked.rules.push(Rule {
            when: "raise".into(),
            then: Planned::new("reach"),
        });
        asked
            .check(&vocabulary, Some(&vocabulary))
            .expect("a good plan");
        change(&mut asked);
        let fault = asked.check(&vocabulary, Some(&vocabulary));
        let fault = fault.expect_err(says);
        assert!(fault.message.contains(says), "{says}: {fault}");
        assert_eq!(fault.place, place, "{fault}");
        let start = State::resting(vocabulary.body().neutral(), Root::ORIGIN);
        let made = Controller::new(&vocabulary, &asked, &start, &ControlSettings::default());
        assert!(
            made.is_err_and(|e| e.is_invalid() && e.to_string().contains(says)),
            "{says}"
        );
    };
    let second = Place::Behavior(1);
    for rate in [0.0, 0.5, 10_001.0, f64::NAN] {
        check(&|p| p.rate_hz = rate, Place::Plan, "rate_hz");
    }
    for seconds in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        check(&|p| p.seconds = seconds, Place::Plan, "seconds");
    }
    check(
        &|p| p.behaviors[1].primitive = "wavee".into(),
        second,
        "nearest: `wave`",
    );
    for start in [-0.1, f64::NAN] {
        check(&|p| p.behaviors[1].start_secs = start, second, "start");
    }
    check(&|p| p.behaviors[1].start_secs = 1.0, second, "ends at 1");
    check(&|p| p.behaviors[1].repeat = 0, second, "repeat");
    for pace in [0.0, -1.0, 1e3, f64::NAN] {
        check(&|p| p.behaviors[1].pace = pace, second, "pace");
    }
    for weight in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        check(&|p| p.behaviors[1].weight = weight, second, "weight");
    }
    let names = |names: &[&str]| -> Vec<String> { names.iter().map(|n| n.to_string()).collect() };
    for (joints, says) in [
        (names(&["left_amr"]), "nearest: `left_arm`"),
        (
            names(&["right_arm", "right_elbwo"]),
            "nearest: `right_elbow`",
        ),
        (names(&["left_arm", "head"]), "moves none of left_arm, head"),
        (names(&["left_leg"]), "moves none of"),
    ] {
        check(&|p| p.behaviors[1].joints = joints.clone(), second, says);
    }
    let aims = [
        (Aiming::Parameters(vec![]), "1 parameters"),
        (Aiming::Parameters(vec![0.1, 0.2]), "1 parameters"),
        (Aiming::Parameters(vec![f64::NAN]), "finite"),
        (Aiming::Parameters(vec![1.2]), "lies in 0 to 1"),
        (
            Aiming::Reach {
                effector: "right_hnad".into(),
                at: [0.3; 3],
            },
            "nearest: `right_hand`",
        ),
        (
            Aiming::Reach {
                effector: "right_hand".into(),
                at: [0.3, f64::NAN, 0.0],
            },
            "finite",
        ),
    ];
    for (aim, says) in aims {
        check(&|p| p.behaviors[1].aim = aim.clone(), second, says);
    }
    check(
        &|p| p.rules[0].when = "rise".into(),
        Place::Rule(0),
        "when: unknown primitive `rise`; nearest: `raise`",
    );
    check(&|p| p.rules[0].then.repeat = 0, Place::Rule(0), "repeat");

    let mut unobserved = plan(Vec::new());
    unobserved.check(&vocabulary, None).expect("nothing to do");
    unobserved.rules.push(Rule {
        when: "raise".into(),
        then: Planned::new("reach"),
    });
    let fault = unobserved
        .check(&vocabulary, None)
        .expect_err("nothing is observed");
    assert_eq!(
        fault.to_string(),
        "rule 1: a rule waits for what is observed, but nothing is"
    );
}

#[test]
fn what_no_controller_can_be_made_of_is_refused() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = State::resting(vocabulary.body().neutral(), Root::ORIGIN);
    let asked = plan(vec![Planned::new("reach"), Planned::new("wave")]);
    let settings = ControlSettings::default;
    let connected = |from, to, effect| ControlSettings {
        connections: vec![Connection { from, to, effect }],
        ..settings()
    };
    let fed = |change: &dyn Fn(&mut Feedback)| {
        let mut feedback = Feedback::default();
        change(&mut feedback);
        ControlSettings {
            feedback,
            ..settings()
        }
    };
    let [first, second] = [Place::Behavior(0), Place::Behavior(1)];
    for (settings, says) in [
        (
            connected(first, Place::Rule(0), Effect::Inhibit),
            "no behavior",
        ),
        (
            connected(Place::Plan, first, Effect::Inhibit),
            "no behavior",
        ),
        (connected(first, first, Effect::Select), "itself"),
        (
            connected(first, second, Effect::Suppress { secs: -1.0 }),
            "suppression",
        ),
        (
            connected(first, second, Effect::Aim(Aiming::Parameters(vec![3.0]))),
            "lies in",
        ),
        (fed(&|f| f.share = 1.0), "share"),
        (fed(&|f| f.slowest = 0.0), "slows"),
        (fed(&|f| f.tolerance_rad = f64::NAN), "tolerance_rad"),
        (fed(&|f| f.lag_secs = -1.0), "lags"),
        (
            ControlSettings {
                rest_secs: Some(-1.0),
                ..settings()
            },
            "rest_secs",
        ),
        (
            ControlSettings {
                winning_margin: f64::NAN,
                ..settings()
            },
            "winning_margin",
        ),
    ] {
        let made = Controller::new(&vocabulary, &asked, &start, &settings);
        assert!(
            made.is_err_and(|e| e.is_invalid() && e.to_string().contains(says)),
            "{says}"
        );
    }
    let short = State::resting(vec![0.0], Root::ORIGIN);
    let made = Controller::new(&vocabulary, &asked, &short, &settings());
    assert!(made.is_err_and(|e| e.to_string().contains("coordinates")));
}

#[test]
fn a_kinematic_robot_is_where_it_is_told_to_be_and_refuses_what_is_no_posture() {
    let vocabulary = vocabulary_of(of_adonis());
    let body = vocabulary.body();
    let mut robot = KinematicRobot::new(Arc::clone(body));
    assert_eq!(robot.sensed().pose, body.neutral());
    assert!(!robot.is_physical());
    let start = State::resting(body.neutral(), Root::ORIGIN);
    let asked = plan(vec![Planned::new("reach")]);
    let mut controller =
        Controller::new(&vocabulary, &asked, &start, &ControlSettings::default()).expect("a plan");
    for _ in 0..40 {
        let command = controller.tick(Some(robot.sensed()), None);
        robot.advance(command, 1.0 / 120.0).expect("a command");
        assert_eq!(robot.sensed().pose, command.pose);
        assert_eq!(robot.sensed().velocity, command.velocity);
    }
    assert_eq!((robot.effort().saturated, robot.effort().torques), (0, 0));
    let before = robot.sensed().clone();
    let mut bad = controller.command().clone();
    assert!(robot.advance(&bad, 0.0).is_err());
    bad.pose[3] = f64::NAN;
    assert!(robot.advance(&bad, 0.01).is_err());
    assert!(robot.reset(&[0.0], &[0.0]).is_err());
    assert_eq!(*robot.sensed(), before);
}
