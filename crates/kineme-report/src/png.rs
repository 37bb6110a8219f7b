//! Figures as PNG, for programs that show no SVG.

use std::fmt;
use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Why a figure could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PngError(String);

impl fmt::Display for PngError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no PNG: {}", self.0)
    }
}

impl std::error::Error for PngError {}

/// The most pixels of a side.
const MOST_PIXELS: f64 = 16_384.0;

/// An SVG as a PNG of `scale` pixels a unit, in its light colours. Text is set in a font that comes with the program, so
/// that every machine draws the same bytes.
///
/// # Errors
/// When the text is no SVG, or the picture would have no pixel or more than 16384 along a side.
pub fn png(svg: &str, scale: f64) -> Result<Vec<u8>, PngError> {
    let fonts = fonts();
    let options = Options {
        font_family: fonts.family.clone(),
        fontdb: Arc::clone(&fonts.database),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|e| PngError(e.to_string()))?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|v| (f64::from(v) * scale).round());
    let fits = |v: f64| (1.0..=MOST_PIXELS).contains(&v);
    if !fits(width) || !fits(height) {
        return Err(PngError(format!("a picture of {width} x {height} pixels")));
    }
    let mut pixels = Pixmap::new(width as u32, height as u32)
        .ok_or_else(|| PngError("no memory for the picture".into()))?;
    let scale = scale as f32;
    let transform = Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| PngError(e.to_string()))
}

struct Fonts {
    database: Arc<fontdb::Database>,
    family: String,
}

/// The fonts, read once.
fn fonts() -> &'static Fonts {
    static FONTS: OnceLock<Fonts> = OnceLock::new();
    FONTS.get_or_init(|| {
        let mut database = fontdb::Database::new();
        database.load_font_data(dejavu::sans_condensed::regular().to_vec());
        database.load_font_data(dejavu::sans_condensed::bold().to_vec());
        let names = database.faces().flat_map(|face| &face.families);
        let family = names.map(|(name, _)| name.clone()).next();
        let family = family.unwrap_or_else(|| "DejaVu Sans".into());
        // Whatever a figure asks for, these are what there is.
        database.set_sans_serif_family(&family);
        Fonts {
            database: Arc::new(database),
            family,
        }
    })
}
