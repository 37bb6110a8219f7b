//! `kineme learn`: labelled motions to a vocabulary, the manual determination.

use std::sync::Arc;

use kineme::{Behavior, Modelling, Transitions, Vocabulary};

use crate::args::{Global, LearnArgs};
use crate::bodies::built_in;
use crate::describe;
use crate::failure::Failure;
use crate::labelled::{Example, Manifest};
use crate::vocabularies::{
    self, Lesson, calibrated, check_cyclic, check_out, learn, modelling, print_notes,
};

pub fn run(args: &LearnArgs, global: &Global) -> Result<u8, Failure> {
    check_out(&args.out, "vocabulary", global)?;
    let body = built_in(&args.body)?;
    let modelling = modelling(&args.model, &body)?;
    let manifest = Manifest::open(&args.manifest, args.root.as_deref())?;
    let labels = manifest.labels();
    check_cyclic(&args.model, &labels)?;
    let mut read = manifest.examples(&body, &args.read)?;
    let mut lessons: Vec<Lesson> = labels
        .iter()
        .map(|label| Lesson {
            name: (*label).into(),
            exemplars: Vec::new(),
            places: Vec::new(),
            modelling: Modelling {
                cyclic: args.model.cyclic.iter().any(|c| c == label).then_some(true),
                ..modelling.clone()
            },
        })
        .collect();
    for Example {
        label,
        exemplar,
        place,
    } in std::mem::take(&mut read.items)
    {
        if let Some(lesson) = lessons.iter_mut().find(|l| l.name == label) {
            lesson.exemplars.push(exemplar);
            lesson.places.push(Some(place));
        }
    }
    // Labels all of whose motions were skipped.
    lessons.retain(|lesson| !lesson.exemplars.is_empty());
    let (primitives, left_out) = learn(lessons, args.read.keep_going)?;
    read.skip(left_out);
    print_notes(&primitives, false);
    let behaviors = primitives.iter().map(|p| Behavior {
        name: p.name().into(),
        primitives: vec![p.name().into()],
    });
    let behaviors = behaviors.collect();
    let transitions = Transitions::observed(&primitives);
    let vocabulary = Vocabulary::new(Arc::clone(&body), primitives, behaviors, transitions)?;
    let vocabulary = calibrated(vocabulary, None)?;
    let told = describe::all(&vocabulary, &args.out.display().to_string(), global)?;
    vocabularies::write(&vocabulary, &args.out, &told, global)?;
    Ok(read.print_skipped())
}
