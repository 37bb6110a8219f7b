//! Known sets of markers: the conventional gait model's (Plug-in Gait, Kadaba et al. 1990; Davis et al. 1991), whose names
//! most laboratories keep, and the waist's of CMU and HDM05.

use kineme::math::rotation::Axis;
use nalgebra::Vector3;

/// Which marker, by its index, stands where. Wherever several are listed the middle of them is meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MarkerSet {
    pub left: Side,
    pub right: Side,
    pub head: Vec<usize>,
    /// Seventh vertebra of the neck and the notch between the clavicles, or one of them.
    pub neck: Vec<usize>,
    /// Tenth vertebra of the chest and the tip of the breastbone; empty unless both are there.
    pub chest: Vec<usize>,
}

/// The markers of one side of the body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Side {
    /// Front and back of the pelvis: anterior superior iliac spine; posterior one, or the sacrum.
    pub front: usize,
    pub back: usize,
    /// The acromion, on top of the shoulder.
    pub shoulder: usize,
    /// The epicondyle at the outside of the elbow.
    pub elbow: Knob,
    /// Thumb side and little finger's side of the wrist.
    pub wrist: Vec<usize>,
    /// A knuckle of the hand.
    pub fingers: Option<usize>,
    pub knee: Option<Knob>,
    pub ankle: Option<Knob>,
    pub toes: Option<usize>,
}

/// A hinge between two knobs: the marker on the outer one, and on the inner one where it was put.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Knob {
    pub outer: usize,
    pub inner: Option<usize>,
}

impl Knob {
    /// The markers midway between which the hinge is, if there are two.
    pub fn marked(&self) -> Vec<usize> {
        std::iter::once(self.outer).chain(self.inner).collect()
    }
}

impl MarkerSet {
    /// The set that these markers are of; `None` where pelvis, neck, shoulders or elbows are not all marked.
    pub fn of<S: AsRef<str>>(names: &[S]) -> Option<Self> {
        let plain: Vec<String> = names.iter().map(|n| self::plain(n.as_ref())).collect();
        let find = |name: &str| plain.iter().position(|p| p == name);
        let any = |of: &[&str]| of.iter().find_map(|n| find(n));
        let all = |of: &[&str]| -> Vec<usize> { of.iter().filter_map(|n| find(n)).collect() };
        let side = |s: &str| -> Option<Side> {
            let any = |of: &[&str]| of.iter().find_map(|n| find(&format!("{s}{n}")));
            let knob = |outer: &[&str], inner: &[&str]| {
                let inner = any(inner);
                any(outer).map(|outer| Knob { outer, inner })
            };
            let bar = [any(&["WRA"]), any(&["WRB"])];
            let wrist = match bar {
                [Some(a), Some(b)] => vec![a, b],
                [a, b] => any(&["WRI"]).or(a).or(b).into_iter().collect(),
            };
            Some(Side {
                front: any(&["ASI", "ASIS", "FWT"])?,
                back: any(&["PSI", "PSIS", "BWT"]).or_else(|| find("SACR"))?,
                shoulder: any(&["SHO"])?,
                elbow: knob(&["ELB"], &["ELM", "ELBM", "MEP"])?,
                wrist,
                fingers: any(&["FIN"]),
                knee: knob(&["KNE"], &["KNM", "KNEM", "MKNE"]),
                ankle: knob(&["ANK"], &["MED", "ANKM", "MANK"]),
                toes: any(&["TOE", "MT5"]),
            })
        };
        let chest = all(&["T10", "STRN"]);
        let neck = all(&["C7", "CLAV"]);
        any(&["C7", "CLAV"])?;
        Some(Self {
            left: side("L")?,
            right: side("R")?,
            head: all(&["LFHD", "RFHD", "LBHD", "RBHD"]),
            neck,
            chest: if chest.len() == 2 { chest } else { Vec::new() },
        })
    }
}

/// A marker's name without the subject before it (`Subject01:LFHD`), case and marks.
pub fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    let letters = name.chars().filter(|c| c.is_ascii_alphanumeric());
    letters.map(|c| c.to_ascii_uppercase()).collect()
}

/// The axis, y or z, along which shoulders are above hips; `None` for markers of no known set, or never seen together.
pub fn up<S: AsRef<str>>(names: &[S], seen: &[Option<Vector3<f64>>]) -> Option<Axis> {
    let set = MarkerSet::of(names)?;
    let mut trunk = Vector3::zeros();
    for frame in seen.chunks_exact(names.len()) {
        for side in [&set.left, &set.right] {
            if let (Some(high), Some(low)) = (frame[side.shoulder], frame[side.front]) {
                trunk += high - low;
            }
        }
    }
    (trunk.norm() > 0.0).then(|| match trunk.y.abs() > trunk.z.abs() {
        true => Axis::Y,
        false => Axis::Z,
    })
}
