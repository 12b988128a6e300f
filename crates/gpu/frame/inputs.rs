//! Inputs of a frame: everything that a scene puts on the device, checked against the limits of the device.

use crate::device::Device;
use crate::device::pipelines::compositor_buffers;
use crate::frame::output::PendingStats;
use crate::frame::renderer::Renderer;
use crate::grid::{
    BufferSizes, DeviceArray, DeviceGrid, ValueArray, offset_parts, split, value_axis, widget_axis,
};
use crate::tables::TableKey;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::progress::Progress;
use voltet_core::transfer::{Slab, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::curved_axes::CurvedAxes;
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::integrators::Extent;
use voltet_optics::ray_events::{RayEventKind, RayEvents};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Ordering, Shading};
use voltet_shaders::{
    Axis, Blend, Combine, CompositorProgram, Parameters, Places, Shader, ShaderKey, Spans, TileOrder,
    ViewRecord, check_32_bits, compose,
};

/// Everything of a scene but the camera's sample.
pub(crate) struct FrameInputs<'a> {
    pub renderer: &'a Renderer,
    pub shader_key: ShaderKey,
    pub sizes: BufferSizes,
    pub shading: Shading,
    pub tables: TableKey,
    pub compositor: Shader,
    pub scalar: Arc<DeviceArray>,
    /// Further values of the points, each with where it is counted from.
    pub attributes: Vec<(Arc<DeviceArray>, [f32; 2])>,
    pub scene: Vec<u8>,
    pub numbers: Vec<f32>,
    pub support: Vec<u32>,
    /// True if cells are sorted on the device.
    pub sorted: bool,
    pub samples: Vec<ViewRecord>,
    /// Words that stand behind the tiles' lists, by sample (`compositor/segments_cut.wgsl`); none where rays meet nothing but cells.
    pub events: Vec<Vec<[u32; 2]>>,
    /// The output as far as it is known before readback.
    pub pending: PendingStats,
}

impl<'a> FrameInputs<'a> {
    pub fn device(&self) -> &'a Device {
        &self.renderer.grid.device
    }

    pub fn picture_bytes(&self, window: [u32; 4]) -> u64 {
        let pixels = u64::from(window[2]) * u64::from(window[3]) * u64::from(ViewRecord::TILE).pow(2);
        pixels * 16
    }
}

