//! The six vocabularies written by hand: that they can be read and performed, and that they say what they mean.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use kineme::choreography::perform;
use kineme::math::rotation::{Axis, EulerOrder};
use kineme::skeleton::{Frame, JointKind};
use kineme::{Motion, Skeleton, adonis, ares};
use kineme_formats::script;
use nalgebra::{DMatrix, Vector3};

const RATE_HZ: f64 = 100.0;
/// The values that every adverb takes.
const LEVELS: [f64; 3] = [0.0, 0.5, 1.0];

/// A file of `choreography/`: its adverbs and its primitives.
struct File {
    name: &'static str,
    adverbs: [&'static str; 2],
    primitives: &'static [&'static str],
    /// Whether the second primitive goes back where the first came from.
    pair: bool,
}

const FILES: [File; 6] = [
    File {
        name: "boxing",
        adverbs: ["height", "side"],
        primitives: &["jab", "hook", "uppercut", "elbow", "shield"],
        pair: false,
    },
    File {
        name: "punching",
        adverbs: ["height", "side"],
        primitives: &["punch-out", "punch-return"],
        pair: true,
    },
    File {
        name: "vertical-waving",
        adverbs: ["amplitude", "side"],
        primitives: &["wave-up", "wave-down"],
        pair: true,
    },
    File {
        name: "horizontal-waving",
        adverbs: ["amplitude", "height"],
        primitives: &["wave-across", "wave-return"],
        pair: true,
    },
    File {
        name: "twist",
        adverbs: ["amplitude", "arms"],
        primitives: &["twist-left", "twist-right"],
        pair: true,
    },
    File {
        name: "greeting",
        adverbs: ["amplitude", "height"],
        primitives: &["greet-in", "greet-out"],
        pair: true,
    },
];

/// The nine exemplars of a primitive by the levels of its two adverbs.
type Grid = [[Motion; 3]; 3];

/// One file performed on one body: a grid for each primitive, in the order of [`File::primitives`].
struct Performed {
    file: &'static File,
    grids: Vec<Grid>,
}

impl Performed {
    fn new(file: &'static File, body: &Arc<Skeleton>) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../choreography")
            .join(format!("{}.toml", file.name));
        let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let script = script::parse(file.name, &bytes).unwrap();
        assert_eq!(script.body, "ares", "{}", file.name);
        assert!(script.animations.is_empty(), "{}", file.name);
        let mut exemplars = BTreeMap::new();
        for exemplar in &script.exemplars {
            let at = file.adverbs.map(|adverb| {
                let value = exemplar.parameters[adverb];
                LEVELS.iter().position(|&l| l == value).expect("a level")
            });
            assert_eq!(exemplar.parameters.len(), 2, "{}", file.name);
            let name = format!("{} {at:?}", exemplar.primitive);
            assert!((4..=7).contains(&exemplar.keys.len()), "{name}");
            let motion = perform(&name, &exemplar.keys, body, RATE_HZ).unwrap();
            let twin = exemplars.insert((exemplar.primitive.as_str(), at), motion);
            assert!(twin.is_none(), "{name} is written twice");
        }
        assert_eq!(exemplars.len(), 9 * file.primitives.len(), "{}", file.name);
        let grids = file.primitives.iter().map(|p| {
            [0, 1, 2]
                .map(|i| [0, 1, 2].map(|j| exemplars.remove(&(*p, [i, j])).expect("a whole grid")))
        });
        Self {
            file,
            grids: grids.collect(),
        }
    }

    fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.grids.iter().flatten().flatten()
    }
}

fn performed(body: Skeleton) -> Vec<Performed> {
    let body = Arc::new(body);
    let files = FILES.iter();
    files.map(|file| Performed::new(file, &body)).collect()
}

static ON_ARES: LazyLock<Vec<Performed>> = LazyLock::new(|| performed(ares().unwrap()));
static ON_ADONIS: LazyLock<Vec<Performed>> = LazyLock::new(|| performed(adonis().unwrap()));

/// Calls `check` with every exemplar of every file, on Ares and on Adonis.
fn check(check: impl Fn(&str, &Motion)) {
    for performed in ON_ARES.iter().chain(ON_ADONIS.iter()) {
        for motion in performed.motions() {
            let body = motion.skeleton().name();
            check(
                &format!("{} on {body}, {}", performed.file.name, motion.name()),
                motion,
            );
        }
    }
}

/// The frame at this share of the motion.
fn frame_at(motion: &Motion, phase: f64) -> usize {
    (phase * (motion.frames() - 1) as f64).round() as usize
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y));
    squares.sum::<f64>().sqrt()
}

