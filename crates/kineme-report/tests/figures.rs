//! Every figure is one well-formed SVG with a mark for each datum, whatever it is given.

mod made_up;

use kineme_report::{
    Embedding, Figure, GroupPaths, Page, Row, Section, Span, embedding, hand_paths,
    residual_variance, timeline, transitions,
};
use made_up::{MadeUp, made_up};

/// Parses a figure, checks what holds of each, and counts the elements that `counted` accepts.
fn check(svg: &str, counted: impl Fn(&roxmltree::Node) -> bool) -> usize {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    let root = document.root_element();
    assert_eq!(root.tag_name().name(), "svg");
    assert!(
        root.attribute("aria-label")
            .is_some_and(|label| !label.is_empty())
    );
    for node in document.descendants() {
        for attribute in node.attributes() {
            let value = attribute.value();
            assert!(!value.contains("NaN") && !value.contains("inf"), "{value}");
            // One page holds many figures: names of one would be taken for another's.
            assert_ne!(attribute.name(), "id");
        }
    }
    document.descendants().filter(|node| counted(node)).count()
}

fn element(name: &'static str) -> impl Fn(&roxmltree::Node) -> bool {
    move |node| node.has_tag_name(("http://www.w3.org/2000/svg", name))
}

/// Elements that say these words.
fn says(words: &str) -> impl Fn(&roxmltree::Node) -> bool {
    move |node| {
        node.text()
            .is_some_and(|text| node.is_element() && text.contains(words))
    }
}

fn embedded(made: &MadeUp) -> Embedding<'_> {
    Embedding {
        points: &made.points,
        groups: &made.groups,
        names: &made.names,
        recordings: &made.recordings,
    }
}

fn all(made: &MadeUp) -> [String; 5] {
    [
        embedding(&embedded(made)),
        hand_paths(&made.paths),
        residual_variance(&[0.4, 0.1, 0.05], 2),
        timeline(&made.rows, &made.names),
        transitions(&made.names, &made.transitions),
    ]
}

#[test]
fn the_same_data_give_the_same_bytes() {
    assert_eq!(all(&made_up(7, 200)), all(&made_up(7, 200)));
}

#[test]
fn any_size_is_well_formed_and_of_modest_length() {
    for (groups, segments) in [(1, 1), (2, 9), (20, 300), (60, 3000), (200, 3000)] {
        for svg in all(&made_up(groups, segments)) {
            check(&svg, |_| true);
            assert!(
                svg.len() < 2_000_000,
                "{groups} groups: {} bytes",
                svg.len()
            );
        }
    }
}

#[test]
fn without_data_a_figure_says_so() {
    let nothing = [
        embedding(&Embedding::default()),
        hand_paths(&[]),
        hand_paths(&[GroupPaths {
            right: vec![vec![]],
            ..Default::default()
        }]),
        residual_variance(&[], 1),
        timeline(&[], &[]),
        timeline(&[Row::default()], &[]),
        transitions(&[], &[]),
        transitions(&["a".to_owned()], &[vec![0.0]]),
    ];
    for svg in nothing {
        assert_eq!(check(&svg, element("text")), 2, "{svg}");
    }
}

#[test]
fn every_segment_is_a_mark_in_every_view() {
    let made = made_up(5, 90);
    let clustered = made.groups.iter().flatten().count();
    let legend = 5;
    let in_space = embedding(&embedded(&made));
    assert_eq!(check(&in_space, element("path")), 2 * clustered + legend);
    assert_eq!(
        check(&in_space, element("circle")),
        2 * (90 - clustered) + 1
    );
    assert_eq!(
        check(&in_space, element("polyline")),
        2 * made.recordings.len()
    );

    let plane: Vec<Vec<f64>> = made.points.iter().map(|p| p[..2].to_vec()).collect();
    let flat = embedding(&Embedding {
        points: &plane,
        ..embedded(&made)
    });
    assert_eq!(check(&flat, element("path")), clustered + legend);
}

