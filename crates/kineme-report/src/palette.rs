//! How groups are told apart: six colours in three lightnesses, six shapes, full and hollow.

use crate::svg::{number, tenth};

/// Colours that people of every colour vision tell apart (Okabe and Ito 2008, "Color universal design"), without its
/// black, which is the text's, and its yellow, which is faint on white.
const HUES: [[f64; 3]; 6] = [
    [0.0, 114.0, 178.0],
    [213.0, 94.0, 0.0],
    [0.0, 158.0, 115.0],
    [204.0, 121.0, 167.0],
    [230.0, 159.0, 0.0],
    [86.0, 180.0, 233.0],
];

/// How many groups have a colour of their own.
pub const COLOURS: usize = 3 * HUES.len();

/// The colour of a group as `#rrggbb`; after [`COLOURS`] they begin anew.
pub fn colour(group: usize) -> String {
    let [r, g, b] = HUES[group % HUES.len()].map(|level| {
        let level = match group / HUES.len() % 3 {
            0 => level,
            1 => level * 0.66,
            _ => level + (255.0 - level) * 0.42,
        };
        level.round() as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Black or white, whichever reads better on a group's colour (relative luminance of WCAG 2.1).
pub fn text_on(group: usize) -> &'static str {
    let hex = colour(group);
    let level = |at: usize| {
        let byte = u8::from_str_radix(hex.get(at..at + 2).unwrap_or("00"), 16).unwrap_or(0);
        let c = f64::from(byte) / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    let luminance = 0.2126 * level(1) + 0.7152 * level(3) + 0.0722 * level(5);
    if luminance > 0.179 { "#000" } else { "#fff" }
}

/// The attributes that all marks of a group share.
pub fn mark_style(group: usize) -> String {
    let colour = colour(group);
    if is_hollow(group) {
        format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.3\"")
    } else {
        format!("fill=\"{colour}\" fill-opacity=\"0.85\"")
    }
}

fn is_hollow(group: usize) -> bool {
    group / (HUES.len() * 6) % 2 == 1
}

/// The outline of a group's mark about a point as path data: disc, square, triangle, diamond, triangle down, cross.
pub fn mark(group: usize, [x, y]: [f64; 2], radius: f64) -> String {
    let r = radius;
    let polygon = |corners: &[[f64; 2]]| {
        let mut data = String::new();
        for (i, [dx, dy]) in corners.iter().enumerate() {
            data.push(if i == 0 { 'M' } else { 'L' });
            data.push_str(&format!("{} {}", tenth(x + dx * r), tenth(y + dy * r)));
        }
        data + "Z"
    };
    match group / HUES.len() % 6 {
        0 => {
            let (left, d, r) = (tenth(x - r), tenth(2.0 * r), number(r));
            format!(
                "M{left} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z",
                tenth(y)
            )
        }
        1 => polygon(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        2 => polygon(&[[0.0, -1.15], [1.1, 0.85], [-1.1, 0.85]]),
        3 => polygon(&[[0.0, -1.25], [1.1, 0.0], [0.0, 1.25], [-1.1, 0.0]]),
        4 => polygon(&[[0.0, 1.15], [-1.1, -0.85], [1.1, -0.85]]),
        _ => polygon(&[
            [-1.1, -0.4],
            [-0.4, -0.4],
            [-0.4, -1.1],
            [0.4, -1.1],
            [0.4, -0.4],
            [1.1, -0.4],
            [1.1, 0.4],
            [0.4, 0.4],
            [0.4, 1.1],
            [-0.4, 1.1],
            [-0.4, 0.4],
            [-1.1, 0.4],
        ]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_72_groups_look_different() {
        let looks: std::collections::BTreeSet<String> = (0..72)
            .map(|group| mark_style(group) + &mark(group, [0.0, 0.0], 3.0))
            .collect();
        assert_eq!(looks.len(), 72);
        let colours: std::collections::BTreeSet<String> = (0..COLOURS).map(colour).collect();
        assert_eq!(colours.len(), COLOURS);
    }
}
