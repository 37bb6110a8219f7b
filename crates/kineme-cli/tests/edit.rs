//! Changing a vocabulary.

mod common;

use std::fs;

use common::{done, json, kineme, names, vocabularies, vocabulary};
use kineme::{Primitive, Vocabulary};

#[test]
fn editing_changes_what_was_named_and_nothing_else() {
    let folder = vocabularies();
    let at = folder.path();
    let before = vocabulary(at, "punching.kineme");
    let edited = |line: &str, out: &str| {
        done(at, &format!("edit punching.kineme -o {out} {line}"));
        vocabulary(at, out)
    };
    // Names change places; everything else stays.
    let renamed = edited(
        "--rename punch-out=punch-return --rename punch-return=punch-out",
        "1.kineme",
    );
    assert_eq!(names(&renamed), ["punch-return", "punch-out"]);
    for (a, b) in before.primitives().iter().zip(renamed.primitives()) {
        assert_eq!(a.fitted(), b.fitted());
        assert_eq!(a.exemplars(), b.exemplars());
    }
    let behaviors: Vec<&str> = renamed
        .behaviors()
        .iter()
        .map(|b| b.name.as_str())
        .collect();
    assert_eq!(behaviors, ["punch-return", "punch-out"]);
    let removed = edited("--remove punch-out", "2.kineme");
    assert_eq!(removed.primitives(), &before.primitives()[1..]);
    assert_eq!(removed.behaviors(), &before.behaviors()[1..]);
    // The order is rename, merge, remove, whatever the line says.
    let merged = edited(
        "--merge out,punch-return=punch --rename punch-out=out",
        "3.kineme",
    );
    assert_eq!(names(&merged), ["punch"]);
    let punch = &merged.primitives()[0];
    assert_eq!(punch.exemplars().len(), 18);
    let axes: Vec<&str> = punch
        .parameters()
        .axes()
        .iter()
        .map(|a| a.name.as_str())
        .collect();
    assert_eq!(axes, ["height", "side"], "adverbs keep their names");

    // Exemplars are added to one primitive, and to a new one, once.
    done(at, "choreograph punching.toml --motions m");
    let rows = "file,label,p1,p2\npunch-out-01.bvh,punch-out,0.1,0.1\npunch-out-02.bvh,jab,0,0.5\npunch-out-09.bvh,jab,1,1\n";
    fs::write(at.join("m/add.csv"), rows).expect("a manifest");
    let added = edited("--add m/add.csv", "4.kineme");
    assert_eq!(names(&added), ["punch-out", "punch-return", "jab"]);
    assert_eq!(added.primitives()[0].exemplars().len(), 10);
    assert_eq!(
        added.primitives()[0].exemplars()[..9],
        *before.primitives()[0].exemplars()
    );
    assert_eq!(added.primitives()[1], before.primitives()[1], "bit for bit");
    assert_eq!(added.transitions().n, 3);
    let run = done(at, "edit 4.kineme -o 5.kineme --add m/add.csv");
    assert!(
        run.err
            .contains("3 of the motions to add are exemplars already"),
        "{}",
        run.err
    );
    let bytes = |name: &str| fs::read(at.join(name)).expect("a file");
    assert_eq!(bytes("4.kineme"), bytes("5.kineme"));
    fs::write(
        at.join("m/few.csv"),
        "file,label,p1\npunch-out-01.bvh,punch-out,0.1\n",
    )
    .expect("a manifest");
    let run = kineme(
        at,
        &[
            "edit",
            "punching.kineme",
            "-o",
            "6.kineme",
            "--add",
            "m/few.csv",
        ],
    );
    assert_eq!(run.code, 3);
    assert!(
        run.err
            .contains("m/few.csv:2: found 1 parameters of `punch-out`, expected 2 (height, side)"),
        "{}",
        run.err
    );
}