/// A point of the body in its frames: an effector or a joint's centre.
fn point(motion: &Motion, name: &str, frames: &[Frame]) -> Vector3<f64> {
    let body = motion.skeleton();
    match body.effectors().iter().find(|e| e.name == name) {
        Some(e) => frames[e.joint].place(&e.point),
        None => frames[body.joint(name).expect("a joint")].position,
    }
}

/// The path of a point in the world or in the thorax frame.
fn path(motion: &Motion, name: &str, thorax: bool) -> Vec<Vector3<f64>> {
    let frames = (0..motion.frames()).map(|f| motion.frames_at(f));
    let place = |frames: Vec<Frame>| {
        let world = point(motion, name, &frames);
        match motion.skeleton().thorax(&frames) {
            Some(frame) if thorax => frame.local(&world),
            _ => world,
        }
    };
    frames.map(place).collect()
}

/// Where a path is farthest from its start.
fn extreme(path: &[Vector3<f64>]) -> usize {
    let far = |f: &usize| (path[*f] - path[0]).norm();
    let farthest = (0..path.len()).max_by(|a, b| far(a).total_cmp(&far(b)));
    farthest.expect("a path")
}

#[test]
fn durations_are_those_of_a_person() {
    let seconds = |file: &str| -> RangeInclusive<f64> {
        match file {
            "boxing" => 0.5..=1.2,
            _ => 0.3..=3.0,
        }
    };
    for performed in ON_ARES.iter() {
        for motion in performed.motions() {
            let found = motion.duration_secs();
            assert!(
                seconds(performed.file.name).contains(&found),
                "{}: {found} s",
                motion.name()
            );
        }
    }
}

#[test]
fn joints_stay_in_human_ranges_and_coordinates_in_one_chart() {
    check(|what, motion| {
        let body = motion.skeleton();
        for (j, joint) in body.joints().iter().enumerate() {
            let (ranges, order, signs) = match &joint.kind {
                JointKind::Fixed => continue,
                JointKind::Hinge { range, .. } => {
                    for f in 0..motion.frames() {
                        let angle = motion.pose(f)[body.coordinates(j).start];
                        let inside = range.low <= angle && angle <= range.high;
                        assert!(inside, "{what}, {}: {angle}", joint.name);
                    }
                    continue;
                }
                JointKind::Ball { ranges, .. } => {
                    let axes = [joint.axes.flexion, joint.axes.abduction, joint.axes.axial];
                    let order = EulerOrder(axes.map(|a| [Axis::X, Axis::Y, Axis::Z][a.iamax()]));
                    (ranges, order, axes.map(|a| a.sum()))
                }
            };
            for f in 0..motion.frames() {
                let coordinates = &motion.pose(f)[body.coordinates(j)];
                let length = Vector3::from_column_slice(coordinates).norm();
                assert!(length < 3.0, "{what}, {}: {length}", joint.name);
                let angles = order.angles(&body.rotation(j, coordinates));
                for ((angle, sign), range) in angles.iter().zip(signs).zip(ranges) {
                    let angle = angle * sign;
                    // A hundredth of a degree for the vertebrae, which divide what the chest does.
                    let inside = range.low - 2e-4 <= angle && angle <= range.high + 2e-4;
                    let degrees = angle.to_degrees();
                    assert!(inside, "{what}, {}, frame {f}: {degrees}", joint.name);
                }
            }
        }
    });
}

#[test]
fn joints_turn_no_faster_than_a_person_can() {
    check(|what, motion| {
        let body = motion.skeleton();
        for f in 1..motion.frames() {
            for j in 0..body.joints().len() {
                let turn = |f: usize| body.rotation(j, &motion.pose(f)[body.coordinates(j)]);
                let speed = turn(f - 1).angle_to(&turn(f)) * RATE_HZ;
                let name = &body.joints()[j].name;
                assert!(speed < 25.0, "{what}, {name}: {speed} rad/s");
            }
        }
    });
}

#[test]
fn movements_are_at_rest_at_both_ends() {
    check(|what, motion| {
        let last = motion.frames() - 1;
        let fastest = (1..=last)
            .map(|f| distance(motion.pose(f - 1), motion.pose(f)))
            .fold(0.0, f64::max);
        // The last frame may come up to one frame before the last key.
        for (a, b) in [(0, 1), (last - 1, last)] {
            let speed = distance(motion.pose(a), motion.pose(b));
            assert!(speed < 0.3 * fastest, "{what}: {speed} of {fastest}");
        }
    });
}

