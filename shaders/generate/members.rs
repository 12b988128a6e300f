//! The widgets as members of an ordered integral, or of what is sampled.

use super::Block;
use super::widgets::track;
use crate::choices::{Combine, Kind, Method, WidgetChoice};
use std::fmt::Write as _;

impl Block<'_> {
    /// The widgets as members. Where the only need for them is a widget alone that has no closed form, the list holds
    /// such widgets, absent ones with an empty range.
    pub(super) fn members(&mut self) {
        let emitter = if self.choices.constant_emitter {
            "overlap/constant_emitter"
        } else {
            "overlap/density_emitter"
        };
        self.uses(&[emitter]);
        let choices = self.choices;
        let (mut fields, mut breaks, mut lights) = (String::new(), String::new(), String::new());
        for (i, widget) in choices.widgets.iter().enumerate() {
            let (piece, stem, track) = track(&widget.kind);
            if choices.combine != Combine::Ordered && !choices.is_integrated(&widget.kind) {
                continue;
            }
            self.uses(&[piece]);
            let _ = writeln!(fields, "    member_{i}: Member,\n    track_{i}: {track},");
            let _ = writeln!(
                breaks,
                "    next = min(next, member_next_break(members.member_{i}, t, \
                 {stem}_next_break(members.track_{i}, t)));"
            );
            let call = if widget.kind == Kind::Table {
                self.uses(&["overlap/member_colors"]);
                format!(
                    "member_texels_light(members.member_{i}, table_texels(members.track_{i}, at), at, \
                     members.track_{i}.peak)"
                )
            } else if matches!(widget.kind, Kind::Piecewise(_)) {
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
    }

    /// The light of each widget alone that has no closed form: the others have an empty range.
    pub(super) fn lights_alone(&mut self) {
        let choices = self.choices;
        for (i, widget) in choices.widgets.iter().enumerate().filter(|(_, w)| choices.is_integrated(&w.kind))
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
        let choices = self.choices;
        for (i, widget) in choices.widgets.iter().enumerate() {
            let (member, track) = self.member(i, widget);
            self.line(format!("{indent}members.track_{i} = {track};"));
            self.line(format!("{indent}members.member_{i} = {member};"));
        }
    }

    /// The ordered integral over `members`, exact or to the tolerance; `i`: any of the widgets that have a part, `depth`:
    /// T of those that are in it.
    pub(super) fn ordered_integral(&mut self, i: usize, depth: &str) -> String {
        let constant = self.choices.constant_emitter;
        let scale = if constant { format!("glow_scale(part_{i})") } else { String::new() };
        let integral = if self.choices.method == Method::Adaptive {
            let stake = if constant { "adaptive/constant_stake" } else { "adaptive/density_stake" };
            self.uses(&["adaptive/march", stake]);
            let members = self.choices.widgets.len();
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
        let choices = self.choices;
        self.fill_members("    ");
        let integral = self.ordered_integral(0, "depth");
        let bounded = |widget: &WidgetChoice| match widget.kind {
            // Its colour varies.
            Kind::Piecewise(_) | Kind::Table => false,
            // It glows in many windows.
            Kind::TriangleWave | Kind::SineWave => !choices.constant_emitter,
            _ => true,
        };
        if !choices.widgets.iter().all(bounded) {
            self.line(format!("    let color = {integral};"));
            return;
        }
        self.uses(&["adaptive/mixed"]);
        let (mut light, mut whole) = (Vec::new(), Vec::new());
        for i in 0..choices.widgets.len() {
            let color = format!("scene.widgets[{i}].color");
            let part = if choices.constant_emitter {
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
        let mean = if choices.constant_emitter {
            "vec3f(0.0)".to_owned()
        } else {
            format!("color / max({}, 1e-37)", whole.join(" + "))
        };
        self.line(format!("    let mean = {mean};\n    var slack = MixedError(vec3f(0.0), vec3f(0.0));"));
        for i in 0..choices.widgets.len() {
            self.line(format!("    slack = mixed_add(slack, mixed_{i}, mean);"));
        }
        let scale = if choices.constant_emitter { "glow_scale(part_0)" } else { "1.0" };
        self.line(format!(
            "    color *= {scale};\n    if scene.tolerance < {scale} * mixed_largest(slack) {{ color = {integral}; }}"
        ));
    }

    /// Expressions of a widget's member and track.
    fn member(&mut self, i: usize, widget: &WidgetChoice) -> (String, String) {
        let constant = self.choices.constant_emitter;
        let track = match widget.kind {
            Kind::Uniform => format!("uniform_track({i}u, part_{i})"),
            Kind::Triangular => format!("triangular_track({i}u, part_{i})"),
            Kind::TriangleWave | Kind::SineWave => format!("wave_widget_track({i}u, part_{i})"),
            Kind::Piecewise(count) => format!("piecewise_track({i}u, {count}u, part_{i})"),
            Kind::Table => {
                let cutoff = if constant { "scene.cutoff" } else { "-1.0" };
                format!("table_track({i}u, {cutoff}, part_{i})")
            }
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
}
