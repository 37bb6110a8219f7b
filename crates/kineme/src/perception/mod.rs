//! Floor 5: recognising movement with the same vocabulary that makes it (paper, section V).

mod alarm;
mod calibration;
mod checked;
pub mod encoding;
mod filter;
mod frame;
mod outline;
mod pairs;
mod paper;
mod parts;
mod restriction;
mod rows;
mod spans;
mod temperature;

pub use alarm::{Alarm, AlarmSettings};
pub use calibration::calibrated;
pub use filter::{Filter, FilterSettings};
pub use frame::{Frame, FrameSettings, Patch};
pub use paper::{Bars, Mixture, Paper, PaperSettings};
pub use restriction::{Restricted, Restriction};