#[test]
fn no_arm_passes_through_head_or_trunk() {
    // A head of 10 cm about its centre; a trunk 20 cm deep and 32 cm wide.
    let (head, deep, wide) = (0.10, 0.10, 0.16);
    check(|what, motion| {
        let body = motion.skeleton();
        for f in 0..motion.frames() {
            let frames = motion.frames_at(f);
            let thorax = body.thorax(&frames).expect("shoulders");
            let skull = point(motion, "head", &frames);
            for side in ["left", "right"] {
                let [elbow, wrist] = ["elbow", "wrist"].map(|j| {
                    let joint = body.joint(&format!("{side}_{j}")).expect("a joint");
                    frames[joint]
                });
                let knuckles = wrist.place(&Vector3::new(0.0, 0.0, -0.086));
                let (e, w) = (elbow.position, wrist.position);
                for p in [e, e.lerp(&w, 0.5), w, knuckles] {
                    assert!((p - skull).norm() > head, "{what}, frame {f}: {side}, head");
                    let l = thorax.local(&p);
                    let outside = (l.x / deep).hypot(l.y / wide) > 1.0 || l.z > 0.03 || l.z < -0.45;
                    assert!(outside, "{what}, frame {f}: {side}, trunk");
                }
            }
        }
    });
}

#[test]
fn adverbs_change_the_posture_in_the_middle_each_in_its_own_way() {
    for performed in ON_ARES.iter().chain(ON_ADONIS.iter()) {
        for (grid, name) in performed.grids.iter().zip(performed.file.primitives) {
            let middle = |i: usize, j: usize| grid[i][j].pose(frame_at(&grid[i][j], 0.5));
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let from = middle(i, j);
                let slope = |to: &[f64]| -> Vec<f64> {
                    let step = LEVELS[1] - LEVELS[0];
                    to.iter().zip(from).map(|(b, a)| (b - a) / step).collect()
                };
                let columns = [slope(middle(i + 1, j)), slope(middle(i, j + 1))].concat();
                let jacobian = DMatrix::from_column_slice(from.len(), 2, &columns);
                let least = jacobian.singular_values().min();
                assert!(least > 0.15, "{name} at {i}, {j}: {least} rad");
            }
        }
    }
}

#[test]
fn no_two_exemplars_are_alike() {
    for performed in ON_ARES.iter() {
        let motions: Vec<&Motion> = performed.motions().collect();
        for (k, a) in motions.iter().enumerate() {
            for b in &motions[..k] {
                let apart = [0.25, 0.5, 0.75]
                    .map(|phase| distance(a.pose(frame_at(a, phase)), b.pose(frame_at(b, phase))))
                    .into_iter()
                    .fold(0.0, f64::max);
                assert!(apart > 0.15, "{} and {}: {apart}", a.name(), b.name());
            }
        }
    }
}

#[test]
fn boxing_goes_from_the_guard_back_to_the_guard() {
    let boxing = &ON_ARES[0];
    let guard = boxing.grids[0][0][0].pose(0);
    for motion in boxing.motions() {
        let start = distance(motion.pose(0), guard);
        let end = distance(motion.pose(motion.frames() - 1), guard);
        assert!(start < 1e-12, "{}", motion.name());
        assert!(end < 0.05, "{}: {end}", motion.name());
    }
}

#[test]
fn returns_take_up_where_the_way_out_ends_and_go_the_other_way() {
    for performed in ON_ARES.iter().filter(|p| p.file.pair) {
        let [out, back] = &performed.grids[..] else {
            panic!("a pair");
        };
        for (out, back) in out.iter().flatten().zip(back.iter().flatten()) {
            let what = out.name();
            let ends = |m: &Motion| (m.pose(0).to_vec(), m.pose(m.frames() - 1).to_vec());
            let ((a, b), (c, d)) = (ends(out), ends(back));
            let gaps = [distance(&b, &c), distance(&a, &d)];
            assert!(gaps.iter().all(|g| *g < 0.05), "{what}: {gaps:?}");
            let velocity = |m: &Motion, f: usize| -> Vec<f64> {
                let pair = m.pose(f - 1).iter().zip(m.pose(f + 1));
                pair.map(|(a, b)| b - a).collect()
            };
            let from = frame_at(out, 0.5);
            let near = |f: &usize| distance(back.pose(*f), out.pose(from));
            let to = (1..back.frames() - 1)
                .min_by(|a, b| near(a).total_cmp(&near(b)))
                .expect("frames");
            let (u, v) = (velocity(out, from), velocity(back, to));
            let none = vec![0.0; u.len()];
            let product: f64 = u.iter().zip(&v).map(|(a, b)| a * b).sum();
            let cosine = product / (distance(&u, &none) * distance(&v, &none));
            assert!(cosine < -0.8, "{what}: {cosine}");
        }
    }
}

