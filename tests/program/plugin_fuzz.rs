//! Plug-ins and their files damaged at random: no crash of the program, and no gradient that is wrong without a word.
//!
//! The environment variable `VOLTET_FUZZ` gives the number of cases in place of the small standard ones: 10000 take some minutes.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use voltet::core::Result;
use voltet::core::error::ErrorKind;
use voltet::core::field::Method;
use voltet::core::glam::DVec3;
use voltet::core::grid::{Grid, generate};
use voltet::core::progress::Progress;
use voltet_plugins::{Contents, PluginFile};
use voltet_testing::compilers;

const RIGHT: DVec3 = DVec3::new(2.0, 3.0, -1.0);

fn count(standard: u64) -> u64 {
    std::env::var("VOLTET_FUZZ").map_or(standard, |count| count.parse().unwrap())
}

fn source() -> PathBuf {
    compilers::source("tests/plugins/random.c")
}

fn grid() -> Grid {
    let grid = generate::box_of_tetrahedra([5, 4, 3], [DVec3::ZERO, DVec3::ONE], 0.2);
    generate::with_scalar(grid, "s", |p| p.dot(RIGHT))
}

/// Machine code that was damaged may go round for ever.
const PATIENCE: Duration = Duration::from_secs(5);

/// Stops the work then.
struct Until(Instant);

impl Progress for Until {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        Instant::now() > self.0
    }
}

/// Number of cases by outcome.
#[derive(Debug, Default)]
struct Tally {
    refused: u64,
    crashed: u64,
    failed: u64,
    /// It had not ended after [`PATIENCE`].
    stopped: u64,
    right: u64,
    wrong: u64,
}

/// Loads, and computes where that is possible.
fn tried(tally: &mut Tally, grid: &Grid, loaded: Result<Contents>, what: &str) {
    let filters = match loaded {
        Ok(contents) => contents.filters,
        Err(error) => {
            assert!(error.to_string().contains(what), "{what}: {error}");
            let crashed = error.to_string().contains("its process");
            *(if crashed { &mut tally.crashed } else { &mut tally.refused }) += 1;
            return;
        }
    };
    let scalar = grid.scalar.clone().unwrap();
    for filter in filters {
        // What a registry would refuse is refused there.
        let mut registry = voltet::nodes::registry().unwrap();
        let computed = registry
            .add_filter(filter.clone())
            .and_then(|()| Method::with_defaults(filter))
            .and_then(|method| method.gradient(grid, &scalar, &Until(Instant::now() + PATIENCE)));
        match computed {
            Ok(gradient) if gradient.vectors.iter().all(|v| *v == RIGHT) => tally.right += 1,
            Ok(_) => tally.wrong += 1,
            Err(error) if error.to_string().contains("signal") => tally.crashed += 1,
            Err(error) if error.kind == ErrorKind::Cancelled => tally.stopped += 1,
            Err(_) => tally.failed += 1,
        }
    }
}

/// A copy under the name of a seed, of which the library takes its damage; with that name in every message.
fn copy(folder: &Path, library: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::copy(library, &path).unwrap();
    path
}

#[test]
fn what_plugins_declare_and_give_at_random_is_refused_or_right() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["-D_GNU_SOURCE", "-ldl"];
    let Some(library) = compilers::library(folder.path(), "whole.so", &[source()], &options) else { return };
    let (mut tally, grid) = (Tally::default(), grid());
    // A library stays loaded, in five pieces, and a process has some 65,000 at most.
    for seed in 0..count(300).min(10_000) {
        let name = format!("random-{seed}.so");
        let path = copy(folder.path(), &library, &name);
        tried(&mut tally, &grid, voltet_plugins::load(&path), &name);
        std::fs::remove_file(path).unwrap();
    }
    eprintln!("in this process: {tally:?}");
    assert_eq!((tally.wrong, tally.crashed), (0, 0));
    assert!(tally.right > 0 && tally.refused > 0 && tally.failed > 0, "{tally:?}");
}

#[cfg(unix)]
#[test]
fn what_plugins_do_at_random_with_addresses_of_functions_stays_in_their_process() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["-D_GNU_SOURCE", "-ldl"];
    let Some(library) = compilers::library(folder.path(), "whole.so", &[source()], &options) else { return };
    let (mut tally, grid) = (Tally::default(), grid());
    for seed in 0..count(60) {
        let name = format!("wild-{seed}.so");
        let path = copy(folder.path(), &library, &name);
        let program = env!("CARGO_BIN_EXE_voltet").into();
        let apart = PluginFile::read(&path).and_then(|file| voltet_plugins::load_apart(&file, program));
        tried(&mut tally, &grid, apart, &name);
        std::fs::remove_file(path).unwrap();
    }
    eprintln!("in a process of its own: {tally:?}");
    assert_eq!(tally.wrong, 0);
    assert!(tally.right > 0 && tally.refused > 0 && tally.crashed > 0, "{tally:?}");
}

#[cfg(unix)]
#[test]
fn damaged_files_are_refused_or_stay_in_their_process() {
    let folder = tempfile::tempdir().unwrap();
    let source = compilers::source("tests/plugins/faulty.c");
    let Some(library) = compilers::library(folder.path(), "whole.so", &[source], &["-D_DEFAULT_SOURCE"])
    else {
        return;
    };
    let whole = std::fs::read(library).unwrap();
    let mut random = Random(1);
    let (mut tally, grid) = (Tally::default(), grid());
    for case in 0..count(60) {
        let mut bytes = whole.clone();
        match random.below(4) {
            0 => bytes.truncate(random.below(whole.len())),
            1 => {
                let from = random.below(whole.len());
                let end = (from + random.below(2000)).min(whole.len());
                bytes[from..end].fill(0);
            }
            _ => {
                for _ in 0..=random.below(20) {
                    let at = random.below(whole.len());
                    bytes[at] = random.below(256) as u8;
                }
            }
        }
        let name = format!("damaged-{case}.so");
        let path = folder.path().join(&name);
        std::fs::write(&path, bytes).unwrap();
        let program = env!("CARGO_BIN_EXE_voltet").into();
        let apart = PluginFile::read(&path).and_then(|file| voltet_plugins::load_apart(&file, program));
        tried(&mut tally, &grid, apart, &name);
        std::fs::remove_file(path).unwrap();
    }
    // One that still loads may compute anything: who damages the code of a filter makes another filter. Pictures say which file.
    eprintln!("files: {tally:?}");
    assert!(tally.right > 0 && tally.refused > 0, "{tally:?}");
}

/// Steele, Lea, Flood 2014: SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}
