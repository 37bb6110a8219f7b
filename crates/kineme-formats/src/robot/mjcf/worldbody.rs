//! The bodies and hinges of a model, as the file has them: `compiler`, classes of `default`, and the `worldbody`.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};
use roxmltree::Node;

use kineme::skeleton::Range;

use super::source::Compiler;
use crate::error::Result;
use crate::robot::source::Sources;
use crate::robot::tree::{Body, Hinge, MOST, TURN, Tree};
use crate::sheet::quoted;

/// Attributes of `joint` by class; a class has those of the classes around it.
type Classes<'a> = BTreeMap<String, BTreeMap<&'a str, &'a str>>;

/// The class that stands around all others.
const MAIN: &str = "main";

/// Reads the model.
pub fn tree(sources: &Sources<'_>) -> Result<Tree> {
    let root = sources.files[0].1.root_element();
    let sections = sources.children(root)?;
    let mut compiler = Compiler::default();
    let mut classes = Classes::from([(MAIN.to_string(), BTreeMap::new())]);
    for &section in &sections {
        match section.tag_name().name() {
            "compiler" => read_compiler(sources, section, &mut compiler)?,
            "default" => read_classes(sources, section, &mut classes)?,
            _ => {}
        }
    }
    let mut reader = Reader {
        sources,
        compiler,
        classes,
        tree: Tree {
            title: root.attribute("model").map(str::to_string),
            ..Tree::default()
        },
        hinges: 0,
    };
    for section in sections {
        if section.has_tag_name("worldbody") {
            reader.world(section)?;
        }
    }
    Ok(reader.tree)
}

fn read_compiler(sources: &Sources<'_>, node: Node<'_, '_>, compiler: &mut Compiler) -> Result<()> {
    let wrong = |key: &str, text: &str, expected: &str| {
        sources.error(node, format!("{key} = {}", quoted(text)), expected)
    };
    match node.attribute("angle") {
        None => {}
        Some("radian") => compiler.unit = 1.0,
        Some("degree") => compiler.unit = 1f64.to_radians(),
        Some(other) => return Err(wrong("angle", other, "radian or degree")),
    }
    if let Some(text) = node.attribute("eulerseq") {
        let letters: Vec<char> = text.chars().collect();
        let axes = letters.iter().all(|c| "xyzXYZ".contains(*c));
        compiler.sequence = <[char; 3]>::try_from(letters)
            .ok()
            .filter(|_| axes)
            .ok_or_else(|| wrong("eulerseq", text, "three of x y z X Y Z"))?;
    }
    match node.attribute("autolimits") {
        None => {}
        Some("true") => compiler.autolimits = true,
        Some("false") => compiler.autolimits = false,
        Some(other) => return Err(wrong("autolimits", other, "true or false")),
    }
    match node.attribute("coordinate") {
        None | Some("local") => Ok(()),
        Some(other) => Err(wrong("coordinate", other, "local")),
    }
}

fn read_classes<'a>(
    sources: &'a Sources<'_>,
    top: Node<'a, '_>,
    classes: &mut Classes<'a>,
) -> Result<()> {
    let mut open = vec![(top, None::<String>)];
    while let Some((node, around)) = open.pop() {
        let class = match (node.attribute("class"), &around) {
            (Some(name), _) => name.to_string(),
            (None, None) => MAIN.to_string(),
            (None, Some(_)) => {
                return Err(sources.error(
                    node,
                    "a <default> in another without `class`",
                    "a name",
                ));
            }
        };
        // The outermost class is the main one, whatever it is called.
        let inherited = classes
            .get(around.as_deref().unwrap_or(MAIN))
            .cloned()
            .unwrap_or_default();
        let own = classes.entry(class.clone()).or_insert(inherited);
        let children = sources.children(node)?;
        for joint in children.iter().filter(|c| c.has_tag_name("joint")) {
            for attribute in joint.attributes() {
                own.insert(attribute.name(), attribute.value());
            }
        }
        if around.is_none() {
            let main = own.clone();
            classes.insert(MAIN.to_string(), main);
        }
        // Last in, first out: in the order of the file.
        let nested = children.into_iter().filter(|c| c.has_tag_name("default"));
        let mut nested: Vec<_> = nested.map(|c| (c, Some(class.clone()))).collect();
        nested.reverse();
        open.extend(nested);
    }
    Ok(())
}

