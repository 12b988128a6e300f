//! Hard transfer functions: thin and stiff, narrow, stepped, banded, tabulated, lit.

use super::scene::{Hard, PLAIN, cube, look, moved};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_optics::shading::{Light, Shading};

const RED: [f64; 3] = [0.9, 0.3, 0.2];
const BLUE: [f64; 3] = [0.2, 0.5, 1.1];

/// Every one, on a cube of irregular cells.
pub(super) fn scenes() -> Vec<Hard> {
    let base = cube([4, 4, 4], 0.2);
    let scene = |category, name: String, look: TransferFunction, shading: Shading| Hard {
        look,
        shading,
        ..moved(name, category, &base, |p| p)
    };
    let depths = [1e-12, 1e3, 1e6, 1e9, 1e12];
    let depths = depths.map(|depth| {
        let mut stiff = look();
        stiff.widgets.iter_mut().for_each(|widget| widget.extinction *= depth);
        scene("optical depths", format!("extinction times {depth:e}"), stiff, PLAIN)
    });
    let narrow = [1e-3, 1e-6].map(|width| {
        let look = density(vec![
            gaussian(0.55, width, 1.0 / width, BLUE),
            triangular(0.45, width, 1.0 / width, RED),
            gaussian(0.5, 0.2, 1.0, RED),
        ]);
        scene("narrow widgets", format!("widths of {width:e}"), look, PLAIN)
    });
    let steps = [(1e-3, 1e3), (1e-6, 1e6)].map(|(width, dense)| {
        scene("steps", format!("to {dense:e} over {width:e}"), density(vec![step(0.5, width, dense)]), PLAIN)
    });
    let bands = [1e-2, 1e-3].map(|period| {
        let look = density(vec![wave(period, true, BLUE), wave(3.0 * period, false, RED)]);
        scene("many bands", format!("a period of {period:e}"), look, PLAIN)
    });
    let constant = [1.0 / 255.0, 1e-6].map(|cutoff| {
        let look = TransferFunction { model: OpticalModel::ConstantEmitter { cutoff }, ..look() };
        scene("constant emitter", format!("a cutoff of {cutoff:.1e}"), look, PLAIN)
    });
    let table = scene("tables", "an image of 5 × 3 texels".into(), density(vec![image()]), PLAIN);
    let light = Light { direction: DVec3::new(0.3, -0.7, 0.9), ambient: 0.2, diffuse: 0.8 };
    let shaded = [
        ("diffuse light", Shading { light: Some(light), ..PLAIN }),
        ("silhouettes of exponent 0.5", Shading { silhouette: Some(0.5), ..PLAIN }),
        ("silhouettes of exponent 8, lit", Shading { silhouette: Some(8.0), light: Some(light), ..PLAIN }),
    ];
    let shaded = shaded.map(|(name, shading)| scene("light and silhouettes", name.into(), look(), shading));
    depths
        .into_iter()
        .chain(narrow)
        .chain(steps)
        .chain(bands)
        .chain(constant)
        .chain([table])
        .chain(shaded)
        .collect()
}

fn density(widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets }
}

fn widget(profile: Profile, extinction: f64, color: [f64; 3]) -> Widget {
    Widget { profile, color, extinction, region: None }
}

/// Along s alone.
fn gaussian(centre: f64, width: f64, extinction: f64, color: [f64; 3]) -> Widget {
    widget(
        Profile::Gaussian { centre: [centre, 0.0], matrix: [[1.0 / width, 0.0], [0.0, 0.0]] },
        extinction,
        color,
    )
}

fn triangular(centre: f64, sigma: f64, extinction: f64, color: [f64; 3]) -> Widget {
    widget(Profile::TriangularGaussian { centre, sigma }, extinction, color)
}

/// From nothing to a dense rest, with a thin part before.
fn step(s: f64, width: f64, dense: f64) -> Widget {
    let point = |s, extinction, color| ControlPoint { s, color, extinction };
    let points =
        vec![point(0.1, 0.0, BLUE), point(0.3, 1.0, BLUE), point(s, 0.0, BLUE), point(s + width, dense, RED)];
    widget(Profile::PiecewiseLinear { points }, 0.0, [0.0; 3])
}

fn wave(period: f64, sine: bool, color: [f64; 3]) -> Widget {
    let wave = Wave { origin: [0.1, 0.0], angle: 0.4, scale: [1.0, 0.3], period, band_width: 0.4 };
    let profile = if sine { Profile::SineWave(wave) } else { Profile::TriangleWave(wave) };
    let region = Region::rectangle([0.2, 0.8], [0.3, 1.6]);
    Widget { region: Some(region), ..widget(profile, 4.0, color) }
}

fn image() -> Widget {
    let texels = (0..15u8).map(|k| {
        let x = f32::from(k) / 14.0;
        [x, 0.5, 1.0 - x, f32::from(k * 7 % 5) / 4.0]
    });
    let table = Table { width: 5, height: 3, texels: texels.collect(), s: [0.1, 0.9], g: [0.3, 1.8] };
    widget(Profile::Table(Arc::new(table)), 4.0, [0.0; 3])
}
