//! The shape of a body on a page: which points it has and what is drawn between them.

use std::collections::BTreeMap;

use kineme::motion::Placement;
use kineme::retargeting::RoleMap;
use kineme::skeleton::Frame;
use kineme::{Recording, Role, Skeleton};
use kineme_report::scene::{Body, Bone};
use nalgebra::Vector3;

/// Length of a leg that radii are given for, metres: that of Ares.
const LEG_M: f64 = 0.856;
/// From here on there is a chest between the highest joint of the trunk and the shoulders.
const CHEST_M: f64 = 0.15;
/// Points of the trunk between pelvis and neck.
const TRUNK_POINTS: usize = 6;

/// A body as it is drawn, and where its points are.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// What the page knows of it.
    pub body: Body,
    spots: Vec<Spot>,
}

/// Where a point is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spot {
    /// At a joint.
    Joint(usize),
    /// In the frame of a joint, metres.
    Fixed(usize, Vector3<f64>),
    /// Between two earlier points, at this share of the way.
    Between(usize, usize, f64),
}

/// A joint of whichever skeleton.
struct Rigged {
    parent: Option<usize>,
    tip: Option<Vector3<f64>>,
}

impl Shape {
    /// The shape of one of our bodies, or of a robot.
    pub fn of(skeleton: &Skeleton) -> Self {
        let joints: Vec<Rigged> = skeleton
            .joints()
            .iter()
            .map(|j| Rigged {
                parent: j.parent,
                tip: Some(j.tip).filter(|t| t.norm() > 1e-6),
            })
            .collect();
        let roles = Role::ALL
            .iter()
            .filter_map(|&role| Some((role, *skeleton.joints_of(role).first()?)))
            .collect();
        let placed = of_frames(&skeleton.frames(&skeleton.neutral(), &kineme::Root::ORIGIN));
        let mut built = Builder::new(&joints, roles, &placed);
        let head = built.roles.get(&Role::Head).copied();
        built.draw();
        // Where the face is: only of our own bodies is the head's forward direction known.
        if let Some(head) = head.filter(|_| built.human) {
            let nose = [(0.075, 0.078), (0.096, 0.066)]
                .map(|(x, z)| built.spot(Spot::Fixed(head, built.scale * Vector3::new(x, 0.0, z))));
            built.bone(nose, [0.019, 0.013]);
        }
        built.finish(skeleton.name())
    }

    /// The shape of a recording's own skeleton; `roles` says which joint is which, as far as that is known.
    pub fn of_recording(recording: &Recording, roles: Option<&RoleMap>) -> Self {
        let joints: Vec<Rigged> = recording
            .joints()
            .iter()
            .map(|j| Rigged {
                parent: j.parent,
                tip: j.tip,
            })
            .collect();
        let roles = roles.map_or_else(BTreeMap::new, |map| map.joints.clone());
        let placed = recording.placements(0);
        let mut built = Builder::new(&joints, roles, &placed);
        built.draw();
        built.finish(recording.name())
    }

    /// Where the points are when the joints are so placed, metres; NaN where that is not known.
    pub fn places(&self, placed: &[Placement]) -> Vec<[f64; 3]> {
        let mut points: Vec<[f64; 3]> = Vec::with_capacity(self.spots.len());
        for spot in &self.spots {
            points.push(place(spot, placed, &points));
        }
        points
    }

    /// As [`Self::places`], of a body whose frames are all known.
    pub fn of_frames(&self, frames: &[Frame]) -> Vec<[f64; 3]> {
        self.places(&of_frames(frames))
    }
}

fn of_frames(frames: &[Frame]) -> Vec<Placement> {
    let placed = frames.iter().map(|f| Placement {
        position: Some(f.position),
        rotation: Some(f.rotation),
    });
    placed.collect()
}

