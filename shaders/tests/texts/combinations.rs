//! Shader texts of every combination of widgets, regions, models and shadings, without a device: they hold only pieces that are used, and
//! one in a few is parsed and validated (in a whole series all).

use crate::module::{SHADING, layout, offsets, validate, validate_everywhere, validate_numbered};
use std::collections::HashSet;
use std::sync::Arc;
use voltet_core::transfer::{
    AxisScale, ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical};
use voltet_optics::WidgetBlend;
use voltet_optics::curved_axes::CurvedAxes;
use voltet_optics::integrators::{self, Extent, can_serve};
use voltet_optics::shading::{Integrator, Light, Shading};
use voltet_reference::REFERENCE;
use voltet_shaders::{
    Axis, AxisShape, Buffer, Combine, CompositorProgram, Method, PIECES, Parameters, Parts, Places,
    Resources, SceneHead, ShaderKey, TEXEL_BYTES, WidgetRecord, compose,
};

const CONSTANT: OpticalModel = OpticalModel::ConstantEmitter { cutoff: 0.01 };

/// Kinds of widgets.
const KINDS: usize = 10;

/// The words that only text with such a widget may contain.
const WORDS: [(&str, &[&str]); KINDS] = [
    ("uniform", &["uniform_depth"]),
    ("gaussian line", &["gaussian_line_path"]),
    ("gaussian plane", &["gaussian_plane_path"]),
    ("gaussian-nd", &["gaussian_fields_path"]),
    ("triangular", &["triangular_ends"]),
    ("triangle", &["triangle_mean_on_flank"]),
    ("sine", &["sine_mean_on_flank", "sin_pi"]),
    ("piecewise", &["ControlPoints", "POINT_STRIDE"]),
    ("table", &["fn texel(", "struct TableTrack"]),
    ("triangular-gaussian-nd", &["triangular_fields"]),
];

fn wave(angle: f64) -> Wave {
    Wave { origin: [0.1, 0.2], angle, scale: [1.0; 2], period: 0.4, band_width: 0.5 }
}

/// One profile for each entry of [`WORDS`].
fn profile(kind: usize) -> Profile {
    let point = |s, extinction, r| ControlPoint { s, color: [r, 0.5, 0.1], extinction };
    match kind {
        0 => Profile::Uniform,
        1 => Profile::Gaussian { centre: [0.5, 0.0], matrix: [[4.0, 0.0], [0.0, 0.0]] },
        2 => Profile::Gaussian { centre: [0.5, 0.5], matrix: [[4.0, 1.0], [0.0, 2.0]] },
        3 => Profile::GaussianNd {
            fields: vec!["b".into(), "a".into()],
            centre: vec![0.1, 0.2],
            matrix: vec![vec![1.0, 0.0], vec![0.5, 2.0]],
        },
        4 => Profile::TriangularGaussian { centre: 0.5, sigma: 0.3 },
        5 => Profile::TriangleWave(wave(0.0)),
        6 => Profile::SineWave(wave(0.4)),
        7 => Profile::PiecewiseLinear {
            points: vec![point(0.0, 0.0, 1.0), point(0.5, 2.0, 0.2), point(1.0, 0.5, 0.4)],
        },
        8 => {
            let texels = vec![[0.5, 0.2, 0.1, 1.0]; 6];
            Profile::Table(Arc::new(Table { width: 3, height: 2, texels, s: [0.0, 1.0], g: [0.0, 2.0] }))
        }
        _ => Profile::TriangularGaussianNd {
            fields: vec!["b".into(), "c".into()],
            magnitude: "m".into(),
            centre: vec![0.1, 0.2],
            matrix: vec![vec![1.0, 0.0], vec![0.5, 2.0]],
        },
    }
}

fn widget(kind: usize, region: Option<Region>) -> Widget {
    let color = [0.1 * kind as f64, 0.5, 1.0];
    Widget { profile: profile(kind), color, extinction: 1.0 + kind as f64, region }
}

fn regions() -> [Option<Region>; 3] {
    let triangle = Region { corners: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] };
    [None, Some(Region::rectangle([0.2, 0.8], [f64::NEG_INFINITY, f64::INFINITY])), Some(triangle)]
}

