//! Robots of URDF files: the same as what MJCF says of them, what is held, what is refused.

use kineme::skeleton::JointKind;
use kineme::{Root, Skeleton};
use kineme_formats::robot::{self as robots, RobotModel};
use kineme_formats::{FormatError, Place, Result};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// A robot, and the same as MJCF.
const ROBOT: &str = include_str!("common/small.urdf");
const SAME: &str = include_str!("common/small.xml");

/// A link that weighs something, and one hinge with all that a hinge can have.
const HINGE: &str = r#"<robot name="one">
  <link name="base"/>
  <link name="arm">
    <inertial>
      <origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/>
      <mass value="2"/>
      <inertia ixx="0.1" ixy="0.01" ixz="0.02" iyy="0.2" iyz="0.03" izz="0.25"/>
    </inertial>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/>
    <child link="arm"/>
    <origin xyz="1 2 3" rpy="0.4 0.5 0.6"/>
    <axis xyz="0 0 2"/>
    <limit lower="-1" upper="2" effort="30" velocity="4"/>
    <dynamics damping="0.5" friction="0.25"/>
  </joint>
</robot>"#;

fn alone(file: &str) -> Result<Vec<u8>> {
    Err(FormatError::new(file, Place::File, "nothing", "a file"))
}

fn parsed(text: &str) -> Result<RobotModel> {
    robots::parse("small", text.as_bytes(), &alone, None)
}

fn robot(text: &str) -> RobotModel {
    parsed(text).unwrap_or_else(|e| panic!("{e}"))
}

/// A robot of these links (names) and joints (elements), whose first hinge is `turn`, of `base` and `arm`.
fn with(links: &str, joints: &str) -> String {
    let links = links.split_whitespace();
    let links: String = links.map(|l| format!("<link name=\"{l}\"/>")).collect();
    HINGE.replace("</robot>", &format!("{links}{joints}</robot>"))
}

/// A joint of this type and these links with these elements in it.
fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}</joint>"
    )
}

/// Where a joint (or the link of a fixed one) is when the hinges have these angles of the file's.
fn place(robot: &RobotModel, name: &str, angles: &[f64]) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let body = &robot.skeleton;
    let offsets = robot.hinges.iter().map(|h| h.neutral_rad);
    let pose: Vec<f64> = angles.iter().zip(offsets).map(|(a, o)| a - o).collect();
    let frame = &body.frames(&pose, &Root::ORIGIN)[body.joint(name).expect("a joint")];
    (frame.position, frame.rotation)
}

fn assert_same(one: &RobotModel, other: &RobotModel, mass: f64) {
    let near = |a: &Vector3<f64>, b: &Vector3<f64>| (a - b).norm() < 1e-6;
    let (a, b) = (&one.skeleton, &other.skeleton);
    assert_eq!(a.name(), b.name());
    assert_eq!(one.root, other.root);
    let names = |body: &Skeleton| -> Vec<String> {
        let joints = body.joints().iter();
        joints
            .map(|j| format!("{} {:?} {:?}", j.name, j.parent, j.role))
            .collect()
    };
    assert_eq!(names(a), names(b));
    for (x, y) in a.joints().iter().zip(b.joints()) {
        assert!(near(&x.offset, &y.offset), "{}: {x:?} {y:?}", x.name);
        assert!(near(&x.tip, &y.tip), "{}: {x:?} {y:?}", x.name);
        assert!(
            (x.link.mass_kg - y.link.mass_kg).abs() <= mass,
            "{}",
            x.name
        );
        assert!(
            near(&x.link.center, &y.link.center),
            "{}: {x:?} {y:?}",
            x.name
        );
        assert!(
            (x.link.inertia - y.link.inertia).norm() < 1e-6,
            "{}",
            x.name
        );
        match (&x.kind, &y.kind) {
            (
                JointKind::Hinge { axis, range },
                JointKind::Hinge {
                    axis: other,
                    range: room,
                },
            ) => {
                assert!(near(axis, other), "{}", x.name);
                assert!((range.low - room.low).abs() < 1e-6, "{}", x.name);
                assert!((range.high - room.high).abs() < 1e-6, "{}", x.name);
            }
            (x, y) => assert_eq!(x, y),
        }
    }
    for (x, y) in one.hinges.iter().zip(&other.hinges) {
        assert_eq!(x.joint, y.joint);
        assert!((x.neutral_rad - y.neutral_rad).abs() < 1e-6, "{x:?} {y:?}");
    }
}

