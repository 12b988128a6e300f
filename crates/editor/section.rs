//! The section: s on a plane through the data, where a click, a box or an outline finds values.

use crate::fields::gradient;
use crate::focus::Sheet;
use crate::outline::{Drawing, Outline, OutlineShape, enclosed};
use crate::picture::{WHOLE, set_texture};
use crate::scene::{Action, EARLIER, Scene};
use crate::theme::{self, Help};
use crate::view::View;
use crate::ways_out::{show_error, ways_out_of_data};
use crate::worker::{PixelProbe, Section, short, short_by};
use eframe::egui::{
    Color32, ColorImage, Context, Pos2, Rect, Rgba, RichText, Sense, Slider, TextureHandle, TextureOptions,
    Ui, pos2, vec2,
};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::colormap::Colormap;
use voltet_core::{agreeing, noun_of, with_commas};
use voltet_graph::ArrayRef;
use voltet_io::encode::viridis;

/// Pixels of its picture.
pub(crate) const SIZE: [usize; 2] = [320, 240];

#[derive(Default)]
pub(crate) struct SectionPanel {
    pub open: bool,
    /// Axis (0: x, 1: y, 2: z) that the plane is across; none where it is parallel to the picture.
    across: Option<usize>,
    /// From the centre that was picked, as a share of half of the data's diagonal.
    offset: f64,
    texture: Option<TextureHandle>,
    shown: Option<Arc<Section>>,
    /// Values of s that have the first and the last colour.
    range: [f64; 2],
    outline: Outline,
    /// True if a drag draws an outline, false if a box.
    is_free: bool,
    /// For tests.
    #[cfg(test)]
    pub rect: Option<Rect>,
}

impl SectionPanel {
    /// The panel of another document.
    pub fn emptied(self) -> SectionPanel {
        SectionPanel { open: self.open, ..SectionPanel::default() }
    }

    /// The section that is wanted of a volume: its middle, the plane's axes and half of its height.
    pub fn wanted(&self, view: View, bounds: [DVec3; 2]) -> Option<(DVec3, [DVec3; 2], f64)> {
        let radius = 0.5 * (bounds[1] - bounds[0]).length();
        let (axes, half) = match self.across {
            None => (view.sides()?, (0.5 * view.height()).min(radius)),
            Some(axis) => ([[1, 2], [0, 2], [0, 1]][axis].map(|other: usize| DVec3::AXES[other]), radius),
        };
        let normal = axes[0].cross(axes[1]);
        let sound = half > 0.0 && half.is_finite();
        sound.then(|| (view.target + self.offset * radius * normal, axes, half))
    }

    pub fn show(&mut self, ctx: &Context, scene: &Scene) {
        let mut open = self.open;
        Sheet::SECTION.window().open(&mut open).resizable(false).default_pos([20.0, 60.0]).show(ctx, |ui| {
            ui.horizontal(|ui| {
                for (across, text, help) in [
                    (None, "as seen", "parallel to the picture"),
                    (Some(0), "x", "across the x axis"),
                    (Some(1), "y", "across the y axis"),
                    (Some(2), "z", "across the z axis"),
                ] {
                    ui.selectable_value(&mut self.across, across, text).help(help);
                }
                ui.add(Slider::new(&mut self.offset, -1.0..=1.0).show_value(false))
                    .help("how far from the centre that was picked (double click in the picture)");
                if ui.small_button("0").help("through the centre that was picked").clicked() {
                    self.offset = 0.0;
                }
                let help = "a drag takes the values in the outline that it draws, not in a box";
                if theme::switch(ui, self.is_free, "outline", help).clicked() {
                    self.is_free = !self.is_free;
                }
            });
            self.picture(ui, scene);
        });
        self.open = open;
    }

