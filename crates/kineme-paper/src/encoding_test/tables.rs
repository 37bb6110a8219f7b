//! The tables of the test.

use std::fmt::Write as _;

use super::strokes::{Told, share};
use super::{
    Answer, EncodingTest, Method, RESEMBLING, RISING, SETS, Truth, refused, right, wilson,
};
use crate::sets::Result;

const INTRODUCTION: &str = "\n## Trajectory encoding\n\n\
Motions to their set: *answered*, refusals counting as wrong; *likeliest*, refused or not. Shares in hundred with the \
Wilson interval. *Other half*: every second recording of each kind, on which nothing was chosen; a refusal's limit is \
what 98 in 100 of the first half stay below.\n\n\
*The movement* is found by the hands' own kinematics, by one rule for all kinds; a hand is where its fingers begin. It \
moves if its path is at least half as long as the other's. If it hangs at the beginning or the end (0.45 of the reach below \
the shoulders or lower), that is a place of rest, and its movement lasts from the first to the last moment at which it is \
farther from there than 0.7 of its greatest such distance. If it turns back twice or more meanwhile (by more than 107 \
degrees, 0.08 of the reach each way), it lasts from the first to the last of these turning points. By hypotheses, every \
hand that moves is judged by itself, the left one in the mirror; by the paper's method both together, in the mirror if the \
left moves more.\n\n";

