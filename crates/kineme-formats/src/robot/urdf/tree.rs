//! From links and joints to bodies in the world.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use roxmltree::{Document, Node};

use super::elements::{self, Joint, Kind, Link};
use super::mjcf::{self, Drive};
use super::still;
use crate::error::{FormatError, Result};
use crate::robot::source::{Sources, Text, XACRO};
use crate::robot::tree::{Body, Hinge, MOST, Tree};
use crate::sheet::quoted;

/// The link that stands for what does not move.
const WORLD: &str = "world";

/// The bodies and hinges of a URDF, and the same as MJCF.
///
/// # Errors
/// As [`crate::robot::read`].
pub fn tree(main: &Text, document: Document<'_>) -> Result<Tree> {
    let sources = Sources {
        files: vec![(main, document)],
    };
    let root = sources.files[0].1.root_element();
    no_macros(&sources, root)?;
    let file = Links::read(&sources, root)?;
    let held = still::held(&sources, &file.joints)?;
    let (mut tree, drives) = file.bodies(&held)?;
    tree.title = root.attribute("name").map(str::to_string);
    tree.warnings = still::told(&file.joints, &held);
    let (text, doubts) = mjcf::write(&tree, &drives);
    tree.mjcf = Some(text);
    tree.warnings.extend(doubts);
    Ok(tree)
}

/// Refuses what xacro has not been over yet.
fn no_macros(sources: &Sources<'_>, root: Node<'_, '_>) -> Result<()> {
    let of_xacro = |node: &Node<'_, '_>| {
        let space = node.tag_name().namespace();
        space.is_some_and(|uri| uri.contains("xacro"))
    };
    match root.descendants().find(of_xacro) {
        None => Ok(()),
        Some(node) => {
            let found = format!("<xacro:{}>", node.tag_name().name());
            Err(sources.error(node, found, XACRO))
        }
    }
}

/// The links of a file, and the joints that make a tree of them.
struct Links<'a, 't> {
    sources: &'a Sources<'t>,
    links: Vec<Link<'a, 't>>,
    joints: Vec<Joint<'a, 't>>,
    /// For each joint, the link that hangs on it.
    child: Vec<usize>,
    /// For each link, the joints that hang on it, in the order of the file.
    below: Vec<Vec<usize>>,
    root: usize,
}

impl<'a, 't> Links<'a, 't> {
    fn read(sources: &'a Sources<'t>, robot: Node<'a, 't>) -> Result<Self> {
        let mut links: Vec<Link<'a, 't>> = Vec::new();
        let mut joints: Vec<Joint<'a, 't>> = Vec::new();
        let (mut at, mut seen) = (BTreeMap::new(), BTreeMap::new());
        for node in robot.children() {
            let (name, before) = match node.tag_name().name() {
                "link" => {
                    links.push(elements::link(sources, node)?);
                    let name = links[links.len() - 1].name;
                    (name, at.insert(name, links.len() - 1))
                }
                "joint" => {
                    joints.push(elements::joint(sources, node)?);
                    let name = joints[joints.len() - 1].name;
                    (name, seen.insert(name, joints.len() - 1))
                }
                _ => continue,
            };
            if before.is_some() {
                let found = format!("a second {} {}", node.tag_name().name(), quoted(name));
                return Err(sources.error(node, found, "each name once"));
            }
            if links.len() > MOST {
                return Err(sources.error(node, format!("more than {MOST} links"), "a robot"));
            }
        }
        if links.is_empty() {
            return Err(sources.error(robot, "no <link>", "a robot of links and joints"));
        }
        let mut child = Vec::with_capacity(joints.len());
        let mut below = vec![Vec::new(); links.len()];
        let mut above: Vec<Option<usize>> = vec![None; links.len()];
        for (j, joint) in joints.iter().enumerate() {
            let link = |name: &str| {
                at.get(name).copied().ok_or_else(|| {
                    let found = format!(
                        "joint {} of link {}, which is not there",
                        quoted(joint.name),
                        quoted(name)
                    );
                    sources.error(joint.node, found, "a link of the file")
                })
            };
            let (parent, own) = (link(joint.parent)?, link(joint.child)?);
            if let Some(other) = above[own].replace(j) {
                let [one, other, link] = [joint.name, joints[other].name, joint.child].map(quoted);
                let found = format!("link {link} on joint {other} and on joint {one}");
                let expected = "links that make a tree: each hangs on one joint";
                return Err(sources.error(joint.node, found, expected));
            }
            child.push(own);
            below[parent].push(j);
        }
        let root = root(sources, &links, &above)?;
        Ok(Self {
            sources,
            links,
            joints,
            child,
            below,
            root,
        })
    }

