//! ASF, the Acclaim skeleton: bones with directions, lengths and axes, and how they hang together.
//!
//! After "Acclaim ASF/AMC file formats" (Acclaim Entertainment; Lander, "Working with Motion Capture File Formats",
//! Game Developer, January 1998). A bone turns by `C M C^-1`, where C is the rotation of its `axis` line and M that of
//! its motion values; `axis XYZ` means that x comes first about fixed axes, so the product is Rz Ry Rx. A
//! bone starts at its parent's tip. Lengths are in units of `0.0254 / length` metres, y is up.

use std::collections::HashMap;

use kineme::math::rotation::{Axis, EulerOrder};
use kineme::{Format, RecordedJoint, Source};
use nalgebra::{UnitQuaternion, Vector3};

use crate::error::{FormatError, Result};
use crate::text::{Blame, Lines, decoded, number, quoted, words};

/// One value of a bone in the motion file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dof {
    /// A translation along an axis; of the root alone.
    Move(Axis),
    /// A turn about an axis.
    Turn(Axis),
}

/// What the motion of a bone needs to know of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bone {
    /// C: the rotation of the bone's own axes, in the file's axes.
    pub(crate) axes: UnitQuaternion<f64>,
    /// Intrinsic order of M, the file's order reversed.
    pub(crate) order: EulerOrder,
    /// The values that the motion file gives it, in their order.
    pub(crate) dof: Vec<Dof>,
}

/// An Acclaim skeleton; its motions are read by [`crate::amc::parse`].
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    pub(crate) joints: Vec<RecordedJoint>,
    pub(crate) bones: Vec<Bone>,
    /// Bone indices by name in lower case.
    pub(crate) by_name: HashMap<Vec<u8>, usize>,
    pub(crate) degrees: bool,
    pub(crate) source: Source,
}

impl Skeleton {
    /// Its joints, the root first, depth first: a bone's frame sits at the bone's start, its tip is the bone's end.
    pub fn joints(&self) -> &[RecordedJoint] {
        &self.joints
    }

    /// Unit and axes of the file.
    pub fn source(&self) -> &Source {
        &self.source
    }
}

/// A bone as written.
#[derive(Debug, Clone)]
struct Written {
    name: String,
    line: usize,
    direction: Vector3<f64>,
    length: f64,
    axis: ([f64; 3], EulerOrder),
    dof: Vec<Dof>,
}

/// The order of three letters as Acclaim means it: the first is turned first, about fixed axes.
const XYZ: EulerOrder = EulerOrder([Axis::Z, Axis::Y, Axis::X]);

/// What the sections of a file say.
struct Reader<'a> {
    blame: Blame<'a>,
    length_unit: f64,
    degrees: bool,
    root: Written,
    bones: Vec<Written>,
    open: Option<Written>,
    children: HashMap<Vec<u8>, Vec<(usize, Vec<u8>)>>,
    warnings: Vec<String>,
}

/// Reads an ASF file; `name` is what errors call it.
///
/// # Errors
/// [`crate::FormatError`] with the line where the text is no ASF file or is cut.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Skeleton> {
    let blame = Blame(name);
    let mut lines = Lines::new(bytes);
    let mut reader = Reader::new(blame);
    let mut section = Vec::new();
    let mut sections = 0;
    while let Some((at, line)) = lines.next_full() {
        if line.starts_with(b"#") {
            continue;
        }
        let mut parts = words(line);
        let key = parts.next().unwrap_or_default().to_ascii_lowercase();
        if key.starts_with(b":") {
            reader.close(at)?;
            section = key;
            sections += 1;
            continue;
        }
        let values: Vec<&[u8]> = parts.collect();
        match section.as_slice() {
            b":units" => reader.units(at, &key, &values)?,
            b":root" => reader.root(at, &key, &values)?,
            b":bonedata" => reader.bone(at, &key, &values)?,
            b":hierarchy" => reader.hang(at, &key, &values)?,
            b"" => return Err(blame.line(at, quoted(line), "a section such as `:units`")),
            // :version, :name, :documentation, :skin say nothing that a motion needs.
            _ => {}
        }
    }
    if sections == 0 {
        return Err(blame.file("no section", "an ASF skeleton with `:bonedata`"));
    }
    reader.close(lines.number())?;
    reader.skeleton(lines.number())
}

impl<'a> Reader<'a> {
    fn new(blame: Blame<'a>) -> Self {
        Self {
            blame,
            length_unit: 1.0,
            degrees: true,
            root: Written {
                dof: ["tx", "ty", "tz", "rx", "ry", "rz"]
                    .iter()
                    .filter_map(|t| dof(t.as_bytes()))
                    .collect(),
                ..Written::new("root".into(), 1)
            },
            bones: Vec::new(),
            open: None,
            children: HashMap::new(),
            warnings: Vec::new(),
        }
    }

