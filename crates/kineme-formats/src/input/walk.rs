//! From paths to entries: folders, archives, and the skeletons beside motions.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::archive::{Archive, Handles};
use super::{Entry, Location, lost};
use crate::detect::{self, Kind};
use crate::error::{FormatError, Result};

/// Inputs as they are met.
#[derive(Default)]
pub(super) struct Walk {
    pub(super) entries: Vec<Entry>,
    pub(super) ignored: usize,
    handles: Arc<Handles>,
    /// Folders on the way down, so that links that lead back end.
    seen: BTreeSet<PathBuf>,
    /// ASF files of folders on disk, listed once.
    asf_in: BTreeMap<PathBuf, Vec<PathBuf>>,
}

impl Walk {
    /// Adds the motions of one path; where it leads to none, an entry that tells why.
    pub(super) fn input(&mut self, path: &Path) {
        let shown = shown(path);
        if shown == "-" {
            return self.standard_input();
        }
        let before = self.entries.len();
        match std::fs::metadata(path) {
            Ok(found) if found.is_dir() => self.folder(path, &shown),
            Ok(found) if found.is_file() => {
                let place = Location::File(path.into());
                match self.kind(&shown, &place) {
                    Some(Kind::Zip) => self.archive(path, &shown, ""),
                    kind => self.push(shown.clone(), kind, place),
                }
            }
            Ok(_) => {
                let why = lost(&shown, "neither file nor folder".into(), "a motion file");
                self.lose(&shown, why);
            }
            Err(e) => match packed_path(path) {
                Some((archive, inner)) => {
                    self.archive(archive, &shown_parent(&shown, &inner), &inner)
                }
                None => {
                    let why = lost(&shown, crate::told(&e), "a file, a folder or an archive");
                    self.lose(&shown, why);
                }
            },
        }
        if self.entries.len() == before {
            let why = lost(&shown, "no motion in it".into(), "motion files");
            self.lose(&shown, why);
        }
    }

    fn standard_input(&mut self) {
        let mut bytes = Vec::new();
        match std::io::stdin().lock().read_to_end(&mut bytes) {
            Ok(_) => {
                let place = Location::Held(bytes.into());
                let kind = self.kind("-", &place).filter(|kind| *kind != Kind::Zip);
                self.push("-".into(), kind, place);
            }
            Err(e) => {
                let why = lost("-", crate::told(&e), "readable standard input");
                self.lose("-", why);
            }
        }
    }

    fn folder(&mut self, path: &Path, shown: &str) {
        let listed = std::fs::canonicalize(path).and_then(|real| {
            let mut names = Vec::new();
            for entry in std::fs::read_dir(path)? {
                names.push(entry?.file_name());
            }
            names.sort();
            Ok((real, names))
        });
        let (real, names) = match listed {
            Ok(listed) => listed,
            Err(e) => {
                let why = lost(shown, crate::told(&e), "a readable folder");
                return self.lose(shown, why);
            }
        };
        if !self.seen.insert(real.clone()) {
            return;
        }
        for name in names {
            let inner = path.join(&name);
            let name = name.to_string_lossy();
            if name.starts_with('.') {
                continue;
            }
            let inner_shown = format!("{}/{name}", shown.trim_end_matches('/'));
            match std::fs::metadata(&inner) {
                Ok(found) if found.is_dir() => self.folder(&inner, &inner_shown),
                Ok(found) if found.is_file() => {
                    let place = Location::File(inner.clone());
                    match self.kind(&inner_shown, &place) {
                        Some(Kind::Zip) => self.archive(&inner, &inner_shown, ""),
                        kind => self.met(inner_shown, kind, place),
                    }
                }
                _ => self.ignored += 1,
            }
        }
        self.seen.remove(&real);
    }

