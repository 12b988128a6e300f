//! The library as it is installed, and programs that are linked with it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use voltet_testing::compilers;

/// A folder with the libraries, for one test.
pub struct Installed {
    folder: tempfile::TempDir,
}

impl Installed {
    pub fn new() -> Installed {
        let folder = tempfile::tempdir().unwrap();
        // Tests stand beside the libraries that were built for them.
        let built = std::env::current_exe().unwrap().parent().unwrap().to_path_buf();
        for (from, to) in [
            ("libvoltet_c.so", "libvoltet.so.0"),
            ("libvoltet_c.so", "libvoltet.so"),
            ("libvoltet_c.a", "libvoltet.a"),
        ] {
            std::os::unix::fs::symlink(built.join(from), folder.path().join(to)).unwrap();
        }
        // And as cargo leaves them.
        let release = folder.path().join("built");
        std::fs::create_dir(&release).unwrap();
        for name in ["libvoltet_c.so", "libvoltet_c.a"] {
            std::os::unix::fs::symlink(built.join(name), release.join(name)).unwrap();
        }
        Installed { folder }
    }

    /// A program of these sources, by their paths in the repository, linked with the shared library; `None` without a compiler.
    #[track_caller]
    pub fn program(&self, sources: &[&str]) -> Option<PathBuf> {
        let folder = self.folder.path().to_str().unwrap();
        let options = [&format!("-L{folder}"), "-lvoltet", "-lpthread", &format!("-Wl,-rpath,{folder}")];
        self.linked(sources, &options)
    }

    /// Links the sources with the static library.
    #[track_caller]
    pub fn static_program(&self, sources: &[&str]) -> Option<PathBuf> {
        let archive = self.path("libvoltet.a");
        let mut options = vec![archive.to_str().unwrap()];
        let package = include_str!("../../voltet.pc.in");
        let needed = package.lines().find_map(|line| line.strip_prefix("Libs.private:")).unwrap();
        options.extend(needed.split_whitespace());
        self.linked(sources, &options)
    }

    #[track_caller]
    fn linked(&self, sources: &[&str], options: &[&str]) -> Option<PathBuf> {
        let sources: Vec<PathBuf> = sources.iter().map(|path| compilers::source(path)).collect();
        compilers::program(self.folder.path(), "program", &sources, options)
    }

    /// A file of this folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

/// Runs a program; its engine is the CPU's, in whose lanes the expected picture is drawn, too.
pub fn run(program: &Path, words: &[&Path]) -> Output {
    Command::new(program).args(words).output().unwrap()
}

/// Runs a program that must succeed.
#[track_caller]
pub fn succeed(program: &Path, words: &[&Path]) -> String {
    let output = run(program, words);
    let [said, warned] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{}: {said}{warned}", output.status);
    said
}