#[test]
fn a_urdf_is_the_robot_that_the_same_mjcf_is() {
    let found = robot(ROBOT);
    assert_same(&found, &robot(&SAME.replacen(" ref=\"10\"", "", 1)), 0.0);
    assert_eq!(found.skeleton.dof(), 11);
    assert_eq!(found.warnings.len(), 1, "{:?}", found.warnings);
    assert!(
        found.warnings[0].contains("`left_shoulder`"),
        "{:?}",
        found.warnings
    );
}

/// A robot's links carry frames of sensors, which are listed where it pleases those who wrote the file.
#[test]
fn a_bone_ends_where_the_next_part_that_moves_begins() {
    let wrist = "<joint name=\"left_wrist\"";
    let camera = joint(
        "eye",
        "fixed",
        "left_forearm",
        "camera",
        "<origin xyz='0 0 0.1'/>",
    );
    let seeing = ROBOT.replacen(wrist, &format!("<link name='camera'/>{camera}{wrist}"), 1);
    let [plain, seeing] = [ROBOT, &seeing].map(|text| robot(text).skeleton);
    let tip = |body: &Skeleton| body.joints()[body.joint("left_elbow").expect("an elbow")].tip;
    assert!((tip(&plain) - tip(&seeing)).norm() < 1e-9);
    assert_eq!(seeing.joints().len(), plain.joints().len() + 1);
}

#[test]
fn what_an_engine_is_given_is_the_same_robot() {
    for text in [ROBOT, HINGE] {
        let found = robot(text);
        let given = found.mjcf.as_deref().expect("a model");
        assert_same(&found, &robot(given), 1e-6);
    }
    let given = robot(HINGE).mjcf.expect("a model");
    for piece in [
        "range=\"-1 2\"",
        "actuatorfrcrange=\"-30 30\"",
        "damping=\"0.5\"",
        "frictionloss=\"0.25\"",
    ] {
        assert!(given.contains(piece), "{piece}: {given}");
    }
    assert!(robot(SAME).mjcf.is_none());
    // Names are texts: what XML has a meaning for is escaped.
    let odd = HINGE.replace("\"turn\"", "\"a&amp;&lt;&quot;&#10;'b\"");
    let found = robot(&odd);
    assert_eq!(found.hinges[0].joint, "a&<\"\n'b");
    assert_same(&found, &robot(&found.mjcf.clone().expect("a model")), 1e-6);
}

/// Turns of rpy are about axes that stay: R = Rz(yaw) Ry(pitch) Rx(roll).
#[test]
fn origins_turn_about_fixed_axes_first_roll_then_pitch_then_yaw() {
    let turn = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
    let rpy =
        |[r, p, y]: [f64; 3]| turn(Vector3::z(), y) * turn(Vector3::y(), p) * turn(Vector3::x(), r);
    let found = robot(HINGE);
    let frame = rpy([0.4, 0.5, 0.6]);
    let hinge = &found.skeleton.joints()[1];
    let JointKind::Hinge { axis, range } = &hinge.kind else {
        panic!("{hinge:?}");
    };
    assert!((axis.into_inner() - frame * Vector3::z()).norm() < 1e-12);
    assert_eq!((range.low, range.high), (-1.0, 2.0));
    assert_eq!(hinge.offset, Vector3::new(1.0, 2.0, 3.0));
    // The centre of mass and the inertia stand in the link, turned once more.
    let center = frame * Vector3::new(0.1, 0.2, 0.3);
    assert!((hinge.link.center - center).norm() < 1e-12);
    let inertia = Matrix3::new(0.1, 0.01, 0.02, 0.01, 0.2, 0.03, 0.02, 0.03, 0.25);
    let turned = (frame * rpy([0.3, -0.4, 0.5]))
        .to_rotation_matrix()
        .into_inner();
    let wanted = turned * inertia * turned.transpose();
    assert!((hinge.link.inertia - wanted).norm() < 1e-12);
    // The same orientation as a quaternion.
    let q = frame.quaternion();
    let quaternion = format!("quat_xyzw=\"{} {} {} {}\"", q.i, q.j, q.k, q.w);
    assert_same(
        &found,
        &robot(&HINGE.replace("rpy=\"0.4 0.5 0.6\"", &quaternion)),
        0.0,
    );
}