/// Every shading of the analytic integrator, and the others under one.
fn shadings() -> Vec<Shading> {
    let light = Light { direction: glam::DVec3::new(1.0, 2.0, 3.0), ambient: 0.2, diffuse: 0.8 };
    let mut shadings = Vec::new();
    for overlap in [WidgetBlend::Exact, WidgetBlend::Mix] {
        for silhouette in [None, Some(2.0)] {
            for light in [None, Some(light)] {
                shadings.push(Shading { overlap, silhouette, light, ..SHADING });
            }
        }
    }
    let kinds = integrators::KINDS.into_iter().chain(voltet_integrators::KINDS);
    let others =
        kinds.map(Integrator::new).filter(|i| *i != Integrator::ANALYTIC && voltet_shaders::has_method(i));
    // Small tables: their texts are asked about, not their entries.
    shadings.extend(
        others.map(|integrator| Shading { integrator: integrator.with("table_size", 9.0), ..SHADING }),
    );
    shadings
}

fn scene(model: OpticalModel, widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }
}

/// Every set of kinds of the sizes given, each under every region and model.
fn scenes() -> Vec<(Vec<usize>, TransferFunction)> {
    let mut sets: Vec<Vec<usize>> = vec![vec![], (0..KINDS).collect()];
    for i in 0..KINDS {
        sets.push(vec![i]);
        for j in 0..KINDS {
            sets.push(vec![i, j]);
        }
    }
    let mut scenes = Vec::new();
    for set in sets {
        for model in [OpticalModel::DensityEmitter, CONSTANT] {
            for region in regions() {
                // A uniform widget needs a region.
                let region_of = |kind: usize| match (kind, &region) {
                    (0, None) => regions()[1].clone(),
                    _ => region.clone(),
                };
                let mut widgets: Vec<Widget> =
                    set.iter().map(|&kind| widget(kind, region_of(kind))).collect();
                // Two of a kind have two colours.
                for (i, widget) in widgets.iter_mut().enumerate() {
                    widget.color[2] += i as f64;
                }
                scenes.push((set.clone(), scene(model, widgets)));
            }
        }
    }
    scenes
}

/// Every set of two kinds that curved axes allow, along each pair of scales.
fn curved_scenes() -> Vec<TransferFunction> {
    let symlog = AxisScale::SymLog { linear_below: 0.1 };
    let pairs = [
        [AxisScale::Log, AxisScale::Log],
        [AxisScale::Log, AxisScale::Linear],
        [AxisScale::Linear, AxisScale::Log],
        [symlog, AxisScale::Log],
    ];
    let mut scenes = Vec::new();
    for (number, axes) in pairs.into_iter().enumerate() {
        for i in 0..KINDS {
            let region = regions()[1 + number % 2].clone();
            // A Gaussian over the plane, so that both axes are read.
            let widgets = vec![widget(i, region), widget(2, None)];
            let model = if i % 2 == 0 { CONSTANT } else { OpticalModel::DensityEmitter };
            scenes.push(TransferFunction { axes, ..scene(model, widgets) });
        }
    }
    scenes.retain(|scene| scene.check_axes().is_ok());
    scenes
}

/// Checks that unchosen pieces are absent.
fn check_words(
    kinds: &[usize],
    transfer_function: &TransferFunction,
    shading: &Shading,
    shader_key: &ShaderKey,
    text: &str,
) {
    let from_table = shader_key.method.is_table_of_lengths();
    let adaptive = shader_key.method == Method::Adaptive;
    let named =
        |name: &str| matches!(shader_key.method, Method::Registered(text) if text.schema().name == name);
    let samples = named("riemann") || named("segments");
    for (kind, (name, words)) in WORDS.iter().enumerate() {
        for word in *words {
            let asked_for = kinds.contains(&kind) && !from_table;
            // A sampled widget needs no depth.
            let word = if samples && *word == "uniform_depth" { "UniformTrack" } else { word };
            assert_eq!(text.contains(word), asked_for, "'{word}' of {name} in {kinds:?}");
        }
    }
    let constant = transfer_function.model == CONSTANT;
    let clipped = transfer_function.widgets.iter().any(|w| w.region.is_some()) || kinds.contains(&8);
    let ordered = shader_key.combine == Combine::Ordered;
    let integrated = constant && (kinds.contains(&4) || kinds.contains(&9)) || kinds.contains(&8);
    let walks = (ordered || integrated) && !samples && !from_table;
    let holds =
        |word: &str, when: bool| assert_eq!(text.contains(word), when, "'{word}' in {kinds:?}, {shading:?}");
    holds("fn silhouette_factor", shading.silhouette.is_some());
    holds("fn diffuse_factor", shading.light.is_some());
    holds("fn part_inside", clipped && !from_table);
    holds("fn ordered(", walks && !adaptive);
    holds("fn mix_share", kinds.len() > 1 && !samples && !from_table && !adaptive);
    holds("fn march(", walks && adaptive);
    holds("AxisWalk", false);
    holds("@compute", shader_key.compositor == CompositorProgram::Segments);
    holds("fn riemann(", named("riemann") && !kinds.is_empty());
    holds("fn partial_place", named("segments") && !kinds.is_empty());
    holds("fn glow(", from_table);
    holds("fn to_cylinder", named("pre-integrated-cylindrical"));
    for (word, when) in [("_glow(", true), ("fn emission_weights", false)] {
        assert!(!text.contains(word) || constant == when, "'{word}' in {kinds:?}, {constant}");
    }
}

