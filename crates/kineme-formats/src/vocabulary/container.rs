//! The vocabulary file as a safetensors container: bytes out, bytes in.

use std::borrow::Cow;
use std::collections::HashMap;

use safetensors::tensor::Metadata;
use safetensors::{Dtype, SafeTensors, View};
use serde::{Deserialize, Serialize};

use super::check::Flaw;
use super::{ExemplarFrames, VERSION, VocabularyFile, VocabularyMeta};
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
        let dof = self.meta.coordinates.len();
        let tensors: Vec<(String, Tensor)> = self
            .exemplars
            .iter()
            .enumerate()
            .flat_map(|(i, e)| {
                let frames = e.root.len();
                let poses = Tensor::new([frames, dof], e.poses.iter());
                let root = Tensor::new([frames, 4], e.root.iter().flatten());
                [(tensor_name(i, POSES), poses), (tensor_name(i, ROOT), root)]
            })
            .collect();
        // The container sorts tensors of one type by name, which is the order they already have.
        let mut hasher = blake3::Hasher::new();
        for (_, tensor) in &tensors {
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
}

fn refusal(name: &str, (found, expected): Flaw) -> FormatError {
    FormatError::new(name, Place::File, found, expected)
}

/// What the container holds, its parts in agreement but not yet checked by themselves.
fn read(bytes: &[u8]) -> std::result::Result<VocabularyFile, Flaw> {
    let (header, container) = SafeTensors::read_metadata(bytes)
        .map_err(|e| (e.to_string(), "a safetensors container".to_string()))?;
    let json = container
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
    let count = meta.exemplar_count();
    let tensors = container.offset_keys().len();
    if tensors != 2 * count {
        let found = format!("{tensors} tensors for {count} exemplars");
        return Err((found, "two an exemplar".to_string()));
    }
    let exemplars = (0..count)
        .map(|i| {
            let width = meta.coordinates.len();
            let poses = read_tensor(&container, data, &tensor_name(i, POSES), width)?;
            let root = read_tensor(&container, data, &tensor_name(i, ROOT), 4)?;
            let root = root.as_chunks::<4>().0.to_vec();
            Ok(ExemplarFrames { poses, root })
        })
        .collect::<std::result::Result<_, Flaw>>()?;
    Ok(VocabularyFile { meta, exemplars })
}

const POSES: &str = "poses";
const ROOT: &str = "root";

fn tensor_name(exemplar: usize, what: &str) -> String {
    format!("exemplar-{exemplar:06}/{what}")
}

/// A matrix of f64 as the container takes it.
struct Tensor {
    shape: [usize; 2],
    bytes: Vec<u8>,
}

impl Tensor {
    fn new<'a>(shape: [usize; 2], values: impl Iterator<Item = &'a f64>) -> Self {
        let bytes = values.flat_map(|v| v.to_le_bytes()).collect();
        Self { shape, bytes }
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
    if version != VERSION {
        return Err((
            format!("format version {version}"),
            format!("version {VERSION}, the only one this program reads"),
        ));
    }
    let document: Document<VocabularyMeta> = serde_json::from_str(json).map_err(damaged)?;
    if document.units != Units::ours() {
        let found = "units other than m, rad and s".to_string();
        return Err((found, "metres, radians, seconds".to_string()));
    }
    Ok(document)
}

fn read_tensor(
    container: &Metadata,
    data: &[u8],
    name: &str,
    width: usize,
) -> std::result::Result<Vec<f64>, Flaw> {
    let info = container
        .info(name)
        .ok_or_else(|| (format!("no tensor `{name}`"), "two an exemplar".to_string()))?;
    if info.dtype != Dtype::F64 || info.shape.len() != 2 || info.shape[1] != width {
        return Err((
            format!("tensor `{name}` of {:?} {:?}", info.dtype, info.shape),
            format!("F64 [frames, {width}]"),
        ));
    }
    let (start, end) = info.data_offsets;
    let (numbers, _) = data[start..end].as_chunks::<8>();
    Ok(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect())
}
