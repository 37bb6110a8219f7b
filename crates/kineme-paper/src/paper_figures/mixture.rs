//! Figures 4 to 6: how an observed joint confines the phase, how that confines another joint, and what of it is exact.

use kineme::Vocabulary;
use kineme::perception::{Bars, Frame, FrameSettings, Mixture, Paper, PaperSettings, Patch};
use kineme::primitive::{Course, Primitive};
use kineme_report::paper;

use crate::sets::Result;

/// The primitive, the joint that was observed (the paper's joint 2), its value in radians, and the joint whose density
/// is sought (joint 1).
const PRIMITIVE: &str = "punch-out";
const OBSERVED: &str = "right_elbow";
const VALUE_RAD: f64 = 0.9;
const SOUGHT: &str = "right_upper_arm_y";
/// Points of a density's curve.
const POINTS: usize = 241;
/// Strips of the first parameter in which the exact set is counted.
const STRIPS: usize = 24;

/// The steps of section V-A.1.b for one observed joint, by the classifier itself, beside what [`Frame`] says exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    /// The primitive, its place in the vocabulary.
    pub primitive: usize,
    /// The observed coordinate.
    pub observed: usize,
    /// The coordinate whose density is sought.
    pub sought: usize,
    /// The observed value, radians.
    pub value_rad: f64,
    /// Half width of "equals", radians.
    pub delta_rad: f64,
    /// The range of the sought coordinate where the movement is not the primitive, radians.
    pub range_rad: f64,
    /// Mixture space of the observed coordinate (Figure 4) and of the sought one (Figure 5).
    pub mixtures: [Mixture; 2],
    /// The phases that the paper's search finds.
    pub intervals: Vec<[f64; 2]>,
    /// The histogram over them (Figure 6).
    pub histogram: Bars,
    /// All samples of the sought coordinate from these phases: what the histogram counts.
    pub samples: Vec<f64>,
    /// The exact set, with the bounds of the sought coordinate.
    pub exact: Vec<Patch>,
    /// All patches of the primitive.
    pub patches: usize,
    /// Phase and value of each exemplar, observed and sought coordinate.
    exemplars: [Vec<Vec<[f64; 2]>>; 2],
    names: [String; 2],
    parameters: Vec<String>,
    rows: Vec<Vec<f64>>,
}

/// The relaxation in the vocabulary of punching.
///
/// # Errors
/// When the vocabulary lacks the primitive or its coordinates.
pub fn relaxation(vocabulary: &Vocabulary) -> Result<Relaxation> {
    let paper = Paper::new(vocabulary, &PaperSettings::default())?;
    // One tolerance for both, so that what differs is the method.
    let settings = FrameSettings {
        delta_rad: paper.delta_rad(),
        residual: 0.0,
        ..FrameSettings::default()
    };
    let frame = Frame::new(vocabulary, &settings)?;
    let known = vocabulary.primitives().iter();
    let names = known.map(Primitive::name).collect::<Vec<_>>();
    let k = names.iter().position(|n| *n == PRIMITIVE);
    let k = k.ok_or_else(|| format!("no primitive `{PRIMITIVE}` among {names:?}"))?;
    let coordinate = |name: &str| {
        let at = paper.coordinates().iter().position(|n| n == name);
        at.ok_or_else(|| format!("no coordinate `{name}` among {:?}", paper.coordinates()))
    };
    let (observed, sought) = (coordinate(OBSERVED)?, coordinate(SOUGHT)?);
    let mixtures = [paper.mixture(k, observed)?, paper.mixture(k, sought)?];
    let intervals = paper.attained(k, observed, VALUE_RAD, &[[0.0, 1.0]])?;
    let inside = |phase: f64| intervals.iter().any(|i| i[0] <= phase && phase <= i[1]);
    let slices = mixtures[1].phases.iter().zip(&mixtures[1].samples);
    let samples = slices.filter(|(phase, _)| inside(**phase));
    let samples = samples
        .flat_map(|(_, slice)| slice.iter().copied())
        .collect();
    let all = frame.explaining(k, &[], &[])?;
    let mut rows: Vec<Vec<f64>> = all.iter().map(|p| p.parameters.clone()).collect();
    rows.dedup();
    let primitive = &vocabulary.primitives()[k];
    Ok(Relaxation {
        primitive: k,
        observed,
        sought,
        value_rad: VALUE_RAD,
        delta_rad: paper.delta_rad(),
        range_rad: paper.range_rad(sought)?,
        histogram: paper.histogram(k, sought, &intervals)?,
        exact: frame.explaining(k, &[(observed, VALUE_RAD)], &[sought])?,
        patches: all.len(),
        mixtures,
        intervals,
        samples,
        exemplars: [
            exemplars(&paper, primitive, observed)?,
            exemplars(&paper, primitive, sought)?,
        ],
        names: [OBSERVED, SOUGHT].map(str::to_string),
        parameters: primitive
            .parameters()
            .axes()
            .iter()
            .map(|x| x.name.clone())
            .collect(),
        rows,
    })
}

