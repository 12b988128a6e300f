//! The calls that one widget stands for: its depth, its light alone, its path and its track.

use super::Block;
use crate::choices::{Kind, WidgetChoice};

impl Block<'_> {
    /// The path of a Gaussian, over the whole segment or inside its region.
    pub(super) fn path(&mut self, i: usize, widget: &WidgetChoice, which: &str) -> String {
        let (piece, name, count) = match widget.kind {
            Kind::GaussianLine => ("widgets/gaussian_line", "line", String::new()),
            Kind::GaussianPlane => ("widgets/gaussian_plane", "plane", String::new()),
            Kind::GaussianFields(count) => ("widgets/gaussian_fields", "fields", format!("{count}u, ")),
            _ => unreachable!("only Gaussians have paths"),
        };
        self.uses(&[piece]);
        format!("gaussian_{name}_{which}({i}u, {count}part_{i})")
    }

    pub(super) fn depth(&mut self, i: usize, widget: &WidgetChoice) -> String {
        let (piece, call) = match widget.kind {
            Kind::Uniform => ("widgets/uniform", format!("uniform_depth({i}u, part_{i})")),
            Kind::Triangular => ("widgets/triangular", format!("triangular_depth({i}u, part_{i})")),
            Kind::TriangleWave | Kind::SineWave => ("widgets/wave", format!("wave_depth({i}u, part_{i})")),
            Kind::Table => ("widgets/table", format!("table_depth({i}u, part_{i})")),
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
    pub(super) fn light(&mut self, i: usize, widget: &WidgetChoice) -> String {
        if self.choices.is_integrated(&widget.kind) {
            return format!("light_alone_{i}(part_{i}, depth_{i})");
        }
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
            (_, true) => {
                let path = self.path(i, widget, "inside");
                ("widgets/gaussian_light", format!("gaussian_light({i}u, part_{i}, {path})"))
            }
        };
        self.uses(&[piece]);
        call
    }
}

/// The piece, the stem of the functions and the type of a widget's track.
pub(super) fn track(kind: &Kind) -> (&'static str, &'static str, &'static str) {
    match kind {
        Kind::Uniform => ("widgets/uniform_track", "uniform", "UniformTrack"),
        Kind::Triangular => ("widgets/triangular_track", "triangular", "TriangularTrack"),
        Kind::TriangleWave | Kind::SineWave => ("widgets/wave_track", "wave", "WaveTrack"),
        Kind::Piecewise(_) => ("widgets/piecewise_track", "piecewise", "PiecewiseTrack"),
        Kind::Table => ("widgets/table", "table", "TableTrack"),
        Kind::GaussianLine | Kind::GaussianPlane | Kind::GaussianFields(_) => {
            ("gaussian/track", "gaussian", "GaussianTrack")
        }
    }
}
