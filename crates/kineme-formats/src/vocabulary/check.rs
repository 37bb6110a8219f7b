//! What makes a vocabulary file valid, on the way in and on the way out.

use std::collections::BTreeSet;

use super::{
    CalibrationMeta, ExemplarMeta, ExemplarTensors, FitMeta, FitTensors, MAX_EXEMPLARS,
    PrimitiveMeta, SourceMeta, VocabularyFile, VocabularyMeta,
};
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

/// Finite numbers only: others the document cannot even say.
fn finite<'a>(what: impl Fn() -> String, numbers: impl IntoIterator<Item = &'a f64>) -> Checked {
    ensure(numbers.into_iter().all(|v| v.is_finite()), || {
        let found = format!("{} with a number that is not finite", what());
        (found, "finite numbers".to_string())
    })
}

impl VocabularyFile {
    /// Checks the document, then the numbers against it. What numbers mean is for the library to check.
    pub(super) fn check(&self) -> Checked {
        self.meta.check()?;
        let (count, primitives) = (self.meta.exemplar_count(), self.meta.primitives.len());
        ensure(
            self.exemplars.len() == count && self.fits.len() == primitives,
            || {
                let (exemplars, fits) = (self.exemplars.len(), self.fits.len());
                (
                    format!("movements of {exemplars} exemplars and fits of {fits} primitives"),
                    format!("{count} and {primitives}, as listed"),
                )
            },
        )?;
        for (i, exemplar) in self.exemplars.iter().enumerate() {
            exemplar.check(i, self.meta.coordinates.len())?;
        }
        let fits = self.fits.iter().zip(&self.meta.primitives);
        for (fit, primitive) in fits {
            fit.check(primitive, self.meta.landmarks as usize)?;
        }
        Ok(())
    }
}

impl ExemplarTensors {
    fn check(&self, i: usize, dof: usize) -> Checked {
        let frames = self.root.len();
        ensure(
            frames > 0 && frames.checked_mul(dof) == Some(self.poses.len()),
            || {
                let numbers = self.poses.len();
                (
                    format!("exemplar {i} with {numbers} numbers for {frames} frames"),
                    format!("at least one frame, and {dof} numbers each"),
                )
            },
        )?;
        let all = self.poses.iter().chain(self.root.as_flattened());
        finite(|| format!("exemplar {i}"), all.chain(&self.warp))
    }
}

impl FitTensors {
    fn check(&self, primitive: &PrimitiveMeta, landmarks: usize) -> Checked {
        let of = |what: &str| format!("{what} of primitive {}", quoted(&primitive.name));
        let dims = primitive.fit.parameters.len();
        let points = primitive.exemplars.len().checked_mul(dims);
        ensure(points == Some(self.points.len()), || {
            let found = format!("{} {}", self.points.len(), of("parameters"));
            (found, format!("{dims} an exemplar"))
        })?;
        ensure(self.reference.len().is_multiple_of(landmarks), || {
            let found = format!("{} {}", self.reference.len(), of("reference numbers"));
            (found, format!("{landmarks} a knot"))
        })?;
        finite(|| of("parameters"), &self.points)?;
        finite(|| of("reference"), &self.reference)?;
        let transform = (
            primitive.fit.source == SourceMeta::Principal,
            &self.principal,
        );
        match transform {
            (false, None) => Ok(()),
            (true, Some(principal)) => {
                let (mean, directions) = (&principal.mean, &principal.directions);
                ensure(
                    mean.len().checked_mul(dims) == Some(directions.len()),
                    || {
                        let found = format!("{} {}", directions.len(), of("direction numbers"));
                        (found, format!("{dims} directions of {}", mean.len()))
                    },
                )?;
                finite(
                    || of("principal coordinates"),
                    mean.iter().chain(directions),
                )
            }
            (wanted, _) => Err((
                of(if wanted {
                    "no transform"
                } else {
                    "a transform"
                }),
                "one where parameters are principal coordinates, else none".to_string(),
            )),
        }
    }
}

