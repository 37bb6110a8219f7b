//! `kineme demo`: the choreographed session, from motion to vocabulary to page.

use std::path::PathBuf;

use kineme_paper::demo::{self, Demo, Found, VOCABULARY};
use kineme_paper::show::PLANS;

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
    let found = demo::run(global.seed, &mut |stage| spinner.set_message(stage.name()));
    spinner.finish_and_clear();
    let found = found.map_err(|e| Failure::failed(e.to_string()))?;
    let page = found
        .write(&args.out, existing(global))
        .map_err(unwritten)?;
    let findings = Findings {
        derived: &found.found.derived,
        motions: &found.found.motions,
        seconds: None,
    };
    if global.json {
        print(findings.json()?.as_bytes())?;
        return Ok(0);
    }
    let text = format!(
        "{}\nA choreographed session of {} recordings, {} movements in {} strokes, that recur in varied order, size and \
         speed.\nWhat was found in it without being told:\n\n{}\n{}\nwritten:    {}\nto look at: {}\ntry next:   kineme control {} {} --body adonis\n",
        shown(&found),
        found.found.motions.len(),
        found.found.movements.kinds,
        found.found.strokes.kinds,
        findings.text(),
        judged(&found.found),
        args.out.join(VOCABULARY).display(),
        page.display(),
        args.out.join(demo::MOVEMENTS_KNOWN).display(),
        args.out.join(PLANS[0].0).display()
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
                "in physics, within {:.2} degrees of what it was told",
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
    format!(
        "{} primitives of written exemplars move two bodies and recognise what they do:\n\n{}  sparring: adonis answers {}\n",
        show.movements.primitives().len(),
        moved.collect::<String>(),
        answers.join(", ")
    )
}

/// What was found beside what was choreographed.
fn judged(found: &Found) -> String {
    let rows: Vec<Vec<String>> = found
        .derived
        .groups
        .iter()
        .zip(&found.names)
        .map(|(group, (stroke, count))| {
            let size = group.segments.len();
            vec![
                group.name.clone(),
                format!("{count} of {size}"),
                stroke.clone(),
            ]
        })
        .collect();
    let header = [
        ("group", Side::Left),
        ("of one kind", Side::Right),
        ("which is", Side::Left),
    ];
    let share = |what: &str, m: &demo::Match| {
        format!(
            "{what}: purity {:.2}, adjusted Rand index {:.2} (what is in no group counts against it)\n",
            m.purity, m.ari
        )
    };
    format!(
        "Judged by what was choreographed, which the derivation never saw:\n\n{}\n{}{}",
        aligned(&header, &rows),
        share("groups against strokes     ", &found.strokes),
        share("behaviors against movements", &found.movements)
    )
}
