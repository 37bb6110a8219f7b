//! The table of `docs/derivation.md`: derivation on real people beside its baselines.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kineme::Skeleton;
use kineme::derivation::{Cut, Derivation, SecondLevel};
use kineme::math::statistics::mean_and_deviation;
use kineme::segmentation::Segmenter;

use crate::derivation::{Annotation, Clips, Order, Score, baselines, frame_score, frame_scores};
use crate::sets::{IndexRow, LabelledSet, Result, index, load};

/// Performances drawn for each row.
const SEEDS: u64 = 10;
/// Share of the mean posture removed in the rows named so.
const SHAPE: f64 = 0.7;

/// Derives every labelled set of a corpus with its labels hidden and writes what came of it, as Markdown.
///
/// # Errors
/// When the corpus lacks a file or a step fails.
pub fn derivation_table(corpus: &Path, watch: &mut dyn FnMut(&str)) -> Result<String> {
    let rows = index(corpus)?;
    let body = Arc::new(kineme::ares()?);
    let pick = |archive: &str, format: &str| -> Vec<&IndexRow> {
        let of = |r: &&IndexRow| r.archive == archive && r.format == format;
        rows.iter().filter(of).collect()
    };
    let mut out = String::new();
    let label = |r: &IndexRow| r.label.clone();
    let content = |r: &IndexRow| r.content().to_string();

    watch("HDM05");
    let set = load(corpus, &pick("hdm05.zip", "amc"), &body, None, &label)?;
    clips(&mut out, "HDM05", &set, &[Order::Separate])?;
    watch("Bandai-Namco 2");
    let set = load(
        corpus,
        &pick("bandai-namco-2.zip", "bvh"),
        &body,
        None,
        &content,
    )?;
    clips(&mut out, "Bandai-Namco 2", &set, &[Order::Routine])?;
    watch("UTD-MHAD");
    let set = load(
        corpus,
        &pick("utd-mhad.zip", "joints-csv"),
        &body,
        None,
        &label,
    )?;
    let orders = [Order::Separate, Order::Random, Order::Routine];
    clips(&mut out, "UTD-MHAD", &set, &orders)?;
    watch("CMU exercises");
    continuous(&mut out, corpus, &rows, &body)?;
    Ok(out)
}

/// Mean and spread of scores over the drawn performances.
fn summary(scores: &[Score]) -> String {
    let (mean, spread) = mean_and_deviation(&scores.iter().map(|s| s.ari).collect::<Vec<_>>());
    let of = |f: &dyn Fn(&Score) -> f64| scores.iter().map(f).sum::<f64>() / scores.len() as f64;
    let ari = match scores.len() {
        1 => format!("{mean:.2}"),
        _ => format!("{mean:.2} ± {spread:.2}"),
    };
    format!(
        "{ari} | {:.2} | {:.1} | {:.0} %",
        of(&|s| s.nmi),
        of(&|s| s.groups as f64),
        100.0 * of(&|s| s.noise)
    )
}

/// The rows of one set of clips.
fn clips(out: &mut String, name: &str, set: &LabelledSet, orders: &[Order]) -> Result<()> {
    writeln!(
        out,
        "\n### {name}: {} clips, {} classes\n\n| method | ARI | NMI | groups | noise |\n| --- | --- | --- | --- | --- |",
        set.motions.len(),
        set.classes.len()
    )?;
    let plain = Clips::new(set, 0.0)?;
    let shaped = Clips::new(set, SHAPE)?;
    for &order in orders {
        let seeds = if order == Order::Separate { 1 } else { SEEDS };
        for (clips, suffix) in [(&plain, ""), (&shaped, ", `--shape 0.7`")] {
            let (mut found, mut swept, mut stability) = (Vec::new(), Vec::new(), 0.0);
            for seed in 0..seeds {
                let derived = clips.derive(order, seed)?;
                found.push(clips.score(&derived));
                swept.push(clips.score_sweep(&derived));
                stability += derived.sweep.stability / seeds as f64;
            }
            let order = match order {
                Order::Separate => "clips apart",
                Order::Random => "random order",
                Order::Routine => "routine order",
            };
            writeln!(out, "| **{order}{suffix}** | {} |", summary(&found))?;
            writeln!(
                out,
                "| {order}{suffix}, sweep-and-prune (stability {stability:.2}) | {} |",
                summary(&swept)
            )?;
        }
    }
    if orders.contains(&Order::Routine) {
        let shuffled: Vec<Score> = (0..SEEDS)
            .map(|seed| Ok(plain.score(&plain.derive_shuffled(seed)?)))
            .collect::<Result<_>>()?;
        let control = "control: routine order, distances shuffled";
        writeln!(out, "| {control} | {} |", summary(&shuffled))?;
    }
    let kmeans: Vec<Score> = (0..SEEDS).map(|seed| plain.kmeans(seed)).collect();
    writeln!(
        out,
        "| baseline: warping distance + HDBSCAN | {} |",
        summary(&[plain.dtw_hdbscan(5)?])
    )?;
    writeln!(
        out,
        "| baseline: plain Isomap (K 8, 6-D) + HDBSCAN | {} |",
        summary(&[plain.isomap_hdbscan(5)?])
    )?;
    writeln!(
        out,
        "| baseline: k-means with the true number of classes | {} |",
        summary(&kmeans)
    )?;
    Ok(())
}

