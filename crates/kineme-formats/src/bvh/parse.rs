//! The text of a BVH file: hierarchy, header of the motion, rows.

use kineme::math::rotation::Axis;
use nalgebra::Vector3;

use super::{Channel, File, Joint};
use crate::error::{FormatError, Result};
use crate::text::{Blame, Lines, decoded, make_unique, number, quoted, words};

/// Reads the text; decides nothing that it does not say.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<File> {
    let blame = Blame(name);
    let mut lines = Lines::new(bytes);
    let mut hierarchy = Hierarchy::new(blame);
    match lines.next_full() {
        Some((_, line)) if line.eq_ignore_ascii_case(b"HIERARCHY") => {}
        Some((at, line)) => return Err(blame.line(at, quoted(line), "`HIERARCHY`")),
        None => return Err(blame.file("an empty file", "`HIERARCHY`")),
    }
    loop {
        let Some((at, line)) = lines.next_full() else {
            return Err(blame.line(
                lines.number(),
                "the end of the file",
                "more joints, or `MOTION`",
            ));
        };
        if line.eq_ignore_ascii_case(b"MOTION") {
            hierarchy.close(at)?;
            break;
        }
        hierarchy.line(at, line)?;
    }
    let mut joints = hierarchy.joints;
    let mut warnings = hierarchy.warnings;
    let mut names: Vec<String> = joints
        .iter_mut()
        .map(|j| std::mem::take(&mut j.name))
        .collect();
    warnings.extend(make_unique(&mut names));
    for (joint, unique) in joints.iter_mut().zip(names) {
        joint.name = unique;
    }

    let (declared_at, text) = header(blame, &mut lines, &["frames"], "`Frames: <count>`")?;
    let declared = std::str::from_utf8(text)
        .ok()
        .and_then(|t| t.parse::<usize>().ok())
        .filter(|&n| n > 0)
        .ok_or_else(|| blame.line(declared_at, quoted(text), "a count of frames above zero"))?;
    let (at, text) = header(
        blame,
        &mut lines,
        &["frame", "time"],
        "`Frame Time: <seconds>`",
    )?;
    let frame_secs = number(text)
        .filter(|&t| t > 0.0 && t.recip().is_finite())
        .ok_or_else(|| blame.line(at, quoted(text), "seconds a frame, above zero"))?;

    let channels = joints.iter().map(|j| j.channels.len()).sum();
    if channels == 0 {
        return Err(blame.line(declared_at, "a skeleton without channels", "`CHANNELS`"));
    }
    let values = rows(blame, &mut lines, bytes.len(), channels, declared)?;
    let frames = values.len() / channels;
    if frames < declared {
        return Err(blame.line(
            lines.number(),
            format!("the end of the file after {frames} rows"),
            format!("the {declared} rows that line {declared_at} declares"),
        ));
    }
    let extra = std::iter::from_fn(|| lines.next_full()).count();
    if extra > 0 {
        warnings.push(format!(
            "{extra} lines follow the {declared} declared rows and were left out"
        ));
    }
    Ok(File {
        joints,
        frame_secs,
        values,
        frames,
        warnings,
    })
}

/// The value of a line such as `Frame Time: 0.01`, whatever its spacing and case.
fn header<'a>(
    blame: Blame<'_>,
    lines: &mut Lines<'a>,
    keys: &[&str],
    expected: &str,
) -> Result<(usize, &'a [u8])> {
    let Some((at, line)) = lines.next_full() else {
        return Err(blame.line(lines.number(), "the end of the file", expected));
    };
    let mut rest = line;
    for key in keys {
        let Some((head, tail)) = rest.split_at_checked(key.len()) else {
            return Err(blame.line(at, quoted(line), expected));
        };
        if !head.eq_ignore_ascii_case(key.as_bytes()) {
            return Err(blame.line(at, quoted(line), expected));
        }
        rest = tail.trim_ascii_start();
    }
    Ok((at, rest.strip_prefix(b":").unwrap_or(rest).trim_ascii()))
}

