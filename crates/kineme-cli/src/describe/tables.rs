//! Tables and lists for people.

use kineme::interpolation::Method;
use kineme::primitive::{LeaveOneOut, ParameterSource, Trial};
use kineme::{Exemplar, Primitive, Vocabulary};
use kineme_paper::figures::counted;

use super::{calibrated, durations, short};
use crate::table::{Side, aligned};

/// A method in words: what `--interpolation` calls it, and what it was smoothed by.
fn method_name(method: &Method) -> String {
    match *method {
        Method::Shepard { power } => format!("shepard, power {}", short(power)),
        Method::Cardinal { nugget: 0.0, .. } => "verbs-and-adverbs".into(),
        Method::Cardinal { nugget, .. } => format!("verbs-and-adverbs, nugget {}", short(nugget)),
    }
}

fn range(low: f64, high: f64) -> String {
    let (low, high) = (format!("{low:.2}"), format!("{high:.2}"));
    if low == high {
        low
    } else {
        format!("{low}-{high}")
    }
}

fn kind(primitive: &Primitive) -> String {
    if primitive.is_cyclic() {
        "cycle"
    } else {
        "stroke"
    }
    .into()
}

/// The parameters with their ranges, as `--at` takes them.
fn parameters(primitive: &Primitive) -> String {
    let axes = primitive.parameters().axes().iter();
    let told: Vec<String> = axes
        .map(|a| format!("{} {} to {}", a.name, short(a.low), short(a.high)))
        .collect();
    if told.is_empty() {
        "-".into()
    } else {
        told.join(", ")
    }
}

fn cm(metres: f64) -> String {
    format!("{:.1}", 100.0 * metres)
}

fn degrees(radians: f64) -> String {
    format!("{:.1}", radians.to_degrees())
}

/// What the primitives are, and how good.
pub(super) fn tables(vocabulary: &Vocabulary, name: &str) -> String {
    let primitives = vocabulary.primitives();
    let exemplars: usize = primitives.iter().map(|p| p.exemplars().len()).sum();
    let derived = primitives.iter().any(|p| p.group().is_some());
    let mut text = format!(
        "{name}: {} of {}, body {}\n\n",
        counted(primitives.len(), "primitive"),
        counted(exemplars, "exemplar"),
        vocabulary.body().name()
    );
    let mut header = vec![
        ("primitive", Side::Left),
        ("exemplars", Side::Right),
        ("seconds", Side::Right),
        ("kind", Side::Left),
    ];
    if derived {
        header.extend([("members", Side::Right), ("coherence", Side::Right)]);
    }
    header.push(("parameters", Side::Left));
    let rows: Vec<Vec<String>> = primitives
        .iter()
        .map(|p| {
            let [shortest, longest] = durations(p);
            let mut row = vec![
                p.name().into(),
                p.exemplars().len().to_string(),
                range(shortest, longest),
                kind(p),
            ];
            if derived {
                let group = p.group();
                row.push(group.map_or("-".into(), |g| g.members.to_string()));
                let coherence = group.and_then(|g| g.coherence);
                row.push(coherence.map_or("-".into(), |c| format!("{c:.2}")));
            }
            row.push(parameters(p));
            row
        })
        .collect();
    text.push_str(&aligned(&header, &rows));
    text.push('\n');
    text.push_str(&judged(primitives));
    text.push_str(&behaviors(vocabulary));
    text.push_str(&recognition(vocabulary));
    let notes: usize = primitives.iter().map(|p| p.notes().count()).sum();
    if notes > 0 {
        text.push_str(&format!(
            "\n{} on single primitives: `kineme show {name} PRIMITIVE`\n",
            counted(notes, "note")
        ));
    }
    text
}

/// How exemplars are predicted from the others.
fn judged(primitives: &[Primitive]) -> String {
    let header = [
        ("each exemplar from the others", Side::Left),
        ("joints deg", Side::Right),
        ("wrists cm", Side::Right),
        ("body cm", Side::Right),
        ("nearest cm", Side::Right),
        ("mean cm", Side::Right),
        ("by", Side::Left),
    ];
    let rows: Vec<Vec<String>> = primitives
        .iter()
        .map(|p| {
            let fit = p.fitted();
            let mut row = vec![p.name().to_owned()];
            match (&fit.error, fit.trials.first()) {
                (Some(e), Some(t)) => row.extend([
                    degrees(e.joint_rad),
                    cm(e.wrist_m),
                    cm(t.error_m),
                    cm(e.nearest_m),
                    cm(e.mean_m),
                ]),
                _ => row.extend(std::iter::repeat_n("-".to_owned(), 5)),
            }
            row.push(method_name(&fit.method));
            row
        })
        .collect();
    format!(
        "{}body: joints all over it, root mean square; nearest and mean: what the nearest exemplar or the mean would give\n",
        aligned(&header, &rows)
    )
}

