//! The vocabulary file as a safetensors container: bytes out, bytes in.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use safetensors::tensor::Metadata;
use safetensors::{Dtype, SafeTensorError, SafeTensors, View};
use serde::{Deserialize, Serialize};

use super::check::Flaw;
use super::{
    ExemplarTensors, FitTensors, OLDEST_VERSION, PrimitiveMeta, PrincipalTensors, SourceMeta,
    VERSION, VocabularyFile, VocabularyMeta,
};
use crate::error::{FormatError, Place, Result};

/// The key of the document in the container's metadata.
const KEY: &str = "kineme";

#[derive(Serialize, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Units {
    length: String,
    angle: String,
    time: String,
}

impl Units {
    fn ours() -> Self {
        Self {
            length: "m".to_string(),
            angle: "rad".to_string(),
            time: "s".to_string(),
        }
    }
}

/// The document: `data_blake3` is of the container's bytes after its header, all tensors in the order of their names.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document<M> {
    version: u64,
    units: Units,
    data_blake3: String,
    vocabulary: M,
}

impl VocabularyFile {
    /// The file's bytes: the same vocabulary gives the same bytes. `name` stands in errors.
    ///
    /// # Errors
    /// When the vocabulary breaks a rule that [`Self::parse`] checks.
    pub fn write(&self, name: &str) -> Result<Vec<u8>> {
        self.check().map_err(|flaw| refusal(name, flaw))?;
        let tensors = self.tensors();
        // The container sorts tensors of one type by name, which is the order they already have.
        let mut hasher = blake3::Hasher::new();
        for tensor in tensors.values() {
            hasher.update(&tensor.bytes);
        }
        let document = Document {
            version: VERSION,
            units: Units::ours(),
            data_blake3: hasher.finalize().to_hex().to_string(),
            vocabulary: &self.meta,
        };
        let unwritable = |e: String| refusal(name, (e, "a vocabulary that can be written".into()));
        let json = serde_json::to_string(&document).map_err(|e| unwritable(e.to_string()))?;
        let metadata = HashMap::from([(KEY.to_string(), json)]);
        safetensors::serialize(tensors, Some(metadata)).map_err(|e| unwritable(e.to_string()))
    }

    /// Reads a vocabulary file named `name` in messages.
    ///
    /// # Errors
    /// When the container is damaged, the version or units are not ours, the checksum differs, the document
    /// and the tensors disagree, or a part is invalid: empty or repeated names, names of no primitive,
    /// numbers that are not finite, spans or rates that are not positive.
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self> {
        read(bytes)
            .and_then(|file| file.check().map(|()| file))
            .map_err(|flaw| refusal(name, flaw))
    }

    fn tensors(&self) -> BTreeMap<String, Tensor> {
        let mut tensors = BTreeMap::new();
        let dof = self.meta.coordinates.len();
        for (i, e) in self.exemplars.iter().enumerate() {
            let frames = e.root.len();
            let name = |what| tensor_name(EXEMPLAR, i, what);
            tensors.insert(name(POSES), Tensor::new(&[frames, dof], &e.poses));
            tensors.insert(name(ROOT), Tensor::new(&[frames, 4], e.root.as_flattened()));
            tensors.insert(name(WARP), Tensor::new(&[e.warp.len()], &e.warp));
        }
        let landmarks = self.meta.landmarks as usize;
        for (j, (fit, meta)) in self.fits.iter().zip(&self.meta.primitives).enumerate() {
            let dims = meta.fit.parameters.len();
            let points = Tensor::new(&[meta.exemplars.len(), dims], &fit.points);
            let knots = fit.reference.len() / landmarks;
            let reference = Tensor::new(&[knots, landmarks], &fit.reference);
            let name = |what| tensor_name(PRIMITIVE, j, what);
            tensors.insert(name(POINTS), points);
            tensors.insert(name(REFERENCE), reference);
            if let Some(PrincipalTensors { mean, directions }) = &fit.principal {
                let length = mean.len();
                tensors.insert(name(MEAN), Tensor::new(&[length], mean));
                tensors.insert(name(DIRECTIONS), Tensor::new(&[dims, length], directions));
            }
        }
        tensors
    }
}

