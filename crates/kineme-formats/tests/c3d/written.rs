//! C3D files made by hand, byte by byte as the format's manual has them.

/// How coordinates are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbers {
    /// 16-bit, of a scale of 1/64.
    Whole,
    /// 32-bit.
    Real,
}

const SCALE: f32 = 1.0 / 64.0;

#[derive(Debug, Clone)]
pub struct Written {
    /// 84 Intel, 85 DEC, 86 MIPS.
    pub processor: u8,
    pub numbers: Numbers,
    /// Analog samples a frame.
    pub analog: u16,
    pub labels: Vec<String>,
    /// Whether labels after the first stand in `LABELS2`.
    pub split: bool,
    pub unit: String,
    pub screen: String,
    pub rate_hz: f32,
    /// Frame by frame; `None` with a negative residual.
    pub points: Vec<Vec<Option<[f32; 3]>>>,
    /// Whether `TRIAL` says which frames there are; else `POINT:LONG_FRAMES` where the header cannot.
    pub actual_field: bool,
}

impl Written {
    /// Two frames of three markers, one of them unseen at first.
    pub fn small() -> Self {
        Self {
            processor: 84,
            numbers: Numbers::Real,
            analog: 0,
            labels: ["A", "B", "C"].map(String::from).into(),
            split: false,
            unit: "m".into(),
            screen: "+Z".into(),
            rate_hz: 50.0,
            points: vec![
                vec![Some([0.25, -1.5, 0.75]), Some([0.0, 0.5, 1.0]), None],
                vec![
                    Some([0.5, -1.5, 0.75]),
                    Some([0.0, 0.5, 1.25]),
                    Some([2.0, 0.0, 0.0]),
                ],
            ],
            actual_field: false,
        }
    }

    fn word(&self, value: u16) -> [u8; 2] {
        match self.processor {
            86 => value.to_be_bytes(),
            _ => value.to_le_bytes(),
        }
    }

    fn real(&self, value: f32) -> [u8; 4] {
        match self.processor {
            86 => value.to_be_bytes(),
            85 => {
                let b = (4.0 * value).to_le_bytes();
                [b[2], b[3], b[0], b[1]]
            }
            _ => value.to_le_bytes(),
        }
    }

    fn record(&self, name: &str, group: i8, body: &[u8]) -> Vec<u8> {
        let mut record = vec![name.len() as u8, group.cast_unsigned()];
        record.extend(name.as_bytes());
        record.extend(self.word(2 + body.len() as u16));
        record.extend(body);
        record
    }

    fn texts(&self, name: &str, texts: &[String]) -> Vec<u8> {
        let length = texts.iter().map(String::len).max().unwrap_or(0);
        let mut body = vec![(-1i8).cast_unsigned(), 2, length as u8, texts.len() as u8];
        for text in texts {
            body.extend(format!("{text:length$}").as_bytes());
        }
        body.push(0);
        self.record(name, 1, &body)
    }

    fn numbers(&self, name: &str, group: i8, kind: u8, bytes: &[u8]) -> Vec<u8> {
        let mut body = vec![kind, 1, (bytes.len() / usize::from(kind)) as u8];
        body.extend(bytes);
        body.push(0);
        self.record(name, group, &body)
    }

    fn parameters(&self) -> Vec<u8> {
        let mut section = vec![1, 0x50, 1, self.processor];
        section.extend(self.record("POINT", -1, &[0]));
        section.extend(self.record("TRIAL", -2, &[0]));
        let first = if self.split { 1 } else { self.labels.len() };
        section.extend(self.texts("LABELS", &self.labels[..first]));
        if self.split && first < self.labels.len() {
            section.extend(self.texts("LABELS2", &self.labels[first..]));
        }
        section.extend(self.texts("UNITS", std::slice::from_ref(&self.unit)));
        section.extend(self.texts("Y_SCREEN", std::slice::from_ref(&self.screen)));
        section.extend(self.numbers("RATE", 1, 4, &self.real(self.rate_hz)));
        let frames = self.points.len() as u32;
        if self.actual_field {
            for (name, frame) in [("ACTUAL_START_FIELD", 1), ("ACTUAL_END_FIELD", frames)] {
                let words = [frame as u16, (frame >> 16) as u16].map(|w| self.word(w));
                section.extend(self.numbers(name, 2, 2, &words.concat()));
            }
        } else if frames > 65_535 {
            section.extend(self.numbers("LONG_FRAMES", 1, 4, &self.real(frames as f32)));
        }
        section.extend([0, 0]);
        section.resize(section.len().div_ceil(512) * 512, 0);
        section
    }

    pub fn bytes(&self) -> Vec<u8> {
        let parameters = self.parameters();
        let mut bytes = vec![2, 0x50];
        bytes.extend(self.word(self.points[0].len() as u16));
        bytes.extend(self.word(self.analog));
        bytes.extend(self.word(1));
        bytes.extend(self.word(self.points.len().min(65_535) as u16));
        bytes.extend(self.word(10));
        let whole = self.numbers == Numbers::Whole;
        bytes.extend(self.real(if whole { SCALE } else { -SCALE }));
        bytes.extend(self.word(2 + (parameters.len() / 512) as u16));
        bytes.extend(self.word(1));
        bytes.extend(self.real(self.rate_hz));
        bytes.resize(512, 0);
        bytes.extend(parameters);
        for frame in &self.points {
            for point in frame {
                let [x, y, z] = point.unwrap_or_default();
                let residual = if point.is_some() { 0.0 } else { -1.0 };
                for value in [x, y, z] {
                    match self.numbers {
                        Numbers::Whole => {
                            let steps = (value / SCALE).round() as i16;
                            bytes.extend(self.word(steps.cast_unsigned()));
                        }
                        Numbers::Real => bytes.extend(self.real(value)),
                    }
                }
                match self.numbers {
                    Numbers::Whole => bytes.extend(self.word((residual as i16).cast_unsigned())),
                    Numbers::Real => bytes.extend(self.real(residual)),
                }
            }
            let width = if whole { 2 } else { 4 };
            bytes.extend(vec![7; width * usize::from(self.analog)]);
        }
        bytes
    }
}
