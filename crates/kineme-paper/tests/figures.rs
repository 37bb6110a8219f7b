//! The paper's figures: the numbers in them are those that the library computes, and they are drawn the same each time.

use std::path::Path;
use std::sync::OnceLock;

use kineme::perception::{Paper, PaperSettings};
use kineme::primitive::{Observation, Recogniser};
use kineme_formats::output::Existing;
use kineme_paper::demo::{Found, find};
use kineme_paper::paper_figures::{
    Encoded, NAMES, Relaxation, chart, draw, encoded, field_view, files, panels, punching,
    relaxation, write,
};
use kineme_report::paper;

/// Parses a figure and counts the texts that hold these words.
fn says(svg: &str, words: &str) -> usize {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    for node in document.descendants() {
        for attribute in node.attributes() {
            let value = attribute.value();
            assert!(!value.contains("NaN") && !value.contains("inf"), "{value}");
        }
    }
    let texts = document
        .descendants()
        .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "text")));
    texts
        .filter(|n| n.text().is_some_and(|t| t.contains(words)))
        .count()
}

fn demo() -> &'static Found {
    static DEMO: OnceLock<Found> = OnceLock::new();
    DEMO.get_or_init(|| find(0, &mut |_| {}).expect("a demo"))
}

fn relaxed() -> &'static Relaxation {
    static RELAXED: OnceLock<Relaxation> = OnceLock::new();
    RELAXED.get_or_init(|| relaxation(&punching().expect("a vocabulary")).expect("steps"))
}

fn encoding() -> &'static Encoded {
    static ENCODED: OnceLock<Encoded> = OnceLock::new();
    ENCODED.get_or_init(|| encoded().expect("an encoding"))
}

#[test]
fn figure_1_shows_three_behaviors_and_the_least_coherent_group() {
    let panels = panels(demo()).expect("panels");
    assert_eq!(panels.len(), 4);
    let coherence = |k: usize| panels[k].coherence.expect("a coherence");
    let svg = paper::hand_panels(&panels);
    for (k, panel) in panels.iter().enumerate() {
        assert_eq!(panel.unintended, k == 3, "{}", panel.title);
        assert!(coherence(k) >= coherence(3), "{}", panel.title);
        assert!(panel.right.len() >= 3 && panel.left.len() == panel.right.len());
        assert!(!panel.right_interpolated.is_empty());
        let shown = format!("{}, coherence {:.2}", panel.title, coherence(k));
        assert_eq!(says(&svg, &shown.replace('-', "\u{2212}")), 1, "{shown}");
    }
}

#[test]
fn figure_2_flows_from_right_to_left_along_its_exemplars() {
    let ares = std::sync::Arc::new(kineme::ares().expect("a body"));
    let text = include_str!("../../../choreography/horizontal-waving.toml");
    let script = kineme_formats::script::parse("waving", text.as_bytes()).expect("a script");
    let vocabulary = script
        .vocabulary(&ares, &kineme::Modelling::default(), ("waving", None))
        .expect("a vocabulary");
    let view =
        field_view(vocabulary.primitive("wave-across").expect("a primitive")).expect("a field");
    assert!(
        view.shares[0] > view.shares[1] && view.shares[0] + view.shares[1] > 0.7,
        "{:?}",
        view.shares
    );
    assert_eq!(view.flow.exemplars.len(), 9);
    for way in &view.flow.exemplars {
        let (first, last) = (way[0], way[way.len() - 1]);
        assert!(first.0[0] > last.0[0], "{first:?} {last:?}");
        assert_eq!((first.1, last.1), (0.0, 1.0));
    }
    // In the midst of the movement the flow goes left, but for eddies at its border.
    let midst = || {
        view.flow
            .arrows
            .iter()
            .filter(|a| (0.3..0.7).contains(&a.phase))
    };
    assert!(midst().count() > 100);
    let left = midst().filter(|a| a.to[0] < a.from[0]).count();
    assert!(
        left * 10 >= midst().count() * 8,
        "{left} of {}",
        midst().count()
    );
    says(&paper::flow(&view.flow), "");
}

