//! Numbers of a page as text: little-endian bytes in base64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

/// What stands for a coordinate of a point that is not there.
const MISSING: i16 = i16::MIN;

/// Places of points, row by row: 16 bits a coordinate, which tells 0.2 mm apart in a room of 12 m. Of every row but the
/// first the difference to the one before is kept, which is nothing for what stands still and packs small.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Places {
    /// How many rows there are.
    pub rows: usize,
    /// How many points a row has.
    pub points: usize,
    /// Metres a step of the integers.
    pub step: f64,
    /// Differences of integers, row-major, x y z, wrapping round; the lowest integer marks what is missing.
    pub data: String,
}

impl Places {
    /// Packs rows of as many points each, metres. A row of another length than the first is cut or filled with missing
    /// points; what is not finite is missing.
    pub fn pack(rows: &[Vec<[f64; 3]>]) -> Self {
        let points = rows.first().map_or(0, Vec::len);
        let finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
        let all = rows.iter().flatten().filter(|p| finite(p)).flatten();
        let farthest = all.fold(0.0, |most: f64, c| most.max(c.abs()));
        let step = (farthest / f64::from(i16::MAX)).max(1e-6);
        let mut bytes = Vec::with_capacity(rows.len() * points * 6);
        let mut before = vec![0_i16; 3 * points];
        for row in rows {
            for (i, before) in before.iter_mut().enumerate() {
                let place = row.get(i / 3).filter(|p| finite(p));
                let whole = place.map_or(MISSING, |p| (p[i % 3] / step).round() as i16);
                bytes.extend(whole.wrapping_sub(*before).to_le_bytes());
                *before = whole;
            }
        }
        Self {
            rows: rows.len(),
            points,
            step,
            data: STANDARD.encode(bytes),
        }
    }

    /// The rows again, to half a step; `None` where a point is missing. Empty where the text is not as many places.
    pub fn unpack(&self) -> Vec<Vec<Option<[f64; 3]>>> {
        let bytes = STANDARD.decode(&self.data).unwrap_or_default();
        if self.points == 0 || bytes.len() != self.rows * self.points * 6 {
            return Vec::new();
        }
        let mut whole = vec![[0_i16; 3]; self.points];
        let place = |whole: &[i16; 3]| {
            (!whole.contains(&MISSING)).then(|| whole.map(|w| f64::from(w) * self.step))
        };
        let rows = bytes.chunks_exact(self.points * 6).map(|row| {
            for (at, by) in whole.as_flattened_mut().iter_mut().zip(row.chunks_exact(2)) {
                *at = at.wrapping_add(i16::from_le_bytes([by[0], by[1]]));
            }
            whole.iter().map(place).collect()
        });
        rows.collect()
    }
}

/// Plain numbers of single precision.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Floats(String);

impl Floats {
    /// Packs numbers; what is not finite becomes 0.
    pub fn pack(values: impl IntoIterator<Item = f64>) -> Self {
        let finite = |v: f64| if v.is_finite() { v as f32 } else { 0.0 };
        let bytes: Vec<u8> = values
            .into_iter()
            .flat_map(|v| finite(v).to_le_bytes())
            .collect();
        Self(STANDARD.encode(bytes))
    }

    /// The numbers again.
    pub fn unpack(&self) -> Vec<f32> {
        let bytes = STANDARD.decode(&self.0).unwrap_or_default();
        let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        bytes.chunks_exact(4).map(number).collect()
    }
}

/// Shares in [0, 1], a byte each.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Shares(String);

impl Shares {
    /// Packs shares; what lies outside is brought to the nearer end, what is no number to 0.
    pub fn pack(values: impl IntoIterator<Item = f64>) -> Self {
        let byte = |v: f64| (255.0 * v.clamp(0.0, 1.0)).round() as u8;
        let bytes: Vec<u8> = values.into_iter().map(byte).collect();
        Self(STANDARD.encode(bytes))
    }

    /// The shares again, to 1/510.
    pub fn unpack(&self) -> Vec<f64> {
        let bytes = STANDARD.decode(&self.0).unwrap_or_default();
        bytes.into_iter().map(|b| f64::from(b) / 255.0).collect()
    }
}
