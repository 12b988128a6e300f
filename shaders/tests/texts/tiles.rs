//! The passes of a frame and the compositors of pixels: parsed and validated without a device; layouts of their uniforms.

use crate::module::{SHADING, layout, offsets, validate_everywhere, validate_numbered};
use std::collections::HashSet;
use std::sync::Arc;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_optics::integrators::{self, can_serve};
use voltet_optics::shading::{Integrator, Light, Shading};
use voltet_shaders::{
    Access, Blend, CompositorProgram, FramePass, GRID_GROUP, GridArray, Layout, PIECES, Parts,
    PlacementRecord, RoundRecord, RunRecord, ShaderKey, TileOrder, ViewRecord, cells_read, compose,
};
use voltet_testing::random::widget_of_each_kind;

const ORDERS: [TileOrder; 4] = [TileOrder::Exact, TileOrder::Cut, TileOrder::Listed, TileOrder::Sum];

/// Scenes of each kind, with a region and without, and of two widgets, under both models.
fn scenes() -> Vec<TransferFunction> {
    let point = |s, extinction| ControlPoint { s, color: [s, 0.5, 0.1], extinction };
    let wave = Wave { origin: [0.1, 0.2], angle: 0.4, scale: [1.0; 2], period: 0.1, band_width: 0.5 };
    let over_fields = |names: &[&str]| {
        let n = names.len();
        let row = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        Profile::GaussianNd {
            fields: names.iter().map(|name| name.to_string()).collect(),
            centre: vec![0.1; n],
            matrix: (0..n).map(row).collect(),
        }
    };
    let profiles = [
        Profile::Gaussian { centre: [0.5, 0.0], matrix: [[4.0, 0.0], [0.0, 0.0]] },
        Profile::Gaussian { centre: [0.5, 0.5], matrix: [[4.0, 1.0], [0.0, 2.0]] },
        over_fields(&["a"]),
        over_fields(&["a", "b", "c", "d", "e", "f", "i", "j"]),
        Profile::TriangularGaussian { centre: 0.5, sigma: 0.3 },
        Profile::TriangularGaussianNd {
            fields: vec!["a".into(), "b".into()],
            magnitude: "m".into(),
            centre: vec![0.1; 2],
            matrix: vec![vec![1.0, 0.0], vec![0.5, 2.0]],
        },
        Profile::TriangleWave(wave),
        Profile::SineWave(wave),
        Profile::PiecewiseLinear { points: vec![point(0.0, 0.0), point(1.0, 2.0)] },
    ];
    let triangle = Region { corners: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] };
    let mut lists = vec![vec![]];
    lists.extend(widget_of_each_kind().into_iter().map(|widget| vec![widget]));
    for profile in profiles {
        for region in [None, Some(triangle.clone())] {
            let widget = Widget { profile: profile.clone(), color: [0.1, 0.5, 1.0], extinction: 1.0, region };
            let uniform =
                Widget { profile: Profile::Uniform, region: Some(triangle.clone()), ..widget.clone() };
            lists.extend([vec![widget.clone()], vec![widget, uniform]]);
        }
    }
    let models = [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 0.01 }];
    let of = |model| {
        lists.iter().map(move |w| TransferFunction {
            model,
            unit_distance: 1.0,
            widgets: w.clone(),
            axes: Default::default(),
        })
    };
    models.into_iter().flat_map(of).collect()
}

fn shadings() -> Vec<Shading> {
    let light = Light { direction: glam::DVec3::new(1.0, 2.0, 3.0), ambient: 0.2, diffuse: 0.8 };
    let mut shadings = vec![SHADING];
    shadings.push(Shading { light: Some(light), ..SHADING });
    shadings.push(Shading { silhouette: Some(2.0), light: Some(light), ..SHADING });
    let kinds = integrators::KINDS.into_iter().chain(voltet_integrators::KINDS);
    let others =
        kinds.map(Integrator::new).filter(|i| *i != Integrator::ANALYTIC && voltet_shaders::has_method(i));
    shadings.extend(others.map(|integrator| Shading { integrator, ..SHADING }));
    shadings
}

/// Memory of a workgroup that every device of WebGPU has.
const WORKGROUP_BYTES: u32 = 16_384;

fn workgroup_bytes(module: &naga::Module) -> u32 {
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).expect("types have sizes");
    let of_workgroup = |variable: &&naga::GlobalVariable| variable.space == naga::AddressSpace::WorkGroup;
    let variables = module.global_variables.iter().map(|(_, variable)| variable).filter(of_workgroup);
    variables.map(|variable| layouter[variable.ty].size.next_multiple_of(16)).sum()
}

/// A device of WebGPU has 8 storage buffers for a stage. What blends writes the picture in a stage that binds nothing of the grid.
fn check_buffers(module: &naga::Module, shader_key: &ShaderKey) {
    let is_storage = |v: &naga::GlobalVariable| matches!(v.space, naga::AddressSpace::Storage { .. });
    let declared = module.global_variables.iter().filter(|(_, variable)| is_storage(variable)).count();
    let of_stage = match shader_key.compositor {
        CompositorProgram::Tiles(_) => declared,
        CompositorProgram::None
        | CompositorProgram::Segments
        | CompositorProgram::Raster(_)
        | CompositorProgram::Triangles(_) => declared - 1,
    };
    assert!(of_stage <= 8, "{shader_key:?}");
}

