//! Colour spaces in which the colours of a map are straight between its points.
//!
//! Sources: CIE 1976 L*a*b* with the white D65; Msh and its interpolation: K. Moreland, "Diverging color maps for scientific
//! visualization", 2009, sections 5 and 6.

use crate::color::linear_from_srgb;

/// A colour space for the way between two colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorSpace {
    /// sRGB as it is displayed.
    Rgb,
    /// CIE L*a*b*.
    Lab,
    /// Msh, the polar form of L*a*b*: over white between two saturated colours of different hue.
    Diverging,
}

/// White D65 in XYZ.
const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];
/// XYZ from linear RGB (IEC 61966-2-1).
const XYZ: [[f64; 3]; 3] = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
/// Linear RGB from XYZ.
const RGB: [[f64; 3]; 3] = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
/// Saturation (radians) below which a colour has no hue of its own.
const GREY: f64 = 0.05;

impl ColorSpace {
    /// The colour (sRGB) at a share of the way from one to another.
    pub(super) fn between(self, a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
        let mixed = |a: [f64; 3], b: [f64; 3], t: f64| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t);
        if t == 0.0 || t == 1.0 {
            return if t == 0.0 { a } else { b };
        }
        match self {
            ColorSpace::Rgb => mixed(a, b, t),
            ColorSpace::Lab => srgb_from_lab(mixed(lab_from_srgb(a), lab_from_srgb(b), t)),
            ColorSpace::Diverging => {
                let [mut a, mut b] = [a, b].map(|color| msh_from_lab(lab_from_srgb(color)));
                let mut t = t;
                if a[1] > GREY && b[1] > GREY && turn(a[2], b[2]) > std::f64::consts::FRAC_PI_3 {
                    let white = [a[0].max(b[0]).max(88.0), 0.0, 0.0];
                    if t < 0.5 {
                        (b, t) = (white, 2.0 * t);
                    } else {
                        (a, t) = (white, 2.0 * t - 1.0);
                    }
                }
                if a[1] < GREY && b[1] > GREY {
                    a[2] = spun(b, a[0]);
                } else if b[1] < GREY && a[1] > GREY {
                    b[2] = spun(a, b[0]);
                }
                srgb_from_lab(lab_from_msh(mixed(a, b, t)))
            }
        }
    }
}

/// Angle between two hues.
fn turn(a: f64, b: f64) -> f64 {
    let turn = (a - b).abs();
    turn.min(std::f64::consts::TAU - turn)
}

/// Hue that an unsaturated colour of this M has beside a saturated one, so that the way between them is perceived as even.
fn spun([m, s, h]: [f64; 3], other_m: f64) -> f64 {
    if m >= other_m {
        return h;
    }
    let spin = s * (other_m * other_m - m * m).sqrt() / (m * s.sin());
    // Away from purple.
    if h > -std::f64::consts::FRAC_PI_3 { h + spin } else { h - spin }
}

fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn lab_from_srgb(color: [f64; 3]) -> [f64; 3] {
    let xyz = times(XYZ, color.map(linear_from_srgb));
    let f = |k: usize| {
        let v = xyz[k] / WHITE[k];
        if v > 0.008856 { libm::cbrt(v) } else { 7.787 * v + 16.0 / 116.0 }
    };
    let [x, y, z] = [0, 1, 2].map(f);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Clamped to 0 … 1: what a display shows.
fn srgb_from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let y = (l + 16.0) / 116.0;
    let f = |v: f64| if v * v * v > 0.008856 { v * v * v } else { (v - 16.0 / 116.0) / 7.787 };
    let xyz = [f(y + a / 500.0) * WHITE[0], f(y) * WHITE[1], f(y - b / 200.0) * WHITE[2]];
    let encoded = |v: f64| match v {
        v if v <= 0.003_130_8 => v * 12.92,
        v => 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055,
    };
    times(RGB, xyz).map(|v| encoded(v).clamp(0.0, 1.0))
}

/// [M, s, h]: length, angle from the axis of greys, hue.
fn msh_from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let m = (l * l + a * a + b * b).sqrt();
    let s = if m > 0.001 { (l / m).acos() } else { 0.0 };
    [m, s, if s > 0.001 { b.atan2(a) } else { 0.0 }]
}

fn lab_from_msh([m, s, h]: [f64; 3]) -> [f64; 3] {
    [m * s.cos(), m * s.sin() * h.cos(), m * s.sin() * h.sin()]
}
