//! The generated block: constants, and the functions that name a scene's widgets one by one.

mod members;
mod tiles;

use crate::integrator::WgslCall;
use crate::kinds::{Light, Snippet};
use crate::parts::{Access, PartedArray, Parts};
use crate::shader_key::{Combine, CompositorProgram, Method, ShaderKey};

/// The block, and the pieces that it uses.
pub(crate) struct Generated {
    pub text: String,
    pub uses: Vec<&'static str>,
}

/// Slots that the block fills. `wave_mean_on_flank` it fills by choosing between the pieces that do.
#[cfg(test)]
pub(crate) const FILLS: &[&str] = &[
    "values",
    "numbers",
    "members",
    "segment",
    "finish",
    "wave_mean_on_flank",
    "positions",
    "quantity",
    "seen",
    "attributes",
    "tetrahedra",
    "bounds",
    "texels",
    "glows",
];

struct Block<'a> {
    shader_key: &'a ShaderKey,
    text: String,
    uses: Vec<&'static str>,
}

pub(crate) fn generate(shader_key: &ShaderKey) -> Generated {
    let mut block = Block { shader_key, text: String::new(), uses: vec!["scene"] };
    block.values();
    block.flanks();
    if shader_key.combine == Combine::Ordered
        || shader_key.widgets.iter().any(|w| shader_key.is_integrated(&w.kind))
    {
        block.members();
    }
    block.segment();
    if shader_key.reads_gradient() {
        block.surface();
    }
    match shader_key.compositor {
        CompositorProgram::None => {}
        CompositorProgram::Segments => block.finish(),
        CompositorProgram::Tiles(order) => block.finish_tiles(order),
        CompositorProgram::Raster(blend) => block.finish_blended("compositor/raster", blend),
        CompositorProgram::Triangles(blend) => block.finish_blended("compositor/triangles", blend),
    }
    Generated { text: block.text, uses: block.uses }
}

