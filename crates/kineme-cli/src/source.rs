//! INPUT of every verb: read in parallel, told in order.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use kineme::retargeting::{Profile, retarget};
use kineme::{Format, Motion, Recording, Skeleton};
use kineme_formats::c3d::{Centred, joint_centres};
use kineme_formats::input::{Entry, InputRates, Inputs, ReadOptions};
use kineme_formats::{FormatError, Place};
use rayon::prelude::*;

use crate::args::ReadArgs;
use crate::failure::{Failure, complain};
use crate::progress;
use crate::warnings::Warnings;

/// The motions of the command line, and how to read them.
pub struct Source {
    /// What was found.
    pub inputs: Inputs,
    keep_going: bool,
    profile: Option<UserProfile>,
}

/// A profile with what it says of axes and unit.
struct UserProfile {
    profile: Profile,
    up: Option<kineme::math::rotation::Axis>,
    unit_metres: Option<f64>,
    /// Whether several names of a role are markers around its joint; a built-in profile's are other names of it.
    surrounded: bool,
}

/// A recording in whose joints roles can be found.
pub struct Jointed<'r> {
    /// As it was read, or of markers the joints that they surround.
    pub recording: Cow<'r, Recording>,
    /// Which joint plays which role, where that is known.
    pub profile: Option<Cow<'r, Profile>>,
}

/// What came of every motion, in the order of the inputs.
pub struct Read<T> {
    /// Of those that could be read. Without `--keep-going` these end before the first that could not.
    pub items: Vec<T>,
    /// Of those that could not.
    pub failures: Vec<Failure>,
    /// How many motions there were.
    pub of: usize,
    /// How many of them are not among the items.
    pub skipped: usize,
    keep_going: bool,
}

impl<T> Read<T> {
    /// Of no motion read now, but `of` known from before.
    pub fn nothing(of: usize) -> Self {
        Self {
            items: Vec::new(),
            failures: Vec::new(),
            of,
            skipped: 0,
            keep_going: true,
        }
    }

    /// The same of `of` motions that gave these items.
    pub fn with<U>(self, items: Vec<U>, of: usize) -> Read<U> {
        Read {
            skipped: of - items.len().min(of),
            items,
            failures: self.failures,
            of,
            keep_going: self.keep_going,
        }
    }

    /// Adds what had to be left out later.
    pub fn skip(&mut self, failures: Vec<Failure>) {
        self.skipped += failures.len();
        self.failures.extend(failures);
    }

    /// Ends the run when a motion could not be read and that is not to be skipped, or when none could.
    pub fn unless_failed(mut self) -> Result<Self, Failure> {
        if self.failures.is_empty() || (self.keep_going && !self.items.is_empty()) {
            return Ok(self);
        }
        if self.keep_going {
            self.print_skipped();
            return Err(Failure::unreadable("no input could be read"));
        }
        let failure = self.failures.swap_remove(0);
        Err(if self.of > 1 {
            failure.or_hint("--keep-going skips what cannot be read")
        } else {
            failure
        })
    }

    /// Lists what was skipped on stderr; the exit code of a run that got so far.
    pub fn print_skipped(&self) -> u8 {
        for failure in &self.failures {
            failure.print();
        }
        if self.failures.is_empty() {
            return 0;
        }
        complain(&format!("skipped {} of {} motions", self.skipped, self.of));
        crate::failure::UNREADABLE
    }
}

impl Source {
    /// Finds the motions of INPUT and settles how to read them.
    pub fn open<P: AsRef<Path>>(paths: &[P], args: &ReadArgs) -> Result<Self, Failure> {
        let profile = args.profile.as_deref().map(profile).transpose()?;
        let inputs = resolve(paths, args, None)?;
        // What is not there is told before any work.
        let mut lost = inputs.entries.iter().filter_map(Entry::lost);
        if let (false, Some(why)) = (args.keep_going, lost.next()) {
            let failure = Failure::from(why.clone());
            return Err(match inputs.entries.len() {
                1 => failure,
                _ => failure.or_hint("--keep-going skips what cannot be read"),
            });
        }
        print_assumed(&inputs);
        if inputs.ignored > 0 {
            complain(&match inputs.ignored {
                1 => "note: 1 file is no motion and was ignored".into(),
                n => format!("note: {n} files are no motions and were ignored"),
            });
        }
        Ok(Self {
            inputs,
            keep_going: args.keep_going,
            profile,
        })
    }