fn refusal(name: &str, (found, expected): Flaw) -> FormatError {
    FormatError::new(name, Place::File, found, expected)
}

/// Why bytes are no container: what was cut off begins as one.
fn unreadable(bytes: &[u8], error: &SafeTensorError) -> String {
    match error {
        _ if bytes.is_empty() => "an empty file".into(),
        SafeTensorError::InvalidHeaderLength if bytes.get(8) == Some(&b'{') => {
            "a file that was cut off".into()
        }
        SafeTensorError::MetadataIncompleteBuffer => {
            "a file of another length than its header says".into()
        }
        SafeTensorError::HeaderTooSmall
        | SafeTensorError::HeaderTooLarge
        | SafeTensorError::InvalidHeaderLength
        | SafeTensorError::InvalidHeader(_) => "another kind of file".into(),
        other => other.to_string(),
    }
}

/// What the container holds, its parts in agreement but not yet checked by themselves.
fn read(bytes: &[u8]) -> std::result::Result<VocabularyFile, Flaw> {
    let (header, metadata) = SafeTensors::read_metadata(bytes).map_err(|e| {
        (
            unreadable(bytes, &e),
            "a vocabulary (a safetensors container)".to_string(),
        )
    })?;
    let json = metadata
        .metadata()
        .as_ref()
        .and_then(|m| m.get(KEY))
        .ok_or_else(|| {
            let expected = format!("metadata under the key `{KEY}`");
            ("no document".to_string(), expected)
        })?;
    let document = read_document(json)?;
    let meta = document.vocabulary;

    // The container has been checked: its tensors fill what follows the header, without gaps.
    let data = &bytes[size_of::<u64>() + header..];
    if blake3::hash(data).to_hex().as_str() != document.data_blake3 {
        let found = "tensors whose BLAKE3 differs from `data_blake3`".to_string();
        return Err((found, "an undamaged file".to_string()));
    }
    let principal = |p: &&PrimitiveMeta| p.fit.source == SourceMeta::Principal;
    let expected = 3 * meta.exemplar_count()
        + 2 * meta.primitives.len()
        + 2 * meta.primitives.iter().filter(principal).count();
    let tensors = metadata.offset_keys().len();
    if tensors != expected {
        let expected = format!("{expected} for the exemplars and primitives listed");
        return Err((format!("{tensors} tensors"), expected));
    }
    let container = Container { metadata, data };
    let exemplars = (0..meta.exemplar_count()).map(|i| container.exemplar(i, &meta));
    let exemplars = exemplars.collect::<std::result::Result<_, _>>()?;
    let fits = meta.primitives.iter().enumerate();
    let fits = fits.map(|(j, primitive)| container.fit(j, primitive, meta.landmarks as usize));
    Ok(VocabularyFile {
        exemplars,
        fits: fits.collect::<std::result::Result<_, _>>()?,
        meta,
    })
}

const EXEMPLAR: &str = "exemplar";
const POSES: &str = "poses";
const ROOT: &str = "root";
const WARP: &str = "warp";
const PRIMITIVE: &str = "primitive";
const POINTS: &str = "points";
const REFERENCE: &str = "reference";
const MEAN: &str = "mean";
const DIRECTIONS: &str = "directions";

fn tensor_name(of: &str, index: usize, what: &str) -> String {
    format!("{of}-{index:06}/{what}")
}

/// Numbers as the container takes them.
struct Tensor {
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Tensor {
    fn new(shape: &[usize], values: &[f64]) -> Self {
        Self {
            shape: shape.to_vec(),
            bytes: values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        }
    }
}

impl View for Tensor {
    fn dtype(&self) -> Dtype {
        Dtype::F64
    }