impl VocabularyMeta {
    fn check(&self) -> Checked {
        distinct("the program", [&self.program])?;
        distinct("the body", [&self.body])?;
        distinct("coordinates", &self.coordinates)?;
        ensure(self.landmarks > 0, || {
            ("no landmarks".to_string(), "at least one".to_string())
        })?;
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
        self.check_transitions()?;
        self.check_calibrations()
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

    fn check_calibrations(&self) -> Checked {
        if self.calibrations.is_empty() {
            return Ok(());
        }
        distinct(
            "calibrated recognisers",
            self.calibrations.iter().map(|c| &c.recogniser),
        )?;
        let mut all = self.calibrations.iter();
        all.try_for_each(|c| c.check(&self.primitives))
    }
}

impl CalibrationMeta {
    fn check(&self, primitives: &[PrimitiveMeta]) -> Checked {
        let at = |what: &str| format!("{what} in the calibration of {}", quoted(&self.recogniser));
        let names = self.primitives.iter().map(|p| &p.name);
        ensure(names.eq(primitives.iter().map(|p| &p.name)), || {
            let expected = "every primitive of the vocabulary, in its order";
            (at("other primitives"), expected.to_string())
        })?;
        let rows = self.primitives.iter().map(|p| &p.numbers);
        let equal = self.primitives.windows(2);
        ensure(
            equal
                .into_iter()
                .all(|w| w[0].numbers.len() == w[1].numbers.len()),
            || {
                let expected = "equally many of each primitive".to_string();
                (at("unequal numbers"), expected)
            },
        )?;
        finite(|| at("a primitive"), rows.flatten().chain(&self.shared))
    }
}

impl PrimitiveMeta {
    fn check(&self) -> Checked {
        let at = |what: String| format!("primitive {}: {what}", quoted(&self.name));
        ensure(!self.exemplars.is_empty(), || {
            (at("no exemplar".to_string()), "at least one".to_string())
        })?;
        let coherence = self.group.iter().filter_map(|g| g.coherence.as_ref());
        finite(|| at("coherence".to_string()), coherence)?;
        self.fit.check(&at)?;
        self.exemplars.iter().try_for_each(|e| e.check(&at))
    }
}

impl FitMeta {
    fn check(&self, at: &impl Fn(String) -> String) -> Checked {
        let ranges = self.parameters.iter().flat_map(|p| [&p.low, &p.high]);
        finite(|| at("parameters".to_string()), ranges)?;
        finite(|| at("method".to_string()), &self.method.numbers())?;
        for trial in &self.trials {
            let numbers = trial.method.numbers();
            let numbers = numbers.iter().chain([&trial.error_m]);
            finite(|| at("trials".to_string()), numbers)?;
        }
        let errors = self.error.iter();
        let errors = errors.flat_map(|e| [&e.joint_rad, &e.wrist_m, &e.nearest_m, &e.mean_m]);
        finite(|| at("error".to_string()), errors)
    }
}

impl ExemplarMeta {
    fn check(&self, at: &impl Fn(String) -> String) -> Checked {
        distinct("a source motion", [&self.motion])?;
        ensure(
            self.start_secs >= 0.0 && self.end_secs > self.start_secs && self.end_secs.is_finite(),
            || {
                (
                    at(format!("span {} to {} s", self.start_secs, self.end_secs)),
                    "an end after the start, both finite and not negative".to_string(),
                )
            },
        )?;
        ensure(self.rate_hz.is_finite() && self.rate_hz > 0.0, || {
            (
                at(format!("{} Hz", self.rate_hz)),
                "a positive rate".to_string(),
            )
        })?;
        let hex = |h: &str| h.len() == 64 && h.bytes().all(|b| b"0123456789abcdef".contains(&b));
        ensure(self.blake3.as_deref().is_none_or(hex), || {
            (
                at("a `blake3` that is none".to_string()),
                "64 lower-case hexadecimal digits".to_string(),
            )
        })?;
        finite(|| at("adverbs".to_string()), self.adverbs.iter().flatten())?;
        let [first, last] = self.used;
        // A shorter part has no duration to speak of.
        ensure(
            first.is_finite() && last.is_finite() && last - first >= 1.0,
            || {
                (
                    at(format!("frames {first} to {last} used")),
                    "a part at least a frame long".to_string(),
                )
            },
        )?;
        ensure((0.0..1.0).contains(&self.shift), || {
            (
                at(format!("shift {}", self.shift)),
                "a share from 0 to less than 1".to_string(),
            )
        })
    }
}