    /// Finds motions one by one, each with the frame rate (hertz) that somebody knows of it. What is at a path is told
    /// beside it, in the same order: just one motion, or why not.
    pub fn one_by_one(
        files: &[(PathBuf, Option<f64>)],
        args: &ReadArgs,
    ) -> Result<(Self, Vec<Result<Entry, FormatError>>), Failure> {
        let profile = args.profile.as_deref().map(profile).transpose()?;
        let mut found: Vec<Option<Result<Entry, FormatError>>> = vec![None; files.len()];
        // Rates are said of all files of a run: one run for each.
        while let Some(first) = found.iter().position(Option::is_none) {
            let rate_hz = files[first].1;
            let same: Vec<usize> = (first..files.len())
                .filter(|&i| files[i].1 == rate_hz)
                .collect();
            let paths: Vec<&PathBuf> = same.iter().map(|&i| &files[i].0).collect();
            for (i, entry) in same.into_iter().zip(single(&paths, args, rate_hz)?) {
                found[i] = Some(entry);
            }
        }
        let source = Self {
            inputs: Inputs {
                entries: Vec::new(),
                ignored: 0,
                warnings: Vec::new(),
            },
            keep_going: args.keep_going,
            profile,
        };
        Ok((source, found.into_iter().flatten().collect()))
    }

    /// Works on every one of `items`, told with its index, on all threads. Once one has failed, later ones are not begun,
    /// unless they are to be skipped.
    pub fn each<I: Sync, T: Send>(
        &self,
        items: &[I],
        what: &'static str,
        work: impl Fn(usize, &I) -> Result<T, Failure> + Sync,
    ) -> Read<T> {
        let bar = progress::bar(items.len(), what);
        let first_failed = AtomicUsize::new(usize::MAX);
        let results: Vec<Option<Result<T, Failure>>> = items
            .par_iter()
            .with_max_len(1)
            .enumerate()
            .map(|(i, item)| {
                if !self.keep_going && first_failed.load(Ordering::Relaxed) < i {
                    return None;
                }
                let result = work(i, item);
                if result.is_err() {
                    first_failed.fetch_min(i, Ordering::Relaxed);
                }
                bar.inc(1);
                Some(result)
            })
            .collect();
        bar.finish_and_clear();
        let mut read = Read {
            items: Vec::new(),
            failures: Vec::new(),
            of: items.len(),
            skipped: 0,
            keep_going: self.keep_going,
        };
        for result in results.into_iter().flatten() {
            match result {
                Ok(item) => read.items.push(item),
                Err(failure) => {
                    read.skipped += 1;
                    read.failures.push(failure);
                    if !self.keep_going {
                        break;
                    }
                }
            }
        }
        read
    }

    /// A recording in the axes and unit that the profile says.
    pub fn read(&self, entry: &Entry) -> Result<Recording, Failure> {
        self.in_axes(entry.read()?)
    }

    /// As [`Self::read`], with the BLAKE3 of the file.
    pub fn read_hashed(&self, entry: &Entry) -> Result<(Recording, String), Failure> {
        let (recording, hash) = entry.read_hashed()?;
        Ok((self.in_axes(recording)?, hash))
    }

    fn in_axes(&self, recording: Recording) -> Result<Recording, Failure> {
        let Some(user) = &self.profile else {
            return Ok(recording);
        };
        let mut source = recording.source().clone();
        let up = user.up.unwrap_or(source.up);
        let unit = user.unit_metres.unwrap_or(source.unit_metres);
        let same = (up, unit) == (source.up, source.unit_metres);
        // Whoever says it need not be told what the reader took it for.
        if user.up.is_some() {
            source.warnings.retain(|w| !w.starts_with("up axis:"));
        }
        let name = recording.name().to_owned();
        let refused = |e: kineme::Error| Failure::unreadable(format!("{name}: {e}"));
        let recording = recording.with_source(source).map_err(refused)?;
        match same {
            true => Ok(recording),
            false => recording.reread(up, unit).map_err(refused),
        }
    }

