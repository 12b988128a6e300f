//! Times of steady frames by stage, as Markdown tables of medians, and a record of them by commit.
//!
//! `cargo bench -p voltet-bench --bench frame`; `-- --help` lists the options. A steady frame runs all stages; the camera turns by one
//! degree before each, so that nothing of the former frame can be used again but the cells that the widgets touch. The heat sink
//! that ships and generated grids are always there; further ones where the folder named by VOLTET_TEST_DATA has them. `voltet time`
//! measures frames of any pipeline, also on a device; `lab/bench/beside_vtk.py` sets them beside VTK's.

mod changes;
mod options;
mod peak;
mod record;
mod subject;
mod widgets;

use options::BenchOptions;
use record::{Here, Line};
use std::sync::Arc;
use std::time::Instant;
use subject::{Subject, middle};
use voltet::core::progress::NoProgress;
use voltet::core::transfer::TransferFunction;
use voltet::core::volume::Volume;
use voltet::core::{Error, Result};
use voltet::engine::{VolumeCache, composite, project};
use voltet::lanes::LaneSet;
use voltet::optics::WidgetBlend;
use voltet::optics::shading::{Integrator, Shading};

const SHADING: Shading =
    Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette: None, light: None };

fn main() -> Result<()> {
    let Some(wish) = BenchOptions::read()? else { return Ok(()) };
    let lanes = LaneSet::detect()?;
    let all = std::thread::available_parallelism().map_or(1, |n| n.get());
    println!("{all} threads, {}, {} {}", lanes.name(), std::env::consts::OS, std::env::consts::ARCH);
    let mut pools = Vec::new();
    for &count in &wish.threads {
        let count = if count == 0 { all } else { count };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
        let pool = pool.map_err(|error| Error::run("threads cannot be had").got(error))?;
        let peak = pool.install(|| peak::multiply_adds_per_second(lanes));
        println!("{count} threads reach {:.1} G multiply-adds a second of 32 bits", peak * 1e-9);
        pools.push((count, pool, peak));
    }
    let mut lines = Vec::new();
    for name in &wish.scenes {
        let Some((subject, volumes)) = Subject::named(name)? else {
            println!("\nskipped: {name} (VOLTET_TEST_DATA names no folder that has it)");
            continue;
        };
        let grid = &volumes.plain.grid;
        println!("\n{name}: {} tetrahedra, {} points\n", grid.tetrahedra.len(), grid.points.len());
        println!(
            "| steady frame | extinction × | size | threads | cull, ms | project, ms | composite, ms | frame, ms | M cells/s: cull | \
             project | M segments/s: composite | multiply-adds that fit: a cell, cull | project | a segment, composite |"
        );
        println!("| --- |{}", " ---: |".repeat(13));
        for look in &wish.looks {
            let (volume, whole) = subject.drawn(look, &volumes);
            for &factor in &wish.extinctions {
                let look_there = thicker(&whole, factor);
                for &size in &wish.sizes {
                    for (threads, pool, peak) in &pools {
                        let frame = pool.install(|| measure(&wish, subject, volume, &look_there, size))?;
                        frame.print(
                            [look, &factor.to_string(), &format!("{size}²"), &threads.to_string()],
                            *peak,
                        );
                        let what = [
                            name.clone(),
                            look.clone(),
                            factor.to_string(),
                            size.to_string(),
                            threads.to_string(),
                        ];
                        let [a, b, c, d, e] = what;
                        lines.push(Line {
                            what: [a, b, c, d, e, lanes.name().into()],
                            ms: frame.ms,
                            segments: frame.segments,
                            peak: *peak,
                        });
                    }
                }
            }
        }
        if wish.changes {
            changes::measure(subject, &volumes)?;
        }
        if wish.widgets {
            widgets::measure(subject, &volumes)?;
        }
    }
    match &wish.record {
        Some(path) => Here::find().append(path, &lines),
        None => Ok(()),
    }
}

/// Every extinction times a factor.
fn thicker(look: &TransferFunction, factor: f64) -> TransferFunction {
    // The unit distance says the same of all kinds.
    TransferFunction { unit_distance: look.unit_distance / factor, ..look.clone() }
}

/// Medians of a row.
struct Frame {
    /// Culling, projecting, compositing, the whole frame.
    ms: [f64; 4],
    /// Cells that culling looks at, and that projecting does.
    cells: [u64; 2],
    segments: u64,
}

/// Draws frames from a camera that turns.
fn measure(
    wish: &BenchOptions,
    subject: &Subject,
    volume: &Arc<Volume>,
    look: &TransferFunction,
    size: u32,
) -> Result<Frame> {
    let mut stages = [const { Vec::new() }; 4];
    let (mut cells_kept, mut segments) = (0, 0);
    let begun = Instant::now();
    let known = VolumeCache::new(volume)?;
    for k in 0..=wish.frames {
        let camera = subject.camera(k as f64, size);
        let start = Instant::now();
        let cells = known.cull(look, &camera, &NoProgress)?;
        let culled = Instant::now();
        let projection = project(&cells, look, &camera, false, &NoProgress)?;
        let projected = Instant::now();
        let (_, counts) = composite(&projection, look, &SHADING, &NoProgress)?;
        let whole = start.elapsed();
        let times = [culled - start, projected - culled, projected.elapsed(), whole];
        let over = begun.elapsed().as_secs_f64() > wish.patience;
        // The first one warms up, but where it outlasts the patience.
        if k > 0 || over {
            for (stage, time) in stages.iter_mut().zip(times) {
                stage.push(1e3 * time.as_secs_f64());
            }
        }
        (cells_kept, segments) = (cells.ids.len() as u64, counts.segments);
        if over {
            break;
        }
    }
    let cells = [volume.grid.tetrahedra.len() as u64, cells_kept];
    Ok(Frame { ms: stages.map(middle), cells, segments })
}

impl Frame {
    fn print(&self, head: [&str; 4], peak: f64) {
        let [cull, project, composite, whole] = self.ms;
        let works = [(self.cells[0], cull), (self.cells[1], project), (self.segments, composite)];
        let rates = works.map(|(count, ms)| format!("{:.1}", count as f64 / ms * 1e-3));
        // What the machine could do at most in the time that one of them takes.
        let fit = works.map(|(count, ms)| format!("{:.0}", peak * ms * 1e-3 / (count as f64).max(1.0)));
        println!(
            "| {} | {cull:.1} | {project:.1} | {composite:.1} | **{whole:.1}** | {} | {} |",
            head.join(" | "),
            rates.join(" | "),
            fit.join(" | ")
        );
    }
}
