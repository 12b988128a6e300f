//! J. Kniss, S. Premože, M. Ikits, A. Lefohn, C. Hansen, E. Praun, "Gaussian transfer functions for multi-field volume
//! visualization", 2003.

use super::bench::{Bench, Scene, TimedRender};
use crate::papers::bench::*;
use crate::work_precision::Subject;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::transfer::{Profile, TransferFunction};
use voltet_integrators::{riemann, tabulated};
use voltet_optics::shading::Integrator;

/// Table 5: seconds a frame for one to four primitives.
const TABLE_5: [(&str, [f64; 4]); 5] = [
    ("separable 2-D textures", [0.20, 0.26, 0.39, 0.54]),
    ("3-D Gaussians, point samples", [0.21, 0.30, 0.39, 0.55]),
    ("4-D triangular, point samples", [0.24, 0.33, 0.44, 0.59]),
    ("3-D Gaussians, analytic", [0.55, 1.11, 1.79, 2.45]),
    ("4-D triangular, analytic", [0.57, 1.23, 2.00, 2.60]),
];

const TABLED: Integrator = tabulated(128);

pub(super) fn section(bench: &Bench) -> Result<Section> {
    let mut section = Section::new(Paper::Kniss, "Kniss et al. 2003: Gaussian transfer functions");
    section.say(
        "The paper's CT tooth and MRI of a mouse brain are no unstructured grids and are not to be had: the heat sink stands in for \
         both, its temperature and the number of the part for the fields. Slices there are samples of each ray segment here, so the \
         number of samples can be compared by its ratio. Its \"analytic\" way is ours `tabulated` with 128² entries (the mean \
         gradient magnitude of a segment, widgets averaged without their order); `analytic` has neither approximation.",
    );
    figure_1(bench, &mut section)?;
    figure_2(&mut section)?;
    figure_6(bench, &mut section)?;
    table_5(bench, &mut section)?;
    table_of_gaussians(bench, &mut section)?;
    Ok(section)
}

const HEAD: [&str; 6] = ["here", "printed", "ms", "rms error", "largest error", "pixels over 1/255"];

fn figure_1(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Figure 1: thin boundaries, analytic and numerical");
    let scene = bench.scene("kniss_boundaries.toml")?;
    let shot = |integrator| bench.shot(&scene, integrator);
    let exact = shot(Integrator::ANALYTIC)?;
    let tabled = shot(TABLED)?;
    let [three, one] = [shot(riemann(3))?, shot(riemann(1))?];
    let (count, equal) = bench.in_equal_time(&scene, exact.ms, riemann)?;
    section.figure(
        "figure_1",
        "Figure 1: analytic (left), three samples a segment (middle), one (right)",
        &[exact.panel(), three.panel(), one.panel()],
    )?;
    let rows = [
        exact.row(&["closed forms", "analytic, 128 slices"]),
        tabled.row(&["`tabulated`", "the same, as printed"]),
        three.row(&["3 samples a segment", "numerical, 368 slices"]),
        one.row(&["1 sample a segment", "numerical, 128 slices"]),
        equal.row(&[&format!("in equal time with the closed forms: {count} a segment"), "–"]),
    ];
    section.table(&HEAD, &rows);
    let rms = |shot: &TimedRender| shot.errors.root_mean_square;
    section.say(&format!(
        "\"Similar quality using far fewer slices\": that the printed way is at least as right with one stretch as sampling with three \
         {} (rms {:.1e} and {:.1e}); the closed forms leave {:.1e}.",
        verdict(rms(&tabled) <= rms(&three)),
        rms(&tabled),
        rms(&three),
        rms(&exact),
    ));
    Ok(())
}

/// The first feature of Figure 2, and the second.
const FEATURES: [[f64; 2]; 2] = [[0.3, 0.68], [0.7, 0.3]];
const WIDTH: f64 = 0.09;

