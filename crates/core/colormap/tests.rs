use super::*;

/// The 256 colours of each map, 8-bit sRGB, from the same sources as the knots.
const COLORS: &str = include_str!("colors_256.txt");

fn bytes(curve: &ColorCurve, level: f64) -> [f64; 3] {
    let encoded = |v: f64| if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    curve.at(level).map(|v| 255.0 * encoded(v))
}

fn colors(name: &str) -> Vec<[u8; 3]> {
    let line = COLORS.lines().find_map(|line| line.strip_prefix(&format!("{name} "))).unwrap();
    let byte = |at: usize| u8::from_str_radix(&line[at..at + 2], 16).unwrap();
    (0..256).map(|i| [0, 2, 4].map(|k| byte(6 * i + k))).collect()
}

fn farthest(curve: &ColorCurve, name: &str) -> f64 {
    let of = |(i, color): (usize, [u8; 3])| {
        let found = bytes(curve, i as f64 / 255.0);
        (0..3).map(|k| (found[k].round() - f64::from(color[k])).abs()).fold(0.0, f64::max)
    };
    colors(name).into_iter().enumerate().map(of).fold(0.0, f64::max)
}

#[test]
fn each_map_is_within_one_step_of_its_256_colours() {
    for (map, (name, _)) in Colormap::ALL.into_iter().zip(NAMES) {
        assert_eq!(Colormap::named(name), Some(map));
        let curve = map.curve();
        assert!(curve.knots().iter().is_sorted_by(|a, b| a.0 < b.0), "{name}");
        assert_eq!([curve.knots()[0].0, curve.knots().last().unwrap().0], [0.0, 1.0]);
        assert!(farthest(&curve, name) <= 1.0, "{name}: {}", farthest(&curve, name));
    }
}

/// Colours of `vtkColorTransferFunction` (VTK 9.2) between two points, in 255ths of sRGB.
#[test]
fn the_way_between_two_points_is_that_of_vtk() {
    let blue = [0.0, 0.0, 1.0];
    let pale = [[0.23, 0.3, 0.75], [0.86, 0.86, 0.86]];
    let cases = [
        (ColorSpace::Rgb, [blue, [1.0, 1.0, 0.0]], 0.25, [63.75, 63.75, 191.25]),
        (ColorSpace::Lab, [blue, [1.0, 1.0, 0.0]], 0.5, [201.78, 138.36, 169.69]),
        (ColorSpace::Lab, [blue, [1.0, 1.0, 0.0]], 0.25, [151.84, 79.84, 213.47]),
        (ColorSpace::Diverging, COOL_WARM, 0.1, [89.69, 119.47, 227.05]),
        (ColorSpace::Diverging, COOL_WARM, 0.5, [220.68, 220.68, 220.68]),
        (ColorSpace::Diverging, pale, 0.5, [139.61, 174.80, 251.95]),
    ];
    for (space, [from, to], level, right) in cases {
        let curve = ColorCurve::interpolated(&[(-3.0, from), (5.0, to)], space).unwrap();
        let found = bytes(&curve, level);
        assert!((0..3).all(|k| (found[k] - right[k]).abs() <= 1.0), "{space:?} {level}: {found:?} {right:?}");
    }
}

/// Ends of ParaView's "Cool to Warm".
const COOL_WARM: [[f64; 3]; 2] = [[0.231373, 0.298039, 0.752941], [0.705882, 0.0156863, 0.14902]];

#[test]
fn a_curve_turns_round_and_is_cut_into_bands() {
    let curve = Colormap::Viridis.curve();
    let reversed = curve.clone().reversed();
    assert_eq!(reversed.at(0.0), curve.at(1.0));
    assert!((0..3).all(|k| (reversed.at(0.3)[k] - curve.at(0.7)[k]).abs() < 1e-12));
    let bands = curve.stepped(4);
    for (k, level) in [0.1, 0.3, 0.6, 0.9].into_iter().enumerate() {
        assert_eq!(bands.at(level), curve.at(k as f64 / 3.0));
    }
}

#[test]
fn points_that_make_no_curve_are_refused() {
    let color = [0.5; 3];
    let nan = f64::NAN;
    for wrong in [
        vec![],
        vec![(0.0, color)],
        vec![(0.0, color), (0.0, color)],
        vec![(1.0, color), (0.0, color)],
        vec![(0.0, color), (nan, color), (1.0, color)],
        vec![(0.0, color), (f64::INFINITY, color)],
        vec![(0.0, color), (1.0, [0.0, 0.0, 1.5])],
        vec![(0.0, color), (1.0, [0.0, nan, 0.0])],
    ] {
        ColorCurve::interpolated(&wrong, ColorSpace::Rgb).unwrap_err();
    }
}
