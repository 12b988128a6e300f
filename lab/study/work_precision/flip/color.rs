//! The colour spaces of FLIP: linear sRGB, YCxCz (Kolpatzik and Bouman 1992), CIE L*a*b* (D65).

/// Linear sRGB.
pub type Rgb = [f64; 3];

/// Linear sRGB to XYZ, with the primaries and the white (D65) of IEC 61966-2-1 worked out as fractions.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0],
    [2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0],
    [1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0],
];

fn xyz(rgb: Rgb) -> [f64; 3] {
    XYZ_FROM_RGB.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])
}

/// XYZ over that of white.
fn relative(rgb: Rgb) -> [f64; 3] {
    let (white, xyz) = (xyz([1.0; 3]), xyz(rgb));
    std::array::from_fn(|k| xyz[k] / white[k])
}

/// Linear RGB to YCxCz.
pub fn ycxcz(rgb: Rgb) -> [f64; 3] {
    let [x, y, z] = relative(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// YCxCz to linear RGB.
pub fn linear_rgb([y, cx, cz]: [f64; 3]) -> Rgb {
    let white = xyz([1.0; 3]);
    let y = (y + 16.0) / 116.0;
    let value = [(y + cx / 500.0) * white[0], y * white[1], (y - cz / 200.0) * white[2]];
    solve(value)
}

/// Y of YCxCz, −16 … 100, as 0 … 1.
pub fn lightness(y: f64) -> f64 {
    (y + 16.0) / 116.0
}

/// XYZ to linear RGB: Cramer's rule for the matrix above.
fn solve(value: [f64; 3]) -> Rgb {
    let m = XYZ_FROM_RGB;
    let determinant = |m: [[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(m);
    std::array::from_fn(|k| {
        let mut replaced = m;
        (0..3).for_each(|row| replaced[row][k] = value[row]);
        determinant(replaced) / whole
    })
}

/// Linear RGB to L*, and a*, b* scaled by 0.01 L* (Hunt: colours of dark places look less colourful).
pub fn hunt_lab(rgb: Rgb) -> [f64; 3] {
    const D: f64 = 6.0 / 29.0;
    let f = |t: f64| if t > D.powi(3) { t.cbrt() } else { t / (3.0 * D * D) + 4.0 / 29.0 };
    let [x, y, z] = relative(rgb).map(f);
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// HyAB (Abasi, Tehran, Fairchild 2020).
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The distance of pure green and pure blue, the largest there is.
pub fn largest_distance() -> f64 {
    distance(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() < tolerance), "{a:?} {b:?}");
    }

    #[test]
    fn known_colours() {
        close(ycxcz([1.0; 3]), [100.0, 0.0, 0.0], 1e-12);
        close(ycxcz([0.0; 3]), [-16.0, 0.0, 0.0], 1e-12);
        // Lindbloom's calculator: green is L*a*b* (87.735, −86.183, 83.180), blue (32.301, 79.188, −107.860); his white
        // has other digits behind the fourth.
        close(hunt_lab([0.0, 1.0, 0.0]), [87.735, -0.87735 * 86.183, 0.87735 * 83.180], 2e-2);
        close(hunt_lab([0.0, 0.0, 1.0]), [32.301, 0.32301 * 79.188, -0.32301 * 107.860], 2e-2);
        close(hunt_lab([1.0; 3]), [100.0, 0.0, 0.0], 1e-12);
        // 55.434 + 147.868 from those figures.
        assert!((largest_distance() - 203.302).abs() < 1e-2, "{}", largest_distance());
    }

    #[test]
    fn there_and_back() {
        for rgb in [[0.2, 0.5, 0.9], [1.0, 0.0, 0.0], [0.01, 0.02, 0.0]] {
            close(linear_rgb(ycxcz(rgb)), rgb, 1e-13);
        }
    }
}
