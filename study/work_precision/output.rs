//! The files of a study.

use super::{Study, csv, json, page, plot};
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_nodes::{encode, files};

/// Writes everything into `folder`, which is made where it is not there, and gives the paths.
pub fn write(study: &Study, title: &str, folder: &Path) -> Result<Vec<PathBuf>> {
    let differences = folder.join("differences");
    std::fs::create_dir_all(&differences).map_err(|error| {
        let what = format!("the folder '{}' cannot be made", differences.display());
        Error::run(what).found(error).accepted("--output with a folder that can be written to")
    })?;
    let canvas = plot::plot(study, title);
    let plot_svg = canvas.svg();
    let reference_png = encode::png(&study.reference.picture, study.subject.background)?;
    let mut outputs = vec![
        (folder.join("study.html"), page::page(study, title, &plot_svg, &reference_png).into_bytes()),
        (folder.join("study.csv"), csv(study).into_bytes()),
        (folder.join("study.json"), format!("{:#}\n", json(study, title)).into_bytes()),
        (folder.join("plot.svg"), plot_svg.into_bytes()),
        (folder.join("plot.png"), encode::png(&canvas.picture(), [1.0; 3])?),
        (folder.join("reference.png"), reference_png),
    ];
    for row in &study.rows {
        let name = format!("{}.png", row.setting.file_stem());
        outputs.push((differences.join(name), row.difference_png.clone()));
    }
    for (path, content) in &outputs {
        files::write_whole(path, content)?;
    }
    Ok(outputs.into_iter().map(|(path, _)| path).collect())
}