    fn picture(&mut self, ui: &mut Ui, scene: &Scene) {
        let size = vec2(1.25 * SIZE[0] as f32, 1.25 * SIZE[1] as f32);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        ui.painter().rect_filled(rect, 0.0, Color32::BLACK);
        #[cfg(test)]
        self.rect.replace(rect);
        match &scene.section {
            Some(Ok(section)) => self.take(ui, scene, section),
            Some(Err(error)) => {
                self.shown = None;
                show_error(ui, scene, error, &ways_out_of_data(scene, error));
            }
            None => {
                self.shown = None;
                drop(ui.label("computing the section …"));
            }
        }
        let (Some(section), Some(texture)) = (self.shown.clone(), &self.texture) else { return };
        ui.painter().image(texture.id(), rect, WHOLE, theme::tint(scene.is_section_earlier));
        let pixel = |at: Pos2| {
            let share = (at - rect.min) / rect.size();
            [share.x * SIZE[0] as f32, share.y * SIZE[1] as f32].map(|x| f64::from(x.max(0.0)))
        };
        let at = response.interact_pointer_pos().or(response.hover_pos());
        let shape = if self.is_free { OutlineShape::Free } else { OutlineShape::Box };
        if let Drawing::Done(corners) = self.outline.follow(ui, &response, rect, Some(shape)) {
            probe(scene, &section, &corners.into_iter().map(pixel).collect::<Vec<_>>(), shape);
        }
        if let Some(at) = at.filter(|_| response.clicked()) {
            probe(scene, &section, &[pixel(at)], OutlineShape::Box);
        }
        let weak = theme::weak(ui.visuals().dark_mode);
        ui.horizontal(|ui| {
            let [low, high] = self.range.map(|s| short_by(s, 1e-2 * (self.range[1] - self.range[0])));
            let name = scene.scalar().unwrap_or("s");
            ui.label(RichText::new(format!("{name} from {low}")).small());
            Colormap::named("viridis").into_iter().for_each(|map| gradient(ui, map));
            ui.label(RichText::new(format!("to {high}")).small());
        });
        let words = match response.hover_pos().map(pixel) {
            _ if scene.is_section_earlier => format!("{EARLIER}; computing the section …"),
            Some(at) => under(&section, at),
            None => {
                let (cells, are) = (noun_of(&section.cells, "cell"), agreeing(&section.cells, "is", "are"));
                format!("{} {cells} {are} cut; click or drag: the values there", with_commas(section.cells))
            }
        };
        ui.label(RichText::new(words).small().color(weak));
    }

    /// The section as a texture, by the range of s in all of the data where that is known.
    fn take(&mut self, ui: &Ui, scene: &Scene, section: &Arc<Section>) {
        if self.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, section)) {
            return;
        }
        let of_data = scene.distribution.as_ref();
        let of_data = of_data.and_then(|found| found.known.ranges.get(&ArrayRef::Named("s")).copied());
        let [low, high] = of_data.unwrap_or_else(|| range_of(section));
        self.range = [low, high];
        let color = |value: &Option<[f64; 2]>| match value {
            Some([s, _]) => colored((s - low) / (high - low)),
            None => Color32::from_gray(24),
        };
        let image = ColorImage::new(section.of.size, section.values.iter().map(color).collect());
        set_texture(&mut self.texture, ui, "section", image, TextureOptions::NEAREST);
        self.shown = Some(section.clone());
    }
}

fn colored(share: f64) -> Color32 {
    // A constant field has no range.
    let [r, g, b, _] = viridis(if share.is_finite() { share.clamp(0.0, 1.0) as f32 } else { 0.0 });
    Rgba::from_rgb(r, g, b).into()
}

/// Smallest and largest s.
fn range_of(section: &Section) -> [f64; 2] {
    let found = section.values.iter().flatten().map(|value| value[0]);
    found.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], s| [a.min(s), b.max(s)])
}

fn value_at(section: &Section, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let [width, height] = section.of.size;
    let (column, row) = ((x as usize).min(width - 1), (y as usize).min(height - 1));
    *section.values.get(row * width + column)?
}

