//! [`Table`] as Markdown and as CSV.

use std::fmt::Write as _;

use kineme::evaluation::Estimate;

use super::measures::{MEASURES, Measure};
use super::mode::Mode;
use super::row::{Row, Table};
use super::run::SETS;
use crate::sets::Result;

/// What is asked of the filter in each set: accuracy, in hundred; the recall of the first; alarms an hour of the third.
const ASKED: [(&str, f64); 3] = [(SETS[0], 99.5), (SETS[1], 99.99), (SETS[2], 99.99)];
const ASKED_RECALL: f64 = 95.0;
const ASKED_ALARMS: f64 = 1.0;

/// The paper's table, n = 1 and n = 2.
pub(super) const PUBLISHED: [(&str, f64, f64); 3] = [
    (SETS[0], 96.61, 96.61),
    (SETS[1], 99.94, 99.94),
    (SETS[2], 99.97, 99.98),
];

pub(super) fn percent(estimate: Option<Estimate>) -> String {
    match estimate {
        Some(e) => format!("{:.2}", 100.0 * e.value),
        None => "-".into(),
    }
}

fn with_interval(estimate: Option<Estimate>) -> String {
    match estimate {
        Some(e) => format!(
            "{:.2} [{:.2}, {:.2}]",
            100.0 * e.value,
            100.0 * e.low,
            100.0 * e.high
        ),
        None => "-".into(),
    }
}

pub(super) fn way(mode: Mode) -> String {
    match mode.postures() {
        Some((1, _)) => format!("{}, n 1", mode.name()),
        Some((n, stride)) => format!("{}, n {n}, stride {stride}", mode.name()),
        None => mode.name(),
    }
}

impl Table {
    /// All of it, as Markdown.
    ///
    /// # Errors
    /// Never; writing to a string cannot fail.
    pub fn markdown(&self) -> Result<String> {
        let mut out = String::new();
        self.sets(&mut out)?;
        self.targets(&mut out)?;
        writeln!(
            out,
            "\n### The table\n\nAccuracy in hundred, with the interval of 95 in 100 over clips; *any*: whether any of the {} \
             is shown; *every*: frames in which all were decided rightly; *never*: what always denying has. Precision, \
             recall and F1 of all decisions pooled. Alarms an hour with the Poisson interval. Loss in nats a decision.\n",
            self.behaviors.len()
        )?;
        header(&mut out)?;
        for row in &self.rows {
            line(&mut out, row)?;
        }
        writeln!(
            out,
            "\n### Other joints altered\n\nHands are altered in the sets two and three above. Here they are not, or the \
             legs are as well, so that nothing but trunk, arms and head tells.\n"
        )?;
        header(&mut out)?;
        for row in &self.altered {
            line(&mut out, row)?;
        }
        self.grids(&mut out)?;
        self.beyond(&mut out)?;
        Ok(out)
    }

    fn sets(&self, out: &mut String) -> Result<()> {
        writeln!(
            out,
            "\n### The sets\n\nBehaviours: {}. Ares {}.\n\n| set | clips | frames | hours | frames that show a behaviour | paper, n 1 | n 2 |\n| --- | --- | --- | --- | --- | --- | --- |",
            self.behaviors.join(", "),
            match self.physics {
                true => "was simulated",
                false =>
                    "was not simulated: built without physics, its joints were where they were told to be",
            }
        )?;
        let mut frames = 0;
        for (set, one, two) in PUBLISHED {
            let Some(row) = self.rows.iter().find(|r| r.set == set) else {
                continue;
            };
            frames += row.frames;
            let shown = row
                .measure(Measure::NeverAny)
                .map_or(0.0, |e| 1.0 - e.value);
            writeln!(
                out,
                "| {set} | {} | {} | {:.2} | {:.1} % | {one} % | {two} % |",
                row.clips,
                row.frames,
                row.hours,
                100.0 * shown
            )?;
        }
        writeln!(
            out,
            "\n{frames} frames in all; the paper had 209,188 data points."
        )?;
        Ok(())
    }

