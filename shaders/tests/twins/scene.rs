//! Whole composed shaders over lists of segments.

use crate::device::{Bound, Device, Pass, Prepared};
use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::optics::integrators::Extent;
use voltet_core::optics::{Contribution, Segment};
use voltet_core::shading::Shading;
use voltet_core::transfer::{Profile, TransferFunction, Widget};
use voltet_shaders::{Axis, Choices, Combine, Compositor, Parameters, Resources, Shader, compose};

/// A device with the passes that it has compiled.
pub struct Scenes {
    pub device: Device,
    passes: RefCell<HashMap<String, Rc<Pass>>>,
}

/// A transfer function with its shading, and all that its shader reads but the segments.
pub struct Scene {
    pub choices: Choices,
    parameters: Parameters,
    pub resources: Resources,
    tables: OnceCell<Prepared>,
    axes: Vec<Axis>,
    length: f64,
}

/// Numbers of a contribution on the device: r, g, b, A, T, and what its alignment adds.
const CONTRIBUTION: usize = 8;

/// Where no table of lengths is asked for.
const NO_EXTENT: Extent = Extent { scalar: [0.0; 2], longest: 1.0 };

impl Scene {
    /// `axes` of s, g and the fields, `length`: the unit of D. What leaves the range of 32 bits is the inner error.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        axes: &[Axis],
        length: f64,
        extent: Option<&Extent>,
    ) -> Result<std::result::Result<Scene, &'static str>> {
        let choices = Choices::new(transfer_function, shading, Compositor::Segments)?;
        let Ok(parameters) = Parameters::new(transfer_function, shading, axes, length) else {
            return Ok(Err("numbers leave the range of 32 bits"));
        };
        let extent = extent.unwrap_or(&NO_EXTENT);
        let resources = Resources::new(&choices, transfer_function, shading, axes[0], length, extent)?;
        let axes = axes.to_vec();
        Ok(Ok(Scene { choices, parameters, resources, tables: OnceCell::new(), axes, length }))
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

    fn row(&self, segment: &Segment) -> Vec<f32> {
        let mut row = vec![(segment.length / self.length) as f32];
        for (plane, fields) in [(segment.front, segment.fields_front), (segment.back, segment.fields_back)] {
            let values = [&plane, fields].concat();
            let read = |a: usize| match a {
                0 => true,
                1 => self.choices.reads_gradient_magnitude,
                _ => a - 2 < self.choices.field_count,
            };
            for (a, axis) in self.axes.iter().enumerate().filter(|(a, _)| read(*a)) {
                row.push(((values[a] - axis.offset) / axis.scale) as f32);
            }
        }
        row
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
    pub fn integrate(&self, scene: &Scene, segments: &[Segment]) -> Vec<Contribution> {
        self.integrate_by(scene, &compose(&scene.choices), segments)
    }

    /// The same by another shader that reads what the scene's reads.
    pub fn integrate_by(&self, scene: &Scene, shader: &Shader, segments: &[Segment]) -> Vec<Contribution> {
        let (pass, inputs) = self.bind(scene, shader, segments);
        let length = CONTRIBUTION * segments.len();
        let found = self.device.run(&pass, inputs, (1, 1), length, segments.len());
        let contribution = |found: &[f32]| {
            let [red, green, blue, opacity, optical_depth] = std::array::from_fn(|i| f64::from(found[i]));
            Contribution { optical_depth, color: [red, green, blue], opacity }
        };
        found.chunks(CONTRIBUTION).map(contribution).collect()
    }

    /// Seconds of one dispatch over the segments, the least of `count`.
    pub fn seconds(&self, scene: &Scene, segments: &[Segment], count: u32) -> f64 {
        let (pass, mut inputs) = self.bind(scene, &compose(&scene.choices), segments);
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
    fn bind(&self, scene: &Scene, shader: &Shader, segments: &[Segment]) -> (Rc<Pass>, Vec<Bound>) {
        let device = &self.device;
        // No product of depths is too small for the order of widgets: channels are judged by themselves.
        let has_threshold =
            scene.choices.combine == Combine::Ordered && shader.text.contains("order_threshold");
        let constants: &[(&str, f64)] = if has_threshold { &[("order_threshold", 0.0)] } else { &[] };
        let pass = self.pass(shader, "integrate_segments", constants);
        let rows: Vec<f32> = segments.iter().flat_map(|segment| scene.row(segment)).collect();
        let storage = |group, binding, bytes: &[u8]| Bound { group, binding, buffer: device.storage(bytes) };
        let mut inputs = vec![storage(1, 0, bytemuck::cast_slice(&rows))];
        let from_table = scene.choices.method.is_table_of_lengths();
        if !from_table && !scene.choices.widgets.is_empty() {
            inputs.push(Bound {
                group: 0,
                binding: 0,
                buffer: device.uniform(&scene.parameters.scene_bytes()),
            });
        }
        if scene.choices.reads_numbers() {
            inputs.push(storage(0, 1, bytemuck::cast_slice(&scene.parameters.numbers)));
        }
        for (buffer, table) in scene.resources.buffers.iter().zip(scene.tables(device)) {
            if let Some(binding) = buffer.binding {
                inputs.push(Bound { group: 0, binding, buffer: table.clone() });
            }
        }
        (pass, inputs)
    }
}

/// The one place that all differences of a scene are taken from, if there is one: [s, g], then the fields.
pub fn origin(widgets: &[Widget]) -> Option<Vec<f64>> {
    let [widget] = widgets else { return None };
    if widget.region.is_some() {
        return None;
    }
    match &widget.profile {
        Profile::Gaussian { centre, .. } => Some(centre.to_vec()),
        Profile::GaussianNd { centre, .. } => Some([&[0.0, 0.0], centre.as_slice()].concat()),
        Profile::TriangularGaussian { centre, .. } => Some(vec![*centre, 0.0]),
        Profile::TriangleWave(wave) | Profile::SineWave(wave) => Some(wave.origin.to_vec()),
        _ => None,
    }
}

/// [s, g] and the fields at both ends.
pub fn ends(segment: &Segment) -> [Vec<f64>; 2] {
    [[&segment.front, segment.fields_front].concat(), [&segment.back, segment.fields_back].concat()]
}

/// |v_b − v_f|.
pub fn spans(segment: &Segment) -> Vec<f64> {
    let [front, back] = ends(segment);
    front.iter().zip(&back).map(|(a, b)| (b - a).abs()).collect()
}

/// Axes for one segment alone: values about the origin, at most 1 and with all their digits, since scales are powers of
/// two.
pub fn axes(transfer_function: &TransferFunction, segment: &Segment) -> Vec<Axis> {
    let origin = origin(&transfer_function.widgets).unwrap_or_default();
    let [front, back] = ends(segment);
    let axis = |a: usize| {
        let offset = origin.get(a).copied().unwrap_or(0.0);
        let size = (front[a] - offset).abs().max((back[a] - offset).abs());
        let scale = if size > 0.0 { size.log2().ceil().exp2() } else { 1.0 };
        Axis { offset, scale }
    };
    (0..2 + transfer_function.fields().len()).map(axis).collect()
}