/// What an adverb does: a measure of the movement that rises with it.
enum Effect {
    /// Place of a point at its extreme, along z.
    High(&'static str),
    /// Place of a point at its extreme, along -y, as the one who moves says right.
    Right(&'static str),
    /// How far apart along an axis the places of a point come.
    Travel(&'static str, Axis),
    /// Mean of a point's places along z.
    Level(&'static str),
    /// Mean of a point's places along -y.
    Aside(&'static str),
    /// The angle between the trunk's utmost headings, radians.
    Turn,
}

impl Effect {
    fn of(&self, motion: &Motion, thorax: bool) -> f64 {
        let mean = |path: &[Vector3<f64>], axis: usize| {
            path.iter().map(|p| p[axis]).sum::<f64>() / path.len() as f64
        };
        // The extreme is where the hand is farthest in the thorax frame, whichever frame it is then seen in.
        let at_extreme =
            |name: &str| path(motion, name, thorax)[extreme(&path(motion, name, true))];
        let span = |values: Vec<f64>| {
            let ends = values
                .iter()
                .fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            ends.1 - ends.0
        };
        match self {
            Effect::High(name) => at_extreme(name).z,
            Effect::Right(name) => -at_extreme(name).y,
            Effect::Travel(name, axis) => {
                let path = path(motion, name, thorax);
                span(path.iter().map(|p| p[axis.index()]).collect())
            }
            Effect::Level(name) => mean(&path(motion, name, thorax), 2),
            Effect::Aside(name) => -mean(&path(motion, name, thorax), 1),
            Effect::Turn => {
                let heading = |f: usize| {
                    let frames = motion.frames_at(f);
                    let thorax = motion.skeleton().thorax(&frames).expect("shoulders");
                    let ahead = thorax.rotation * Vector3::x();
                    ahead.y.atan2(ahead.x)
                };
                span((0..motion.frames()).map(heading).collect())
            }
        }
    }
}

#[test]
fn adverbs_move_the_body_the_way_their_names_say() {
    use Effect::{Aside, High, Level, Right, Travel, Turn};
    let (left, right) = ("left_hand", "right_hand");
    // Primitive, effects of the first and of the second adverb, the least difference that the adverb makes from end
    // to end (metres or radians), and whether it shows in the thorax frame as in the world.
    let cases: &[(&str, [Effect; 2], f64, bool)] = &[
        ("jab", [High(right), Right(right)], 0.25, true),
        ("hook", [High(left), Right(left)], 0.25, true),
        ("uppercut", [High(left), Right(left)], 0.25, true),
        (
            "elbow",
            [High("right_elbow"), Right("right_elbow")],
            0.25,
            false,
        ),
        ("shield", [High(left), Right(left)], 0.25, false),
        ("shield", [High(right), Right(right)], 0.25, false),
        ("punch-out", [High(right), Right(right)], 0.25, true),
        (
            "wave-up",
            [Travel(right, Axis::Z), Aside(right)],
            0.25,
            true,
        ),
        (
            "wave-down",
            [Travel(right, Axis::Z), Aside(right)],
            0.25,
            true,
        ),
        (
            "wave-across",
            [Travel(right, Axis::Y), Level(right)],
            0.25,
            true,
        ),
        (
            "wave-return",
            [Travel(right, Axis::Y), Level(right)],
            0.25,
            true,
        ),
        (
            "greet-in",
            [Travel(right, Axis::Y), Level(right)],
            0.1,
            true,
        ),
        (
            "greet-out",
            [Travel(right, Axis::Y), Level(right)],
            0.1,
            true,
        ),
        ("twist-left", [Turn, Level(right)], 0.25, false),
        ("twist-right", [Turn, Level(left)], 0.25, false),
    ];
    for performed in ON_ARES.iter().chain(ON_ADONIS.iter()) {
        for (grid, name) in performed.grids.iter().zip(performed.file.primitives) {
            for (_, effects, least, both) in cases.iter().filter(|c| c.0 == *name) {
                for thorax in [false, true].into_iter().filter(|t| *both || !t) {
                    for (which, effect) in effects.iter().enumerate() {
                        for k in 0..3 {
                            let of = |level: usize| {
                                let [i, j] = [[level, k], [k, level]][which];
                                effect.of(&grid[i][j], thorax)
                            };
                            let found = [of(0), of(1), of(2)];
                            let what = format!("{name}, adverb {which}, other {k}, {thorax}");
                            assert!(
                                found.is_sorted_by(|a, b| a < b) && found[2] - found[0] >= *least,
                                "{what}: {found:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}