/// At most `declared` rows of exactly `channels` numbers each.
fn rows(
    blame: Blame<'_>,
    lines: &mut Lines<'_>,
    bytes: usize,
    channels: usize,
    declared: usize,
) -> Result<Vec<f64>> {
    // A number takes two bytes at least: the count that a file declares is not trusted.
    let most = bytes / 2 + 1;
    let mut values = Vec::with_capacity(declared.saturating_mul(channels).min(most));
    for _ in 0..declared {
        let Some((at, line)) = lines.next_full() else {
            break;
        };
        let before = values.len();
        for word in words(line) {
            let value = number(word).ok_or_else(|| {
                let column = values.len() - before + 1;
                blame.line(
                    at,
                    format!("{} in column {column}", quoted(word)),
                    "a number",
                )
            })?;
            values.push(value);
        }
        let found = values.len() - before;
        if found != channels {
            return Err(blame.line(
                at,
                format!("{found} numbers"),
                format!("{channels}, one a channel"),
            ));
        }
    }
    Ok(values)
}

/// What a brace opened.
enum Open {
    Joint { index: usize, offset: bool },
    Site { joint: usize, offset: bool },
}

/// The hierarchy read so far.
struct Hierarchy<'a> {
    blame: Blame<'a>,
    joints: Vec<Joint>,
    warnings: Vec<String>,
    open: Vec<Open>,
    /// A joint or site whose brace has not come yet.
    announced: Option<Open>,
}

impl<'a> Hierarchy<'a> {
    fn new(blame: Blame<'a>) -> Self {
        Self {
            blame,
            joints: Vec::new(),
            warnings: Vec::new(),
            open: Vec::new(),
            announced: None,
        }
    }

    /// Takes one line, in which braces may stand beside other words.
    fn line(&mut self, at: usize, line: &[u8]) -> Result<()> {
        let mut rest = line;
        while !rest.is_empty() {
            let end = match rest[0] {
                b'{' | b'}' => 1,
                _ => rest
                    .iter()
                    .position(|b| matches!(b, b'{' | b'}'))
                    .unwrap_or(rest.len()),
            };
            let (part, tail) = rest.split_at(end);
            self.part(at, part.trim_ascii())?;
            rest = tail.trim_ascii_start();
        }
        Ok(())
    }

    fn part(&mut self, at: usize, part: &[u8]) -> Result<()> {
        if part == b"{" {
            let opened = self
                .announced
                .take()
                .ok_or_else(|| self.wrong(at, part, "a joint or end site before it"))?;
            self.open.push(opened);
            return Ok(());
        }
        if self.announced.is_some() {
            return Err(self.wrong(at, part, "`{`"));
        }
        if part == b"}" {
            return match self.open.pop() {
                Some(Open::Joint { offset: true, .. } | Open::Site { offset: true, .. }) => Ok(()),
                Some(_) => Err(self.wrong(at, part, "`OFFSET` before it")),
                None => Err(self.wrong(at, part, "`ROOT` or `MOTION`")),
            };
        }
        let (key, rest) = part.split_at(
            part.iter()
                .position(u8::is_ascii_whitespace)
                .unwrap_or(part.len()),
        );
        let rest = rest.trim_ascii();
        match key.to_ascii_uppercase().as_slice() {
            b"ROOT" if self.open.is_empty() => self.joint(at, None, rest),
            b"JOINT" => match self.open.last() {
                Some(Open::Joint { index, .. }) => self.joint(at, Some(*index), rest),
                _ => Err(self.wrong(at, part, "`JOINT` only inside a joint")),
            },
            b"END" => match self.open.last() {
                Some(Open::Joint { index, .. }) => {
                    self.announced = Some(Open::Site {
                        joint: *index,
                        offset: false,
                    });
                    Ok(())
                }
                _ => Err(self.wrong(at, part, "`End Site` only inside a joint")),
            },
            b"OFFSET" => self.offset(at, rest),
            b"CHANNELS" => self.channels(at, rest),
            _ => Err(self.wrong(
                at,
                part,
                "`ROOT`, `JOINT`, `End Site`, `OFFSET`, `CHANNELS`, `}` or `MOTION`",
            )),
        }
    }