/// Makes the inputs of a scene's frame.
///
/// Errors: what the device has no shader for, cannot hold in 32 bits, or has more parts than it binds; memory; a lost device.
pub(crate) fn inputs<'a>(
    renderer: &'a Renderer,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<FrameInputs<'a>> {
    let Scene { volume, transfer_function, camera, shading, .. } = scene;
    let grid = &renderer.grid;
    can_serve(transfer_function, shading)?;
    let compositing = compositing(scene, options);
    let ordering = ordering(scene, options);
    let (shader_key, sizes) = shader_key(renderer, scene, options)?;
    let compositor = shader_key.compositor;

    let scalar = grid.stored(volume, ValueArray::Scalar)?;
    // Where g is not read, s stands in its place.
    let mut values = vec![scalar.clone(), scalar.clone()];
    if shader_key.reads_gradient_magnitude {
        values[1] = grid.stored(volume, ValueArray::GradientMagnitude)?;
    }
    for name in transfer_function.fields() {
        values.push(grid.stored(volume, ValueArray::Field(name.to_string()))?);
    }
    let curved = CurvedAxes::new(transfer_function);
    check(grid, &shader_key, transfer_function, curved.as_ref(), &values)?;
    let numbered = values.iter().enumerate();
    let axes: Vec<Axis> =
        numbered.clone().map(|(k, value)| value_axis(value, transfer_function, k)).collect();
    let placed: Vec<Axis> = numbered.map(|(k, value)| widget_axis(value, transfer_function, k)).collect();
    let mut parameters = Parameters::new(transfer_function, shading, &placed, grid.length)?;
    if let Some(curved) = &curved {
        parameters.add_curved_axes(curved, [axes[0], axes[1]], [placed[0], placed[1]])?;
    }
    let (support, support_count) = match options.exhaustive {
        false => supports(transfer_function, &axes, grid.length),
        // One support that holds every cell.
        true => (vec![0, 0], 1),
    };

    let first = if shader_key.reads_gradient_magnitude { 1 } else { 2 };
    let further = values.iter().zip(&axes).skip(first);
    let mut attributes: Vec<_> =
        further.map(|(value, axis)| (value.clone(), offset_parts(value, axis))).collect();
    if shader_key.reads_gradient() {
        for component in 0..3 {
            attributes.push((grid.stored(volume, ValueArray::Gradient(component))?, [0.0; 2]));
        }
    }
    let is_free = is_free(compositor);
    let sort_key = match ordering {
        _ if is_free => 2,
        _ if matches!(compositor, CompositorProgram::Tiles(TileOrder::Exact | TileOrder::Cut)) => 0,
        Ordering::CellCentroid => 1,
        // What comes in its order needs no key.
        _ => 2,
    };
    let sample = |offset: &[f64; 2]| {
        Ok(ViewRecord {
            sort_key,
            scalar_offset: offset_parts(&scalar, &axes[0]),
            widget_count: support_count,
            ..view(grid, camera, *offset)?
        })
    };
    let samples: Vec<ViewRecord> = camera.sample_offsets().iter().map(sample).collect::<Result<_>>()?;
    samples.iter().take(1).try_for_each(|view| grid.flat_cells.check(volume, transfer_function, view))?;
    let mut events = Vec::new();
    if let Some(source) = scene.ray_event_source()? {
        for (offset, view) in camera.sample_offsets().into_iter().zip(&samples) {
            events.push(stored(&source.events(offset, progress)?, grid.length, view.distance));
        }
    }
    let shader = compose(&shader_key);
    let by_tiles = compositing == Compositor::Tiles;
    let (parts_left_out, part_bytes_left_out) = parts_left_out(&shader);
    let pending = PendingStats {
        compositing,
        is_order_known: by_tiles || !scene.needs_order(),
        exhaustive: options.exhaustive,
        parts_left_out,
        part_bytes_left_out,
        blended_in_16_bits: !by_tiles && !grid.device.blends_32_bits,
    };
    Ok(FrameInputs {
        renderer,
        compositor: shader,
        pending,
        tables: TableKey {
            transfer_function: transfer_function.clone(),
            integrator: shading.integrator,
            axis: axes[0],
            length: grid.length,
            extent: Extent { scalar: scalar.range, longest: grid.longest },
        },
        shading: *shading,
        shader_key,
        sizes,
        scene: parameters.scene_bytes(),
        numbers: parameters.numbers,
        support,
        sorted: !is_free && (sort_key != 2 || by_tiles),
        samples,
        events,
        scalar: scalar.clone(),
        attributes,
    })
}

/// Events as the device reads them. `length`: world units in a scene length; `distance`: depth of the view's base.
fn stored(events: &RayEvents, length: f64, distance: f32) -> Vec<[u32; 2]> {
    let mut end = 0;
    let ranges = events.by_pixel().map(|own| {
        let first = end;
        end += own.len() as u32;
        [first, end]
    });
    let mut stored: Vec<[u32; 2]> = ranges.collect();
    stored.extend(events.by_pixel().flatten().flat_map(|event| {
        let [r, g, b, a] = match event.kind {
            RayEventKind::Surface(rgba) => rgba,
            RayEventKind::Hide => [0.0, 0.0, 0.0, -1.0],
            RayEventKind::Show => [0.0, 0.0, 0.0, -2.0],
        };
        let depth = (event.depth / length - f64::from(distance)) as f32;
        [[depth, r], [g, b], [a, 0.0]].map(|pair| pair.map(f32::to_bits))
    }));
    stored
}