    fn targets(&self, out: &mut String) -> Result<()> {
        let ways = [Mode::FILTER, Mode::HINDSIGHT];
        let names = ways.map(|way| match way {
            Mode::FILTER => "at once".into(),
            way => way.name(),
        });
        writeln!(
            out,
            "\n### What was asked of the filter\n\n| set | asked | {} |\n| --- | --- | --- | --- |",
            names.join(" | ")
        )?;
        let value =
            |m: Measure| move |row: &Row| row.measure(m).map_or(f64::NAN, |e| 100.0 * e.value);
        let accuracy = value(Measure::Accuracy);
        let recall = value(Measure::Recall);
        let alarms = |row: &Row| row.alarms_an_hour()[0];
        let at_least = |asked: f64| move |found: f64| found >= asked;
        let mut asked =
            |set: &str, what: &str, found: &dyn Fn(&Row) -> f64, met: &dyn Fn(f64) -> bool| {
                let of = |way: Mode| self.rows.iter().find(|r| r.set == set && r.mode == way);
                let rows: Vec<&Row> = ways.into_iter().filter_map(of).collect();
                if rows.is_empty() {
                    return Ok(());
                }
                let cell = |row: &&Row| {
                    let found = found(row);
                    let verdict = if met(found) { "met" } else { "**missed**" };
                    format!("{found:.2}, {verdict}")
                };
                let cells: Vec<String> = rows.iter().map(cell).collect();
                writeln!(out, "| {set} | {what} | {} |", cells.join(" | "))
            };
        for (set, least) in ASKED {
            let what = format!("accuracy, %, at least {least}");
            asked(set, &what, &accuracy, &at_least(least))?;
            if set == SETS[0] {
                let what = format!("recall, %, at least {ASKED_RECALL}");
                asked(set, &what, &recall, &at_least(ASKED_RECALL))?;
            }
            if set == SETS[2] {
                let what = format!("alarms an hour, at most {ASKED_ALARMS}");
                asked(set, &what, &alarms, &|found| found <= ASKED_ALARMS)?;
            }
        }
        Ok(())
    }

    fn grids(&self, out: &mut String) -> Result<()> {
        let mut sets: Vec<&str> = Vec::new();
        for row in &self.grid {
            if !sets.contains(&row.set.as_str()) {
                sets.push(&row.set);
            }
        }
        writeln!(
            out,
            "\n### Postures judged together\n\nAccuracy (mean over the behaviours), and recall where there is anything to \
             recall, in hundred; hands altered in the sets two and three."
        )?;
        for set in &sets {
            if let Some(row) = self.grid.iter().find(|r| r.set == *set) {
                writeln!(out, "\n{set}: {} clips, {} frames.", row.clips, row.frames)?;
            }
        }
        writeln!(
            out,
            "\n| | {} |\n| --- {}|",
            sets.join(" | "),
            "| --- ".repeat(sets.len())
        )?;
        let mut ways: Vec<Mode> = Vec::new();
        for row in &self.grid {
            if !ways.contains(&row.mode) {
                ways.push(row.mode);
            }
        }
        for mode in ways {
            let cell = |set: &&str| {
                let found = self.grid.iter().find(|r| r.set == *set && r.mode == mode);
                found.map_or("-".into(), |row| {
                    let accuracy = percent(row.measure(Measure::Accuracy));
                    match row.measure(Measure::Recall) {
                        Some(_) => format!("{accuracy}; {}", percent(row.measure(Measure::Recall))),
                        None => accuracy,
                    }
                })
            };
            let cells: Vec<String> = sets.iter().map(cell).collect();
            writeln!(out, "| {} | {} |", way(mode), cells.join(" | "))?;
        }
        Ok(())
    }

    fn beyond(&self, out: &mut String) -> Result<()> {
        writeln!(out, "\n### Noise and lost joints, Ares movements\n")?;
        writeln!(
            out,
            "| | way | accuracy | recall | precision | alarms an hour |\n| --- | --- | --- | --- | --- | --- |"
        )?;
        for (damage, row) in &self.damaged {
            writeln!(
                out,
                "| {damage} | {} | {} | {} | {} | {:.0} |",
                way(row.mode),
                percent(row.measure(Measure::Accuracy)),
                percent(row.measure(Measure::Recall)),
                percent(row.measure(Measure::Precision)),
                row.alarms_an_hour()[0]
            )?;
        }
        writeln!(
            out,
            "\n### Movements that no behaviour makes\n\nThe share of frames in which any behaviour is affirmed: to be high in \
             the first rows, and low in those after them.\n\n| | clips | way | affirmed |\n| --- | --- | --- | --- |"
        )?;
        for (name, mode, share, clips) in &self.impossible {
            writeln!(
                out,
                "| {name} | {clips} | {} | {:.1} % |",
                way(*mode),
                100.0 * share
            )?;
        }
        if self.left.is_empty() {
            return Ok(());
        }
        writeln!(
            out,
            "\n### People who strike or wave\n\n{} recordings left the third set, because they show what a behaviour may be. \
             In how many of them is a behaviour affirmed, for a tenth of a second or longer?\n",
            self.left_files.len()
        )?;
        let mut kinds: Vec<&str> = self.left.iter().map(|(kind, ..)| kind.as_str()).collect();
        kinds.dedup();
        let mut seen: Vec<&str> = Vec::new();
        kinds.retain(|k| {
            let new = !seen.contains(k);
            seen.push(k);
            new
        });
        let mut ways: Vec<Mode> = Vec::new();
        for (_, mode, ..) in &self.left {
            if !ways.contains(mode) {
                ways.push(*mode);
            }
        }
        let names: Vec<String> = ways.iter().map(|m| way(*m)).collect();
        writeln!(
            out,
            "| recordings | clips | {} |\n| --- | --- {}|",
            names.join(" | "),
            "| --- ".repeat(names.len())
        )?;
        for kind in kinds {
            let of = |mode: &Mode| {
                let found = self.left.iter().find(|(k, m, ..)| k == kind && m == mode);
                found.map_or((0, 0), |(_, _, yes, all)| (*yes, *all))
            };
            let cells: Vec<String> = ways.iter().map(|m| of(m).0.to_string()).collect();
            writeln!(
                out,
                "| {kind} | {} | {} |",
                of(&ways[0]).1,
                cells.join(" | ")
            )?;
        }
        Ok(())
    }