struct Reader<'a, 't> {
    sources: &'a Sources<'t>,
    compiler: Compiler,
    classes: Classes<'a>,
    tree: Tree,
    hinges: usize,
}

/// Elements that are still to be read, and where they stand.
#[derive(Clone)]
struct Open<'a, 't> {
    node: Node<'a, 't>,
    /// The body that they are of, or for a body that it stands in; `None` in the world.
    body: Option<usize>,
    /// The frame in which they are written, in the world.
    position: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    class: String,
}

impl<'a, 't> Reader<'a, 't> {
    fn world(&mut self, node: Node<'a, 't>) -> Result<()> {
        let mut open = vec![Open {
            node,
            body: None,
            position: Vector3::zeros(),
            rotation: UnitQuaternion::identity(),
            class: node.attribute("childclass").unwrap_or(MAIN).to_string(),
        }];
        while let Some(mut around) = open.pop() {
            if around.node.has_tag_name("body") {
                if self.tree.bodies.len() >= MOST {
                    let found = format!("more than {MOST} bodies");
                    return Err(self.sources.error(around.node, found, "a robot"));
                }
                around.body = Some(self.body(&around));
            }
            let mut inside = Vec::new();
            for child in self.sources.children(around.node)? {
                match child.tag_name().name() {
                    "body" | "frame" => inside.push(self.within(&around, child)?),
                    "joint" => self.joint(&around, child)?,
                    "freejoint" => self.free(&around, child)?,
                    "inertial" => self.inertial(&around, child)?,
                    "attach" | "replicate" | "flexcomp" | "composite" => {
                        let found = format!("<{}>", child.tag_name().name());
                        let expected =
                            "bodies written out (the engine can save the compiled model)";
                        return Err(self.sources.error(child, found, expected));
                    }
                    _ => {}
                }
            }
            inside.reverse();
            open.extend(inside);
        }
        Ok(())
    }

    /// What stands in a body or frame that stands in `around`.
    fn within(&self, around: &Open<'a, 't>, node: Node<'a, 't>) -> Result<Open<'a, 't>> {
        let turn = self.sources.orientation(node, &self.compiler)?;
        let class = node.attribute("childclass").unwrap_or(&around.class);
        Ok(Open {
            node,
            body: around.body,
            position: around.position + around.rotation * self.sources.position(node)?,
            rotation: around.rotation * turn,
            class: class.to_string(),
        })
    }

    /// Adds the body; its parent is the body that it stands in.
    fn body(&mut self, at: &Open<'a, 't>) -> usize {
        let index = self.tree.bodies.len();
        let name = at.node.attribute("name");
        self.tree.bodies.push(Body {
            name: name.map_or_else(|| format!("body_{index}"), str::to_string),
            parent: at.body,
            position: at.position,
            hinges: Vec::new(),
            inertial: None,
        });
        index
    }

    fn owner(&self, at: &Open<'_, '_>, node: Node<'_, '_>) -> Result<usize> {
        at.body.ok_or_else(|| {
            let found = format!("<{}> in the world", node.tag_name().name());
            self.sources.error(node, found, "it in a body")
        })
    }

