//! Writes small PLOT3D files.

use super::xml::Values;

/// One way to write a binary file.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Most significant byte first.
    pub big_endian: bool,
    /// Each record between its lengths, as Fortran writes them.
    pub marks: bool,
    /// The number of grids first.
    pub counted: bool,
    /// 64-bit numbers.
    pub double: bool,
    /// A flag a point.
    pub blanking: bool,
}

/// Every combination.
pub fn layouts() -> impl Iterator<Item = Layout> {
    (0..32).map(|bits: u32| Layout {
        big_endian: bits & 1 != 0,
        marks: bits & 2 != 0,
        counted: bits & 4 != 0,
        double: bits & 8 != 0,
        blanking: bits & 16 != 0,
    })
}

/// A record of parts, between marks where there are some.
fn record(out: &mut Vec<u8>, layout: Layout, parts: &[Values]) {
    let bytes: Vec<u8> = parts.iter().flat_map(|part| part.bytes(layout.big_endian)).collect();
    let mark = Values::new("UInt32", [bytes.len() as f64]).bytes(layout.big_endian);
    let mark = if layout.marks { &mark[..] } else { &[] };
    out.extend([mark, &bytes, mark].concat());
}

/// The grids: 4 × 3 × 2 points, and (with a count) a second one of 2 × 2 × 3 beside it.
const GRIDS: [[usize; 3]; 2] = [[4, 3, 2], [2, 2, 3]];

/// Their dimensions.
pub fn grids(layout: Layout) -> &'static [[usize; 3]] {
    if layout.counted { &GRIDS } else { &GRIDS[..1] }
}

fn head(layout: Layout) -> Vec<u8> {
    let mut out = Vec::new();
    let grids = grids(layout);
    if layout.counted {
        record(&mut out, layout, &[Values::new("Int32", [grids.len() as f64])]);
    }
    record(&mut out, layout, &[Values::new("Int32", grids.iter().flatten().map(|&n| n as f64))]);
    out
}

/// Position of point `n` of grid `g`.
pub fn position(g: usize, [nx, ny, _]: [usize; 3], n: usize) -> [f64; 3] {
    [(10 * g + n % nx) as f64, (n / nx % ny) as f64 * 0.5, (n / (nx * ny)) as f64 * 2.0]
}

/// The points.
pub fn grid_file(layout: Layout) -> Vec<u8> {
    let mut out = head(layout);
    let float = if layout.double { "Float64" } else { "Float32" };
    for (g, &size) in grids(layout).iter().enumerate() {
        let count: usize = size.iter().product();
        let mut parts: Vec<Values> =
            (0..3).map(|axis| Values::new(float, (0..count).map(|n| position(g, size, n)[axis]))).collect();
        if layout.blanking {
            // The first point is outside the flow, the last one touches another grid.
            let flag = |n| {
                if n == 0 {
                    0.0
                } else if n == count - 1 {
                    -2.0
                } else {
                    1.0
                }
            };
            parts.push(Values::new("Int32", (0..count).map(flag)));
        }
        record(&mut out, layout, &parts);
    }
    out
}

/// Five quantities a point.
pub fn solution_file(layout: Layout) -> Vec<u8> {
    let mut out = head(layout);
    let float = if layout.double { "Float64" } else { "Float32" };
    for &size in grids(layout) {
        let count: usize = size.iter().product();
        record(&mut out, layout, &[Values::new(float, [0.5, 0.0, 1e5, 0.0])]);
        let plane =
            |q: usize| Values::new(float, (0..count).map(move |n| if q == 0 { 2.0 } else { (n + q) as f64 }));
        record(&mut out, layout, &[plane(0), plane(1), plane(2), plane(3), plane(40)]);
    }
    out
}
