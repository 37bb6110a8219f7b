//! What makes a vocabulary file valid, on the way in and on the way out.

use std::collections::BTreeSet;

use super::{MAX_EXEMPLARS, PrimitiveMeta, VocabularyFile, VocabularyMeta};
use crate::sheet::quoted;

/// What was found and what was expected, before the file's name is known.
pub(super) type Flaw = (String, String);

type Checked = std::result::Result<(), Flaw>;

fn ensure(holds: bool, flaw: impl FnOnce() -> Flaw) -> Checked {
    if holds { Ok(()) } else { Err(flaw()) }
}

/// At least one name, none blank, none twice.
fn distinct<'a>(what: &str, names: impl IntoIterator<Item = &'a String>) -> Checked {
    let mut seen = BTreeSet::new();
    for name in names {
        ensure(!name.trim().is_empty(), || {
            (format!("{what} without a name"), "a name".to_string())
        })?;
        ensure(seen.insert(name), || {
            (
                format!("{} twice among {what}", quoted(name)),
                "every name once".to_string(),
            )
        })?;
    }
    ensure(!seen.is_empty(), || {
        (format!("no {what}"), "at least one".to_string())
    })
}

impl VocabularyFile {
    /// Checks the document, then the movements against it.
    pub(super) fn check(&self) -> Checked {
        self.meta.check()?;
        self.check_frames()
    }

    fn check_frames(&self) -> Checked {
        let count = self.meta.exemplar_count();
        ensure(self.exemplars.len() == count, || {
            (
                format!("movements of {} exemplars", self.exemplars.len()),
                format!("{count}, as listed"),
            )
        })?;
        let dof = self.meta.coordinates.len();
        for (i, exemplar) in self.exemplars.iter().enumerate() {
            let frames = exemplar.root.len();
            ensure(
                frames > 0 && frames.checked_mul(dof) == Some(exemplar.poses.len()),
                || {
                    (
                        format!(
                            "exemplar {i} with {} numbers for {frames} frames",
                            exemplar.poses.len()
                        ),
                        format!("at least one frame, and {dof} numbers each"),
                    )
                },
            )?;
            let mut all = exemplar.poses.iter().chain(exemplar.root.iter().flatten());
            ensure(all.all(|v| v.is_finite()), || {
                (
                    format!("exemplar {i} with a number that is not finite"),
                    "finite numbers".to_string(),
                )
            })?;
        }
        Ok(())
    }
}

impl VocabularyMeta {
    fn check(&self) -> Checked {
        distinct("the program", [&self.program])?;
        distinct("the body", [&self.body])?;
        distinct("coordinates", &self.coordinates)?;
        distinct("primitives", self.primitives.iter().map(|p| &p.name))?;
        ensure(self.exemplar_count() <= MAX_EXEMPLARS, || {
            (
                format!("{} exemplars", self.exemplar_count()),
                format!("{MAX_EXEMPLARS} at most"),
            )
        })?;
        for primitive in &self.primitives {
            primitive.check()?;
        }
        self.check_behaviors()?;
        self.check_transitions()
    }

    fn check_behaviors(&self) -> Checked {
        if self.behaviors.is_empty() {
            return Ok(());
        }
        distinct("behaviors", self.behaviors.iter().map(|b| &b.name))?;
        distinct(
            "groups of behaviors",
            self.behaviors.iter().flat_map(|b| &b.groups),
        )?;
        let primitives: BTreeSet<&str> = self.primitives.iter().map(|p| p.name.as_str()).collect();
        for behavior in &self.behaviors {
            distinct("groups of a behavior", &behavior.groups)?;
            for group in &behavior.groups {
                ensure(primitives.contains(group.as_str()), || {
                    (
                        format!("{} in behavior {}", quoted(group), quoted(&behavior.name)),
                        "a primitive's name".to_string(),
                    )
                })?;
            }
        }
        Ok(())
    }

    fn check_transitions(&self) -> Checked {
        let primitives: BTreeSet<&str> = self.primitives.iter().map(|p| p.name.as_str()).collect();
        let mut seen = BTreeSet::new();
        for t in &self.transitions {
            let told = || format!("a transition from {} to {}", quoted(&t.from), quoted(&t.to));
            let known = [&t.from, &t.to].map(|name| primitives.contains(name.as_str()));
            ensure(known == [true; 2], || {
                (told(), "names of primitives".to_string())
            })?;
            ensure(seen.insert((&t.from, &t.to)) && t.count > 0, || {
                let expected = "every pair once, seen at least once".to_string();
                (format!("{}, {} times", told(), t.count), expected)
            })?;
        }
        Ok(())
    }
}

impl PrimitiveMeta {
    fn check(&self) -> Checked {
        let at = |what: String| format!("primitive {}: {what}", quoted(&self.name));
        ensure(!self.exemplars.is_empty(), || {
            (at("no exemplar".to_string()), "at least one".to_string())
        })?;
        ensure(self.coherence.is_none_or(f64::is_finite), || {
            (
                at("coherence not finite".to_string()),
                "a finite number or null".to_string(),
            )
        })?;
        for e in &self.exemplars {
            distinct("a source motion", [&e.motion])?;
            ensure(
                e.start_secs >= 0.0 && e.end_secs > e.start_secs && e.end_secs.is_finite(),
                || {
                    (
                        at(format!("span {} to {} s", e.start_secs, e.end_secs)),
                        "an end after the start, both finite and not negative".to_string(),
                    )
                },
            )?;
            ensure(e.rate_hz.is_finite() && e.rate_hz > 0.0, || {
                (
                    at(format!("{} Hz", e.rate_hz)),
                    "a positive rate".to_string(),
                )
            })?;
            let hex =
                |h: &str| h.len() == 64 && h.bytes().all(|b| b"0123456789abcdef".contains(&b));
            ensure(e.blake3.as_deref().is_none_or(hex), || {
                (
                    at("a `blake3` that is none".to_string()),
                    "64 lower-case hexadecimal digits".to_string(),
                )
            })?;
        }
        Ok(())
    }
}
