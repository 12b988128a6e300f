//! Text of the shader of a scene: the pieces of its key behind a generated block of constants and of functions that name the
//! scene's widgets one by one.

use crate::kinds::Snippet;
use crate::passes::{Access, FramePass, Layout, PartedArray, Parts, cells_read, grid_text};
use crate::shader_key::{
    AxisShape, Blend, Combine, CompositorProgram, Method, ShaderKey, TileOrder, WgslCall, WidgetChoice,
};
use crate::text::{PIECES, Shader, WgslPiece, compose_pieces_with};
use std::fmt::Write as _;

impl Shader {
    /// The pieces that are not in it although some scene asks for them: what makes frames and what is measured is put together apart.
    pub fn leaves_out(&self) -> Vec<&'static WgslPiece> {
        let frames: Vec<Shader> = FramePass::ALL.iter().map(|pass| pass.shader(&Layout::WHOLE)).collect();
        let holds = |shader: &Shader, piece: &WgslPiece| shader.files().any(|file| file == piece.file);
        let apart = |piece: &WgslPiece| {
            piece.name.starts_with("measured/") || frames.iter().any(|frame| holds(frame, piece))
        };
        PIECES.iter().filter(|piece| !apart(piece) && !holds(self, piece)).collect()
    }
}

struct Block<'a> {
    shader_key: &'a ShaderKey,
    text: String,
    uses: Vec<&'static str>,
}

