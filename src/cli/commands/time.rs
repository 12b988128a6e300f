//! `voltet time`: what a frame costs on each engine, with a camera that turns.

use super::shared::{DONE, Outcome, open_all, show, warn};
use super::study::option;
use crate::Document;
use crate::cli::arguments;
use crate::cli::present::{Bar, print, say, warnings};
use crate::core::progress::CancelOnly;
use crate::core::{Error, Result, counted};
use crate::graph::{NodeProgress, Observer, Registry};
use voltet_study::work_precision::{
    self as study, Benches, Cost, Frames, RenderConfig, RendererVariant, StudyOptions, Subject, Times,
};

pub fn time(arguments: &arguments::Time, registry: &Registry) -> Outcome {
    let wish = wish(arguments)?;
    let (documents, wrong) = open_all(&arguments.files, &[], registry);
    if wrong != DONE {
        return Ok(wrong);
    }
    let bar = Bar::new(false);
    let mut worst = DONE;
    for document in &documents {
        warn(document);
        let done = measure(arguments, &wish, document, &bar);
        bar.clear();
        if let Err(error) = done {
            worst = worst.max(show(&document.failure(error)));
        }
    }
    Ok(worst)
}

fn wish(arguments: &arguments::Time) -> Result<StudyOptions> {
    let wish = StudyOptions {
        engines: arguments.engine,
        adapter: arguments.adapter.clone(),
        frames: Frames {
            count: arguments.frames,
            patience: study::patience(arguments.patience, "--patience")?,
            turn: arguments.turn,
            in_flight: arguments.in_flight,
        },
        ..StudyOptions::default()
    };
    wish.check(&[], option)?;
    Ok(wish)
}

const HEAD: &str =
    "| node | size | engine | order | frame, median ms | fastest to slowest | in flight, ms | cull | sort | project | \
composite | set-up, ms | segments | 10⁶ segments/s |
| --- | --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |";

/// Prints the table of one file.
fn measure(arguments: &arguments::Time, wish: &StudyOptions, document: &Document, bar: &Bar) -> Result<()> {
    document.refuse_missing_data()?;
    let nodes = study::drawing_nodes(&document.graph);
    if nodes.is_empty() {
        return Err(Error::usage("the pipeline draws no volume, so there is nothing to time").expected(
            "a node of type \"renderer\", \"gpu-renderer\" or \"composite\" that an image-writer needs",
        ));
    }
    let title = document.pipeline.title.clone().unwrap_or_else(|| document.path.display().to_string());
    let mut session = crate::nodes::session();
    let mut said: Vec<String> = document.graph.warnings.iter().map(Error::to_string).collect();
    for (number, node) in nodes.iter().enumerate() {
        let subject = Subject::gather(&document.graph, Some(node), false, &mut session, bar)?;
        let mut benches = Benches::open(&subject, wish)?;
        bar.clear();
        // Nodes that are fed alike have the same warnings.
        let new: Vec<String> = subject.warnings.iter().filter(|new| !said.contains(new)).cloned().collect();
        say(&warnings(&new, 0));
        said.extend(new);
        if number == 0 {
            let cells = counted(subject.scene.volume.grid.tetrahedra.len(), "tetrahedron");
            let mut head = format!("\n{title}: {cells}\n");
            head.extend(benches.left_out.iter().map(|what| format!("\nnot measured: {what}\n")));
            let devices = benches.adapters(&subject, wish);
            head.extend(devices.iter().map(|device| format!("\ndevice: {}\n", device.name)));
            print(&format!("{head}\n{HEAD}\n"))?;
        }
        if !rows(arguments, wish, subject, &mut benches, bar)? {
            break;
        }
    }
    Ok(())
}

/// Prints the rows of one node that draws; false if the output was closed. Errors: cancellation; other errors stand in their row.
fn rows(
    arguments: &arguments::Time,
    wish: &StudyOptions,
    mut subject: Subject,
    benches: &mut Benches,
    bar: &Bar,
) -> Result<bool> {
    let own = [subject.scene.camera.size];
    for &size in if arguments.size.is_empty() { &own[..] } else { &arguments.size } {
        subject.scene.camera.size = size;
        for setting in settings(arguments, &subject, benches) {
            // Progress is not shown, since that takes time.
            let watch = CancelOnly(&NodeProgress { observer: bar, node: "" });
            let line = match benches.measure(&subject, &setting, &wish.frames, &watch) {
                Ok((_, cost)) => row(&subject, &setting, &cost),
                Err(error) if bar.cancelled() => return Err(error),
                Err(error) => format!("{}{error} {}", head(&subject, &setting), "|".repeat(10)),
            };
            if !print(&(line + "\n"))? {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// Settings of the file on every requested engine, in both orders where one is needed.
fn settings(arguments: &arguments::Time, subject: &Subject, benches: &Benches) -> Vec<RenderConfig> {
    let own = RenderConfig::of_file(subject, RendererVariant::NATIVE);
    let only = [own.integrator.name().to_string()];
    let mut settings = benches.settings(subject, &only);
    let ways = &arguments.compositor;
    let is_asked = |setting: &RenderConfig| {
        let way = setting.variant.compositing;
        ways.is_empty() || way.is_none_or(|way| ways.contains(&way))
    };
    settings.retain(|setting| {
        setting.integrator == own.integrator && setting.overlap == own.overlap && is_asked(setting)
    });
    settings
}

fn head(subject: &Subject, setting: &RenderConfig) -> String {
    let order = setting.scene(subject).ordering(false);
    let [width, height] = subject.scene.camera.size;
    format!("| {} | {width} × {height} | {} | {order} | ", subject.node, setting.variant.label())
}

fn row(subject: &Subject, setting: &RenderConfig, cost: &Cost) -> String {
    let stage = |times: Option<Times>| times.map_or(String::new(), |times| format!("{:.2}", times.median_ms));
    let Times { median_ms, fastest_ms, slowest_ms } = cost.frame;
    let in_flight = cost.in_flight_ms.map_or(String::new(), |ms| format!("{ms:.2}"));
    // Blending hardware does not count segments.
    let count = cost.segments.map(|count| count.to_string()).unwrap_or_default();
    let rate =
        cost.segments.map(|count| format!("{:.0}", count as f64 / median_ms * 1e-3)).unwrap_or_default();
    format!(
        "{}**{median_ms:.2}** | {fastest_ms:.2} to {slowest_ms:.2} | {in_flight} | {} | {} | {} | {} | {:.1} | {count} | {rate} |",
        head(subject, setting),
        stage(cost.cull),
        stage(cost.sort),
        stage(cost.project),
        stage(cost.composite),
        cost.set_up.median_ms,
    )
}