    /// The bodies, with the joints that do not turn where they are held, and for each hinge what the file says of it
    /// besides.
    fn bodies(&self, held: &[Option<f64>]) -> Result<(Tree, Vec<Drive>)> {
        let (mut tree, mut drives) = (Tree::default(), Vec::new());
        // Links that are still to be placed, each with the body and the joint that it hangs on.
        let mut open = vec![(self.root, Isometry3::identity(), None, None::<usize>)];
        let mut placed = vec![false; self.links.len()];
        while let Some((k, frame, parent, joint)) = open.pop() {
            placed[k] = true;
            let mut body = None;
            if k != self.root || !self.root_is_the_world() {
                body = Some(tree.bodies.len());
                let hinge = joint.filter(|&j| held[j].is_none());
                let hinge = hinge.map(|j| &self.joints[j]);
                drives.extend(hinge.map(Drive::of));
                tree.bodies.push(self.body(k, parent, &frame, hinge));
            }
            // Last in, first out: in the order of the file.
            for &j in self.below[k].iter().rev() {
                let joint = &self.joints[j];
                let floats = floats(joint);
                if floats && k != self.root {
                    let found = format!(
                        "joint {} that floats below link {}",
                        quoted(joint.name),
                        quoted(joint.parent)
                    );
                    let expected = "floating and planar joints of the root link alone";
                    return Err(self.sources.error(joint.node, found, expected));
                }
                let frame = frame * joint.origin * moved(joint, held[j].unwrap_or(0.0));
                let parent = body.filter(|_| !floats);
                open.push((self.child[j], frame, parent, Some(j)));
            }
        }
        match placed.iter().position(|there| !there) {
            None => Ok((tree, drives)),
            Some(k) => Err(in_a_circle(self.sources, &self.links[k])),
        }
    }

    fn body(
        &self,
        k: usize,
        parent: Option<usize>,
        frame: &Isometry3<f64>,
        hinge: Option<&Joint<'_, '_>>,
    ) -> Body {
        let link = &self.links[k];
        let position = frame.translation.vector;
        let hinge = hinge.map(|joint| Hinge {
            name: joint.name.to_string(),
            anchor: position,
            axis: frame.rotation * joint.axis,
            range: joint.range,
            reference: 0.0,
        });
        let inertial = link.inertial.as_ref().map(|inertial| {
            let frame = frame * inertial.frame;
            let turn = frame.rotation.to_rotation_matrix().into_inner();
            let inertia = turn * inertial.inertia * turn.transpose();
            (inertial.mass_kg, frame.translation.vector, inertia)
        });
        Body {
            name: self.body_name(link.name),
            parent,
            position,
            hinges: hinge.into_iter().collect(),
            inertial,
        }
    }

    /// Whether the root link is but the place where the robot stands.
    fn root_is_the_world(&self) -> bool {
        let root = &self.links[self.root];
        let weighs = root.inertial.as_ref().is_some_and(|i| i.mass_kg > 0.0);
        let below = &self.below[self.root];
        let carries = !below.is_empty() && below.iter().all(|&j| floats(&self.joints[j]));
        let named =
            root.name == WORLD && matches!(below[..], [j] if self.joints[j].kind == Kind::Fixed);
        !weighs && (carries || named)
    }

    /// The name of a link's body: its own, but for the one that engines call the world.
    fn body_name(&self, link: &str) -> String {
        let mut name = link.to_string();
        while name == WORLD || (name != link && self.links.iter().any(|l| l.name == name)) {
            name.push_str("_body");
        }
        name
    }
}

/// The one link that hangs on no joint.
fn root(sources: &Sources<'_>, links: &[Link<'_, '_>], above: &[Option<usize>]) -> Result<usize> {
    let mut roots = (0..links.len()).filter(|&k| above[k].is_none());
    match (roots.next(), roots.next()) {
        (Some(root), None) => Ok(root),
        (Some(one), Some(other)) => {
            let [one, name] = [links[one].name, links[other].name].map(quoted);
            let found = format!("links {one} and {name}, both on no joint");
            Err(sources.error(links[other].node, found, "one root link"))
        }
        (None, _) => Err(in_a_circle(sources, &links[0])),
    }
}

fn in_a_circle(sources: &Sources<'_>, link: &Link<'_, '_>) -> FormatError {
    let found = format!("link {} on joints that go in a circle", quoted(link.name));
    let expected = "links that make a tree: from one root link outward";
    sources.error(link.node, found, expected)
}

fn floats(joint: &Joint<'_, '_>) -> bool {
    matches!(joint.kind, Kind::Floating | Kind::Planar)
}

/// By how much a joint at this angle (radians) or place (metres) moves its child.
fn moved(joint: &Joint<'_, '_>, by: f64) -> Isometry3<f64> {
    match joint.kind {
        Kind::Prismatic => {
            let along = Translation3::from(joint.axis.into_inner() * by);
            Isometry3::from_parts(along, UnitQuaternion::identity())
        }
        Kind::Revolute | Kind::Continuous => {
            let turn = UnitQuaternion::from_axis_angle(&joint.axis, by);
            Isometry3::from_parts(Translation3::identity(), turn)
        }
        Kind::Fixed | Kind::Floating | Kind::Planar => Isometry3::identity(),
    }
}
