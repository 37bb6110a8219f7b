//! Output that is there completely or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::{FormatError, Place, Result, told};

/// What to do about a file that exists already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Existing {
    /// Refuse to write.
    #[default]
    Keep,
    /// Put the new one in its place.
    Replace,
}

/// Writes a file through a temporary one beside it, renamed when complete: nobody ever reads half of it, and a
/// failure leaves what was there. Parent folders are made. A link stays one: what it points to is written. What is no
/// file, a pipe or a device, is written into, complete or not.
///
/// # Errors
/// When the file exists and is to be kept, when the disk refuses, or whatever `content` returns.
pub fn write(
    path: &Path,
    existing: Existing,
    content: impl FnOnce(&mut dyn Write) -> Result<()>,
) -> Result<()> {
    let shown = path.display().to_string();
    let wrong = |found: String, expected: &str| {
        FormatError::new(shown.clone(), Place::File, found, expected)
    };
    let failed = |e: io::Error| wrong(told(&e), "a file that can be written");
    let refused = || {
        wrong(
            "an existing file".into(),
            "a new name, or leave to overwrite it",
        )
    };
    if is_channel(path) {
        let opened = std::fs::OpenOptions::new().write(true).open(path);
        let mut out = BufWriter::new(opened.map_err(failed)?);
        content(&mut out)?;
        return out.flush().map_err(failed);
    }
    // Asked before the work, and once more by the system when the name is taken.
    if existing == Existing::Keep && path.symlink_metadata().is_ok() {
        return Err(refused());
    }
    if path.is_dir() {
        return Err(wrong("a folder".into(), "the name of a file"));
    }
    let real = match path.is_symlink() {
        true => Some(std::fs::canonicalize(path).map_err(failed)?),
        false => None,
    };
    let path = real.as_deref().unwrap_or(path);
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".kineme-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file's, less what the user's mask takes away; temporary files are private by default.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let temporary = builder.tempfile_in(folder).map_err(failed)?;
    let mut out = BufWriter::new(temporary);
    content(&mut out)?;
    let temporary = out.into_inner().map_err(|e| failed(e.into_error()))?;
    match existing {
        Existing::Keep => temporary.persist_noclobber(path).map_err(|e| {
            if e.error.kind() == io::ErrorKind::AlreadyExists {
                refused()
            } else {
                failed(e.error)
            }
        })?,
        Existing::Replace => temporary.persist(path).map_err(|e| failed(e.error))?,
    };
    Ok(())
}

/// Whether something is there that holds nothing which could be lost: neither file nor folder, but a pipe or a device.
pub fn is_channel(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Whether a file could be written here, asked before the work that it is to hold. Nothing is left behind.
///
/// # Errors
/// When the path is a folder, or the nearest folder that exists takes no file.
pub fn probe(path: &Path) -> Result<()> {
    let wrong = |found: String, expected: &str| {
        FormatError::new(path.display().to_string(), Place::File, found, expected)
    };
    if path.is_dir() {
        return Err(wrong("a folder".into(), "the name of a file"));
    }
    if is_channel(path) {
        return Ok(());
    }
    let there = path
        .ancestors()
        .skip(1)
        .find(|p| p.symlink_metadata().is_ok());
    let folder = there.unwrap_or(Path::new("."));
    let made = tempfile::Builder::new()
        .prefix(".kineme-")
        .tempfile_in(folder);
    made.map(drop)
        .map_err(|e| wrong(told(&e), "a file that can be written"))
}

/// As [`write()`], of bytes that are there already.
///
/// # Errors
/// As [`write()`].
pub fn write_bytes(path: &Path, existing: Existing, bytes: &[u8]) -> Result<()> {
    write(path, existing, |out| {
        out.write_all(bytes).map_err(|e| {
            FormatError::new(
                path.display().to_string(),
                Place::File,
                told(&e),
                "a file that can be written",
            )
        })
    })
}
