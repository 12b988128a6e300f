use super::super::sub_tetrahedron::{Distribution, SubTetrahedron};
use super::super::{Axis, BandCounts, Volumes, bands, histogram};
use super::{Shares, close, cube, numbers};
use crate::SharedSlice;
use crate::error::ErrorKind;
use crate::grid::Grid;
use crate::grid::generate::{box_of_tetrahedra, sample};
use crate::progress::NoProgress;
use crate::transfer::{OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use crate::volume::Volume;
use glam::DVec3;
use std::sync::Arc;

/// One tetrahedron: the corner of the unit cube, so that s = x and g = y have hand-worked integrals.
fn corner() -> Grid {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    Grid {
        points: SharedSlice::from(points),
        tetrahedra: SharedSlice::from(vec![[0, 1, 2, 3]]),
        ..Grid::default()
    }
}

#[test]
fn both_sides_of_a_cut_make_the_whole() {
    let mut number = numbers();
    for round in 0..1000 {
        // Some corners lie in the plane itself.
        let f = [(); 4].map(|()| if number() < 0.1 { 0.0 } else { number() - 0.5 });
        let (mut above, mut below) = (0.0, 0.0);
        SubTetrahedron::WHOLE.clip_to_level(f, |part| {
            above += part.volume_fraction;
            // The corners make a tetrahedron of that share: the determinant of their coordinates.
            let matrix = glam::DMat4::from_cols_array_2d(&part.corners);
            close(matrix.determinant().abs(), part.volume_fraction, 1e-14);
            // Nothing of it lies on the other side, but for rounding.
            assert!(part.values(f).iter().all(|&v| v >= -1e-15), "{f:?}");
        });
        SubTetrahedron::WHOLE.clip_to_level(f.map(|f| -f), |part| below += part.volume_fraction);
        close(above + below, 1.0, 1e-14);
        close(Distribution::new(f).below(0.0), below, 1e-14);
        assert!(round > 0 || above > 0.0);
    }
}

#[test]
fn a_corner_of_a_cube_falls_into_four_bins_as_worked_by_hand() {
    let grid = corner();
    let (s, g) = (sample(&grid, |p| p.x), sample(&grid, |p| p.y));
    let axis = Axis { low: 0.0, high: 1.0, bins: 2 };
    let found = histogram(&grid, [&s, &g], [axis; 2], &NoProgress).unwrap();
    // ∫∫ (1 − x − y) over [0, ½]² is 1/8; the two bins beside it share the rest of 1/6; x + y ≥ 1 holds nothing.
    let wanted = [1.0 / 8.0, 1.0 / 48.0, 1.0 / 48.0, 0.0];
    found.volumes.iter().zip(wanted).for_each(|(&volume, wanted)| close(volume, wanted, 1e-16));
    assert_eq!(found.volumes[3], 0.0);
    close(found.total, 1.0 / 6.0, 1e-16);
}

/// Fields that are far from linear over the cube, on cells that touch many bins and cells that touch one.
fn curved(grid: &Grid) -> [Vec<f64>; 2] {
    [sample(grid, |p| (3.0 * p.x).sin() + p.y * p.z), sample(grid, |p| p.x * p.y + (p.z - 0.3).powi(2))]
}

#[test]
fn every_bin_is_the_volume_cut_by_four_half_spaces() {
    let grid = cube();
    let [s, g] = curved(&grid);
    // The axes leave out some of the data.
    let axes = [Axis { low: 0.1, high: 1.3, bins: 7 }, Axis { low: 0.05, high: 0.9, bins: 23 }];
    let found = histogram(&grid, [&s, &g], axes, &NoProgress).unwrap();
    let mut largest: f64 = 0.0;
    for (bin, &volume) in found.volumes.iter().enumerate() {
        let (i, j) = (bin % 7, bin / 7);
        let mut wanted = 0.0;
        for (cell, corners) in grid.tetrahedra.iter().enumerate() {
            let mut pieces = vec![SubTetrahedron::WHOLE];
            for (values, axis, edge, sign) in
                [(&s, 0, i, 1.0), (&s, 0, i + 1, -1.0), (&g, 1, j, 1.0), (&g, 1, j + 1, -1.0)]
            {
                let f = corners.map(|p| sign * (values[p as usize] - axes[axis].edge(edge)));
                let mut parts = Vec::new();
                pieces.iter().for_each(|piece| piece.clip_to_level(piece.values(f), |part| parts.push(part)));
                pieces = parts;
            }
            let share: f64 = pieces.iter().map(|piece| piece.volume_fraction).sum();
            wanted += share * crate::grid::tetrahedron_volume(grid.corners(cell));
        }
        // Rounding of the edges, in bins: some 1e-15 of the volume that a bin's edge crosses.
        close(volume, wanted, 1e-14);
        largest = largest.max(wanted);
    }
    assert!(largest > 1e-2, "the test looks at no full bin: {largest}");
    let inside: f64 = found.volumes.iter().sum();
    close(inside + found.outside, 1.0, 1e-13);
    assert!(found.outside > 0.05, "{}", found.outside);
}

#[test]
fn all_bins_make_the_volume_and_the_margins_the_exact_distributions() {
    let grid = cube();
    let [s, g] = curved(&grid);
    let axes = [Axis::over(&s, 64), Axis::over(&g, 48)];
    let found = histogram(&grid, [&s, &g], axes, &NoProgress).unwrap();
    // Rounding of a few hundred cells' volumes, split among some thousand bins.
    close(found.volumes.iter().sum::<f64>(), 1.0, 1e-13);
    close(found.total, 1.0, 1e-13);
    assert_eq!(found.outside, 0.0);
    for (axis, values) in [&s, &g].into_iter().enumerate() {
        let below = |edge: f64| -> f64 {
            let of_cell = |(cell, corners): (usize, &[u32; 4])| {
                let distribution = Distribution::new(corners.map(|p| values[p as usize]));
                distribution.below(edge) * crate::grid::tetrahedron_volume(grid.corners(cell))
            };
            grid.tetrahedra.iter().enumerate().map(of_cell).sum()
        };
        for bin in 0..axes[axis].bins {
            let in_bin =
                |&(place, _): &(usize, &f64)| if axis == 0 { place % 64 == bin } else { place / 64 == bin };
            let margin: f64 = found.volumes.iter().enumerate().filter(in_bin).map(|(_, volume)| volume).sum();
            let exact = below(axes[axis].edge(bin + 1)) - below(axes[axis].edge(bin));
            close(margin, exact, 1e-13);
        }
    }
}

#[test]
fn bands_are_counted_by_cell() {
    let grid = Arc::new(box_of_tetrahedra([10, 1, 1], [DVec3::ZERO, DVec3::new(10.0, 1.0, 1.0)], 0.0));
    // Each layer of cells spans as much of s as its number: 0, 1, 2, …; g runs along y.
    let s = sample(&grid, |p| p.x * (p.x - 1.0) / 2.0);
    let g = sample(&grid, |p| 0.25 * p.y);
    let volume = Volume {
        scalar: SharedSlice::from(s),
        gradient_magnitude: Some(SharedSlice::from(g)),
        gradient: None,
        grid,
    };
    let wave = Wave { origin: [3.0, 0.0], angle: 0.0, scale: [1.0; 2], period: 1.0, band_width: 0.1 };
    let widget = |profile, region| Widget { profile, color: [1.0; 3], extinction: 1.0, region };
    let of = |widgets| {
        let model = OpticalModel::DensityEmitter;
        bands(&volume, &TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() })
            .unwrap()
    };
    let found = of(vec![
        widget(Profile::Uniform, Some(Region::rectangle([0.0, 1.0], [0.0, 1.0]))),
        widget(Profile::SineWave(wave), None),
        widget(Profile::TriangleWave(Wave { angle: 90.0_f64.to_radians(), ..wave }), None),
        widget(
            Profile::TriangleWave(wave),
            Some(Region::rectangle([36.5, 100.0], [f64::NEG_INFINITY, f64::INFINITY])),
        ),
    ]);
    let cells = volume.grid.tetrahedra.len() as u64;
    let first = BandCounts {
        widget: 1,
        kind: "sine-wave",
        cell_count: cells,
        median: 4.0,
        percent_99: 9.0,
        max: 9.0,
        share_above_one: 0.8,
    };
    assert_eq!(found[0], first);
    // Every cell has corners on both sides along y.
    close(found[1].median, 0.25, 1e-7);
    assert_eq!((found[1].share_above_one, found[1].cell_count), (0.0, cells));
    // Only the last layer, s from 36 to 45, reaches into the region.
    assert_eq!((found[2].widget, found[2].median, found[2].cell_count), (3, 9.0, cells / 10));
}

