//! `read_speed`: seconds that a data file takes from disk to a grid, for `lab/scripts/read-speed.py`.
//!
//! A process reads one file once, as a pipeline's reader does: points, cells as tetrahedra, one scalar. Prints seconds, cells and points.

use std::path::Path;
use std::time::Instant;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Options, Request, inspect, read};

/// Forms of a reading: with tetrahedra, the file's own cells alone, all of the file as `voltet info` does, bytes of the file alone.
const FORMS: [&str; 4] = ["tetrahedra", "cells", "info", "bytes"];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [form, path, array] = &words[..] else {
        stop("usage: read_speed tetrahedra|cells|info|bytes FILE ARRAY|cell:ARRAY|-")
    };
    if !FORMS.contains(&form.as_str()) {
        stop(&format!("unknown form '{form}', expected one of {}", FORMS.join(", ")));
    }
    let scalar = Some(array.clone()).filter(|array| array != "-");
    let start = Instant::now();
    let counts = match form.as_str() {
        "bytes" => bytes(Path::new(path)).map(|count| [count, 0]),
        "info" => match inspect(Path::new(path), &Request::default(), &NoProgress) {
            Ok(summary) => Ok([summary.cell_count, summary.point_count].map(|count| count as usize)),
            Err(error) => Err(error.to_string()),
        },
        _ => grid(Path::new(path), scalar, form == "cells"),
    };
    match counts {
        Ok([cells, points]) => println!("{} {cells} {points}", start.elapsed().as_secs_f64()),
        Err(message) => stop(&message),
    }
}

fn stop(message: &str) -> ! {
    eprintln!("read_speed: {message}");
    std::process::exit(1)
}

/// Numbers of cells and points of a file.
fn grid(path: &Path, scalar: Option<String>, without_tetrahedra: bool) -> Result<[usize; 2], String> {
    let (of_cells, scalar) = match scalar.as_deref().and_then(|name| name.strip_prefix("cell:")) {
        Some(name) => (true, Some(name.to_owned())),
        None => (false, scalar),
    };
    let options = Options { without_tetrahedra, ..Options::default() };
    let request = match without_tetrahedra {
        false => Request { without_scalar: scalar.is_none(), scalar, options, ..Request::default() },
        true => Request {
            without_scalar: true,
            point_arrays: scalar.clone().filter(|_| !of_cells).into_iter().collect(),
            cell_arrays: scalar.filter(|_| of_cells).into_iter().collect(),
            options,
            ..Request::default()
        },
    };
    let grid = read(path, &request, &NoProgress).map_err(|error| error.to_string())?;
    let cells = grid.file_cells.as_ref().map_or(grid.tetrahedra.len(), |cells| cells.cells.count());
    Ok([cells, grid.points.len()])
}

/// Number of bytes of a file, or of a folder's files, read into memory at once by one thread.
fn bytes(path: &Path) -> Result<usize, String> {
    let failed = |error: std::io::Error| error.to_string();
    if !path.is_dir() {
        return std::fs::read(path).map(|bytes| std::hint::black_box(bytes).len()).map_err(failed);
    }
    let mut count = 0;
    for entry in std::fs::read_dir(path).map_err(failed)? {
        count += bytes(&entry.map_err(failed)?.path())?;
    }
    Ok(count)
}
