//! The files of a study, and a setting written into a pipeline file.

use super::settings::overlap_name;
use super::table::csv;
use super::{RenderConfig, RendererNode, Study, json, page, plot};
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_document::{Document, Edit};
use voltet_graph::ParameterValue;
use voltet_io::encode;
use voltet_nodes::files;
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::Integrator;

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

/// The text of the pipeline file with one of the study's settings in it; every other byte stays as it is. Overlap, order, engine,
/// adapter and compositor are written where they differ from what the file says or comes to here; a `gpu-renderer` that is to draw
/// on the native engine becomes a `renderer`.
pub fn apply(text: &str, study: &Study, setting: &RenderConfig) -> Result<String> {
    let subject = &study.subject;
    let mut document = Document::from_text(text.to_string(), None);
    let mut set = |node: &str, name, value| document.edit(&Edit::set(node, name, value));
    let word = |text: &str| ParameterValue::Text(text.to_string());
    let own = RenderConfig::of_file(subject, setting.variant);
    for (name, value) in setting.keys() {
        set(&subject.node, name, value)?;
    }
    if setting.overlap != own.overlap && setting.integrator == Integrator::ANALYTIC {
        set(&subject.node, "overlap", word(overlap_name(setting.overlap)))?;
    } else if own.overlap == WidgetBlend::Mix && setting.integrator != Integrator::ANALYTIC {
        // Of no account for the others, and misleading.
        set(&subject.node, "overlap", word(overlap_name(WidgetBlend::Exact)))?;
    }
    if setting.order != own.order
        && let Some(node) = &subject.order_node
    {
        set(node, "order", word(setting.order.name()))?;
    }
    for (name, value) in engine_keys(study, setting) {
        set(&subject.node, name, word(value))?;
    }
    Ok(document.text().to_string())
}

/// The keys that state the setting's engine, where the file comes to another one.
fn engine_keys<'a>(study: &'a Study, setting: &RenderConfig) -> Vec<(&'static str, &'a str)> {
    let asked = &study.subject.asked;
    let variant = setting.variant;
    let mut keys = Vec::new();
    match asked.form {
        RendererNode::Stages => return keys,
        RendererNode::GpuRenderer if variant.engine.name != asked.engine => {
            keys.extend([("type", "renderer"), ("engine", variant.engine.name)]);
        }
        RendererNode::GpuRenderer => {}
        RendererNode::Renderer => {
            let same = study.own.is_some_and(|own| own.variant.engine == variant.engine);
            keys.extend((!same).then_some(("engine", variant.engine.name)));
        }
    }
    let adapter = study.adapters.iter().find(|adapter| adapter.engine == variant.engine);
    let wish = adapter.and_then(|adapter| adapter.wish.as_deref());
    keys.extend(wish.filter(|wish| asked.adapter.as_deref() != Some(wish)).map(|wish| ("adapter", wish)));
    let only = asked.compositor == "auto" && variant.engine.compositing.len() == 1;
    let compositor = variant.compositor().filter(|name| *name != asked.compositor && !only);
    keys.extend(compositor.map(|name| ("compositor", name)));
    // Tiles refuse what the file asks of those that blend.
    let accumulation = variant.compositing.is_some().then_some(setting.accumulation);
    let other = accumulation.filter(|one| *one != asked.accumulation);
    keys.extend(other.map(|one| ("accumulation", one.name())));
    keys
}