#[test]
fn figure_3_names_modules_that_exist() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../kineme/src");
    let chart = chart();
    let svg = paper::flowchart(&chart);
    for node in &chart.nodes {
        assert_eq!(says(&svg, &node.module), 1, "{}", node.module);
        let (room, name) = node.module.split_once("::").expect("a room and a name");
        let folder = source.join(room);
        let module = folder.join(format!("{name}.rs")).exists() || folder.join(name).is_dir();
        let room = std::fs::read_to_string(folder.join("mod.rs")).expect("a room");
        let exported = room
            .split(|c: char| !c.is_alphanumeric())
            .any(|word| word == name);
        assert!(module || exported, "{}", node.module);
    }
}

#[test]
fn figure_4_s_interval_is_where_the_envelope_meets_the_value() {
    let r = relaxed();
    let m = &r.mixtures[0];
    assert!(!r.intervals.is_empty());
    for (phase, (low, high)) in m.phases.iter().zip(m.low.iter().zip(&m.high)) {
        let meets = low - r.delta_rad <= r.value_rad && r.value_rad <= high + r.delta_rad;
        let inside = r.intervals.iter().any(|i| (i[0]..=i[1]).contains(phase));
        assert_eq!(meets, inside, "{phase}");
    }
    // As in the paper, from the midst to the end, in one.
    assert_eq!(r.intervals.len(), 1);
    assert!(
        r.intervals[0][0] > 0.4 && r.intervals[0][1] == 1.0,
        "{:?}",
        r.intervals
    );
    let svg = paper::mixture(&r.confining());
    assert!(says(&svg, &format!("\u{3c4} = {:.2}", r.intervals[0][0])) == 1);
}

#[test]
fn the_paper_s_interval_holds_the_exact_set_and_more() {
    let r = relaxed();
    assert!(!r.exact.is_empty() && r.exact.len() < r.patches);
    let [from, to] = r.intervals[0];
    // A patch is as long as a piece of phase.
    for patch in &r.exact {
        let piece = patch.phase[1] - patch.phase[0];
        assert!(
            patch.phase[1] >= from - piece && patch.phase[0] <= to,
            "{:?}",
            patch.phase
        );
    }
    let share = r.share_of_admitted();
    assert!((0.02..0.9).contains(&share), "{share}");
}

#[test]
fn figure_5_shades_the_interval_of_figure_4() {
    let r = relaxed();
    let (four, five) = (r.confining(), r.confined());
    assert_eq!(four.intervals, five.intervals);
    assert_eq!(five.exact.len(), r.exact.len());
    let m = &r.mixtures[1];
    let (least, most) = (
        m.low.iter().copied().fold(f64::INFINITY, f64::min),
        m.high.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    );
    for cell in &five.exact {
        let [low, high] = cell.across;
        assert!(low >= least - 0.05 && high <= most + 0.05, "{cell:?}");
    }
    says(&paper::mixture(&five), "");
}

#[test]
fn figure_6_integrates_to_one_three_times() {
    let r = relaxed();
    let figure = r.density().expect("a density");
    let bars = figure.edges.windows(2).zip(&figure.bars);
    let histogram: f64 = bars.map(|(e, d)| (e[1] - e[0]) * d).sum();
    assert!((histogram - 1.0).abs() < 1e-9, "{histogram}");
    for curve in [&figure.kernel, &figure.exact] {
        let whole: f64 = curve
            .windows(2)
            .map(|w| (w[1][0] - w[0][0]) * 0.5 * (w[0][1] + w[1][1]))
            .sum();
        assert!((whole - 1.0).abs() < 0.02, "{whole}");
    }
    // Counted again from the samples themselves.
    let bin = |k: usize| figure.edges[k]..figure.edges[k + 1];
    for k in 1..figure.bars.len() - 1 {
        let count = r.samples.iter().filter(|s| bin(k).contains(s)).count() as f64;
        let width = figure.edges[k + 1] - figure.edges[k];
        let density = count / (r.samples.len() as f64 * width);
        // A sample on the edge may be on either side.
        assert!(
            (density - figure.bars[k]).abs() < 1e-3 * figure.bars[k].max(1.0),
            "{k}: {density} {}",
            figure.bars[k]
        );
    }
    says(&paper::density(&figure), "");
}

