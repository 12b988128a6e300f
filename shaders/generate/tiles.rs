//! What the tiles' compositors ask of the generated block.

use super::Block;
use crate::choices::TileOrder;
use crate::parts::{TILES_READ, grid_text};

impl Block<'_> {
    /// What tiles make of a segment: the gradient stands behind the values of its cell's points.
    pub(super) fn finish_tiles(&mut self, order: TileOrder) {
        let choices = self.choices;
        self.uses(&[match order {
            TileOrder::Exact => "compositor/tiles_exact",
            TileOrder::Listed => "compositor/tiles_listed",
            TileOrder::Sum => "compositor/tiles_sum",
        }]);
        self.line(format!("const ATTRIBUTE_STRIDE = {}u;", choices.attribute_stride()));
        self.text.push_str(&grid_text(TILES_READ, &choices.layout));
        if order == TileOrder::Sum {
            self.line(format!("const DEPTHS_ADD_UP = {};", !choices.reads_gradient()));
        }
        self.line("fn finish(found: Contribution, points: vec4u, middle: vec4f, ray: Ray) -> Contribution {");
        if choices.reads_gradient() {
            let first = choices.value_count() - 1;
            let at = |i: usize| format!("attribute_at(points, middle, {}u)", first + i);
            self.line(format!("    let gradient = vec3f({}, {}, {});", at(0), at(1), at(2)));
            let view = if choices.silhouette { "ray_direction(ray)" } else { "vec3f(0.0)" };
            self.line(format!("    return surface(found, gradient, {view});\n}}"));
        } else {
            self.line("    return found;\n}");
        }
    }
}
