//! Warnings about parts of a scene that a picture does not show, with the reason and the remedy.

use rayon::prelude::*;
use voltet_core::grid::extent;
use voltet_core::picture::Picture;
use voltet_optics::engine::RenderStats;
use voltet_optics::scene::Scene;

/// Less than this in every channel is nothing in 8 bits; this near to 1, opaque.
const STEP: f32 = 1.0 / 255.0;

/// The share of the pixels that show something from which on a picture counts as opaque: at outlines rays are short.
const OPAQUE_SHARE: f64 = 0.999;

/// Warnings about a picture that shows nothing, next to nothing or only the front, and about colours beyond the usual range.
pub fn warnings(scene: &Scene, counts: &RenderStats, picture: &Picture) -> Vec<String> {
    let mut warnings = too_bright(scene);
    let widgets = &scene.transfer_function.widgets;
    let Some(seen) = PictureStatistics::from_picture(picture).filter(|_| !widgets.is_empty()) else {
        return warnings;
    };
    warnings.extend(match seen.max {
        0.0 => Some(format!("the picture is empty: {}", why_empty(scene, counts))),
        most if most < STEP => Some(nearly_empty(most, seen.opacity)),
        _ if seen.opaque as f64 >= OPAQUE_SHARE * seen.shown as f64 => Some(
            "every pixel that shows anything is opaque: what lies behind the first cells is hidden. A smaller extinction or a \
             larger unit_distance shows the inside"
                .into(),
        ),
        _ => None,
    });
    warnings
}

/// Statistics of a picture's pixels.
struct PictureStatistics {
    /// The largest opacity or channel of any pixel.
    max: f32,
    /// The largest opacity.
    opacity: f32,
    /// Pixels that hold anything.
    shown: usize,
    /// Pixels that hide what is behind them.
    opaque: usize,
}

impl PictureStatistics {
    /// `None` for a picture without pixels.
    fn from_picture(picture: &Picture) -> Option<PictureStatistics> {
        let of_pixel = |pixel: &[f32; 4]| {
            let most = pixel.iter().copied().fold(0.0, f32::max);
            let [shown, opaque] = [most > 0.0, pixel[3] > 1.0 - STEP].map(usize::from);
            PictureStatistics { max: most, opacity: pixel[3], shown, opaque }
        };
        picture.rgba.par_iter().map(of_pixel).reduce_with(|a, b| PictureStatistics {
            max: a.max.max(b.max),
            opacity: a.opacity.max(b.opacity),
            shown: a.shown + b.shown,
            opaque: a.opaque + b.opaque,
        })
    }
}

fn nearly_empty(most: f32, opacity: f32) -> String {
    let text =
        format!("the picture is nearly empty: no pixel reaches 1/255 (the largest opacity is {most:.1e})");
    // Optical depth is in proportion to the extinction; half opaque is ln 2 of it.
    let depth = -f64::from(-opacity).ln_1p();
    match depth > 0.0 {
        true => {
            let factor = std::f64::consts::LN_2 / depth;
            format!("{text}. With {factor:.1e} times the extinction its densest pixel is half opaque")
        }
        false => format!("{text}. A larger extinction or a smaller unit_distance shows more"),
    }
}

/// The reason for an empty picture, and the remedy. The transfer function has widgets.
fn why_empty(scene: &Scene, counts: &RenderStats) -> String {
    let widgets = &scene.transfer_function.widgets;
    if !widgets.iter().any(|widget| widget.is_drawn()) {
        return "the extinction of every widget is 0. Give one an extinction above it".into();
    }
    let total = scene.volume.grid.tetrahedra.len() as u64;
    let untouched = counts.culled_by_transfer_function.unwrap_or(0);
    let out_of_view = counts.culled_by_frustum.unwrap_or(0);
    let values = || values(scene);
    if untouched == total {
        return format!(
            "no widget reaches any of the {total} cells ({}). Move the widgets there; `voltet info` shows ranges, the node \
             histogram where the volume lies",
            values()
        );
    }
    if untouched + out_of_view == total {
        let rest = match untouched {
            0 => format!("all {total} cells lie out of the camera's view"),
            _ => format!(
                "no widget reaches {untouched} of the {total} cells ({}), and the others lie out of the camera's view",
                values()
            ),
        };
        return format!("{rest}. Look {}", where_to_look(scene));
    }
    if counts.cells_projected == Some(0) || counts.segments == Some(0) {
        return format!(
            "no cell covers the middle of a pixel. Come nearer, or look {}",
            where_to_look(scene)
        );
    }
    "the opacity of every segment rounds to 0. A larger extinction or a smaller unit_distance shows them"
        .into()
}

/// The ranges of what the widgets look at.
fn values(scene: &Scene) -> String {
    let volume = &scene.volume;
    let range = |name: &str, values: &[f64]| match extent::range(values) {
        Some([low, high]) => format!("{name} lies within [{low}, {high}]"),
        None => format!("{name} is nowhere finite"),
    };
    let mut ranges = vec![range("s", &volume.scalar)];
    if scene.transfer_function.uses_gradient_magnitude() {
        ranges.extend(volume.gradient_magnitude.iter().map(|g| range("g", g)));
    }
    let fields = scene.transfer_function.fields().into_iter();
    let known = fields.filter_map(|name| Some((name, volume.grid.point_arrays.get(name)?)));
    ranges.extend(known.map(|(name, array)| range(&format!("\"{name}\""), &array.values)));
    ranges.join(", ")
}

fn where_to_look(scene: &Scene) -> String {
    let Some([low, high]) = scene.volume.grid.bounds() else { return "at the grid".into() };
    let vector = |v: glam::DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    format!(
        "at the grid, which reaches from {} to {}: target = {}",
        vector(low),
        vector(high),
        vector(0.5 * low + 0.5 * high)
    )
}

/// Widgets whose colours are brighter than white.
fn too_bright(scene: &Scene) -> Vec<String> {
    let widgets = scene.transfer_function.widgets.iter().enumerate();
    let bright =
        widgets.map(|(i, widget)| (i, widget.max_emission())).filter(|(_, brightest)| *brightest > 1.0);
    let said = |(i, brightest): (usize, f64)| {
        let meant = match brightest > 2.0 && brightest <= 255.0 {
            true => "; was 0 to 255 meant? Then (c / 255)^2.2 is about the linear one",
            false => "",
        };
        format!(
            "a colour of widgets[{i}] has a component of {brightest}: linear RGB, brighter than white above 1{meant}"
        )
    };
    bright.map(said).collect()
}