/// A coordinate of each exemplar over phase.
fn exemplars(
    paper: &Paper,
    primitive: &Primitive,
    coordinate: usize,
) -> Result<Vec<Vec<[f64; 2]>>> {
    const POSTURES: usize = 65;
    let line = |i: usize| -> Result<Vec<[f64; 2]>> {
        let course: Course = primitive.at(primitive.point(i))?;
        let at = |k: usize| k as f64 / (POSTURES - 1) as f64;
        let point = |k: usize| Ok([at(k), paper.place(&course.pose(at(k)))?[coordinate]]);
        (0..POSTURES).map(point).collect()
    };
    (0..primitive.exemplars().len()).map(line).collect()
}

impl Relaxation {
    /// Figure 4.
    pub fn confining(&self) -> paper::Mixture {
        let [name, _] = &self.names;
        paper::Mixture {
            title: "Figure 4. When a joint assumes a value: the mixture space of \u{201c}joint 2\u{201d}".into(),
            subtitle: format!(
                "`{PRIMITIVE}`, {name}: f(p, \u{3c4}) assumes {:.2} rad for \u{3c4} \u{2208} {}; the exact set holds {:.0} % of \
                 the pairs (p, \u{3c4}) that these phases admit",
                self.value_rad,
                shown(&self.intervals),
                100.0 * self.share_of_admitted()
            ),
            parameters: Some(self.parameter_set()),
            level: Some([self.value_rad, self.delta_rad]),
            exact: Vec::new(),
            ..self.space(0)
        }
    }

    /// Figure 5.
    pub fn confined(&self) -> paper::Mixture {
        let [observed, name] = &self.names;
        let exact = self.exact.iter().map(|p| paper::Cell {
            phase: p.phase,
            across: p.bounds[0],
            share: 1.0,
        });
        paper::Mixture {
            title: "Figure 5. What another joint may then be: the mixture space of \u{201c}joint 1\u{201d}".into(),
            subtitle: format!(
                "`{PRIMITIVE}`, {name}: the paper samples all of the space over \u{3c4} \u{2208} {}; exactly, {observed} at \
                 {:.2} rad leaves the green part",
                shown(&self.intervals),
                self.value_rad
            ),
            exact: exact.collect(),
            ..self.space(1)
        }
    }

    fn space(&self, which: usize) -> paper::Mixture {
        let m = &self.mixtures[which];
        let ends = m.low.iter().zip(&m.high);
        paper::Mixture {
            joint: format!("{} (rad)", self.names[which]),
            envelope: m
                .phases
                .iter()
                .zip(ends)
                .map(|(t, (l, h))| [*t, *l, *h])
                .collect(),
            exemplars: self.exemplars[which].clone(),
            intervals: self.intervals.clone(),
            ..paper::Mixture::default()
        }
    }

    /// The share of the pairs (p, τ) whose phase the paper's search admits that are in the exact set.
    pub fn share_of_admitted(&self) -> f64 {
        let admitted: f64 = self.intervals.iter().map(|i| i[1] - i[0]).sum();
        let own = |p: &Patch| {
            let overlap = |i: &[f64; 2]| (p.phase[1].min(i[1]) - p.phase[0].max(i[0])).max(0.0);
            self.intervals.iter().map(overlap).sum::<f64>()
        };
        let exact: f64 = self.exact.iter().map(own).sum();
        exact / (admitted * self.rows.len() as f64)
    }