    fn shape(&self) -> &[usize] {
        &self.shape
    }

    fn data(&self) -> Cow<'_, [u8]> {
        self.bytes.as_slice().into()
    }

    fn data_len(&self) -> usize {
        self.bytes.len()
    }
}

fn read_document(json: &str) -> std::result::Result<Document<VocabularyMeta>, Flaw> {
    #[derive(Deserialize)]
    struct Versioned {
        version: u64,
    }
    let damaged = |e: serde_json::Error| (e.to_string(), "a vocabulary document".to_string());
    let Versioned { version } = serde_json::from_str(json).map_err(damaged)?;
    if !(OLDEST_VERSION..=VERSION).contains(&version) {
        let expected = match version {
            1 => format!(
                "version {VERSION}, which holds fitted primitives: make the vocabulary again"
            ),
            _ => format!("version {OLDEST_VERSION} or {VERSION}, which this program reads"),
        };
        return Err((format!("format version {version}"), expected));
    }
    let document: Document<VocabularyMeta> = serde_json::from_str(json).map_err(damaged)?;
    if document.units != Units::ours() {
        let found = "units other than m, rad and s".to_string();
        return Err((found, "metres, radians, seconds".to_string()));
    }
    Ok(document)
}

/// A container whose tensors lie within its data.
struct Container<'a> {
    metadata: Metadata,
    data: &'a [u8],
}

impl Container<'_> {
    fn exemplar(
        &self,
        i: usize,
        meta: &VocabularyMeta,
    ) -> std::result::Result<ExemplarTensors, Flaw> {
        let name = |what| tensor_name(EXEMPLAR, i, what);
        let root = self.numbers(&name(ROOT), &[None, Some(4)])?;
        Ok(ExemplarTensors {
            poses: self.numbers(&name(POSES), &[None, Some(meta.coordinates.len())])?,
            root: root.as_chunks::<4>().0.to_vec(),
            warp: self.numbers(&name(WARP), &[None])?,
        })
    }

    fn fit(
        &self,
        j: usize,
        meta: &PrimitiveMeta,
        landmarks: usize,
    ) -> std::result::Result<FitTensors, Flaw> {
        let name = |what| tensor_name(PRIMITIVE, j, what);
        let dims = meta.fit.parameters.len();
        let principal = if meta.fit.source == SourceMeta::Principal {
            let mean = self.numbers(&name(MEAN), &[None])?;
            let shape = [Some(dims), Some(mean.len())];
            let directions = self.numbers(&name(DIRECTIONS), &shape)?;
            Some(PrincipalTensors { mean, directions })
        } else {
            None
        };
        Ok(FitTensors {
            points: self.numbers(&name(POINTS), &[Some(meta.exemplars.len()), Some(dims)])?,
            reference: self.numbers(&name(REFERENCE), &[None, Some(landmarks)])?,
            principal,
        })
    }

    /// The numbers of a tensor of this shape; `None` is any number of rows.
    fn numbers(&self, name: &str, shape: &[Option<usize>]) -> std::result::Result<Vec<f64>, Flaw> {
        let expected = || {
            let length = |n: &Option<usize>| n.map_or("any".to_string(), |n| n.to_string());
            let shape: Vec<String> = shape.iter().map(length).collect();
            format!("F64 [{}]", shape.join(", "))
        };
        let info = self
            .metadata
            .info(name)
            .ok_or_else(|| (format!("no tensor `{name}`"), expected()))?;
        let fits = |(found, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|w| w == *found);
        let same_rank = info.shape.len() == shape.len();
        if info.dtype != Dtype::F64 || !same_rank || !info.shape.iter().zip(shape).all(fits) {
            let found = format!("tensor `{name}` of {:?} {:?}", info.dtype, info.shape);
            return Err((found, expected()));
        }
        let (start, end) = info.data_offsets;
        let (numbers, _) = self.data[start..end].as_chunks::<8>();
        Ok(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect())
    }
}
