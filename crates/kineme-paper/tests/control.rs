//! Section IV in physics: what `docs/control.md` tables, in small.
#![cfg(feature = "sim")]

use std::path::Path;
use std::sync::{Arc, LazyLock};

use kineme::control::KinematicRobot;
use kineme::{Skeleton, Vocabulary, adonis, ares};
use kineme_paper::choreographies::{SCRIPTS, choreography, everything};
use kineme_paper::control::disturbance::{BACK_RAD, begun, posture, pushed};
use kineme_paper::control::robots::{beyond_limits, robot, routine};
use kineme_paper::control::tracking::{performing, swinging};
use kineme_paper::sparring;
use kineme_sim::{Servo, SimSettings, SimulatedRobot};
use rand::SeedableRng;
use rand_pcg::Pcg64;

static ADONIS: LazyLock<Arc<Skeleton>> = LazyLock::new(|| Arc::new(adonis().expect("adonis")));
static ARES: LazyLock<Arc<Skeleton>> = LazyLock::new(|| Arc::new(ares().expect("ares")));

fn simulated(body: &Arc<Skeleton>) -> SimulatedRobot {
    SimulatedRobot::humanoid(body, &SimSettings::default()).expect("a robot")
}

fn boxing(body: &Arc<Skeleton>) -> Vocabulary {
    choreography(SCRIPTS[0].0, SCRIPTS[0].1, body).expect("boxing")
}

#[test]
fn hinges_swing_as_near_as_their_law_allows() {
    use Servo::{ComputedTorque, FeedforwardFeedback, Pd};
    let cases = [
        (&ADONIS, Pd, 0.02),
        (&ADONIS, FeedforwardFeedback, 0.0006),
        (&ADONIS, ComputedTorque, 0.0006),
        (&ARES, FeedforwardFeedback, 0.002),
        (&ARES, ComputedTorque, 0.0006),
    ];
    for (body, servo, most) in cases {
        let rms = swinging(body, servo, 1.5).expect("a swing").rms_rad();
        assert!(rms <= most, "{} {servo:?}: {rms} rad", body.name());
    }
}

#[test]
fn strokes_are_performed() {
    for (body, most_degrees) in [(&ADONIS, 2.0), (&ARES, 0.5)] {
        let vocabulary = boxing(body);
        let mut robot = simulated(body);
        for name in ["jab", "uppercut"] {
            let primitive = vocabulary.primitive(name).expect("a stroke");
            let course = Arc::new(primitive.at(&primitive.middle()).expect("a course"));
            let errors = performing(&mut robot, &course).expect("a performance");
            let degrees = errors.rms_rad().to_degrees();
            assert!(degrees <= most_degrees, "{} {name}: {degrees}", body.name());
        }
    }
}

#[test]
fn a_pushed_body_comes_back_and_completes() {
    let vocabulary = boxing(&ADONIS);
    let mut robot = simulated(&ADONIS);
    for phase in [0.2, 0.5, 0.8] {
        let came = pushed(&mut robot, &vocabulary, "jab", "right_wrist", phase).expect("a push");
        assert!(came.away_rad > 0.005, "{phase}: it was a push: {came:?}");
        assert!(came.left_rad <= BACK_RAD, "{phase}: {came:?}");
        assert!(came.completed, "{phase}");
    }
}

#[test]
fn from_any_posture_a_stroke_is_completed() {
    let vocabulary = boxing(&ADONIS);
    let mut robot = simulated(&ADONIS);
    let mut random = Pcg64::seed_from_u64(1);
    for _ in 0..5 {
        let from = posture(&ADONIS, &mut random);
        let end = begun(&mut robot, &vocabulary, "hook", &from).expect("a run");
        assert!(end.is_some_and(|end| end < 0.05), "{end:?}");
    }
}

#[test]
fn attacks_are_answered_and_nothing_else_is() {
    let vocabulary = boxing(&ADONIS);
    let filter = kineme::perception::Filter::new(&vocabulary, &Default::default());
    let filter = filter.expect("a filter");
    let attacks = ["jab", "uppercut"];
    let rules = sparring::rules(&attacks, "shield");
    let attacker = sparring::attacker(&vocabulary, &attacks, 4, 3).expect("an attacker");
    let mut robot = KinematicRobot::new(Arc::clone(&ADONIS));
    let came = sparring::spar(&vocabulary, &filter, &rules, &attacker, &mut robot);
    let came = came.expect("a bout");
    assert_eq!((came.delays.len(), came.missed), (4, 0), "{came:?}");
    assert_eq!(came.false_answers, 0);
    assert!(came.delays.iter().all(|d| *d < 0.6), "{:?}", came.delays);
}

#[test]
fn the_g1_waves_within_its_limits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.mujoco/robots/unitree_g1/g1.xml");
    if !path.exists() {
        eprintln!("skipped: no robot at .mujoco/robots; `cargo xtask setup --robots` fetches it");
        return;
    }
    let vocabulary = everything(&ARES).expect("primitives");
    let mut robot = robot(&path).expect("a robot");
    let done = routine(&vocabulary, &["wave-up", "twist-left"], &mut robot).expect("a routine");
    assert!(done.ran.iter().all(|ran| ran.completed), "{:?}", done.ran);
    assert!(done.tracking.rms_rad < 0.01, "{:?}", done.tracking);
    assert!(beyond_limits(&done.done) < 0.01);
    assert_eq!(done.effort.saturated, 0);
}
