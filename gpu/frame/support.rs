//! Where widgets lie, in slabs low ≤ a s + b g ≤ high of stored values, for the device to leave out the cells that none
//! touches.
//!
//! A cell is kept if for some support its corners reach every slab. That is less sharp than the native engine's hulls,
//! and as safe: what is left out adds less than 1e-7 of optical depth along the grid's diagonal.

use voltet_core::transfer::{ControlPoint, Profile, Region, TransferFunction, Widget};
use voltet_shaders::Axis;

/// Optical depth that all cells left out together may have along the longest ray.
const DEPTH_LEFT_OUT: f64 = 1e-7;

/// Room for the rounding of stored values and of the slabs themselves, in units of a value's span: 32 bits leave 1e-7.
const SLACK: f64 = 1e-6;

/// low ≤ a s + b g ≤ high, in the transfer function's values.
struct Slab {
    normal: [f64; 2],
    low: f64,
    high: f64,
}

/// The supports of a transfer function as the shader reads them: where each one's slabs begin and the last one's end,
/// then four numbers a slab. And how many supports there are.
pub(crate) fn supports(transfer_function: &TransferFunction, axes: &[Axis], length: f64) -> (Vec<u32>, u32) {
    let share = DEPTH_LEFT_OUT / transfer_function.widgets.len().max(1) as f64;
    let cutoff = transfer_function.model.cutoff();
    let mut supports: Vec<Vec<Slab>> = Vec::new();
    for widget in &transfer_function.widgets {
        let depth = length / transfer_function.unit_distance * widget.extinction;
        let reach = Reach::new(depth / share, cutoff);
        let region = || widget.region.iter().flat_map(edges);
        for shape in shapes(widget, reach) {
            supports.push(shape.into_iter().chain(region()).collect());
        }
    }
    let (mut starts, mut numbers) = (vec![0u32], Vec::new());
    for slabs in &supports {
        numbers.extend(slabs.iter().flat_map(|slab| stored(slab, axes)));
        starts.push(numbers.len() as u32 / 4);
    }
    let count = supports.len() as u32;
    starts.extend(numbers.iter().map(|x: &f32| x.to_bits()));
    (starts, count)
}

/// Squared distance, in widths, at which a profile exp(−r²) no longer counts.
#[derive(Clone, Copy)]
enum Reach {
    Nowhere,
    Within(f64),
    Everywhere,
}

impl Reach {
    fn new(ratio: f64, cutoff: Option<f64>) -> Reach {
        let absorbs = if ratio > 1.0 { ratio.ln() } else { 0.0 };
        match cutoff {
            _ if ratio <= 0.0 => Reach::Nowhere,
            Some(cutoff) if cutoff <= 0.0 => Reach::Everywhere,
            Some(cutoff) => Reach::Within(absorbs.max(-cutoff.ln())),
            None if ratio <= 1.0 => Reach::Nowhere,
            None => Reach::Within(absorbs),
        }
    }
}

/// The slabs of a profile; several lists where its support has several parts, none where it has none.
fn shapes(widget: &Widget, reach: Reach) -> Vec<Vec<Slab>> {
    if let Profile::PiecewiseLinear { points } = &widget.profile {
        return lit_runs(points);
    }
    let distance = match reach {
        Reach::Nowhere => return Vec::new(),
        Reach::Everywhere => return vec![Vec::new()],
        Reach::Within(square) => square.sqrt(),
    };
    let slabs = match &widget.profile {
        Profile::Gaussian { centre, matrix } => {
            let row = |row: &[f64; 2]| {
                let middle = row[0] * centre[0] + row[1] * centre[1];
                Slab { normal: *row, low: middle - distance, high: middle + distance }
            };
            matrix.iter().filter(|row| **row != [0.0; 2]).map(row).collect()
        }
        Profile::TriangularGaussian { centre, sigma } => {
            let width = distance * sigma;
            vec![
                Slab { normal: [1.0, -width], low: f64::NEG_INFINITY, high: *centre },
                Slab { normal: [1.0, width], low: *centre, high: f64::INFINITY },
            ]
        }
        Profile::Table(table) => vec![
            Slab { normal: [1.0, 0.0], low: table.s[0], high: table.s[1] },
            Slab { normal: [0.0, 1.0], low: table.g[0], high: table.g[1] },
        ],
        _ => Vec::new(),
    };
    vec![slabs]
}

/// The ranges of s in which a function of control points absorbs.
fn lit_runs(points: &[ControlPoint]) -> Vec<Vec<Slab>> {
    let lit = |k: usize| points.get(k).is_some_and(|point| point.extinction > 0.0);
    let mut runs = Vec::new();
    let mut k = 0;
    while k < points.len() {
        if !lit(k) {
            k += 1;
            continue;
        }
        let first = k;
        while lit(k) {
            k += 1;
        }
        // Extinction falls to 0 at the neighbour, or stays beyond the ends.
        let low = if first == 0 { f64::NEG_INFINITY } else { points[first - 1].s };
        let high = points.get(k).map_or(f64::INFINITY, |point| point.s);
        runs.push(vec![Slab { normal: [1.0, 0.0], low, high }]);
    }
    runs
}

/// The edges of a region as half-planes.
fn edges(region: &Region) -> Vec<Slab> {
    let corners = &region.corners;
    let range = |axis: usize| {
        corners
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(c[axis]), high.max(c[axis])])
    };
    let [s, g] = [range(0), range(1)];
    // Its box; where it is no rectangle also its edges.
    let mut slabs = vec![Slab { normal: [1.0, 0.0], low: s[0], high: s[1] }];
    if region.depends_on_g() {
        slabs.push(Slab { normal: [0.0, 1.0], low: g[0], high: g[1] });
    }
    if corners.iter().flatten().all(|x| x.is_finite()) {
        for (k, a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let normal = [a[1] - b[1], b[0] - a[0]];
            let at = |c: &[f64; 2]| normal[0] * c[0] + normal[1] * c[1];
            let [low, high] = corners
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(at(c)), high.max(at(c))]);
            if normal != [0.0; 2] {
                slabs.push(Slab { normal, low, high });
            }
        }
    }
    slabs
}

/// A slab in stored values, widened by what rounding can do.
fn stored(slab: &Slab, axes: &[Axis]) -> [f32; 4] {
    let Slab { normal, low, high } = slab;
    let [a, b] = [0, 1].map(|k| normal[k] * axes[k].scale);
    let largest = a.abs().max(b.abs());
    if largest == 0.0 || !largest.is_finite() {
        return [0.0, 0.0, -1.0, 1.0];
    }
    let moved = |k: usize| if normal[k] == 0.0 { 0.0 } else { normal[k] * axes[k].offset };
    let offset = moved(0) + moved(1);
    // What cancels here lost digits of the offset: they widen the slab.
    let slack = SLACK + 4.0 * f64::EPSILON * (moved(0).abs() + moved(1).abs()) / largest;
    let bound = |x: f64, sign: f64| {
        let x = (x - offset) / largest + sign * slack;
        (x + sign * SLACK * x.abs()).clamp(-1e30, 1e30) as f32
    };
    [(a / largest) as f32, (b / largest) as f32, bound(*low, -1.0), bound(*high, 1.0)]
}
