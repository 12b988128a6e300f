//! Roettger and Ertl 2002, section 4: the table as planes about its diagonal, and what is drawn from them.

use super::bench::Bench;
use super::frame_buffer::{Lookup, interleaved};
use super::moreland::verdict;
use super::page::{Section, number};
use super::plane::square;
use crate::work_precision::errors;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_integrators::from_cylinder;
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical};
use voltet_optics::WidgetBlend;
use voltet_optics::shading::Integrator;

pub(super) fn pictures(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Figures 8 to 12: tables as planes, the spherical distance volume, and many cells");
    let lookup = Lookup::new(64, interleaved);
    let slices =
        [1, 2, 3, 4, 5, 6, 7, 8].map(|k| square(64, |s, t| texel(&lookup, [s, t, f64::from(k) / 8.0])));
    let row = slices.each_ref().map(|picture| (picture, [0.0; 3]));
    section.figure(
        "figure_9",
        "Figure 9: eight of 64 slices of the table for growing length, S_f to the right, S_b upward",
        &row,
    )?;
    section.figure(
        "figure_10",
        "Figure 10: the same table as 64 planes of 64², s to the right and t upward, from α = 0° left below to 180° right above; black where \
         S_f leaves the table",
        &[(&tiles(&lookup), [0.0; 3])],
    )?;
    let subject = bench.subject("roettger_ertl_sphere.toml", &[])?;
    let cells = subject.scene.volume.grid.tetrahedra.len();
    let scene = bench.referred(subject)?;
    let shot = |integrator| bench.shot(&scene, integrator, WidgetBlend::Exact);
    let exact = shot(Integrator::ANALYTIC)?;
    let (table_size, oversampling) = (64, 2);
    let table = shot(pre_integrated(table_size, oversampling))?;
    let mut rows = Vec::new();
    let mut add = |what: String, shot: &super::bench::TimedRender, loss: String| {
        let [_, rms, most, _] = shot.cells();
        rows.push([what, number(1e3 / shot.ms), rms, most, loss]);
    };
    add("cut at its control points".into(), &exact, "–".into());
    add("table of 64³".into(), &table, "–".into());
    let mut losses = Vec::new();
    let mut speed = 0.0;
    for planes in [1, 2, 4, 8] {
        let tiles = shot(pre_integrated_cylindrical(table_size, oversampling, planes))?;
        let loss = errors(&tiles.picture, &table.picture);
        let over = loss.pixels_over_step;
        add(
            format!("{} planes", planes * table_size + 1),
            &tiles,
            format!("{:.1e}, {over} pixels", loss.maximum),
        );
        losses.push(loss.maximum);
        if planes == 1 {
            speed = table.ms / tiles.ms;
        }
    }
    section.table(
        [
            "512 × 384",
            "frames a second",
            "rms error",
            "largest error",
            "largest difference from the table of 64³",
        ],
        &rows,
    );
    let background = scene.subject.background;
    section.figure(
        "figure_11",
        "Figure 11: cut at the control points (left), from the table of 64³ (right)",
        &[(&exact.picture, background), (&table.picture, background)],
    )?;
    section.say(&format!(
        "{cells} tetrahedra; 2,560 in the paper. \"In order to reconstruct the original table exactly, the number of planes must be four times \
         the resolution\": with four times as many the largest difference is {:.1e}, with eight times {:.1e}: exactness {}, as the \
         places on a plane are resampled, too, and the slices of this program's table lie closer where lengths are small. \"In most \
         cases the number of planes can be reduced by a factor of two or four without introducing visible artifacts\": with as many \
         planes as entries {:.1e}, which {}.",
        losses[2],
        losses[3],
        verdict(losses[2] < 1e-6),
        losses[0],
        verdict(losses[0] < 1.0 / 255.0),
    ));
    section.say(&format!(
        "Two-dimensional tables were 1.13 to 3.8 times as fast as three-dimensional ones on hardware (printed: 13 % to 282 % faster); \
         here {} times. Times without making the table.",
        number(speed),
    ));
    many(bench, section)
}

/// Straight RGB and opacity of an entry at S_f, S_b and the length.
fn texel(lookup: &Lookup, [front, back, length]: [f64; 3]) -> ([f64; 3], f64) {
    let [r, g, b, opacity] = lookup.software(front, back, length, 2.0);
    ([r, g, b].map(|c| if opacity > 0.0 { c / opacity } else { 0.0 }), opacity)
}

/// 8 × 8 planes from α = 0 to 1.
fn tiles(lookup: &Lookup) -> Picture {
    const ACROSS: usize = 8;
    square(ACROSS * 64, |x, y| {
        let [x, y] = [x, y].map(|place| place * ACROSS as f64);
        let plane = y as usize * ACROSS + x as usize;
        let angle = plane as f64 / (ACROSS * ACROSS - 1) as f64;
        let place = from_cylinder(angle, x.fract(), y.fract());
        if (0.0..=1.0).contains(&place[0]) { texel(lookup, place) } else { ([0.0; 3], 0.0) }
    })
}

/// Figure 12: as many cells, in a scene of another kind.
fn many(bench: &Bench, section: &mut Section) -> Result<()> {
    let subject = bench.subject("roettger_ertl_many.toml", &["grid.resolution=[58,58,59]".into()])?;
    let cells = subject.scene.volume.grid.tetrahedra.len();
    let planes = pre_integrated_cylindrical(256, 2, 1);
    let (exact, closed) = bench.measured(&subject, Integrator::ANALYTIC, WidgetBlend::Exact)?;
    let (picture, tiled) = bench.measured(&subject, planes, WidgetBlend::Exact)?;
    let loss = errors(&picture, &exact);
    section.figure(
        "figure_12",
        "Figure 12, the bonsai there, the field by formula of VTK's \"Wavelet\" here: from 257 planes",
        &[(&picture, subject.background)],
    )?;
    section.say(&format!(
        "{cells} tetrahedra in grid order; about 1,200,000 of several sizes in the paper. {:.0} ms from planes and {:.0} ms cut at its \
         control points, which the planes differ from by {:.1e} at worst and {:.1e} on the mean (rms). The planes take {:.0} ms to make.",
        tiled.frame.median_ms,
        closed.frame.median_ms,
        loss.maximum,
        loss.root_mean_square,
        tiled.set_up.median_ms,
    ));
    Ok(())
}
