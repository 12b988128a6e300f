//! Compute passes on any adapter: buffers in, numbers out.

use voltet_shaders::{Contents, Resources, Shader};
use wgpu::util::DeviceExt;

/// A device, with the name of its adapter.
pub struct Device {
    pub name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// A buffer that a pass reads or writes.
pub struct Bound {
    pub group: u32,
    pub binding: u32,
    pub buffer: wgpu::Buffer,
}

/// A compiled pass.
pub struct Pass {
    pipeline: wgpu::ComputePipeline,
}

/// Buffers, and the passes that fill some of them.
pub struct Prepared {
    pub buffers: Vec<wgpu::Buffer>,
    passes: Vec<(Pass, Vec<Bound>, [u32; 3])>,
}

impl Device {
    /// `None` where there is no adapter, said loudly; a failure if the environment variable `VOLTET_REQUIRE_GPU` is 1.
    pub fn open() -> Option<Device> {
        let found = pollster::block_on(Device::request());
        match found {
            Ok(device) => {
                println!("adapter: {}", device.name);
                Some(device)
            }
            Err(why) => {
                voltet_testing::skipped_without_device(why);
                None
            }
        }
    }

    async fn request() -> Result<Device, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(|e| e.to_string())?;
        let descriptor = wgpu::DeviceDescriptor::default();
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|e| e.to_string())?;
        let info = adapter.get_info();
        Ok(Device { name: format!("{} ({:?})", info.name, info.device_type), device, queue })
    }

    /// Compiles; errors come at the piece's own file and line.
    pub fn compile(&self, shader: &Shader, entry_point: &str, constants: &[(&str, f64)]) -> Pass {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        let info = pollster::block_on(module.get_compilation_info());
        if let Some(message) = info.messages.first() {
            let line = message.location.map_or(1, |location| location.line_number as usize);
            panic!("{}", shader.error(line, &message.message));
        }
        if let Some(error) = pollster::block_on(scope.pop()) {
            panic!("{error}");
        }
        Pass { pipeline }
    }

    fn buffer(&self, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents,
            usage: usage | wgpu::BufferUsages::COPY_SRC,
        })
    }

    /// A uniform buffer.
    pub fn uniform(&self, contents: &[u8]) -> wgpu::Buffer {
        self.buffer(contents, wgpu::BufferUsages::UNIFORM)
    }

    /// A storage buffer.
    pub fn storage(&self, contents: &[u8]) -> wgpu::Buffer {
        self.buffer(contents, wgpu::BufferUsages::STORAGE)
    }

    /// The buffers of `resources`, not yet filled by its passes, which are compiled.
    pub fn prepare(&self, resources: &Resources) -> Prepared {
        let make = |Contents { filled, bytes }: &Contents| {
            let unfilled = f32::NAN.to_ne_bytes().repeat(*filled as usize / size_of::<f32>());
            self.storage(&[&unfilled, &bytes[..]].concat())
        };
        let buffers: Vec<wgpu::Buffer> =
            resources.buffers.iter().map(|buffer| make(&buffer.contents)).collect();
        let passes = resources.passes.iter().map(|pass| {
            let bound = pass.buffers.iter().zip(0..).map(|(i, binding)| Bound {
                group: 0,
                binding,
                buffer: buffers[*i].clone(),
            });
            (self.compile(&pass.shader, pass.entry_point, &[]), bound.collect(), pass.workgroups)
        });
        Prepared { passes: passes.collect(), buffers }
    }

    /// Runs the passes that fill buffers.
    pub fn fill(&self, prepared: &Prepared) {
        for (pass, bound, workgroups) in &prepared.passes {
            self.dispatch(pass, bound, *workgroups);
        }
    }

    /// Runs `pass` over so many workgroups.
    pub fn dispatch(&self, pass: &Pass, bound: &[Bound], workgroups: [u32; 3]) {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut compute = encoder.begin_compute_pass(&Default::default());
        compute.set_pipeline(&pass.pipeline);
        let groups = bound.iter().map(|bound| bound.group).max().unwrap_or(0);
        for group in 0..=groups {
            let entries: Vec<wgpu::BindGroupEntry> = bound
                .iter()
                .filter(|bound| bound.group == group)
                .map(|bound| wgpu::BindGroupEntry {
                    binding: bound.binding,
                    resource: bound.buffer.as_entire_binding(),
                })
                .collect();
            let bind_group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pass.pipeline.get_bind_group_layout(group),
                entries: &entries,
            });
            compute.set_bind_group(group, &bind_group, &[]);
        }
        let [x, y, z] = workgroups;
        compute.dispatch_workgroups(x, y, z);
        drop(compute);
        self.queue.submit([encoder.finish()]);
    }

    /// Contents of a buffer when all passes are done.
    pub fn read(&self, buffer: &wgpu::Buffer) -> Vec<f32> {
        let read = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: buffer.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &read, 0, read.size());
        self.queue.submit([encoder.finish()]);
        read.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("the buffer is readable"));
        self.wait();
        let view = read.slice(..).get_mapped_range().expect("the buffer is mapped");
        bytemuck::pod_collect_to_vec(&view)
    }

    /// Waits until all passes are done.
    pub fn wait(&self) {
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    }

    /// Runs `pass` once for each of `count` elements; `output` is its (group, binding), of `length` numbers. The output
    /// is filled with NaN before, so that what was not written is not taken for a result.
    pub fn run(
        &self,
        pass: &Pass,
        mut inputs: Vec<Bound>,
        output: (u32, u32),
        length: usize,
        count: usize,
    ) -> Vec<f32> {
        let buffer = self.storage(bytemuck::cast_slice(&vec![f32::NAN; length]));
        inputs.push(Bound { group: output.0, binding: output.1, buffer: buffer.clone() });
        self.dispatch(pass, &inputs, [count.div_ceil(64) as u32, 1, 1]);
        self.read(&buffer)
    }
}