#[test]
fn on_one_dimension_every_group_has_a_row_of_its_own() {
    let made = made_up(5, 90);
    let clustered = made.groups.iter().flatten().count();
    let line: Vec<Vec<f64>> = made.points.iter().map(|p| p[..1].to_vec()).collect();
    let svg = embedding(&Embedding {
        points: &line,
        ..embedded(&made)
    });
    assert_eq!(check(&svg, element("path")), clustered);
    assert_eq!(check(&svg, element("circle")), 90 - clustered);
    let read = roxmltree::Document::parse(&svg).expect("XML");
    let heights = |name: &str| {
        let texts = read.descendants().filter(|n| n.has_tag_name("text"));
        let of = texts.filter(|n| {
            n.text()
                .is_some_and(|t| t.starts_with(&format!("{name} (")))
        });
        of.filter_map(|n| n.attribute("y").map(str::to_owned))
            .collect::<Vec<_>>()
    };
    let mut rows: Vec<String> = made.names.iter().flat_map(|name| heights(name)).collect();
    rows.extend(heights("unclustered"));
    assert_eq!(rows.len(), 6);
    rows.sort();
    rows.dedup();
    assert_eq!(rows.len(), 6, "no two on one height");
}

#[test]
fn what_cannot_be_drawn_is_counted_and_does_no_harm() {
    let points = [
        vec![0.0, 1.0],
        vec![f64::NAN, 0.0],
        vec![1.0, f64::INFINITY],
        vec![2.0],
        vec![],
    ];
    let data = Embedding {
        points: &points,
        groups: &[Some(0), Some(0), None, Some(9)],
        names: &["a".to_owned()],
        recordings: &[vec![0, 3, 77]],
    };
    let svg = embedding(&data);
    assert_eq!(
        check(&svg, says("2 segments without finite coordinates")),
        1
    );
    assert_eq!(check(&svg, element("circle")), 2 + 1);

    let broken = GroupPaths {
        right: vec![vec![[f64::NAN; 3]], vec![[0.0; 3], [0.1; 3]]],
        coherence: Some(f64::NAN),
        ..Default::default()
    };
    assert_eq!(check(&hand_paths(&[broken]), says("1 segment")), 1);
    check(&residual_variance(&[0.5, f64::NAN, 0.1], 2), |_| true);
    check(
        &transitions(&["a".to_owned()], &[vec![3.0, 9.0], vec![f64::NAN]]),
        |_| true,
    );
    let spans = [(0.0, f64::NAN), (-1.0, 2.0), (3.0, 2.0), (1.0, 4.0)];
    let spans = spans.map(|(start, end)| Span {
        start,
        end,
        group: Some(4),
        behavior: None,
    });
    let row = Row {
        name: String::new(),
        spans: spans.to_vec(),
    };
    assert_eq!(
        check(&timeline(&[row], &[]), says("unclustered, 1.00 to 4.00 s")),
        1
    );
}

#[test]
fn names_are_escaped_wherever_they_stand() {
    let name = "a<b> & \"c'\u{7}";
    let mut made = made_up(2, 40);
    made.names[0] = name.to_owned();
    made.paths[0].name = name.to_owned();
    made.rows[0].name = name.to_owned();
    for svg in all(&made) {
        check(&svg, |_| true);
    }
    let svg = hand_paths(&made.paths);
    assert_eq!(check(&svg, says("a<b> & \"c'\u{fffd}")), 1);
    let page = Page {
        title: name.to_owned(),
        summary: vec![name.to_owned()],
        ..Page::default()
    };
    let page = page.html();
    assert_eq!(page.matches("a&lt;b&gt; &amp; &quot;c&#39;").count(), 3);
}

#[test]
fn a_panel_shows_both_hands_twice_and_warns_of_low_coherence() {
    let line = |x: f64| vec![[x, 0.0, 0.0], [x, 0.1, 0.2]];
    let group = |coherence| GroupPaths {
        name: "jab".to_owned(),
        coherence,
        right: vec![line(0.1), line(0.2)],
        left: vec![line(0.3)],
    };
    for (coherence, warnings) in [(Some(0.8), 0), (Some(0.1), 1), (None, 0)] {
        let svg = hand_paths(&[group(coherence)]);
        // Members and mean of each hand in two views, and two lines of the key.
        assert_eq!(check(&svg, element("polyline")), 2 * (2 + 1 + 1 + 1) + 2);
        assert_eq!(check(&svg, says("low coherence")), warnings);
    }
}