    /// The motions of an archive below `inner`, or the one of that name.
    fn archive(&mut self, path: &Path, shown: &str, inner: &str) {
        let archive = match Archive::list(path, shown, &self.handles) {
            Ok(archive) => Arc::new(archive),
            Err(why) => return self.lose(shown, why),
        };
        for (index, file) in archive.files.iter().enumerate() {
            let below = match file.path.strip_prefix(inner) {
                Some(rest) => inner.is_empty() || rest.starts_with('/') || rest.is_empty(),
                None => false,
            };
            if !below
                || file
                    .path
                    .split('/')
                    .any(|p| p.starts_with('.') || p == "__MACOSX")
            {
                continue;
            }
            let name = format!("{shown}/{}", file.path);
            let place = Location::Packed(Arc::clone(&archive), index);
            let kind = self.kind(&name, &place);
            if file.path == inner {
                self.push(name, kind, place);
            } else if kind == Some(Kind::Zip) {
                self.ignored += 1;
            } else {
                self.met(name, kind, place);
            }
        }
    }

    /// The kind by name, and where that says nothing, by content.
    fn kind(&self, shown: &str, place: &Location) -> Option<Kind> {
        detect::by_extension(shown).or_else(|| {
            let head = place.bytes(shown, Some(detect::HEAD), &self.handles).ok()?;
            match detect::detect(shown, &head) {
                Some(Kind::Parquet) => {
                    detect::by_columns(|most| place.end(shown, most, &self.handles).ok())
                }
                kind => kind,
            }
        })
    }

    /// A file of a folder: skeletons serve motions, what is no motion is counted.
    fn met(&mut self, name: String, kind: Option<Kind>, place: Location) {
        match kind {
            None => self.ignored += 1,
            Some(Kind::Asf) => {}
            Some(_) => self.push(name, kind, place),
        }
    }

    fn push(&mut self, name: String, kind: Option<Kind>, place: Location) {
        let skeleton = match kind {
            Some(Kind::Amc) => self.skeleton_beside(&name, &place),
            _ => None,
        };
        self.entries.push(Entry {
            name,
            kind,
            place,
            skeleton,
            rate_hz: None,
            handles: Arc::clone(&self.handles),
        });
    }

    fn lose(&mut self, name: &str, why: FormatError) {
        self.push(name.into(), None, Location::Lost(why));
    }

    /// The ASF of an AMC among those in its own folder.
    fn skeleton_beside(&mut self, name: &str, place: &Location) -> Option<(String, Location)> {
        let (folder, _) = name.rsplit_once('/').unwrap_or(("", name));
        let joined = |file: &str| match folder {
            "" => file.to_owned(),
            _ => format!("{folder}/{file}"),
        };
        match place {
            Location::File(path) => {
                let parent = path.parent().unwrap_or(Path::new(""));
                let beside = self
                    .asf_in
                    .entry(parent.into())
                    .or_insert_with(|| asf_files(parent));
                let names: Vec<String> = beside
                    .iter()
                    .map(|p| p.file_name().unwrap_or_default().to_string_lossy().into())
                    .collect();
                let chosen = asf_for(name, &names)?;
                let place = Location::File(beside[chosen].clone());
                Some((joined(&names[chosen]), place))
            }
            Location::Packed(archive, file) => {
                let folder_of =
                    |path: &str| path.rsplit_once('/').map_or("", |(f, _)| f).to_owned();
                let own = folder_of(&archive.files[*file].path);
                let beside: Vec<(usize, String)> = archive
                    .skeletons
                    .iter()
                    .map(|&i| (i, archive.files[i].path.as_str()))
                    .filter(|(_, path)| folder_of(path) == own)
                    .map(|(i, path)| (i, path.rsplit('/').next().unwrap_or_default().to_owned()))
                    .collect();
                let names: Vec<String> = beside.iter().map(|(_, n)| n.clone()).collect();
                let chosen = asf_for(name, &names)?;
                let place = Location::Packed(Arc::clone(archive), beside[chosen].0);
                Some((joined(&names[chosen]), place))
            }
            Location::Held(_) | Location::Lost(_) => None,
        }
    }