impl EncodingTest {
    /// The counts with their intervals, the confusions, every kind of motion, and the strokes, as Markdown.
    ///
    /// # Errors
    /// Never; writing to a string cannot fail.
    pub fn markdown(&self) -> Result<String> {
        let mut out = String::from(INTRODUCTION);
        out.push_str(
            "| judged | method | answered | likeliest | other half, answered | other half, likeliest | fit none, refused | \
             asked: 95 |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        );
        for method in &self.methods {
            let (answered, leading, all) = right(method.answers.iter());
            let other = || method.answers.iter().filter(|a| !a.question.tuned());
            let (answered_2, leading_2, all_2) = right(other());
            let (refused, foreign) = refused(method.answers.iter());
            let verdict = match 100 * answered >= 95 * all {
                true => "met",
                false => "**missed**",
            };
            writeln!(
                out,
                "| {} | {} | {} | {} | {} | {} | {} | {verdict} |",
                method.part.name(),
                method.name,
                told(answered, all),
                told(leading, all),
                told(answered_2, all_2),
                told(leading_2, all_2),
                told(refused, foreign)
            )?;
        }
        for method in &self.methods {
            confusion(method, &mut out)?;
        }
        self.kinds(&mut out)?;
        self.strokes(&mut out)?;
        Ok(out)
    }

    fn kinds(&self, out: &mut String) -> Result<()> {
        let names: Vec<String> = self.methods.iter().map(named).collect();
        writeln!(
            out,
            "\n### Which motions resemble which: how many were answered so, and in how many it was the likeliest\n\n\
             | motions | resemble | clips | {} |\n| --- | --- | --- {}|",
            names.join(" | "),
            "| --- ".repeat(names.len())
        )?;
        for (archive, label, truth) in RESEMBLING {
            let kind = format!("{archive}, {label}");
            let own = |m: &Method| -> [usize; 3] {
                let own = || m.answers.iter().filter(|a| a.question.kind == kind);
                let leads = |a: &&Answer| Some(a.leading) == truth;
                [
                    own().filter(|a| a.is_right()).count(),
                    own().filter(leads).count(),
                    own().count(),
                ]
            };
            let counts: Vec<[usize; 3]> = self.methods.iter().map(own).collect();
            let all = counts.first().map_or(0, |c| c[2]);
            if all == 0 {
                continue;
            }
            let cell = |[right, leading, _]: &[usize; 3]| match truth {
                Some(_) => format!("{right}, {leading}"),
                None => right.to_string(),
            };
            let cells: Vec<String> = counts.iter().map(cell).collect();
            writeln!(
                out,
                "| {kind} | {} | {all} | {} |",
                truth.map_or("none", |t| SETS[t]),
                cells.join(" | ")
            )?;
        }
        Ok(())
    }

    fn strokes(&self, out: &mut String) -> Result<()> {
        writeln!(
            out,
            "\n### Stroke by stroke inside its own set\n\nEach hand's wrist while it is away from rest, applied to the \
             primitives of the set that it resembles. The truth is the hand's own direction: its height; its horizontal distance from between the \
             shoulders; its bearing around them; how far left it is. A stroke goes from turning point to turning point \
             (0.15 of the reach back, or radians); counted are decisions wholly inside one, at 0.2 reaches a second along \
             it or more. Shares in hundred; intervals by resampling recordings.\n\n\
             | method | set | clips | decisions | right | other half | rising strokes: right, wrong | falling: right, wrong |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- |"
        )?;
        for (name, all) in &self.strokes {
            for set in (0..SETS.len()).map(Some).chain([None]) {
                let of = |t: &&Told| set.is_none() || t.question.truth == set;
                let own: Vec<&Told> = all.iter().filter(of).filter(|t| t.right().1 > 0).collect();
                let other = own.iter().filter(|t| !t.question.tuned());
                let other: Vec<&Told> = other.copied().collect();
                let sum = |stroke: usize, answer: usize| -> usize {
                    own.iter().map(|t| t.counts[stroke][answer]).sum()
                };
                let shown = |told: &[&Told]| -> Result<String> {
                    Ok(share(told)?.map_or("-".into(), |e| {
                        let [v, l, h] = [e.value, e.low, e.high].map(|x| 100.0 * x);
                        format!("{v:.1} [{l:.1}, {h:.1}]")
                    }))
                };
                writeln!(
                    out,
                    "| {name} | {} | {} | {} | {} | {} | {}, {} | {}, {} |",
                    set.map_or("all".into(), |s| format!(
                        "{} (rising: {})",
                        SETS[s],
                        RISING[s].join(", ")
                    )),
                    own.len(),
                    own.iter().map(|t| t.right().1).sum::<usize>(),
                    shown(&own)?,
                    shown(&other)?,
                    sum(0, 0),
                    sum(0, 1),
                    sum(1, 1),
                    sum(1, 0)
                )?;
            }
        }
        Ok(())
    }

    /// Every answer as CSV.
    ///
    /// # Errors
    /// Never; writing to memory cannot fail.
    pub fn csv(&self) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let head = [
            "judged",
            "method",
            "motions",
            "number",
            "resembles",
            "likeliest",
            "refused",
        ];
        writer.write_record(head)?;
        for method in &self.methods {
            for a in &method.answers {
                writer.write_record([
                    method.part.name(),
                    method.name,
                    &a.question.kind,
                    &a.question.number.to_string(),
                    a.question.truth.map_or("none", |t| SETS[t]),
                    SETS[a.leading],
                    if a.refused { "yes" } else { "no" },
                ])?;
            }
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }
}

fn named(method: &Method) -> String {
    format!("{}, {}", method.name, method.part.name())
}

fn told(part: usize, whole: usize) -> String {
    let (low, high) = wilson(part, whole);
    format!(
        "{part} of {whole}: {:.1} [{:.1}, {:.1}]",
        100.0 * part as f64 / whole.max(1) as f64,
        100.0 * low,
        100.0 * high
    )
}

fn confusion(method: &Method, out: &mut String) -> Result<()> {
    writeln!(
        out,
        "\n### Which set: {}\n\n| resembles | {} | refused |\n| --- {}| --- |",
        named(method),
        SETS.join(" | "),
        "| --- ".repeat(SETS.len())
    )?;
    for truth in (0..SETS.len()).map(Some).chain([None]) {
        let own = || method.answers.iter().filter(|a| a.question.truth == truth);
        let count = |answer: Truth| own().filter(|a| a.set() == answer).count();
        let cells: Vec<String> = (0..SETS.len())
            .map(|s| count(Some(s)).to_string())
            .collect();
        writeln!(
            out,
            "| {} | {} | {} |",
            truth.map_or("none", |t| SETS[t]),
            cells.join(" | "),
            count(None)
        )?;
    }
    Ok(())
}