    fn joint(&mut self, at: usize, parent: Option<usize>, name: &[u8]) -> Result<()> {
        if name.is_empty() {
            return Err(self.wrong(at, name, "the joint's name"));
        }
        self.announced = Some(Open::Joint {
            index: self.joints.len(),
            offset: false,
        });
        self.joints.push(Joint {
            name: decoded(name),
            parent,
            offset: Vector3::zeros(),
            site: None,
            channels: Vec::new(),
        });
        Ok(())
    }

    fn offset(&mut self, at: usize, rest: &[u8]) -> Result<()> {
        let numbers: Option<Vec<f64>> = words(rest).map(number).collect();
        let Some([x, y, z]) = numbers.as_deref() else {
            return Err(self.wrong(at, rest, "three numbers after `OFFSET`"));
        };
        let value = Vector3::new(*x, *y, *z);
        match self.open.last_mut() {
            Some(Open::Joint { index, offset }) if !*offset => {
                *offset = true;
                self.joints[*index].offset = value;
            }
            Some(Open::Site { joint, offset }) if !*offset => {
                *offset = true;
                let joint = &mut self.joints[*joint];
                if joint.site.is_none() {
                    joint.site = Some(value);
                } else {
                    self.warnings.push(format!(
                        "`{}` has more than one end site; the first was kept",
                        joint.name
                    ));
                }
            }
            _ => return Err(self.wrong(at, b"OFFSET", "one `OFFSET` in a joint or end site")),
        }
        Ok(())
    }

    fn channels(&mut self, at: usize, rest: &[u8]) -> Result<()> {
        let index = match self.open.last() {
            Some(Open::Joint { index, .. }) if self.joints[*index].channels.is_empty() => *index,
            _ => return Err(self.wrong(at, b"CHANNELS", "one `CHANNELS` in a joint")),
        };
        let mut names = words(rest);
        let count = names
            .next()
            .and_then(|w| std::str::from_utf8(w).ok())
            .and_then(|w| w.parse::<usize>().ok());
        let channels: Option<Vec<Channel>> = names.map(channel).collect();
        let channels = channels.ok_or_else(|| {
            self.wrong(
                at,
                rest,
                "channels named `Xposition` to `Zposition` and `Xrotation` to `Zrotation`",
            )
        })?;
        if count != Some(channels.len()) {
            return Err(self.wrong(at, rest, "as many channels as the line declares"));
        }
        let positions = |axis| {
            channels
                .iter()
                .filter(|&&c| c == Channel::Position(axis))
                .count()
        };
        let turns: Vec<Channel> = channels
            .iter()
            .copied()
            .filter(|c| matches!(c, Channel::Rotation(_)))
            .collect();
        let repeated = [Axis::X, Axis::Y, Axis::Z]
            .map(positions)
            .iter()
            .any(|&n| n > 1)
            || turns.windows(2).any(|pair| pair[0] == pair[1])
            || turns.len() > 3;
        if repeated {
            return Err(self.wrong(
                at,
                rest,
                "each position once and at most three rotations, neighbours about different axes",
            ));
        }
        self.joints[index].channels = channels;
        Ok(())
    }

    /// Everything is closed and something was there.
    fn close(&self, at: usize) -> Result<()> {
        if !self.open.is_empty() || self.announced.is_some() {
            return Err(self.wrong(at, b"MOTION", "`}` for every `{` before it"));
        }
        if self.joints.is_empty() {
            return Err(self.wrong(at, b"MOTION", "a `ROOT` before it"));
        }
        Ok(())
    }

    fn wrong(&self, at: usize, found: &[u8], expected: &str) -> FormatError {
        self.blame.line(at, quoted(found), expected)
    }
}

/// `Xposition` to `Zrotation`, in any case.
fn channel(word: &[u8]) -> Option<Channel> {
    let (first, rest) = word.split_first()?;
    let axis = match first.to_ascii_uppercase() {
        b'X' => Axis::X,
        b'Y' => Axis::Y,
        b'Z' => Axis::Z,
        _ => return None,
    };
    if rest.eq_ignore_ascii_case(b"position") {
        Some(Channel::Position(axis))
    } else if rest.eq_ignore_ascii_case(b"rotation") {
        Some(Channel::Rotation(axis))
    } else {
        None
    }
}