#[test]
fn of_many_groups_the_largest_are_shown_and_the_rest_is_owned_up_to() {
    let made = made_up(60, 3000);
    let svg = hand_paths(&made.paths);
    assert_eq!(check(&svg, says("The 24 largest of 60 groups")), 1);
    assert_eq!(check(&svg, says("group-")), 24);
    assert_eq!(check(&svg, says("group-01")), 1);
    let few = hand_paths(&made.paths[..24]);
    assert_eq!(check(&few, says("groups are shown")), 0);
}

#[test]
fn the_mean_path_is_the_mean_at_equal_shares_of_time() {
    let line = |samples: usize, y: f64| -> Vec<[f64; 3]> {
        (0..samples)
            .map(|k| [0.0, y, k as f64 / (samples - 1) as f64])
            .collect()
    };
    // The other hand spans the same room in both figures, so that they have one scale.
    let figure = |right| {
        let left = vec![vec![[-1.0; 3], [1.0; 3]]];
        hand_paths(&[GroupPaths {
            name: "a".to_owned(),
            right,
            left,
            coherence: None,
        }])
    };
    let bold = |svg: &str| -> Vec<String> {
        let of_mean = |l: &&str| {
            l.contains("class=\"right\"")
                && l.contains("2.6\" stroke-linecap=\"round\" stroke-linejoin")
        };
        svg.lines().filter(of_mean).map(str::to_owned).collect()
    };
    let both = bold(&figure(vec![line(11, 0.0), line(2, 0.2)]));
    assert_eq!(both.len(), 2);
    assert_eq!(both, bold(&figure(vec![line(6, 0.1)])));
}

#[test]
fn the_chosen_dimension_is_ringed() {
    for (chosen, rings) in [(1, 1), (3, 1), (4, 0)] {
        let svg = residual_variance(&[0.3, 0.2, 0.1], chosen);
        let ring = |n: &roxmltree::Node| n.attribute("class") == Some("accent-line");
        assert_eq!(check(&svg, ring), rings);
        assert_eq!(check(&svg, element("circle")), 3 + rings);
    }
}

#[test]
fn a_long_recording_is_broken_into_lines_and_loses_nothing() {
    let made = made_up(6, 150);
    let svg = timeline(&made.rows, &made.names);
    let lines = 1 + check(&svg, |n| says("from ")(n) && element("text")(n));
    assert!(lines > 1);
    for span in &made.rows[0].spans {
        let seen = check(
            &svg,
            says(&format!("{:.2} to {:.2} s", span.start, span.end)),
        );
        assert!((1..=2).contains(&seen), "{seen} pieces of {span:?}");
    }
}

#[test]
fn a_transition_is_a_cell_with_its_share_of_the_row() {
    let names = ["a", "b", "c"].map(str::to_owned);
    let svg = transitions(&names, &[vec![0.0, 3.0, 1.0], vec![2.0], vec![]]);
    let cells = check(&svg, |n| element("rect")(n) && n.has_children());
    assert_eq!(cells, 3);
    for words in [
        "a → b: 3, 75 % of its row",
        "a → c: 1, 25 % of its row",
        "b → a: 2, 100 %",
    ] {
        assert_eq!(check(&svg, says(words)), 1, "{words}");
    }
}

#[test]
fn the_page_holds_its_figures_and_loads_nothing() {
    let svg = residual_variance(&[0.2, 0.1], 1);
    let figure = Figure {
        title: "One".into(),
        caption: "A & B".into(),
        svg: svg.clone(),
    };
    let page = Page {
        title: "Vocabulary".into(),
        summary: vec!["First.".into()],
        sections: vec![Section {
            title: "Figures".into(),
            figures: vec![figure.clone(), figure],
            ..Section::default()
        }],
        ..Page::default()
    };
    let html = page.html();
    assert_eq!(html.matches(&svg).count(), 2);
    assert_eq!(html.matches("A &amp; B").count(), 2);
    for reference in ["<script", "src=", "href=", "url(", "@import"] {
        assert!(!html.contains(reference), "{reference}");
    }
}