impl Block<'_> {
    fn line(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }

    fn uses(&mut self, pieces: &[&'static str]) {
        self.uses.extend_from_slice(pieces);
    }

    /// The text of a call for widget `i`, whose pieces are used from now on.
    fn call(&mut self, i: usize, call: &Snippet) -> String {
        self.uses(&call.pieces);
        call.text.replace('#', &i.to_string())
    }

    fn values(&mut self) {
        let shader_key = self.shader_key;
        self.numbers();
        let clipped = shader_key.widgets.iter().any(|widget| widget.edges.is_some());
        self.uses(&[if clipped { "part/clipped" } else { "part/whole" }]);
        self.line(format!("const VALUE_COUNT = {}u;", shader_key.value_count()));
        self.line(format!("const WIDGET_COUNT = {}u;", shader_key.widgets.len().max(1)));
        self.line("alias Values = array<f32, VALUE_COUNT>;");
        self.line("fn value_s(values: Values) -> f32 { return values[0]; }");
        let g = if shader_key.reads_gradient_magnitude { "values[1]" } else { "0.0" };
        self.line(format!("fn value_g(values: Values) -> f32 {{ return {g}; }}"));
        self.line("fn plane(values: Values) -> vec2f { return vec2f(value_s(values), value_g(values)); }");
    }

    /// Writes the readers of the scene's numbers, as vectors where any are among them.
    fn numbers(&mut self) {
        let shader_key = self.shader_key;
        let declared = |element, parts| {
            let numbers = PartedArray { name: "numbers", element, stride: None, parts };
            let text = numbers.declared(Access::Read, 0, ShaderKey::binding_of_numbers);
            (numbers, text)
        };
        if let Some(function) = shader_key.reads_vectors() {
            let (numbers, text) = declared("vec4f", shader_key.layout.table);
            self.text += &text;
            self.text += &numbers.read_by(function);
            self.text += &numbers.number_read_by("number");
        } else if shader_key.reads_numbers() {
            let (numbers, text) = declared("f32", Parts::WHOLE);
            self.text += &text;
            self.text += &numbers.read_by("number");
        }
    }

    /// The slot `wave_mean_on_flank`, by the kinds of waves that the scene has.
    fn flanks(&mut self) {
        let mut flanks: Vec<(&'static str, &'static str)> = Vec::new();
        for found in self.shader_key.widgets.iter().filter_map(|widget| widget.kind.flank()) {
            if !flanks.contains(&found) {
                flanks.push(found);
            }
        }
        // Equal sets give equal text.
        flanks.sort_unstable();
        let mean = match flanks.as_slice() {
            [] => return,
            [(_, only)] => format!("return {only}(bell, low, high);"),
            _ => "if bell.is_sine == 1u { return sine_mean_on_flank(bell, low, high); } \
                  return triangle_mean_on_flank(bell, low, high);"
                .to_owned(),
        };
        for (piece, _) in flanks {
            self.uses(&[piece]);
        }
        self.line(format!("fn wave_mean_on_flank(bell: Bell, low: Spot, high: Spot) -> f32 {{ {mean} }}"));
    }

    fn segment(&mut self) {
        let shader_key = self.shader_key;
        self.line("struct Contribution {\n    color: vec3f,\n    opacity: f32,\n    optical_depth: f32,\n}");
        // What is sampled, and what is subdivided as a whole, asks for no light of one widget alone.
        let whole = shader_key.method == Method::Adaptive && shader_key.combine == Combine::Ordered;
        if !shader_key.method.samples() && !whole {
            self.lights_alone();
        }
        self.line("fn segment(length: f32, front: Values, back: Values) -> Contribution {");
        match shader_key.method.call(shader_key.constant_emitter) {
            Some(WgslCall::Table { function, pieces }) => self.tabulated(function, pieces),
            _ if shader_key.combine == Combine::Nothing => {
                self.line("    return Contribution(vec3f(0.0), 0.0, 0.0);\n}");
            }
            Some(WgslCall::Samples { function, pieces, .. }) => self.sampled(function, pieces),
            None => self.closed_forms(),
        }
    }

    fn tabulated(&mut self, function: &str, pieces: &[&'static str]) {
        self.uses(pieces);
        self.uses(&["elementary/one_minus_exp"]);
        self.line(format!("    let found = {function}(length, value_s(front), value_s(back));"));
        self.line("    return Contribution(found.rgb, one_minus_exp(found.a), found.a);\n}");
    }

    fn sampled(&mut self, function: &str, pieces: &[&'static str]) {
        let shader_key = self.shader_key;
        self.parts();
        self.fill_members("    ");
        self.uses(pieces);
        self.uses(&["elementary/one_minus_exp"]);
        let scale = if shader_key.constant_emitter { "glow_scale(part_0) * " } else { "" };
        self.line(format!("    let found = {function}(members, scene.piece_count);"));
        self.line(format!("    return Contribution({scale}found.rgb, one_minus_exp(found.a), found.a);\n}}"));
    }

    /// Each widget's part of the segment.
    fn parts(&mut self) {
        let shader_key = self.shader_key;
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            let part = match widget.edges {
                None => "part_whole(length, front, back)".to_owned(),
                Some(count) => {
                    format!("part_inside(scene.widgets[{i}].first_edge, {count}u, length, front, back)")
                }
            };
            self.line(format!("    let part_{i} = {part};"));
        }
    }

    fn closed_forms(&mut self) {
        let shader_key = self.shader_key;
        self.uses(&["elementary/one_minus_exp"]);
        self.parts();
        self.line("    var depth = 0.0;");
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            let depth = self.shader_key.snippets(&widget.kind).depth;
            let depth = self.call(i, &depth);
            self.line(format!("    var depth_{i} = 0.0;"));
            self.line(format!("    if 0.0 < part_share(part_{i}) {{ depth_{i} = {depth}; }}"));
            self.line(format!("    depth += depth_{i};"));
        }
        self.line("    let opacity = one_minus_exp(depth);");
        match shader_key.combine {
            Combine::OneColor => self.line("    let color = scene.widgets[0].color * opacity;"),
            Combine::Alone => self.sum_of_lights("1.0"),
            Combine::Mix => {
                self.uses(&["overlap/mix"]);
                self.sum_of_lights("mix_share(depth_#, depth)");
            }
            Combine::Ordered if shader_key.method == Method::Adaptive => self.subdivided(),
            Combine::Ordered => self.ordered(),
            Combine::Nothing => {}
        }
        self.line("    return Contribution(color, opacity, depth);\n}");
    }

    /// Each widget's own light times `share`, in which # stands for its index.
    fn sum_of_lights(&mut self, share: &str) {
        self.line("    var color = vec3f(0.0);");
        let shader_key = self.shader_key;
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            let light = match self.shader_key.snippets(&widget.kind).light {
                Light::Closed(call) => self.call(i, &call),
                Light::Integrated => format!("light_alone_{i}(part_{i}, depth_{i})"),
            };
            let share = share.replace('#', &i.to_string());
            self.line(format!("    if 0.0 < part_share(part_{i}) {{ color += {share} * {light}; }}"));
        }
    }

    /// The ordered integral where order matters, else the mix, which is then as exact.
    fn ordered(&mut self) {
        let shader_key = self.shader_key;
        self.uses(&["overlap/mix"]);
        if shader_key.constant_emitter {
            // What glows need not absorb: only one widget, or no depth at all, is free of order.
            self.line("    var present = 0u;");
            for i in 0..shader_key.widgets.len() {
                self.line(format!("    present += select(0u, 1u, 0.0 < part_share(part_{i}));"));
            }
            self.line("    let order_matters = 1u < present && order_threshold < depth;");
        } else {
            // Σ_{i<j} T_i T_j, without cancellation: a stiff widget must not hide a thin one.
            self.line("    var product = 0.0;\n    var ahead = 0.0;");
            for i in 0..shader_key.widgets.len() {
                self.line(format!("    product += depth_{i} * ahead;\n    ahead += depth_{i};"));
            }
            self.line("    let order_matters = order_threshold < product;");
        }
        self.text.insert_str(
            0,
            "// Depth, or product of depths, up to which the order of widgets is left out.\n\
             override order_threshold: f32 = 1e-8;\n",
        );
        self.sum_of_lights("mix_share(depth_#, depth)");
        self.line("    if order_matters {");
        self.fill_members("        ");
        let integral = self.ordered_integral(0, "depth");
        self.line(format!("        color = {integral};\n    }}"));
    }

    fn surface(&mut self) {
        let (silhouette, light) = (self.shader_key.silhouette, self.shader_key.light);
        self.line(
            "// Song et al. 2009, section 6.2, and diffuse light: `gradient` at the middle of the segment.",
        );
        self.line("fn surface(found: Contribution, gradient: vec3f, view: vec3f) -> Contribution {");
        self.line("    var opacity = 1.0;\n    var light = 1.0;");
        if silhouette {
            self.uses(&["light/silhouette"]);
            self.line("    opacity = silhouette_factor(gradient, view, scene.silhouette_exponent);");
        }
        if light {
            self.uses(&["light/diffuse"]);
            self.line(
                "    light = diffuse_factor(gradient, scene.light_direction, scene.light_ambient, \
                 scene.light_diffuse);",
            );
        }
        self.line("    let color = found.color * (opacity * light);");
        self.line("    return Contribution(color, found.opacity * opacity, found.optical_depth);\n}");
    }

    fn finish(&mut self) {
        let shader_key = self.shader_key;
        self.uses(&["compositor/segments"]);
        self.line(format!("const SEGMENT_STRIDE = {}u;", shader_key.segment_stride()));
        self.line("fn finish(found: Contribution, first: u32) -> Contribution {");
        let result = match (shader_key.reads_gradient(), shader_key.silhouette) {
            (false, _) => "found",
            (true, false) => "surface(found, segment_vector(first), vec3f(0.0))",
            (true, true) => "surface(found, segment_vector(first), segment_vector(first + 3u))",
        };
        self.line(format!("    return {result};\n}}"));
    }
}
