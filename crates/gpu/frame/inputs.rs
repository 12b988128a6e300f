//! Inputs of a frame: everything that a scene puts on the device, but the camera's samples one by one.

use crate::device::bindings::compositor_buffers;
use crate::device::device_handle::Device;
use crate::frame::output::PendingStats;
use crate::frame::renderer::Renderer;
use crate::frame::{limits, support, view};
use crate::grid::axes::{axis, offset_parts};
use crate::grid::device_grid::{DeviceArray, DeviceGrid, ValueArray};
use crate::grid::split_buffer::BufferSizes;
use crate::pass::tables::TableKey;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_core::visibility::FaceOrder;
use voltet_optics::engine::{Accumulation, Compositor, RenderOptions};
use voltet_optics::integrators::Extent;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Ordering, Shading};
use voltet_shaders::{
    Axis, Blend, Combine, CompositorProgram, Parameters, Places, Shader, ShaderKey, TileOrder, ViewRecord,
    compose,
};

/// Everything of a scene but the camera's sample.
pub(crate) struct FrameInputs<'a> {
    pub renderer: &'a Renderer,
    pub shader_key: ShaderKey,
    pub sizes: BufferSizes,
    pub shading: Shading,
    pub tables: TableKey,
    pub compositor: Shader,
    /// Read-only buffers that the compositor reads, with their bindings in group 0.
    pub storage_buffers: Vec<(String, u32)>,
    /// The scalar.
    pub scalar: Arc<DeviceArray>,
    /// Further values of the points, each with where it is counted from.
    pub attributes: Vec<(Arc<DeviceArray>, [f32; 2])>,
    pub reads_g: bool,
    pub scene: Vec<u8>,
    pub numbers: Vec<f32>,
    pub support: Vec<u32>,
    /// True if what is blended stands in 8 bits a channel.
    pub in_8_bits: bool,
    /// True if pixels that are opaque look at no further cells.
    pub stops_where_opaque: bool,
    /// True if cells are sorted on the device.
    pub sorted: bool,
    /// The order of cells along their faces, where they are blended in it.
    pub ordered: Option<Arc<FaceOrder>>,
    pub samples: Vec<ViewRecord>,
}

impl<'a> FrameInputs<'a> {
    pub fn grid(&self) -> &'a DeviceGrid {
        &self.renderer.grid
    }

    pub fn device(&self) -> &'a Device {
        &self.renderer.grid.device
    }

    /// The output of the frame as far as it is known before readback.
    pub(crate) fn pending_stats(&self, scene: &Scene, options: &RenderOptions) -> PendingStats {
        let is_counted = compositing(options) == Compositor::Tiles;
        let (parts_left_out, part_bytes_left_out) = parts_left_out(&self.compositor);
        PendingStats {
            is_counted,
            is_order_known: is_counted || is_free(self.shader_key.compositor) || !scene.needs_order(),
            parts_left_out,
            part_bytes_left_out,
            blended_in_16_bits: !is_counted
                && options.accumulation == Accumulation::Float
                && !self.device().blends_32_bits,
        }
    }

    /// Bytes of a window's pixels.
    pub fn picture_bytes(&self, window: [u32; 4]) -> u64 {
        let pixels = u64::from(window[2]) * u64::from(window[3]) * u64::from(ViewRecord::TILE).pow(2);
        pixels * 16
    }
}

