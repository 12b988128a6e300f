//! Draws a scene with an engine and with the referee, compares, and keeps what differs for looking at.

pub use super::scene::{NamedScene, SHADING};

use std::path::PathBuf;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_reference as reference;

/// Bound of the error of 32-bit segments on an ordinary scene.
pub const ORDINARY: f64 = 2e-4;

/// The referee's picture.
pub fn referee(scene: &NamedScene) -> Picture {
    referee_shaded(scene, &SHADING)
}

/// The referee's picture with another shading.
pub fn referee_shaded(scene: &NamedScene, shading: &Shading) -> Picture {
    reference::draw(&scene.drawn_by(shading, VisibilityOrder::Exact), &NoProgress)
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Asserts that no pixel differs by more than `bound` and none is not finite.
pub fn within(name: &str, actual: &Picture, expected: &Picture, bound: f64) {
    let errors = errors(actual, expected);
    let (worst, at) = worst(&errors);
    let beyond = errors.iter().filter(|e| **e > bound).count();
    if beyond > 0 {
        let kept = keep(name, actual, expected, &errors);
        let (i, j) = (at % actual.width, at / actual.width);
        panic!(
            "{name}: {beyond} of {} pixels differ by more than {bound:e}, at most {worst:e} at ({i}, {j}): \
             {:?} for {:?}; pictures: {}",
            errors.len(),
            actual.rgba[at],
            expected.rgba[at],
            kept.display()
        );
    }
    println!("{name}: at most {worst:.2e}");
}

/// Asserts the bound of stiff scenes: 99.9 % of the pixels within 1/255, all finite.
pub fn nearly_all_within(name: &str, actual: &Picture, expected: &Picture) {
    let errors = errors(actual, expected);
    let beyond = errors.iter().filter(|e| **e > 1.0 / 255.0).count();
    let broken = errors.iter().filter(|e| !e.is_finite()).count();
    println!("{name}: {beyond} of {} beyond 1/255, at most {:.2e}", errors.len(), worst(&errors).0);
    if broken > 0 || beyond as f64 > 0.001 * errors.len() as f64 {
        let kept = keep(name, actual, expected, &errors);
        panic!(
            "{name}: {beyond} of {} pixels differ by more than 1/255 ({broken} not finite); pictures: {}",
            errors.len(),
            kept.display()
        );
    }
}

/// The largest difference of each pixel's channels; infinite where a value is not finite.
fn errors(actual: &Picture, expected: &Picture) -> Vec<f64> {
    assert_eq!((actual.width, actual.height), (expected.width, expected.height), "the pictures' sizes");
    assert_eq!(actual.rgba.len(), expected.rgba.len(), "the pictures' pixels");
    let pixel = |(a, b): (&[f32; 4], &[f32; 4])| {
        let channel = |(x, y): (&f32, &f32)| (f64::from(*x) - f64::from(*y)).abs();
        // Not f64::max alone, which passes over NaN.
        let finite = a.iter().chain(b).all(|x| x.is_finite());
        if finite { a.iter().zip(b).map(channel).fold(0.0, f64::max) } else { f64::INFINITY }
    };
    actual.rgba.iter().zip(&expected.rgba).map(pixel).collect()
}

fn worst(errors: &[f64]) -> (f64, usize) {
    let at = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
    (errors[at], at)
}

/// Writes the actual and the expected picture (.exr) and the difference (.png, white from 1/255 on).
fn keep(name: &str, actual: &Picture, expected: &Picture, errors: &[f64]) -> PathBuf {
    // The tests lie in `target/PROFILE/deps`.
    let program = std::env::current_exe().expect("the tests are a program");
    let target = program.ancestors().nth(3).expect("the tests lie in the target folder");
    let folder = target.join("tmp/validation");
    std::fs::create_dir_all(&folder).expect("the target folder can be written");
    let base = folder.join(name.replace([' ', '/'], "_"));
    save(actual, &base.with_extension("actual.exr"));
    save(expected, &base.with_extension("expected.exr"));
    let grey: Vec<u8> = errors.iter().map(|e| (e * 255.0 * 255.0).min(255.0) as u8).collect();
    image::GrayImage::from_raw(actual.width as u32, actual.height as u32, grey)
        .expect("one value a pixel")
        .save(base.with_extension("difference.png"))
        .expect("the target folder can be written");
    base
}

/// Writes a picture as premultiplied linear 32-bit RGBA.
pub fn save(picture: &Picture, path: &std::path::Path) {
    let values: Vec<f32> = picture.rgba.iter().flatten().copied().collect();
    image::Rgba32FImage::from_raw(picture.width as u32, picture.height as u32, values)
        .expect("four values a pixel")
        .save(path)
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

/// The check itself: it must see a missing pixel, a wrong one and one that is not a number.
pub fn sees_what_is_wrong() {
    let mut right = Picture::transparent(4, 3);
    right.rgba.fill([0.5; 4]);
    assert_eq!(worst(&errors(&right, &right)).0, 0.0);
    for (value, least) in [(0.0, 0.5), (0.501, 0.9e-3), (f32::NAN, f64::INFINITY)] {
        let mut wrong = right.clone();
        wrong.rgba[7][2] = value;
        let (error, at) = worst(&errors(&wrong, &right));
        assert!(error >= least && at == 7, "{value}: {error}");
    }
}
