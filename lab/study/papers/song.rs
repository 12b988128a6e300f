//! Y. Song, W. Chen, R. Maciejewski, K. Gaither, D. Ebert, "Bivariate transfer functions on unstructured grids", 2009.

use super::bench::Bench;
use crate::papers::bench::*;
use crate::work_precision::Subject;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::extent;
use voltet_core::transfer::{ControlPoint, Profile, TransferFunction, Widget};
use voltet_integrators::{DEFAULT_SIDE, segments};
use voltet_optics::shading::Integrator;

/// The paper's approximation: ten samples a ray segment.
const APPROXIMATE: Integrator = segments(10, DEFAULT_SIDE);

/// A row of Table 1: the data, tetrahedra, frames a second in one dimension, bivariate in closed form and approximated; and how many
/// hexahedra of the field by formula make as many tetrahedra, where the data are not there.
struct Printed(&'static str, u64, [f64; 3], Option<[u64; 3]>);

const TABLE_1: [Printed; 6] = [
    Printed("Blunt fin", 224_874, [1.27, 0.16, 0.91], Some([34, 33, 33])),
    Printed("Heat sink", 121_668, [1.91, 0.23, 1.00], None),
    Printed("Cylinder", 762_048, [0.42, 0.07, 0.36], Some([50, 50, 51])),
    Printed("M6 wing", 287_962, [1.27, 0.11, 1.27], Some([36, 36, 37])),
    Printed("X38", 1_943_483, [0.18, 0.04, 0.18], Some([69, 69, 68])),
    Printed("Delta wing", 3_853_502, [0.08, 0.03, 0.07], Some([86, 86, 87])),
];

pub(super) fn section(bench: &Bench) -> Result<Section> {
    let mut section = Section::new(Paper::Song, "Song et al. 2009: bivariate transfer functions");
    section.say(
        "Of the paper's data only a heat sink is there, and it is another one (214,020 tetrahedra, computed for this project); the \
         field by formula of VTK's \"Wavelet\", on as many tetrahedra, stands in for the others, and the blunt fin is taken where \
         `--data` names a folder that has it. Frames a second cannot be compared, their ratios can. The paper's light is \
         premultiplied by no extinction (constant-emitter); here Table 1 and Figure 7 take the density-emitter.",
    );
    table_1(bench, &mut section)?;
    figures(bench, &mut section)?;
    Ok(section)
}

fn table_1(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Table 1: frames a second, 512²");
    let (mut rows, mut ratios) = (Vec::new(), Vec::new());
    for Printed(name, cells, printed, hexahedra) in TABLE_1 {
        let frames = printed.map(number).to_vec();
        let printed_ratio = number(printed[2] / printed[1]);
        let Some(mut subject) = subject(bench, name, hexahedra)? else {
            let left = format!("{name} ({cells}): not run, more than `--most-cells`");
            let nothing = vec!["–".to_string(); 3];
            rows.push([vec![left], frames, nothing, vec![printed_ratio, "–".into()]].concat());
            continue;
        };
        subject.scene.camera.size = [512; 2];
        let mut one = subject.clone();
        one.scene.transfer_function = Arc::new(ramp(&subject));
        let ms = |subject, integrator| Ok(bench.measured(subject, integrator)?.1.frame.median_ms);
        let found: [Result<f64>; 3] =
            [ms(&one, Integrator::ANALYTIC), ms(&subject, Integrator::ANALYTIC), ms(&subject, APPROXIMATE)];
        let found = found.into_iter().collect::<Result<Vec<f64>>>()?;
        ratios.push(found[1] / found[2]);
        let grid = &subject.scene.volume.grid;
        let by_formula = hexahedra.is_some() && grid.scalar_name == "wavelet";
        let data = if by_formula { "by formula" } else { "itself or alike" };
        let name = format!("{name} ({cells}); here {}, {data}", grid.tetrahedra.len());
        let here = found.iter().map(|ms| number(1e3 / ms)).collect();
        rows.push([vec![name], frames, here, vec![printed_ratio, number(found[1] / found[2])]].concat());
    }
    section.table(
        &[
            "data (tetrahedra)",
            "printed: 1-D",
            "2-D closed",
            "2-D approximated",
            "here: 1-D",
            "2-D closed",
            "2-D approximated",
            "printed: approximated by closed",
            "here",
        ],
        &rows,
    );
    let faster = ratios.iter().all(|ratio| *ratio > 1.0);
    section.say(&format!(
        "\"The approximated mode performs much faster than the analytical one\": {}: with erf in place of long fragment programs it \
         is {} times as fast here.",
        verdict(faster),
        span(&ratios),
    ));
    Ok(())
}

/// The scene of a row of Table 1, if it may be run.
fn subject(bench: &Bench, name: &str, hexahedra: Option<[u64; 3]>) -> Result<Option<Subject>> {
    let fin =
        bench.wish.data.as_ref().map(|folder| folder.join("bluntfin.vtu")).filter(|path| path.is_file());
    match (hexahedra, fin) {
        (Some(_), Some(path)) if name == "Blunt fin" => {
            let options = [
                format!("grid.path={:?}", path.display().to_string()),
                "grid.scalar=\"density\"".into(),
                "view.eye=[-12.0314, -30.8182, 24.7259]".into(),
                "view.target=[3.2732, 4.1638, 2.8621]".into(),
            ];
            (bench.open)("song_gaussian.toml", &options).map(Some)
        }
        (Some(counts), _) if 6 * counts.iter().product::<u64>() > bench.wish.max_cells => Ok(None),
        (Some(counts), _) => {
            (bench.open)("song_table.toml", &[format!("grid.resolution={counts:?}")]).map(Some)
        }
        (None, _) => (bench.open)("song_gaussian.toml", &[]).map(Some),
    }
}

/// A piecewise-linear function over the scalar's range, about as opaque as the scene's own.
fn ramp(subject: &Subject) -> TransferFunction {
    let [low, high] = extent::range(&subject.scene.volume.scalar).unwrap_or_default();
    let own = &subject.scene.transfer_function;
    let peak = own.widgets.iter().map(|widget| widget.extinction).fold(0.0, f64::max);
    let point = |share: f64, color, extinction: f64| ControlPoint {
        s: low + share * (high - low),
        color,
        extinction: extinction * peak,
    };
    let points = vec![
        point(0.0, [0.1, 0.2, 0.9], 0.0),
        point(0.25, [0.1, 0.8, 0.9], 0.1),
        point(0.5, [0.2, 0.8, 0.2], 0.4),
        point(0.75, [0.9, 0.8, 0.1], 0.2),
        point(1.0, [0.9, 0.1, 0.1], 1.0),
    ];
    let profile = Profile::PiecewiseLinear { points };
    let widget = Widget { profile, color: [0.0; 3], extinction: 0.0, region: None };
    TransferFunction { widgets: vec![widget], ..TransferFunction::clone(own) }
}

fn figures(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Figures");
    let side = 128;
    let band = |x: f64| 1.0 - (2.0 * (x * 4.0).fract() - 1.0).abs();
    let widgets = [
        square(side, |s, g| ([0.3, 0.6, 1.0], f64::from((0.3..0.7).contains(&s) && (0.3..0.7).contains(&g)))),
        square(side, |s, g| ([0.3, 0.6, 1.0], gaussian(s, 0.5, 0.2) * gaussian(g, 0.5, 0.2))),
        square(side, |s, _| ([0.3, 0.6, 1.0], band(s))),
        square(side, |s, _| ([0.3, 0.6, 1.0], (std::f64::consts::PI * 4.0 * s).sin().abs())),
    ];
    let white = widgets.each_ref().map(|picture| (picture, [1.0; 3]));
    section.figure(
        "figure_1",
        "Figure 1: the widgets over s (to the right) and g: uniform, Gaussian, triangle wave, sine wave",
        &white,
    )?;
    for (name, caption, files) in [
        (
            "figure_2",
            "Figure 2, blunt fin there, heat sink here: one dimension, and two",
            ["../quickstart_1d.toml", "../quickstart.toml"],
        ),
        ("figure_5", "Figure 5: uniform and Gaussian", ["song_uniform.toml", "song_gaussian.toml"]),
        (
            "figure_6",
            "Figure 6: triangle wave without light, sine wave with light",
            ["song_triangle.toml", "song_sine.toml"],
        ),
        (
            "figure_8",
            "Figure 8: bands of the scalar alone, and bands within a region of s and g",
            ["song_bands_1d.toml", "song_sine.toml"],
        ),
        (
            "figure_9",
            "Figure 9: triangle wave, and the same with silhouettes",
            ["song_triangle.toml", "song_silhouette.toml"],
        ),
    ] {
        let draw = |file| -> Result<_> {
            let subject = bench.sized(file)?;
            Ok((bench.measured(&subject, Integrator::ANALYTIC)?.0, subject.background))
        };
        let [(left, background), (right, other)] = [draw(files[0])?, draw(files[1])?];
        section.figure(name, caption, &[(&left, background), (&right, other)])?;
    }
    section.part("Figure 7, and pictures in equal time");
    let mut rows = Vec::new();
    for file in ["song_gaussian.toml", "song_triangle.toml"] {
        let scene = bench.scene(file)?;
        let closed = bench.shot(&scene, Integrator::ANALYTIC)?;
        let ten = bench.shot(&scene, APPROXIMATE)?;
        let with = |count| segments(count, DEFAULT_SIDE);
        let (count, equal) = bench.in_equal_time(&scene, closed.ms, with)?;
        if file == "song_gaussian.toml" {
            let caption = "Figure 7: closed form (left), ten samples a segment (right)";
            section.figure("figure_7", caption, &[closed.panel(), ten.panel()])?;
        } else {
            let caption = format!(
                "In equal time, or one where even that takes longer: closed form (left), samples a segment: {count} (right)"
            );
            section.figure("equal_time", &caption, &[closed.panel(), equal.panel()])?;
        }
        for (way, shot) in [
            ("closed form".into(), &closed),
            ("10 samples".into(), &ten),
            (format!("in equal time: {count} a segment"), &equal),
        ] {
            rows.push(shot.row(&[&format!("{}, {way}", file.trim_end_matches(".toml"))]));
        }
    }
    section.table(&["scene, way", "ms", "rms error", "largest error", "pixels over 1/255"], &rows);
    section.say(
        "Printed: \"theoretically, this mode [closed form] yields better quality\", and \"both schemes perform well\" with ten samples \
         and a Gaussian. Where even one sample a segment takes longer than the closed form, one is what is drawn in equal time.",
    );
    Ok(())
}