#[test]
fn behaviors_and_transitions_follow_an_edit() {
    let folder = common::folder();
    let at = folder.path();
    done(at, "derive arms.bvh -o v.kineme");
    let before = vocabulary(at, "v.kineme");
    let all = names(&before);
    assert!(all.len() >= 3, "{all:?}");
    let counts = |v: &Vocabulary| v.transitions().counts.iter().sum::<u32>();
    let (a, b, c) = (all[0], all[1], all[2]);
    done(
        at,
        &format!("edit v.kineme -o merged.kineme --merge {a},{b}=both"),
    );
    let merged = vocabulary(at, "merged.kineme");
    assert_eq!(merged.primitives().len(), all.len() - 1);
    assert_eq!(counts(&merged), counts(&before), "no succession is lost");
    let within: u32 = [(0, 0), (0, 1), (1, 0), (1, 1)]
        .iter()
        .map(|&(f, t)| before.transitions().count(f, t))
        .sum();
    assert_eq!(merged.transitions().count(0, 0), within);
    let members = |p: &Primitive| p.group().map_or(0, |g| g.members);
    let both = merged.primitive("both").expect("merged");
    assert_eq!(
        members(both),
        members(&before.primitives()[0]) + members(&before.primitives()[1])
    );
    for v in [&before, &merged] {
        for name in names(v) {
            let of = v
                .behaviors()
                .iter()
                .filter(|b| b.primitives.iter().any(|p| p == name));
            assert_eq!(of.count(), 1, "{name}");
        }
    }
    done(at, &format!("edit v.kineme -o removed.kineme --remove {c}"));
    let removed = vocabulary(at, "removed.kineme");
    assert_eq!(
        removed.transitions().count(0, 1),
        before.transitions().count(0, 1)
    );
    let gone = |name: &String| name == c;
    assert!(
        !removed
            .behaviors()
            .iter()
            .flat_map(|b| &b.primitives)
            .any(gone)
    );
}

#[test]
fn recognition_is_calibrated_and_stays_so() {
    let folder = vocabularies();
    let at = folder.path();
    let before = vocabulary(at, "punching.kineme");
    let recognisers: Vec<&str> = before
        .calibrations()
        .iter()
        .map(|c| c.recogniser.as_str())
        .collect();
    assert_eq!(recognisers, ["encoder", "filter"]);
    // What an edit leaves, and where it was before.
    let cases = [
        ("--rename punch-out=jab", vec![0, 1]),
        (
            "--rename punch-out=punch-return --rename punch-return=punch-out",
            vec![0, 1],
        ),
        ("--remove punch-out", vec![1]),
    ];
    for (line, places) in cases {
        done(
            at,
            &format!("edit punching.kineme -o e.kineme --force {line}"),
        );
        let edited = vocabulary(at, "e.kineme");
        for (now, then) in edited.calibrations().iter().zip(before.calibrations()) {
            let kept: Vec<_> = places.iter().map(|&i| then.primitives[i].clone()).collect();
            assert_eq!(now.primitives, kept, "{line}");
            assert_eq!(now.shared == then.shared, places.len() == 2, "{line}");
        }
        assert_eq!(edited.calibrations().len(), 2, "{line}");
    }
    // A vocabulary without is told from one with, and becomes one by an edit.
    let bare = Vocabulary::new(
        before.body().clone(),
        before.primitives().to_vec(),
        before.behaviors().to_vec(),
        before.transitions().clone(),
    );
    let bytes = kineme_formats::vocabulary::write(&bare.expect("a vocabulary"), "bare.kineme");
    fs::write(at.join("bare.kineme"), bytes.expect("a file")).expect("a file");
    done(
        at,
        "edit bare.kineme -o again.kineme --rename punch-out=jab",
    );
    for (name, told, listed) in [
        ("bare.kineme", "recognition: not calibrated", vec![]),
        (
            "again.kineme",
            "recognition: calibrated for encoder and filter\n",
            recognisers,
        ),
    ] {
        assert!(
            done(at, &format!("show {name}")).out.contains(told),
            "{name}"
        );
        let shown = json(at, &format!("show {name} --json"));
        assert_eq!(
            shown["calibrated"],
            serde_json::Value::from(listed),
            "{name}"
        );
    }
    assert_eq!(
        vocabulary(at, "again.kineme").calibrations(),
        before.calibrations()
    );
}