/// The read-only storage buffers of group 0, by binding.
fn storage_buffers(module: &naga::Module) -> Vec<(String, u32)> {
    let read_only = naga::AddressSpace::Storage { access: naga::StorageAccess::LOAD };
    let mut found: Vec<(String, u32)> = module
        .global_variables
        .iter()
        .filter(|(_, variable)| variable.space == read_only)
        .filter_map(|(_, variable)| Some((variable.name.as_deref()?, variable.binding?)))
        .filter(|(_, binding)| binding.group == 0)
        .map(|(name, binding)| (name.to_string(), binding.binding))
        .collect();
    found.sort_by_key(|(_, binding)| *binding);
    found
}

/// Every buffer that the text reads has contents, all of them so long as the places in it say.
fn check_resources(transfer_function: &TransferFunction, shading: &Shading, shader_key: &ShaderKey) {
    let extent = Extent { scalar: [0.0, 1.0], longest: 2.0 };
    let numbers = vec![1.0; shader_key.number_count() as usize];
    let resources =
        Resources::new(shader_key, transfer_function, shading, Axis::PLAIN, 1.0, &extent, &numbers)
            .expect("in range");
    let bound: Vec<(String, u32)> =
        resources.buffers.iter().filter_map(|buffer| Some((buffer.name.clone(), buffer.binding?))).collect();
    assert_eq!(bound, shader_key.storage_buffers());
    let places = Places::new(transfer_function, shading, numbers.len() as u64);
    let length: u64 = resources.buffers.iter().filter(|b| b.binding.is_some()).map(Buffer::length).sum();
    let all = 4 * (places.first_number() + numbers.len() as u64);
    assert!(bound.is_empty() || length == all.next_multiple_of(TEXEL_BYTES), "{length} {places:?}");
    for pass in &resources.passes {
        assert!(pass.buffers.iter().all(|i| *i < resources.buffers.len()));
    }
}

#[test]
fn passes_that_fill_tables_are_valid() {
    let transfer_function = scene(CONSTANT, vec![widget(1, None)]);
    let extent = Extent { scalar: [0.0, 1.0], longest: 2.0 };
    for (integrator, count) in [(pre_integrated(5, 2), 1), (pre_integrated_cylindrical(5, 2, 1), 2)] {
        let shading = Shading { integrator, ..SHADING };
        let shader_key =
            ShaderKey::new(&transfer_function, &shading, CompositorProgram::None).expect("has pieces");
        let places = Places::new(&transfer_function, &shading, shader_key.number_count());
        let length = places.in_vectors();
        for most in [length, length.div_ceil(2), 32] {
            let mut shader_key = shader_key.clone();
            shader_key.layout.table = Parts::for_elements(length, 1, most);
            let resources =
                Resources::new(&shader_key, &transfer_function, &shading, Axis::PLAIN, 1.0, &extent, &[])
                    .expect("in range");
            assert_eq!(resources.passes.len(), count);
            let filled: u64 = resources.buffers.iter().map(|buffer| buffer.contents.filled).sum();
            assert_eq!(filled, (places.vectors + places.source_vectors) * TEXEL_BYTES);
            for pass in &resources.passes {
                let module = validate_everywhere(&pass.shader);
                assert_eq!(module.entry_points[0].name, pass.entry_point);
                let read = storage_buffers(&module);
                assert_eq!(read.len(), pass.buffers.len() - pass.written, "the last are written");
                assert!(read.iter().enumerate().all(|(i, (_, binding))| *binding == i as u32));
                assert_eq!(module.global_variables.len(), pass.buffers.len());
            }
            check_resources(&transfer_function, &shading, &shader_key);
            assert_eq!(storage_buffers(&validate(&compose(&shader_key))), shader_key.storage_buffers());
        }
    }
}