#[test]
fn the_figures_numbers_are_those_the_classifier_uses() {
    let vocabulary = punching().expect("a vocabulary");
    let settings = PaperSettings {
        n: 1,
        ..PaperSettings::default()
    };
    let paper = Paper::new(&vocabulary, &settings).expect("a classifier");
    let body = vocabulary.body();
    let seen: Vec<usize> = ["right_elbow", "right_shoulder"]
        .iter()
        .map(|name| body.joint(name).expect("a joint"))
        .collect();
    let missing: Vec<bool> = (0..body.joints().len())
        .map(|j| !seen.contains(&j))
        .collect();
    for (p, phase) in [([0.3, 0.6], 0.7), ([0.9, 0.1], 0.4), ([0.5, 0.5], 0.95)] {
        let pose = vocabulary.primitives()[0]
            .at(&p)
            .expect("a course")
            .pose(phase);
        let observation = Observation {
            secs: 0.0,
            pose: &pose,
            root: None,
            missing: &missing,
        };
        let reading = paper.listen().hear(&observation).expect("a reading");
        let place = paper.place(&pose).expect("coordinates");
        let known = |c: usize| {
            let name = &paper.coordinates()[c];
            name == "right_elbow" || name.starts_with("right_upper_arm")
        };
        for k in 0..vocabulary.primitives().len() {
            let mut phases = vec![[0.0, 1.0]];
            let mut log = 0.0;
            for c in paper
                .chain(k)
                .expect("a chain")
                .into_iter()
                .filter(|&c| known(c))
            {
                let left = paper.attained(k, c, place[c], &phases).expect("phases");
                if left.is_empty() {
                    log = f64::NEG_INFINITY;
                    break;
                }
                // Over the phases that the joints before have left.
                log += paper
                    .density(k, c, place[c], &phases)
                    .expect("a density")
                    .ln();
                log += paper.range_rad(c).expect("a range").ln();
                phases = left;
            }
            let expected = 1.0 / (1.0 + (-log).exp());
            let found = reading.posterior.primitives[k];
            assert!(
                (found - expected).abs() < 1e-9,
                "{p:?} {phase} {k}: {found} {expected}"
            );
            assert!(k > 0 || found > 0.5 && found < 1.0 - 1e-9, "{found}");
        }
    }
}

#[test]
fn figure_7_is_winner_take_all_and_concatenates_what_the_winners_predict() {
    let e = encoding();
    assert!(e.decisions.len() > 10);
    for pair in e.decisions.windows(2) {
        let (d, next) = (&pair[0], &pair[1]);
        let best = d.similarities.iter().copied().fold(0.0, f64::max);
        assert_eq!(d.similarities[d.winner], best);
        assert!((d.end_secs - next.start_secs).abs() < 1e-9);
        // Every primitive's next prediction begins where the winner's ended.
        let end = &d.predicted[d.winner][d.instants()];
        for path in &next.predicted {
            for (a, b) in path[0].iter().zip(end) {
                let (a, b) = (a.expect("a hand"), b.expect("a hand"));
                assert!((a - b).norm() < 1e-9);
            }
        }
    }
    assert_eq!(e.paths.decisions.len(), e.decisions.len());
    says(&paper::encoded_paths(&e.paths), "");
}

#[test]
fn figures_are_the_same_bytes_on_one_thread_and_on_many() {
    let folder = tempfile::tempdir().expect("a folder");
    // Made before there is a pool: whose threads would else wait for it and for each other.
    demo();
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let place = folder.path().join(threads.to_string());
        pool.install(|| {
            let figures = draw(demo(), &mut |_| {}).expect("figures");
            write(&figures, &place, Existing::Keep).expect("written");
            assert!(write(&figures, &place, Existing::Keep).is_err(), "kept");
        });
        place
    };
    let [one, many] = [1, 3].map(of);
    assert_eq!(files().len() % NAMES.len(), 0);
    for name in files() {
        let [a, b] = [&one, &many].map(|p| std::fs::read(p.join(&name)).expect("a figure"));
        assert!(a == b && !a.is_empty(), "{name}");
    }
}