fn place(spot: &Spot, placed: &[Placement], points: &[[f64; 3]]) -> [f64; 3] {
    let found = match *spot {
        Spot::Joint(j) => placed[j].position,
        Spot::Fixed(j, at) => placed[j]
            .position
            .zip(placed[j].rotation)
            .map(|(p, q)| p + q * at),
        Spot::Between(a, b, share) => {
            let [a, b] = [a, b].map(|i| Vector3::from(points[i]));
            Some(a + (b - a) * share)
        }
    };
    found.map_or([f64::NAN; 3], Into::into)
}

/// A shape in the making.
struct Builder<'a> {
    joints: &'a [Rigged],
    roles: BTreeMap<Role, usize>,
    placed: &'a [Placement],
    human: bool,
    scale: f64,
    spots: Vec<Spot>,
    points: Vec<[f64; 3]>,
    at_joint: BTreeMap<usize, usize>,
    bones: Vec<Bone>,
    tips: Vec<usize>,
}

impl<'a> Builder<'a> {
    fn new(joints: &'a [Rigged], roles: BTreeMap<Role, usize>, placed: &'a [Placement]) -> Self {
        use Role::*;
        let needed = [
            Hips,
            Head,
            LeftUpperArm,
            LeftLowerArm,
            LeftHand,
            RightUpperArm,
            RightLowerArm,
            RightHand,
            LeftUpperLeg,
            LeftLowerLeg,
            LeftFoot,
            RightUpperLeg,
            RightLowerLeg,
            RightFoot,
        ];
        let mut built = Self {
            joints,
            placed,
            human: needed.iter().all(|r| roles.contains_key(r)),
            roles,
            scale: 1.0,
            spots: Vec::new(),
            points: Vec::new(),
            at_joint: BTreeMap::new(),
            bones: Vec::new(),
            tips: Vec::new(),
        };
        let place = |role| placed[built.roles.get(&role).copied()?].position;
        let leg = |u, l, f| Some((place(u)? - place(l)?).norm() + (place(l)? - place(f)?).norm());
        let left = leg(LeftUpperLeg, LeftLowerLeg, LeftFoot);
        let leg = left.or_else(|| leg(RightUpperLeg, RightLowerLeg, RightFoot));
        if let Some(leg) = leg.filter(|l| *l > 0.0) {
            built.scale = leg / LEG_M;
        }
        built
    }

    fn draw(&mut self) {
        if self.human {
            self.trunk();
            self.limbs();
            self.rest();
        } else {
            self.sticks();
        }
    }

    fn finish(self, name: &str) -> Shape {
        let hips = self.roles.get(&Role::Hips).copied().unwrap_or(0);
        let centre = self.at_joint.get(&hips).copied().unwrap_or(0);
        let parents = self.spots.iter().map(|spot| self.hangs_on(spot)).collect();
        Shape {
            body: Body {
                name: name.into(),
                points: self.spots.len(),
                centre,
                parents,
                bones: self.bones,
                tips: self.tips,
            },
            spots: self.spots,
        }
    }

    /// The point at whose joint a part turns, for what lies on the part.
    fn hangs_on(&self, spot: &Spot) -> Option<usize> {
        let (mut at, include) = match *spot {
            Spot::Joint(j) => (j, false),
            Spot::Fixed(j, _) => (j, true),
            Spot::Between(a, ..) => return Some(a),
        };
        if include && let Some(&point) = self.at_joint.get(&at) {
            return Some(point);
        }
        while let Some(parent) = self.joints[at].parent {
            if let Some(&point) = self.at_joint.get(&parent) {
                return Some(point);
            }
            at = parent;
        }
        None
    }

    fn spot(&mut self, spot: Spot) -> usize {
        self.points.push(place(&spot, self.placed, &self.points));
        self.spots.push(spot);
        self.spots.len() - 1
    }

    fn joint(&mut self, joint: usize) -> usize {
        if let Some(&known) = self.at_joint.get(&joint) {
            return known;
        }
        let point = self.spot(Spot::Joint(joint));
        self.at_joint.insert(joint, point);
        point
    }

    fn role(&mut self, role: Role) -> Option<usize> {
        let joint = *self.roles.get(&role)?;
        Some(self.joint(joint))
    }