    /// The exact set over phase and the first parameter; the share is over the others.
    fn parameter_set(&self) -> paper::ParameterSet {
        let strip = |p: f64| ((p * STRIPS as f64) as usize).min(STRIPS - 1);
        let mut rows = [0usize; STRIPS];
        for p in &self.rows {
            rows[strip(p.first().copied().unwrap_or(0.0))] += 1;
        }
        let mut cells: Vec<paper::Cell> = Vec::new();
        let width = 1.0 / STRIPS as f64;
        let mut phases: Vec<[f64; 2]> = self.exact.iter().map(|p| p.phase).collect();
        phases.sort_by(|a, b| a[0].total_cmp(&b[0]));
        phases.dedup();
        for phase in phases {
            let mut counts = [0usize; STRIPS];
            for p in self.exact.iter().filter(|p| p.phase == phase) {
                counts[strip(p.parameters.first().copied().unwrap_or(0.0))] += 1;
            }
            for (s, (count, all)) in counts.iter().zip(rows).enumerate() {
                if *count > 0 {
                    cells.push(paper::Cell {
                        phase,
                        across: [s as f64 * width, (s + 1) as f64 * width],
                        share: *count as f64 / all as f64,
                    });
                }
            }
        }
        let first = self.parameters.first().map_or("p", String::as_str);
        let others = self.parameters.get(1..).unwrap_or_default().join(", ");
        paper::ParameterSet {
            name: match others.is_empty() {
                true => first.to_string(),
                false => format!("{first} (shade: share of {others})"),
            },
            cells,
        }
    }

    /// Figure 6.
    ///
    /// # Errors
    /// When there is no sample.
    pub fn density(&self) -> Result<paper::Density> {
        let [observed, name] = &self.names;
        let (first, last) = match (self.histogram.edges.first(), self.histogram.edges.last()) {
            (Some(a), Some(b)) => (a - 2.0 * self.delta_rad, b + 2.0 * self.delta_rad),
            _ => return Err("no histogram".into()),
        };
        let at = |k: usize| first + (last - first) * k as f64 / (POINTS - 1) as f64;
        let curve = |of: &dyn Fn(f64) -> f64| (0..POINTS).map(|k| [at(k), of(at(k))]).collect();
        let width = bandwidth(&self.samples).max(1e-3);
        Ok(paper::Density {
            title: "Figure 6. Density of \u{201c}joint 1\u{201d} where \u{201c}joint 2\u{201d} has that value".into(),
            subtitle: format!(
                "`{PRIMITIVE}`, {name} given {observed} = {:.2} \u{b1} {:.2} rad; {} samples from \u{3c4} \u{2208} {}",
                self.value_rad,
                self.delta_rad,
                self.samples.len(),
                shown(&self.intervals)
            ),
            remark: format!(
                "The histogram forgets which p attained the value; what it holds outside of the green density is that \
                 relaxation. Kernel: Gaussian, {width:.3} rad."
            ),
            joint: format!("{name} (rad)"),
            edges: self.histogram.edges.clone(),
            bars: self.histogram.densities.clone(),
            kernel: curve(&|x| kernel_density(&self.samples, width, x)),
            exact: curve(&|x| self.exact_density(x)),
            uniform: curve(&|_| 1.0 / self.range_rad),
        })
    }

    /// The exact conditional density at a value of the sought coordinate, 1/rad: every patch of the exact set is as
    /// likely, and in each the value is uniform over the patch's bounds widened by the tolerance.
    pub fn exact_density(&self, x: f64) -> f64 {
        let delta = self.delta_rad;
        let own = |p: &Patch| {
            let [low, high] = p.bounds[0];
            let (low, high) = (low - delta, high + delta);
            if (low..=high).contains(&x) {
                1.0 / (high - low)
            } else {
                0.0
            }
        };
        self.exact.iter().map(own).sum::<f64>() / self.exact.len().max(1) as f64
    }
}

fn shown(intervals: &[[f64; 2]]) -> String {
    let one = |i: &[f64; 2]| format!("[{:.2}, {:.2}]", i[0], i[1]);
    intervals
        .iter()
        .map(one)
        .collect::<Vec<_>>()
        .join(" \u{222a} ")
}

/// The bandwidth of Silverman (1986, equation 3.31): 0.9 min(deviation, quartiles' distance / 1.34) n^(-1/5).
fn bandwidth(samples: &[f64]) -> f64 {
    let n = samples.len().max(1) as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let deviation = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    let quartile = |q| kineme::math::statistics::quantile(samples, q).unwrap_or(0.0);
    let spread = (quartile(0.75) - quartile(0.25)) / 1.34;
    0.9 * deviation.min(spread) * n.powf(-0.2)
}

fn kernel_density(samples: &[f64], width: f64, x: f64) -> f64 {
    let own = |s: &f64| (-0.5 * ((x - s) / width).powi(2)).exp();
    let all = samples.len().max(1) as f64 * width * std::f64::consts::TAU.sqrt();
    samples.iter().map(own).sum::<f64>() / all
}
