//! The page is one file that loads nothing, and its data are what was put in.

#[path = "made_up/scene.rs"]
mod scene;

use kineme_report::scene::{Floats, Places, Scene, Shares};
use kineme_report::{Page, Section, Table, strip, viewer};

fn page() -> Page {
    Page {
        title: "A <page> & more".into(),
        scene: scene::scene(),
        sections: vec![
            Section {
                title: "One".into(),
                cards: 0..1,
                ..Section::default()
            },
            Section {
                title: "<Two>".into(),
                cards: 1..2,
                ..Section::default()
            },
        ],
        ..Page::default()
    }
}

#[test]
fn the_same_data_give_the_same_bytes() {
    assert!(page().html() == page().html());
}

#[test]
fn the_page_loads_nothing() {
    // What leads to a place on the page itself loads nothing.
    let html = page().html().replace(" href=\"#", "");
    assert!(html.contains("default-src 'none'"));
    for reference in [" src=", " href=", "url(", "@import", "import("] {
        assert!(!html.contains(reference), "{reference}");
    }
    // Names of XML languages are the only addresses, and nobody loads those.
    let unnamed = html.replace("http://www.w3.org/", "");
    let style = unnamed.split("<script").next().unwrap_or_default();
    assert!(!style.contains("http:") && !style.contains("https:"));
}

#[test]
fn no_name_ends_a_script() {
    let html = page().html();
    let scripts = if viewer().is_some() { 2 } else { 0 };
    assert_eq!(html.matches("</script>").count(), scripts);
    assert_eq!(html.matches("<wave>").count(), 0);
}

#[test]
fn a_scene_survives_json() {
    let scene = scene::scene();
    let json = serde_json::to_string(&scene).expect("JSON");
    let mut back: Scene = serde_json::from_str(&json).expect("a scene");
    // Where exemplars come from is told by the page itself.
    for (back, card) in back.primitives.iter_mut().zip(&scene.primitives) {
        back.sources.clone_from(&card.sources);
    }
    assert_eq!(back, scene);
}

#[test]
fn packed_numbers_come_back_to_half_a_step() {
    let rows = vec![
        vec![[0.0, -1.5, 2.25], [f64::NAN, 0.0, 0.0]],
        vec![[8.0, 0.1234, -8.0], [1e-3, 0.0, 0.0]],
    ];
    let packed = Places::pack(&rows);
    let back = packed.unpack();
    assert_eq!((packed.rows, packed.points, back.len()), (2, 2, 2));
    assert_eq!(back[0][1], None, "not finite is missing");
    for (row, back) in rows.iter().zip(&back) {
        for (p, b) in row.iter().zip(back).filter(|(_, b)| b.is_some()) {
            let b = b.expect("there");
            for (x, y) in p.iter().zip(b) {
                assert!((x - y).abs() <= 0.5 * packed.step + 1e-12, "{x} {y}");
            }
        }
    }
    assert!(packed.step < 3e-4);
    assert_eq!(
        Floats::pack([1.5, -2.0, f64::NAN]).unpack(),
        [1.5, -2.0, 0.0]
    );
    assert_eq!(
        Shares::pack([0.0, 1.0, 2.0, -1.0]).unpack(),
        [0.0, 1.0, 1.0, 0.0]
    );
}

#[test]
fn damaged_places_unpack_to_nothing() {
    for (rows, points, data) in [
        (1, 1, "AAAA"),
        (2, 1, "AAAAAAAA"),
        (1, 0, ""),
        (1, 1, "\u{fc}"),
    ] {
        let places = Places {
            rows,
            points,
            step: 1.0,
            data: data.into(),
        };
        assert!(places.unpack().is_empty(), "{rows} {points} {data}");
    }
}

#[test]
fn a_strip_draws_every_bone_of_every_posture() {
    let scene = scene::scene();
    let (body, card) = (&scene.bodies[0], &scene.primitives[0]);
    let svg = strip("a <wave>", body, &card.lattice, &[0, 5, 10], "#0072b2");
    let document = roxmltree::Document::parse(&svg).expect("well-formed XML");
    let paths = document
        .descendants()
        .filter(|n| n.tag_name().name() == "path");
    // Each with a rim.
    assert_eq!(paths.count(), 3 * 2 * body.bones.len());
    assert!(!svg.contains("NaN"));
    let none = strip("nothing", body, &Places::default(), &[0, 1], "#000");
    assert!(!none.contains("<path"));
}

#[test]
fn columns_of_numbers_stand_right() {
    let cells = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
    let table = Table {
        caption: "a & b".into(),
        header: cells(["name", "value", "share"]),
        rows: vec![
            cells(["x<y", "1.5", "30 %"]),
            cells(["z", "-", "\u{2212}2 %"]),
        ],
    };
    let html = table.html();
    assert_eq!(html.matches("class=\"number\"").count(), 2 * 3);
    assert!(html.contains("x&lt;y") && html.contains("a &amp; b"));
}

#[test]
fn sources_are_links_where_a_take_shows_them() {
    let html = page().html();
    assert_eq!(
        html.matches("data-take=\"1\" data-secs=\"1.500\"").count(),
        2
    );
    assert!(html.contains("<li title=\"takes/elsewhere.bvh\">elsewhere"));
    assert!(html.contains("&lt;/a&gt; &amp; one"));
}

#[test]
fn many_cards_have_an_index() {
    let card = scene::scene().primitives.remove(1);
    for (cards, links) in [(6, 0), (7, 7)] {
        let mut page = page();
        page.scene.primitives = vec![card.clone(); cards];
        page.sections[0].cards = 0..cards;
        let html = page.html();
        assert_eq!(html.matches("<a href=\"#primitive-").count(), links);
        assert_eq!(html.matches("id=\"primitive-").count(), cards + 1);
    }
}
