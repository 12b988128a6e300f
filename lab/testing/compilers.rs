//! Plug-ins and programs in other languages, compiled for a test.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex, OnceLock};

/// The repository's folder.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// A file of the repository.
pub fn source(path: &str) -> PathBuf {
    Path::new(ROOT).join(path)
}

/// Sources of a library: the options, and the sources with their texts, as a test may change one.
type CompiledLibrary = (Vec<String>, Vec<(PathBuf, String)>);

/// Its bytes, once it is compiled; `None` where there is no compiler.
type Library = OnceLock<Option<Vec<u8>>>;

static LIBRARIES: Mutex<Option<HashMap<CompiledLibrary, Arc<Library>>>> = Mutex::new(None);

/// The shared library `name` in `folder`, made of these sources by the compiler of the first one's language (`.c`: `cc`, `.cpp`:
/// `c++`, `.f90`, `.F90`: `gfortran`), without a warning; compiled once for all tests of a program. `None` where there is no such compiler,
/// said loudly; a failure if the environment variable `VOLTET_REQUIRE_COMPILERS` is 1.
#[track_caller]
pub fn library(folder: &Path, name: &str, sources: &[PathBuf], options: &[&str]) -> Option<PathBuf> {
    let path = folder.join(name);
    let texts = sources.iter().map(|source| (source.clone(), std::fs::read_to_string(source).unwrap()));
    let made = (options.iter().map(|option| option.to_string()).collect(), texts.collect());
    let library = {
        let mut libraries = LIBRARIES.lock().unwrap();
        Arc::clone(libraries.get_or_insert_default().entry(made).or_default())
    };
    let options: Vec<&str> = ["-shared", "-fPIC", "-O2"].iter().chain(options).copied().collect();
    let compile = || compiled(folder, &path, sources, &options).then(|| std::fs::read(&path).unwrap());
    let bytes = library.get_or_init(compile).as_ref()?;
    // Another file of this name may be loaded: it stays whole.
    let _ = std::fs::remove_file(&path);
    std::fs::write(&path, bytes).unwrap();
    Some(path)
}

/// Compiles a program; like [`library`].
#[track_caller]
pub fn program(folder: &Path, name: &str, sources: &[PathBuf], options: &[&str]) -> Option<PathBuf> {
    let path = folder.join(name);
    compiled(folder, &path, sources, options).then_some(path)
}

/// The WebAssembly module `path`, made of a C source as docs/src/how-to/plugins.md says, by `clang` and what belongs to it (`wasm-ld`,
/// `wasi-libc`). `None` where these are not there, said loudly.
pub fn module(source_file: &Path, path: &Path) -> Option<()> {
    let mut command = Command::new("clang");
    command.args(["--target=wasm32-wasi", "-O2", "-nostartfiles", "-nodefaultlibs", "-Wl,--no-entry"]);
    command.args(["-Wl,--export=voltet_plugin_entry", "-Wl,--export-table", "-Wl,--growable-table"]);
    command.arg("-I").arg(source("include")).arg("-o").arg(path).arg(source_file).args(["-lc", "-lm"]);
    let why = match command.output() {
        Ok(output) if output.status.success() => return Some(()),
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => error.to_string(),
    };
    eprintln!("\n*** SKIPPED: there is no clang that compiles for WebAssembly ({}) ***\n", why.trim());
    None
}

#[track_caller]
fn compiled(folder: &Path, path: &Path, sources: &[PathBuf], options: &[&str]) -> bool {
    let ending = sources[0].extension().and_then(|ending| ending.to_str());
    let (compiler, standard): (&str, &[&str]) = match ending {
        Some("c") => ("cc", &["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]),
        Some("cpp") => ("c++", &["-std=c++17", "-pedantic", "-Wall", "-Wextra", "-Werror"]),
        Some("f90" | "F90") => ("gfortran", &["-Wall", "-Wextra", "-Werror"]),
        other => panic!("no compiler for {other:?}"),
    };
    let mut command = Command::new(compiler);
    // Fortran writes what its modules export beside it.
    command.current_dir(folder).args(standard).arg("-I").arg(source("include"));
    command.arg("-o").arg(path).args(sources).args(options).arg("-lm");
    match command.output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{command:?}: {said}");
            true
        }
        Err(error) => {
            let required = std::env::var("VOLTET_REQUIRE_COMPILERS").is_ok_and(|value| value == "1");
            assert!(!required, "VOLTET_REQUIRE_COMPILERS is 1, but there is no {compiler}: {error}");
            eprintln!("\n*** SKIPPED: there is no {compiler} ({error}) ***\n");
            false
        }
    }
}
