//! Where results go: never over what is there without leave, never outside the folder that was named.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use kineme::math::rotation::Axis;
use kineme::{Format, Motion, Recording, Source};
use kineme_formats::output::Existing;
use kineme_formats::tables::body_angles;
use kineme_formats::{bvh, npz, output};

use crate::args::{Global, Written};
use crate::failure::Failure;

/// What the command line says about files that exist.
pub fn existing(global: &Global) -> Existing {
    if global.force {
        Existing::Replace
    } else {
        Existing::Keep
    }
}

/// Refuses, before any work, what would be refused after it: to write over what is there, or where nothing can be.
pub fn refuse_existing<'a>(
    paths: impl IntoIterator<Item = &'a Path>,
    global: &Global,
) -> Result<(), Failure> {
    let mut probed = BTreeSet::new();
    for path in paths {
        let taken = path.symlink_metadata().is_ok() && !output::is_channel(path);
        if taken && !global.force && !path.is_dir() {
            let message = format!("{} exists already", path.display());
            return Err(Failure::usage(message).hint("--force overwrites it"));
        }
        // One answer for all files of a folder: there may be thousands.
        if path.is_dir() || probed.insert(path.parent()) {
            output::probe(path).map_err(unwritten)?;
        }
    }
    Ok(())
}

/// A failure to write is no unreadable input.
pub fn unwritten(error: kineme_formats::FormatError) -> Failure {
    Failure::failed(error.to_string())
}

impl Written {
    /// The format that a file's name says.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        [Self::Bvh, Self::Csv, Self::Parquet, Self::Npz]
            .into_iter()
            .find(|format| format.extension() == extension)
    }

    /// What a file's name ends with.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Npz => "npz",
        }
    }

    /// A motion of a body in this format: as BVH in centimetres with y up, as most programs expect it.
    pub fn bytes(self, motion: &Motion) -> Result<Vec<u8>, Failure> {
        match self {
            Self::Bvh => {
                let source = Source {
                    format: Format::Synthetic,
                    up: Axis::Y,
                    unit_metres: 0.01,
                    warnings: Vec::new(),
                };
                let recording = Recording::from_motion(motion).with_source(source)?;
                let mut bytes = Vec::new();
                bvh::write(&recording, &mut bytes).map_err(unwritten)?;
                Ok(bytes)
            }
            Self::Csv => body_angles::table(motion)
                .write(motion.name())
                .map_err(unwritten),
            Self::Parquet => body_angles::table(motion)
                .write_parquet(motion.name())
                .map_err(unwritten),
            Self::Npz => npz::write(motion).map_err(unwritten),
        }
    }
}

/// Paths below a folder for motions of these names, which lie below `root`: the same folders, with another extension.
/// Names that would meet keep their own extension, too.
pub fn mirrored(names: &[&str], root: &str, extension: &str) -> Vec<PathBuf> {
    let inner: Vec<PathBuf> = names
        .iter()
        .map(|name| {
            let below = name.strip_prefix(root).unwrap_or(name);
            // An archive's author must not choose where we write: `..` and roots are dropped.
            let parts = below.split(['/', '\\']);
            parts
                .filter(|part| !matches!(*part, "" | "." | "..") && !part.contains(':'))
                .collect()
        })
        .collect();
    let short: Vec<PathBuf> = inner.iter().map(|p| p.with_extension(extension)).collect();
    let mut taken: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for path in &short {
        *taken.entry(lowered(path)).or_default() += 1;
    }
    let mut used = BTreeMap::new();
    inner
        .iter()
        .zip(short)
        .map(|(inner, short)| {
            let mut path = short;
            if taken[&lowered(&path)] > 1 {
                path = inner.clone();
                path.as_mut_os_string().push(format!(".{extension}"));
            }
            let again = used.entry(lowered(&path)).or_insert(0);
            *again += 1;
            if *again > 1 {
                path = path.with_extension(format!("{again}.{extension}"));
            }
            path
        })
        .collect()
}

/// Some file systems do not tell cases apart.
fn lowered(path: &Path) -> PathBuf {
    path.to_string_lossy().to_lowercase().into()
}

#[cfg(test)]
mod tests {
    use super::mirrored;

    #[test]
    fn outputs_mirror_names_and_stay_in_their_folder() {
        let names = [
            "set.zip/walk/a.bvh",
            "set.zip/walk/a.amc",
            "set.zip/../../etc/b.bvh",
            "set.zip/C:\\x\\c.bvh",
            "set.zip/d",
            "set.zip/D.csv",
        ];
        let found: Vec<String> = mirrored(&names, "set.zip", "bvh")
            .iter()
            .map(|p| p.to_string_lossy().replace('\\', "/"))
            .collect();
        let wanted = [
            "walk/a.bvh.bvh",
            "walk/a.amc.bvh",
            "etc/b.bvh",
            "x/c.bvh",
            "d.bvh",
            "D.csv.bvh",
        ];
        assert_eq!(found, wanted);
    }
}