/// Composes and validates every scene under these shadings; the number of different texts.
fn check_combinations(shadings: &[Shading]) -> usize {
    let (mut texts, mut combinations) = (HashSet::new(), 0);
    for (kinds, transfer_function) in scenes() {
        for shading in shadings {
            if can_serve(&shading.integrator, &transfer_function).is_err() {
                continue;
            }
            // What the entry point adds is the same for every integrator.
            let both = [CompositorProgram::None, CompositorProgram::Segments];
            let analytic = shading.integrator == Integrator::ANALYTIC;
            for compositor in if analytic { &both[..] } else { &both[1..] }.iter().copied() {
                combinations += 1;
                let shader_key = ShaderKey::new(&transfer_function, shading, compositor).expect("has pieces");
                let shader = compose(&shader_key);
                check_words(&kinds, &transfer_function, shading, &shader_key, &shader.text);
                if texts.insert(shader.text.clone())
                    && let Some(module) = validate_numbered(&shader, texts.len())
                {
                    assert_eq!(
                        module.entry_points.len(),
                        usize::from(compositor == CompositorProgram::Segments)
                    );
                    assert_eq!(storage_buffers(&module), shader_key.storage_buffers());
                }
                let axes = vec![Axis::PLAIN; 2 + transfer_function.fields().len()];
                let parameters = Parameters::new(&transfer_function, shading, &axes, 1.0).expect("in range");
                assert_eq!(parameters.widgets.len(), kinds.len().max(1));
                assert_eq!(parameters.numbers.len() as u64, shader_key.number_count());
                check_resources(&transfer_function, shading, &shader_key);
            }
        }
    }
    println!("{combinations} combinations, {} texts", texts.len());
    texts.len()
}

/// They are most of the tests' work: half of them a thread.
#[test]
fn every_combination_is_valid_and_holds_only_what_it_uses() {
    let all = shadings();
    let (some, others): (Vec<Shading>, Vec<Shading>) = all.into_iter().partition(|s| s.light.is_some());
    let texts = std::thread::scope(|scope| {
        let beside = scope.spawn(|| check_combinations(&some));
        check_combinations(&others) + beside.join().expect("every combination is right")
    });
    // Without order or light many combinations are one text; a composer that ignored its shader_key would make few.
    assert!(texts > 2000, "{texts}");
}

/// Segments along curved axes are cut by the pieces of these alone, from numbers that stand behind the widgets'.
#[test]
fn curved_axes_are_valid_and_hold_only_what_they_use() {
    let mut texts = HashSet::new();
    for transfer_function in curved_scenes() {
        for integrator in [Integrator::ANALYTIC, Integrator::adaptive(1e-4)] {
            let shading = Shading { integrator, ..SHADING };
            let shader_key = ShaderKey::new(&transfer_function, &shading, CompositorProgram::Segments)
                .expect("has pieces");
            let shader = compose(&shader_key);
            if texts.insert(shader.text.clone()) {
                let module = validate_everywhere(&shader);
                assert_eq!(storage_buffers(&module), shader_key.storage_buffers());
            }
            let is_of = |shape: AxisShape| shader_key.curved_axes.is_some_and(|axes| axes.contains(&shape));
            let holds = |word: &str, when: bool| {
                assert_eq!(shader.text.contains(word), when, "'{word}' along {:?}", transfer_function.axes);
            };
            holds("struct AxisWalk", true);
            holds("fn log_position", is_of(AxisShape::Log));
            holds("fn symlog_position", is_of(AxisShape::SymLog));
            let axes = vec![Axis::PLAIN; 2 + transfer_function.fields().len()];
            let mut parameters = Parameters::new(&transfer_function, &shading, &axes, 1.0).expect("in range");
            let curved = CurvedAxes::new(&transfer_function).expect("is curved");
            parameters.add_curved_axes(&curved, [Axis::PLAIN; 2], [Axis::PLAIN; 2]).expect("wide enough");
            let own = (0..2).filter(|axis| curved.scale(*axis).is_curved());
            let jumps: usize = own.map(|axis| curved.jumps(axis).len()).sum();
            let first = parameters.head.first_entry as usize;
            let texels = 4 * Places::new(&transfer_function, &shading, 0).vectors as usize;
            assert_eq!(first - texels, shader_key.number_count() as usize);
            assert_eq!(parameters.numbers.len() + texels - first, 22 + 2 * jumps);
        }
    }
    assert!(texts.len() > 40, "{}", texts.len());
    let sampled = Shading { integrator: pre_integrated(5, 2), ..SHADING };
    let look = TransferFunction { axes: [AxisScale::Log; 2], ..scene(CONSTANT, vec![widget(1, None)]) };
    assert!(ShaderKey::new(&look, &sampled, CompositorProgram::None).is_err());
}

