//! `kineme demo`: what kineme does, on motion that comes with it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use kineme_paper::demo::{self, Demo, DemoSettings, Found};
use kineme_paper::show::PLANS;
use kineme_paper::table1::{Measure, Mode, Row};

use crate::args::{DemoArgs, Global};
use crate::failure::{Failure, print};
use crate::findings::Findings;
use crate::outputs::{existing, refuse_existing, unwritten};
use crate::progress;
use crate::table::{Side, aligned};

pub fn run(args: &DemoArgs, global: &Global) -> Result<u8, Failure> {
    let files: Vec<PathBuf> = Demo::files().iter().map(|f| args.out.join(f)).collect();
    refuse_existing(files.iter().map(PathBuf::as_path), global)?;
    let spinner = progress::spinner();
    let settings = DemoSettings {
        seed: global.seed,
        ..DemoSettings::default()
    };
    let made = demo::run(&settings, &mut |step| spinner.set_message(step.name()));
    spinner.set_message("writing the page");
    let written = made.map(|made| (made.write(&args.out, existing(global)), made));
    spinner.finish_and_clear();
    let (page, made) = written.map_err(|e| Failure::failed(e.to_string()))?;
    let page = page.map_err(unwritten)?;
    if global.json {
        let findings = Findings {
            derived: &made.found.derived,
            motions: &made.found.motions,
            seconds: None,
        };
        print(findings.json()?.as_bytes())?;
        return Ok(0);
    }
    let file = |name: &str| args.out.join(name).display().to_string();
    let (movements, boxing) = (file(demo::MOVEMENTS_KNOWN), file(demo::BOXING));
    let text = format!(
        "{}\n{}\nOpen this page in a browser; everything on it moves:\n\n  {}\n\nNext:\n\n  \
         kineme view {movements}\n  kineme classify {boxing} {}\n  kineme control {movements} {} --body adonis\n",
        shown(&made),
        told(&made.found),
        page.display(),
        file(demo::ATTACKER),
        file(PLANS[0].0),
    );
    print(text.as_bytes())?;
    Ok(0)
}

/// What bodies did with written primitives, and what was seen of it.
fn shown(found: &Demo) -> String {
    let show = &found.show;
    let moved = show.routine.iter().map(|performance| {
        let body = performance.done.skeleton();
        let how = match show.physics {
            true => format!(
                "in physics, within {:.2} degrees of what it was told (root mean square)",
                performance.tracking.rms_rad.to_degrees()
            ),
            false => "without physics".into(),
        };
        format!(
            "  {} ({} degrees of freedom): a routine of {:.0} s, {how}\n",
            body.name(),
            body.dof(),
            performance.done.duration_secs()
        )
    });
    let answered = show.bout.ran.iter().map(|ran| ran.start_secs);
    let attacks = &show.attacker.attacks;
    let answers: Vec<String> = attacks
        .iter()
        .map(|attack| {
            let span = attack.start_secs..attack.end_secs;
            match answered.clone().find(|at| span.contains(at)) {
                Some(at) => format!("{} after {:.2} s", attack.primitive, at - attack.start_secs),
                None => format!("{} missed", attack.primitive),
            }
        })
        .collect();
    let filter = |row: &&Row| row.mode == Mode::FILTER;
    let judged = found.table.iter().filter(filter).map(|row| {
        let percent = |measure| row.measure(measure).map(|e| 100.0 * e.value);
        let accuracy = percent(Measure::Accuracy).unwrap_or(f64::NAN);
        let recall =
            percent(Measure::Recall).map_or(String::new(), |r| format!(", recall {r:.1} %"));
        let never = percent(Measure::Never).unwrap_or(f64::NAN);
        format!(
            "  {}: accuracy {accuracy:.2} % ({never:.2} % for always denying){recall}\n",
            row.set
        )
    });
    format!(
        "{} primitives of exemplars written by hand move two bodies:\n\n{}\nThe same primitives recognise what is done:\n\n  \
         sparring: adonis answers {}\n{}",
        show.movements.primitives().len(),
        moved.collect::<String>(),
        answers.join(", "),
        judged.collect::<String>()
    )
}

/// What was found in the session, movement by movement as it was choreographed.
fn told(found: &Found) -> String {
    let mut movements: BTreeMap<&str, BTreeMap<&str, Vec<String>>> = BTreeMap::new();
    for (group, (kind, count)) in found.derived.groups.iter().zip(&found.names) {
        let (movement, stroke) = kind.split_once(' ').unwrap_or((kind, ""));
        let all = group.segments.len();
        let name = match all == *count {
            true => group.name.clone(),
            false => format!("{} ({count} of {all})", group.name),
        };
        let strokes = movements.entry(movement).or_default();
        strokes.entry(stroke).or_default().push(name);
    }
    let row = |(movement, strokes): (&&str, &BTreeMap<&str, Vec<String>>)| {
        let strokes = strokes
            .iter()
            .map(|(stroke, groups)| format!("{stroke}: {}", groups.join(" ")));
        vec![
            (*movement).to_owned(),
            strokes.collect::<Vec<_>>().join(", "),
        ]
    };
    let rows: Vec<Vec<String>> = movements.iter().map(row).collect();
    let left_over = found.derived.labels.iter().filter(|l| l.is_none()).count();
    format!(
        "In a session of {} recordings, told nothing, the derivation cut {} segments and found {} groups ({left_over} left \
         over).\nBeside what was choreographed, purity {:.2}, adjusted Rand index {:.2}:\n\n{}",
        found.motions.len(),
        found.derived.segments.len(),
        found.derived.groups.len(),
        found.strokes.purity,
        found.strokes.ari,
        aligned(&[("movement", Side::Left), ("found as", Side::Left)], &rows)
    )
}
