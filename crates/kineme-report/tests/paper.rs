//! The paper's figures as drawings: well-formed, the same each time, and honest when there is nothing to draw.

use kineme_report::paper::{
    Arrow, Cell, Density, EncodedDecision, EncodedPaths, Flow, Flowchart, HandPanel, Mixture, Node,
    ParameterSet, Stick, density, encoded_paths, flow, flowchart, hand_panels, mixture,
};

/// Parses a figure and counts its elements of a name.
fn check(svg: &str, name: &str) -> usize {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    let root = document.root_element();
    assert!(root.attribute("aria-label").is_some_and(|l| !l.is_empty()));
    for node in document.descendants() {
        for attribute in node.attributes() {
            let value = attribute.value();
            assert!(!value.contains("NaN") && !value.contains("inf"), "{value}");
            assert_ne!(attribute.name(), "id", "pages hold many figures");
        }
    }
    let of = |n: &roxmltree::Node| n.has_tag_name(("http://www.w3.org/2000/svg", name));
    document.descendants().filter(of).count()
}

fn line(y: f64) -> Vec<[f64; 2]> {
    vec![[0.0, y], [1.0, y + 0.5]]
}

fn all() -> [String; 6] {
    let title = || "A <title> & more".to_string();
    let cell = Cell {
        phase: [0.5, 0.75],
        across: [0.2, 0.4],
        share: 0.5,
    };
    let hand = vec![vec![[0.1, 0.2, 0.3], [0.2, 0.2, 0.1]]];
    let stick = Stick {
        at: [0.5, 0.5],
        phase: 0.5,
        exemplar: 0,
        bones: vec![[[0.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [0.3, 0.6]]],
        moving: 1,
    };
    [
        hand_panels(&[HandPanel {
            title: title(),
            coherence: Some(-0.25),
            unintended: true,
            right: hand.clone(),
            left: hand.clone(),
            right_interpolated: hand.clone(),
            left_interpolated: hand,
            ..HandPanel::default()
        }]),
        flow(&Flow {
            title: title(),
            arrows: vec![Arrow {
                from: [1.0, 0.0],
                to: [0.0, 1.0],
                phase: 0.5,
            }],
            exemplars: vec![vec![([1.0, 0.0], 0.0), ([0.0, 1.0], 1.0)]],
            above: vec![stick.clone()],
            below: vec![stick],
            ..Flow::default()
        }),
        flowchart(&Flowchart {
            title: title(),
            size: [300.0, 200.0],
            nodes: vec![Node {
                name: "a & b".into(),
                place: [50.0, 80.0, 100.0, 60.0],
                ..Node::default()
            }],
            ..Flowchart::default()
        }),
        mixture(&Mixture {
            title: title(),
            envelope: vec![[0.0, 0.0, 1.0], [1.0, 0.5, 2.0]],
            exemplars: vec![line(0.1), line(0.9)],
            level: Some([0.7, 0.1]),
            intervals: vec![[0.4, 0.9]],
            exact: vec![cell],
            parameters: Some(ParameterSet {
                name: "p".into(),
                cells: vec![cell],
            }),
            ..Mixture::default()
        }),
        density(&Density {
            title: title(),
            edges: vec![0.0, 0.5, 1.0],
            bars: vec![0.5, 1.5],
            kernel: line(0.5),
            exact: line(0.2),
            uniform: line(0.1),
            ..Density::default()
        }),
        encoded_paths(&EncodedPaths {
            title: title(),
            names: vec!["a".into(), "b".into()],
            observed: line(0.1),
            encoded: line(0.2),
            observed_view: line(0.1),
            encoded_view: line(0.2),
            decisions: vec![EncodedDecision {
                start: 0.0,
                end: 1.0,
                winner: 1,
                similarities: vec![0.25, 0.75],
                predicted: vec![line(0.2), line(0.3)],
                predicted_view: vec![line(0.2), line(0.3)],
            }],
            truth: vec![(0.0, 1.0, 0)],
            ..EncodedPaths::default()
        }),
    ]
}

#[test]
fn figures_are_well_formed_and_the_same_each_time() {
    let figures = all();
    assert_eq!(figures, all());
    for svg in &figures {
        assert!(check(svg, "text") > 1);
    }
    // Two exemplars, the level and the interval's two ends are lines; so are those of the legend.
    assert_eq!(check(&figures[3], "polyline"), 2 + 1 + 2 + 2 + 2);
}

#[test]
fn without_data_a_figure_says_so() {
    for svg in [
        hand_panels(&[]),
        hand_panels(&[HandPanel::default()]),
        flow(&Flow::default()),
        flowchart(&Flowchart::default()),
        mixture(&Mixture::default()),
        density(&Density::default()),
        encoded_paths(&EncodedPaths::default()),
    ] {
        assert_eq!(check(&svg, "text"), 2, "{svg}");
    }
}

#[cfg(feature = "png")]
#[test]
fn a_png_is_as_large_as_it_should_be_and_shows_its_words() {
    use kineme_report::png;
    let svg = &all()[2];
    let picture = png(svg, 2.0).expect("a picture");
    assert_eq!(picture, png(svg, 2.0).expect("a picture"));
    let side = |at: usize| u32::from_be_bytes(picture[at..at + 4].try_into().expect("four bytes"));
    assert_eq!(
        (&picture[1..4], side(16), side(20)),
        (&b"PNG"[..], 600, 400)
    );
    let mute = svg.replace("a &amp; b", "");
    assert_ne!(
        picture,
        png(&mute, 2.0).expect("a picture"),
        "text is drawn"
    );
    for (svg, scale) in [
        ("no svg", 1.0),
        (svg.as_str(), 0.0),
        (svg.as_str(), 1e6),
        (svg.as_str(), f64::NAN),
    ] {
        assert!(png(svg, scale).is_err(), "{scale}");
    }
}
