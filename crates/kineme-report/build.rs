//! Puts the built viewer into the library where `cargo xtask viewer` has made it; without it everything builds, too.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let built = here.join("../../viewer/dist");
    // The folder, not the files in it: what is not there would count as changed in every build.
    println!("cargo::rerun-if-changed={}", built.display());
    let mut code = String::new();
    for (name, file) in [("SCRIPT", "viewer.js"), ("STYLE", "viewer.css")] {
        let text = included(&built.join(file))?;
        code.push_str(&format!(
            "/// The built viewer's `{file}`.\nconst {name}: Option<&str> = {text};\n"
        ));
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    fs::write(out.join("viewer.rs"), code)
}

/// The expression of a file's text.
fn included(file: &Path) -> io::Result<String> {
    if !file.is_file() {
        return Ok("None".into());
    }
    // Its own dependency line: a file written anew does not change its folder.
    println!("cargo::rerun-if-changed={}", file.display());
    let path = file.canonicalize()?;
    Ok(format!(
        "Some(include_str!({:?}))",
        path.display().to_string()
    ))
}
