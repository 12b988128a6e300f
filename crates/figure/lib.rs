//! voltet-figure: what makes a picture a figure of a report. Text, lines and colours over a picture, round ticks, colour bars and axes.
//!
//! | module | what |
//! | --- | --- |
//! | [`canvas`] | lines, rectangles and text over a picture, in linear light, or as shapes apart from it |
//! | [`note`] | texts of one's own in corners, at borders and at points |
//! | [`ticks`] | round numbers along an axis, and their labels |
//! | [`scale`] | a colour bar along s; the plane of s and g |
//! | [`space`] | box, axes and scale bar of a view |
//!
//! Lengths are in pixels, from the upper left corner of the picture. A size that is not stated follows from the height of the letters.

pub mod canvas;
pub mod note;
mod raster;
pub mod scale;
pub mod space;
pub mod ticks;

/// Height of letters that is read well in a picture of this size, pixels: 18 at 1024 × 768.
pub fn font_size([width, height]: [usize; 2]) -> f32 {
    (0.75 * width as f32).min(height as f32) / 42.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use canvas::Align;
    use canvas::{Canvas, Theme};
    use glam::DVec3;
    use note::{Anchor, note};
    use scale::{Border, NamedAxis, Shade, Side};
    use voltet_core::camera::{Camera, Projection};
    use voltet_core::grid::extent::corners;
    use voltet_core::picture::Picture;

    fn axis(name: &str, range: [f64; 2]) -> NamedAxis {
        NamedAxis { name: name.into(), scale: voltet_core::transfer::AxisScale::Linear, range }
    }

    #[derive(Debug, Clone, Copy)]
    enum Scale {
        Bar(Side),
        Plane(Side),
        Level(Border),
    }

    const SCALES: [Scale; 6] = [
        Scale::Bar(Side::Left),
        Scale::Bar(Side::Right),
        Scale::Plane(Side::Left),
        Scale::Plane(Side::Right),
        Scale::Level(Border::Top),
        Scale::Level(Border::Bottom),
    ];

    /// Elements of a figure with everything, written over nothing. Gives the number of texts.
    fn check_figure(size: [usize; 2], scale: Scale, direction: DVec3, projection: Projection) -> usize {
        let ends = [DVec3::new(-0.2, 3.0, 1e5), DVec3::new(7.5, 5.0, 1e5 + 3.0)];
        let (eye, up) = (direction, if direction.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z });
        let camera = Camera {
            eye,
            target: DVec3::ZERO,
            up,
            projection,
            near: 0.0,
            size: size.map(|n| n as u32),
            samples: 1,
        };
        let camera = camera.fitted(&corners(ends)).unwrap().zoomed(0.75);
        let view = space::View::new(camera).unwrap();
        let mut picture = Picture::transparent(size[0], size[1]);
        let mut canvas = Canvas::new(&mut picture, Theme::LIGHT, font_size(size).max(10.0));
        let top = canvas.heading("heat_sink.vtu", "t = 0.25 s, steady conduction").unwrap();
        let s = axis("Temperature of the fluid [°C]", [101325.0, 101325.01]);
        let shade = |[low, _]: [f64; 2]| Shade { color: None, extinction: low - 101324.0 };
        let (side, place) = match scale {
            Scale::Bar(side) => (side, scale::color_bar(&mut canvas, side, top, &s, shade)),
            Scale::Plane(side) => {
                let g = axis("|∇T| [K/mm]", [0.0, 3e5]);
                (side, scale::plane(&mut canvas, side, [&s, &g], |_| [0.5, 0.5, 0.5, 1.0]))
            }
            Scale::Level(border) => {
                (Side::Right, scale::level_color_bar(&mut canvas, border, top, &s, shade))
            }
        };
        assert!(place.is_some(), "{size:?} {scale:?}");
        assert!(space::directions(&mut canvas, &view, side.opposite()));
        let is_parallel = matches!(projection, Projection::Orthographic { .. });
        assert_eq!(space::scale_bar(&mut canvas, &view, "mm").is_some(), is_parallel);
        for (across, down) in [(Align::Start, Align::End), (Align::End, Align::Start)] {
            let anchor = Anchor::Border { across, down, margin: 0.5 };
            assert!(note(&mut canvas, "run 7, refined", anchor), "{size:?} {scale:?}");
        }
        let fixed = canvas.texts.len();
        let unlabelled = space::box_axes(&mut canvas, &view, ends, "mm");
        assert!(
            unlabelled.is_empty() || size[0] < 3000,
            "{size:?} {direction} {projection:?}: {unlabelled:?}"
        );
        let texts = std::mem::take(&mut canvas.texts);
        let what = format!("{size:?} {scale:?} {direction} {projection:?}");
        for (k, (text, [low, high])) in texts.iter().enumerate() {
            let is_within = (0..2).all(|k| low[k] >= 0.0 && high[k] <= size[k] as f32);
            assert!(is_within, "{what}: '{text}' is cut at {low:?} {high:?}");
            for (other, [from, to]) in &texts[..k] {
                let is_apart = (0..2).any(|k| high[k] <= from[k] || to[k] <= low[k]);
                assert!(is_apart, "{what}: '{text}' overlaps '{other}'");
            }
        }
        texts.len() - fixed
    }

    #[test]
    fn texts_neither_overlap_nor_are_cut() {
        let views = [
            DVec3::ONE,
            DVec3::X,
            -DVec3::Y,
            DVec3::Z,
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::new(-0.8, -1.4, 0.9),
            DVec3::new(0.1, 1.0, -0.4),
        ];
        let projections = [Projection::Perspective { fov_y: 30.0 }, Projection::Orthographic { height: 1.0 }];
        for size in [[400, 300], [300, 400], [1024, 768], [3840, 2160]] {
            for scale in SCALES {
                for (view, projection) in
                    views.into_iter().flat_map(|view| projections.map(|one| (view, one)))
                {
                    let labels = check_figure(size, scale, view, projection);
                    // Two ticks and the name of two axes at least.
                    assert!(
                        labels >= 6,
                        "{size:?} {scale:?} {view} {projection:?}: {labels} labels at the box"
                    );
                }
            }
        }
    }

    #[test]
    fn a_view_from_within_or_of_a_part_is_no_fault() {
        let ends = [DVec3::ZERO, DVec3::ONE];
        let projection = Projection::Perspective { fov_y: 60.0 };
        for eye in [
            DVec3::splat(0.4),
            DVec3::new(0.5, -1e-3, 0.5),
            DVec3::new(-1e-9, 0.5, 0.5),
            DVec3::new(0.0, 0.0, 2.0),
        ] {
            let target = DVec3::new(0.9, 0.8, 0.1);
            let camera =
                Camera { eye, target, up: DVec3::Z, projection, near: 0.0, size: [200, 150], samples: 1 };
            let mut picture = Picture::transparent(200, 150);
            let mut canvas = Canvas::new(&mut picture, Theme::DARK, 10.0);
            space::box_axes(&mut canvas, &space::View::new(camera).unwrap(), ends, "");
            assert!(picture.rgba.iter().flatten().all(|x| x.is_finite() && (0.0..=1.0).contains(x)));
            assert!(picture.rgba.iter().any(|pixel| pixel[3] > 0.0), "{eye}");
        }
    }
}