/// Behaviors of several primitives.
fn behaviors(vocabulary: &Vocabulary) -> String {
    let several = vocabulary.behaviors().iter();
    let rows: Vec<Vec<String>> = several
        .filter(|b| b.primitives.len() > 1)
        .map(|b| vec![b.name.clone(), b.primitives.join(" ")])
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let header = [("behavior", Side::Left), ("primitives", Side::Left)];
    format!("\n{}", aligned(&header, &rows))
}

/// Whom recognition need not be fitted for.
fn recognition(vocabulary: &Vocabulary) -> String {
    let names: Vec<&str> = calibrated(vocabulary).collect();
    let told = match names.as_slice() {
        [] => "not calibrated, usual numbers hold; what `kineme edit` writes is calibrated".into(),
        names => format!("calibrated for {}", names.join(" and ")),
    };
    format!("\nrecognition: {told}\n")
}

/// All there is to tell of a primitive.
pub(super) fn details(primitive: &Primitive) -> String {
    let fit = primitive.fitted();
    let [shortest, longest] = durations(primitive);
    let n = primitive.exemplars().len();
    let mut text = format!(
        "{}: a {} of {} s, {} on {}\n",
        primitive.name(),
        kind(primitive),
        range(shortest, longest),
        counted(n, "exemplar"),
        primitive.body().name()
    );
    if let Some(group) = primitive.group() {
        let coherence = group.coherence.map(|c| format!(", coherence {c:.2}"));
        text.push_str(&format!(
            "derived from a group of {}{}\n",
            counted(group.members, "segment"),
            coherence.unwrap_or_default()
        ));
    }
    text.push_str(&format!(
        "parameters: {} ({})\n",
        parameters(primitive),
        match primitive.parameters().source() {
            _ if primitive.parameters().dims() == 0 => "it always looks the same".into(),
            ParameterSource::Adverbs => "adverbs, as they were given".into(),
            ParameterSource::Principal { .. } =>
                "the directions in which the exemplars vary most".into(),
            ParameterSource::Effector { effector, .. } =>
                format!("where {effector} is at its extreme, metres from between the shoulders"),
        }
    ));
    text.push_str(&format!("interpolation: {}\n", method_name(&fit.method)));
    if let Some(error) = &fit.error {
        text.push('\n');
        text.push_str(&predicted(error, &fit.trials));
    }
    text.push('\n');
    text.push_str(&sources(primitive));
    for note in primitive.notes() {
        text.push_str(&format!("note: {note}\n"));
    }
    text
}

/// What was tried, and how well it predicts.
fn predicted(error: &LeaveOneOut, trials: &[Trial]) -> String {
    let mut rows: Vec<Vec<String>> = trials
        .iter()
        .enumerate()
        .map(|(i, t)| {
            let chosen = if i == 0 { "  <- chosen" } else { "" };
            let name = format!(
                "{} of {}",
                method_name(&t.method),
                counted(t.dims, "parameter")
            );
            vec![name, format!("{}{chosen}", cm(t.error_m))]
        })
        .collect();
    rows.push(vec!["the nearest exemplar".into(), cm(error.nearest_m)]);
    rows.push(vec!["the mean of the others".into(), cm(error.mean_m)]);
    let header = [
        ("each exemplar from the others, by", Side::Left),
        ("body cm", Side::Left),
    ];
    format!(
        "{}The chosen one errs by {} degrees a joint and {} cm at the wrists. What passes through every exemplar is kept\n\
         unless another is better by 2 %.\n",
        aligned(&header, &rows),
        degrees(error.joint_rad),
        cm(error.wrist_m)
    )
}

/// The exemplars, where they come from and where they lie.
fn sources(primitive: &Primitive) -> String {
    let axes = primitive.parameters().axes();
    let mut header = vec![
        ("exemplar", Side::Left),
        ("start", Side::Right),
        ("end", Side::Right),
        ("blake3", Side::Left),
    ];
    header.extend(axes.iter().map(|a| (a.name.as_str(), Side::Right)));
    let row = |(i, e): (usize, &Exemplar)| {
        let from = &e.provenance;
        let hash = from.blake3.as_deref().and_then(|h| h.get(..8));
        let mut row = vec![
            from.motion.clone(),
            format!("{:.2}", from.start_secs),
            format!("{:.2}", from.end_secs),
            hash.unwrap_or("-").to_owned(),
        ];
        let values = primitive.parameters().from_unit(primitive.point(i));
        row.extend(values.into_iter().map(short));
        row
    };
    let rows: Vec<Vec<String>> = primitive.exemplars().iter().enumerate().map(row).collect();
    aligned(&header, &rows)
}
