//! What BVH files leave unsaid is decided by the documented rules, and told.

use kineme::Recording;
use kineme::math::rotation::Axis;
use kineme_formats::bvh;

/// A standing figure: hips with two legs and a trunk, and rows of root and trunk positions.
struct Figure {
    root_offset: [f64; 3],
    rows: Vec<([f64; 3], [f64; 3])>,
    scale: f64,
    z_up: bool,
}

/// In centimetres, the hips 90 above the floor, the trunk 20 above them, channels in place of `OFFSET`.
fn standing() -> Figure {
    Figure {
        root_offset: [0.0; 3],
        rows: vec![([0.0, 90.0, 0.0], [0.0, 20.0, 0.0]); 3],
        scale: 1.0,
        z_up: false,
    }
}

fn text(figure: &Figure) -> String {
    let vector = |[x, y, z]: [f64; 3]| {
        let [x, y, z] = [x, y, z].map(|v| v * figure.scale);
        if figure.z_up {
            format!("{z} {x} {y}")
        } else {
            format!("{x} {y} {z}")
        }
    };
    let leg = |name: &str, x: f64| {
        format!(
            "JOINT {name} {{\nOFFSET {}\nCHANNELS 1 Xrotation\nEnd Site {{\nOFFSET {}\n}}\n}}\n",
            vector([x, 0.0, 0.0]),
            vector([0.0, -90.0, 0.0])
        )
    };
    let mut text = format!(
        "HIERARCHY\nROOT hips {{\nOFFSET {}\nCHANNELS 3 Xposition Yposition Zposition\n{}{}\
         JOINT trunk {{\nOFFSET {}\nCHANNELS 6 Xrotation Zrotation Yrotation Zposition Xposition Yposition\n\
         End Site {{\nOFFSET {}\n}}\n}}\n}}\nMOTION\nFrames : {}\nFRAME TIME:\t.5\n",
        vector(figure.root_offset),
        leg("left", 10.0),
        leg("right", -10.0),
        vector([0.0, 20.0, 0.0]),
        vector([0.0, 50.0, 0.0]),
        figure.rows.len()
    );
    for (root, trunk) in &figure.rows {
        let trunk = vector(*trunk);
        let trunk: Vec<&str> = trunk.split(' ').collect();
        // The line above gives z before x and y, after the rotations.
        text += &format!(
            "{} 0 0 0 0 0 {} {} {}\n",
            vector(*root),
            trunk[2],
            trunk[0],
            trunk[1]
        );
    }
    text
}

/// The heights of hips and trunk in the last frame, metres, and the recording.
fn read(figure: &Figure) -> (f64, f64, Recording) {
    let recording = bvh::parse("figure.bvh", text(figure).as_bytes()).expect("a figure");
    let placed = recording.placements(recording.frames() - 1);
    let height = |joint: usize| placed[joint].position.expect("a place").z;
    (height(0), height(3), recording)
}

fn check(figure: &Figure, hips: f64, trunk: f64, says: &str) {
    let (found_hips, found_trunk, recording) = read(figure);
    let warnings = recording.source().warnings.join("; ");
    assert!(
        (found_hips - hips).abs() < 1e-12,
        "hips at {found_hips}: {warnings}"
    );
    assert!(
        (found_trunk - trunk).abs() < 1e-12,
        "trunk at {found_trunk}: {warnings}"
    );
    assert!(
        warnings.contains(says),
        "{warnings:?} does not say {says:?}"
    );
}

#[test]
fn children_near_their_offset_replace_it_and_near_zero_are_added() {
    let mut figure = standing();
    check(&figure, 0.9, 1.1, "below the root replace their OFFSET");
    figure.rows.iter_mut().for_each(|r| r.1 = [0.0, 21.0, 0.0]);
    check(&figure, 0.9, 1.11, "below the root replace their OFFSET");
    figure.rows.iter_mut().for_each(|r| r.1 = [0.0, 1.0, 0.0]);
    check(
        &figure,
        0.9,
        1.11,
        "below the root are added to their OFFSET",
    );
}

#[test]
fn a_root_with_an_offset_goes_where_the_feet_reach_the_floor() {
    let mut figure = standing();
    figure.root_offset = [0.0, 90.0, 0.0];
    check(&figure, 0.9, 1.1, "which they repeat");
    figure.rows.iter_mut().for_each(|r| r.0 = [3.0, 2.0, 0.0]);
    check(&figure, 0.92, 1.12, "root are added to its OFFSET");
    figure.root_offset = [0.0, 30.0, 0.0];
    figure.rows.iter_mut().for_each(|r| r.0 = [3.0, 92.0, 0.0]);
    check(&figure, 0.92, 1.12, "root replace its OFFSET");
    // Neither reaches the floor: replace.
    figure.rows.iter_mut().for_each(|r| r.0 = [3.0, 900.0, 0.0]);
    check(&figure, 9.0, 9.2, "root replace its OFFSET");
}

#[test]
fn the_unit_is_the_one_that_makes_an_adult() {
    for (scale, unit, told) in [
        (0.01, 1.0, "1 m a unit"),
        (1.0, 0.01, "0.01 m a unit"),
        (1.0 / 2.54, 0.0254, "0.0254 m a unit"),
        (10.0, 0.001, "0.001 m a unit"),
        (0.45 / 2.54, 0.0254 / 0.45, "0.0564444 m a unit"),
    ] {
        for size in [0.8, 1.0, 1.2] {
            let figure = Figure {
                scale: scale * size,
                ..standing()
            };
            let (hips, _, recording) = read(&figure);
            let source = recording.source();
            assert_eq!(source.unit_metres, unit, "{scale} {size}");
            assert!((hips - 0.9 * size).abs() < 1e-9, "{hips}");
            assert!(source.warnings[0].contains(told), "{:?}", source.warnings);
        }
    }
}

#[test]
fn the_up_axis_is_the_one_that_the_body_stands_along() {
    for z_up in [false, true] {
        let (hips, trunk, recording) = read(&Figure { z_up, ..standing() });
        assert_eq!(recording.source().up, if z_up { Axis::Z } else { Axis::Y });
        assert!((hips - 0.9).abs() < 1e-12 && (trunk - 1.1).abs() < 1e-12);
        assert_eq!(recording.rate_hz(), 2.0);
    }
}
