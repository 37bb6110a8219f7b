//! One page over HTTP, to this machine alone.

use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use crate::failure::{Failure, complain, print};

/// How long a browser may take to say what it wants.
const PATIENCE: Duration = Duration::from_secs(5);
/// Bytes of a request that are read.
const MOST_ASKED: u64 = 16 << 10;

/// Serves the page until the program is ended.
pub fn serve(html: &str, port: u16, open: bool) -> Result<(), Failure> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|e| {
        Failure::failed(format!("port {port}: {e}")).hint("--port takes another one")
    })?;
    let port = listener.local_addr().map_or(port, |a| a.port());
    let address = format!("http://127.0.0.1:{port}/");
    print(format!("to look at: {address}\nCtrl-C ends it\n").as_bytes())?;
    if open && !opened(&address) {
        complain("no browser could be opened: open the address yourself");
    }
    let html: Arc<str> = html.into();
    for stream in listener.incoming().flatten() {
        let html = Arc::clone(&html);
        // Browsers open connections that they may need later: one must not wait for another. Nor is one that hangs up
        // a reason to stop.
        std::thread::spawn(move || {
            let _ = answer(stream, &html, port);
        });
    }
    Ok(())
}

/// Answers one request. Whoever asks by another host's name is a page of somebody else's, and gets nothing.
fn answer(mut stream: TcpStream, html: &str, port: u16) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut asked = BufReader::new((&stream).take(MOST_ASKED));
    let mut line = String::new();
    asked.read_line(&mut line)?;
    let mut host = None;
    loop {
        let mut header = String::new();
        if asked.read_line(&mut header)? == 0 || header.trim().is_empty() {
            break;
        }
        if let Some((name, value)) = header.split_once(':')
            && name.eq_ignore_ascii_case("host")
        {
            host = Some(value.trim().to_owned());
        }
    }
    drop(asked);
    let ours = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let (status, kind, body) = match line.split_whitespace().collect::<Vec<_>>().as_slice() {
        _ if host.is_some_and(|h| !ours.contains(&h)) => ("403 Forbidden", "text/plain", ""),
        ["GET" | "HEAD", "/" | "/index.html", ..] => ("200 OK", "text/html; charset=utf-8", html),
        ["GET" | "HEAD", ..] => ("404 Not Found", "text/plain", ""),
        _ => ("405 Method Not Allowed", "text/plain", ""),
    };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    if !line.starts_with("HEAD") {
        stream.write_all(body.as_bytes())?;
    }
    match stream.flush() {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done,
    }
}

/// Opens the system's browser.
fn opened(address: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let started = Command::new(program)
        .args(arguments)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    started.is_ok()
}
