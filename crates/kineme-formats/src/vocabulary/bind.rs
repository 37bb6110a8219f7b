//! Between the library's [`Vocabulary`] and its file.

use std::sync::Arc;

use kineme::motion::landmark_dims;
use kineme::primitive::{Calibration, Group, Used};
use kineme::{
    Behavior, Exemplar, Motion, Primitive, Provenance, Root, Skeleton, Transitions, Vocabulary,
    body,
};
use nalgebra::Vector3;

use super::{
    BehaviorMeta, CalibratedMeta, CalibrationMeta, ExemplarMeta, ExemplarTensors, FitTensors,
    GroupMeta, PrimitiveMeta, TransitionMeta, VocabularyFile, VocabularyMeta,
};
use crate::error::{FormatError, Place, Result};

/// A vocabulary as the bytes of a file named `name` in messages; the same vocabulary gives the same bytes.
///
/// # Errors
/// When the body is none that [`kineme::body`] knows by its name, when there is no primitive, a name is blank, or a
/// warp wraps in a primitive that does not, or the other way round.
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
    let wraps = |p: &Primitive| {
        p.fitted()
            .warps
            .iter()
            .all(|w| w.is_closed() == p.is_cyclic())
    };
    if let Some(p) = vocabulary.primitives().iter().find(|p| !wraps(p)) {
        let found = format!("open and closed warps in the primitive `{}`", p.name());
        let expected = "closed warps where phase wraps, and only there";
        return Err(FormatError::new(name, Place::File, found, expected));
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
    let landmarks = landmark_dims(&skeleton);
    let coordinates = &file.meta.coordinates;
    if skeleton.coordinate_names() != *coordinates || file.meta.landmarks != landmarks as u64 {
        return Err(FormatError::new(
            name,
            Place::File,
            format!(
                "{} coordinates and {} numbers of landmarks",
                coordinates.len(),
                file.meta.landmarks
            ),
            format!(
                "the {} and {landmarks} of the body `{}`",
                skeleton.dof(),
                skeleton.name()
            ),
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
    let mut movements = file.exemplars.into_iter();
    let fits = file.fits.into_iter();
    let primitives = file
        .meta
        .primitives
        .into_iter()
        .zip(fits)
        .map(|(meta, fit)| {
            let movements = movements.by_ref().take(meta.exemplars.len()).collect();
            primitive(meta, fit, movements, &skeleton)
        });
    let primitives = primitives.collect::<kineme::Result<_>>().map_err(refused)?;
    let vocabulary = Vocabulary::new(
        Arc::clone(&skeleton),
        primitives,
        behaviors.collect(),
        transitions,
    );
    let calibrations = file.meta.calibrations.into_iter().map(|c| Calibration {
        recogniser: c.recogniser,
        primitives: c.primitives.into_iter().map(|p| p.numbers).collect(),
        shared: c.shared,
    });
    calibrations
        .fold(vocabulary, |v, calibration| v?.calibrated(calibration))
        .map_err(refused)
}

fn primitive(
    meta: PrimitiveMeta,
    tensors: FitTensors,
    movements: Vec<ExemplarTensors>,
    skeleton: &Arc<Skeleton>,
) -> kineme::Result<Primitive> {
    let used = meta.exemplars.iter().map(|e| Used {
        start: e.used[0],
        end: e.used[1],
        shift: e.shift,
    });
    let used = used.collect();
    let (mut exemplars, mut warps) = (Vec::new(), Vec::new());
    for (meta, movement) in meta.exemplars.into_iter().zip(movements) {
        exemplars.push(exemplar(meta, movement.poses, &movement.root, skeleton)?);
        warps.push(movement.warp);
    }
    let group = meta.group.map(|g| Group {
        members: g.members as usize,
        coherence: g.coherence,
    });
    Primitive::from_fit(
        &meta.name,
        exemplars,
        meta.fit.with(tensors, used, warps)?,
        group,
    )
}

fn exemplar(
    meta: ExemplarMeta,
    poses: Vec<f64>,
    root: &[[f64; 4]],
    skeleton: &Arc<Skeleton>,
) -> kineme::Result<Exemplar> {
    let roots = root.iter().map(|&[x, y, z, yaw]| Root {
        position: Vector3::new(x, y, z),
        yaw,
    });
    Ok(Exemplar {
        motion: Motion::new(
            meta.motion.as_str(),
            Arc::clone(skeleton),
            meta.rate_hz,
            poses,
            roots.collect(),
        )?,
        provenance: Provenance {
            motion: meta.motion,
            start_secs: meta.start_secs,
            end_secs: meta.end_secs,
            blake3: meta.blake3,
        },
        adverbs: meta.adverbs,
    })
}

fn file_of(vocabulary: &Vocabulary) -> VocabularyFile {
    let primitives = vocabulary.primitives();
    let transitions = vocabulary.transitions();
    let pairs = (0..transitions.n).flat_map(|from| (0..transitions.n).map(move |to| (from, to)));
    VocabularyFile {
        exemplars: primitives.iter().flat_map(exemplar_tensors).collect(),
        fits: primitives
            .iter()
            .map(|p| FitTensors::of(p.fitted()))
            .collect(),
        meta: VocabularyMeta {
            program: concat!("kineme ", env!("CARGO_PKG_VERSION")).into(),
            body: vocabulary.body().name().into(),
            coordinates: vocabulary.body().coordinate_names(),
            landmarks: landmark_dims(vocabulary.body()) as u64,
            primitives: primitives.iter().map(primitive_meta).collect(),
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
                    from: primitives[from].name().into(),
                    to: primitives[to].name().into(),
                    count: transitions.count(from, to),
                })
                .filter(|t| t.count > 0)
                .collect(),
            calibrations: vocabulary
                .calibrations()
                .iter()
                .map(|c| calibration_meta(c, primitives))
                .collect(),
        },
    }
}

fn calibration_meta(calibration: &Calibration, primitives: &[Primitive]) -> CalibrationMeta {
    let numbers = primitives.iter().zip(&calibration.primitives);
    CalibrationMeta {
        recogniser: calibration.recogniser.clone(),
        primitives: numbers
            .map(|(primitive, numbers)| CalibratedMeta {
                name: primitive.name().into(),
                numbers: numbers.clone(),
            })
            .collect(),
        shared: calibration.shared.clone(),
    }
}

fn primitive_meta(primitive: &Primitive) -> PrimitiveMeta {
    let fit = primitive.fitted();
    let exemplars = primitive.exemplars().iter().zip(&fit.used);
    PrimitiveMeta {
        name: primitive.name().into(),
        group: primitive.group().map(|g| GroupMeta {
            members: g.members as u64,
            coherence: g.coherence,
        }),
        fit: fit.into(),
        exemplars: exemplars
            .map(|(e, used)| ExemplarMeta {
                motion: e.provenance.motion.clone(),
                start_secs: e.provenance.start_secs,
                end_secs: e.provenance.end_secs,
                rate_hz: e.motion.rate_hz(),
                blake3: e.provenance.blake3.clone(),
                adverbs: e.adverbs.clone(),
                used: [used.start, used.end],
                shift: used.shift,
            })
            .collect(),
    }
}

fn exemplar_tensors(primitive: &Primitive) -> impl Iterator<Item = ExemplarTensors> + '_ {
    let warps = primitive.fitted().warps.iter();
    primitive.exemplars().iter().zip(warps).map(|(e, warp)| {
        let roots = e.motion.roots().iter();
        ExemplarTensors {
            poses: e.motion.poses().to_vec(),
            root: roots
                .map(|r| [r.position.x, r.position.y, r.position.z, r.yaw])
                .collect(),
            warp: warp.places().to_vec(),
        }
    })
}
