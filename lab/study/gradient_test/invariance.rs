//! Changes without effect on a gradient: position, orientation and size of the grid, and how its points and cells are
//! numbered, what is added to the scalar, and in which units it is.

use super::fields::SMOOTH;
use super::meshes::{Mesh, turn};
use super::report::Invariance;
use super::subject::{Subject, sizes};
use glam::DVec3;
use voltet_core::Result;
use voltet_core::SharedSlice;
use voltet_core::grid::Grid;
use voltet_core::grid::generate::{Random, sample};
use voltet_core::progress::Progress;

/// Boxes a side.
const COUNT: usize = 8;

/// Offset of the grid, in its own sides.
const FAR: DVec3 = DVec3::new(1000.3, -2000.7, 500.1);
/// By which it grows.
const LARGER: f64 = 1e4;
/// Offset of the scalar, in its own ranges.
const ADDED: f64 = 1e4;
/// Factor of the scalar.
const TIMES: f64 = -1e-6;

/// Differences after each change, brought back; all relative to the largest gradient.
pub(super) fn invariance(
    subject: &mut Subject<'_>,
    progress: &dyn Progress,
    step: &dyn Fn(),
) -> Result<Vec<Invariance>> {
    let grid = Mesh::Distorted.grid(COUNT).grid;
    let scalar = sample(&grid, SMOOTH[0].value);
    let usual = subject.gradient(|| "the grid of invariance".into(), &grid, &scalar, progress)?;
    let Some(usual) = usual else { return Ok(Vec::new()) };
    let [_, scale] = sizes(usual.iter().map(|v| v.length()));
    let [_, reach] = sizes(FAR.to_array().into_iter());
    let moved = |place: &dyn Fn(DVec3) -> DVec3| Grid {
        points: SharedSlice::from(grid.points.iter().map(|&p| place(p)).collect::<Vec<_>>()),
        ..grid.clone()
    };
    let with = |change: &dyn Fn(f64) -> f64| scalar.iter().map(|&s| change(s)).collect::<Vec<f64>>();
    let (turn, spacing) = (turn(), 1.0 / COUNT as f64);
    let numbering = Numbering::new(&grid);
    let other = |s: &[f64]| numbering.to.iter().map(|&old| s[old]).collect::<Vec<f64>>();
    // What was changed, the grid and the scalar afterwards, how a vector is brought back, and what rounding of positions and
    // values by 2⁻⁵³ may make of it over one spacing.
    type Back<'a> = &'a dyn Fn(DVec3) -> DVec3;
    let changes: [(&'static str, Grid, Vec<f64>, Back<'_>, f64); 6] = [
        ("translation", moved(&|p| p + FAR), scalar.clone(), &|v| v, reach / spacing),
        ("rotation", moved(&|p| turn * p), scalar.clone(), &|v| turn.transpose() * v, 1.0 / spacing),
        ("scaling of space", moved(&|p| p * LARGER), scalar.clone(), &|v| v * LARGER, 1.0 / spacing),
        ("a constant added", grid.clone(), with(&|s| s + ADDED), &|v| v, ADDED / spacing),
        ("scaling of the scalar", grid.clone(), with(&|s| s * TIMES), &|v| v / TIMES, 1.0 / spacing),
        ("numbering", numbering.grid.clone(), other(&scalar), &|v| v, 1.0 / spacing),
    ];
    let mut all = Vec::new();
    for (under, grid, scalar, back, loss) in changes {
        let found = subject.gradient(|| under.into(), &grid, &scalar, progress)?;
        step();
        let Some(mut found) = found else { continue };
        if under == "numbering" {
            found = numbering.back(&found);
        }
        let pairs = found.iter().zip(&usual).map(|(v, w)| (back(*v) - *w).length() / scale);
        let [_, difference] = sizes(pairs);
        all.push(Invariance { under, difference, rounding: ROUNDINGS * f64::EPSILON * loss });
    }
    Ok(all)
}

/// Roundings that a reconstruction may take one after the other, with the condition of its matrices.
const ROUNDINGS: f64 = 300.0;

/// Grid with its points and cells in another order, and the corners of cells turned.
struct Numbering {
    grid: Grid,
    /// The old number of each new point.
    to: Vec<usize>,
}

impl Numbering {
    fn new(grid: &Grid) -> Numbering {
        let mut random = Random(0x5DEE_CE66_D1CE_5EED);
        let mut shuffled = |count: usize| {
            let mut order: Vec<usize> = (0..count).collect();
            (1..count).rev().for_each(|k| order.swap(k, (random.next() * (k + 1) as f64) as usize));
            order
        };
        let (to, cells) = (shuffled(grid.points.len()), shuffled(grid.tetrahedra.len()));
        let mut from = vec![0u32; to.len()];
        to.iter().enumerate().for_each(|(new, &old)| from[old] = new as u32);
        // A cyclic change of three corners keeps a cell's handedness.
        let turned = |[a, b, c, d]: [u32; 4]| [b, c, a, d].map(|p| from[p as usize]);
        let tetrahedra = cells.iter().map(|&cell| turned(grid.tetrahedra[cell])).collect();
        let points = to.iter().map(|&old| grid.points[old]).collect();
        let grid = Grid { points, tetrahedra, ..grid.clone() };
        Numbering { grid, to }
    }

    fn back(&self, vectors: &[DVec3]) -> Vec<DVec3> {
        let mut found = vec![DVec3::ZERO; vectors.len()];
        self.to.iter().zip(vectors).for_each(|(&old, &v)| found[old] = v);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_numbering_is_the_same_grid() {
        let grid = Mesh::Distorted.grid(3).grid;
        let other = Numbering::new(&grid);
        assert_ne!(other.grid.points, grid.points);
        assert_eq!(other.back(&other.grid.points), *grid.points);
        let volume = |grid: &Grid| -> f64 {
            let corners = |t: &[u32; 4]| t.map(|p| grid.points[p as usize]);
            grid.tetrahedra.iter().map(|t| voltet_core::grid::tetrahedron_volume(corners(t))).sum()
        };
        assert!((volume(&other.grid) - volume(&grid)).abs() < 1e-12);
    }
}
