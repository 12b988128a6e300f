//! Texts as modules: parsed, validated, and how their structs are laid out.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use voltet_core::optics::Overlap;
use voltet_core::shading::{Integrator, Shading};
use voltet_shaders::Shader;

/// Closed forms, without light.
pub const SHADING: Shading =
    Shading { integrator: Integrator::Analytic, overlap: Overlap::Exact, silhouette: None, light: None };

/// Parsed and validated; fails with the piece's own file and line.
pub fn validate(shader: &Shader) -> naga::Module {
    let module = naga::front::wgsl::parse_str(&shader.text).unwrap_or_else(|error| {
        let line = error.location(&shader.text).map_or(1, |location| location.line_number as usize);
        let text = shader.text.lines().nth(line - 1).unwrap_or("");
        panic!("{}: {text}", shader.error(line, error.message()))
    });
    if let Err(error) = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module) {
        let line = error.location(&shader.text).map_or(1, |location| location.line_number as usize);
        panic!("{}", shader.error(line, &format!("{:?}", error.into_inner())));
    }
    module
}

/// Offsets of a struct's members.
pub fn layout(shader: &Shader, name: &str) -> (Vec<(String, u32)>, u32) {
    let module = validate(shader);
    let found =
        module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).expect("the struct exists");
    let naga::TypeInner::Struct { members, span } = &found.1.inner else { panic!("{name} is no struct") };
    (members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect(), *span)
}

/// Offsets of a Rust struct's fields.
macro_rules! offsets {
    ($type:ty: $($field:ident),* $(,)?) => {
        vec![$((stringify!($field).to_owned(), std::mem::offset_of!($type, $field) as u32)),*]
    };
}

pub(crate) use offsets;
