//! Texts as modules: parsed, validated, and how their structs are laid out.

use naga::back::pipeline_constants::process_overrides;
use naga::back::{PipelineConstants, hlsl, msl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use voltet_optics::WidgetBlend;
use voltet_optics::shading::{Integrator, Shading};
use voltet_shaders::Shader;
use voltet_testing::whole_series;

/// Closed forms, without light.
pub const SHADING: Shading =
    Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette: None, light: None };

/// One in so many of a test's texts is validated, in a whole series all; one in so many of those is translated, too. No powers of two, since
/// texts follow each other in patterns.
const VALIDATED: usize = 23;
const TRANSLATED: usize = 3;

/// Validates and translates text `number` of a test, or leaves it out.
pub fn validate_numbered(shader: &Shader, number: usize) -> Option<naga::Module> {
    let step = if whole_series() { 1 } else { VALIDATED };
    match number.is_multiple_of(step) {
        true if number.is_multiple_of(TRANSLATED * step) => Some(validate_everywhere(shader)),
        true => Some(validate(shader)),
        false => None,
    }
}

/// Validated, and translated for Metal and DirectX 12.
pub fn validate_everywhere(shader: &Shader) -> naga::Module {
    let (module, info) = read(shader);
    translate(&module, &info);
    module
}

/// Parsed and validated by the rules of WebGPU, without any of its options; fails with the piece's own file and line.
pub fn validate(shader: &Shader) -> naga::Module {
    read(shader).0
}

fn read(shader: &Shader) -> (naga::Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(&shader.text).unwrap_or_else(|error| {
        let line = error.location(&shader.text).map_or(1, |location| location.line_number as usize);
        let text = shader.text.lines().nth(line - 1).unwrap_or("");
        panic!("{}: {text}", shader.error(line, error.message()))
    });
    let validated = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    let info = validated.unwrap_or_else(|error| {
        let line = error.location(&shader.text).map_or(1, |location| location.line_number as usize);
        panic!("{}", shader.error(line, &format!("{:?}", error.into_inner())));
    });
    (module, info)
}

/// In the languages of Metal and of DirectX 12, as wgpu translates it there: of every entry point, overrides at what they are
/// without a word.
fn translate(module: &naga::Module, info: &ModuleInfo) {
    let (module, info) =
        process_overrides(module, info, None, &PipelineConstants::default()).expect("overrides have values");
    let (metal, _) = msl::write_string(
        &module,
        &info,
        &msl::Options { lang_version: (2, 0), ..Default::default() },
        &Default::default(),
    )
    .unwrap_or_else(|error| panic!("Metal: {error:?}"));
    let mut direct_x = String::new();
    let (options, pipeline) = Default::default();
    let written = hlsl::Writer::new(&mut direct_x, &options, &pipeline).write(&module, &info, None);
    let written = written.unwrap_or_else(|error| panic!("DirectX 12: {error:?}"));
    for (entry, name) in module.entry_points.iter().zip(written.entry_point_names) {
        let name = name.unwrap_or_else(|error| panic!("DirectX 12, {}: {error:?}", entry.name));
        assert!(direct_x.contains(&format!(" {name}(")) && metal.contains(&entry.name), "{}", entry.name);
    }
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