    /// The profile of the command line.
    fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref().map(|u| &u.profile)
    }

    /// The joints of a recording: markers lie on the skin around them.
    pub fn jointed<'r>(&'r self, recording: &'r Recording) -> Result<Jointed<'r>, Failure> {
        let own = self.profile.as_ref();
        if recording.source().format == Format::C3d && own.is_none_or(|user| user.surrounded) {
            let centred = joint_centres(recording, self.profile())
                .map_err(|e| Failure::unreadable(format!("{}: {e}", recording.name())))?;
            if let Some(Centred { recording, profile }) = centred {
                return Ok(Jointed {
                    recording: Cow::Owned(recording),
                    profile: Some(Cow::Owned(profile)),
                });
            }
        }
        Ok(Jointed {
            recording: Cow::Borrowed(recording),
            profile: own.map(|user| Cow::Borrowed(&user.profile)),
        })
    }

    /// A recording in the joints of a body, and what there is to warn of.
    pub fn retarget(
        &self,
        recording: &Recording,
        body: &Arc<Skeleton>,
    ) -> Result<(Motion, Vec<String>), Failure> {
        let jointed = self.jointed(recording)?;
        let recording = &*jointed.recording;
        let done = retarget(recording, body, jointed.profile.as_deref())
            .map_err(|e| Failure::unreadable(format!("{}: {e}", recording.name())))?;
        let mut warnings = recording.source().warnings.clone();
        if done.profile == "guessed" {
            let names: Vec<&str> = recording.joints().iter().map(|j| j.name.as_str()).collect();
            warnings.push(format!(
                "roles guessed from the names of the {} joints; --profile FILE says them",
                names.len()
            ));
        }
        if !done.unobserved.is_empty() {
            let roles: Vec<&str> = done.unobserved.iter().map(|r| r.name()).collect();
            warnings.push(format!(
                "not transferred, stays neutral: {}",
                roles.join(", ")
            ));
        }
        if done.filled > 0.0 {
            warnings.push(format!(
                "{:.1} % of the points missing and filled from their neighbours in time",
                100.0 * done.filled
            ));
        }
        Ok((done.motion, warnings))
    }
}

/// The one motion at each path, or that there is another number of them.
fn single(
    paths: &[&PathBuf],
    args: &ReadArgs,
    rate_hz: Option<f64>,
) -> Result<Vec<Result<Entry, FormatError>>, Failure> {
    let fits = |entries: &[Entry], paths: &[&PathBuf]| {
        let pairs = entries.iter().zip(paths);
        let same = pairs.filter(|(e, p)| *e.name() == p.to_string_lossy());
        same.count() == paths.len() && entries.len() == paths.len()
    };
    let mut inputs = resolve(paths, args, rate_hz)?;
    let mut alone = vec![true; paths.len()];
    if !fits(&inputs.entries, paths) {
        // A folder among them: which it is, only one by one can tell.
        for (path, alone) in paths.iter().zip(&mut alone) {
            *alone = fits(&resolve(&[path], args, rate_hz)?.entries, &[path]);
        }
        let files: Vec<&&PathBuf> = paths
            .iter()
            .zip(&alone)
            .filter(|(_, a)| **a)
            .map(|(p, _)| p)
            .collect();
        inputs = resolve(&files, args, rate_hz)?;
    }
    print_assumed(&inputs);
    let mut entries = inputs.entries.into_iter();
    let each = paths.iter().zip(alone).map(|(path, alone)| {
        let refused = || {
            let name = path.to_string_lossy();
            FormatError::new(name, Place::File, "a folder or an archive", "one motion")
        };
        if alone {
            entries.next().ok_or_else(refused)
        } else {
            Err(refused())
        }
    });
    Ok(each.collect())
}

/// The motions at paths.
fn resolve<P: AsRef<Path>>(
    paths: &[P],
    args: &ReadArgs,
    rate_hz: Option<f64>,
) -> Result<Inputs, Failure> {
    let rates = match rate_hz {
        Some(hz) => hz.to_string().parse::<InputRates>()?,
        None => args.input_rate.clone().unwrap_or_default(),
    };
    let options = ReadOptions {
        asf: args.asf.clone(),
        rates,
    };
    Ok(Inputs::resolve(paths, &options)?)
}

/// Tells what had to be assumed of motions.
fn print_assumed(inputs: &Inputs) {
    for warning in &inputs.warnings {
        complain(&format!("warning: {warning}"));
    }
}

/// Tells the warnings of motions, each kind once.
pub fn print_warnings<'a>(warned: impl IntoIterator<Item = (&'a str, &'a [String])>) {
    let mut warnings = Warnings::default();
    for (motion, texts) in warned {
        for text in texts {
            warnings.add(motion, text);
        }
    }
    warnings.print();
}

/// The built-in profile of this name, else the file.
fn profile(name: &str) -> Result<UserProfile, Failure> {
    let unknown = match Profile::named(name) {
        Ok(profile) => {
            return Ok(UserProfile {
                profile,
                up: None,
                unit_metres: None,
                surrounded: false,
            });
        }
        Err(unknown) => unknown,
    };
    let bytes = match std::fs::read(name) {
        Ok(bytes) => bytes,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            return Err(Failure::usage(unknown.to_string()));
        }
        Err(e) => return Err(Failure::unreadable(format!("{name}: {e}"))),
    };
    let read = kineme_formats::profile::parse(name, &bytes)?;
    Ok(UserProfile {
        profile: Profile {
            name: read.name,
            roles: read.roles,
        },
        up: read.up,
        unit_metres: read.unit_metres,
        surrounded: true,
    })
}