    fn joint(&mut self, at: &Open<'a, 't>, node: Node<'a, 't>) -> Result<()> {
        let body = self.owner(at, node)?;
        let sources = self.sources;
        let class = node.attribute("class").unwrap_or(&at.class);
        let usual = self.classes.get(class).ok_or_else(|| {
            let known: Vec<&str> = self.classes.keys().map(String::as_str).collect();
            let found = format!("class {}", quoted(class));
            sources.error(node, found, known.join(", "))
        })?;
        let value = |key: &str| node.attribute(key).or_else(|| usual.get(key).copied());
        match value("type") {
            None | Some("hinge") => {}
            Some("free") => return self.free(at, node),
            Some("slide") => {
                let name = node.attribute("name").unwrap_or("without a name");
                let told = format!("joint {} slides; it is left where it is", quoted(name));
                self.tree.warnings.push(told);
                return Ok(());
            }
            Some(other) => {
                let found = format!("a joint of type {}", quoted(other));
                return Err(sources.error(node, found, "hinges (a ball can be three of them)"));
            }
        }
        let name = sources.text(node, "name")?;
        let axis = match value("axis") {
            None => Vector3::z(),
            Some(text) => Vector3::from(sources.numbers::<3>(node, "axis", text)?),
        };
        let axis = Unit::try_new(axis, 1e-9)
            .ok_or_else(|| sources.error(node, "an axis of no length", "a direction"))?;
        let anchor = match value("pos") {
            None => Vector3::zeros(),
            Some(text) => Vector3::from(sources.numbers::<3>(node, "pos", text)?),
        };
        let number = |key: &str| match value(key) {
            None => Ok(0.0),
            Some(text) => sources.numbers::<1>(node, key, text).map(|[x]| x),
        };
        let reference = number("ref")? * self.compiler.unit;
        let range = value("range")
            .map(|text| sources.numbers::<2>(node, "range", text))
            .transpose()?;
        let limited = match value("limited") {
            Some("true") => true,
            Some("false") => false,
            None | Some("auto") => self.compiler.autolimits && range.is_some(),
            Some(other) => {
                let found = format!("limited = {}", quoted(other));
                return Err(sources.error(node, found, "true, false or auto"));
            }
        };
        let range = match range {
            Some([low, high]) if limited && low < high => Range {
                low: low * self.compiler.unit - reference,
                high: high * self.compiler.unit - reference,
            },
            _ if limited => {
                let found = format!("range = {}", quoted(value("range").unwrap_or_default()));
                return Err(sources.error(node, found, "a lower and a greater angle"));
            }
            _ => Range {
                low: -TURN,
                high: TURN,
            },
        };
        self.hinges += 1;
        if self.hinges > MOST {
            let found = format!("more than {MOST} hinges");
            return Err(sources.error(node, found, "a robot"));
        }
        self.tree.bodies[body].hinges.push(Hinge {
            name: name.to_string(),
            anchor: at.position + at.rotation * anchor,
            axis: at.rotation * axis,
            range,
            reference,
        });
        Ok(())
    }

    /// A free joint: the base's own, which is held; MuJoCo has none elsewhere.
    fn free(&mut self, at: &Open<'_, '_>, node: Node<'_, '_>) -> Result<()> {
        let body = self.owner(at, node)?;
        if self.tree.bodies[body].parent.is_some() {
            return Err(self.sources.error(
                node,
                "a free joint in a body in a body",
                "it in a base",
            ));
        }
        Ok(())
    }

    fn inertial(&mut self, at: &Open<'a, 't>, node: Node<'a, 't>) -> Result<()> {
        let body = self.owner(at, node)?;
        let sources = self.sources;
        let [mass] = sources.numbers::<1>(node, "mass", sources.text(node, "mass")?)?;
        if mass < 0.0 {
            return Err(sources.error(node, format!("mass = {mass}"), "no less than zero"));
        }
        let inertia = if let Some(diagonal) = sources.optional::<3>(node, "diaginertia")? {
            Matrix3::from_diagonal(&Vector3::from(diagonal))
        } else if let Some([xx, yy, zz, xy, xz, yz]) = sources.optional::<6>(node, "fullinertia")? {
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
        } else {
            return Err(sources.error(node, "no inertia", "diaginertia or fullinertia"));
        };
        let turn = at.rotation * sources.orientation(node, &self.compiler)?;
        let turn = turn.to_rotation_matrix().into_inner();
        let center = at.position + at.rotation * sources.position(node)?;
        self.tree.bodies[body].inertial = Some((mass, center, turn * inertia * turn.transpose()));
        Ok(())
    }
}