/// The shader of a scene.
pub fn compose(shader_key: &ShaderKey) -> Shader {
    let mut block = Block { shader_key, text: String::new(), uses: vec!["scene"] };
    block.values();
    block.flanks();
    if shader_key.combine == Combine::Ordered
        || shader_key.widgets.iter().any(|w| w.kind.is_integrated(shader_key.constant_emitter))
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
    compose_pieces_with(&block.text, &block.uses, shader_key.method.pieces())
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
        let curved = shader_key.curved_axes.is_some();
        let name = if curved { "straight_segment" } else { "segment" };
        self.line(format!("fn {name}(length: f32, front: Values, back: Values) -> Contribution {{"));
        match shader_key.method.call(shader_key.constant_emitter) {
            Some(WgslCall::Table { function, pieces }) => self.tabulated(function, pieces),
            _ if shader_key.combine == Combine::Nothing => {
                self.line("    return Contribution(vec3f(0.0), 0.0, 0.0);\n}");
            }
            Some(WgslCall::Samples { function, pieces, .. }) => self.sampled(function, pieces),
            None => self.closed_forms(),
        }
        if let Some(shapes) = shader_key.curved_axes {
            self.along_curved_axes(shapes);
        }
    }

    /// Cuts segments along curved axes, and finds positions on them.
    fn along_curved_axes(&mut self, shapes: [AxisShape; 2]) {
        self.uses(&["axes/curved"]);
        let both = |name: &str, shape: fn(AxisShape) -> bool| {
            let [s, g] = shapes.map(shape);
            format!("const {name} = vec2<bool>({s}, {g});")
        };
        self.line(both("IS_CURVED", |shape| shape != AxisShape::Linear));
        self.line(both("IS_LOG", |shape| shape == AxisShape::Log));
        for (function, argument) in [("position", "value"), ("value", "position")] {
            self.line(format!("fn axis_{function}(axis: u32, {argument}: f32) -> f32 {{"));
            for (axis, shape) in shapes.into_iter().enumerate() {
                let (piece, prefix) = match shape {
                    AxisShape::Linear => continue,
                    AxisShape::Log => ("axes/log", "log"),
                    AxisShape::SymLog => ("axes/symlog", "symlog"),
                };
                self.uses(&[piece]);
                let call = format!("{prefix}_{function}(axis_number({axis}u), {argument})");
                self.line(format!("    if axis == {axis}u {{ return {call}; }}"));
            }
            self.line(format!("    return {argument};\n}}"));
        }
        let first_field = 1 + usize::from(self.shader_key.reads_gradient_magnitude);
        self.line(format!("const FIRST_FIELD = {first_field}u;"));
        self.line("fn with_positions(values: Values, positions: vec2f) -> Values {");
        self.line("    var placed = values;\n    placed[0] = positions.x;");
        if self.shader_key.reads_gradient_magnitude {
            self.line("    placed[1] = positions.y;");
        }
        self.line("    return placed;\n}");
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
            let depth = widget.kind.snippets(self.shader_key.constant_emitter).depth;
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
            let light = match widget.kind.snippets(self.shader_key.constant_emitter).light {
                Some(call) => self.call(i, &call),
                None => format!("light_alone_{i}(part_{i}, depth_{i})"),
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

    /// The widgets as members. Where the only need for them is a widget alone that has no closed form, the list holds
    /// such widgets, absent ones with an empty range.
    fn members(&mut self) {
        let shader_key = self.shader_key;
        let constant = shader_key.constant_emitter;
        self.uses(&[if constant { "overlap/constant_emitter" } else { "overlap/density_emitter" }]);
        let (mut fields, mut breaks, mut lights) = (String::new(), String::new(), String::new());
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            if shader_key.combine != Combine::Ordered && !widget.kind.is_integrated(constant) {
                continue;
            }
            let calls = widget.kind.snippets(constant);
            let (track, next) = (calls.track_type, calls.next_break.replace('#', &i.to_string()));
            self.uses(&calls.track.pieces);
            let light = self.call(i, &calls.member_light);
            let _ = writeln!(fields, "    member_{i}: Member,\n    track_{i}: {track},");
            let _ =
                writeln!(breaks, "    next = min(next, member_next_break(members.member_{i}, t, {next}));");
            let _ = writeln!(lights, "    light += {light};");
        }
        self.line(format!("struct Members {{\n{fields}}}"));
        self.line("fn members_next_break(members: Members, t: f32) -> f32 {\n    var next = 2.0;");
        self.line(format!("{breaks}    return next;\n}}"));
        self.line("fn members_light(members: Members, at: vec4f) -> mat4x4f {\n    var light = mat4x4f();");
        self.line(format!("{lights}    return light;\n}}"));
    }

    /// The light of each widget alone that has no closed form: the others have an empty range.
    fn lights_alone(&mut self) {
        let shader_key = self.shader_key;
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            if !widget.kind.is_integrated(shader_key.constant_emitter) {
                continue;
            }
            let (member, track) = self.member(i, widget);
            let integral = self.ordered_integral(i, &format!("depth_{i}"));
            self.line(format!(
                "fn light_alone_{i}(part_{i}: Part, depth_{i}: f32) -> vec3f {{\n    var members = Members();"
            ));
            self.line(format!("    members.track_{i} = {track};\n    members.member_{i} = {member};"));
            self.line(format!("    return {integral};\n}}"));
        }
    }

    /// The variable `members`, filled from the parts of all widgets.
    fn fill_members(&mut self, indent: &str) {
        self.line(format!("{indent}var members = Members();"));
        let shader_key = self.shader_key;
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            let (member, track) = self.member(i, widget);
            self.line(format!("{indent}members.track_{i} = {track};"));
            self.line(format!("{indent}members.member_{i} = {member};"));
        }
    }

    /// The ordered integral over `members`, exact or to the tolerance; `i`: any of the widgets that have a part, `depth`:
    /// T of those that are in it.
    fn ordered_integral(&mut self, i: usize, depth: &str) -> String {
        let constant = self.shader_key.constant_emitter;
        let scale = if constant { format!("glow_scale(part_{i})") } else { String::new() };
        let integral = if self.shader_key.method == Method::Adaptive {
            let stake = if constant { "adaptive/constant_stake" } else { "adaptive/density_stake" };
            self.uses(&["adaptive/march", stake]);
            let members = self.shader_key.widgets.len();
            if constant {
                format!(
                    "march(members, {depth}, scene.tolerance / max({scale}, 1e-37), {members}.0 * scene.brightest)"
                )
            } else {
                format!("march(members, {depth}, scene.tolerance, scene.brightest)")
            }
        } else {
            self.uses(&["overlap/ordered"]);
            "ordered(members)".to_owned()
        };
        if constant { format!("{scale} * {integral}") } else { integral }
    }

    /// The mix where the bound of its error keeps the tolerance, else the ordered integral.
    fn subdivided(&mut self) {
        let shader_key = self.shader_key;
        self.fill_members("    ");
        let integral = self.ordered_integral(0, "depth");
        let bounded =
            |widget: &WidgetChoice| widget.kind.snippets(shader_key.constant_emitter).is_mix_bounded;
        if !shader_key.widgets.iter().all(bounded) {
            self.line(format!("    let color = {integral};"));
            return;
        }
        self.uses(&["adaptive/mixed"]);
        let (mut light, mut whole) = (Vec::new(), Vec::new());
        for i in 0..shader_key.widgets.len() {
            let color = format!("scene.widgets[{i}].color");
            let part = if shader_key.constant_emitter {
                let member = format!("members.member_{i}");
                format!("mixed_constant({color}, {member}.range, {member}.window, depth)")
            } else {
                format!("mixed_density({color}, depth_{i}, depth)")
            };
            self.line(format!("    let mixed_{i} = {part};"));
            light.push(format!("mixed_{i}.light * mixed_{i}.color"));
            whole.push(format!("mixed_{i}.light"));
        }
        self.line(format!("    var color = {};", light.join(" + ")));
        let mean = if shader_key.constant_emitter {
            "vec3f(0.0)".to_owned()
        } else {
            format!("color / max({}, 1e-37)", whole.join(" + "))
        };
        self.line(format!("    let mean = {mean};\n    var slack = MixedError(vec3f(0.0), vec3f(0.0));"));
        for i in 0..shader_key.widgets.len() {
            self.line(format!("    slack = mixed_add(slack, mixed_{i}, mean);"));
        }
        let scale = if shader_key.constant_emitter { "glow_scale(part_0)" } else { "1.0" };
        self.line(format!(
            "    color *= {scale};\n    if scene.tolerance < {scale} * mixed_largest(slack) {{ color = {integral}; }}"
        ));
    }

    /// Expressions of a widget's member and track.
    fn member(&mut self, i: usize, widget: &WidgetChoice) -> (String, String) {
        let calls = widget.kind.snippets(self.shader_key.constant_emitter);
        let track = self.call(i, &calls.track);
        let everywhere = || "vec2f(-1.0, 2.0)".to_owned();
        let (window, threshold) = if self.shader_key.constant_emitter {
            let window = calls.window.map_or_else(everywhere, |window| self.call(i, &window));
            (window, calls.threshold.replace('#', &i.to_string()))
        } else {
            (everywhere(), "0.0".to_owned())
        };
        (format!("Member(part_range(part_{i}), {window}, {threshold})"), track)
    }
}

