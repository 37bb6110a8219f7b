//! `kineme control`: a plan of behaviors on a simulated body.

mod machines;
mod told;
mod watched;

use std::time::Instant;

use indicatif::ProgressBar;
use kineme::Vocabulary;
use kineme::control::{ControlSettings, Controller, Plan, Robot};
use kineme::interaction::{Performance, Session, SessionSettings, standing};
use kineme::perception::{Filter, FilterSettings};
use kineme::primitive::{Observations, Recogniser, readings};
use kineme_formats::{output, plan};
use kineme_paper::figures::PAGE;
use kineme_paper::scene::take_of_performance;
use kineme_report::scene::Scene;
use kineme_report::{Page, Section};

use crate::args::{ControlArgs, Global, Written};
use crate::failure::{Failure, complain, print};
use crate::outputs::{existing, refuse_existing, unwritten};
use crate::progress;
use crate::vocabularies::{read, read_bytes};
use watched::Watched;

/// Joints that are named in a note.
const NAMED: usize = 8;

pub fn run(args: &ControlArgs, global: &Global) -> Result<u8, Failure> {
    let written = written(args, global)?;
    let page = args.report.as_ref().map(|folder| folder.join(PAGE));
    refuse_existing(page.as_deref(), global)?;
    let vocabulary = read(&args.vocabulary)?;
    let (name, bytes) = read_bytes(&args.plan, "a plan")?;
    let file = plan::parse(&name, &bytes)?;
    let plan = &file.plan;
    let watches = args.watch.is_some() || plan.observed.is_some();
    let refused = plan.check(&vocabulary, watches.then_some(&vocabulary));
    refused.map_err(|fault| file.fault(&fault))?;
    let watched = Watched::asked(args, plan.observed.as_deref(), vocabulary.body())?;
    if watched.is_some() && plan.rules.is_empty() {
        complain("note: nothing answers what is watched: the plan has no [[rule]]");
    }
    let mut robot = machines::robot(args, &vocabulary)?;
    let begun = Instant::now();
    let (performance, ended) = perform(&vocabulary, plan, watched.as_ref(), &mut *robot)?;
    let factor = performance.done.duration_secs() / begun.elapsed().as_secs_f64();
    if let (Some(out), Some(format)) = (&args.out, written) {
        let bytes = format.bytes(&performance.done)?;
        output::write_bytes(out, existing(global), &bytes).map_err(unwritten)?;
    }
    let told = told::Told::of(
        &performance,
        &vocabulary,
        robot.is_physical(),
        args.timings.then_some(factor),
    );
    if let Some(page) = &page {
        let html = shown(&name, &vocabulary, &performance, &told, watched.as_ref())?;
        output::write_bytes(page, existing(global), html.as_bytes()).map_err(unwritten)?;
    }
    let text = match global.json {
        true => crate::json::line(&told)?,
        false => told.text([args.out.as_deref(), page.as_deref()]),
    };
    print(text.as_bytes())?;
    ended.map(|()| 0)
}

/// What was done, and why it ended before the plan did if it did: what was done until then is not lost.
fn perform(
    vocabulary: &Vocabulary,
    plan: &Plan,
    watched: Option<&Watched>,
    robot: &mut dyn Robot,
) -> Result<(Performance, Result<(), Failure>), Failure> {
    let filter = match watched {
        Some(_) => Some(Filter::new(vocabulary, &FilterSettings::default())?),
        None => None,
    };
    let start = standing(vocabulary, plan)?;
    let controller = Controller::new(vocabulary, plan, &start, &ControlSettings::default())?;
    let recogniser = filter.as_ref().map(|f| f as &dyn Recogniser);
    let mut session = Session::new(controller, robot, recogniser, &SessionSettings::default())?;
    tell_unshown(&session, vocabulary);
    let bar = progress::seconds(plan.seconds, "moving");
    let done = match watched {
        Some(watched) => watched.run(&mut session, vocabulary.body(), &bar),
        None => alone(&mut session, None, &bar),
    };
    bar.finish_and_clear();
    match session.performance("control") {
        Ok(performance) => Ok((performance, done)),
        // Nothing was done: why is what there is to say.
        Err(nothing) => Err(done.err().unwrap_or(nothing.into())),
    }
}

/// Goes on to the end of the plan, with a recording or nothing to watch.
fn alone(
    session: &mut Session<'_>,
    seen: Option<&Observations>,
    bar: &ProgressBar,
) -> Result<(), Failure> {
    Ok(session.run(seen, &mut |secs| show(secs, bar))?)
}

fn show(secs: f64, bar: &ProgressBar) {
    bar.set_position((secs * 1000.0) as u64);
}

/// Tells which joints of the vocabulary's body the robot has nothing for.
fn tell_unshown(session: &Session<'_>, vocabulary: &Vocabulary) {
    let joints = session.without_counterpart();
    if joints.is_empty() {
        return;
    }
    let name = |j: &usize| vocabulary.body().joints()[*j].name.as_str();
    let named: Vec<&str> = joints.iter().take(NAMED).map(name).collect();
    let more = match joints.len().saturating_sub(NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    complain(&format!(
        "note: the robot has no counterpart of {}{more}",
        named.join(", ")
    ));
}

/// The page of a performance; a stream that was watched is gone and not on it.
fn shown(
    plan: &str,
    vocabulary: &Vocabulary,
    performance: &Performance,
    told: &told::Told,
    watched: Option<&Watched>,
) -> Result<String, Failure> {
    let seen = match watched {
        Some(Watched::Recording(seen)) => {
            let filter = Filter::new(vocabulary, &FilterSettings::default())?;
            Some((seen.motion(), readings(&filter, seen)?))
        }
        _ => None,
    };
    let mut scene = Scene::default();
    let seen = seen.as_ref().map(|(motion, r)| (*motion, r.as_slice()));
    let take = take_of_performance(&mut scene, vocabulary, performance, seen);
    scene.takes.push(take);
    let page = Page {
        title: format!("{plan} on {}", performance.done.skeleton().name()),
        summary: vec![told.tracking()],
        scene,
        sections: vec![Section {
            title: "What ran".into(),
            tables: vec![told.table()],
            ..Section::default()
        }],
    };
    Ok(page.html())
}

fn written(args: &ControlArgs, global: &Global) -> Result<Option<Written>, Failure> {
    let Some(out) = &args.out else {
        return Ok(None);
    };
    refuse_existing([out.as_path()], global)?;
    let format = Written::of(out).ok_or_else(|| {
        let message = format!("`{}` says no format that can be written", out.display());
        Failure::usage(message).hint("write .bvh, .csv, .parquet or .npz")
    })?;
    Ok(Some(format))
}
