//! What is on the page.

use kineme::retargeting::RoleMap;
use kineme::{Motion, Recording, Vocabulary};
use kineme_paper::figures::counted;
use kineme_paper::scene::{
    CardBudget, HOW_TO_READ, Shape, Shown, actor, actor_of_recording, cards,
};
use kineme_report::scene::{Scene, Take};
use kineme_report::{Page, Section, Table, short_names};

use crate::args::ViewArgs;
use crate::bodies;
use crate::describe::short;
use crate::failure::Failure;
use crate::source::{Source, print_warnings};

/// Bytes of page for all motions together.
const BYTES: usize = 9_000_000;
/// How far apart bodies stand that are shown beside each other, metres.
const BESIDE_M: f64 = 1.2;

/// A motion as read, and on the body that was asked for.
struct Taken {
    recording: Recording,
    roles: Option<RoleMap>,
    motion: Option<Motion>,
    warnings: Vec<String>,
}

/// A page of motions; beside it the exit code.
pub fn of_motions(args: &ViewArgs) -> Result<(Page, u8), Failure> {
    let wanted = args.body.as_deref().map(bodies::any).transpose()?;
    let source = Source::open(&args.inputs, &args.read)?;
    let entries: Vec<_> = source.inputs.entries.iter().collect();
    let read = source.each(&entries, "reading", |_, entry| {
        let recording = source.read(entry)?;
        let (motion, warnings) = match &wanted {
            Some(body) => {
                let (motion, warnings) = source.retarget(&recording, body)?;
                (Some(motion), warnings)
            }
            None => (None, recording.source().warnings.clone()),
        };
        let jointed = source.jointed(&recording)?;
        let joints = jointed.recording.joints().iter();
        let names: Vec<&str> = joints.map(|j| j.name.as_str()).collect();
        let roles = match &jointed.profile {
            Some(given) => Some(given.matched(&names)),
            None => RoleMap::detect(&names).ok(),
        };
        Ok(Taken {
            recording: jointed.recording.into_owned(),
            roles,
            motion,
            warnings,
        })
    });
    print_warnings(
        read.items
            .iter()
            .map(|t| (t.recording.name(), t.warnings.as_slice())),
    );
    let read = read.unless_failed()?;
    let page = page_of(&read.items);
    Ok((page, read.print_skipped()))
}

fn page_of(taken: &[Taken]) -> Page {
    let size = |t: &Taken| {
        let own = Shape::of_recording(&t.recording, t.roles.as_ref())
            .body
            .points;
        let on_body = t
            .motion
            .as_ref()
            .map_or(0, |m| Shape::of(m.skeleton()).body.points);
        (t.recording.duration_secs(), own + on_body)
    };
    let sizes: Vec<(f64, usize)> = taken.iter().map(size).collect();
    let shown = Shown::within(BYTES, &sizes);
    let mut scene = Scene::default();
    let names: Vec<&str> = taken.iter().map(|t| t.recording.name()).collect();
    for (t, name) in taken.iter().zip(short_names(&names)).take(shown.takes) {
        let take = take(&mut scene, t, shown.rate_hz);
        scene.takes.push(Take { name, ..take });
    }
    let title = match taken {
        [one] => one.recording.name().to_owned(),
        all => format!("{} motions", all.len()),
    };
    let mut summary = Vec::new();
    if let [one] = taken {
        summary.push(facts(&one.recording));
    }
    if shown.takes < taken.len() {
        summary.push(format!(
            "To keep this page small, the first {} of {} motions play on it, {} frames a second of each.",
            shown.takes,
            taken.len(),
            short(shown.rate_hz)
        ));
    }
    Page {
        title,
        summary,
        scene,
        sections: match taken {
            [_] => Vec::new(),
            all => vec![Section {
                title: "Files".into(),
                tables: vec![table(all)],
                ..Section::default()
            }],
        },
    }
}

fn take(scene: &mut Scene, taken: &Taken, most_hz: f64) -> Take {
    let recording = &taken.recording;
    let own = actor_of_recording(
        scene,
        "as recorded",
        recording,
        taken.roles.as_ref(),
        most_hz,
    );
    let mut note = String::new();
    if own.rate_hz < recording.rate_hz() - 1e-6 {
        note = format!(
            "shown at {} of {} frames a second",
            short(own.rate_hz),
            short(recording.rate_hz())
        );
    }
    let mut actors = vec![own];
    if let Some(motion) = &taken.motion {
        let mut on_body = actor(scene, motion.skeleton().name(), motion, most_hz);
        on_body.colour = Some(0);
        on_body.aside = [0.0, BESIDE_M, 0.0];
        actors.push(on_body);
    }
    Take {
        name: recording.name().into(),
        note,
        secs: recording.duration_secs(),
        actors,
        tracks: Vec::new(),
    }
}

fn facts(recording: &Recording) -> String {
    format!(
        "{}, {} at {} Hz, {:.2} s ({}).",
        counted(recording.joints().len(), "joint"),
        counted(recording.frames(), "frame"),
        short(recording.rate_hz()),
        recording.duration_secs(),
        recording.source().format.name()
    )
}

fn table(taken: &[Taken]) -> Table {
    let row = |t: &Taken| {
        let r = &t.recording;
        vec![
            r.name().to_owned(),
            r.source().format.name().to_owned(),
            r.joints().len().to_string(),
            r.frames().to_string(),
            short(r.rate_hz()),
            format!("{:.2}", r.duration_secs()),
        ]
    };
    Table {
        caption: "The motions, as they were read.".into(),
        header: [
            "motion", "format", "joints", "frames", "rate, Hz", "seconds",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: taken.iter().map(row).collect(),
    }
}

/// A page of a vocabulary.
pub fn of_vocabulary(vocabulary: &Vocabulary, name: &str) -> Result<Page, Failure> {
    let mut scene = Scene::default();
    let budget = CardBudget {
        bytes: BYTES,
        ..CardBudget::default()
    };
    let (cards, left_out) = cards(&mut scene, vocabulary, &budget)?;
    scene.primitives = cards;
    scene.vocabulary = name.into();
    let section = Section {
        title: "Primitives".into(),
        text: vec![HOW_TO_READ.into()],
        cards: 0..scene.primitives.len(),
        ..Section::default()
    };
    let all = vocabulary.primitives().len();
    let exemplars: usize = vocabulary
        .primitives()
        .iter()
        .map(|p| p.exemplars().len())
        .sum();
    let mut summary = vec![format!(
        "{} of {}, of the body {}.",
        counted(all, "primitive"),
        counted(exemplars, "exemplar"),
        vocabulary.body().name()
    )];
    if left_out > 0 {
        summary.push(format!("The first {} of them are shown.", all - left_out));
    }
    Ok(Page {
        title: name.into(),
        summary,
        scene,
        sections: vec![section],
    })
}
