//! Figure 3: how movement is synthesised, by the modules that do it.

use kineme_report::paper::{Edge, Flowchart, Kind, Node};

/// The chart: the paper's arbitrator, flowfield primitives, initial pose and incremental update, each under the name of
/// the module that is it.
pub fn chart() -> Flowchart {
    let text = |lines: &[&str]| lines.iter().map(|l| l.to_string()).collect::<Vec<String>>();
    let node = |name: &str, module: &str, lines: &[&str], kind, place, copies| Node {
        name: name.into(),
        module: module.into(),
        lines: text(lines),
        kind,
        place,
        copies,
    };
    let edge = |label: &str, label_at, optional, corners: &[[f64; 2]]| Edge {
        corners: corners.to_vec(),
        label: label.into(),
        label_at,
        optional,
    };
    Flowchart {
        title: "Figure 3. Motion synthesis with flowfield primitives and an arbitrator".into(),
        subtitle: "It wants an initial pose; from then on each tick updates the desired configuration by what the \
                   arbitrator selects. The module of each box stands under its name."
            .into(),
        size: [960.0, 560.0],
        nodes: vec![
            node(
                "Vocabulary",
                "primitive::Vocabulary",
                &["primitives f(p, \u{3c4})"],
                Kind::Data,
                [24.0, 96.0, 190.0, 78.0],
                1,
            ),
            node(
                "Plan",
                "control::Plan",
                &["when, which, at what p;", "rules"],
                Kind::Data,
                [24.0, 226.0, 190.0, 84.0],
                1,
            ),
            node(
                "Percept",
                "control::Percept",
                &["what was recognised"],
                Kind::Data,
                [24.0, 362.0, 190.0, 72.0],
                1,
            ),
            node(
                "Behaviours",
                "control::behavior",
                &["one a primitive, each with", "its flow: phase, parameters"],
                Kind::Module,
                [316.0, 150.0, 216.0, 96.0],
                3,
            ),
            node(
                "Ancillary connections",
                "control::connection",
                &["inhibit, suppress, select, aim"],
                Kind::Module,
                [316.0, 330.0, 216.0, 78.0],
                1,
            ),
            node(
                "Arbitrator",
                "control::arbiter",
                &["who moves which joint:", "priority, winner, superposition"],
                Kind::Module,
                [672.0, 142.0, 250.0, 96.0],
                1,
            ),
            node(
                "Incremental update",
                "control::synthesizer",
                &["join without a jump, step,", "joint limits"],
                Kind::Module,
                [672.0, 302.0, 250.0, 92.0],
                1,
            ),
            node(
                "Initial pose",
                "control::State",
                &[],
                Kind::Data,
                [420.0, 470.0, 150.0, 58.0],
                1,
            ),
            node(
                "Robot",
                "control::Robot",
                &["Adonis, Ares, any body"],
                Kind::World,
                [672.0, 462.0, 250.0, 74.0],
                1,
            ),
        ],
        edges: vec![
            edge("flowfields", [254.0, 129.0], false, &[
                [214.0, 135.0],
                [265.0, 135.0],
                [265.0, 182.0],
                [316.0, 182.0],
            ]),
            edge("start, stop", [252.0, 262.0], false, &[
                [214.0, 268.0],
                [290.0, 268.0],
                [290.0, 224.0],
                [316.0, 224.0],
            ]),
            edge("what is seen", [262.0, 391.0], true, &[[214.0, 398.0], [316.0, 398.0]]),
            edge("rules", [262.0, 342.0], false, &[
                [119.0, 310.0],
                [119.0, 348.0],
                [316.0, 348.0],
            ]),
            edge("act on one another", [340.0, 292.0], false, &[[400.0, 330.0], [400.0, 246.0]]),
            edge("begin, end", [486.0, 292.0], false, &[[448.0, 246.0], [448.0, 330.0]]),
            edge("desired joint\ntrajectories", [607.0, 172.0], false, &[
                [544.0, 190.0],
                [672.0, 190.0],
            ]),
            edge("shares of each joint", [797.0, 274.0], false, &[[797.0, 238.0], [797.0, 302.0]]),
            edge("command: pose, velocity,\nacceleration", [874.0, 424.0], false, &[
                [797.0, 394.0],
                [797.0, 462.0],
            ]),
            edge("at the start", [628.0, 428.0], false, &[
                [570.0, 490.0],
                [628.0, 490.0],
                [628.0, 366.0],
                [672.0, 366.0],
            ]),
            edge("next tick", [632.0, 318.0], false, &[
                [672.0, 326.0],
                [590.0, 326.0],
                [590.0, 226.0],
                [546.0, 226.0],
            ]),
            edge("sensed posture (closes the loop where a body is pushed)", [300.0, 546.0], true, &[
                [672.0, 524.0],
                [640.0, 524.0],
                [640.0, 550.0],
                [14.0, 550.0],
                [14.0, 62.0],
                [424.0, 62.0],
                [424.0, 138.0],
            ]),
        ],
    }
}
