//! INPUT as a list of motions, and output that is complete or absent.

use std::fs;
use std::io::Write;
use std::path::Path;

use kineme_formats::input::{InputRates, Inputs, ReadOptions};
use kineme_formats::output::{self, Existing};
use rayon::prelude::*;
use zip::write::SimpleFileOptions;

const BVH: &str = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 1 0\n";
const ASF: &str = ":units\nlength 1\n:bonedata\nbegin\nname b\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\ndof rx\nend\n:hierarchy\nbegin\nroot b\nend\n";
const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\nb 5\n";
const TABLE: &str = "frame,a_x,a_y,a_z\n0,1,2,3\n";

fn file(folder: &Path, name: &str, content: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
    fs::write(path, content).expect("a file");
}

fn archive(path: &Path, files: &[(&str, &[u8])]) {
    let mut zip = zip::ZipWriter::new(fs::File::create(path).expect("an archive"));
    for (name, content) in files {
        zip.start_file(*name, SimpleFileOptions::default())
            .expect("an entry");
        zip.write_all(content).expect("content");
    }
    zip.finish().expect("an archive");
}

/// A folder with a little of everything.
fn corpus() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    file(root, "b/walk.BVH", BVH);
    file(root, "b/notes.md", "no motion");
    file(root, "b/.hidden.bvh", "no motion either");
    file(root, "a.txt", BVH);
    file(root, "amc/02.asf", ASF);
    file(root, "amc/02_01.amc", AMC);
    file(root, "amc/03.asf", "broken");
    file(root, "labels.csv", "file,label\na,b\n");
    file(root, "table.csv", TABLE);
    archive(
        &root.join("set.zip"),
        &[
            ("set/z.bvh", BVH.as_bytes()),
            ("set/13/x.amc", AMC.as_bytes()),
            ("set/13/only.ASF", ASF.as_bytes()),
            ("set/lost/y.amc", AMC.as_bytes()),
            ("set/readme.txt", b"words"),
            ("__MACOSX/set/._z.bvh", b"\0\0"),
        ],
    );
    folder
}

fn names(inputs: &Inputs, root: &Path) -> Vec<String> {
    let root = format!("{}/", root.display());
    inputs
        .entries
        .iter()
        .map(|e| e.name().strip_prefix(&root).unwrap_or(e.name()).to_owned())
        .collect()
}

fn resolve(paths: &[&Path], options: &ReadOptions) -> Inputs {
    Inputs::resolve(paths, options).expect("inputs")
}

#[test]
fn folders_and_archives_are_walked_in_order() {
    let folder = corpus();
    let root = folder.path();
    let inputs = resolve(&[root], &ReadOptions::default());
    assert_eq!(
        names(&inputs, root),
        [
            "a.txt",
            "amc/02_01.amc",
            "b/walk.BVH",
            "set.zip/set/13/x.amc",
            "set.zip/set/lost/y.amc",
            "set.zip/set/z.bvh",
            "table.csv",
        ]
    );
    // notes.md, labels.csv, set/readme.txt
    assert_eq!(inputs.ignored, 3);
    assert_eq!(inputs.warnings.len(), 2, "{:?}", inputs.warnings);
    assert!(inputs.warnings[0].contains("amc") && inputs.warnings[0].contains("120"));
    assert!(inputs.warnings[1].contains("positions") && inputs.warnings[1].contains("30"));
    let read: Vec<_> = inputs.entries.par_iter().map(|e| e.read()).collect();
    for (entry, read) in inputs.entries.iter().zip(&read) {
        let name = entry.name();
        match name.rsplit('/').next().expect("a name") {
            "y.amc" => assert!(read.as_ref().expect_err(name).found.contains("no ASF")),
            "table.csv" => {}
            _ => assert_eq!(read.as_ref().expect(name).name(), name),
        }
    }
}

#[test]
fn a_path_leads_into_an_archive() {
    let folder = corpus();
    let root = folder.path();
    let check = |path: &str, expected: &[&str]| {
        let inputs = resolve(&[&root.join(path)], &ReadOptions::default());
        assert_eq!(names(&inputs, root), expected, "{path}");
        inputs
    };
    check("set.zip/set/z.bvh", &["set.zip/set/z.bvh"]).entries[0]
        .read()
        .expect("a motion");
    check("set.zip/set/13", &["set.zip/set/13/x.amc"]).entries[0]
        .read()
        .expect("its ASF is there");
    // Neither a part of a name nor a file that is not there; the entry tells.
    for absent in [
        "set.zip/set/1",
        "set.zip/none.bvh",
        "none.bvh",
        "b/notes.md",
    ] {
        let error = check(absent, &[absent]).entries[0]
            .read()
            .expect_err(absent);
        assert!(error.file.ends_with(absent), "{error}");
    }
    assert!(
        check("amc/03.asf", &["amc/03.asf"]).entries[0]
            .read()
            .is_err()
    );
}

#[test]
fn a_given_skeleton_serves_those_that_find_none() {
    let folder = corpus();
    let root = folder.path();
    for given in ["amc/02.asf", "set.zip/set/13/only.ASF"] {
        let options = ReadOptions {
            asf: Some(root.join(given)),
            ..ReadOptions::default()
        };
        let inputs = resolve(&[&root.join("set.zip/set/lost")], &options);
        inputs.entries[0].read().expect("the given skeleton");
    }
    let options = ReadOptions {
        asf: Some(root.join("none.asf")),
        ..ReadOptions::default()
    };
    assert!(Inputs::resolve(&[root], &options).is_err());
}

