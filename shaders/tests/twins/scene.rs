//! Whole composed shaders over lists of segments.

use crate::device::{Bound, Device, Pass, Prepared};
use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::Extent;
use voltet_optics::shading::Shading;
use voltet_optics::{Contribution, Segment};
use voltet_shaders::segment_list::{CONTRIBUTION, constants, contributions, row};
use voltet_shaders::{Axis, CompositorProgram, Parameters, Resources, Shader, ShaderKey, compose};

/// A device with the passes that it has compiled.
pub struct Scenes {
    pub device: Device,
    passes: RefCell<HashMap<String, Rc<Pass>>>,
}

/// A transfer function with its shading, and all that its shader reads but the segments.
pub struct Composed {
    pub shader_key: ShaderKey,
    parameters: Parameters,
    pub resources: Resources,
    tables: OnceCell<Prepared>,
    axes: Vec<Axis>,
    length: f64,
}

/// Extent for scenes without a table of lengths.
const NO_EXTENT: Extent = Extent { scalar: [0.0; 2], longest: 1.0 };

impl Composed {
    /// `axes` of s, g and the fields, `length`: the unit of D. What leaves the range of 32 bits is the inner error.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        axes: &[Axis],
        length: f64,
        extent: Option<&Extent>,
    ) -> Result<std::result::Result<Composed, &'static str>> {
        let shader_key = ShaderKey::new(transfer_function, shading, CompositorProgram::Segments)?;
        let Ok(parameters) = Parameters::new(transfer_function, shading, axes, length) else {
            return Ok(Err("numbers leave the range of 32 bits"));
        };
        let extent = extent.unwrap_or(&NO_EXTENT);
        let numbers = &parameters.numbers;
        let resources =
            Resources::new(&shader_key, transfer_function, shading, axes[0], length, extent, numbers)?;
        let axes = axes.to_vec();
        Ok(Ok(Composed { shader_key, parameters, resources, tables: OnceCell::new(), axes, length }))
    }

    /// The tables, filled when they are first asked for.
    pub fn tables(&self, device: &Device) -> &[wgpu::Buffer] {
        let fill = || {
            let prepared = device.prepare(&self.resources);
            device.fill(&prepared);
            prepared
        };
        &self.tables.get_or_init(fill).buffers
    }
}

impl Scenes {
    pub fn new(device: Device) -> Scenes {
        Scenes { device, passes: RefCell::default() }
    }

    /// Shaders compiled so far.
    pub fn count(&self) -> usize {
        self.passes.borrow().len()
    }

    pub fn pass(&self, shader: &Shader, entry_point: &str, constants: &[(&str, f64)]) -> Rc<Pass> {
        let mut passes = self.passes.borrow_mut();
        let made = || Rc::new(self.device.compile(shader, entry_point, constants));
        passes.entry(shader.text.clone()).or_insert_with(made).clone()
    }

    /// Each segment's contribution, from one dispatch.
    pub fn integrate(&self, scene: &Composed, segments: &[Segment]) -> Vec<Contribution> {
        self.integrate_by(scene, &compose(&scene.shader_key), segments)
    }

    /// Integrates by another shader that reads the scene's resources.
    pub fn integrate_by(&self, scene: &Composed, shader: &Shader, segments: &[Segment]) -> Vec<Contribution> {
        let (pass, inputs) = self.bind(scene, shader, segments);
        let length = CONTRIBUTION * segments.len();
        let found = self.device.run(&pass, inputs, (1, 1), length, segments.len());
        contributions(&found)
    }

    /// Seconds of one dispatch over the segments, the least of `count`.
    pub fn seconds(&self, scene: &Composed, segments: &[Segment], count: u32) -> f64 {
        let (pass, mut inputs) = self.bind(scene, &compose(&scene.shader_key), segments);
        let buffer = self.device.storage(&vec![0; CONTRIBUTION * segments.len() * size_of::<f32>()]);
        inputs.push(Bound { group: 1, binding: 1, buffer });
        let workgroups = [segments.len().div_ceil(64) as u32, 1, 1];
        let once = |_| {
            let start = Instant::now();
            self.device.dispatch(&pass, &inputs, workgroups);
            self.device.wait();
            start.elapsed().as_secs_f64()
        };
        (0..count).map(once).fold(f64::INFINITY, f64::min)
    }

    /// The pass over a list of segments, and all that it reads.
    fn bind(&self, scene: &Composed, shader: &Shader, segments: &[Segment]) -> (Rc<Pass>, Vec<Bound>) {
        let device = &self.device;
        let pass = self.pass(shader, "integrate_segments", constants(&scene.shader_key, shader));
        let of = |segment: &Segment| row(&scene.shader_key, &scene.axes, scene.length, segment);
        let rows: Vec<f32> = segments.iter().flat_map(of).collect();
        let storage = |group, binding, bytes: &[u8]| Bound { group, binding, buffer: device.storage(bytes) };
        let mut inputs = vec![storage(1, 0, bytemuck::cast_slice(&rows))];
        let from_table = scene.shader_key.method.is_table_of_lengths();
        if from_table || !scene.shader_key.widgets.is_empty() {
            inputs.push(Bound {
                group: 0,
                binding: 0,
                buffer: device.uniform(&scene.parameters.scene_bytes()),
            });
        }
        for (buffer, table) in scene.resources.buffers.iter().zip(scene.tables(device)) {
            if let Some(binding) = buffer.binding {
                inputs.push(Bound { group: 0, binding, buffer: table.clone() });
            }
        }
        (pass, inputs)
    }
}