/// Values of which a workgroup keeps those at the corners of a chunk's cells: with these it takes 14.5 of the 16 KiB that
/// every device has.
const VALUES_KEPT: usize = 8;

impl Block<'_> {
    fn finish_tiles(&mut self, order: TileOrder) {
        self.uses(&[match order {
            TileOrder::Exact | TileOrder::Cut => "compositor/tiles_exact",
            TileOrder::Listed => "compositor/tiles_listed",
            TileOrder::Sum => "compositor/tiles_sum",
        }]);
        if matches!(order, TileOrder::Exact | TileOrder::Cut) {
            let is_cut = order == TileOrder::Cut;
            self.uses(&[if is_cut { "compositor/segments_cut" } else { "compositor/segments_whole" }]);
        } else {
            let is_kept = self.shader_key.value_count() <= VALUES_KEPT;
            self.uses(&[if is_kept { "compositor/corners_kept" } else { "compositor/corners_read" }]);
        }
        self.finish_pixels(order == TileOrder::Sum);
    }

    /// Writes the entry points of a blending compositor and the contents of its pixels.
    fn finish_blended(&mut self, drawing: &'static str, blend: Blend) {
        let holds = match blend {
            Blend::Over => "compositor/blend_over",
            Blend::Sum => "compositor/blend_sum",
        };
        self.uses(&[drawing, holds]);
        self.finish_pixels(blend == Blend::Sum);
    }

    /// Writes the colour of a segment at a pixel: the gradient stands behind the values of its cell's points.
    fn finish_pixels(&mut self, is_sum: bool) {
        let shader_key = self.shader_key;
        let stride = shader_key.attribute_stride();
        self.line(format!("const ATTRIBUTE_STRIDE = {stride}u;"));
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
