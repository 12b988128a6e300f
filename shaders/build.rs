//! Lists the pieces: every file under `wgsl/`, so that a new one need not be named anywhere.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let root = Path::new("wgsl");
    println!("cargo::rerun-if-changed={}", root.display());
    let mut files = Vec::new();
    find(root, &mut files)?;
    let mut names: Vec<String> = files.iter().filter_map(|file| name(root, file)).collect();
    names.sort();
    let mut text = String::from("&[\n");
    for name in names {
        let path = env::current_dir()?.join(root).join(format!("{name}.wgsl"));
        let file = format!("shaders/wgsl/{name}.wgsl");
        // Writing to a string cannot fail.
        let _ =
            writeln!(text, "WgslPiece {{ name: {name:?}, file: {file:?}, text: include_str!({path:?}) }},");
    }
    text.push(']');
    let out = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("cargo names no OUT_DIR"))?;
    fs::write(Path::new(&out).join("pieces.rs"), text)
}

fn find(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            find(&path, files)?;
        } else if path.extension().is_some_and(|ending| ending == "wgsl") {
            files.push(path);
        }
    }
    Ok(())
}

/// The path under the folder without its ending, with slashes.
fn name(root: &Path, file: &Path) -> Option<String> {
    let inside = file.strip_prefix(root).ok()?.with_extension("");
    Some(inside.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/"))
}