/// The rows of the continuous recordings of CMU subject 13, annotated ten times a second by Fox et al. (2014).
fn continuous(
    out: &mut String,
    corpus: &Path,
    rows: &[IndexRow],
    body: &Arc<Skeleton>,
) -> Result<()> {
    let trials = ["13_29", "13_30", "13_31"];
    let of = |r: &&IndexRow| {
        r.archive == "cmu-asfamc.zip"
            && trials.iter().any(|t| r.file.ends_with(&format!("{t}.amc")))
    };
    let picked: Vec<&IndexRow> = rows.iter().filter(of).collect();
    let asf = "cmu-asfamc.zip/cmu-asfamc/02/02.asf";
    let set = load(corpus, &picked, body, Some(asf), &|r| r.file.clone())?;
    let (truth, _) = annotations(corpus, &trials)?;
    writeln!(
        out,
        "\n### CMU exercises 13_29 to 13_31, continuous, scored ten times a second\n\n| method | ARI level 1 | ARI level 2 | segments | groups | behaviours | noise |\n| --- | --- | --- | --- | --- | --- | --- |"
    )?;
    let mut row = |name: &str, settings: &Derivation| -> Result<()> {
        let derived = settings.run(&set.motions, &mut |_| {})?;
        let (first, second) = frame_scores(&derived, &set.motions, &truth);
        writeln!(
            out,
            "| {name} | {:.2} | {:.2} | {} | {} | {} | {:.0} % |",
            first.ari,
            second.ari,
            derived.segments.len(),
            first.groups,
            second.groups,
            100.0 * first.noise
        )?;
        Ok(())
    };
    for name in ["pendulum", "zfunction", "changepoint"] {
        let mut settings = Derivation::new(Cut::Segmenter {
            segmenter: Segmenter::named(name)?,
            target_secs: None,
        });
        if name != "pendulum" {
            row(name, &settings)?;
            continue;
        }
        row("**pendulum, alternation (the default: K 3)**", &settings)?;
        for k in [4, 5, 6] {
            settings.neighbours = Some(k);
            row(&format!("pendulum, alternation, K {k}"), &settings)?;
        }
        settings.neighbours = None;
        settings.second_level = SecondLevel::Isomap;
        row("pendulum, second spatio-temporal Isomap", &settings)?;
        settings.second_level = SecondLevel::Alternation;
        settings.c_ctn = 1.0;
        row(
            "pendulum, no temporal neighbours (c 1), alternation",
            &settings,
        )?;
    }
    let settings = Derivation::new(Cut::Segmenter {
        segmenter: Segmenter::default(),
        target_secs: None,
    });
    let derived = settings.run(&set.motions, &mut |_| {})?;
    let sequences = settings.sequences(&set.motions, &derived.segments);
    let classes = truth
        .iter()
        .flat_map(|t| &t.labels)
        .max()
        .map_or(0, |m| m + 1);
    let size = derived.neighbourhood.min_group;
    let names = [
        "warping distance + HDBSCAN",
        "plain Isomap (K 8, 6-D) + HDBSCAN",
        "k-means with the true number of classes",
    ];
    let labels = baselines(&derived, &sequences, classes, size)?;
    for (name, labels) in names.iter().zip(labels) {
        let score = frame_score(&derived.segments, &labels, &set.motions, &truth);
        writeln!(
            out,
            "| baseline: pendulum, {name} | {:.2} | - | {} | {} | - | {:.0} % |",
            score.ari,
            derived.segments.len(),
            score.groups,
            100.0 * score.noise
        )?;
    }
    Ok(())
}

/// The annotation of each trial, from `mocap6-labels.csv`, and the names of its classes.
pub(crate) fn annotations(
    corpus: &Path,
    trials: &[&str],
) -> Result<(Vec<Annotation>, Vec<String>)> {
    let mut reader = csv::Reader::from_path(corpus.join("mocap6-labels.csv"))?;
    let mut truth: Vec<Annotation> = trials
        .iter()
        .map(|_| Annotation {
            labels: Vec::new(),
            rate_hz: 10.0,
        })
        .collect();
    let mut names: Vec<String> = Vec::new();
    for record in reader.records() {
        let record = record?;
        let (trial, action) = (&record[0], record[2].to_string());
        let Some(t) = trials.iter().position(|x| *x == trial) else {
            continue;
        };
        let class = names.iter().position(|n| *n == action).unwrap_or_else(|| {
            names.push(action.clone());
            names.len() - 1
        });
        truth[t].labels.push(class);
    }
    Ok((truth, names))
}