fn figure_2(section: &mut Section) -> Result<()> {
    section.part("Figure 2: separable transfer functions");
    let feature =
        |k: usize, x: f64, y: f64| gaussian(x, FEATURES[k][0], WIDTH) * gaussian(y, FEATURES[k][1], WIDTH);
    let along = |axis: usize, count: usize, x: f64| -> f64 {
        FEATURES[..count].iter().map(|centre| gaussian(x, centre[axis], WIDTH)).sum::<f64>().min(1.0)
    };
    let red = |opacity: f64| ([0.9, 0.1, 0.1], opacity.min(1.0));
    let pictures: [Picture; 4] = [
        square(128, |x, y| red(feature(0, x, y))),
        square(128, |x, y| red(along(0, 1, x) * along(1, 1, y))),
        square(128, |x, y| red(feature(0, x, y) + feature(1, x, y))),
        square(128, |x, y| red(along(0, 2, x) * along(1, 2, y))),
    ];
    let row = pictures.each_ref().map(|picture| (picture, [1.0; 3]));
    section.figure(
        "figure_2",
        "Figure 2: one feature in two dimensions (A), as a product of two in one (B); two features (C), as a product (D)",
        &row,
    )?;
    let sum = |picture: &Picture| picture.rgba.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>();
    let [one, product, two, both] = pictures.each_ref().map(sum);
    section.say(&format!(
        "The product classifies {} times what one feature holds and {} times what two hold: \"separable parts unintentionally \
         interact\" {}.",
        number(product / one),
        number(both / two),
        verdict(both > 1.5 * two && (product / one - 1.0).abs() < 1e-6),
    ));
    Ok(())
}

/// The scene with its first `count` primitives.
fn first(subject: &Subject, count: usize) -> Subject {
    let mut look = TransferFunction::clone(&subject.scene.transfer_function);
    look.widgets.truncate(count);
    let mut subject = subject.clone();
    subject.scene.transfer_function = Arc::new(look);
    subject
}

fn figure_6(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Figure 6: three primitives over several fields");
    let subject = bench.sized("kniss_fields.toml")?;
    let scene = bench.referred(first(&subject, 3))?;
    let shot = |integrator| bench.shot(&scene, integrator);
    let (one, tabled) = (shot(riemann(1))?, shot(TABLED)?);
    let four = shot(riemann(4))?;
    let exact = shot(Integrator::ANALYTIC)?;
    let (count, equal) = bench.in_equal_time(&scene, exact.ms, riemann)?;
    section.figure(
        "figure_6",
        "Figure 6: one sample a segment (A), `tabulated` (B), four samples (C)",
        &[one.panel(), tabled.panel(), four.panel()],
    )?;
    let caption = format!(
        "In equal time, or one where even that takes longer: closed forms (left), samples a segment: {count} (right)"
    );
    section.figure("equal_time", &caption, &[exact.panel(), equal.panel()])?;
    let rows = [
        one.row(&["1 sample a segment", "A: Riemann sum, 270 slices"]),
        tabled.row(&["`tabulated`", "B: analytic, 270 slices"]),
        four.row(&["4 samples a segment", "C: Riemann sum, 1000 slices, as long as B"]),
        exact.row(&["closed forms", "–"]),
        equal.row(&[&format!("in equal time with the closed forms: {count} a segment"), "–"]),
    ];
    section.table(&HEAD, &rows);
    section.say(&format!(
        "\"Note the higher quality result of the analytic integration\" than of samples that take as long: of the closed forms that \
         {} (rms {:.1e} and {:.1e}), of the printed way against four samples {} (rms {:.1e} and {:.1e}).",
        verdict(exact.errors.root_mean_square < equal.errors.root_mean_square),
        exact.errors.root_mean_square,
        equal.errors.root_mean_square,
        verdict(tabled.errors.root_mean_square < four.errors.root_mean_square),
        tabled.errors.root_mean_square,
        four.errors.root_mean_square,
    ));
    Ok(())
}

