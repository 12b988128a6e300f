//! Generated functions that the compositors of pixels call.

use super::Block;
use crate::parts::{cells_read, grid_text};
use crate::shader_key::{Blend, TileOrder};

/// Values of which a workgroup keeps those at the corners of a chunk's cells: with these it takes 14.5 of the 16 KiB that
/// every device has.
const VALUES_KEPT: usize = 8;

impl Block<'_> {
    pub(super) fn finish_tiles(&mut self, order: TileOrder) {
        self.uses(&[match order {
            TileOrder::Exact => "compositor/tiles_exact",
            TileOrder::Listed => "compositor/tiles_listed",
            TileOrder::Sum => "compositor/tiles_sum",
        }]);
        if order != TileOrder::Exact {
            let is_kept = self.shader_key.value_count() <= VALUES_KEPT;
            self.uses(&[if is_kept { "compositor/corners_kept" } else { "compositor/corners_read" }]);
        }
        self.finish_pixels(order == TileOrder::Sum);
    }

    /// Writes the entry points of a blending compositor and the contents of its pixels.
    pub(super) fn finish_blended(&mut self, drawing: &'static str, blend: Blend) {
        let holds = match blend {
            Blend::Over => "compositor/blend_over",
            Blend::Sum => "compositor/blend_sum",
            Blend::Rounded { .. } => "compositor/blend_rounded",
        };
        self.uses(&[drawing, holds]);
        if matches!(blend, Blend::Rounded { .. }) {
            self.line(format!("const BLENDED_ABOUT = {:.1};", blend.about()));
        }
        self.finish_pixels(blend == Blend::Sum);
    }

    /// Writes the colour of a segment at a pixel: the gradient stands behind the values of its cell's points.
    fn finish_pixels(&mut self, is_sum: bool) {
        let shader_key = self.shader_key;
        self.line(format!("const ATTRIBUTE_STRIDE = {}u;", shader_key.attribute_stride()));
        let stride = shader_key.attribute_stride();
        self.text.push_str(&grid_text(cells_read(stride), &shader_key.layout));
        if stride == 0 {
            self.line("fn attribute_of(index: u32, slot: u32) -> f32 { return 0.0; }");
        }
        if is_sum {
            self.line(format!("const DEPTHS_ADD_UP = {};", shader_key.depths_add_up()));
        }
        self.line("fn finish(found: Contribution, points: vec4u, middle: vec4f, ray: Ray) -> Contribution {");
        if shader_key.reads_gradient() {
            let first = shader_key.value_count() - 1;
            let at = |i: usize| format!("attribute_at(points, middle, {}u)", first + i);
            self.line(format!("    let gradient = vec3f({}, {}, {});", at(0), at(1), at(2)));
            let view = if shader_key.silhouette { "ray_direction(ray)" } else { "vec3f(0.0)" };
            self.line(format!("    return surface(found, gradient, {view});\n}}"));
        } else {
            self.line("    return found;\n}");
        }
    }
}
