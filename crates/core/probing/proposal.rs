//! A first transfer function over (s, g), found from the data's own histogram.
//!
//! A bin of volume V at gradient magnitude g holds level surfaces of area V g per unit of s (the coarea formula; Scheidegger,
//! Schreiner, Duffy, Carr and Silva 2008, "Revisiting histograms and isosurface statistics"). So V g says how much boundary
//! there is in each bin, where V alone says how much of everything, and is mostly surroundings. Boundaries are divided by s
//! into parts of equal area, and each part gets a Gaussian at the mean of its bins with their deviations (Kniss et al. 2003):
//! it stands above the quiet stretches
//! of the same s, which no function of s alone can leave out.

use super::Histogram;

/// One Gaussian of a proposal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedWidget {
    /// [s, g].
    pub centre: [f64; 2],
    /// Standard deviations along s and g, > 0.
    pub sigma: [f64; 2],
    /// Extinction per world unit.
    pub extinction: f64,
}

/// Shares of volume and of boundaries that are left out: the quietest, where surroundings and noise lie.
const QUIET: [f64; 2] = [0.5, 0.2];

/// Deviations of a Gaussian, as shares of those of its bins along s and g: along s they should not run into each other.
const NARROWER: [f64; 2] = [0.6, 1.0];

/// Least deviation, in bins: what the histogram resolves.
const MIN_BINS: f64 = 1.0;

/// Optical depth of a ray through what a Gaussian holds: 63 % of the light is taken.
const DEPTH: f64 = 1.0;

/// The gradient magnitude under which the data are quiet: half of the volume, or a fifth of the boundaries where that is more.
pub fn quiet(histogram: &Histogram) -> f64 {
    let bins = ColumnSums::new(histogram);
    let row = |j: usize, of: &dyn Fn(usize, usize) -> f64| (0..bins.wide).map(|i| of(i, j)).sum::<f64>();
    let below = |share: f64, of: &dyn Fn(usize, usize) -> f64| {
        let rows: Vec<f64> = (0..bins.middles[1].len()).map(|j| row(j, of)).collect();
        let (total, mut sum) = (rows.iter().sum::<f64>(), 0.0);
        let passes = |amount: &&f64| {
            sum += **amount;
            sum < share * total
        };
        rows.iter().take_while(passes).count()
    };
    let volume = below(QUIET[0], &|i, j| bins.volume(i, j));
    let area = below(QUIET[1], &|i, j| bins.area(i, j));
    histogram.axes[1].edge(volume.max(area))
}

/// The Gaussians of `count` parts, in rising s; fewer where there are no boundaries. What lies outside the histogram, such as
/// all that is [`quiet`], is no part of them. World units are those of the histogram's volumes.
pub fn proposal(histogram: &Histogram, count: usize) -> Vec<ProposedWidget> {
    let bins = ColumnSums::new(histogram);
    let shares = bins.by_scalar();
    let total: f64 = shares.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return Vec::new();
    }
    let mut parts: Vec<ProposedWidget> = Vec::new();
    let (mut from, mut passed) = (0, 0.0);
    for part in 1..=count {
        let mut to = from;
        while to < shares.len() && (passed < total * part as f64 / count as f64 || part == count) {
            passed += shares[to];
            to += 1;
        }
        if to > from {
            parts.extend(bins.widget_of_columns(from..to));
        }
        from = to;
    }
    parts
}

/// The histogram with the values of its bins' middles.
struct ColumnSums<'a> {
    histogram: &'a Histogram,
    wide: usize,
    middles: [Vec<f64>; 2],
}

