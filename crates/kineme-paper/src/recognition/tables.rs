//! All tables of `docs/perception.md`, one after another.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use super::calibration::{self, write_calibration};
use super::clips::{Asked, METHODS, line_beside_route, lines, write_clips};
use super::corpora::{BANDAI_NAMCO, HDM05, MSR, Part, UTD, corpora};
use super::damage::{costs, write_costs};
use super::exercises::Exercises;
use super::few_shots::few_shots;
use super::known::Method;
use super::law::write_law;
use super::open_set::{rejections, write_rejections};
use super::peers::Peers;
use super::streams::{dances, hear, write_streams};
use super::summary::{shown, write_lines};
use super::trials::SHOTS;
use crate::sets::Result;

/// One clip in so many is asked damaged.
const DAMAGED: usize = 8;

/// Recognises every set of a corpus and writes what came of it, as Markdown. `watch` is told what is being done, and the
/// tables one by one as they are made. With `only`, nothing is done but the stages in whose name (`HDM05: few
/// exemplars`, as `watch` hears it) that word is.
///
/// # Errors
/// When the corpus lacks a file or a step fails.
pub fn perception_tables(
    corpus: &Path,
    only: Option<&str>,
    watch: &mut dyn FnMut(&str),
) -> Result<String> {
    let begin = |stage: String, watch: &mut dyn FnMut(&str)| {
        let wanted = only.is_none_or(|word| stage.contains(word));
        if wanted {
            watch(&stage);
        }
        wanted
    };
    let body = Arc::new(kineme::ares()?);
    let peers = Peers::kept()?;
    watch("reading");
    let sets = corpora(corpus, &body, &[UTD, MSR, HDM05, BANDAI_NAMCO], Part::WHOLE)?;
    let (mut whole, mut hands) = (Vec::new(), Vec::new());
    let mut rest = Vec::new();
    let mut details = String::new();
    let mut calibrated = Vec::new();
    for of in &sets {
        if !begin(format!("{}: whole clips", of.name), watch) {
            continue;
        }
        let asked = Asked::of(of, &METHODS)?;
        let [all, by_hands] = lines(of, &asked)?;
        whole.push(all);
        if of.name == BANDAI_NAMCO {
            whole.push(line_beside_route(of, &asked)?);
        }
        hands.push(by_hands);
        tell(&mut details, watch, |t| write_clips(t, of, &asked))?;
        watch(&format!("{}: {} pooled splits", of.name, of.pooled.len()));
        calibrated.push(calibration::line(of, &asked)?);
    }
    if begin("exercises".into(), watch) {
        let line = Exercises::read(corpus, &body)?.line()?;
        watch(&format!("{}: {}", line.row, shown(&line.ours)));
        rest.push(line);
    }
    let pair = [Method::Filter, Method::Dtw];
    let learned_few: Vec<_> = sets
        .iter()
        .filter(|c| [UTD, HDM05].contains(&c.name))
        .collect();
    for of in &learned_few {
        if !begin(format!("{}: half of the classes unknown", of.name), watch) {
            continue;
        }
        let all = rejections(of, &pair)?;
        let write = |t: &mut String| write_rejections(t, of, &pair, &all);
        rest.extend(tell(&mut details, watch, write)?);
    }
    for of in &learned_few {
        if !begin(format!("{}: few exemplars", of.name), watch) {
            continue;
        }
        for shots in SHOTS {
            let line = few_shots(of, shots, pair[0], pair[1])?;
            watch(&format!("{}: {}", line.row, shown(&line.ours)));
            rest.push(line);
        }
    }
    let dances = dances(corpus, &body)?;
    let listeners = [Method::Filter, Method::Frame, Method::Dtw];
    for of in sets.iter().filter(|c| c.name != BANDAI_NAMCO) {
        if !begin(format!("{}: streams", of.name), watch) {
            continue;
        }
        let heard = hear(of, &dances, &listeners)?;
        let write = |t: &mut String| write_streams(t, of, &listeners, &heard);
        tell(&mut details, watch, write)?;
    }
    let hurt = [Method::Filter, Method::Frame, Method::Paper, Method::Dtw];
    for of in &learned_few {
        if !begin(format!("{}: damaged", of.name), watch) {
            continue;
        }
        let right = costs(of, &hurt, DAMAGED)?;
        tell(&mut details, watch, |t| write_costs(t, of, &hurt, &right))?;
    }
    if begin("inverse law".into(), watch) {
        tell(&mut details, watch, write_law)?;
    }
    whole.extend(rest);
    let mut out = String::from("\n### Aims: the whole body, `filter`\n");
    write_lines(&mut out, "filter", "1NN-DTW", &whole, &peers)?;
    writeln!(out, "\n### Aims: hands alone, `encode`")?;
    write_lines(&mut out, "encode", "1NN-DTW, hands", &hands, &peers)?;
    write_calibration(&mut out, &calibrated)?;
    if !peers.made_by.is_empty() {
        writeln!(out, "\nMiniRocket: {}.", peers.made_by)?;
    }
    out.push_str(&details);
    Ok(out)
}

/// Adds what `write` writes to the details and tells it.
fn tell<T>(
    details: &mut String,
    watch: &mut dyn FnMut(&str),
    write: impl FnOnce(&mut String) -> Result<T>,
) -> Result<T> {
    let mut text = String::new();
    let made = write(&mut text)?;
    watch(&text);
    details.push_str(&text);
    Ok(made)
}
