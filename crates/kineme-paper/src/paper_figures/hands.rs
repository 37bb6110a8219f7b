//! Figure 1: hand trajectories of groups that the derivation found in the choreographed session.

use std::sync::Arc;

use kineme::primitive::Primitive;
use kineme::{Motion, Root};
use kineme_report::paper::HandPanel;

use crate::demo::Found;
use crate::figures::wrists;
use crate::sets::Result;

/// The stroke of the session that stands for each of the paper's behaviours: waving an arm across the body, dancing the
/// monkey (arms going up and down in front), punching.
const STROKES: [(&str, &str); 3] = [
    ("wave left", "Waving an arm across the body"),
    ("raise up", "Arms up, for the dance \u{201c}monkey\u{201d}"),
    ("jab out", "Punching"),
];
/// Movements interpolated, at most.
const MOST: usize = 10;
/// Postures of each.
const POSTURES: usize = 33;

/// The four panels: of each behaviour the most coherent group, and the least coherent group of all, whatever it holds.
///
/// # Errors
/// When the derivation found no group of one of the behaviours.
pub fn panels(demo: &Found) -> Result<Vec<HandPanel>> {
    let groups = &demo.derived.groups;
    let coherence = |g: usize| groups[g].coherence.unwrap_or(0.0);
    let mut panels = Vec::new();
    let mut shown = Vec::new();
    for (stroke, title) in STROKES {
        let own = (0..groups.len()).filter(|&g| demo.names[g].0 == stroke);
        let best = own.max_by(|&a, &b| coherence(a).total_cmp(&coherence(b)));
        let best = best.ok_or_else(|| format!("no group of the stroke `{stroke}`"))?;
        shown.push(best);
        panels.push(panel(demo, best, title.into())?);
    }
    let others = (0..groups.len()).filter(|g| !shown.contains(g));
    let worst = others.min_by(|&a, &b| coherence(a).total_cmp(&coherence(b)));
    if let Some(worst) = worst {
        let mut last = panel(
            demo,
            worst,
            "The least coherent group, which nobody meant".into(),
        )?;
        last.unintended = true;
        panels.push(last);
    }
    Ok(panels)
}

fn panel(demo: &Found, g: usize, title: String) -> Result<HandPanel> {
    let group = &demo.derived.groups[g];
    let (stroke, count) = &demo.names[g];
    let hands = group.segments.iter().map(|&s| {
        let segment = &demo.derived.segments[s];
        wrists(&demo.motions[segment.motion], segment.frames.clone())
    });
    let (left, right) = hands.map(|[l, r]| (l, r)).unzip();
    let made = interpolated(demo.vocabulary.primitive(&group.name)?)?;
    let (left_interpolated, right_interpolated) = made.into_iter().map(|[l, r]| (l, r)).unzip();
    Ok(HandPanel {
        title,
        facts: format!(
            "{}: {} segments, {count} of them choreographed as \u{201c}{stroke}\u{201d}",
            group.name,
            group.segments.len()
        ),
        coherence: group.coherence,
        unintended: false,
        right,
        left,
        right_interpolated,
        left_interpolated,
    })
}

/// Wrists in movements half way between exemplars that follow one another in the primitive's list.
fn interpolated(primitive: &Primitive) -> Result<Vec<[Vec<[f64; 3]>; 2]>> {
    let n = primitive.exemplars().len();
    let between = |i: usize| -> Vec<f64> {
        let pair = primitive.point(i).iter().zip(primitive.point((i + 1) % n));
        pair.map(|(a, b)| 0.5 * (a + b)).collect()
    };
    // Without parameters all are the one movement.
    let count = if primitive.parameters().dims() == 0 {
        1
    } else {
        n.min(MOST)
    };
    (0..count)
        .map(|k| {
            let course = primitive.at(&between(k * n / count))?;
            let pose = |i: usize| course.pose(i as f64 / (POSTURES - 1) as f64);
            let poses: Vec<f64> = (0..POSTURES).flat_map(pose).collect();
            let body = Arc::clone(primitive.body());
            let motion = Motion::new(
                "interpolated",
                body,
                60.0,
                poses,
                vec![Root::ORIGIN; POSTURES],
            )?;
            Ok(wrists(&motion, 0..POSTURES))
        })
        .collect()
}
