//! Times of frames that differ from the one before in one thing.

use crate::SHADING;
use crate::subject::{Subject, Volumes, middle};
use std::time::Instant;
use voltet::core::Result;
use voltet::core::camera::Camera;
use voltet::core::progress::Silent;
use voltet::core::transfer::{Profile, TransferFunction};
use voltet::engine::{Known, composite, project};

const FRAME_COUNT: usize = 31;

/// What differs from frame to frame.
const CHANGES: [&str; 5] = ["nothing", "camera turned", "widget moved", "colour", "extinction"];

/// Prints a table: each Gaussian of the subject at 512², with every change.
pub fn measure(subject: &Subject, volumes: &Volumes) -> Result<()> {
    println!(
        "\n| one Gaussian, 512² | what changes | cells kept | cull, ms | project, ms | composite, ms | frame, ms |"
    );
    println!("| --- | --- |{}", " ---: |".repeat(5));
    for &(name, centre, sigma, extinction) in subject.gaussians {
        for change in CHANGES {
            let known = Known::new(&volumes.bivariate)?;
            let mut stages = [const { Vec::new() }; 4];
            let mut cells_kept = 0;
            for k in 0..=FRAME_COUNT {
                let (camera, look) = frame(subject, change, k, (centre, sigma, extinction));
                let start = Instant::now();
                let cells = known.cull(&look, &camera, &Silent)?;
                let culled = Instant::now();
                let projection = project(&cells, &look, &camera, false, &Silent)?;
                let projected = Instant::now();
                composite(&projection, &look, &SHADING, &Silent)?;
                let times = [culled - start, projected - culled, projected.elapsed(), start.elapsed()];
                // The first one warms up.
                for (stage, time) in stages.iter_mut().zip(times).filter(|_| k > 0) {
                    stage.push(1e3 * time.as_secs_f64());
                }
                cells_kept = cells.kept.len();
            }
            let [cull, project, composite, whole] = stages.map(middle);
            println!(
                "| {name} | {change} | {cells_kept} | {cull:.2} | {project:.1} | {composite:.1} | **{whole:.1}** |"
            );
        }
    }
    Ok(())
}

/// The k-th frame of a change.
fn frame(
    subject: &Subject,
    change: &str,
    k: usize,
    (centre, sigma, extinction): ([f64; 2], [f64; 2], f64),
) -> (Camera, TransferFunction) {
    let share = k as f64 / FRAME_COUNT as f64;
    let of = |name: &str| if change == name { share } else { 0.0 };
    // A drag over half a deviation; a tenfold extinction.
    let mut look = subject.gaussian(centre, sigma, extinction * 10f64.powf(of("extinction")));
    if let Profile::Gaussian { centre, .. } = &mut look.widgets[0].profile {
        *centre = [0, 1].map(|axis| centre[axis] + 0.5 * of("widget moved") * sigma[axis]);
    }
    look.widgets[0].color[2] += 0.5 * of("colour");
    (subject.camera(FRAME_COUNT as f64 * of("camera turned"), 512), look)
}
