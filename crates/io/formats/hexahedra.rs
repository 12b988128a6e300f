//! Order of the nodes of Lagrange and Bézier hexahedra: VTK exchanged two vertical edges with version 2.1 of its XML files and 5.0
//! of its legacy ones, and some programs write the new order under an old number.

use glam::DVec3;
use rayon::prelude::*;
use voltet_core::grid::{CellSet, Cells, code};

/// Cells that one task looks at.
const CHUNK: usize = 1 << 12;

/// Brings the nodes into the present order. The version of the file decides (`is_old`), unless by the positions of the nodes its order
/// folds the cells and the other does not: then a sentence for the user says so.
pub(super) fn restore_order(
    cells: &mut Cells,
    points: &[DVec3],
    degrees: Option<&[[u8; 3]]>,
    is_old: bool,
) -> Option<String> {
    let Cells::Mixed(set) = cells else { return None };
    let is_one =
        |&cell: &usize| [code::LAGRANGE_HEXAHEDRON, code::BEZIER_HEXAHEDRON].contains(&set.types[cell]);
    let found: Vec<(usize, usize)> = (0..set.types.len())
        .filter(is_one)
        .filter_map(|cell| edges(set, cell, degrees.map(|degrees| degrees[cell])))
        .collect();
    // Each node lies nearer to its own edge's chord than to the other's: sums of squares in the present order, and exchanged.
    let (present, exchanged) = found
        .par_iter()
        .with_min_len(CHUNK)
        .map(|&edges| deviations(set, points, edges))
        .reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    // Straight cells have none; strongly curved ones some of the square of their size.
    let is_clear = |own: f64, other: f64| own > 4.0 * other;
    let (by_version, against) = if is_old { (exchanged, present) } else { (present, exchanged) };
    let is_wrong = is_clear(by_version, against);
    if is_old != is_wrong {
        for &(first, count) in &found {
            let nodes = &mut set.connectivity[first..first + 2 * count];
            let (own, other) = nodes.split_at_mut(count);
            own.swap_with_slice(other);
        }
    }
    is_wrong.then(|| {
        let order = if is_old { "since 2.1 (legacy 5.0)" } else { "before 2.1 (legacy 5.0)" };
        format!(
            "{} hexahedra of higher order would be folded by the node order of the file's version: the order {order} was taken.",
            found.len()
        )
    })
}

/// Place in the connectivity at which the nodes of the edges 10 and 11 begin, and their number on each; `None` without any.
fn edges(set: &CellSet, cell: usize, degrees: Option<[u8; 3]>) -> Option<(usize, usize)> {
    let (begin, end) = (set.offsets[cell] as usize, set.offsets[cell + 1] as usize);
    let count = end.checked_sub(begin)?;
    let [p, q, r] = match degrees {
        Some(degrees) => degrees.map(usize::from),
        None => {
            let degree = (count as f64).cbrt().round() as usize;
            [degree.checked_sub(1)?; 3]
        }
    };
    // Damage is found when the grid is built.
    let fits = (p + 1) * (q + 1) * (r + 1) == count && end <= set.connectivity.len();
    let first = 8 + 4 * (p.max(1) - 1) + 4 * (q.max(1) - 1) + 2 * (r.max(1) - 1);
    (fits && r > 1).then_some((begin + first, r - 1))
}

/// Squares of the distances of the nodes of the edges 10 and 11 from where they lie on straight edges, as shares of the squares of
/// these: in the present order, and exchanged.
fn deviations(set: &CellSet, points: &[DVec3], (first, count): (usize, usize)) -> (f64, f64) {
    let begin = set.offsets[set.offsets.partition_point(|&offset| offset as usize <= first) - 1] as usize;
    let point = |place: usize| points.get(set.connectivity[place] as usize).copied().unwrap_or(DVec3::NAN);
    let [a, b, c, d] = [2, 6, 3, 7].map(|corner| point(begin + corner));
    let size = a.distance_squared(b) + c.distance_squared(d) + a.distance_squared(c);
    let mut sums = (0.0, 0.0);
    for node in 0..count {
        let t = (node + 1) as f64 / (count + 1) as f64;
        let (own, other) = (a.lerp(b, t), c.lerp(d, t));
        let (ten, eleven) = (point(first + node), point(first + count + node));
        sums.0 += ten.distance_squared(own) + eleven.distance_squared(other);
        sums.1 += ten.distance_squared(other) + eleven.distance_squared(own);
    }
    let share = |sum: f64| if size > 0.0 && sum.is_finite() { sum / size } else { 0.0 };
    (share(sums.0), share(sums.1))
}
