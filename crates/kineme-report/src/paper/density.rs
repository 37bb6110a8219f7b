//! The density of a joint's angle, by the paper's samples and exactly: Figure 6.

use super::plot::{Plot, field_swatch, legend, line_swatch, outline};
use crate::axis::extent;
use crate::svg::{Anchor, MARGIN, SMALL, Svg, nothing};

/// Densities over one joint's angle, 1/rad.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Density {
    /// The figure's title.
    pub title: String,
    /// One line under it.
    pub subtitle: String,
    /// One line below the figure.
    pub remark: String,
    /// The joint's name with its unit, at the axis.
    pub joint: String,
    /// Ends of the bins, one more than bins.
    pub edges: Vec<f64>,
    /// The histogram.
    pub bars: Vec<f64>,
    /// Value and density: a smooth estimate from the same samples.
    pub kernel: Vec<[f64; 2]>,
    /// Value and density: the exact conditional.
    pub exact: Vec<[f64; 2]>,
    /// Value and density: uniform over the joint's range, which is what the movement is compared with.
    pub uniform: Vec<[f64; 2]>,
}

const WIDTH: f64 = 820.0;

/// A histogram of samples with their kernel density over it, and the exact conditional density.
pub fn density(figure: &Density) -> String {
    let curves = [&figure.kernel, &figure.exact, &figure.uniform];
    let points = || curves.iter().flat_map(|c| c.iter());
    let most = points().map(|p| p[1]).chain(figure.bars.iter().copied());
    let most = most.filter(|v| v.is_finite()).fold(0.0, f64::max);
    let values = points().map(|p| p[0]).chain(figure.edges.iter().copied());
    let Some(range) = extent(values).filter(|_| most > 0.0) else {
        return nothing(&figure.title, "There is no density to show.");
    };
    let mut svg = Svg::new(WIDTH, 0.0, &figure.title);
    svg.text(MARGIN, 46.0, Anchor::Start, SMALL, &figure.subtitle);
    let bars = field_swatch("class=\"heat\" fill-opacity=\"0.38\"");
    let kernel = line_swatch("class=\"right\" fill=\"none\" stroke-width=\"2\"");
    let exact =
        field_swatch("fill=\"#009e73\" fill-opacity=\"0.3\" stroke=\"#009e73\" stroke-width=\"2\"");
    let uniform =
        line_swatch("class=\"chain\" stroke-dasharray=\"2 3\" style=\"stroke-width:1.6\"");
    legend(
        &mut svg,
        [MARGIN, 70.0],
        &[
            (&bars, "the paper's histogram"),
            (&kernel, "kernel density of its samples"),
            (&exact, "exact conditional"),
            (&uniform, "not the primitive"),
        ],
    );
    let plot = Plot::new(
        range,
        [0.0, 1.08 * most],
        [MARGIN + 52.0, 92.0, WIDTH - MARGIN, 452.0],
    );
    plot.draw(&mut svg, &figure.joint, "density (1/rad)", [8, 6]);
    for (ends, height) in figure.edges.windows(2).zip(&figure.bars) {
        let [a, b] = [ends[0], ends[1]].map(|v| plot.x.at(v));
        let (y, base) = (plot.y.at(*height), plot.y.at(0.0));
        let field = "class=\"heat\" fill-opacity=\"0.38\"";
        svg.rectangle(field, [a + 0.5, y], [b - a - 1.0, base - y], "");
    }
    if let (Some(first), Some(last)) = (figure.exact.first(), figure.exact.last()) {
        let ends = [[last[0], 0.0], [first[0], 0.0]];
        let area: Vec<[f64; 2]> = figure.exact.iter().copied().chain(ends).collect();
        let area = outline(&plot.curve(&area));
        svg.path(
            "fill=\"#009e73\" fill-opacity=\"0.3\" stroke=\"#009e73\" stroke-width=\"2\" stroke-linejoin=\"round\"",
            &area,
        );
    }
    let line = "class=\"right\" fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\"";
    svg.polyline(line, &plot.curve(&figure.kernel));
    let dots = "class=\"chain\" stroke-dasharray=\"2 3\" style=\"stroke-width:1.6\"";
    svg.polyline(dots, &plot.curve(&figure.uniform));
    plot.close(&mut svg);
    svg.text(MARGIN, 508.0, Anchor::Start, SMALL, &figure.remark);
    svg.finish(Some(524.0))
}