fn table_5(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Table 5: time for one to four primitives, by that of one point-sampled Gaussian");
    let triangular = bench.sized("kniss_fields.toml")?;
    let mut plain = triangular.clone();
    plain.scene.transfer_function = Arc::new(without_magnitude(&triangular.scene.transfer_function));
    let sampled = riemann(1);
    let ways: [Option<(&Subject, Integrator)>; 5] = [
        None,
        Some((&plain, sampled)),
        Some((&triangular, sampled)),
        Some((&plain, TABLED)),
        Some((&triangular, TABLED)),
    ];
    let time = |subject: &Subject, integrator, count| -> Result<f64> {
        Ok(bench.measured(&first(subject, count), integrator)?.1.frame.median_ms)
    };
    // One point-sampled Gaussian.
    let unit = time(&plain, sampled, 1)?;
    let (mut rows, mut last) = (Vec::new(), Vec::new());
    for ((name, printed), way) in TABLE_5.iter().zip(ways) {
        let printed = printed.map(|seconds| number(seconds / TABLE_5[1].1[0]));
        let here = match way {
            None => ["–"; 4].map(String::from).to_vec(),
            Some((subject, integrator)) => {
                let ratio = |count| Ok(time(subject, integrator, count)? / unit);
                let ratios = (1..=4).map(ratio).collect::<Result<Vec<f64>>>()?;
                last.push(ratios[3]);
                ratios.into_iter().map(number).collect()
            }
        };
        rows.push([vec![name.to_string()], printed.to_vec(), here].concat());
    }
    let own = [&plain, &triangular].map(|subject| time(subject, Integrator::ANALYTIC, 4));
    let own = own.into_iter().map(|ms| Ok(number(ms? / unit))).collect::<Result<Vec<_>>>()?;
    section.table(&["primitives", "printed: 1", "2", "3", "4", "here: 1", "2", "3", "4"], &rows);
    section.say(&format!(
        "Gaussians here are over two fields, triangular ones over two and their multi-gradient. `analytic`, in order and in closed form, \
         takes {} and {} for four. Separable textures have no counterpart. \"More than twice as long\" analytically as by point samples: \
         with four primitives that {}.",
        own[0],
        own[1],
        verdict(last[2] > 2.0 * last[0] && last[3] > 2.0 * last[1]),
    ));
    Ok(())
}

/// Gaussians over the fields alone, about as wide as the triangular ones where the fields change.
fn without_magnitude(look: &TransferFunction) -> TransferFunction {
    let mut look = look.clone();
    for widget in &mut look.widgets {
        if let Profile::TriangularGaussianNd { fields, centre, matrix, .. } = &widget.profile {
            let (fields, centre, matrix) = (fields.clone(), centre.clone(), matrix.clone());
            widget.profile = Profile::GaussianNd { fields, centre, matrix };
        }
    }
    look
}

fn table_of_gaussians(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("\"128² 16-bit samples [are] sufficient\" (section 5.2.1)");
    // Gaussians alone, so that only the table errs.
    let scene = bench.scene("song_gaussian.toml")?;
    let narrow = bench.referred(narrowed(&scene, 30.0))?;
    let (mut rows, mut found) = (Vec::new(), Vec::new());
    for table_size in [32, 64, 128, 256, 512] {
        let shot = |scene| bench.shot(scene, tabulated(table_size));
        let (wide, thin) = (shot(&scene)?, shot(&narrow)?);
        let ([_, a, b, _], [_, c, d, _]) = (wide.cells(), thin.cells());
        rows.push(vec![format!("{table_size}²"), a, b, c, d]);
        found.push([wide.errors.maximum, thin.errors.maximum]);
    }
    section.table(
        &["table", "a wide Gaussian: rms error", "largest", "30 times narrower: rms error", "largest"],
        &rows,
    );
    section.say(&format!(
        "To half a step of 8 bits 128² entries {} for the wide Gaussian, and {} for the narrow one, as the table ends at 10 widths and \
         holds on beyond.",
        verdict(found[2][0] < 0.5 / 255.0),
        verdict(found[2][1] < 0.5 / 255.0),
    ));
    Ok(())
}

/// The scene with Gaussians so many times narrower and denser.
fn narrowed(scene: &Scene, by: f64) -> Subject {
    let mut subject = scene.subject.clone();
    let mut look = TransferFunction::clone(&subject.scene.transfer_function);
    for widget in &mut look.widgets {
        if let Profile::Gaussian { matrix, .. } = &mut widget.profile {
            *matrix = matrix.map(|row| row.map(|k| k * by));
            widget.extinction *= by;
        }
    }
    subject.scene.transfer_function = Arc::new(look);
    subject
}
