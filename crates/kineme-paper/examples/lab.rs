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
}
