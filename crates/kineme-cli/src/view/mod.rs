//! `kineme view`: a page of motions, of a vocabulary or of a result, in the browser.

mod contents;
mod serve;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use kineme_formats::output;
use kineme_paper::figures::PAGE;

use crate::args::{Global, ViewArgs};
use crate::failure::{Failure, print};
use crate::outputs::{existing, unwritten};
use crate::vocabularies;

pub fn run(args: &ViewArgs, global: &Global) -> Result<u8, Failure> {
    if let Some(out) = &args.out {
        vocabularies::check_out(out, "page", global)?;
    }
    let (html, code) = page(args)?;
    match &args.out {
        Some(out) if out.as_os_str() == "-" => print(html.as_bytes())?,
        Some(out) => {
            output::write_bytes(out, existing(global), html.as_bytes()).map_err(unwritten)?;
            let shown = out.display().to_string();
            let told = match global.json {
                true => crate::json::line(&serde_json::json!({ "written": shown }))?,
                false => format!("written: {shown}\n"),
            };
            print(told.as_bytes())?;
        }
        None => serve::serve(&html, args.port, !args.no_open)?,
    }
    Ok(code)
}

/// The page, and the exit code: 3 where inputs were skipped.
fn page(args: &ViewArgs) -> Result<(String, u8), Failure> {
    if let [one] = args.inputs.as_slice() {
        let result = one.join(PAGE);
        if result.is_file() {
            let read = std::fs::read_to_string(&result);
            let html =
                read.map_err(|e| Failure::unreadable(format!("{}: {e}", result.display())))?;
            return Ok((html, 0));
        }
        if is_vocabulary(one) {
            let vocabulary = vocabularies::read(one)?;
            let page = contents::of_vocabulary(&vocabulary, &one.display().to_string())?;
            return Ok((page.html(), 0));
        }
    } else if let Some(vocabulary) = args.inputs.iter().find(|p| is_vocabulary(p)) {
        let message = format!("{} is a vocabulary", vocabulary.display());
        return Err(
            Failure::usage(message).hint("look at one vocabulary at a time, without other inputs")
        );
    }
    let (page, code) = contents::of_motions(args)?;
    Ok((page.html(), code))
}

/// Whether a file is named as a vocabulary, or begins as its container does: the length of a header, then the header.
fn is_vocabulary(path: &Path) -> bool {
    if path.extension().is_some_and(|e| e == "kineme") {
        return true;
    }
    let mut head = [0; 9];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut head));
    read.is_ok() && head[4..8] == [0; 4] && head[8] == b'{'
}
