//! Shapes of widgets in the plane.

/// What its profile is.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    /// Its middle and its two half axes at one standard deviation; an infinite one ignores its axis.
    Gaussian { centre: [f64; 2], axes: [[f64; 2]; 2] },
    /// Its s, and its width in s a unit of g; or a field and the magnitude of its gradients.
    Triangular { centre: f64, sigma: f64 },
    /// Bands: where the wave is 0, the direction across (degrees), factors on the axes, distance, share that is kept.
    Wave { origin: [f64; 2], angle: f64, scale: [f64; 2], period: f64, band_width: f64 },
    /// [s, r, g, b, extinction] each.
    Points(Vec<[f64; 5]>),
    /// A picture over ranges of s and g.
    Table { s: [f64; 2], g: [f64; 2] },
    /// The same everywhere in its region.
    Uniform,
    /// Along other axes, or with numbers that are not known yet.
    Elsewhere,
}

/// Where a widget is not 0.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Region {
    Whole,
    /// Ranges of s and g; infinite ones are no limit.
    Box([[f64; 2]; 2]),
    Polygon(Vec<[f64; 2]>),
}

/// What the metric of a Gaussian, exp(−p x² − 2 r x y − q y²), has for half axes: at right angles in the plane where both extents
/// are as long.
pub(super) fn half_axes([p, r, q]: [f64; 3], extent: [f64; 2]) -> [[f64; 2]; 2] {
    let (p, r, q) = (p * extent[0] * extent[0], r * extent[0] * extent[1], q * extent[1] * extent[1]);
    let (sin, cos) = (0.5 * (2.0 * r).atan2(p - q)).sin_cos();
    let (sin, cos) = if r == 0.0 { (0.0, 1.0) } else { (sin, cos) };
    let length = |x: f64, y: f64| (0.5 / (p * x * x + 2.0 * r * x * y + q * y * y).max(0.0)).sqrt();
    // An infinite length along an axis keeps the other number at 0.
    let axis = |x: f64, y: f64| {
        let length = length(x, y);
        [(x, extent[0]), (y, extent[1])]
            .map(|(part, extent)| if part == 0.0 { 0.0 } else { part * length * extent })
    };
    [axis(cos, sin), axis(-sin, cos)]
}

/// p, r, q of |K v|² along two columns of K; 0 along one that it does not have.
pub(super) fn metric(k: &[Vec<f64>], columns: [Option<usize>; 2]) -> [f64; 3] {
    let of = |row: &Vec<f64>, column: Option<usize>| column.and_then(|c| row.get(c).copied()).unwrap_or(0.0);
    let product = |a: usize, b: usize| k.iter().map(|row| of(row, columns[a]) * of(row, columns[b])).sum();
    [product(0, 0), product(0, 1), product(1, 1)]
}
