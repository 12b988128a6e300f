//! `voltet time`: what a frame costs on each engine, with a camera that turns.

use super::{DONE, open_all, show, warn};
use crate::Document;
use crate::arguments;
use crate::core::graph::{Observer, Registry};
use crate::core::progress::Progress;
use crate::core::shading::Order;
use crate::core::{Error, Result};
use crate::present::Bar;
use crate::study::work_precision::{
    self as study, Benches, Cost, Engine, Engines, Frames, Measure, Scene, Setting, Times, Wish,
};
use std::time::Duration;

pub fn time(arguments: &arguments::Time, registry: &Registry) -> Result<u8> {
    let wish = wish(arguments)?;
    let (documents, wrong) = open_all(&arguments.files, &arguments.set.options, registry);
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
            worst = worst.max(show(&document.locate(error), Some(&document.text)));
        }
    }
    Ok(worst)
}

fn wish(arguments: &arguments::Time) -> Result<Wish> {
    if arguments.frames == 0 {
        return Err(Error::usage("--frames is out of range").found(0).accepted("1 or more"));
    }
    if !(0.0..=3e7).contains(&arguments.patience) || !arguments.turn.is_finite() {
        return Err(Error::usage("--patience or --turn is out of range")
            .found(format!("{} s, {}°", arguments.patience, arguments.turn))
            .accepted("0 to 3e7 seconds, any angle"));
    }
    Ok(Wish {
        only: Vec::new(),
        engines: Engines::from(arguments.engine),
        adapter: arguments.adapter.clone(),
        frames: Frames {
            count: arguments.frames,
            patience: Duration::from_secs_f64(arguments.patience),
            turn: arguments.turn,
        },
        measure: Measure::Maximum,
        max_error: None,
        refine: 0,
    })
}

/// Ctrl-C is heard; what a frame reports is not shown, since showing it takes time.
struct Unshown<'a>(&'a Bar);

impl Progress for Unshown<'_> {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

const HEAD: &str =
    "| node | size | engine | order | frame, median ms | fastest to slowest | cull | sort | project | \
composite | GFLOP/s there | set-up, ms | segments | 10⁶ segments/s |
| --- | --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |";

/// Prints the table of one file.
fn measure(arguments: &arguments::Time, wish: &Wish, document: &Document, bar: &Bar) -> Result<()> {
    let nodes = study::drawing_nodes(&document.graph);
    if nodes.is_empty() {
        return Err(Error::usage("the pipeline draws no volume, so there is nothing to time").accepted(
            "a node of type \"renderer\", \"gpu-renderer\" or \"composite\" that an image-writer needs",
        ));
    }
    let title = document.pipeline.title.clone().unwrap_or_else(|| document.path.display().to_string());
    let mut session = crate::nodes::session();
    for (number, node) in nodes.iter().enumerate() {
        let scene = Scene::gather(&document.graph, Some(node), &mut session, bar)?;
        let mut benches = Benches::open(&scene, wish)?;
        bar.clear();
        if number == 0 {
            println!("\n{title}: {} tetrahedra", scene.volume.grid.tetrahedra.len());
            benches.left_out.iter().for_each(|what| println!("\nnot measured: {what}"));
            device(&benches, &scene, wish)?;
            println!("\n{HEAD}");
        }
        rows(arguments, wish, scene, &mut benches, bar)?;
    }
    Ok(())
}

/// Says what device is measured, and what it can do at most.
fn device(benches: &Benches, scene: &Scene, wish: &Wish) -> Result<()> {
    if let (Some(adapter), Some(rate)) = (benches.adapter(scene, wish), benches.multiply_adds_per_second()?) {
        let rate = 1e-9 * rate;
        println!(
            "\ndevice: {}; measured: {rate:.0}·10⁹ 32-bit multiply-adds/s, {:.0} GFLOP/s",
            adapter.name,
            2.0 * rate
        );
    }
    Ok(())
}

/// Prints the rows of one node that draws. Errors: a stopped run; what else goes wrong with a row stands in it.
fn rows(
    arguments: &arguments::Time,
    wish: &Wish,
    mut scene: Scene,
    benches: &mut Benches,
    bar: &Bar,
) -> Result<()> {
    let own = [scene.camera.size];
    for &size in if arguments.size.is_empty() { &own[..] } else { &arguments.size } {
        scene.camera.size = size;
        for setting in settings(&scene, benches) {
            match benches.measure(&scene, &setting, &wish.frames, &Unshown(bar)) {
                Ok((_, cost)) => println!("{}", row(&scene, &setting, &cost)),
                Err(error) if bar.cancelled() => return Err(error),
                Err(error) => println!("{}{error} {}", head(&scene, &setting), "|".repeat(10)),
            }
        }
    }
    Ok(())
}

/// What the file draws with, on every engine, in both orders where one is needed.
fn settings(scene: &Scene, benches: &Benches) -> Vec<Setting> {
    let own = scene.setting(Engine::Cpu);
    let only = [own.integrator.name().to_string()];
    let mut settings = benches.settings(scene, &only);
    settings.retain(|setting| setting.integrator == own.integrator && setting.overlap == own.overlap);
    settings
}

fn head(scene: &Scene, setting: &Setting) -> String {
    let order = match setting.order {
        _ if !scene.needs_order => "not needed",
        Order::Exact | Order::Auto => "exact",
        Order::Centroid => "centroid",
        Order::None => "none",
    };
    let [width, height] = scene.camera.size;
    format!("| {} | {width} × {height} | {} | {order} | ", scene.node, setting.engine.label())
}

fn row(scene: &Scene, setting: &Setting, cost: &Cost) -> String {
    let stage = |times: Option<Times>| times.map_or(String::new(), |times| format!("{:.2}", times.median_ms));
    let Times { median_ms, fastest_ms, slowest_ms } = cost.frame;
    let rate_there = |(count, times): (u64, Times)| format!("{:.0}", count as f64 / times.median_ms * 1e-6);
    // Blending hardware does not count segments.
    let count = cost.segments.map(|count| count.to_string()).unwrap_or_default();
    let rate =
        cost.segments.map(|count| format!("{:.0}", count as f64 / median_ms * 1e-3)).unwrap_or_default();
    format!(
        "{}**{median_ms:.2}** | {fastest_ms:.2} to {slowest_ms:.2} | {} | {} | {} | {} | {} | {:.1} | {count} | {rate} |",
        head(scene, setting),
        stage(cost.cull),
        stage(cost.sort),
        stage(cost.project),
        stage(cost.composite),
        cost.operations.zip(cost.composite).map(rate_there).unwrap_or_default(),
        cost.set_up.median_ms,
    )
}