/// Threads end their own chunks after the stop: of four, and this many cells, most is left then.
#[test]
fn long_sums_tell_their_share_and_stop_in_the_middle() {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
    threads.install(sums_stop_in_the_middle);
}

fn sums_stop_in_the_middle() {
    let grid = box_of_tetrahedra([40; 3], [DVec3::ZERO, DVec3::ONE], 0.2);
    let [x, y] = [0, 1].map(|axis| grid.points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
    let axis = Axis { low: 0.0, high: 1.0, bins: 64 };
    let of_histogram = |progress: &Shares| histogram(&grid, [&x, &y], [axis; 2], progress).map(drop);
    let of_volumes = |progress: &Shares| Volumes::new(&grid, &x, progress).map(drop);
    type Sums<'a> = &'a dyn Fn(&Shares) -> crate::Result<()>;
    for (stage, sums) in [("histogram", &of_histogram as Sums), ("distribution", &of_volumes)] {
        let whole = Shares::of(stage, f64::INFINITY);
        sums(&whole).unwrap();
        assert_eq!(whole.last(), 1.0, "{stage}");
        assert!(whole.count() >= 20, "{stage}: {} reports", whole.count());
        let stopped = Shares::of(stage, 0.25);
        assert_eq!(sums(&stopped).unwrap_err().kind, ErrorKind::Cancelled, "{stage}");
        assert!((0.25..0.6).contains(&stopped.last()), "{stage}: went on to {}", stopped.last());
    }
    let volumes = Volumes::new(&grid, &x, &Shares::of("distribution", f64::INFINITY)).unwrap();
    let stopped = volumes.below_each(&[0.25, 0.5], &Shares::of("distribution", 0.0));
    assert_eq!(stopped.unwrap_err().kind, ErrorKind::Cancelled);
}
