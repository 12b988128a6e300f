//! The generated block: constants, and the functions that name a scene's widgets one by one.

use crate::choices::{Choices, Combine, Compositor, Kind, WidgetChoice};
use std::fmt::Write as _;

/// The block, and the pieces that it uses.
pub(crate) struct Generated {
    pub text: String,
    pub uses: Vec<&'static str>,
}

/// Slots that the block fills. `wave_mean_on_flank` it fills by choosing between the pieces that do.
#[cfg(test)]
pub(crate) const FILLS: &[&str] = &["values", "members", "segment", "wave_mean_on_flank"];

struct Block<'a> {
    choices: &'a Choices,
    text: String,
    uses: Vec<&'static str>,
}

pub(crate) fn generate(choices: &Choices) -> Generated {
    let mut block = Block { choices, text: String::new(), uses: vec!["scene"] };
    block.values();
    block.waves();
    if choices.combine == Combine::Ordered || block.alone_by_quadrature() {
        block.members();
    }
    block.segment();
    if choices.reads_gradient() {
        block.surface();
    }
    if choices.compositor == Compositor::Segments {
        block.finish();
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

    fn values(&mut self) {
        let choices = self.choices;
        if choices.reads_numbers() {
            self.uses(&["numbers"]);
        }
        let clipped = choices.widgets.iter().any(|widget| widget.edges.is_some());
        self.uses(&[if clipped { "part/clipped" } else { "part/whole" }]);
        self.line(format!("const VALUE_COUNT = {}u;", choices.value_count()));
        self.line(format!("const WIDGET_COUNT = {}u;", choices.widgets.len().max(1)));
        self.line("alias Values = array<f32, VALUE_COUNT>;");
        self.line("fn value_s(values: Values) -> f32 { return values[0]; }");
        let g = if choices.reads_gradient_magnitude { "values[1]" } else { "0.0" };
        self.line(format!("fn value_g(values: Values) -> f32 {{ return {g}; }}"));
        self.line("fn plane(values: Values) -> vec2f { return vec2f(value_s(values), value_g(values)); }");
    }

    fn has(&self, kind: &Kind) -> bool {
        self.choices.widgets.iter().any(|widget| widget.kind == *kind)
    }

    fn waves(&mut self) {
        let (triangle, sine) = (self.has(&Kind::TriangleWave), self.has(&Kind::SineWave));
        let mean = match (triangle, sine) {
            (false, false) => return,
            (true, false) => "return triangle_mean_on_flank(bell, low, high);",
            (false, true) => "return sine_mean_on_flank(bell, low, high);",
            (true, true) => {
                "if bell.is_sine == 1u { return sine_mean_on_flank(bell, low, high); } \
                 return triangle_mean_on_flank(bell, low, high);"
            }
        };
        if triangle {
            self.uses(&["wave/triangle"]);
        }
        if sine {
            self.uses(&["wave/sine"]);
        }
        self.line(format!("fn wave_mean_on_flank(bell: Bell, low: Spot, high: Spot) -> f32 {{ {mean} }}"));
    }

    /// A triangular Gaussian alone has no closed form under the constant-emitter.
    fn alone_by_quadrature(&self) -> bool {
        self.choices.constant_emitter && self.has(&Kind::Triangular)
    }

    /// The path of a Gaussian, over the whole segment or inside its region.
    fn path(&mut self, i: usize, widget: &WidgetChoice, which: &str) -> String {
        let (piece, name, count) = match widget.kind {
            Kind::GaussianLine => ("widgets/gaussian_line", "line", String::new()),
            Kind::GaussianPlane => ("widgets/gaussian_plane", "plane", String::new()),
            Kind::GaussianFields(count) => ("widgets/gaussian_fields", "fields", format!("{count}u, ")),
            _ => unreachable!("only Gaussians have paths"),
        };
        self.uses(&[piece]);
        format!("gaussian_{name}_{which}({i}u, {count}part_{i})")
    }

    fn depth(&mut self, i: usize, widget: &WidgetChoice) -> String {
        let (piece, call) = match widget.kind {
            Kind::Uniform => ("widgets/uniform", format!("uniform_depth({i}u, part_{i})")),
            Kind::Triangular => ("widgets/triangular", format!("triangular_depth({i}u, part_{i})")),
            Kind::TriangleWave | Kind::SineWave => ("widgets/wave", format!("wave_depth({i}u, part_{i})")),
            Kind::Piecewise(count) => {
                ("widgets/piecewise_depth", format!("piecewise_depth({i}u, {count}u, part_{i})"))
            }
            _ => {
                let path = self.path(i, widget, "inside");
                ("widgets/gaussian_depth", format!("gaussian_depth({i}u, part_{i}, {path})"))
            }
        };
        self.uses(&[piece]);
        call
    }

    /// C of a widget that is alone on the segment.
    fn light(&mut self, i: usize, widget: &WidgetChoice) -> String {
        let (piece, call) = match (&widget.kind, self.choices.constant_emitter) {
            (Kind::Piecewise(count), false) => {
                let call = format!("piecewise_density_light({i}u, {count}u, part_{i})");
                ("widgets/piecewise_density_light", call)
            }
            (_, false) => ("widgets/density_light", format!("density_light({i}u, depth_{i})")),
            (Kind::Piecewise(count), true) => {
                ("widgets/piecewise_light", format!("piecewise_light({i}u, {count}u, part_{i})"))
            }
            (Kind::Uniform, true) => {
                ("widgets/uniform_light", format!("uniform_light({i}u, part_{i}, depth_{i})"))
            }
            (Kind::TriangleWave | Kind::SineWave, true) => {
                ("widgets/wave_light", format!("wave_light({i}u, part_{i})"))
            }
            (Kind::Triangular, true) => {
                self.uses(&["overlap/ordered"]);
                let call = format!("triangular_light_{i}(part_{i})");
                ("widgets/triangular_track", call)
            }
            (_, true) => {
                let path = self.path(i, widget, "inside");
                ("widgets/gaussian_light", format!("gaussian_light({i}u, part_{i}, {path})"))
            }
        };
        self.uses(&[piece]);
        call
    }

    /// The widgets as members of the ordered integral. Where the only need for it is a triangular Gaussian alone, the
    /// list holds triangular Gaussians, absent ones with an empty range.
    fn members(&mut self) {
        let emitter = if self.choices.constant_emitter {
            "overlap/constant_emitter"
        } else {
            "overlap/density_emitter"
        };
        self.uses(&["overlap/ordered", emitter]);
        let choices = self.choices;
        let (mut fields, mut breaks, mut lights) = (String::new(), String::new(), String::new());
        for (i, widget) in choices.widgets.iter().enumerate() {
            let (piece, stem, track) = track(&widget.kind);
            if choices.combine != Combine::Ordered && widget.kind != Kind::Triangular {
                continue;
            }
            self.uses(&[piece]);
            let _ = writeln!(fields, "    member_{i}: Member,\n    track_{i}: {track},");
            let _ = writeln!(
                breaks,
                "    next = min(next, member_next_break(members.member_{i}, t, \
                 {stem}_next_break(members.track_{i}, t)));"
            );
            let call = if matches!(widget.kind, Kind::Piecewise(_)) {
                self.uses(&["overlap/member_colors"]);
                format!(
                    "member_colors_light(members.member_{i}, piecewise_colors(members.track_{i}, at), at, \
                     {stem}_rates(members.track_{i}, at))"
                )
            } else {
                format!(
                    "member_light(members.member_{i}, scene.widgets[{i}].color, at, \
                     {stem}_rates(members.track_{i}, at))"
                )
            };
            let _ = writeln!(lights, "    light += {call};");
        }
        self.line(format!("struct Members {{\n{fields}}}"));
        self.line("fn members_next_break(members: Members, t: f32) -> f32 {\n    var next = 2.0;");
        self.line(format!("{breaks}    return next;\n}}"));
        self.line("fn members_light(members: Members, at: vec4f) -> mat4x4f {\n    var light = mat4x4f();");
        self.line(format!("{lights}    return light;\n}}"));
        for (i, widget) in choices.widgets.iter().enumerate() {
            if choices.constant_emitter && widget.kind == Kind::Triangular {
                let text = self.alone_among_members(i);
                self.line(text);
            }
        }
    }

    /// The ordered integral of widget `alone` alone: the others have an empty range.
    fn alone_among_members(&mut self, alone: usize) -> String {
        let mut text = format!("fn triangular_light_{alone}(part_{alone}: Part) -> vec3f {{\n");
        text += "    var members = Members();\n";
        let choices = self.choices;
        let (member, track) = self.member(alone, &choices.widgets[alone]);
        let _ = writeln!(text, "    members.track_{alone} = {track};");
        let _ = writeln!(text, "    members.member_{alone} = {member};");
        text + &format!("    return glow_scale(part_{alone}) * ordered(members);\n}}")
    }

    /// Expressions of a widget's member and track.
    fn member(&mut self, i: usize, widget: &WidgetChoice) -> (String, String) {
        let constant = self.choices.constant_emitter;
        let track = match widget.kind {
            Kind::Uniform => format!("uniform_track({i}u, part_{i})"),
            Kind::Triangular => format!("triangular_track({i}u, part_{i})"),
            Kind::TriangleWave | Kind::SineWave => format!("wave_widget_track({i}u, part_{i})"),
            Kind::Piecewise(count) => format!("piecewise_track({i}u, {count}u, part_{i})"),
            _ => {
                let path = self.path(i, widget, "whole");
                format!("gaussian_track({path}, widget_rate({i}u, part_{i}))")
            }
        };
        let everywhere = "vec2f(-1.0, 2.0)".to_owned();
        let (window, threshold) = match widget.kind {
            _ if !constant => (everywhere, "0.0".to_owned()),
            // Within its window it glows, whatever the rounding of the rate.
            Kind::Triangular => {
                (format!("triangular_window_ends(members.track_{i}, scene.level)"), "0.0".to_owned())
            }
            Kind::GaussianLine | Kind::GaussianPlane | Kind::GaussianFields(_) => {
                let path = self.path(i, widget, "whole");
                (format!("gaussian_window_ends({path}, scene.level)"), "0.0".to_owned())
            }
            Kind::Piecewise(_) => {
                (everywhere, format!("widget_rate({i}u, part_{i}) * scene.widgets[{i}].matrix.x"))
            }
            _ => (everywhere, format!("widget_rate({i}u, part_{i}) * scene.cutoff")),
        };
        (format!("Member(part_range(part_{i}), {window}, {threshold})"), track)
    }

    fn segment(&mut self) {
        let choices = self.choices;
        self.line("struct Contribution {\n    color: vec3f,\n    opacity: f32,\n    optical_depth: f32,\n}");
        self.line("fn segment(length: f32, front: Values, back: Values) -> Contribution {");
        if choices.combine == Combine::Nothing {
            self.line("    return Contribution(vec3f(0.0), 0.0, 0.0);\n}");
            return;
        }
        self.uses(&["elementary/one_minus_exp"]);
        self.line("    var depth = 0.0;");
        for (i, widget) in choices.widgets.iter().enumerate() {
            let part = match widget.edges {
                None => "part_whole(length, front, back)".to_owned(),
                Some(count) => {
                    format!("part_inside(scene.widgets[{i}].first_edge, {count}u, length, front, back)")
                }
            };
            let depth = self.depth(i, widget);
            self.line(format!("    let part_{i} = {part};\n    var depth_{i} = 0.0;"));
            self.line(format!("    if 0.0 < part_share(part_{i}) {{ depth_{i} = {depth}; }}"));
            self.line(format!("    depth += depth_{i};"));
        }
        self.line("    let opacity = one_minus_exp(depth);");
        match choices.combine {
            Combine::OneColor => self.line("    let color = scene.widgets[0].color * opacity;"),
            Combine::Alone => self.sum_of_lights("1.0"),
            Combine::Mix => {
                self.uses(&["overlap/mix"]);
                self.sum_of_lights("mix_share(depth_#, depth)");
            }
            Combine::Ordered => self.ordered(),
            Combine::Nothing => {}
        }
        self.line("    return Contribution(color, opacity, depth);\n}");
    }

    /// Each widget's own light times `share`, in which # stands for its index.
    fn sum_of_lights(&mut self, share: &str) {
        self.line("    var color = vec3f(0.0);");
        let choices = self.choices;
        for (i, widget) in choices.widgets.iter().enumerate() {
            let light = self.light(i, widget);
            let share = share.replace('#', &i.to_string());
            self.line(format!("    if 0.0 < part_share(part_{i}) {{ color += {share} * {light}; }}"));
        }
    }

    /// The ordered integral where order matters, else the mix, which is then as exact.
    fn ordered(&mut self) {
        let choices = self.choices;
        self.uses(&["overlap/mix"]);
        if choices.constant_emitter {
            // What glows need not absorb: only one widget, or no depth at all, is free of order.
            self.line("    var present = 0u;");
            for i in 0..choices.widgets.len() {
                self.line(format!("    present += select(0u, 1u, 0.0 < part_share(part_{i}));"));
            }
            self.line("    let order_matters = 1u < present && order_threshold < depth;");
        } else {
            // Σ_{i<j} T_i T_j, without cancellation: a stiff widget must not hide a thin one.
            self.line("    var product = 0.0;\n    var ahead = 0.0;");
            for i in 0..choices.widgets.len() {
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
        self.line("    if order_matters {\n        var members = Members();");
        for (i, widget) in choices.widgets.iter().enumerate() {
            let (member, track) = self.member(i, widget);
            self.line(format!("        members.track_{i} = {track};"));
            self.line(format!("        members.member_{i} = {member};"));
        }
        let scale = if choices.constant_emitter { "glow_scale(part_0) * " } else { "" };
        self.line(format!("        color = {scale}ordered(members);\n    }}"));
    }

    fn surface(&mut self) {
        let (silhouette, light) = (self.choices.silhouette, self.choices.light);
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
        let choices = self.choices;
        self.uses(&["compositor/segments"]);
        self.line(format!("const SEGMENT_STRIDE = {}u;", choices.segment_stride()));
        self.line("fn finish(found: Contribution, first: u32) -> Contribution {");
        let result = match (choices.reads_gradient(), choices.silhouette) {
            (false, _) => "found",
            (true, false) => "surface(found, segment_vector(first), vec3f(0.0))",
            (true, true) => "surface(found, segment_vector(first), segment_vector(first + 3u))",
        };
        self.line(format!("    return {result};\n}}"));
    }
}

/// The piece, the stem of the functions and the type of a widget's track.
fn track(kind: &Kind) -> (&'static str, &'static str, &'static str) {
    match kind {
        Kind::Uniform => ("widgets/uniform_track", "uniform", "UniformTrack"),
        Kind::Triangular => ("widgets/triangular_track", "triangular", "TriangularTrack"),
        Kind::TriangleWave | Kind::SineWave => ("widgets/wave_track", "wave", "WaveTrack"),
        Kind::Piecewise(_) => ("widgets/piecewise_track", "piecewise", "PiecewiseTrack"),
        Kind::GaussianLine | Kind::GaussianPlane | Kind::GaussianFields(_) => {
            ("gaussian/track", "gaussian", "GaussianTrack")
        }
    }
}