#[test]
fn joints_that_are_no_coordinates_are_held_and_told() {
    let x = "<origin xyz='1 0 0'/><axis xyz='0 0 1'/>";
    let limit = |low: f64, high: f64| {
        format!("{x}<limit lower='{low}' upper='{high}' effort='1' velocity='1'/>")
    };
    let mimic = |of: &str, times: f64, more: f64| {
        format!("{x}<mimic joint='{of}' multiplier='{times}' offset='{more}'/>")
    };
    let end = joint("tip", "fixed", "held", "tip", "<origin xyz='0 1 0'/>");
    // Links held, tip: in `arm`'s frame at 1 0 0, the tip 1 beside, turned or moved by the angle at which it is held.
    let other = joint("other", "revolute", "arm", "other", &limit(-2.0, 2.0));
    let high = joint("other", "revolute", "arm", "other", &limit(0.5, 2.0));
    for (kind, inside, rest, angle, slide, told) in [
        ("fixed", x.to_string(), "", 0.0, 0.0, ""),
        ("prismatic", limit(-1.0, 1.0), "", 0.0, 0.0, "sliding"),
        ("prismatic", limit(0.25, 1.0), "", 0.0, 0.25, "sliding"),
        ("revolute", limit(0.0, 0.0), "", 0.0, 0.0, "no room"),
        ("revolute", limit(0.75, 0.75), "", 0.75, 0.0, "no room"),
        (
            "revolute",
            mimic("turn", 2.0, 0.5),
            "",
            0.5,
            0.0,
            "mimicking",
        ),
        (
            "continuous",
            mimic("other", 2.0, 0.5),
            &other,
            0.5,
            0.0,
            "mimicking",
        ),
        (
            "continuous",
            mimic("other", 2.0, 0.5),
            &high,
            1.5,
            0.0,
            "mimicking",
        ),
        (
            "prismatic",
            mimic("other", 2.0, -0.5),
            &other,
            0.0,
            -0.5,
            "mimicking",
        ),
        (
            "revolute",
            limit(-0.1, 0.1) + &mimic("turn", 2.0, 0.5),
            "",
            0.1,
            0.0,
            "mimicking",
        ),
    ] {
        let held = joint("held", kind, "arm", "held", &inside);
        let links = if rest.is_empty() {
            "held tip"
        } else {
            "held tip other"
        };
        let found = robot(&with(links, &format!("{held}{end}{rest}")));
        let at = vec![0.0; found.skeleton.dof()];
        let arm = UnitQuaternion::from_euler_angles(0.4, 0.5, 0.6);
        let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * angle) * Vector3::y();
        let wanted = Vector3::new(1.0, 2.0, 3.0) + arm * (Vector3::new(1.0, 0.0, slide) + turned);
        let (is, _) = place(&found, "tip", &at);
        assert!(
            (is - wanted).norm() < 1e-9,
            "{kind} {inside}: {is} not {wanted}"
        );
        let said = found.warnings.iter().any(|w| w.contains("`held`"));
        assert_eq!(said, !told.is_empty(), "{:?}", found.warnings);
        assert!(found.warnings.iter().any(|w| w.contains(told)) || told.is_empty());
        assert_eq!(found.skeleton.dof(), if rest.is_empty() { 1 } else { 2 });
    }
    // A chain of those that mimic: 2 (3 * 0 + 0.1) + 0.2.
    let chain = joint(
        "held",
        "continuous",
        "arm",
        "held",
        &mimic("middle", 2.0, 0.2),
    ) + &joint(
        "middle",
        "continuous",
        "arm",
        "middle",
        &mimic("turn", 3.0, 0.1),
    ) + &end;
    let found = robot(&with("held middle tip", &chain));
    let (_, middle) = place(&found, "held", &[0.0]);
    let (tip, _) = place(&found, "tip", &[0.0]);
    let (held, _) = place(&found, "held", &[0.0]);
    let arm = UnitQuaternion::from_euler_angles(0.4, 0.5, 0.6);
    let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * 0.4) * Vector3::y();
    assert!((tip - held - arm * turned).norm() < 1e-9, "{middle:?}");
}