    /// Where the bone of a joint ends, if that is known.
    fn tip(&mut self, role: Role) -> Option<usize> {
        let joint = *self.roles.get(&role)?;
        let tip = self.joints[joint].tip?;
        self.placed[joint].rotation?;
        Some(self.spot(Spot::Fixed(joint, tip)))
    }

    /// A bone with radii in metres on a body of the usual size.
    fn bone(&mut self, ends: [usize; 2], radii: [f64; 2]) {
        self.bones.push(Bone {
            ends,
            radii: radii.map(|r| r * self.scale),
        });
    }

    /// Pelvis, spine, ribs, shoulders, neck and head.
    fn trunk(&mut self) {
        use Role::*;
        let [Some(hips), Some(head)] = [Hips, Head].map(|r| self.role(r)) else {
            return;
        };
        let sides = [(LeftUpperArm, LeftUpperLeg), (RightUpperArm, RightUpperLeg)];
        let chain = self.chain(self.roles[&Head], self.roles[&Hips]);
        // The joint from which the arms branch off is the top of the trunk.
        let arm = self.chain(self.roles[&LeftUpperArm], self.roles[&Hips]);
        let top = chain.iter().rposition(|j| arm.contains(j)).unwrap_or(0);
        let trunk: Vec<usize> = chain[..=top].to_vec();
        let pieces = (trunk.len() - 1).clamp(1, TRUNK_POINTS - 1);
        let mut before = hips;
        for i in 1..=pieces {
            let share = i as f64 / pieces as f64;
            let at = trunk[((trunk.len() - 1) as f64 * share).round() as usize];
            let point = self.joint(at);
            if point == before {
                continue;
            }
            let radius = |s: f64| 0.104 - 0.024 * s - 0.018 * s.powi(8);
            let begun = (i - 1) as f64 / pieces as f64;
            self.bone([before, point], [radius(begun), radius(share)]);
            before = point;
        }
        before = self.chest(before);
        for (arm, leg) in sides {
            let [Some(arm), Some(leg)] = [arm, leg].map(|r| self.role(r)) else {
                continue;
            };
            // The flank: it makes the trunk wider than deep, as trunks are.
            let rib = self.spot(Spot::Between(arm, before, 0.50));
            let waist = self.spot(Spot::Between(leg, before, 0.34));
            let waist = self.spot(Spot::Between(waist, hips, 0.38));
            let crest = self.spot(Spot::Between(leg, hips, 0.45));
            self.bone([rib, waist], [0.090, 0.080]);
            self.bone([waist, crest], [0.080, 0.098]);
            self.bone([hips, leg], [0.104, 0.090]);
            self.bone([before, arm], [0.064, 0.056]);
        }
        self.neck_and_head(before, head);
    }

    /// The top of the trunk: between the shoulders, where the last joint below them is a waist.
    fn chest(&mut self, last: usize) -> usize {
        let arms = [Role::LeftUpperArm, Role::RightUpperArm].map(|r| self.role(r));
        let [Some(left), Some(right)] = arms else {
            return last;
        };
        let middle = self.spot(Spot::Between(left, right, 0.5));
        let [a, b] = [last, middle].map(|i| Vector3::from(self.points[i]));
        if (a - b).norm() < CHEST_M * self.scale {
            return last;
        }
        self.bone([last, middle], [0.100, 0.064]);
        middle
    }

    fn neck_and_head(&mut self, top: usize, head: usize) {
        match self.tip(Role::Head) {
            Some(crown) => {
                self.bone([top, head], [0.056, 0.050]);
                let jaw = self.spot(Spot::Between(head, crown, 0.26));
                let brow = self.spot(Spot::Between(head, crown, 0.52));
                self.bone([head, jaw], [0.050, 0.068]);
                self.bone([jaw, brow], [0.068, 0.086]);
            }
            // A head is where its point is.
            None => {
                let nape = self.spot(Spot::Between(head, top, 0.4));
                self.bone([top, nape], [0.056, 0.050]);
                self.bone([head, head], [0.095, 0.095]);
            }
        }
    }

