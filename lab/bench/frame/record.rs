//! Results by commit, a line each in a CSV file, so that a loss is seen.

use std::io::Write;
use std::path::Path;
use std::process::Command;
use voltet::core::{Error, Result};

/// One measurement.
pub struct Line {
    /// Columns of the measurement that tell lines apart.
    pub what: [String; 6],
    /// Milliseconds of culling, projecting, compositing, and the whole frame.
    pub ms: [f64; 4],
    /// Ray segments of a frame.
    pub segments: u64,
    /// Multiply-adds a second that the machine reaches at most.
    pub peak: f64,
}

const HEAD: &str = "commit,date,machine,scene,look,extinction,size,threads,lanes,cull_ms,project_ms,composite_ms,frame_ms,segments,\
                    multiply_adds_per_second";

/// Relative loss that is reported: quiet machines repeat a median to 3 %.
const LOSS: f64 = 1.05;

/// Machine and commit of this run.
pub struct Here {
    commit: String,
    date: String,
    machine: String,
}

impl Here {
    /// The commit with `+` where files are changed, the date, and the processor's name.
    pub fn find() -> Here {
        let git = |arguments: &[&str]| {
            let ran = Command::new("git").args(arguments).output().ok().filter(|ran| ran.status.success());
            ran.map(|ran| String::from_utf8_lossy(&ran.stdout).trim().to_string())
        };
        let mut commit = git(&["rev-parse", "--short", "HEAD"]).unwrap_or_else(|| "unknown".into());
        if git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|changed| !changed.is_empty())
        {
            commit.push('+');
        }
        let date = voltet::io::provenance::date::iso_date(std::time::SystemTime::now());
        let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
            let name = text.lines().find(|line| line.starts_with("model name"))?;
            Some(name.split_once(':')?.1.trim().replace(',', ""))
        });
        let (system, architecture) = (std::env::consts::OS, std::env::consts::ARCH);
        let machine = processor.unwrap_or_else(|| format!("{system} {architecture}"));
        Here { commit, date: date.split('T').next().unwrap_or_default().into(), machine }
    }

    /// Appends lines to the file, and prints which took longer than the last ones of the same machine.
    pub fn append(&self, path: &Path, lines: &[Line]) -> Result<()> {
        let failed = |error: std::io::Error| {
            Error::run("the record cannot be written").got(format!("{}: {error}", path.display()))
        };
        let former = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed(error)),
        };
        if !former.is_empty() && former.lines().next() != Some(HEAD) {
            let error = Error::run("the record has other columns").got(path.display());
            return Err(error.expected(format!("a file that begins with {HEAD}, or none")));
        }
        let mut text = if former.is_empty() { format!("{HEAD}\n") } else { String::new() };
        println!(
            "\n| against the last line of this machine | then, ms | now, ms | |\n| --- | ---: | ---: | --- |"
        );
        for Line { what, ms, segments, peak } in lines {
            let times = ms.map(|ms| format!("{ms:.2}")).join(",");
            let Here { commit, date, machine } = self;
            text += &format!("{commit},{date},{machine},{},{times},{segments},{peak:.3e}\n", what.join(","));
            if let Some((commit, then)) = last(&former, machine, what) {
                let word = if ms[3] > LOSS * then { "**slower**" } else { "" };
                println!("| {} ({commit}) | {then:.1} | {:.1} | {word} |", what.join(", "), ms[3]);
            }
        }
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).map_err(failed)?;
        file.write_all(text.as_bytes()).map_err(failed)
    }
}

/// Commit and milliseconds of the last line of the machine that measured the same.
fn last<'a>(former: &'a str, machine: &str, what: &[String; 6]) -> Option<(&'a str, f64)> {
    former.lines().rev().find_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let same = cells.get(2) == Some(&machine) && cells.get(3..9)?.iter().zip(what).all(|(a, b)| a == b);
        same.then(|| Some((*cells.first()?, cells.get(12)?.parse().ok()?))).flatten()
    })
}