#[test]
fn the_base_is_what_the_world_carries() {
    let base = |kind: &str, world: &str| {
        let held = joint("held", kind, world, "base", "<origin xyz='0 0 9'/>");
        robot(&with(world, &held))
    };
    for (kind, world, root) in [
        ("floating", "world", "base"),
        ("floating", "odom", "base"),
        ("planar", "map", "base"),
        ("fixed", "world", "base"),
        ("fixed", "stand", "stand"),
    ] {
        let found = base(kind, world);
        assert_eq!(found.root, root, "{kind} {world}");
        assert_eq!(found.skeleton.dof(), 1);
        assert_same(
            &found,
            &robot(found.mjcf.as_deref().expect("a model")),
            1e-6,
        );
    }
    // Two arms in one world are one robot, and no body of an engine's has the world's name.
    let arm = joint("left", "continuous", "world", "base", "")
        + &joint("right", "continuous", "world", "other", "");
    let found = robot(&with("world other", &arm));
    assert_eq!(
        (found.root.as_str(), found.skeleton.dof()),
        ("world_body", 3)
    );
    assert_same(
        &found,
        &robot(found.mjcf.as_deref().expect("a model")),
        1e-6,
    );
}

#[test]
fn a_hinge_ends_where_the_file_says_and_a_continuous_one_nowhere() {
    let tau = std::f64::consts::TAU;
    for (kind, limit, low, high) in [
        ("revolute", "lower='-1' upper='2' effort='1'", -1.0, 2.0),
        ("revolute", "upper='2'", 0.0, 2.0),
        ("revolute", "lower='-2'", -2.0, 0.0),
        ("revolute", "lower='-1e16' upper='1e16'", -tau, tau),
        ("revolute", "lower='-inf' upper='1'", -tau, 1.0),
        ("revolute", "lower='-1' upper='inf'", -1.0, tau),
        ("revolute", "lower='-20' upper='20'", -20.0, 20.0),
        ("continuous", "lower='-1' upper='2'", -tau, tau),
        ("continuous", "effort='3'", -tau, tau),
    ] {
        let limits = "lower=\"-1\" upper=\"2\" effort=\"30\" velocity=\"4\"";
        let text = HINGE.replace(limits, limit).replace("revolute", kind);
        let found = robot(&text);
        let JointKind::Hinge { range, .. } = found.skeleton.joints()[1].kind.clone() else {
            panic!("a hinge");
        };
        let near = (range.low - low).abs() < 1e-12 && (range.high - high).abs() < 1e-12;
        assert!(near, "{kind} {limit}: {range:?}");
        let given = found.mjcf.expect("a model");
        assert_eq!(given.contains(" range=\""), kind == "revolute", "{given}");
    }
    let free = HINGE.replace("revolute", "continuous").replace(
        "<limit lower=\"-1\" upper=\"2\" effort=\"30\" velocity=\"4\"/>",
        "",
    );
    assert!(!robot(&free).mjcf.expect("a model").contains("range="));
    let idle = robot(&HINGE.replace("effort=\"30\"", "effort=\"0\""));
    assert!(!idle.mjcf.expect("a model").contains("frcrange"));
    assert!(
        idle.warnings.iter().any(|w| w.contains("effort of 0")),
        "{:?}",
        idle.warnings
    );
}