/// The compositor; tiles where none is requested, or one that does not make the scene's order.
fn compositing(scene: &Scene, options: &RenderOptions) -> Compositor {
    let ordering = scene.ordering(false);
    options.compositing.filter(|requested| requested.makes(ordering)).unwrap_or(Compositor::Tiles)
}

/// The order that the compositor makes. Blending hardware makes none where none is needed; in exhaustive mode it makes that of
/// centroids in place of an exact one.
fn ordering(scene: &Scene, options: &RenderOptions) -> Ordering {
    let ordering = scene.ordering(options.exhaustive);
    match compositing(scene, options) {
        Compositor::Tiles => ordering,
        _ if !options.exhaustive && !scene.needs_order() => Ordering::Independent,
        blending if !blending.makes(ordering) => Ordering::CellCentroid,
        _ => ordering,
    }
}

/// Key of the scene's shader, and the sizes of the scene's buffers.
pub(crate) fn shader_key(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
) -> Result<(ShaderKey, BufferSizes)> {
    let grid = &renderer.grid;
    let Scene { transfer_function, shading, .. } = scene;
    let compositing = compositing(scene, options);
    let ordering = ordering(scene, options);
    let compositor = compositor(scene, compositing, ordering, options.exhaustive)?;
    if compositing != Compositor::Tiles {
        grid.device.check_blending(compositing, grid.cell_count.into())?;
    }
    let mut shader_key = ShaderKey::new(transfer_function, shading, compositor)?;
    let sizes = sizes(grid, &shader_key, compositing, transfer_function, shading);
    sizes.check(grid.device.room(), &grid.device.name)?;
    shader_key.layout = sizes.layout(grid.device.room());
    Ok((shader_key, sizes))
}