#[test]
fn numbers_that_may_change_do_not_change_the_text() {
    let text = |transfer_function: &TransferFunction| {
        let shader_key =
            ShaderKey::new(transfer_function, &SHADING, CompositorProgram::None).expect("has pieces");
        compose(&shader_key).text
    };
    let before = scene(CONSTANT, vec![widget(2, regions()[2].clone()), widget(6, None)]);
    let mut after = before.clone();
    after.widgets[0].extinction = 7.0;
    after.widgets[0].color = [3.0, 2.0, 1.0];
    after.widgets[0].region = Some(Region { corners: vec![[0.0, 0.0], [2.0, 0.0], [0.5, 1.0]] });
    after.widgets[1].profile = Profile::SineWave(wave(0.8));
    assert_eq!(text(&before), text(&after));
    after.widgets[1].profile = Profile::TriangleWave(wave(0.8));
    assert_ne!(text(&before), text(&after));
}

#[test]
fn every_piece_is_used_by_some_scene() {
    let mut used: HashSet<&str> = HashSet::new();
    for transfer_function in scenes().into_iter().map(|scene| scene.1).chain(curved_scenes()) {
        for shading in shadings() {
            let shader_key = ShaderKey::new(&transfer_function, &shading, CompositorProgram::Segments);
            used.extend(
                shader_key.iter().flat_map(|shader_key| compose(shader_key).files().collect::<Vec<_>>()),
            );
        }
    }
    let unused: Vec<&str> = PIECES.iter().filter(|p| !used.contains(p.file)).map(|p| p.name).collect();
    // ψ is what a table of pre-integration holds; tables are filled by passes of their own, and so are pixels.
    let elsewhere = [
        "compositing",
        "compositor/blend",
        "compositor/corner",
        "compositor/outline",
        "compositor/pixels",
        "compositor/raster",
        "compositor/segments_",
        "compositor/shade",
        "compositor/silhouette",
        "compositor/tiles",
        "compositor/triangles",
        "linear/psi",
        // What a device is measured and judged by.
        "measured/",
        "passes/",
        "pre_integrated/fill_slices",
        "pre_integrated/fill_tiles",
    ];
    let strange = unused.iter().filter(|name| !elsewhere.iter().any(|other| name.starts_with(other)));
    assert_eq!(strange.count(), 0, "{unused:?}");
}

#[test]
fn what_has_no_shader_is_refused() {
    let refusal = |integrator, kind| {
        let shading = Shading { integrator, ..SHADING };
        let transfer_function = scene(CONSTANT, vec![widget(kind, None)]);
        ShaderKey::new(&transfer_function, &shading, CompositorProgram::None)
            .expect_err("refused")
            .to_string()
    };
    let error = refusal(REFERENCE, 1);
    assert!(error.contains("'reference'") || error.contains("reference"), "{error}");
    assert!(error.contains("cpu"), "{error}");
    let error = refusal(pre_integrated(8, 2), 2);
    assert!(error.contains("gradient magnitude"), "{error}");
}

#[test]
fn structs_are_laid_out_as_in_the_shader() {
    let transfer_function = scene(CONSTANT, vec![widget(1, None), widget(2, None)]);
    let shader =
        compose(&ShaderKey::new(&transfer_function, &SHADING, CompositorProgram::None).expect("has pieces"));
    let widget = offsets!(WidgetRecord:
        color, extinction, matrix, bell, centre, first_edge, first_number, bell_kind);
    assert_eq!(layout(&shader, "Widget"), (widget, size_of::<WidgetRecord>() as u32));
    let mut head = offsets!(SceneHead:
        light_direction, light_ambient, light_diffuse, silhouette_exponent, level, cutoff, per_unit, tolerance,
        brightest, piece_count, first_entry);
    head.push(("widgets".to_owned(), size_of::<SceneHead>() as u32));
    let whole = size_of::<SceneHead>() + 2 * size_of::<WidgetRecord>();
    assert_eq!(layout(&shader, "Scene"), (head, whole as u32));
}