/// No hinge moves nothing, and no inertia is one that no body has: an engine takes neither.
#[test]
fn what_no_engine_takes_is_put_right_and_told() {
    let (inertia, mass) = (
        "ixx=\"0.1\" ixy=\"0.01\" ixz=\"0.02\" iyy=\"0.2\" iyz=\"0.03\" izz=\"0.25\"",
        "value=\"2\"",
    );
    let diagonal = |x: &str, y: &str, z: &str| {
        format!("ixx=\"{x}\" ixy=\"0\" ixz=\"0\" iyy=\"{y}\" iyz=\"0\" izz=\"{z}\"")
    };
    let least = "next to none: `arm`";
    let nearest = "nearest that one can: `arm`";
    for (mass_text, inertia_text, moments, told) in [
        (mass, diagonal("3", "4", "5"), [3.0, 4.0, 5.0], ""),
        // A plate, as digits round it.
        (mass, diagonal("1", "1", "2.0001"), [1.0, 1.0, 2.0], ""),
        (mass, diagonal("1", "1", "9"), [1.0, 1.0, 2.0], nearest),
        (mass, diagonal("1", "1", "-1"), [0.0, 1.0, 1.0], nearest),
        (mass, diagonal("0", "0", "0"), [1e-9; 3], least),
        ("value=\"0\"", diagonal("1", "1", "1"), [1.0; 3], least),
    ] {
        let text = HINGE
            .replace(inertia, &inertia_text)
            .replace(mass, mass_text);
        let found = robot(&text);
        let again = robot(found.mjcf.as_deref().expect("a model"));
        let link = &again.skeleton.joints()[1].link;
        let mut principal: [f64; 3] = link.inertia.symmetric_eigenvalues().into();
        principal.sort_by(f64::total_cmp);
        for (is, wanted) in principal.iter().zip(moments) {
            // Moments that are none are at least what resists a turn.
            assert!((is - wanted).abs() < 1e-8, "{inertia_text}: {principal:?}");
        }
        assert!(link.mass_kg >= 1e-6 && (link.mass_kg - 2.0).abs() < 1e-5 || mass_text != mass);
        let notes = found.warnings.join("\n");
        assert!(notes.contains(told), "{inertia_text}: {notes}");
        assert_eq!(notes.is_empty(), told.is_empty(), "{inertia_text}: {notes}");
    }
    // What is fixed to a link resists for it.
    let hand = joint("grip", "fixed", "arm", "hand", "");
    let light = HINGE
        .replace("name=\"arm\"", "name=\"hand\"")
        .replace("</robot>", &format!("<link name=\"arm\"/>{hand}</robot>"));
    assert!(robot(&light).warnings.is_empty());
}

