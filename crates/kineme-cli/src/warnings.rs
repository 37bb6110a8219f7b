//! What readers detected or doubted, each kind told once.

use std::collections::HashMap;

use crate::failure::complain;

/// Warnings in the order in which each kind was first met.
#[derive(Debug, Default)]
pub struct Warnings {
    kinds: Vec<Kind>,
    place: HashMap<String, usize>,
}

#[derive(Debug)]
struct Kind {
    first: String,
    count: usize,
}

impl Warnings {
    /// A remark on one motion or primitive. Remarks that differ in nothing but numbers and quoted names are of one kind.
    pub fn add(&mut self, motion: &str, text: &str) {
        let unquoted: String = text.split('`').step_by(2).collect();
        let key: String = unquoted
            .chars()
            .map(|c| if c.is_ascii_digit() { '0' } else { c })
            .collect();
        let mut key = key.replace("0.0", "0");
        while key.contains("00") {
            key = key.replace("00", "0");
        }
        match self.place.get(&key) {
            Some(&at) => self.kinds[at].count += 1,
            None => {
                self.place.insert(key, self.kinds.len());
                self.kinds.push(Kind {
                    first: format!("{motion}: {text}"),
                    count: 1,
                });
            }
        }
    }

    /// Tells each kind on stderr, with how often it was met.
    pub fn print(&self) {
        for line in self.lines() {
            complain(&format!("note: {line}"));
        }
    }

    fn lines(&self) -> impl Iterator<Item = String> {
        self.kinds.iter().map(|kind| match kind.count {
            1 => kind.first.clone(),
            n => format!("{} (and {} more like it)", kind.first, n - 1),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Warnings;

    #[test]
    fn warnings_that_differ_in_numbers_alone_are_told_once() {
        let mut warnings = Warnings::default();
        for (motion, text) in [
            ("a", "12 of 300 points missing"),
            ("a", "up axis: y"),
            ("b", "7.25 of 9 points missing"),
            ("b", "up axis: z"),
            ("c", "1000 of 10000 points missing"),
            ("p", "left out: `x` from 1 s"),
            ("q", "left out: `y.bvh` from 2.25 s"),
        ] {
            warnings.add(motion, text);
        }
        let lines: Vec<String> = warnings.lines().collect();
        assert_eq!(
            lines,
            [
                "a: 12 of 300 points missing (and 2 more like it)",
                "a: up axis: y",
                "b: up axis: z",
                "p: left out: `x` from 1 s (and 1 more like it)"
            ]
        );
    }
}