#[test]
fn rates_are_given_for_all_or_by_format() {
    let folder = corpus();
    let amc = folder.path().join("amc/02_01.amc");
    let check = |rates: &str, expected: f64, warnings: usize| {
        let rates = rates.parse().expect("rates");
        let inputs = resolve(&[&amc], &ReadOptions { asf: None, rates });
        assert_eq!(
            inputs.entries[0].read().expect("a motion").rate_hz(),
            expected
        );
        assert_eq!(inputs.warnings.len(), warnings);
    };
    check("60", 60.0, 0);
    check("msr=20, AMC=100", 100.0, 0);
    check("50,amc=100", 100.0, 0);
    check("positions=25", 120.0, 1);
    for wrong in ["", "fast", "0", "-1", "inf", "bvh=60", "amc=", "amc=60=2"] {
        assert!(wrong.parse::<InputRates>().is_err(), "{wrong:?}");
    }
    // A file with its own time base keeps it.
    let bvh = folder.path().join("a.txt");
    let rates = "60".parse().expect("rates");
    let inputs = resolve(&[&bvh], &ReadOptions { asf: None, rates });
    assert_eq!(inputs.entries[0].read().expect("a motion").rate_hz(), 10.0);
}

#[test]
fn damaged_archives_and_bombs_are_errors_of_entries() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    fs::write(root.join("cut.zip"), b"PK\x03\x04 and no more").expect("a file");
    let bomb = vec![b' '; 64 << 20];
    archive(
        &root.join("bomb.zip"),
        &[("a.bvh", &bomb), ("b.bvh", BVH.as_bytes())],
    );
    archive(&root.join("empty.zip"), &[("readme.txt", b"words")]);
    let inputs = resolve(&[root], &ReadOptions::default());
    assert_eq!(
        names(&inputs, root),
        ["bomb.zip/a.bvh", "bomb.zip/b.bvh", "cut.zip"]
    );
    let error = inputs.entries[0].read().expect_err("a bomb");
    assert!(error.found.contains("unpacks to more than"), "{error}");
    inputs.entries[1].read().expect("its neighbour");
    let error = inputs.entries[2].read().expect_err("a cut archive");
    assert!(error.expected.contains("zip archive"), "{error}");
    let inputs = resolve(&[&root.join("empty.zip")], &ReadOptions::default());
    assert!(
        inputs.entries[0]
            .read()
            .expect_err("nothing")
            .found
            .contains("no motion")
    );
}

#[cfg(unix)]
#[test]
fn links_that_lead_back_end() {
    let folder = tempfile::tempdir().expect("a folder");
    file(folder.path(), "in/a.bvh", BVH);
    std::os::unix::fs::symlink(folder.path(), folder.path().join("in/back")).expect("a link");
    let inputs = resolve(&[folder.path()], &ReadOptions::default());
    assert_eq!(names(&inputs, folder.path()), ["in/a.bvh"]);
}

#[test]
fn output_is_complete_or_absent() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("new/out.csv");
    let text = |content: &'static str| {
        move |out: &mut dyn Write| {
            out.write_all(content.as_bytes()).expect("a buffer");
            Ok(())
        }
    };
    output::write(&path, Existing::Keep, text("one")).expect("a new file");
    let error = output::write(&path, Existing::Keep, text("two")).expect_err("it is there");
    assert_eq!(error.found, "an existing file");
    assert_eq!(fs::read_to_string(&path).expect("the first"), "one");
    output::write(&path, Existing::Replace, text("two")).expect("force");
    assert_eq!(fs::read_to_string(&path).expect("the second"), "two");
    let failing = |out: &mut dyn Write| {
        out.write_all(b"half").expect("a buffer");
        Err(kineme_formats::FormatError::new(
            "x",
            kineme_formats::Place::File,
            "a",
            "b",
        ))
    };
    output::write(&path, Existing::Replace, failing).expect_err("the content failed");
    assert_eq!(fs::read_to_string(&path).expect("still the second"), "two");
    assert_eq!(
        fs::read_dir(path.parent().expect("a folder"))
            .expect("a folder")
            .count(),
        1
    );
    assert!(output::write(folder.path(), Existing::Replace, text("x")).is_err());
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |p: &Path| fs::metadata(p).expect("a file").permissions().mode();
        let usual = folder.path().join("usual");
        fs::write(&usual, "").expect("a file");
        assert_eq!(mode(&path), mode(&usual));
    }
}

#[test]
#[cfg(unix)]
fn links_stay_links_and_devices_devices() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::write(at("real"), "old").expect("a file");
    symlink("real", at("link")).expect("a link");
    output::write_bytes(&at("link"), Existing::Keep, b"new").expect_err("it is there");
    output::write_bytes(&at("link"), Existing::Replace, b"new").expect("force");
    assert!(at("link").is_symlink());
    assert_eq!(fs::read_to_string(at("real")).expect("the file"), "new");
    symlink("nowhere", at("dangling")).expect("a link");
    output::write_bytes(&at("dangling"), Existing::Replace, b"new").expect_err("no target");
    // What is reached by a link of our own is at no risk, should it be replaced.
    symlink("/dev/null", at("null")).expect("a link");
    for existing in [Existing::Keep, Existing::Replace] {
        output::write_bytes(&at("null"), existing, b"gone").expect("a device takes all");
        assert!(at("null").is_symlink());
    }
    let device = fs::metadata("/dev/null").expect("a device").file_type();
    assert!(device.is_char_device());
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 4);
}

#[test]
fn a_motion_is_read_with_the_hash_of_its_file() {
    let folder = corpus();
    let path = folder.path().join("set.zip/set/z.bvh");
    let inputs = Inputs::resolve(&[path], &ReadOptions::default()).expect("inputs");
    let (recording, hash) = inputs.entries[0].read_hashed().expect("a motion");
    assert_eq!(recording, inputs.entries[0].read().expect("a motion"));
    assert_eq!(hash, blake3::hash(BVH.as_bytes()).to_hex().as_str());
}