    /// Times of decisions, which are of this machine, as Markdown.
    ///
    /// # Errors
    /// Never; writing to a string cannot fail.
    pub fn timings_markdown(&self) -> Result<String> {
        let mut out = String::from(
            "\n### Time of the five decisions of a frame\n\n| way | frames | median, µs | 99 of 100 below, µs |\n| --- | --- | --- | --- |\n",
        );
        for t in &self.timings {
            writeln!(
                out,
                "| {} | {} | {:.1} | {:.1} |",
                way(t.mode),
                t.frames,
                t.median_us,
                t.p99_us
            )?;
        }
        Ok(out)
    }

    /// Every row with every measure and its interval, as CSV.
    ///
    /// # Errors
    /// Never; writing to memory cannot fail.
    pub fn csv(&self) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut head: Vec<String> = [
            "part",
            "set",
            "mode",
            "n",
            "stride",
            "altered",
            "clips",
            "frames",
            "hours",
            "alarms",
            "alarms_an_hour",
            "alarms_low",
            "alarms_high",
            "movements",
            "missed",
        ]
        .map(String::from)
        .to_vec();
        for (_, name) in MEASURES {
            head.extend([name.into(), format!("{name}_low"), format!("{name}_high")]);
        }
        writer.write_record(&head)?;
        let damaged = self.damaged.iter().map(|(name, row)| (name.as_str(), row));
        let parts = [
            ("table", &self.rows),
            ("altered", &self.altered),
            ("grid", &self.grid),
        ];
        let parts = parts
            .iter()
            .flat_map(|(p, rows)| rows.iter().map(move |r| (*p, r)));
        for (part, row) in parts.chain(damaged) {
            let (n, stride) = row.mode.postures().unzip();
            let count = |v: Option<usize>| v.map_or(String::new(), |v| v.to_string());
            let mut record = vec![
                part.to_string(),
                row.set.clone(),
                row.mode.name(),
                count(n),
                count(stride),
                row.altered.name().into(),
                row.clips.to_string(),
                row.frames.to_string(),
                row.hours.to_string(),
                row.alarms.to_string(),
            ];
            record.extend(row.alarms_an_hour().map(|v| v.to_string()));
            record.extend([row.spans.to_string(), row.missed.to_string()]);
            for e in row.measures {
                let cells = e.map_or([None; 3], |e| [Some(e.value), Some(e.low), Some(e.high)]);
                record.extend(cells.map(|v| v.map_or(String::new(), |v| v.to_string())));
            }
            writer.write_record(&record)?;
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }
}

fn header(out: &mut String) -> Result<()> {
    writeln!(
        out,
        "| set | way | accuracy | any | every | never | balanced | precision | recall | F1 | movements found | alarms an hour | loss |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    )?;
    Ok(())
}

fn line(out: &mut String, row: &Row) -> Result<()> {
    let [rate, low, high] = row.alarms_an_hour();
    let found = match row.spans {
        0 => "-".into(),
        all => format!("{} of {all}", all - row.missed),
    };
    let loss = row.measure(Measure::LogLoss);
    writeln!(
        out,
        "| {}{} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {found} | {rate:.1} ({}) [{low:.1}, {high:.1}] | {} |",
        row.set,
        match row.altered {
            super::Altered::Unmoved | super::Altered::Nothing if row.spans == 0 =>
                format!(", {}", row.altered.name()),
            _ => String::new(),
        },
        way(row.mode),
        with_interval(row.measure(Measure::Accuracy)),
        percent(row.measure(Measure::AccuracyAny)),
        percent(row.measure(Measure::AccuracyEvery)),
        percent(row.measure(Measure::Never)),
        percent(row.measure(Measure::Balanced)),
        percent(row.measure(Measure::Precision)),
        percent(row.measure(Measure::Recall)),
        percent(row.measure(Measure::F1)),
        row.alarms,
        loss.map_or("-".into(), |e| format!("{:.4}", e.value)),
    )?;
    Ok(())
}
