//! The widgets as members of an ordered integral, or of what is sampled.

use super::Block;
use crate::kinds::Mixing;
use crate::shader_key::{Combine, Method, WidgetChoice};
use std::fmt::Write as _;

impl Block<'_> {
    /// The widgets as members. Where the only need for them is a widget alone that has no closed form, the list holds
    /// such widgets, absent ones with an empty range.
    pub(super) fn members(&mut self) {
        let emitter = if self.shader_key.constant_emitter {
            "overlap/constant_emitter"
        } else {
            "overlap/density_emitter"
        };
        self.uses(&[emitter]);
        let shader_key = self.shader_key;
        let (mut fields, mut breaks, mut lights) = (String::new(), String::new(), String::new());
        for (i, widget) in shader_key.widgets.iter().enumerate() {
            if shader_key.combine != Combine::Ordered && !shader_key.is_integrated(&widget.kind) {
                continue;
            }
            let calls = shader_key.snippets(&widget.kind);
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
    pub(super) fn lights_alone(&mut self) {
        let shader_key = self.shader_key;
        for (i, widget) in
            shader_key.widgets.iter().enumerate().filter(|(_, w)| shader_key.is_integrated(&w.kind))
        {
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
    pub(super) fn fill_members(&mut self, indent: &str) {
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
    pub(super) fn ordered_integral(&mut self, i: usize, depth: &str) -> String {
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
    pub(super) fn subdivided(&mut self) {
        let shader_key = self.shader_key;
        self.fill_members("    ");
        let integral = self.ordered_integral(0, "depth");
        let bounded = |widget: &WidgetChoice| match shader_key.snippets(&widget.kind).mixing {
            Mixing::Bounded => true,
            Mixing::DensityOnly => !shader_key.constant_emitter,
            Mixing::Unbounded => false,
        };
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
        let calls = self.shader_key.snippets(&widget.kind);
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