#[test]
fn what_is_no_robot_is_refused_with_the_line_of_the_fault() {
    for (old, new, line, found) in [
        ("name=\"arm\"", "", 3, "<link> without `name`"),
        ("name=\"arm\"", "name=\" \"", 3, "name = ` `"),
        ("name=\"arm\"", "name=\"base\"", 3, "a second link `base`"),
        ("name=\"arm\"", "name=\"${side}_arm\"", 3, "run xacro"),
        (
            "xyz=\"0.1 0.2 0.3\"",
            "xyz=\"0.1 0.2\"",
            5,
            "xyz = `0.1 0.2`",
        ),
        (
            "xyz=\"0.1 0.2 0.3\"",
            "xyz=\"0.1 nan 0\"",
            5,
            "3 finite numbers",
        ),
        ("xyz=\"0.1 0.2 0.3\"", "xyz=\"${a} 0 0\"", 5, "run xacro"),
        ("<mass value=\"2\"/>", "", 4, "<inertial> without <mass>"),
        ("value=\"2\"", "value=\"-2\"", 6, "value = -2"),
        ("value=\"2\"", "value=\"two\"", 6, "value = `two`"),
        ("ixy=\"0.01\"", "", 7, "<inertia> without `ixy`"),
        (
            "name=\"turn\" type=\"revolute\"",
            "name=\"turn\"",
            10,
            "<joint> without `type`",
        ),
        (
            "type=\"revolute\"",
            "type=\"ball\"",
            10,
            "a joint of type `ball`",
        ),
        (
            "type=\"revolute\"",
            "type=\"floating\"",
            0,
            "no body with a hinge",
        ),
        (
            "<parent link=\"base\"/>",
            "",
            10,
            "<joint> without <parent>",
        ),
        (
            "<parent link=\"base\"/>",
            "<parent link=\"bass\"/>",
            10,
            "of link `bass`",
        ),
        (
            "<parent link=\"base\"/>",
            "<parent link=\"arm\"/>",
            3,
            "in a circle",
        ),
        (
            "<child link=\"arm\"/>",
            "<child/>",
            12,
            "<child> without `link`",
        ),
        (
            "rpy=\"0.4 0.5 0.6\"",
            "rpy=\"0.4\" quat_xyzw=\"0 0 0 1\"",
            13,
            "rpy = `0.4`",
        ),
        (
            "rpy=\"0.4 0.5 0.6\"",
            "rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\"",
            13,
            "one orientation",
        ),
        (
            "rpy=\"0.4 0.5 0.6\"",
            "quat_xyzw=\"0 0 0 0\"",
            13,
            "of no length",
        ),
        ("xyz=\"0 0 2\"", "xyz=\"0 0 0\"", 14, "an axis of no length"),
        ("lower=\"-1\"", "lower=\"3\"", 15, "lower = 3, upper = 2"),
        ("lower=\"-1\"", "lower=\"nan\"", 15, "lower = `nan`"),
        ("effort=\"30\"", "effort=\"-30\"", 15, "effort = -30"),
        ("damping=\"0.5\"", "damping=\"-1\"", 16, "damping = -1"),
        (
            "<limit lower=\"-1\" upper=\"2\" effort=\"30\" velocity=\"4\"/>",
            "",
            10,
            "`turn` without <limit>",
        ),
        (
            "</robot>",
            "<link name=\"c\"/></robot>",
            18,
            "links `base` and `c`",
        ),
        ("</robot>", "</robo>", 18, "XML"),
        (
            "<robot name=\"one\">",
            "<robot><xacro:macro/>",
            1,
            "run xacro",
        ),
        (
            "<robot name=\"one\">",
            "<robot xmlns:x=\"http://ros.org/wiki/xacro\">\n<x:macro/>",
            2,
            "<xacro:macro>",
        ),
        ("<robot name=\"one\">", "<robots>", 18, "XML"),
    ] {
        assert!(HINGE.contains(old), "{old}");
        let error = parsed(&HINGE.replacen(old, new, 1)).expect_err(new);
        assert!(error.to_string().contains(found), "{new}: {error}");
        let place = if line == 0 {
            Place::File
        } else {
            Place::Line(line)
        };
        assert_eq!(error.place, place, "{new}: {error}");
    }
    let joints =
        |links: &str, joints: &str| parsed(&with(links, joints)).expect_err(joints).to_string();
    let hinge = |name, parent, child, inside| joint(name, "continuous", parent, child, inside);
    for (links, wrong, found) in [
        (
            "",
            hinge("again", "base", "arm", ""),
            "link `arm` on joint `turn` and on joint `again`",
        ),
        ("c", hinge("turn", "arm", "c", ""), "a second joint `turn`"),
        (
            "c d",
            hinge("a", "c", "d", "") + &hinge("b", "d", "c", ""),
            "link `c` on joints that go in a circle",
        ),
        (
            "c",
            joint("a", "floating", "arm", "c", ""),
            "joint `a` that floats below link `arm`",
        ),
        (
            "c",
            hinge("a", "arm", "c", "<mimic joint='b'/>"),
            "mimics joint `b`, which is not there",
        ),
        (
            "c",
            hinge("a", "arm", "c", "<mimic joint='a'/>"),
            "`a` mimics itself",
        ),
        (
            "c d",
            hinge("a", "arm", "c", "<mimic joint='b'/>")
                + &hinge("b", "arm", "d", "<mimic joint='a'/>"),
            "mimics itself",
        ),
    ] {
        let error = joints(links, &wrong);
        assert!(
            error.contains(found) && error.contains(":18"),
            "{wrong}: {error}"
        );
    }
    for (text, found) in [
        ("<robot/>", "no <link>"),
        ("<robot><link name='a'/></robot>", "no body with a hinge"),
        (
            "<sdf/>",
            "expected a robot: <mujoco> (MJCF) or <robot> (URDF)",
        ),
    ] {
        let error = parsed(text).expect_err(text).to_string();
        assert!(error.contains(found), "{text}: {error}");
    }
}

