//! The header and the parameters of a C3D file: numbers in the writer's own byte order, named values in groups.

use crate::error::{FormatError, Place, Result};
use crate::text::decoded;

/// Bytes of a block, in which places of sections are counted.
pub const BLOCK: usize = 512;

/// The second byte of every C3D file, and of its parameter section.
pub const KEY: u8 = 0x50;

/// The processor that wrote the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Processor {
    /// Little-endian, IEEE.
    Intel,
    /// Little-endian words, the higher word of a real number first, four times an IEEE one.
    Dec,
    /// Big-endian, IEEE (MIPS, SGI).
    Mips,
}

impl Processor {
    /// A 16-bit word without a sign; zero beyond the end.
    pub fn word(self, bytes: &[u8], at: usize) -> u16 {
        let two = array(bytes, at);
        match self {
            Self::Intel | Self::Dec => u16::from_le_bytes(two),
            Self::Mips => u16::from_be_bytes(two),
        }
    }

    /// A 16-bit word with a sign; zero beyond the end.
    pub fn signed(self, bytes: &[u8], at: usize) -> i16 {
        self.word(bytes, at).cast_signed()
    }

    /// A 32-bit real; zero beyond the end.
    pub fn real(self, bytes: &[u8], at: usize) -> f32 {
        let four: [u8; 4] = array(bytes, at);
        match self {
            Self::Intel => f32::from_le_bytes(four),
            Self::Mips => f32::from_be_bytes(four),
            Self::Dec => f32::from_le_bytes([four[2], four[3], four[0], four[1]]) / 4.0,
        }
    }
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let end = at.saturating_add(N);
    bytes
        .get(at..end)
        .and_then(|b| b.try_into().ok())
        .unwrap_or([0; N])
}

/// A parameter: `POINT:LABELS`, say.
#[derive(Debug, Clone)]
struct Parameter<'a> {
    group: i8,
    name: String,
    /// Bytes of a value: -1 text, 1, 2, 4 (real).
    kind: i8,
    dimensions: Vec<usize>,
    data: &'a [u8],
}

/// The named values of a file.
#[derive(Debug, Clone)]
pub struct Parameters<'a> {
    /// In whose numbers the file is written.
    pub processor: Processor,
    groups: Vec<(i8, String)>,
    all: Vec<Parameter<'a>>,
}

impl<'a> Parameters<'a> {
    /// Reads the section that the header's first byte points to.
    ///
    /// # Errors
    /// When the file is no C3D, or a record reaches beyond the end of the file.
    pub fn read(name: &str, bytes: &'a [u8]) -> Result<Self> {
        let error = |at: usize, found: String, expected: &str| {
            FormatError::new(name, Place::Byte(at), found, expected)
        };
        if bytes.len() < 2 * BLOCK || bytes[1] != KEY || bytes[0] < 2 {
            let found = match bytes.len() {
                0..2 => "an empty file".into(),
                _ => format!(
                    "{} bytes that begin {:#04x} {:#04x}",
                    bytes.len(),
                    bytes[0],
                    bytes[1]
                ),
            };
            let expected =
                "a C3D file: a header of 512 bytes, the second of them 0x50, and parameters";
            return Err(error(0, found, expected));
        }
        let start = (usize::from(bytes[0]) - 1) * BLOCK;
        let head = bytes.get(start..start + 4).ok_or_else(|| {
            let found = format!(
                "parameters in block {}, beyond the end of the file",
                bytes[0]
            );
            error(0, found, "the block in which the parameters begin")
        })?;
        let processor = match head[3] {
            84 => Processor::Intel,
            85 => Processor::Dec,
            86 => Processor::Mips,
            other => {
                let expected = "84 (Intel), 85 (DEC) or 86 (MIPS)";
                return Err(error(start + 3, format!("processor {other}"), expected));
            }
        };
        let mut parameters = Self {
            processor,
            groups: Vec::new(),
            all: Vec::new(),
        };
        let mut at = start + 4;
        while let Some(&[length, group]) = bytes.get(at..at + 2) {
            let (length, group) = (length.cast_signed(), group.cast_signed());
            if length == 0 || group == 0 {
                break;
            }
            // A negative length locks the parameter.
            let text = at + 2;
            let link = text + usize::from(length.unsigned_abs());
            let cut = |what: &str| error(at, what.to_string(), "a whole record inside the file");
            let title = bytes
                .get(text..link)
                .ok_or_else(|| cut("a name cut short"))?;
            let title = decoded(title).trim().to_ascii_uppercase();
            let offset = usize::from(processor.word(bytes, link));
            let body = link + 2;
            if group < 0 {
                parameters.groups.push((-(group.max(-127)), title));
            } else {
                let parameter = parameter(bytes, body, group, title)
                    .ok_or_else(|| cut("a parameter cut short"))?;
                parameters.all.push(parameter);
            }
            if offset == 0 {
                break;
            }
            // Offsets count from where they stand, so that one of less than two would not go on.
            at = link + offset.max(2);
        }
        Ok(parameters)
    }

    fn find(&self, group: &str, name: &str) -> Option<&Parameter<'a>> {
        let (id, _) = self.groups.iter().find(|(_, title)| title == group)?;
        let own = |p: &&Parameter<'_>| p.group == *id && p.name == name;
        self.all.iter().find(own)
    }

    /// Numbers of a parameter: whole ones without sign, or real ones. Empty where there is none.
    pub fn numbers(&self, group: &str, name: &str) -> Vec<f64> {
        let Some(p) = self.find(group, name) else {
            return Vec::new();
        };
        match p.kind {
            1 => p.data.iter().map(|b| f64::from(*b)).collect(),
            2 => (0..p.data.len() / 2)
                .map(|i| f64::from(self.processor.word(p.data, 2 * i)))
                .collect(),
            4 => (0..p.data.len() / 4)
                .map(|i| f64::from(self.processor.real(p.data, 4 * i)))
                .collect(),
            _ => Vec::new(),
        }
    }

    /// Texts of a parameter, without the blanks that fill them up. Empty where there is none.
    pub fn texts(&self, group: &str, name: &str) -> Vec<String> {
        let Some(p) = self.find(group, name).filter(|p| p.kind == -1) else {
            return Vec::new();
        };
        let length = p.dimensions.first().copied().unwrap_or(p.data.len());
        let blank = |c: char| c.is_whitespace() || c == '\0';
        let chunks = p.data.chunks_exact(length.max(1));
        chunks
            .map(|c| decoded(c).trim_matches(blank).to_owned())
            .collect()
    }

    /// The one text of a parameter.
    pub fn text(&self, group: &str, name: &str) -> Option<String> {
        let text = self.texts(group, name).into_iter().next()?;
        (!text.is_empty()).then_some(text)
    }
}

/// The value of a parameter; `None` when the file ends within it.
fn parameter(bytes: &[u8], body: usize, group: i8, name: String) -> Option<Parameter<'_>> {
    let &[kind, count] = bytes.get(body..body + 2)? else {
        return None;
    };
    let data = body + 2 + usize::from(count);
    let dimensions: Vec<usize> = bytes
        .get(body + 2..data)?
        .iter()
        .map(|d| usize::from(*d))
        .collect();
    let values = dimensions
        .iter()
        .try_fold(1usize, |n, d| n.checked_mul(*d))?;
    let kind = kind.cast_signed();
    let length = values.checked_mul(usize::from(kind.unsigned_abs()))?;
    Some(Parameter {
        group,
        name,
        kind,
        dimensions,
        data: bytes.get(data..data.checked_add(length)?)?,
    })
}
