//! [`Clock`]: how far into a course a body is, seconds after it was told to begin.

/// Time of a course against time since its beginning.
///
/// The clock runs evenly, but where a body needs longer than `blend` to join the course: then the course waits, or
/// begins slowly, so that it has run for `blend` seconds when the body has joined it at `join`. Otherwise a short
/// movement would be over before a body that comes from afar does anything of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    /// Seconds until the body has joined.
    pub join: f64,
    /// Seconds that the course has run by then; not more than `join`.
    pub blend: f64,
    /// Seconds that the course runs altogether, at least `blend`; infinite when nobody said.
    pub whole: f64,
}

impl Clock {
    /// The seconds that the course has run `t` seconds after the beginning, and at what rate it runs.
    ///
    /// The rate rises as a smooth step (cubic) over the last two blends before `join`, from zero or from what makes the
    /// sum right; it is continuous and rises by at most `0.75 / blend` a second.
    pub fn at(&self, t: f64) -> (f64, f64) {
        if t >= self.join {
            return (self.blend + (t - self.join), 1.0);
        }
        let ramp = self.join.min(2.0 * self.blend);
        let since = t - (self.join - ramp);
        if since <= 0.0 && ramp < self.join {
            return (0.0, 0.0);
        }
        let first = (2.0 * self.blend / self.join - 1.0).max(0.0);
        let s = since / ramp;
        let step = s * s * (3.0 - 2.0 * s);
        let area = s * s * s * (1.0 - 0.5 * s);
        (
            ramp * (first * s + (1.0 - first) * area),
            first + (1.0 - first) * step,
        )
    }

    /// Seconds from the beginning until the course has run for the whole.
    pub fn end(&self) -> f64 {
        self.join + (self.whole - self.blend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_runs_forward_and_has_run_for_a_blend_when_the_body_has_joined() {
        for (join, blend) in [
            (0.0, 0.0),
            (0.4, 0.4),
            (0.5, 0.4),
            (0.8, 0.4),
            (3.0, 0.4),
            (0.4, 0.1),
        ] {
            let clock = Clock {
                join,
                blend,
                whole: 1.0,
            };
            let h = 1e-4;
            let mut before = clock.at(0.0);
            assert_eq!(before.0, 0.0);
            for k in 1..=50_000 {
                let t = f64::from(k) * h;
                let now = clock.at(t);
                let mean = (now.0 - before.0) / h;
                assert!(
                    (mean - 0.5 * (now.1 + before.1)).abs() < 1e-6,
                    "{join} {blend} {t}"
                );
                assert!((0.0..=1.0 + 1e-12).contains(&now.1));
                assert!(
                    now.1 - before.1 <= 1.01 * 0.75 * h / blend.max(1e-9),
                    "{join} {blend} {t}"
                );
                before = now;
            }
            assert!((clock.at(join).0 - blend).abs() < 1e-12);
            assert!((clock.at(clock.end()).0 - clock.whole).abs() < 1e-12);
        }
    }
}
