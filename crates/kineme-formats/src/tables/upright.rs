//! Which axis of bare positions points up, told from the body's long axis.

use kineme::math::rotation::Axis;
use nalgebra::Vector3;

// Each list is tried in turn until one matches a joint: the ends of the body first.
const HIGH: [&[&str]; 3] = [&["head"], &["neck"], &["shoulder"]];
const LOW: [&[&str]; 2] = [&["foot", "feet", "ankle", "toe"], &["hip", "pelvis"]];

/// The upward axis, y or z, of frames of `names.len()` points: the larger of the two in the mean of head
/// minus feet (neck or shoulders, hips, where those are not there). Says what it took.
pub(crate) fn detect(
    names: &[&str],
    points: &[Option<Vector3<f64>>],
    warnings: &mut Vec<String>,
) -> Axis {
    let find = |lists: &[&[&str]]| -> Vec<usize> {
        lists
            .iter()
            .map(|words| {
                let named = |j: &usize| {
                    let name = names[*j].to_lowercase();
                    words.iter().any(|w| name.contains(w))
                };
                (0..names.len()).filter(named).collect::<Vec<_>>()
            })
            .find(|found| !found.is_empty())
            .unwrap_or_default()
    };
    let (high, low) = (find(&HIGH), find(&LOW));
    let mut sum = Vector3::zeros();
    let mut frames = 0usize;
    for frame in points.chunks_exact(names.len()) {
        if let (Some(h), Some(l)) = (mean(frame, &high), mean(frame, &low)) {
            sum += h - l;
            frames += 1;
        }
    }
    if frames == 0 {
        warnings.push("up axis: z assumed, no head and feet or hips to tell it by".to_string());
        return Axis::Z;
    }
    let long = sum / frames as f64;
    let up = if long.y.abs() > long.z.abs() {
        Axis::Y
    } else {
        Axis::Z
    };
    let (letter, along) = match up {
        Axis::Y => ('y', long.y),
        _ => ('z', long.z),
    };
    let [h, l] = [&high, &low].map(|side| names[side[0]]);
    warnings.push(format!("up axis: {letter}, from `{h}` against `{l}`"));
    if along < 0.0 {
        warnings.push(format!("{letter} points down: the body is upside down"));
    }
    if along.abs() < 0.5 * long.norm() {
        warnings.push("up axis: in doubt, the body lies".to_string());
    }
    const STATURES_METRES: std::ops::RangeInclusive<f64> = 0.2..=4.0;
    if !STATURES_METRES.contains(&long.norm()) {
        warnings.push(format!(
            "`{h}` is {:.3} m from `{l}`: is the table in metres?",
            long.norm()
        ));
    }
    up
}

fn mean(frame: &[Option<Vector3<f64>>], joints: &[usize]) -> Option<Vector3<f64>> {
    let seen: Vec<Vector3<f64>> = joints.iter().filter_map(|&j| frame[j]).collect();
    (!seen.is_empty()).then(|| seen.iter().sum::<Vector3<f64>>() / seen.len() as f64)
}
