//! From a column of times or frame numbers to an even grid of frames.

use super::positions::DEFAULT_RATE_HZ;
use crate::error::{FormatError, Place, Result};
use crate::sheet::Row;

/// The time column as it is read.
#[derive(Default)]
pub(super) struct Clock {
    readings: Vec<f64>,
}

/// An even grid of frames and the frame of each row.
pub(super) struct Grid {
    pub rate_hz: f64,
    pub frames: usize,
    pub frame_of_row: Vec<usize>,
}

impl Clock {
    /// Readings that are known to rise.
    pub fn of(readings: Vec<f64>) -> Self {
        Self { readings }
    }

    /// The next reading, seconds or a frame number; it must rise.
    pub fn push(&mut self, reading: f64, row: &Row<'_>) -> Result<()> {
        if let Some(last) = self.readings.last()
            && reading <= *last
        {
            return Err(row.error(
                format!("{reading} after {last}"),
                "frames or times that rise",
            ));
        }
        self.readings.push(reading);
        Ok(())
    }

    /// Lays the rows on a grid whose step is the median step: rows that were dropped leave frames out.
    ///
    /// Times give the rate themselves (`timed`). Frame numbers count at `rate_hz`, so a table of every
    /// fourth frame has a quarter of that rate.
    pub fn grid(
        &self,
        file: &str,
        timed: bool,
        rate_hz: Option<f64>,
        warnings: &mut Vec<String>,
    ) -> Result<Grid> {
        let error =
            |found: String, expected: &str| FormatError::new(file, Place::File, found, expected);
        let (Some(first), Some(last)) = (self.readings.first(), self.readings.last()) else {
            return Err(error("no row".to_string(), "at least one frame"));
        };
        let steps: Vec<f64> = self.readings.windows(2).map(|w| w[1] - w[0]).collect();
        let mut sorted = steps.clone();
        sorted.sort_by(f64::total_cmp);
        // The lower median: of two steps the longer is the gap.
        let median = sorted.get(sorted.len().saturating_sub(1) / 2).copied();

        // A grid far longer than the table is a broken time column, not a gap, and would cost memory.
        let most = 4 * self.readings.len();
        let mut frame = 0usize;
        let mut frame_of_row = vec![0];
        for step in &steps {
            let ratio = median.map_or(1.0, |m| (step / m).round().max(1.0));
            if ratio > (most - frame) as f64 {
                return Err(error(
                    format!("gaps of {ratio} frames and more"),
                    "frames or times without such gaps",
                ));
            }
            frame += ratio as usize;
            frame_of_row.push(frame);
        }
        let rows = self.readings.len();
        if frame + 1 > rows {
            warnings.push(format!("{} frames are not in the table", frame + 1 - rows));
        }
        let span = last - first;
        let rate_hz = if timed && frame > 0 {
            let rate = frame as f64 / span;
            let jitter = frame_of_row
                .iter()
                .zip(&self.readings)
                .map(|(f, t)| ((t - first) * rate - *f as f64).abs())
                .fold(0.0, f64::max);
            if jitter > 0.25 {
                warnings.push(format!(
                    "times are up to {:.1} ms off an even {rate:.3} Hz",
                    1000.0 * jitter / rate
                ));
            }
            rate
        } else {
            let counter = rate_hz.unwrap_or_else(|| {
                warnings.push(format!("no time base: {DEFAULT_RATE_HZ} Hz assumed"));
                DEFAULT_RATE_HZ
            });
            counter * if frame > 0 { frame as f64 / span } else { 1.0 }
        };
        Ok(Grid {
            rate_hz,
            frames: frame + 1,
            frame_of_row,
        })
    }
}