fn sizes(
    grid: &DeviceGrid,
    shader_key: &ShaderKey,
    compositing: Compositor,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> BufferSizes {
    let places = Places::new(transfer_function, shading, shader_key.number_count());
    let texels = places.in_vectors();
    BufferSizes {
        points: grid.point_count.into(),
        cells: grid.cell_count.into(),
        stride: shader_key.attribute_stride() as u64,
        texels,
        source_texels: places.source_vectors,
        own_buffers: compositor_buffers(compositing),
        // Vectors stand in parts of their own.
        scene_buffers: if texels > 0 { 0 } else { shader_key.storage_buffers().len() as u32 },
    }
}

/// Folders of which a shader holds no piece, and the bytes of all pieces that it does not hold.
fn parts_left_out(shader: &Shader) -> (Vec<&'static str>, u64) {
    let pieces = shader.leaves_out();
    let bytes = pieces.iter().map(|piece| piece.text.len() as u64).sum();
    let held = |folder: &str| shader.files().any(|file| file.starts_with(&format!("shaders/wgsl/{folder}/")));
    let mut folders: Vec<&str> = Vec::new();
    for (folder, _) in pieces.iter().filter_map(|piece| piece.name.split_once('/')) {
        if !folders.contains(&folder) && !held(folder) {
            folders.push(folder);
        }
    }
    (folders, bytes)
}

/// True if the compositor needs no order.
fn is_free(compositor: CompositorProgram) -> bool {
    match compositor {
        CompositorProgram::Tiles(order) => order == TileOrder::Sum,
        CompositorProgram::Raster(blend) | CompositorProgram::Triangles(blend) => blend == Blend::Sum,
        CompositorProgram::None | CompositorProgram::Segments => false,
    }
}

/// With one colour that no light changes, C = c A whatever the order: none is made, unless nothing may be left out.
fn compositor(
    scene: &Scene,
    compositing: Compositor,
    ordering: Ordering,
    exhaustive: bool,
) -> Result<CompositorProgram> {
    let Scene { transfer_function, shading, .. } = scene;
    let is_cut = scene.has_events();
    let shader_key = ShaderKey::new(transfer_function, shading, CompositorProgram::None)?;
    let lit = shading.light.is_some_and(|light| light.diffuse != 0.0);
    let known = !shader_key.method.is_table_of_lengths();
    let needed = !known || !matches!(shader_key.combine, Combine::OneColor | Combine::Nothing) || lit;
    let free = !needed && !exhaustive && !is_cut;
    // One number a pixel is enough where order is of no account.
    let blend = if free { Blend::Sum } else { Blend::Over };
    Ok(match (compositing, ordering) {
        (Compositor::Tiles, _) if free => CompositorProgram::Tiles(TileOrder::Sum),
        (Compositor::Tiles, Ordering::Independent | Ordering::PerPixel) if is_cut => {
            CompositorProgram::Tiles(TileOrder::Cut)
        }
        (Compositor::Tiles, Ordering::Independent | Ordering::PerPixel) => {
            CompositorProgram::Tiles(TileOrder::Exact)
        }
        (Compositor::Tiles, Ordering::CellCentroid | Ordering::Submission) => {
            CompositorProgram::Tiles(TileOrder::Listed)
        }
        (Compositor::Raster, _) => CompositorProgram::Raster(blend),
        (Compositor::Triangles, _) => CompositorProgram::Triangles(blend),
    })
}

/// Checks that the device has shaders for the scene. What depends on the data is found when it is drawn.
pub fn can_serve(transfer_function: &TransferFunction, shading: &Shading) -> Result<()> {
    ShaderKey::new(transfer_function, shading, CompositorProgram::Tiles(TileOrder::Exact)).map(drop)
}

/// Checks that 32 bits hold what segments of this grid can span. `values`: s, g (anything where it is not read), then the
/// fields, as the transfer function numbers them.
fn check(
    grid: &DeviceGrid,
    shader_key: &ShaderKey,
    transfer_function: &TransferFunction,
    curved: Option<&CurvedAxes>,
    values: &[Arc<DeviceArray>],
) -> Result<()> {
    let curved = |k: usize| curved.filter(|curved| k < 2 && curved.scale(k).is_curved());
    let span = |(k, value): (usize, &Arc<DeviceArray>)| match curved(k) {
        _ if k == 1 && !shader_key.reads_gradient_magnitude => 0.0,
        // Segments along curved axes are cut so that no piece spans more.
        Some(curved) => curved.step(k),
        None => value.span * value.cell_span,
    };
    let spans: Vec<f64> = values.iter().enumerate().map(span).collect();
    let spans = Spans { values: &spans, longest: grid.longest };
    check_32_bits(shader_key, transfer_function, &spans).map_err(|error: Error| {
        let accepted = error.expected.clone().unwrap_or_default();
        error.expected(format!("{accepted}; engine = \"cpu\" holds it"))
    })
}

/// Optical depth that all cells left out together may have along the longest ray.
const DEPTH_LEFT_OUT: f64 = 1e-7;

/// Supports of widgets as the shader reads them, for the device to leave out the cells that none touches: where each one's slabs
/// low ≤ a s + b g ≤ high of stored values begin and the last one's end, then four numbers a slab. And how many supports there are.
///
/// A cell is kept if for some support its corners reach every slab. That is less sharp than the native engine's hulls, and as
/// safe. Slabs across a curved axis are those of its values; ones aslant leave nothing out there.
fn supports(transfer_function: &TransferFunction, axes: &[Axis], length: f64) -> (Vec<u32>, u32) {
    let share = DEPTH_LEFT_OUT / transfer_function.widgets.len().max(1) as f64;
    let longest = length / transfer_function.unit_distance;
    let of = |widget: &Widget| widget.slabs(longest * widget.peak(), share, transfer_function.model);
    let supports: Vec<Vec<Slab>> = transfer_function.widgets.iter().flat_map(of).collect();
    let axis = |k: usize| axes.get(k).map_or([0.0, 1.0], |axis| [axis.offset, axis.scale]);
    let axes = [axis(0), axis(1)];
    let (mut starts, mut numbers) = (vec![0u32], Vec::new());
    for slabs in &supports {
        let slabs = slabs.iter().filter_map(|slab| slab.of_values(&transfer_function.axes_read()));
        numbers.extend(slabs.flat_map(|slab| slab.stored(axes)));
        starts.push(numbers.len() as u32 / 4);
    }
    let count = supports.len() as u32;
    starts.extend(numbers.iter().map(|x: &f32| x.to_bits()));
    (starts, count)
}

/// Rounding error of a point that is allowed (pixels). An ordinary picture changes by less than a tenth in a pixel's
/// width, so by less than 1e-4 for this.
const PIXELS_OFF: f64 = 1e-2;

/// Rounding of a position about the base and of its turn into camera axes, in scene lengths.
const ROUNDING: f64 = 2.0 * f32::EPSILON as f64;

/// The grid as a camera sees it, for the sample at `offset` from the middle of a pixel. What belongs to the window and to
/// the scene is 0.
///
/// Errors: a camera out of range; a view so narrow that 32 bits do not tell its pixels apart.
fn view(grid: &DeviceGrid, camera: &Camera, offset: [f64; 2]) -> Result<ViewRecord> {
    camera.check_picture()?;
    let frame = camera.frame()?;
    let perspective = matches!(camera.projection, Projection::Perspective { .. });
    let pixel = if perspective { frame.pixel } else { frame.pixel / grid.length };
    let eye = (camera.eye - grid.centre) / grid.length;
    // The view axis from where it can first meet the grid, which lies within half a scene length of its middle; of a flat grid
    // seen across, within twice its own depth, so that depths in it keep their digits.
    // A near plane behind that is where the grid is first seen.
    let depth = 2.0 * grid.half.dot(frame.forward.abs());
    let near = camera.near / grid.length;
    let distance = (-eye.dot(frame.forward) - (2.0 * depth).min(0.5)).max(near).max(0.0);
    let base = eye + distance * frame.forward;
    let near = near - distance;
    // The farthest point seen stands a scene length behind the base, where a pixel is as wide as this.
    let width = if perspective { pixel * (distance + 1.0) } else { pixel };
    let reach = 1.0 + base.length().min(1.0);
    if ROUNDING * reach > PIXELS_OFF * width {
        return Err(Error::run("the view is too narrow for the device's 32 bits")
            .got(format!("pixels of {:.1e} of the grid's diagonal", width))
            .expected(format!("at least {:.1e}, or engine = \"cpu\"", ROUNDING * reach / PIXELS_OFF)));
    }
    let numbers = [pixel, distance, near, base.x, base.y, base.z];
    if numbers.iter().any(|x| !x.is_finite() || x.abs() > 1e15) {
        return Err(Error::run("the camera stands too far from the grid for the device's 32 bits")
            .got(format!("{:.1e} of the grid's diagonal", eye.length()))
            .expected("at most 1e15, or engine = \"cpu\""));
    }
    let vector = |v: DVec3| v.to_array().map(|x| x as f32);
    let parts = base.to_array().map(split);
    let [width, height] = camera.size.map(f64::from);
    Ok(ViewRecord {
        right: vector(frame.right),
        distance: distance as f32,
        down: vector(-frame.up),
        pixel: pixel as f32,
        forward: vector(frame.forward),
        near: near as f32,
        base_high: parts.map(|part| part[0]),
        perspective: if perspective { 1.0 } else { 0.0 },
        base_low: parts.map(|part| part[1]),
        axis: [(0.5 * width - 0.5 - offset[0]) as f32, (0.5 * height - 0.5 - offset[1]) as f32],
        size: camera.size,
        point_count: grid.point_count,
        cell_count: grid.cell_count,
        ..bytemuck::Zeroable::zeroed()
    })
}
