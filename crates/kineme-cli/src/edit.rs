//! `kineme edit`: what a person changes after looking.

use kineme::primitive::{self, ParameterSource, Parameterisation};
use kineme::{Exemplar, Modelling, Primitive};

use crate::args::{EditArgs, Global, Merging};
use crate::describe;
use crate::draft::Draft;
use crate::failure::{Failure, complain};
use crate::labelled::{Example, Manifest};
use crate::source::Read;
use crate::vocabularies::{
    self, Lesson, calibrated, check_cyclic, check_out, learn, modelling, print_notes, read,
};

pub fn run(args: &EditArgs, global: &Global) -> Result<u8, Failure> {
    let nothing = args.rename.is_empty() && args.merge.is_empty() && args.remove.is_empty();
    if nothing && args.add.is_none() {
        return Err(Failure::usage("nothing to change")
            .hint("--rename A=B, --merge A,B=C, --remove A or --add MANIFEST.csv"));
    }
    check_out(&args.out, "vocabulary", global)?;
    let vocabulary = read(&args.vocabulary)?;
    let mut editor = Editor {
        args,
        draft: Draft::of(&vocabulary),
        wanted: modelling(&args.model, vocabulary.body())?,
        modelled: Vec::new(),
        left_out: Vec::new(),
    };
    editor.draft.rename(&args.rename)?;
    for merging in &args.merge {
        editor.merge(merging)?;
    }
    let mut removed = Vec::new();
    for name in &args.remove {
        removed.push(editor.draft.place(name)?);
    }
    editor.draft.remove(&removed);
    let mut skipped = None;
    if let Some(path) = &args.add {
        let manifest = Manifest::open(path, args.root.as_deref())?;
        skipped = Some(editor.add(&manifest, vocabulary.body())?);
    }
    let modelled: Vec<&str> = editor.modelled.iter().map(String::as_str).collect();
    check_cyclic(&args.model, &modelled)?;
    let edited = calibrated(editor.draft.finished()?, Some(&vocabulary))?;
    let changed = edited.primitives().iter();
    print_notes(
        changed.filter(|p| editor.modelled.iter().any(|m| m == p.name())),
        false,
    );
    let told = describe::all(&edited, &args.out.display().to_string(), global)?;
    vocabularies::write(&edited, &args.out, &told, global)?;
    let count = editor.left_out.len();
    let mut read = skipped.unwrap_or_else(|| Read::nothing(count));
    read.skip(editor.left_out);
    Ok(read.print_skipped())
}

/// A vocabulary under change.
struct Editor<'a> {
    args: &'a EditArgs,
    draft: Draft,
    /// What the command line says of modelling.
    wanted: Modelling,
    /// Names of primitives that were modelled anew.
    modelled: Vec<String>,
    /// Exemplars that were left out.
    left_out: Vec<Failure>,
}

