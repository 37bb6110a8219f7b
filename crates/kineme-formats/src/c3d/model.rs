//! The conventional gait model (Davis et al. 1991): from its markers to the centres of the joints.

use std::collections::BTreeMap;

use kineme::Role;
use kineme::math::rotation::shortest;
use kineme::math::statistics::median;
use nalgebra::Vector3;

use super::marker_sets::{Knob, MarkerSet, Side};
use super::places::{Path, Places, Point, each};

/// From a marker outside a hinge to the hinge's centre, in widths of the pelvis between its front markers: half an adult's
/// breadth of elbow, knee and ankle, and half a marker.
const ELBOW: f64 = 0.18;
const KNEE: f64 = 0.23;
const ANKLE: f64 = 0.18;

/// From the acromion down to the shoulder's centre, in distances of the two acromions (Rab et al. 2002).
const SHOULDER: f64 = 0.17;

/// Sine of the bend (15 degrees) from which on a hinge shows about which axis it turns.
const BENT: f64 = 0.26;

/// How often axis and centre are told from each other; they settle within two or three.
const ROUNDS: usize = 4;

/// The joints of the conventional gait model.
pub fn joints(markers: &Places<'_>, set: &MarkerSet) -> BTreeMap<Role, Path> {
    use Role::*;
    let neck = markers.middle(&set.neck);
    let mut paths = BTreeMap::new();
    for (role, of) in [(Head, &set.head), (Chest, &set.chest)] {
        if !of.is_empty() {
            paths.insert(role, markers.middle(of));
        }
    }
    let pelvis = Pelvis::of(markers, set);
    let shoulders = markers.distance(set.left.shoulder, set.right.shoulder);
    let hips = [1.0, -1.0].map(|left| pelvis.hip(left));
    let arms = [&set.left, &set.right].map(|side| {
        each(markers.frames, |f| {
            let down = (pelvis.middle[f]? - neck[f]?).try_normalize(1e-9)?;
            Some(markers.at(f, side.shoulder)? + SHOULDER * shoulders * down)
        })
    });
    let left = [
        LeftUpperArm,
        LeftLowerArm,
        LeftHand,
        LeftFingers,
        LeftUpperLeg,
        LeftLowerLeg,
        LeftFoot,
        LeftToes,
    ];
    let roles = [left, left.map(Role::mirrored)];
    for (k, side) in [&set.left, &set.right].into_iter().enumerate() {
        let other = 1 - k;
        let right = if k == 1 { 1.0 } else { -1.0 };
        let arm = Limb {
            markers,
            hinge: side.elbow,
            reach: ELBOW * pelvis.width,
            end_reach: 0.0,
            bend: right,
        };
        let wrist = markers.middle(&side.wrist);
        let (elbow, _) = arm.centre(&arms[k], &arms[other], &wrist);
        let mut own = vec![Some(arms[k].clone()), Some(elbow)];
        own.push((!side.wrist.is_empty()).then_some(wrist));
        own.push(side.fingers.map(|m| markers.middle(&[m])));
        own.push(Some(hips[k].clone()));
        own.extend(leg(markers, side, &hips[k], &hips[other], &pelvis, right));
        own.push(side.toes.map(|m| markers.middle(&[m])));
        let own = roles[k].into_iter().zip(own);
        paths.extend(own.filter_map(|(role, path)| Some((role, path?))));
    }
    paths.insert(Hips, pelvis.middle);
    paths.insert(Neck, neck);
    paths
}

/// Knee and ankle.
fn leg(
    markers: &Places<'_>,
    side: &Side,
    hip: &[Point],
    other: &[Point],
    pelvis: &Pelvis,
    right: f64,
) -> [Option<Path>; 2] {
    let Some(knee) = side.knee else {
        return [None, None];
    };
    let marked = side.ankle.map(|a| markers.middle(&a.marked()));
    let leg = Limb {
        markers,
        hinge: knee,
        reach: KNEE * pelvis.width,
        end_reach: match side.ankle {
            Some(Knob { inner: None, .. }) => ANKLE * pelvis.width,
            _ => 0.0,
        },
        // Knees bend the other way than elbows.
        bend: -right,
    };
    let unseen = vec![None; markers.frames];
    let (knee, axis) = leg.centre(hip, other, marked.as_deref().unwrap_or(&unseen));
    let ankle = marked.map(|ends| {
        each(markers.frames, |f| {
            let end = ends[f]?;
            Some(inward(&knee[f]?, &end, &axis[f]?, leg.end_reach))
        })
    });
    [Some(knee), ankle]
}

/// Front and back of the pelvis, and how wide and deep it is.
struct Pelvis {
    /// Midway between the four markers.
    middle: Path,
    /// Of each frame the middle of the front, and the axes: forward, left, up.
    frames: Vec<Option<[Vector3<f64>; 4]>>,
    width: f64,
    depth: f64,
}