    fn wrong(&self, at: usize, found: &[u8], expected: &str) -> FormatError {
        self.blame.line(at, quoted(found), expected)
    }

    fn numbers<const N: usize>(&self, at: usize, values: &[&[u8]]) -> Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for (i, slot) in numbers.iter_mut().enumerate() {
            *slot = values.get(i).and_then(|w| number(w)).ok_or_else(|| {
                let found = values.get(i).copied().unwrap_or_default();
                self.wrong(at, found, &format!("{N} numbers"))
            })?;
        }
        Ok(numbers)
    }

    fn order(&self, at: usize, word: Option<&&[u8]>) -> Result<EulerOrder> {
        let Some(word) = word else { return Ok(XYZ) };
        let order = EulerOrder::parse(&decoded(word))
            .filter(|o| o.0[0] != o.0[2])
            .ok_or_else(|| self.wrong(at, word, "an order such as `XYZ`"))?;
        let [a, b, c] = order.0;
        Ok(EulerOrder([c, b, a]))
    }

    fn units(&mut self, at: usize, key: &[u8], values: &[&[u8]]) -> Result<()> {
        match key {
            b"length" => {
                let [unit] = self.numbers(at, values)?;
                if unit <= 0.0 {
                    return Err(self.wrong(at, values[0], "a length unit above zero"));
                }
                self.length_unit = unit;
            }
            b"angle" => {
                let word = values.first().copied().unwrap_or_default();
                self.degrees = match word.to_ascii_lowercase().as_slice() {
                    w if w.starts_with(b"deg") => true,
                    w if w.starts_with(b"rad") => false,
                    _ => return Err(self.wrong(at, word, "`deg` or `rad`")),
                };
            }
            _ => {}
        }
        Ok(())
    }

    fn root(&mut self, at: usize, key: &[u8], values: &[&[u8]]) -> Result<()> {
        match key {
            b"order" => {
                self.root.dof = self.dofs(at, values)?;
                self.root.line = at;
            }
            b"axis" => self.root.axis.1 = self.order(at, values.first())?,
            b"position" | b"orientation" => {
                let still: [f64; 3] = self.numbers(at, values)?;
                if still != [0.0; 3] {
                    self.warnings.push(format!(
                        "the root's rest {} in the ASF is not zero and was not applied",
                        decoded(key)
                    ));
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn dofs(&self, at: usize, values: &[&[u8]]) -> Result<Vec<Dof>> {
        let mut dofs = Vec::new();
        for word in values {
            match dof(word) {
                Some(one) if !dofs.contains(&one) => dofs.push(one),
                _ => {
                    return Err(self.wrong(at, word, "each of `tx ty tz rx ry rz` at most once"));
                }
            }
        }
        Ok(dofs)
    }

    fn bone(&mut self, at: usize, key: &[u8], values: &[&[u8]]) -> Result<()> {
        if key == b"begin" {
            if self.open.is_some() {
                return Err(self.wrong(at, key, "`end` of the bone before"));
            }
            self.open = Some(Written::new(String::new(), at));
            return Ok(());
        }
        let Some(mut bone) = self.open.take() else {
            return Err(self.wrong(at, key, "`begin` of a bone"));
        };
        match key {
            b"name" => bone.name = decoded(values.first().copied().unwrap_or_default()),
            b"direction" => bone.direction = Vector3::from(self.numbers(at, values)?),
            b"length" => [bone.length] = self.numbers(at, values)?,
            b"axis" => bone.axis = (self.numbers(at, values)?, self.order(at, values.get(3))?),
            b"dof" => {
                bone.dof = self.dofs(at, values)?;
                if bone.dof.iter().any(|d| matches!(d, Dof::Move(_))) {
                    return Err(self.wrong(
                        at,
                        &values.join(&b' '),
                        "turns `rx ry rz`: only the root translates",
                    ));
                }
            }
            b"end" => {
                if bone.name.is_empty() {
                    return Err(self.blame.line(
                        at,
                        format!("a bone without `name`, begun in line {}", bone.line),
                        "`name`",
                    ));
                }
                self.bones.push(bone);
                return Ok(());
            }
            // id, limits with their continuation lines, bodymass, cofmass.
            _ => {}
        }
        self.open = Some(bone);
        Ok(())
    }

    fn hang(&mut self, at: usize, key: &[u8], values: &[&[u8]]) -> Result<()> {
        if matches!(key, b"begin" | b"end") && values.is_empty() {
            return Ok(());
        }
        let children = self.children.entry(key.to_vec()).or_default();
        children.extend(values.iter().map(|v| (at, v.to_ascii_lowercase())));
        Ok(())
    }

    /// A section ends: no bone may be open.
    fn close(&self, at: usize) -> Result<()> {
        match &self.open {
            Some(bone) => Err(self.blame.line(
                at,
                format!(
                    "the end of the bones inside the one begun in line {}",
                    bone.line
                ),
                "`end`",
            )),
            None => Ok(()),
        }
    }

    /// Hangs the bones together, depth first, and turns them into our frame.
    fn skeleton(mut self, last: usize) -> Result<Skeleton> {
        let source = Source {
            format: Format::AsfAmc,
            up: Axis::Y,
            unit_metres: 0.0254 / self.length_unit,
            warnings: std::mem::take(&mut self.warnings),
        };
        let mut written: HashMap<Vec<u8>, Written> = HashMap::new();
        for bone in std::mem::take(&mut self.bones) {
            let line = bone.line;
            let key = bone.name.to_lowercase().into_bytes();
            if key == b"root" || written.insert(key.clone(), bone).is_some() {
                return Err(self.wrong(line, &key, "a bone name that is not taken"));
            }
        }
        if written.is_empty() {
            return Err(self.blame.line(last, "no bone", "bones in `:bonedata`"));
        }
        let mut skeleton = Skeleton {
            joints: Vec::new(),
            bones: Vec::new(),
            by_name: HashMap::new(),
            degrees: self.degrees,
            source,
        };
        let root = self.root.clone();
        skeleton.push(root, None, self.degrees);
        let mut stack: Vec<(usize, Vec<u8>, usize)> = Vec::new();
        let mut parent = (b"root".to_vec(), 0);
        loop {
            let children = self.children.remove(&parent.0).unwrap_or_default();
            stack.extend(children.into_iter().rev().map(|(at, c)| (at, c, parent.1)));
            let Some((at, name, hangs_on)) = stack.pop() else {
                break;
            };
            let bone = written
                .remove(&name)
                .ok_or_else(|| self.wrong(at, &name, "a bone of `:bonedata`, hung once"))?;
            let index = skeleton.push(bone, Some(hangs_on), self.degrees);
            parent = (name, index);
        }
        // The lowest line, so that the message does not depend on the order of a hash map.
        if let Some(loose) = written.values().min_by_key(|b| b.line) {
            return Err(self.blame.line(
                loose.line,
                format!("bone `{}` outside the hierarchy", loose.name),
                "every bone below `root` in `:hierarchy`",
            ));
        }
        Ok(skeleton)
    }
}

impl Skeleton {
    fn push(&mut self, bone: Written, parent: Option<usize>, degrees: bool) -> usize {
        let index = self.joints.len();
        let tip = self.source.to_inner(bone.direction * bone.length);
        let offset = parent.and_then(|p| self.joints[p].tip).unwrap_or_default();
        let turns = bone.dof.iter().any(|d| matches!(d, Dof::Turn(_)));
        self.by_name
            .insert(bone.name.to_lowercase().into_bytes(), index);
        self.joints.push(RecordedJoint {
            name: bone.name,
            parent,
            offset,
            tip: parent.map(|_| tip),
            order: turns.then_some(bone.axis.1),
            dof: bone.dof.len(),
        });
        let [x, y, z] = bone
            .axis
            .0
            .map(|a| if degrees { a.to_radians() } else { a });
        let order = bone.axis.1;
        let angles = order.0.map(|axis| [x, y, z][axis.index()]);
        self.bones.push(Bone {
            axes: order.rotation(angles),
            order,
            dof: bone.dof,
        });
        index
    }
}

impl Written {
    fn new(name: String, line: usize) -> Self {
        Self {
            name,
            line,
            direction: Vector3::zeros(),
            length: 0.0,
            axis: ([0.0; 3], XYZ),
            dof: Vec::new(),
        }
    }
}

/// `tx` to `rz` in any case.
fn dof(word: &[u8]) -> Option<Dof> {
    let [kind, axis] = word else { return None };
    let axis = match axis.to_ascii_lowercase() {
        b'x' => Axis::X,
        b'y' => Axis::Y,
        b'z' => Axis::Z,
        _ => return None,
    };
    match kind.to_ascii_lowercase() {
        b't' => Some(Dof::Move(axis)),
        b'r' => Some(Dof::Turn(axis)),
        _ => None,
    }
}