    fn limbs(&mut self) {
        use Role::*;
        for (upper, lower, hand, fingers) in [
            (LeftUpperArm, LeftLowerArm, LeftHand, LeftFingers),
            (RightUpperArm, RightLowerArm, RightHand, RightFingers),
        ] {
            self.link(upper, lower, [0.055, 0.041]);
            self.link(lower, hand, [0.041, 0.030]);
            self.tips
                .extend(self.at_joint.get(&self.roles[&hand]).copied());
            self.ending(hand, fingers, [[0.030, 0.031], [0.029, 0.014]]);
        }
        for (upper, lower, foot, toes) in [
            (LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes),
            (RightUpperLeg, RightLowerLeg, RightFoot, RightToes),
        ] {
            self.link(upper, lower, [0.090, 0.056]);
            self.link(lower, foot, [0.056, 0.039]);
            self.ending(foot, toes, [[0.039, 0.031], [0.031, 0.021]]);
        }
    }

    fn link(&mut self, from: Role, to: Role, radii: [f64; 2]) {
        if let (Some(a), Some(b)) = (self.role(from), self.role(to)) {
            self.bone([a, b], radii);
        }
    }

    /// Hand and fingers, foot and toes.
    fn ending(&mut self, first: Role, second: Role, radii: [[f64; 2]; 2]) {
        if self.roles.contains_key(&second) {
            self.link(first, second, radii[0]);
            if let (Some(a), Some(b)) = (self.role(second), self.tip(second)) {
                self.bone([a, b], radii[1]);
            }
        } else if let (Some(a), Some(b)) = (self.role(first), self.tip(first)) {
            self.bone([a, b], [radii[0][0], radii[1][1]]);
        }
    }

    /// What has no role and leads to none, such as single fingers: thin.
    fn rest(&mut self) {
        let mut covered = vec![false; self.joints.len()];
        for &joint in self.roles.values() {
            let mut at = Some(joint);
            while let Some(j) = at.filter(|&j| !covered[j]) {
                covered[j] = true;
                at = self.joints[j].parent;
            }
        }
        let bare = (0..covered.len()).filter(|&j| !covered[j]);
        for joint in bare.collect::<Vec<_>>() {
            if let Some(parent) = self.joints[joint].parent {
                let ends = [self.joint(parent), self.joint(joint)];
                self.bone(ends, [0.011, 0.010]);
            }
        }
    }

    /// A skeleton that is no human's, or not known to be: every bone as thick as its length allows.
    fn sticks(&mut self) {
        for j in 0..self.joints.len() {
            let point = self.joint(j);
            match self.joints[j].parent {
                Some(parent) => {
                    let from = self.joint(parent);
                    self.stick(from, point);
                }
                None => self.bone([point, point], [0.02, 0.02]),
            }
            let is_leaf = !self.joints.iter().any(|k| k.parent == Some(j));
            if let (true, Some(tip), Some(_)) =
                (is_leaf, self.joints[j].tip, self.placed[j].rotation)
            {
                let tip = self.spot(Spot::Fixed(j, tip));
                self.stick(point, tip);
            }
        }
    }

    fn stick(&mut self, from: usize, to: usize) {
        let [a, b] = [from, to].map(|i| Vector3::from(self.points[i]));
        let length = (b - a).norm();
        let radius = if length.is_finite() {
            0.11 * length
        } else {
            0.02
        };
        let radius = radius.clamp(0.008, 0.05);
        self.bone([from, to], [radius, 0.8 * radius]);
    }

    /// Joints from an ancestor to a joint.
    fn chain(&self, joint: usize, ancestor: usize) -> Vec<usize> {
        let mut chain = vec![joint];
        let mut at = joint;
        while at != ancestor {
            match self.joints[at].parent {
                Some(parent) => at = parent,
                None => {
                    // Bare positions know no parents.
                    chain.push(ancestor);
                    break;
                }
            }
            chain.push(at);
        }
        chain.reverse();
        chain
    }
}
