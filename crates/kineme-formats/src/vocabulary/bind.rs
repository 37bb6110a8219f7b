//! Between the library's [`Vocabulary`] and its file.

use std::sync::Arc;

use kineme::{
    Behavior, Exemplar, Motion, Primitive, Provenance, Root, Transitions, Vocabulary, body,
};
use nalgebra::Vector3;

use super::{
    BehaviorMeta, ExemplarFrames, ExemplarMeta, PrimitiveMeta, TransitionMeta, VocabularyFile,
    VocabularyMeta,
};
use crate::error::{FormatError, Place, Result};

/// A vocabulary as the bytes of a file named `name` in messages; the same vocabulary gives the same bytes.
///
/// # Errors
/// When the body is none that [`kineme::body`] knows by its name, when there is no primitive, or a name is blank.
pub fn write(vocabulary: &Vocabulary, name: &str) -> Result<Vec<u8>> {
    let skeleton = vocabulary.body();
    if !body(skeleton.name()).is_ok_and(|known| known == **skeleton) {
        return Err(FormatError::new(
            name,
            Place::File,
            format!("the body `{}`", skeleton.name()),
            "a body known by its name",
        ));
    }
    file_of(vocabulary).write(name)
}

/// Reads the vocabulary in a file named `name` in messages: what [`write()`] wrote, bit for bit.
///
/// # Errors
/// When the file is damaged or invalid, when its body is not known, or has other coordinates than the file says.
pub fn read(name: &str, bytes: &[u8]) -> Result<Vocabulary> {
    let file = VocabularyFile::parse(name, bytes)?;
    let refused =
        |e: kineme::Error| FormatError::new(name, Place::File, e.to_string(), "a valid vocabulary");
    let skeleton = Arc::new(body(&file.meta.body).map_err(refused)?);
    if skeleton.coordinate_names() != file.meta.coordinates {
        return Err(FormatError::new(
            name,
            Place::File,
            format!("{} coordinates", file.meta.coordinates.len()),
            format!("the {} of the body `{}`", skeleton.dof(), skeleton.name()),
        ));
    }
    let place = |primitive: &str| {
        file.meta
            .primitives
            .iter()
            .position(|p| p.name == primitive)
    };
    let mut transitions = Transitions::none(file.meta.primitives.len());
    for t in &file.meta.transitions {
        if let (Some(from), Some(to)) = (place(&t.from), place(&t.to)) {
            transitions.counts[from * transitions.n + to] = t.count;
        }
    }
    let behaviors = file.meta.behaviors.into_iter().map(|b| Behavior {
        name: b.name,
        primitives: b.groups,
    });
    let mut frames = file.exemplars.into_iter();
    let primitives = file.meta.primitives.into_iter().map(|p| {
        let exemplars = p.exemplars.into_iter().zip(&mut frames);
        Ok(Primitive {
            name: p.name,
            exemplars: exemplars
                .map(|(meta, frames)| exemplar(meta, frames, &skeleton))
                .collect::<kineme::Result<_>>()?,
            members: p.members as usize,
            coherence: p.coherence,
        })
    });
    let primitives = primitives.collect::<kineme::Result<_>>().map_err(refused)?;
    Vocabulary::new(
        Arc::clone(&skeleton),
        primitives,
        behaviors.collect(),
        transitions,
    )
    .map_err(refused)
}

fn exemplar(
    meta: ExemplarMeta,
    frames: ExemplarFrames,
    skeleton: &Arc<kineme::Skeleton>,
) -> kineme::Result<Exemplar> {
    let roots = frames.root.iter().map(|&[x, y, z, yaw]| Root {
        position: Vector3::new(x, y, z),
        yaw,
    });
    Ok(Exemplar {
        motion: Motion::new(
            meta.motion.as_str(),
            Arc::clone(skeleton),
            meta.rate_hz,
            frames.poses,
            roots.collect(),
        )?,
        provenance: Provenance {
            motion: meta.motion,
            start_secs: meta.start_secs,
            end_secs: meta.end_secs,
            blake3: meta.blake3,
        },
    })
}

fn file_of(vocabulary: &Vocabulary) -> VocabularyFile {
    let primitives = vocabulary.primitives();
    let exemplars = primitives.iter().flat_map(|p| &p.exemplars);
    let transitions = vocabulary.transitions();
    let pairs = (0..transitions.n).flat_map(|from| (0..transitions.n).map(move |to| (from, to)));
    VocabularyFile {
        exemplars: exemplars.map(|e| frames_of(&e.motion)).collect(),
        meta: VocabularyMeta {
            program: concat!("kineme ", env!("CARGO_PKG_VERSION")).into(),
            body: vocabulary.body().name().into(),
            coordinates: vocabulary.body().coordinate_names(),
            primitives: primitives
                .iter()
                .map(|p| PrimitiveMeta {
                    name: p.name.clone(),
                    members: p.members as u64,
                    coherence: p.coherence,
                    exemplars: p.exemplars.iter().map(exemplar_meta).collect(),
                })
                .collect(),
            behaviors: vocabulary
                .behaviors()
                .iter()
                .map(|b| BehaviorMeta {
                    name: b.name.clone(),
                    groups: b.primitives.clone(),
                })
                .collect(),
            transitions: pairs
                .map(|(from, to)| TransitionMeta {
                    from: primitives[from].name.clone(),
                    to: primitives[to].name.clone(),
                    count: transitions.count(from, to),
                })
                .filter(|t| t.count > 0)
                .collect(),
        },
    }
}

fn exemplar_meta(exemplar: &Exemplar) -> ExemplarMeta {
    let from = &exemplar.provenance;
    ExemplarMeta {
        motion: from.motion.clone(),
        start_secs: from.start_secs,
        end_secs: from.end_secs,
        rate_hz: exemplar.motion.rate_hz(),
        blake3: from.blake3.clone(),
    }
}

fn frames_of(motion: &Motion) -> ExemplarFrames {
    ExemplarFrames {
        poses: motion.poses().to_vec(),
        root: motion
            .roots()
            .iter()
            .map(|r| [r.position.x, r.position.y, r.position.z, r.yaw])
            .collect(),
    }
}