/// Tiles share all text of a segment with the list of segments, which `combinations` tries in every combination.
#[test]
fn tiles_are_valid_for_every_kind_light_and_integrator() {
    let mut texts = HashSet::new();
    for transfer_function in scenes() {
        for shading in shadings() {
            if can_serve(&shading.integrator, &transfer_function).is_err() {
                continue;
            }
            for order in ORDERS {
                let shader_key =
                    ShaderKey::new(&transfer_function, &shading, CompositorProgram::Tiles(order));
                let shader_key = shader_key.expect("has pieces");
                let shader = compose(&shader_key);
                if !texts.insert(shader.text.clone()) {
                    continue;
                }
                let lit = shading.light.is_some() || shading.silhouette.is_some();
                assert_eq!(shader.text.contains("let gradient ="), lit);
                assert_eq!(
                    shader.text.contains("pending"),
                    matches!(order, TileOrder::Exact | TileOrder::Cut)
                );
                if let Some(module) = validate_numbered(&shader, texts.len()) {
                    check_buffers(&module, &shader_key);
                    assert_eq!(module.entry_points.len(), 1);
                    let bytes = workgroup_bytes(&module);
                    assert!(bytes <= WORKGROUP_BYTES, "{bytes} bytes: {:?}", transfer_function.widgets);
                }
            }
        }
    }
    println!("{} texts", texts.len());
    // Each kind alone and in pairs, by each integrator, lit and not.
    assert!(texts.len() > 500, "{}", texts.len());
}

const BLENDS: [Blend; 2] = [Blend::Over, Blend::Sum];

