//! The files of a study.

use super::{Study, csv, json, page, plot};
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_io::encode;
use voltet_nodes::files;

/// The files of every study in `folder`, and the difference pictures of former ones, which it may write anew.
pub fn written(folder: &Path) -> Vec<PathBuf> {
    let former = std::fs::read_dir(folder.join(DIFFERENCES)).into_iter().flatten().flatten();
    FILES.iter().map(|name| folder.join(name)).chain(former.map(|entry| entry.path())).collect()
}

/// The folder of difference pictures, a file a setting.
const DIFFERENCES: &str = "differences";

/// Files beside the page.
const FILES: [&str; 6] = ["study.html", "study.csv", "study.json", "plot.svg", "plot.png", "reference.png"];

/// Writes everything into `folder`, which is made where it is not there, and gives the paths.
pub fn write(study: &Study, title: &str, folder: &Path) -> Result<Vec<PathBuf>> {
    let differences = folder.join(DIFFERENCES);
    std::fs::create_dir_all(&differences).map_err(|error| {
        let what = format!("the folder '{}' cannot be made", differences.display());
        Error::run(what).got(error).expected("--output with a folder that can be written to")
    })?;
    let canvas = plot::plot(study, title);
    let plot_svg = canvas.svg();
    let reference_png = encode::png(&study.reference.picture, study.subject.background, None)?;
    let contents = [
        page::page(study, title, &plot_svg, &reference_png).into_bytes(),
        csv(study).into_bytes(),
        format!("{:#}\n", json(study, title)).into_bytes(),
        plot_svg.into_bytes(),
        encode::png(&canvas.picture(), [1.0; 3], None)?,
        reference_png,
    ];
    let mut outputs: Vec<(PathBuf, Vec<u8>)> =
        FILES.iter().map(|name| folder.join(name)).zip(contents).collect();
    for row in &study.rows {
        let name = format!("{}.png", row.setting.file_stem());
        outputs.push((differences.join(name), row.difference_png.clone()));
    }
    for (path, content) in &outputs {
        files::write_whole(path, content)?;
    }
    Ok(outputs.into_iter().map(|(path, _)| path).collect())
}
