//! Builds, tests and photographs the page's program, `viewer/`: everything that wants node or a browser.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a command of node prints where node is not.
const NO_NODE: &str = "node and npm are not here (Debian: apt install nodejs npm)";

/// Builds the viewer and checks its types.
pub fn build(root: &Path) -> Result<(), String> {
    if !has("node") || !has("npm") {
        return Err(format!("{NO_NODE}: pages will have still pictures only"));
    }
    let folder = root.join("viewer");
    // Installed anew only where the lock has changed since: `npm ci` always removes everything first.
    if !is_installed(&folder) {
        run(
            &folder,
            "npm",
            &["ci", "--ignore-scripts", "--no-audit", "--no-fund"],
        )?;
    }
    run(&folder, "npm", &["run", "--silent", "check"])?;
    run(&folder, "npm", &["run", "--silent", "build"])
}

/// The page of made-up movement in a real browser, every check on it; says why where there is no browser.
pub fn test(root: &Path) -> Result<(), String> {
    if !has("node") {
        println!("SKIPPED: {NO_NODE}");
        return Ok(());
    }
    let page = root.join("target/viewer/page.html");
    write_page(root, &page)?;
    let folder = root.join("viewer");
    let page = page.display().to_string();
    run(&folder, "node", &["test/rows.mjs"])?;
    run(&folder, "node", &["test/data.mjs"])?;
    run(&folder, "node", &["test/page.mjs", &page])
}

/// The small picture in the README, from the demo's page.
pub fn screenshot(root: &Path) -> Result<(), String> {
    let demo = root.join("target/viewer/demo");
    crate::commands::demo(root, &["--force", "-o", &demo.display().to_string()])?;
    let page = demo.join("report.html").display().to_string();
    let picture = root.join("docs/page.png").display().to_string();
    run(
        &root.join("viewer"),
        "node",
        &["test/screenshot.mjs", &page, &picture],
    )
}

fn write_page(root: &Path, page: &Path) -> Result<(), String> {
    let folder = page.parent().unwrap_or(root);
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let page = page.display().to_string();
    let example = [
        "run",
        "--quiet",
        "--package",
        "kineme-report",
        "--no-default-features",
        "--example",
        "page",
        "--",
    ];
    run(root, "cargo", &[example.as_slice(), &[&page]].concat())
}

fn is_installed(folder: &Path) -> bool {
    let changed = |path: PathBuf| path.metadata().and_then(|m| m.modified()).ok();
    let installed = changed(folder.join("node_modules/.package-lock.json"));
    installed.is_some() && installed >= changed(folder.join("package-lock.json"))
}

fn has(program: &str) -> bool {
    let mut probe = Command::new(program);
    let probe = probe
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    probe.status().is_ok_and(|status| status.success())
}

fn run(folder: &Path, program: &str, arguments: &[&str]) -> Result<(), String> {
    let line = format!("{program} {}", arguments.join(" "));
    match Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .status()
    {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!("{line}: failed")),
        Err(e) if e.kind() == ErrorKind::NotFound => Err(format!("{program} is not on PATH")),
        Err(e) => Err(format!("{line}: {e}")),
    }
}
