use kineme_paper::derivation::*;
use kineme_paper::sets;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
fn main() {
    let corpus = Path::new("/work/shared/data/mocap");
    let rows = sets::index(corpus).unwrap();
    let body = Arc::new(kineme::ares().unwrap());
    let pick = |a: &str, f: &str| -> Vec<sets::IndexRow> {
        rows.iter()
            .filter(|r| r.archive == a && r.format == f)
            .cloned()
            .collect()
    };
    let content = |r: &sets::IndexRow| {
        r.notes
            .split(';')
            .find_map(|n| n.trim().strip_prefix("content="))
            .unwrap_or("?")
            .to_string()
    };
    let label = |r: &sets::IndexRow| r.label.clone();
    for (name, arch, fmt) in [
        ("HDM05", "hdm05.zip", "amc"),
        ("BN2", "bandai-namco-2.zip", "bvh"),
        ("UTD", "utd-mhad.zip", "joints-csv"),
    ] {
        let t = Instant::now();
        let set = sets::load(
            name,
            corpus,
            &pick(arch, fmt),
            &body,
            if name == "BN2" { &content } else { &label },
        )
        .unwrap();
        println!(
            "{name}: {} clips, {} classes, read+retarget {:?}",
            set.motions.len(),
            set.classes.len(),
            t.elapsed()
        );
        if std::env::var("CMU").is_ok() {
            break;
        }
        for shape in [0.0, 0.7] {
            let t = Instant::now();
            let clips = Clips::new(&set, shape).unwrap();
            println!(" shape {shape} distances {:?}", t.elapsed());
            clips.dump(&format!("/tmp/dist_{name}_{shape}.txt"));
            if std::env::var("DUMP").is_ok() {
                continue;
            }
            println!("  dtw+hdbscan {:?}", clips.dtw_hdbscan(5).unwrap());
            println!("  isomap+hdbscan {:?}", clips.isomap_hdbscan(5).unwrap());
            println!("  kmeans {:?}", clips.kmeans(0));
            for order in [Order::Separate, Order::Random, Order::Routine] {
                let n = if order == Order::Separate { 1 } else { 5 };
                let s: Vec<(Score, Score)> = (0..n)
                    .map(|seed| {
                        let d = clips.derive(order, seed).unwrap();
                        (clips.score(&d), clips.score_sweep(&d))
                    })
                    .collect();
                let m =
                    |f: &dyn Fn(&(Score, Score)) -> f64| s.iter().map(f).sum::<f64>() / n as f64;
                println!(
                    "  {order:?}: ari {:.3} groups {:.1} noise {:.2} sweep {:.3}",
                    m(&|x| x.0.ari),
                    m(&|x| x.0.groups as f64),
                    m(&|x| x.0.noise),
                    m(&|x| x.1.ari)
                );
            }
        }
    }

    if std::env::var("CMU").is_err() {
        return;
    }
    let cmu: Vec<sets::IndexRow> = rows
        .iter()
        .filter(|r| r.file.contains("13_") && r.archive == "cmu-asfamc.zip")
        .cloned()
        .collect();
    let set = sets::load("CMU", corpus, &cmu, &body, &label).unwrap();
    let text = std::fs::read_to_string(corpus.join("mocap6-labels.csv")).unwrap();
    let mut names: Vec<String> = vec![];
    let truth: Vec<Annotation> = set
        .motions
        .iter()
        .map(|m| {
            let trial = m
                .name()
                .rsplit('/')
                .next()
                .unwrap()
                .trim_end_matches(".amc")
                .to_string();
            let labels = text
                .lines()
                .filter(|l| l.starts_with(&trial))
                .map(|l| {
                    let a = l.rsplit(',').next().unwrap().to_string();
                    if let Some(i) = names.iter().position(|n| *n == a) {
                        i
                    } else {
                        names.push(a);
                        names.len() - 1
                    }
                })
                .collect();
            Annotation {
                labels,
                rate_hz: 10.0,
            }
        })
        .collect();
    use kineme::derivation::*;
    use kineme::segmentation::Segmenter;
    for rate in [120.0, 60.0] {
        let motions: Vec<kineme::Motion> = set
            .motions
            .iter()
            .map(|m| m.resampled(rate).unwrap())
            .collect();
        for seg in ["pendulum", "zfunction", "changepoint"] {
            for (k, size) in [(3, 3), (4, 3), (5, 3), (3, 4), (5, 5)] {
                for (rule, tn, ls) in [
                    (kineme::embedding::TemporalRule::Forward, 1, 0),
                    (kineme::embedding::TemporalRule::Forward, 1, 5),
                    (kineme::embedding::TemporalRule::Known, 2, 5),
                    (kineme::embedding::TemporalRule::Known, 2, 0),
                ] {
                    let mut d = Derivation::new(Cut::Segmenter {
                        segmenter: Segmenter::named(seg).unwrap(),
                        target_secs: None,
                    });
                    d.neighbours = Some(k);
                    d.min_group = Some(size);
                    d.rule = Some(rule);
                    d.temporal_neighbours = Some(tn * k);
                    d.local_scale = ls;
                    let r = d.run(&motions, &mut |_| {}).unwrap();
                    let (p, b) = frame_scores(&r, &motions, &truth);
                    println!(
                        "{rate} {seg} K{k} size{size} {rule:?} x{tn} ls{ls}: {} segments, {} groups noise {:.2}, level1 {:.3} level2 {:.3} ({} behaviours, largest {:.2})",
                        r.segments.len(),
                        p.groups,
                        p.noise,
                        p.ari,
                        b.ari,
                        b.groups,
                        r.behaviors.largest_share
                    );
                }
            }
        }
    }
}