impl Editor<'_> {
    /// Makes one primitive of several.
    fn merge(&mut self, merging: &Merging) -> Result<(), Failure> {
        let mut places = Vec::new();
        for name in &merging.from {
            let place = self.draft.place(name)?;
            if places.contains(&place) {
                return Err(Failure::usage(format!("`{name}` is merged with itself")));
            }
            places.push(place);
        }
        let all = self.draft.primitives();
        let taken = all.iter().position(|p| p.name() == merging.to);
        if taken.is_some_and(|at| !places.contains(&at)) {
            return Err(Failure::usage(format!(
                "`{}` exists already, and is none of those to merge",
                merging.to
            )));
        }
        let merged: Vec<&Primitive> = places.iter().map(|&i| &all[i]).collect();
        let mut lesson = self.lesson(&merging.to, merged[0]);
        let kinds: Vec<bool> = merged.iter().map(|p| p.is_cyclic()).collect();
        if kinds.iter().any(|&k| k != kinds[0]) && !self.args.model.cyclic.contains(&merging.to) {
            lesson.modelling.cyclic = None;
        }
        lesson.exemplars = merged.iter().flat_map(|p| p.exemplars()).cloned().collect();
        lesson.places = vec![None; lesson.exemplars.len()];
        let names: Vec<Vec<String>> = merged.iter().map(|p| adverb_names(p)).collect();
        if names.iter().any(|n| *n != names[0]) {
            let told = |n: &Vec<String>| match n.len() {
                0 => "none".into(),
                _ => n.join(" and "),
            };
            let told: Vec<String> = names.iter().map(told).collect();
            complain(&format!(
                "note: `{}`: the adverbs of its parts differ ({}) and are dropped",
                merging.to,
                told.join("; ")
            ));
            lesson.modelling.adverbs.clear();
            for exemplar in &mut lesson.exemplars {
                exemplar.adverbs = None;
            }
        }
        let members: Option<usize> = merged.iter().map(|p| p.group().map(|g| g.members)).sum();
        let mut primitive = self.learn(lesson)?;
        if let Some(members) = members {
            // How coherent they are together nobody has measured.
            primitive = primitive.of_group(primitive::Group {
                members,
                coherence: None,
            });
        }
        self.draft.merge(&places, primitive);
        Ok(())
    }

    /// Adds labelled motions to primitives of these names, or as new ones; what of them was skipped.
    fn add(
        &mut self,
        manifest: &Manifest,
        body: &std::sync::Arc<kineme::Skeleton>,
    ) -> Result<Read<Example>, Failure> {
        for primitive in self.draft.primitives() {
            let names = adverb_names(primitive);
            let other = manifest
                .rows_of(primitive.name())
                .find(|row| row.parameters.len() != names.len());
            if let Some(row) = other {
                return Err(Failure::unreadable(format!(
                    "{}: found {} parameters of `{}`, expected {}{}",
                    manifest.place(row),
                    row.parameters.len(),
                    primitive.name(),
                    names.len(),
                    match names.len() {
                        0 => String::new(),
                        _ => format!(" ({})", names.join(", ")),
                    }
                )));
            }
        }
        let mut read = manifest.examples(body, &self.args.read)?;
        let examples = std::mem::take(&mut read.items);
        let mut again = 0;
        for label in manifest.labels() {
            let known = self.draft.primitives().iter().find(|p| p.name() == label);
            let mut lesson = match known {
                Some(known) => Lesson {
                    exemplars: known.exemplars().to_vec(),
                    places: vec![None; known.exemplars().len()],
                    ..self.lesson(label, known)
                },
                None => Lesson {
                    name: label.into(),
                    exemplars: Vec::new(),
                    places: Vec::new(),
                    modelling: Modelling {
                        cyclic: self.declared(label),
                        ..self.wanted.clone()
                    },
                },
            };
            let before = lesson.exemplars.len();
            for example in examples.iter().filter(|e| e.label == label) {
                let new = &example.exemplar;
                let same =
                    |e: &Exemplar| e.provenance == new.provenance && e.adverbs == new.adverbs;
                if lesson.exemplars.iter().any(same) {
                    again += 1;
                    continue;
                }
                lesson.exemplars.push(new.clone());
                lesson.places.push(Some(example.place.clone()));
            }
            let added = lesson.exemplars.len() - before;
            if added == 0 {
                continue;
            }
            let group = known.and_then(|p| p.group().copied());
            let mut primitive = self.learn(lesson)?;
            if let Some(group) = group {
                primitive = primitive.of_group(primitive::Group {
                    members: group.members + added,
                    coherence: None,
                });
            }
            self.draft.put(primitive);
        }
        if again > 0 {
            complain(&format!(
                "note: {again} of the motions to add are exemplars already and stay as they are"
            ));
        }
        Ok(read)
    }

    /// An empty lesson for a primitive that was modelled before, in the manner in which it was unless the command line
    /// says another.
    fn lesson(&self, name: &str, before: &Primitive) -> Lesson {
        let parameterisation = match (&self.args.model.parameters, before.parameters().source()) {
            (Some(_), _) => self.wanted.parameterisation.clone(),
            (None, ParameterSource::Adverbs) => Parameterisation::Automatic,
            (None, ParameterSource::Principal { .. }) => Parameterisation::Principal,
            (None, ParameterSource::Effector { effector, .. }) => {
                Parameterisation::Effector(effector.clone())
            }
        };
        Lesson {
            name: name.into(),
            exemplars: Vec::new(),
            places: Vec::new(),
            modelling: Modelling {
                parameterisation,
                adverbs: adverb_names(before),
                cyclic: self.declared(name).or(Some(before.is_cyclic())),
                ..self.wanted.clone()
            },
        }
    }

    fn declared(&self, name: &str) -> Option<bool> {
        let named = self.args.model.cyclic.iter().any(|c| c == name);
        named.then_some(true)
    }

    fn learn(&mut self, lesson: Lesson) -> Result<Primitive, Failure> {
        self.modelled.push(lesson.name.clone());
        let (mut primitives, left_out) = learn(vec![lesson], self.args.read.keep_going)?;
        self.left_out.extend(left_out);
        // One lesson makes one primitive.
        Ok(primitives.swap_remove(0))
    }
}

/// The names of the adverbs that exemplars were given, also of those that became no parameter because they never vary.
fn adverb_names(primitive: &Primitive) -> Vec<String> {
    let rows: Vec<&[f64]> = primitive
        .exemplars()
        .iter()
        .filter_map(|e| e.adverbs.as_deref())
        .collect();
    let count = rows.first().map_or(0, |row| row.len());
    let from_adverbs = *primitive.parameters().source() == ParameterSource::Adverbs;
    let mut named = primitive
        .parameters()
        .axes()
        .iter()
        .filter(|_| from_adverbs);
    let varies = |d: usize| rows.iter().any(|row| row[d] != rows[0][d]);
    (0..count)
        .map(|d| {
            let name = if varies(d) { named.next() } else { None };
            name.map_or_else(|| format!("p{}", d + 1), |axis| axis.name.clone())
        })
        .collect()
}
