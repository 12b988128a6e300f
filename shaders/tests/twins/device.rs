//! One compute pass on any adapter: buffers in, numbers out.

use voltet_shaders::Shader;
use wgpu::util::DeviceExt;

/// A device, with the name of its adapter.
pub struct Device {
    pub name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// A buffer that a pass reads.
pub struct Input<'a> {
    pub group: u32,
    pub binding: u32,
    pub uniform: bool,
    pub bytes: &'a [u8],
}

/// A compiled pass.
pub struct Pass {
    pipeline: wgpu::ComputePipeline,
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
                let required = std::env::var("VOLTET_REQUIRE_GPU").is_ok_and(|value| value == "1");
                assert!(!required, "VOLTET_REQUIRE_GPU is 1, but there is no adapter: {why}");
                eprintln!(
                    "\n*** SKIPPED: no Vulkan adapter ({why}); scripts/install-software-vulkan.sh ***\n"
                );
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

    /// Runs `pass` once for each of `count` elements; `output` is its (group, binding). The output is filled with NaN
    /// before, so that what was not written is not taken for a result.
    pub fn run(
        &self,
        pass: &Pass,
        inputs: &[Input],
        output: (u32, u32),
        length: usize,
        count: usize,
    ) -> Vec<f32> {
        let make = |bytes: &[u8], usage| {
            self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: bytes,
                usage: usage | wgpu::BufferUsages::COPY_SRC,
            })
        };
        let empty = vec![f32::NAN; length];
        let result = make(bytemuck::cast_slice(&empty), wgpu::BufferUsages::STORAGE);
        let buffers: Vec<wgpu::Buffer> = inputs
            .iter()
            .map(|input| {
                let usage =
                    if input.uniform { wgpu::BufferUsages::UNIFORM } else { wgpu::BufferUsages::STORAGE };
                make(input.bytes, usage)
            })
            .collect();
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut compute = encoder.begin_compute_pass(&Default::default());
        compute.set_pipeline(&pass.pipeline);
        let groups = inputs.iter().map(|input| input.group).chain([output.0]).max().unwrap_or(0);
        for group in 0..=groups {
            let mut entries: Vec<wgpu::BindGroupEntry> = inputs
                .iter()
                .zip(&buffers)
                .filter(|(input, _)| input.group == group)
                .map(|(input, buffer)| wgpu::BindGroupEntry {
                    binding: input.binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            if output.0 == group {
                let resource = result.as_entire_binding();
                entries.push(wgpu::BindGroupEntry { binding: output.1, resource });
            }
            let bind_group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pass.pipeline.get_bind_group_layout(group),
                entries: &entries,
            });
            compute.set_bind_group(group, &bind_group, &[]);
        }
        compute.dispatch_workgroups(count.div_ceil(64) as u32, 1, 1);
        drop(compute);
        let read = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (length * size_of::<f32>()) as u64,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(&result, 0, &read, 0, read.size());
        self.queue.submit([encoder.finish()]);
        read.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("the result is readable"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        let view = read.slice(..).get_mapped_range().expect("the result is mapped");
        bytemuck::pod_collect_to_vec(&view)
    }
}
