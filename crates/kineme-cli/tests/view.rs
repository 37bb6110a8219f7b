//! `kineme view`: a page of motions, of a vocabulary, of a result; to a file, to a browser on this machine.

mod common;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Command, Stdio};

use common::{folder, kineme};

#[test]
fn motions_become_one_page() {
    let folder = folder();
    let view = ["view", "arms.bvh", "points.csv", "-o", "page.html"];
    let run = kineme(folder.path(), &view);
    assert_eq!(run.code, 0, "{}", run.err);
    let page = std::fs::read_to_string(folder.path().join("page.html")).expect("a page");
    for text in ["2 motions", "arms.bvh", "points.csv", "<table>"] {
        assert!(page.contains(text), "{text}");
    }
    let again = kineme(folder.path(), &view);
    assert_eq!(again.code, 2, "kept");
    let forced = kineme(folder.path(), &[view.as_slice(), &["--force"]].concat());
    assert_eq!(forced.code, 0, "{}", forced.err);
    let same = std::fs::read_to_string(folder.path().join("page.html")).expect("a page");
    assert!(page == same, "the same bytes");
}

#[test]
fn a_result_is_shown_as_it_is() {
    let folder = folder();
    let result = folder.path().join("result");
    std::fs::create_dir(&result).expect("a folder");
    std::fs::write(result.join("report.html"), "a page").expect("a file");
    let run = kineme(folder.path(), &["view", "result", "-o", "-"]);
    assert_eq!((run.code, run.out.as_str()), (0, "a page"));
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let folder = folder();
    std::fs::write(folder.path().join("moves.kineme"), "no vocabulary").expect("a file");
    for (arguments, code, told) in [
        (vec!["view", "moves.kineme", "-o", "-"], 3, "moves.kineme"),
        (
            vec!["view", "arms.bvh", "moves.kineme", "-o", "-"],
            2,
            "is a vocabulary",
        ),
        (vec!["view", "nothing.bvh", "-o", "-"], 3, "nothing.bvh"),
        (
            vec!["view", "arms.bvh", "-o", "-", "--port", "80"],
            2,
            "--port",
        ),
    ] {
        let run = kineme(folder.path(), &arguments);
        assert_eq!(run.code, code, "{arguments:?}: {}", run.err);
        assert!(run.err.contains(told), "{arguments:?}: {}", run.err);
    }
}

#[test]
fn the_page_is_served_to_this_machine_alone() {
    let folder = folder();
    let mut server = Command::new(env!("CARGO_BIN_EXE_kineme"))
        .args(["view", "arms.bvh", "--no-open"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary");
    let mut told = String::new();
    let out = server.stdout.take().expect("stdout");
    BufReader::new(out).read_line(&mut told).expect("a line");
    let (_, address) = told.split_once("http://").expect("an address");
    let address = address.trim().trim_end_matches('/');
    let ask = |line: &str, host: &str| {
        let mut stream = TcpStream::connect(address).expect("a connection");
        write!(stream, "{line} HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("asked");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        answer
    };
    let answers = [
        ask("GET /", address),
        ask("GET /etc/passwd", address),
        ask("GET /", "somewhere.example"),
        ask("POST /", address),
        ask("HEAD /", address),
    ];
    server.kill().expect("ended");
    server.wait().expect("ended");
    for (answer, status) in answers.iter().zip(["200", "404", "403", "405", "200"]) {
        assert_eq!(answer.split(' ').nth(1), Some(status), "{answer}");
    }
    assert!(address.starts_with("127.0.0.1:"), "{address}");
    assert!(answers[0].contains("<!doctype html>") && !answers[4].contains("<!doctype html>"));
    assert!(!answers[2].contains("<!doctype html>"));
}
