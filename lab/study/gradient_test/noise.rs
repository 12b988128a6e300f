//! Gradients of noise: independent, of variance 1 at every point.

use super::meshes::{Mesh, Meshed};
use super::report::Noise;
use super::subject::{Subject, sizes};
use voltet_core::Result;
use voltet_core::grid::generate::Random;
use voltet_core::progress::Progress;

/// Boxes a side.
const COUNT: usize = 16;

/// Gradients of noise, by the spacing along the axes before the grid is deformed.
pub(super) fn noise(
    subject: &mut Subject<'_>,
    progress: &dyn Progress,
    step: &dyn Fn(),
) -> Result<Vec<Noise>> {
    let mut all = Vec::new();
    for mesh in [Mesh::Regular, Mesh::Distorted] {
        let Meshed { grid, at_boundary } = mesh.grid(COUNT);
        let mut random = Random(0x2545_F491_4F6C_DD1D);
        // Uniform, of variance 1.
        let values: Vec<f64> =
            grid.points.iter().map(|_| (2.0 * random.next() - 1.0) * 3f64.sqrt()).collect();
        let found =
            subject.gradient(|| format!("noise on the {} grid", mesh.name()), &grid, &values, progress)?;
        step();
        let Some(found) = found else { continue };
        let size = |boundary: bool| {
            let there = found.iter().zip(&at_boundary).filter(|(_, at)| **at == boundary);
            sizes(there.map(|(v, _)| v.length()))[0] / COUNT as f64
        };
        all.push(Noise { mesh: mesh.name(), inside: size(false), boundary: size(true) });
    }
    Ok(all)
}