impl ColumnSums<'_> {
    fn new(histogram: &Histogram) -> ColumnSums<'_> {
        let middles = histogram
            .axes
            .map(|axis| (0..axis.bins).map(|i| 0.5 * axis.edge(i) + 0.5 * axis.edge(i + 1)).collect());
        ColumnSums { histogram, wide: histogram.axes[0].bins, middles }
    }

    fn volume(&self, i: usize, j: usize) -> f64 {
        self.histogram.volumes[j * self.wide + i]
    }

    /// Area of level surfaces in a bin, times a width of s.
    fn area(&self, i: usize, j: usize) -> f64 {
        self.volume(i, j) * self.middles[1][j]
    }

    /// Area of each column.
    fn by_scalar(&self) -> Vec<f64> {
        (0..self.wide).map(|i| (0..self.middles[1].len()).map(|j| self.area(i, j)).sum()).collect()
    }

    fn widget_of_columns(&self, columns: std::ops::Range<usize>) -> Option<ProposedWidget> {
        let mut sum = [0.0; 5];
        for i in columns {
            for j in 0..self.middles[1].len() {
                let (area, s, g) = (self.area(i, j), self.middles[0][i], self.middles[1][j]);
                let [s0, g0] = [self.middles[0][0], 0.0];
                let terms = [1.0, s - s0, g - g0, (s - s0) * (s - s0), (g - g0) * (g - g0)];
                sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += area * term);
            }
        }
        let [area, s, g, ss, gg] = sum;
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        let (s, g) = (s / area, g / area);
        let variance = [ss / area - s * s, gg / area - g * g];
        let sigma = [0, 1].map(|a| {
            let axis = &self.histogram.axes[a];
            let least = MIN_BINS * (axis.high - axis.low) / axis.bins as f64;
            (NARROWER[a] * variance[a].max(0.0).sqrt()).max(least)
        });
        let centre = [self.middles[0][0] + s, g];
        let extinction = self.extinction(centre, sigma)?;
        Some(ProposedWidget { centre, sigma, extinction })
    }

    /// The extinction at which a ray through what the Gaussian holds is as deep as [`DEPTH`]. Its path is between what a
    /// sheet across the grid and what a ball of that volume would give; the geometric mean of both is taken.
    fn extinction(&self, centre: [f64; 2], sigma: [f64; 2]) -> Option<f64> {
        let profile = |a: usize, x: f64| (-0.5 * ((x - centre[a]) / sigma[a]).powi(2)).exp();
        let row = |j: usize| {
            let along: f64 = (0..self.wide).map(|i| self.volume(i, j) * profile(0, self.middles[0][i])).sum();
            along * profile(1, self.middles[1][j])
        };
        let held: f64 = (0..self.middles[1].len()).map(row).sum();
        let sheet = held / self.histogram.total.powf(2.0 / 3.0);
        let path = (sheet * held.cbrt()).sqrt();
        let extinction = DEPTH / path;
        (extinction > 0.0 && extinction.is_finite()).then_some(extinction)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    /// Volumes by bin of 10 × 10, s from 0 to 1, g from 0 to 2.
    fn histogram(volume: impl Fn(usize, usize) -> f64) -> Histogram {
        let axis = |high: f64| Axis { low: 0.0, high, bins: 10 };
        let volumes: Vec<f64> = (0..100).map(|k| volume(k % 10, k / 10)).collect();
        let total = volumes.iter().sum();
        Histogram { axes: [axis(1.0), axis(2.0)], volumes, total, outside: 0.0, not_finite: 0.0 }
    }

    fn with_surrounding(i: usize, j: usize) -> f64 {
        match (i, j) {
            (0, 0) => 1000.0,
            (2, 7) | (7, 7) => 10.0,
            _ => 0.0,
        }
    }

    #[test]
    fn surroundings_are_quiet() {
        assert!((quiet(&histogram(with_surrounding)) - 0.2).abs() < 0.21);
        // Boundaries of one steepness: nothing is quieter than they are.
        assert!(quiet(&histogram(|_, j| if j == 7 { 1.0 } else { 0.0 })) <= 1.4 + 1e-12);
    }

    /// Two boundaries: each gets a Gaussian.
    #[test]
    fn every_boundary_gets_a_part() {
        let found = proposal(&histogram(|i, j| if j > 0 { with_surrounding(i, j) } else { 0.0 }), 2);
        let centres: Vec<[f64; 2]> = found.iter().map(|one| one.centre).collect();
        assert_eq!(centres.len(), 2);
        for (centre, s) in centres.iter().zip([0.25, 0.75]) {
            assert!((centre[0] - s).abs() < 1e-12 && (centre[1] - 1.5).abs() < 1e-12, "{centres:?}");
        }
    }

    /// Lengths twice as long, volumes eight times: extinctions halve, as a depth has no unit.
    #[test]
    fn depth_does_not_depend_on_the_unit_of_length() {
        let spread = |i: usize, j: usize| (i + 2 * j) as f64;
        let (small, large) =
            (proposal(&histogram(spread), 4), proposal(&histogram(|i, j| 8.0 * spread(i, j)), 4));
        assert_eq!(small.len(), 4);
        for (small, large) in small.iter().zip(&large) {
            assert!((large.extinction / small.extinction - 0.5).abs() < 1e-12);
            assert!(small.sigma.iter().all(|sigma| *sigma > 0.0));
        }
        assert!(small.windows(2).all(|pair| pair[0].centre[0] < pair[1].centre[0]));
    }

    #[test]
    fn without_boundaries_there_is_nothing_to_propose() {
        assert!(proposal(&histogram(|_, _| 0.0), 3).is_empty());
    }
}
