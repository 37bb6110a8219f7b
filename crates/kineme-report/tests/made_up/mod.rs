//! Made-up results of a derivation, of any size, the same each time.

use kineme_report::{GroupPaths, Row, Span};

/// A small generator (Lehmer, modulus 2^31 - 1): enough to scatter points.
pub struct Noise(u64);

impl Noise {
    pub fn new() -> Self {
        Self(1)
    }

    /// The next number in [-1, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 1_073_741_823.5 - 1.0
    }
}

pub struct MadeUp {
    pub names: Vec<String>,
    pub points: Vec<Vec<f64>>,
    pub groups: Vec<Option<usize>>,
    pub recordings: Vec<Vec<usize>>,
    pub paths: Vec<GroupPaths>,
    pub rows: Vec<Row>,
    pub transitions: Vec<Vec<f64>>,
}

/// `segments` segments in `groups` groups, one in nine unclustered, in recordings of 150.
pub fn made_up(groups: usize, segments: usize) -> MadeUp {
    let mut noise = Noise::new();
    let names: Vec<String> = (1..=groups).map(|k| format!("group-{k:02}")).collect();
    let centres: Vec<[f64; 3]> = (0..groups)
        .map(|_| [0; 3].map(|_| 3.0 * noise.next()))
        .collect();
    let mut made = MadeUp {
        names,
        points: Vec::new(),
        groups: Vec::new(),
        recordings: vec![Vec::new(); segments.div_ceil(150)],
        paths: Vec::new(),
        rows: Vec::new(),
        transitions: vec![vec![0.0; groups]; groups],
    };
    let mut previous: Option<usize> = None;
    for i in 0..segments {
        // Groups follow one another in a ring, and now and then leap; the first are the largest.
        let leap = ((noise.next().abs().powi(2)) * groups as f64) as usize;
        let group = match previous {
            Some(g) if noise.next() < 0.4 => (g + 1) % groups,
            _ => leap.min(groups - 1),
        };
        let kept = (i % 9 != 4).then_some(group);
        let spread = if kept.is_some() { 0.16 } else { 1.6 };
        let point = centres[group]
            .iter()
            .map(|c| c + spread * (noise.next() + noise.next()));
        made.points.push(point.collect());
        made.groups.push(kept);
        made.recordings[i / 150].push(i);
        if let (Some(from), Some(to)) = (previous, kept) {
            made.transitions[from][to] += 1.0;
        }
        previous = kept;
    }
    for (k, recording) in made.recordings.iter().enumerate() {
        let mut time = 0.4;
        let spans = recording.iter().map(|&i| {
            let start = time;
            time += 0.6 + 0.4 * noise.next();
            let group = made.groups[i];
            let behavior = group.map(|g| format!("behavior-{:02}", g / 3 + 1));
            Span {
                start,
                end: time,
                group,
                behavior,
            }
        });
        let spans = spans.collect();
        made.rows.push(Row {
            name: format!("set.zip/subject-{k:02}/take_{k:03}.bvh"),
            spans,
        });
    }
    for (g, name) in made.names.iter().enumerate() {
        let size = made.groups.iter().filter(|x| **x == Some(g)).count();
        let paths = PathsOfGroup::draw(&mut noise);
        let mut members = |side: f64| (0..size).map(|_| paths.member(&mut noise, side)).collect();
        made.paths.push(GroupPaths {
            name: name.clone(),
            coherence: (g % 7 != 6).then_some(0.82 - 0.17 * (g % 6) as f64),
            right: members(-1.0),
            left: members(1.0),
        });
    }
    made
}

/// What the movements of a group have in common.
struct PathsOfGroup {
    reach: [f64; 3],
    lift: f64,
}

impl PathsOfGroup {
    fn draw(noise: &mut Noise) -> Self {
        let reach = [
            0.3 + 0.25 * noise.next(),
            0.25 * noise.next(),
            0.3 * noise.next(),
        ];
        Self {
            reach,
            lift: 0.2 * noise.next(),
        }
    }

    fn member(&self, noise: &mut Noise, side: f64) -> Vec<[f64; 3]> {
        let scale = if side < 0.0 { 1.0 } else { 0.35 };
        let off: [f64; 3] = [0; 3].map(|_| 0.05 * noise.next());
        let frames = 20 + (10.0 * noise.next()) as usize;
        (0..frames)
            .map(|k| {
                let t = k as f64 / (frames - 1) as f64;
                let out = (std::f64::consts::PI * t).sin() * scale;
                [
                    0.15 + self.reach[0] * out + off[0],
                    side * 0.25 + self.reach[1] * out * side + off[1],
                    -0.4 + self.reach[2] * out + self.lift * scale * (6.0 * t).sin() + off[2],
                ]
            })
            .collect()
    }
}
