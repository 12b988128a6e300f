//! Options of the command line.

use std::path::PathBuf;
use std::str::FromStr;
use voltet::core::{Error, Result};

/// Measurements to make.
pub struct BenchOptions {
    /// Grids.
    pub scenes: Vec<String>,
    /// Looks.
    pub looks: Vec<String>,
    /// Pixels a side.
    pub sizes: Vec<u32>,
    /// Threads; 0: all.
    pub threads: Vec<usize>,
    /// Factors of every extinction.
    pub extinctions: Vec<f64>,
    /// Frames that count, at most.
    pub frames: usize,
    /// Seconds after which no further frame of a row begins.
    pub patience: f64,
    /// True if frames are timed that differ from the one before in one thing.
    pub changes: bool,
    /// True if reading, gradients and single widgets are timed, too.
    pub widgets: bool,
    /// The file to append to.
    pub record: Option<PathBuf>,
}

pub const SCENES: [&str; 6] = ["heat_sink", "bluntfin", "post", "1M", "4M", "16M"];
pub const LOOKS: [&str; 3] = ["piecewise-linear", "one-gaussian", "four-gaussians"];

const HELP: &str = "cargo bench --bench frame -- [OPTIONS]
  --scenes LIST      heat_sink,bluntfin,post,1M,4M,16M; bluntfin and post where VOLTET_TEST_DATA has them [all but 4M, 16M]
  --looks LIST       piecewise-linear,one-gaussian,four-gaussians [all]
  --sizes LIST       pixels a side [512,1024]
  --threads LIST     0 is all [0]
  --extinction LIST  factors [1,50,500]
  --frames N         frames of a row, at most [15]
  --patience S       seconds of a row after which no further frame begins [1]
  --changes          frames that differ from the one before in one thing: a camera, a widget, a colour, an extinction
  --widgets          reading, gradients and what each widget costs, too
  --record FILE      append to a CSV file, and say what took longer than its last line of this machine";

impl BenchOptions {
    /// From the command line; `None`: help was asked for and printed. `--bench`, which cargo passes, is of no account.
    pub fn read() -> Result<Option<BenchOptions>> {
        let mut wish = BenchOptions {
            scenes: SCENES[..4].iter().map(|name| name.to_string()).collect(),
            looks: LOOKS.map(String::from).to_vec(),
            sizes: vec![512, 1024],
            threads: vec![0],
            extinctions: vec![1.0, 50.0, 500.0],
            frames: 15,
            patience: 1.0,
            changes: false,
            widgets: false,
            record: None,
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(option) = arguments.next() {
            let mut value = || {
                let missing = || Error::usage(format!("{option} needs a value")).expected(HELP);
                arguments.next().ok_or_else(missing)
            };
            match option.as_str() {
                "--bench" => {}
                "--help" => {
                    println!("{HELP}");
                    return Ok(None);
                }
                "--scenes" => wish.scenes = named(&option, &value()?, &SCENES)?,
                "--looks" => wish.looks = named(&option, &value()?, &LOOKS)?,
                "--sizes" => wish.sizes = list(&option, &value()?)?,
                "--threads" => wish.threads = list(&option, &value()?)?,
                "--extinction" => wish.extinctions = list(&option, &value()?)?,
                "--frames" => wish.frames = one(&option, &value()?)?,
                "--patience" => wish.patience = one(&option, &value()?)?,
                "--changes" => wish.changes = true,
                "--widgets" => wish.widgets = true,
                "--record" => wish.record = Some(PathBuf::from(value()?)),
                _ => return Err(Error::usage("there is no such option").got(option).expected(HELP)),
            }
        }
        Ok(Some(wish))
    }
}

fn one<T: FromStr>(option: &str, text: &str) -> Result<T> {
    let wrong = || Error::usage(format!("{option} takes no such value")).got(text).expected(HELP);
    text.trim().parse().map_err(|_| wrong())
}

fn list<T: FromStr>(option: &str, text: &str) -> Result<Vec<T>> {
    text.split(',').map(|part| one(option, part)).collect()
}

fn named(option: &str, text: &str, known: &[&str]) -> Result<Vec<String>> {
    let names: Vec<String> = list(option, text)?;
    match names.iter().find(|name| !known.contains(&name.as_str())) {
        None => Ok(names),
        Some(name) => {
            Err(Error::usage(format!("{option} has no such name")).got(name).expected(known.join(", ")))
        }
    }
}