    /// The skeleton that `--asf` names.
    pub(super) fn skeleton_given(&self, path: &Path) -> Result<(String, Location)> {
        let shown = shown(path);
        if path.is_file() {
            return Ok((shown, Location::File(path.into())));
        }
        let absent = || lost(&shown, "no such file".into(), "an ASF skeleton for `--asf`");
        let (archive, inner) = packed_path(path).ok_or_else(absent)?;
        let archive = Arc::new(Archive::list(archive, &shown, &self.handles)?);
        let file = archive
            .files
            .iter()
            .position(|f| f.path == inner)
            .ok_or_else(absent)?;
        Ok((shown, Location::Packed(archive, file)))
    }
}

/// The ASF for an AMC among the names beside it: the same stem, else the longest stem that begins the AMC's before
/// a `_`, else the only one. Case does not count.
fn asf_for(amc: &str, beside: &[String]) -> Option<usize> {
    let stem = |name: &str| {
        let name = name.rsplit('/').next().unwrap_or_default();
        name.rsplit_once('.')
            .map_or(name, |(stem, _)| stem)
            .to_lowercase()
    };
    let own = stem(amc);
    let stems: Vec<String> = beside.iter().map(|n| stem(n)).collect();
    let begins = |s: &String| {
        own.strip_prefix(s.as_str())
            .is_some_and(|r| r.starts_with('_'))
    };
    stems
        .iter()
        .position(|s| *s == own)
        .or_else(|| {
            (0..stems.len())
                .filter(|&i| begins(&stems[i]))
                .max_by_key(|&i| stems[i].len())
        })
        .or((stems.len() == 1).then_some(0))
}

/// The ASF files of a folder, sorted.
fn asf_files(folder: &Path) -> Vec<PathBuf> {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let listed = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = listed
        .map(|e| e.path())
        .filter(|p| detect::by_extension(&p.to_string_lossy()) == Some(Kind::Asf))
        .collect();
    files.sort();
    files
}

/// Splits a path that leads into an archive: the archive's file, and the path inside.
fn packed_path(path: &Path) -> Option<(&Path, String)> {
    let archive = path.ancestors().skip(1).find(|p| p.is_file())?;
    let inner = path.strip_prefix(archive).ok()?;
    Some((archive, shown(inner)))
}

/// A path as messages and names show it: with `/`, without one at the end.
fn shown(path: &Path) -> String {
    let text = path.to_string_lossy();
    let text = if cfg!(windows) {
        text.replace('\\', "/")
    } else {
        text.into_owned()
    };
    match text.trim_end_matches('/') {
        "" => text,
        trimmed => trimmed.to_owned(),
    }
}

/// The shown archive of a shown path into it.
fn shown_parent(shown: &str, inner: &str) -> String {
    let archive = shown.strip_suffix(inner).unwrap_or(shown);
    archive.trim_end_matches('/').to_owned()
}

#[cfg(test)]
mod tests {
    use super::asf_for;

    fn check(amc: &str, beside: &[&str], expected: Option<&str>) {
        let names: Vec<String> = beside.iter().map(ToString::to_string).collect();
        let found = asf_for(amc, &names).map(|i| beside[i]);
        assert_eq!(found, expected, "{amc} beside {beside:?}");
    }

    #[test]
    fn an_amc_finds_its_asf_by_stem_then_prefix_then_being_alone() {
        check("d/02_01.amc", &["02_01.asf", "02.asf"], Some("02_01.asf"));
        check("02_01.amc", &["0.asf", "02.ASF"], Some("02.ASF"));
        check(
            "HDM_bd_x.AMC",
            &["HDM.asf", "HDM_bd.asf", "HDM_bk.asf"],
            Some("HDM_bd.asf"),
        );
        check("hdm_bd_x.amc", &["HDM_BD.asf", "a.asf"], Some("HDM_BD.asf"));
        check("0201.amc", &["02.asf", "03.asf"], None);
        check("walk.amc", &["anyone.asf"], Some("anyone.asf"));
        check("walk.amc", &[], None);
    }
}
