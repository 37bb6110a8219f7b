//! Figures 1 to 7 of the paper, each under its own name, on the choreographed movements that come with the program.
//!
//! What is computed stands here, how it is drawn in `kineme_report::paper`. The paper's own recordings are not public;
//! which movement stands for which of theirs is said in each figure.

mod encoding;
mod field;
mod hands;
mod mixture;
mod synthesis;

pub use encoding::{Encoded, encoded};
pub use field::{FieldView, field_view};
pub use hands::panels;
pub use mixture::{Relaxation, relaxation};
pub use synthesis::chart;

use std::path::Path;
use std::sync::Arc;

use kineme::primitive::Transitions;
use kineme::{Modelling, Skeleton, Vocabulary};
use kineme_formats::output::{self, Existing};
use kineme_formats::script;
use kineme_report::paper;
use rayon::prelude::*;

use crate::demo::Found;
use crate::sets::Result;

/// Pixels of a PNG to one of its SVG.
#[cfg(feature = "png")]
const PNG_SCALE: f64 = 2.0;

/// The figures' names, in their order.
pub const NAMES: [&str; 7] = [
    "figure1", "figure2", "figure3", "figure4", "figure5", "figure6", "figure7",
];

/// The sets of primitives of section V-C: three that it names, and the waving of Figure 2.
const SETS: [(&str, &str); 4] = [
    (
        "vertical-waving.toml",
        include_str!("../../../../choreography/vertical-waving.toml"),
    ),
    (
        "punching.toml",
        include_str!("../../../../choreography/punching.toml"),
    ),
    (
        "twist.toml",
        include_str!("../../../../choreography/twist.toml"),
    ),
    (
        "horizontal-waving.toml",
        include_str!("../../../../choreography/horizontal-waving.toml"),
    ),
];

/// The kinds of file of each figure; without the feature `png` there is SVG alone.
const KINDS: &[&str] = match cfg!(feature = "png") {
    true => &["svg", "png"],
    false => &["svg"],
};

/// The names of the files that [`write()`] writes.
pub fn files() -> Vec<String> {
    let both = |name: &&str| {
        KINDS
            .iter()
            .map(move |kind| format!("{name}.{kind}"))
            .collect::<Vec<_>>()
    };
    NAMES.iter().flat_map(both).collect()
}

/// What each figure shows and how to read it.
pub const CAPTIONS: [&str; 7] = [
    "Hand trajectories of groups that were found in the session: three behaviors, and the least coherent group, since the \
     paper shows one that nobody meant. Dashed is what their primitives interpolate.",
    "A primitive as a flowfield: horizontal waving in the first two principal coordinates of its postures. Arrows are \
     updates of the field, bold lines its exemplars.",
    "How motion is synthesized: flowfields propose, an arbitrator decides, a body moves. Each box is a module.",
    "Classification, first step: when does the observed joint have the observed value? Between the envelopes lies all that \
     the primitive can do with it; the interval of phase is where they enclose the value. Green is the exact answer.",
    "Classification, second step: what the next joint may do within that interval of phase.",
    "Classification, third step: the density that comes of sampling there, as published and exactly.",
    "Trajectory encoding: decision by decision, the primitive that predicts the hands' path best, and the motion that \
     follows from its joints.",
];

/// Figures 1 to 7 as SVG, in their order; `watch` hears of each as it begins. Figure 1 is of what was found in the
/// session, everything else draws nothing at random.
///
/// # Errors
/// When a choreography that comes with the program is not sound, or a step of the computation fails.
pub fn draw(found: &Found, watch: &mut dyn FnMut(&'static str)) -> Result<[String; 7]> {
    watch("figure1");
    let hands = paper::hand_panels(&panels(found)?);
    watch("figure2");
    let ares = Arc::new(kineme::ares()?);
    let waving = vocabulary(&["horizontal-waving.toml"], &ares)?;
    let field = paper::flow(&field_view(waving.primitive("wave-across")?)?.flow);
    watch("figure3");
    let chart = paper::flowchart(&chart());
    watch("figure4");
    let relaxation = relaxation(&punching()?)?;
    watch("figure7");
    let encoded = encoded()?;
    Ok([
        hands,
        field,
        chart,
        paper::mixture(&relaxation.confining()),
        paper::mixture(&relaxation.confined()),
        paper::density(&relaxation.density()?),
        paper::encoded_paths(&encoded.paths),
    ])
}

/// Writes the figures as SVG and as PNG of twice the size into a folder, which is made.
///
/// # Errors
/// When a file exists and is to be kept, or cannot be written.
pub fn write(figures: &[String; 7], folder: &Path, existing: Existing) -> Result<()> {
    for (name, bytes) in files().iter().zip(contents(figures)?) {
        output::write_bytes(&folder.join(name), existing, &bytes)?;
    }
    Ok(())
}

/// What is in the files, in the order of [`files`].
fn contents(figures: &[String; 7]) -> Result<Vec<Vec<u8>>> {
    let of = |svg: &String| -> Result<Vec<Vec<u8>>> {
        #[cfg_attr(not(feature = "png"), expect(unused_mut))]
        let mut both = vec![svg.clone().into_bytes()];
        #[cfg(feature = "png")]
        both.push(kineme_report::png(svg, PNG_SCALE)?);
        Ok(both)
    };
    let all: Vec<Vec<Vec<u8>>> = figures.par_iter().map(of).collect::<Result<_>>()?;
    Ok(all.into_iter().flatten().collect())
}

/// The vocabulary of Figures 4 to 6: punching on Adonis, whose elbows are hinges, so that an angle is an angle.
///
/// # Errors
/// When the choreography is not sound.
pub fn punching() -> Result<Vocabulary> {
    vocabulary(&["punching.toml"], &Arc::new(kineme::adonis()?))
}

/// The primitives of some of the sets in one vocabulary of a body, sets in the order of [`SETS`].
pub(crate) fn vocabulary(names: &[&str], body: &Arc<Skeleton>) -> Result<Vocabulary> {
    let chosen: Vec<_> = SETS.iter().filter(|(n, _)| names.contains(n)).collect();
    let sets: Vec<Vocabulary> = chosen
        .par_iter()
        .map(|&&(name, text)| {
            let script = script::parse(name, text.as_bytes())?;
            Ok(script.vocabulary(body, &Modelling::default(), (name, None))?)
        })
        .collect::<Result<_>>()?;
    let primitives: Vec<_> = sets.iter().flat_map(|v| v.primitives().to_vec()).collect();
    let none = Transitions::none(primitives.len());
    Ok(Vocabulary::new(
        Arc::clone(body),
        primitives,
        Vec::new(),
        none,
    )?)
}

/// The names of all sets.
pub(crate) fn all_sets() -> [&'static str; 4] {
    SETS.map(|(name, _)| name)
}