/// Makes the inputs of a scene's frame. `along_faces`: the order of cells in which hardware blends them.
///
/// Errors: what the device has no shader for, cannot hold in 32 bits, or has more parts than it binds; memory; a lost device.
pub(crate) fn inputs<'a>(
    renderer: &'a Renderer,
    scene: &Scene,
    options: &RenderOptions,
    along_faces: Option<&Arc<FaceOrder>>,
) -> Result<FrameInputs<'a>> {
    let Scene { volume, transfer_function, camera, shading, .. } = scene;
    let grid = &renderer.grid;
    limits::can_serve(transfer_function, shading)?;
    let compositing = compositing(options);
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
    limits::check(grid, &shader_key, transfer_function, &values)?;
    let numbered = values.iter().enumerate();
    let axes: Vec<Axis> = numbered.map(|(k, value)| axis(value, transfer_function, k)).collect();
    let parameters = Parameters::new(transfer_function, shading, &axes, grid.length)?;
    let (support, support_count) = match options.exhaustive {
        false => support::supports(transfer_function, &axes, grid.length),
        true => support::everywhere(),
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
        _ if compositor == CompositorProgram::Tiles(TileOrder::Exact) => 0,
        Ordering::CellCentroid => 1,
        // What comes in its order needs no key.
        _ => 2,
    };
    let sample = |offset: &[f64; 2]| {
        Ok(ViewRecord {
            sort_key,
            scalar_offset: offset_parts(&scalar, &axes[0]),
            widget_count: support_count,
            ..view::view(grid, camera, *offset)?
        })
    };
    let shader = compose(&shader_key);
    Ok(FrameInputs {
        renderer,
        compositor: shader,
        storage_buffers: shader_key.storage_buffers(),
        reads_g: shader_key.reads_gradient_magnitude,
        tables: TableKey {
            transfer_function: transfer_function.clone(),
            integrator: shading.integrator,
            axis: axes[0],
            length: grid.length,
            extent: Extent { scalar: scalar.range(), longest: grid.longest },
        },
        shading: *shading,
        shader_key,
        sizes,
        scene: parameters.scene_bytes(),
        numbers: parameters.numbers,
        support,
        in_8_bits: options.accumulation == Accumulation::Bits8,
        stops_where_opaque: !options.exhaustive,
        sorted: !is_free && (sort_key != 2 || compositing == Compositor::Tiles),
        ordered: along_faces.cloned(),
        samples: camera.sample_offsets().iter().map(sample).collect::<Result<_>>()?,
        scalar: scalar.clone(),
        attributes,
    })
}

/// The compositor; tiles where none is requested.
pub(crate) fn compositing(options: &RenderOptions) -> Compositor {
    options.compositing.unwrap_or(Compositor::Tiles)
}

/// The order that the compositor makes. Blending hardware makes none where none is needed; in exhaustive mode, and where each
/// blended cell is rounded and the order shows a little, it makes that of centroids in place of an exact one.
fn ordering(scene: &Scene, options: &RenderOptions) -> Ordering {
    let ordering = scene.ordering(options.exhaustive);
    if compositing(options) == Compositor::Tiles || scene.needs_order() {
        return ordering;
    }
    match ordering {
        _ if !options.exhaustive && options.accumulation == Accumulation::Float => Ordering::Independent,
        Ordering::Independent | Ordering::PerPixel => Ordering::CellCentroid,
        ordering => ordering,
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
    let compositor = compositor(transfer_function, shading, ordering(scene, options), options)?;
    if compositing(options) != Compositor::Tiles {
        grid.device.check_blending(compositing(options), options.accumulation, grid.cell_count.into())?;
    }
    let mut shader_key = ShaderKey::new(transfer_function, shading, compositor)?;
    let sizes = sizes(grid, &shader_key, compositing(options), transfer_function, shading);
    sizes.check(grid.device.room(), &grid.device.name)?;
    shader_key.layout = sizes.layout(grid.device.room());
    Ok((shader_key, sizes))
}

/// Sizes of the scene's buffers.
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
    transfer_function: &TransferFunction,
    shading: &Shading,
    ordering: Ordering,
    options: &RenderOptions,
) -> Result<CompositorProgram> {
    let compositing = compositing(options);
    let shader_key = ShaderKey::new(transfer_function, shading, CompositorProgram::None)?;
    let lit = shading.light.is_some_and(|light| light.diffuse != 0.0);
    let known = !shader_key.method.is_table_of_lengths();
    let needed = !known || !matches!(shader_key.combine, Combine::OneColor | Combine::Nothing) || lit;
    options.accumulation.check(compositing)?;
    let free = !needed && !options.exhaustive;
    Ok(match (compositing, ordering) {
        (Compositor::Tiles, _) if free => CompositorProgram::Tiles(TileOrder::Sum),
        (Compositor::Tiles, Ordering::Independent | Ordering::PerPixel) => {
            CompositorProgram::Tiles(TileOrder::Exact)
        }
        (Compositor::Tiles, Ordering::CellCentroid | Ordering::Submission) => {
            CompositorProgram::Tiles(TileOrder::Listed)
        }
        (Compositor::Raster, _) => CompositorProgram::Raster(blend(options.accumulation, free)),
        (Compositor::Triangles, _) => CompositorProgram::Triangles(blend(options.accumulation, free)),
    })
}

/// Content of a pixel: one number where order is of no account, but for frame buffers of few bits, which hold colours.
fn blend(accumulation: Accumulation, free: bool) -> Blend {
    match accumulation {
        Accumulation::Float if free => Blend::Sum,
        Accumulation::Float | Accumulation::Bits8 => Blend::Over,
        Accumulation::Bits12 => Blend::Rounded { bits: 12 },
        Accumulation::Bits16 => Blend::Rounded { bits: 16 },
    }
}