#[test]
fn a_long_chain_is_read_in_no_time_and_one_that_is_too_long_refused() {
    let chain = |count: usize| {
        let links: String = (0..count).map(|k| format!("<link name='l{k}'/>")).collect();
        // Each hinge mimics the next, the last moves.
        let joints: String = (1..count)
            .map(|k| {
                let next = if k + 1 < count {
                    format!("<mimic joint='j{}'/>", k + 1)
                } else {
                    String::new()
                };
                joint(
                    &format!("j{k}"),
                    "continuous",
                    &format!("l{}", k - 1),
                    &format!("l{k}"),
                    &next,
                )
            })
            .collect();
        format!("<robot>{links}{joints}</robot>")
    };
    let found = robot(&chain(2000));
    assert_eq!(
        (found.skeleton.joints().len(), found.skeleton.dof()),
        (2000, 1)
    );
    let error = parsed(&chain(2001)).expect_err("too long");
    assert!(error.found.contains("more than 2000 links"), "{error}");
}

proptest! {
    #[test]
    fn a_damaged_file_is_read_or_refused(
        which in 0..2usize, at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<bool>(),
    ) {
        let mut bytes = [ROBOT, HINGE][which].as_bytes().to_vec();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if cut {
            bytes.truncate(at);
        }
        let _ = robots::parse("damaged", &bytes, &alone, None);
    }

    /// Numbers of any size stay finite all the way.
    #[test]
    fn any_numbers_are_read_or_refused(numbers in prop::collection::vec(any::<f64>(), 17), scale in -20..10i32) {
        let scale = 10f64.powi(scale);
        let mut numbers = numbers.iter().map(|x| if x.abs() > 1e3 { x.signum() * x.abs().log10() * scale } else { x * scale });
        let parts: Vec<&str> = HINGE.split('"').collect();
        let text: Vec<String> = parts.iter().enumerate().map(|(k, part)| {
            let words: Option<Vec<f64>> = part.split_whitespace().map(|w| w.parse().ok()).collect();
            match words {
                Some(words) if k % 2 == 1 => {
                    let new: Vec<String> = words.iter().map(|w| numbers.next().unwrap_or(*w).to_string()).collect();
                    new.join(" ")
                }
                _ => part.to_string(),
            }
        }).collect();
        if let Ok(found) = parsed(&text.join("\"")) {
            let link = &found.skeleton.joints()[1].link;
            prop_assert!(link.center.iter().chain(link.inertia.iter()).all(|x| x.is_finite()));
            prop_assert!(robots::parse("again", found.mjcf.unwrap().as_bytes(), &alone, None).is_ok());
        }
    }
}
