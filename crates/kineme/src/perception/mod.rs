//! Floor 5: recognising movement with the same vocabulary that makes it (paper, section V).

pub mod encoding;
