//! The pieces, and what their first lines say.

/// A WGSL file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Piece {
    /// Its path under `wgsl/`, without the ending.
    pub name: &'static str,
    /// Its path in this crate, for messages.
    pub file: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! pieces {
    ($($name:literal,)*) => {
        &[$(Piece {
            name: $name,
            file: concat!("shaders/wgsl/", $name, ".wgsl"),
            text: include_str!(concat!("wgsl/", $name, ".wgsl")),
        }),*]
    };
}

/// Every piece, by name.
#[rustfmt::skip]
pub const PIECES: &[Piece] = pieces![
    "adaptive/constant_stake",
    "adaptive/density_stake",
    "adaptive/four_points",
    "adaptive/march",
    "adaptive/mixed",
    "clip",
    "compositing",
    "compositor/corners_kept",
    "compositor/corners_read",
    "compositor/outline",
    "compositor/pixels",
    "compositor/raster",
    "compositor/raster_over",
    "compositor/raster_sum",
    "compositor/segments",
    "compositor/shade",
    "compositor/tiles",
    "compositor/tiles_exact",
    "compositor/tiles_in_turn",
    "compositor/tiles_listed",
    "compositor/tiles_sum",
    "elementary/erfcx",
    "elementary/exponential",
    "elementary/mean_transmittance",
    "elementary/one_minus_exp",
    "elementary/power",
    "gaussian/depth",
    "gaussian/glow",
    "gaussian/light",
    "gaussian/line",
    "gaussian/mean_profile",
    "gaussian/path",
    "gaussian/plane",
    "gaussian/track",
    "gaussian/widget_line",
    "gaussian/widget_plane",
    "gaussian_nd/path",
    "gaussian_nd/widget",
    "light/diffuse",
    "light/direction",
    "light/silhouette",
    "linear/emission_weights",
    "linear/front_back",
    "linear/panels",
    "linear/psi",
    "multiply_adds",
    "numbers",
    "overlap/constant_emitter",
    "overlap/density_emitter",
    "overlap/member",
    "overlap/member_colors",
    "overlap/mix",
    "overlap/ordered",
    "overlap/panel",
    "part/clipped",
    "part/whole",
    "passes/attribute",
    "passes/cells",
    "passes/count_digits",
    "passes/digit_sums",
    "passes/digits",
    "passes/faces",
    "passes/key",
    "passes/lists",
    "passes/loops",
    "passes/move_digits",
    "passes/place_digits",
    "passes/points",
    "passes/runs",
    "passes/screen",
    "passes/sort",
    "passes/starts",
    "passes/view",
    "piecewise_linear/depth",
    "piecewise_linear/emission",
    "piecewise_linear/glow",
    "piecewise_linear/pieces",
    "piecewise_linear/points",
    "piecewise_linear/track",
    "piecewise_linear/widget",
    "piecewise_linear/widget_density_light",
    "piecewise_linear/widget_depth",
    "piecewise_linear/widget_light",
    "piecewise_linear/widget_track",
    "pre_integrated/bilinear",
    "pre_integrated/cylinder",
    "pre_integrated/fill_slices",
    "pre_integrated/fill_tiles",
    "pre_integrated/light",
    "pre_integrated/mean_extinctions",
    "pre_integrated/table",
    "pre_integrated/tiles",
    "pre_integrated/trilinear",
    "quadrature",
    "sampled/partial_constant",
    "sampled/partial_density",
    "sampled/partial_table",
    "sampled/riemann",
    "sampled/segments",
    "scene",
    "table/track",
    "table/widget",
    "track",
    "triangular_gaussian/mean_profile",
    "triangular_gaussian/track",
    "triangular_gaussian/widget",
    "triangular_gaussian/widget_track",
    "uniform/depth",
    "uniform/light",
    "uniform/track",
    "wave/bell",
    "wave/glow",
    "wave/sine",
    "wave/track",
    "wave/triangle",
    "wave/value",
    "wave/widget",
    "wave/widget_light",
    "wave/widget_track",
    "widgets/density_light",
    "widgets/widget",
];

/// The piece of that name.
pub fn piece(name: &str) -> Option<&'static Piece> {
    PIECES.iter().find(|piece| piece.name == name)
}

impl Piece {
    /// Pieces that it uses.
    pub fn uses(&self) -> Vec<&'static str> {
        self.list("Uses: ")
    }

    /// Slots that it fills.
    pub fn fills(&self) -> Vec<&'static str> {
        self.list("Fills: ")
    }

    /// Slots that must be filled for it.
    pub fn asks_for(&self) -> Vec<&'static str> {
        self.list("Asks for: ")
    }

    /// The names behind `key` in the first line.
    fn list(&self, key: &str) -> Vec<&'static str> {
        let header = self.text.lines().next().unwrap_or("");
        let Some(at) = header.find(key) else { return Vec::new() };
        let rest = &header[at + key.len()..];
        let names = rest.split('.').next().unwrap_or("");
        names.split(", ").filter(|name| !name.is_empty() && *name != "nothing").collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn files(folder: &Path, prefix: &str, names: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).expect("the folder of pieces is readable") {
            let path = entry.expect("its entries are readable").path();
            let stem = path.file_stem().and_then(|s| s.to_str()).expect("names are plain").to_owned();
            if path.is_dir() {
                files(&path, &format!("{prefix}{stem}/"), names);
            } else {
                names.push(format!("{prefix}{stem}"));
            }
        }
    }

    #[test]
    fn every_file_is_in_the_list() {
        let mut names = Vec::new();
        files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("wgsl"), "", &mut names);
        names.sort();
        let listed: Vec<&str> = PIECES.iter().map(|piece| piece.name).collect();
        assert_eq!(names, listed);
    }

    #[test]
    fn every_header_is_complete_and_names_pieces() {
        for piece in PIECES {
            let header = piece.text.lines().next().unwrap_or("");
            assert!(header.starts_with("// Uses: ") && header.contains(". Fills: "), "{}", piece.file);
            assert!(header.ends_with('.'), "{}", piece.file);
            for name in piece.uses() {
                assert!(super::piece(name).is_some(), "{} uses '{name}', which is no piece", piece.file);
            }
            for slot in piece.asks_for() {
                let filled = PIECES.iter().any(|other| other.fills().contains(&slot));
                let filled = filled || crate::generate::FILLS.contains(&slot);
                assert!(filled, "{} asks for '{slot}', which nothing fills", piece.file);
            }
        }
    }
}