/// Blending compositors, with their entry points for vertices and pixels.
fn blending() -> Vec<(CompositorProgram, [&'static str; 2])> {
    let outlines = BLENDS.map(|blend| (CompositorProgram::Raster(blend), ["outline_cell", "blend_cell"]));
    let triangles =
        BLENDS.map(|blend| (CompositorProgram::Triangles(blend), ["place_corner", "blend_triangle"]));
    outlines.into_iter().chain(triangles).collect()
}

/// A driver compiles those of the three entry points that it is asked for; all are in one text.
#[test]
fn what_blends_is_valid_for_every_kind_light_and_integrator() {
    let mut texts = HashSet::new();
    for transfer_function in scenes() {
        for shading in shadings() {
            if can_serve(&shading.integrator, &transfer_function).is_err() {
                continue;
            }
            for (compositor, [vertices, pixels]) in blending() {
                // What a pixel holds is apart from how its segments are integrated: once for each light.
                let is_apart = compositor == CompositorProgram::Triangles(Blend::Sum);
                if is_apart && shading.integrator != Integrator::ANALYTIC {
                    continue;
                }
                let shader_key =
                    ShaderKey::new(&transfer_function, &shading, compositor).expect("has pieces");
                let shader = compose(&shader_key);
                if !texts.insert(shader.text.clone()) {
                    continue;
                }
                if let Some(module) = validate_numbered(&shader, texts.len()) {
                    check_buffers(&module, &shader_key);
                    let mut entries: Vec<_> =
                        module.entry_points.iter().map(|e| (e.name.as_str(), e.stage)).collect();
                    // In the order of the files' names.
                    entries.sort_by_key(|(_, stage)| *stage as u32);
                    let expected = [
                        (vertices, naga::ShaderStage::Vertex),
                        (pixels, naga::ShaderStage::Fragment),
                        ("take_blended", naga::ShaderStage::Compute),
                    ];
                    assert_eq!(entries, expected);
                }
                let lit = shading.light.is_some() || shading.silhouette.is_some();
                assert_eq!(shader.text.contains("let gradient ="), lit);
                let is_sum = matches!(
                    compositor,
                    CompositorProgram::Raster(Blend::Sum) | CompositorProgram::Triangles(Blend::Sum)
                );
                assert_eq!(shader.text.contains("const DEPTHS_ADD_UP = true;"), !lit && is_sum);
                for word in ["workgroup>", "composite_tiles", "sort_key("] {
                    assert!(!shader.text.contains(word), "{word}");
                }
            }
        }
    }
    println!("{} texts", texts.len());
    // Each kind alone and in pairs, by each integrator, lit and not.
    assert!(texts.len() > 1000, "{}", texts.len());
}

#[test]
fn passes_are_valid_and_have_their_entry_points() {
    for layout in LAYOUTS {
        for pass in FramePass::ALL {
            let module = validate_everywhere(&pass.shader(&layout));
            let names: Vec<&str> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
            assert_eq!(names, [pass.entry_point()]);
            check_grid(&module, pass.grid_arrays(), &layout);
        }
    }
}

/// The grid's arrays whole, all in two parts, and in numbers of parts of their own.
const LAYOUTS: [Layout; 3] = [Layout::WHOLE, in_parts([2; 7]), in_parts([4, 2, 3, 1, 4, 2, 4])];

const fn in_parts(counts: [u32; 7]) -> Layout {
    const fn parts(count: u32) -> Parts {
        if count == 1 { Parts::WHOLE } else { Parts { count, shift: 20 } }
    }
    let [positions, quantity, seen, attributes, tetrahedra, bounds, table] = counts;
    Layout {
        grid: [
            parts(positions),
            parts(quantity),
            parts(seen),
            parts(attributes),
            parts(tetrahedra),
            parts(bounds),
        ],
        table: parts(table),
    }
}

/// Each part of each array stands in a binding of its own, in order.
fn check_grid(module: &naga::Module, arrays: &[(GridArray, Access)], layout: &Layout) {
    let of_grid = module.global_variables.iter().filter_map(|(_, v)| {
        let naga::AddressSpace::Storage { access } = v.space else { return None };
        let writes = access.contains(naga::StorageAccess::STORE);
        v.binding.filter(|b| b.group == GRID_GROUP).map(|b| (b.binding, writes))
    });
    let mut found: Vec<(u32, bool)> = of_grid.collect();
    found.sort_unstable();
    let parts = |(array, access): &(GridArray, Access)| {
        vec![*access == Access::Write; layout.parts(*array).count as usize]
    };
    let expected: Vec<(u32, bool)> = (0..).zip(arrays.iter().flat_map(parts)).collect();
    assert_eq!(found, expected);
}

/// A scene whose text reads every array, and images.
#[test]
fn tiles_in_parts_are_valid() {
    let mut transfer_function = scenes().pop().expect("there are some");
    let texels = vec![[0.5; 4]; 6];
    let table = Table { width: 3, height: 2, texels, s: [0.0, 1.0], g: [0.0, 2.0] };
    transfer_function.widgets[0].profile = Profile::Table(Arc::new(table));
    let shading = Shading { silhouette: Some(2.0), ..SHADING };
    for order in ORDERS {
        let whole = ShaderKey::new(&transfer_function, &shading, CompositorProgram::Tiles(order))
            .expect("has pieces");
        for layout in LAYOUTS {
            let shader_key = ShaderKey { layout, ..whole.clone() };
            let shader = compose(&shader_key);
            check_grid(&validate_everywhere(&shader), cells_read(1), &layout);
            let last = format!("> {}:", Parts::name("numbers", layout.table.count - 1));
            assert!(shader.text.contains(&last), "'{last}'");
            assert_eq!(shader.text.contains("switch "), layout != Layout::WHOLE);
        }
    }
}

#[test]
fn every_pass_and_compositor_is_used() {
    let mut used: HashSet<&str> =
        FramePass::ALL.iter().flat_map(|p| p.shader(&Layout::WHOLE).files().collect::<Vec<_>>()).collect();
    let compositors = ORDERS.map(CompositorProgram::Tiles).into_iter();
    for compositor in compositors.chain(blending().into_iter().map(|(compositor, _)| compositor)) {
        for transfer_function in scenes() {
            let shader_key = ShaderKey::new(&transfer_function, &SHADING, compositor);
            used.extend(compose(&shader_key.expect("has pieces")).files());
        }
    }
    let apart = |name: &str| name.starts_with("passes/") || name.starts_with("compositor/");
    for piece in PIECES.iter().filter(|p| apart(p.name) && p.name != "compositor/segments") {
        assert!(used.contains(piece.file), "{}", piece.name);
    }
}

#[test]
fn structs_are_laid_out_as_in_the_shader() {
    let view = offsets!(ViewRecord:
        right, distance, down, pixel, forward, near, base_high, perspective, base_low, weight, axis, size, window,
        point_count, cell_count, capacity, sort_key, scalar_offset, widget_count, is_first, budget, goes_on, padding);
    let shader = FramePass::Attribute.shader(&Layout::WHOLE);
    assert_eq!(layout(&shader, "View"), (view, size_of::<ViewRecord>() as u32));
    let placement = offsets!(PlacementRecord: offset, slot, padding);
    assert_eq!(layout(&shader, "Placement"), (placement, size_of::<PlacementRecord>() as u32));
    assert!(shader.text.contains(&format!("const TILE = {}u;", ViewRecord::TILE)));
    let run = offsets!(RunRecord: first, length, padding);
    let shader = FramePass::Split.shader(&Layout::WHOLE);
    assert_eq!(layout(&shader, "Run"), (run, size_of::<RunRecord>() as u32));
    let corner = u64::from(layout(&shader, "SplitCorner").1);
    assert_eq!(5 * corner, RunRecord::CELL_BYTES);
    let round = offsets!(RoundRecord: shift, from_cells, capacity, padding);
    let shader = FramePass::CountDigits.shader(&Layout::WHOLE);
    assert_eq!(layout(&shader, "Round"), (round, size_of::<RoundRecord>() as u32));
    assert!(shader.text.contains(&format!("const DIGITS = {}u;", RoundRecord::DIGITS)));
    let steps = RoundRecord::ITEMS / RoundRecord::DIGITS;
    assert!(shader.text.contains(&format!("const STEPS = {steps}u;")));
}
