//! K. Moreland, "Fast high accuracy volume rendering", dissertation, 2004: adaptive transfer function sampling.

use super::bench::Bench;
use crate::papers::bench::*;
use voltet_core::Result;
use voltet_integrators::{DEFAULT_OVERSAMPLING, DEFAULT_SIDE, VERTEX_SAMPLED, pre_integrated, segments};
use voltet_optics::shading::Integrator;

pub(super) fn section(bench: &Bench) -> Result<Section> {
    let mut section = Section::new(Paper::Moreland, "Moreland 2004: adaptive transfer function sampling");
    section.say(
        "The paper's blunt fin is replaced by a field by formula on 16³ hexahedra (`moreland_surface.toml`), with a transition of \
         opacity over a two-hundredth of its range. Which cells miss it can be compared, not the picture.",
    );
    let scene = bench.scene("moreland_surface.toml")?;
    let tabled = pre_integrated(DEFAULT_SIDE, DEFAULT_OVERSAMPLING);
    let ways = [
        ("(a) sampled at the vertices, linear between: \"a blocky, blurry mess\"", VERTEX_SAMPLED),
        ("(b) cut at the control points: \"removes any error\" of sampling", Integrator::ANALYTIC),
        ("sampled at the ends of each segment", segments(1, DEFAULT_SIDE)),
        ("pre-integrated, 256³: \"the accuracy of pre-integration is low\"", tabled),
    ];
    let shots = ways.iter().map(|way| bench.shot(&scene, way.1)).collect::<Result<Vec<_>>>()?;
    section.part("Figure 1.1");
    section.figure(
        "figure_1_1",
        "Figure 1.1: left (a) the transfer function at the vertices alone, right (b) clipped at its control points",
        &[shots[0].panel(), shots[1].panel()],
    )?;
    let rows: Vec<_> = ways.iter().zip(&shots).map(|((what, _), shot)| shot.row(&[what])).collect();
    section.table(&["printed", "here: ms", "rms error", "largest error", "pixels over 1/255"], &rows);
    let [vertices, clipped, _, table] = &shots[..] else { return Ok(section) };
    section.say(&format!(
        "Found: (a) is off by {:.2} of full scale at worst; (b) by {:.0e}, which is the rounding of 32 bits: the claim {}. The table \
         of 256³ is off by {:.2} at worst, {} (b): {}.",
        vertices.errors.maximum,
        clipped.errors.maximum,
        verdict(clipped.errors.maximum < 1e-3),
        table.errors.maximum,
        if table.errors.maximum > 10.0 * clipped.errors.maximum { "far more than" } else { "about as" },
        verdict(table.errors.maximum > 10.0 * clipped.errors.maximum),
    ));
    Ok(section)
}
