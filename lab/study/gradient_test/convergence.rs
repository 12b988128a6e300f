//! Errors on finer and finer grids, and where a filter is exact.

use super::fields::{Field, JUMP, LINEAR, MATERIALS, MEETING, QUADRATIC, SMOOTH};
use super::meshes::{Mesh, Meshed};
use super::report::{Convergence, Exactness, Materials, Series};
use super::subject::{Subject, order, sizes};
use glam::DVec3;
use voltet_core::Result;
use voltet_core::grid::generate::sample;
use voltet_core::progress::Progress;

/// Orders of every smooth field on every family of grids. `step` is told of each piece of work.
pub(super) fn convergence(
    subject: &mut Subject<'_>,
    levels: &[usize],
    progress: &dyn Progress,
    step: &dyn Fn(),
) -> Result<Vec<Convergence>> {
    let mut all = Vec::new();
    for mesh in Mesh::EVERY {
        let mut series = SMOOTH.map(|_| [Series::default(), Series::default()]);
        for &count in levels {
            let meshed = mesh.grid(count);
            for (field, series) in SMOOTH.iter().zip(&mut series) {
                let Some(errors) = errors(subject, mesh, &meshed, field, progress)? else { continue };
                for (series, [root_mean_square, maximum]) in series.iter_mut().zip(errors) {
                    series.root_mean_square.push(root_mean_square);
                    series.maximum.push(maximum);
                }
            }
            step();
        }
        for (field, mut series) in SMOOTH.iter().zip(series) {
            if series[0].root_mean_square.len() != levels.len() {
                // It failed somewhere, which is noted.
                continue;
            }
            series.iter_mut().for_each(|one| one.order = order(&one.root_mean_square, levels));
            let [inside, boundary] = series;
            all.push(Convergence { mesh: mesh.name(), field: field.name, inside, boundary });
        }
    }
    Ok(all)
}

/// Root mean square and largest error inside and on the boundary, by the root mean square of the exact gradient.
fn errors(
    subject: &mut Subject<'_>,
    mesh: Mesh,
    meshed: &Meshed,
    field: &Field,
    progress: &dyn Progress,
) -> Result<Option<[[f64; 2]; 2]>> {
    let grid = &meshed.grid;
    let at = || format!("{} on the {} grid of {} points", field.name, mesh.name(), grid.points.len());
    let exact = sample(grid, field.gradient);
    let Some(found) = subject.gradient(at, grid, &sample(grid, field.value), progress)? else {
        return Ok(None);
    };
    let [scale, _] = sizes(exact.iter().map(|v| v.length()));
    let sizes_where = |boundary: bool| {
        let pairs = found.iter().zip(&exact).zip(&meshed.at_boundary).filter(|(_, at)| **at == boundary);
        sizes(pairs.map(|((a, b), _)| (*a - *b).length() / scale))
    };
    Ok(Some([sizes_where(false), sizes_where(true)]))
}

/// Errors on a linear and a quadratic field.
pub(super) fn exactness(
    subject: &mut Subject<'_>,
    progress: &dyn Progress,
    step: &dyn Fn(),
) -> Result<Vec<Exactness>> {
    let mut all = Vec::new();
    for mesh in Mesh::EVERY {
        let meshed = mesh.grid(EXACT_AT);
        let linear = largest(subject, mesh, &meshed, &LINEAR, progress)?;
        let quadratic = largest(subject, mesh, &meshed, &QUADRATIC, progress)?;
        step();
        if let (Some(linear), Some([quadratic_inside, quadratic_boundary])) = (linear, quadratic) {
            let linear = linear[0].max(linear[1]);
            all.push(Exactness { mesh: mesh.name(), linear, quadratic_inside, quadratic_boundary });
        }
    }
    Ok(all)
}

/// Boxes a side of the grid for exactness.
const EXACT_AT: usize = 8;

/// The largest error inside and on the boundary, by the largest gradient.
fn largest(
    subject: &mut Subject<'_>,
    mesh: Mesh,
    meshed: &Meshed,
    field: &Field,
    progress: &dyn Progress,
) -> Result<Option<[f64; 2]>> {
    let found = errors(subject, mesh, meshed, field, progress)?;
    let [scale, most] = sizes(meshed.grid.points.iter().map(|&p| (field.gradient)(p).length()));
    Ok(found.map(|each| each.map(|[_, maximum]| maximum * scale / most)))
}

/// Two materials that meet in a plane of the regular grid.
pub(super) fn materials(
    subject: &mut Subject<'_>,
    levels: &[usize],
    progress: &dyn Progress,
    step: &dyn Fn(),
) -> Result<Option<Materials>> {
    let mut found = Materials { beyond: Vec::new(), order: None, reach: 0, overshoot: 0.0 };
    for &count in levels {
        // The plane is one of the grid's.
        let count = count + count % 2;
        let Meshed { grid, .. } = Mesh::Regular.grid(count);
        let at = || format!("two materials on the regular grid of {} points", grid.points.len());
        let Some(vectors) = subject.gradient(at, &grid, &sample(&grid, MATERIALS.value), progress)? else {
            return Ok(None);
        };
        let cells_off = |p: DVec3| ((p.x - MEETING) * count as f64).abs().round() as usize;
        let error = |(p, v): (&DVec3, &DVec3)| (*v - (MATERIALS.gradient)(*p)).length() / JUMP;
        let pairs = || grid.points.iter().zip(&vectors);
        found.beyond.push(pairs().filter(|(p, _)| cells_off(**p) > NEAR).map(error).fold(0.0, f64::max));
        // Those of the finest stay. In the plane itself either slope is right.
        let far = pairs().filter(|(p, _)| cells_off(**p) > 0).filter(|pair| error(*pair) > NOTICED);
        found.reach = far.map(|(p, _)| cells_off(*p)).max().unwrap_or(0);
        let beyond = |v: &DVec3| (v.x - (1.0 + JUMP)).max(1.0 - v.x).max(0.0) / JUMP;
        found.overshoot = vectors.iter().map(beyond).fold(0.0, f64::max);
        step();
    }
    found.order = order(&found.beyond, levels);
    Ok(Some(found))
}

/// Cells on either side of the meeting of materials that are not asked to converge.
const NEAR: usize = 2;
/// Share of the jump from which an error counts as reached by it.
const NOTICED: f64 = 0.01;
