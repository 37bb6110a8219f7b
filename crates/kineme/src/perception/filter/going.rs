//! How a body goes on: what the last looks tell of its velocity.

use super::features::Feature;

/// How the numbers of a feature went on since the look before.
#[derive(Debug, Clone)]
pub(super) struct Going {
    /// Seconds since then.
    pub secs: f64,
    /// How far each number went.
    pub step: Vec<f64>,
    /// What of this is not explained by the velocity until then; nothing where that is not known.
    pub surprise: Option<Vec<f64>>,
}

/// What is kept of the last looks.
#[derive(Debug, Clone, Default)]
pub(super) struct Looks {
    latest: Option<Feature>,
    /// How the latest look went on from the one before it.
    step: Option<(Vec<f64>, f64)>,
}

impl Looks {
    /// How a feature goes on from the latest one, so many seconds before; nothing where they lack different numbers.
    pub fn take(&mut self, feature: &Feature, secs: f64) -> Option<Going> {
        let latest = self.latest.replace(feature.clone());
        let earlier = self.step.take();
        let latest = latest.filter(|l| l.unknown == feature.unknown)?;
        let pairs = feature.values.iter().zip(&latest.values);
        let step: Vec<f64> = pairs.map(|(now, then)| now - then).collect();
        let surprise = earlier.map(|(before, lasted)| {
            let pairs = step.iter().zip(&before);
            let surprise = pairs.map(|(now, then)| now - then * secs / lasted);
            surprise.collect::<Vec<f64>>()
        });
        self.step = Some((step.clone(), secs));
        Some(Going {
            secs,
            step,
            surprise,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_velocity_is_no_surprise() {
        let mut looks = Looks::default();
        let mut going = None;
        for k in 0..60 {
            let feature = Feature {
                values: vec![2.0 * f64::from(k) / 60.0],
                unknown: vec![false],
            };
            going = looks.take(&feature, 1.0 / 60.0);
        }
        let going = going.unwrap();
        assert!((going.step[0] - 2.0 / 60.0).abs() < 1e-12);
        assert!(going.surprise.unwrap()[0].abs() < 1e-12);
    }
}