fn under(section: &Section, at: [f64; 2]) -> String {
    let pixel = 2.0 * section.of.half / section.of.size[1] as f64;
    let point = section.of.point(at).to_array().map(|x| short_by(x, pixel)).join(", ");
    let [low, high] = range_of(section);
    match value_at(section, at) {
        Some([s, g]) => format!("s {}   g {}   at ({point})", short_by(s, 1e-3 * (high - low)), short(g)),
        None => format!("no cell at ({point})"),
    }
}

/// Middles of the pixels in an outline, corners in pixels: of a box all from corner to corner, both ends included, so that a thin one
/// has those along it, too.
fn pixels_in(corners: &[Pos2], shape: OutlineShape, size: [usize; 2]) -> Vec<Pos2> {
    let around = Rect::from_points(corners);
    let within =
        |low: f32, high: f32, count: usize| (low as usize).min(count - 1)..=(high as usize).min(count - 1);
    let columns = within(around.left(), around.right(), size[0]);
    let middles = within(around.top(), around.bottom(), size[1])
        .flat_map(|row| columns.clone().map(move |column| pos2(column as f32 + 0.5, row as f32 + 0.5)));
    match shape {
        OutlineShape::Box => middles.collect(),
        OutlineShape::Free => enclosed(corners, middles),
    }
}

/// The values at the pixels in an outline, corners in pixels, as what a probe found.
fn probe(scene: &Scene, section: &Section, corners: &[[f64; 2]], shape: OutlineShape) {
    let corners: Vec<Pos2> = corners.iter().map(|[x, y]| pos2(*x as f32, *y as f32)).collect();
    let around = Rect::from_points(&corners);
    let pixels = pixels_in(&corners, shape, section.of.size);
    let pixels = pixels.into_iter().map(|at| [at.x, at.y].map(f64::from));
    let values: Vec<([f64; 2], f64)> =
        pixels.filter_map(|at| value_at(section, at).map(|value| (value, 1.0))).collect();
    let middle = section.of.point([around.center().x, around.center().y].map(f64::from));
    let point = Some(middle).filter(|_| !values.is_empty());
    let found = PixelProbe { values, point, ..PixelProbe::default() };
    scene.actions.push(Action::PixelProbe(section.of.source.clone(), Arc::new(found)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_all_pixels_from_corner_to_corner_also_a_thin_one() {
        let within = |[left, top]: [f32; 2], [right, bottom]: [f32; 2]| {
            let corners = [pos2(left, top), pos2(right, top), pos2(right, bottom), pos2(left, bottom)];
            let places = pixels_in(&corners, OutlineShape::Box, [8, 6]);
            places.iter().map(|at| [at.x as usize, at.y as usize]).collect::<Vec<_>>()
        };
        assert_eq!(within([1.2, 2.4], [4.9, 2.4]), [[1, 2], [2, 2], [3, 2], [4, 2]]);
        assert_eq!(within([7.0, 3.1], [7.0, 5.3]), [[7, 3], [7, 4], [7, 5]]);
        assert_eq!(within([1.9, 1.9], [2.1, 2.1]), [[1, 1], [2, 1], [1, 2], [2, 2]]);
        // The corner of the picture is the end of its last pixel.
        assert_eq!(within([7.5, 5.5], [8.0, 6.0]), [[7, 5]]);
        assert_eq!(pixels_in(&[pos2(3.7, 0.2)], OutlineShape::Box, [8, 6]), [pos2(3.5, 0.5)]);
    }

    #[test]
    fn colours_rise_and_a_constant_field_has_one() {
        let brightness = |share: f64| {
            let [r, g, b, _] = colored(share).to_array();
            u32::from(r) + 2 * u32::from(g) + u32::from(b)
        };
        assert!((0..20).all(|i| brightness(f64::from(i) / 20.0) < brightness(f64::from(i + 1) / 20.0)));
        assert_eq!(colored(f64::NAN), colored(0.0));
    }
}