impl Pelvis {
    fn of(markers: &Places<'_>, set: &MarkerSet) -> Self {
        let (left, right) = (&set.left, &set.right);
        let front = markers.middle(&[left.front, right.front]);
        let back = markers.middle(&[left.back, right.back]);
        let depths = front.iter().zip(&back);
        let depths: Vec<f64> = depths
            .filter_map(|(a, b)| Some(((*a)? - (*b)?).norm()))
            .collect();
        let frames = (0..markers.frames).map(|f| {
            let (front, back) = (front[f]?, back[f]?);
            let across = markers.at(f, left.front)? - markers.at(f, right.front)?;
            let left = across.try_normalize(1e-9)?;
            let ahead = front - back;
            let ahead = (ahead - left * left.dot(&ahead)).try_normalize(1e-9)?;
            Some([front, ahead, left, ahead.cross(&left)])
        });
        Self {
            middle: each(markers.frames, |f| Some(0.5 * (front[f]? + back[f]?))),
            frames: frames.collect(),
            width: markers.distance(left.front, right.front),
            depth: median(&depths).unwrap_or(0.0),
        }
    }

    /// The centre of a hip from width and depth of the pelvis (Harrington et al. 2007); `left` is 1 or -1.
    fn hip(&self, left: f64) -> Path {
        let back = -0.24 * self.depth - 0.0099;
        let down = -0.30 * self.width - 0.0109;
        let aside = left * (0.33 * self.width + 0.0073);
        let at = |frame: &Option<[Vector3<f64>; 4]>| {
            let [front, x, y, z] = (*frame)?;
            Some(front + back * x + aside * y + down * z)
        };
        self.frames.iter().map(at).collect()
    }
}

/// A limb whose hinge is marked.
struct Limb<'m> {
    markers: &'m Places<'m>,
    hinge: Knob,
    /// From the marker outside to the centre, metres.
    reach: f64,
    /// From the marker at the limb's end to the centre there, metres; 0 where it is a centre.
    end_reach: f64,
    /// 1 where the limb bends about the axis that points inward, from above the hinge to below it: at the right elbow and
    /// the left knee; at the others -1.
    bend: f64,
}

impl Limb<'_> {
    /// The hinge's centre, and the direction inward along its axis. `root` is where the limb begins, `other` where the
    /// other side's does, `end` where it ends.
    ///
    /// A bent limb shows the axis; a straight one carries along that of the frame before, as it swings without turning; at
    /// first as if it had hung and the axis pointed to the other side.
    fn centre(&self, root: &[Point], other: &[Point], end: &[Point]) -> (Path, Path) {
        let mut before: Option<[Vector3<f64>; 2]> = None;
        let mut axes = vec![None; self.markers.frames];
        let centres = each(self.markers.frames, |f| {
            let outer = self.markers.at(f, self.hinge.outer)?;
            let root = root[f]?;
            let limb = (outer - root).try_normalize(1e-9)?;
            if let Some(inner) = self.hinge.inner {
                let inner = self.markers.at(f, inner)?;
                axes[f] = (inner - outer).try_normalize(1e-9);
                return Some(0.5 * (outer + inner));
            }
            let mut axis = match before {
                Some([limb_before, axis]) => shortest(&limb_before, &limb) * axis,
                None => {
                    let hung = -Vector3::z();
                    shortest(&hung, &limb) * (other[f]? - root).try_normalize(1e-9)?
                }
            };
            let mut centre = inward(&root, &outer, &axis, self.reach);
            // The bend is that of the centres, which the axis moves a little.
            for _ in 0..ROUNDS {
                let Some(end) = end[f] else { break };
                let end = inward(&centre, &end, &axis, self.end_reach);
                let up = (root - centre).try_normalize(1e-9);
                let down = (end - centre).try_normalize(1e-9);
                let Some((up, down)) = up.zip(down) else {
                    break;
                };
                let Some(shown) = (self.bend * up.cross(&down)).try_normalize(BENT) else {
                    break;
                };
                axis = shown;
                centre = inward(&root, &outer, &axis, self.reach);
            }
            before = Some([limb, axis]);
            axes[f] = Some(axis);
            Some(centre)
        });
        (centres, axes)
    }
}

/// From a marker outside a hinge so far inward, square to the limb that begins at `root`; the marker itself where that is
/// nowhere.
fn inward(
    root: &Vector3<f64>,
    outer: &Vector3<f64>,
    axis: &Vector3<f64>,
    reach: f64,
) -> Vector3<f64> {
    let limb = root - outer;
    let share = reach / limb.norm().max(1e-9);
    let along = limb.try_normalize(1e-9).unwrap_or_else(Vector3::z);
    match (axis - along * along.dot(axis)).try_normalize(1e-9) {
        Some(square) if share < 1.0 => {
            outer + reach * (share * along + (1.0 - share * share).sqrt() * square)
        }
        _ => *outer,
    }
}
