//! A device: its limits, its compiled pipelines, and its errors.

use crate::device::adapter::{Adapters, describe, kind};
use crate::device::pipeline_cache::{DrawingKey, PassKey, PipelineCache};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::{Error, Result};

/// An open device. Pipelines that were compiled for it stay.
pub struct Device {
    /// Name and kind of the adapter, for people.
    pub name: String,
    /// The driver and its version, as it calls itself.
    pub driver: String,
    /// Why this adapter was taken.
    pub reason: String,
    /// True if the device is a program on the CPU.
    pub is_software: bool,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) limits: wgpu::Limits,
    pub(crate) downlevel: wgpu::DownlevelFlags,
    /// True if textures of 32-bit floats can be blended in.
    pub(crate) blends_32_bits: bool,
    /// Nanoseconds of a tick, where passes can be timed.
    pub(crate) tick: Option<f32>,
    pub(crate) passes: PipelineCache<PassKey, wgpu::ComputePipeline>,
    pub(crate) drawings: PipelineCache<DrawingKey, wgpu::RenderPipeline>,
    pub(crate) work: AtomicWorkCounts,
    lost: Arc<Mutex<Option<String>>>,
}

/// Counts of the work done on the device since it was opened.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WorkCounts {
    /// Pipelines compiled.
    pub shader_builds: u64,
    /// Arrays of grids uploaded.
    pub uploads: u64,
    /// Bytes sent to the device: grids, tables and what frames are told.
    pub bytes_uploaded: u64,
}

#[derive(Default)]
pub(crate) struct AtomicWorkCounts {
    pub shader_builds: AtomicU64,
    pub uploads: AtomicU64,
    pub bytes_uploaded: AtomicU64,
}

/// Storage buffers of a stage that are enough: those that every device of WebGPU has.
const STORAGE_BUFFERS: u32 = 8;

impl Device {
    /// Opens the fastest adapter, or the one that `wish` names (a kind, or a part of its name). With `hardware`,
    /// software devices are passed over unless they are wished for.
    pub fn open(wish: Option<&str>, hardware: bool) -> Result<Device> {
        Device::open_of(&Adapters::find(), wish, hardware)
    }

    /// Like [`Device::open`], among adapters that were found.
    pub(crate) fn open_of(adapters: &Adapters, wish: Option<&str>, hardware: bool) -> Result<Device> {
        Device::open_within(adapters, wish, hardware, |limits| limits)
    }

    /// Like [`Device::open`], with no more than every device of WebGPU has: bindings of 128 MiB, 8 storage buffers of a stage, workgroups of
    /// 256 invocations and 16 KiB. What needs more is an error, as it would be there.
    pub fn open_as_webgpu(wish: Option<&str>) -> Result<Device> {
        Device::open_within(&Adapters::find(), wish, false, |_| wgpu::Limits::defaults())
    }

    fn open_within(
        adapters: &Adapters,
        wish: Option<&str>,
        hardware: bool,
        within: impl Fn(wgpu::Limits) -> wgpu::Limits,
    ) -> Result<Device> {
        let (adapter, reason) = adapters.choose(wish, hardware)?;
        let info = adapter.get_info();
        let limits = within(adapter.limits());
        if limits.max_storage_buffers_per_shader_stage < STORAGE_BUFFERS {
            return Err(Error::run(format!("{} binds too few buffers at a time", describe(&info)))
                .got(limits.max_storage_buffers_per_shader_stage)
                .expected(format!("{STORAGE_BUFFERS} storage buffers")));
        }
        let wished = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::FLOAT32_BLENDABLE;
        let features = adapter.features() & wished;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("voltet"),
            required_features: features,
            required_limits: limits.clone(),
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened
            .map_err(|why| Error::run(format!("the device {} does not open", describe(&info))).got(why))?;
        let lost = Arc::new(Mutex::new(None));
        let note = lost.clone();
        device.set_device_lost_callback(move |why, message| {
            *note.lock().unwrap_or_else(PoisonError::into_inner) = Some(format!("{why:?}: {message}"));
        });
        // Without a handler an error outside of `guarded` would end the program.
        let note = lost.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            *note.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
        }));
        let is_software = kind(info.device_type).1 == "software";
        Ok(Device {
            name: describe(&info),
            driver: format!("{} {}", info.driver, info.driver_info),
            reason,
            is_software,
            tick: features.contains(wgpu::Features::TIMESTAMP_QUERY).then(|| queue.get_timestamp_period()),
            device,
            queue,
            limits,
            downlevel: adapter.get_downlevel_capabilities().flags,
            blends_32_bits: features.contains(wgpu::Features::FLOAT32_BLENDABLE),
            passes: PipelineCache::default(),
            drawings: PipelineCache::default(),
            work: AtomicWorkCounts::default(),
            lost,
        })
    }

    /// Limits buffers to this many bytes each, as if its bindings held no more.
    pub fn with_bindings_of(mut self, bytes: u64) -> Device {
        self.limits.max_storage_buffer_binding_size = bytes;
        self
    }

    /// Limits the storage buffers of a pass to this number, as if it bound no more.
    pub fn with_buffers_at_a_time(mut self, count: u32) -> Device {
        self.limits.max_storage_buffers_per_shader_stage = count;
        self
    }

    /// Limits textures to this many pixels a side.
    pub fn with_textures_of(mut self, side: u32) -> Device {
        self.limits.max_texture_dimension_2d = side;
        self
    }

    /// Turns off blending of 32-bit floats.
    pub fn blending_16_bits(mut self) -> Device {
        self.blends_32_bits = false;
        self
    }

    /// Does something on the device. An error of the device comes back as one of ours, which names `what` was done.
    pub(crate) fn guarded<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let done = work();
        let internal = pollster::block_on(internal.pop());
        let validation = pollster::block_on(validation.pop());
        if pollster::block_on(memory.pop()).is_some() {
            return Err(self.out_of_memory(what));
        }
        self.check(what)?;
        match internal.or(validation) {
            None => Ok(done),
            Some(error) => Err(Error::run(format!("{} fails at {what}", self.name)).got(error)),
        }
    }

    fn out_of_memory(&self, what: &str) -> Error {
        Error::run(format!("{} has no memory left for {what}", self.name))
            .expected("a smaller grid or picture, another adapter, or engine = \"cpu\"")
    }

    /// An error if the device is lost.
    pub(crate) fn check(&self, what: &str) -> Result<()> {
        match &*self.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            None => Ok(()),
            Some(why) => Err(Error::run(format!("{} was lost at {what}", self.name))
                .got(why)
                .expected("a smaller picture or fewer samples, another adapter, or engine = \"cpu\"")),
        }
    }

    /// Counts of the work done so far.
    pub fn work(&self) -> WorkCounts {
        WorkCounts {
            shader_builds: self.work.shader_builds.load(Ordering::Relaxed),
            uploads: self.work.uploads.load(Ordering::Relaxed),
            bytes_uploaded: self.work.bytes_uploaded.load(Ordering::Relaxed),
        }
    }

    /// True if the device has been lost: nothing can be done with it any more.
    pub fn is_lost(&self) -> bool {
        self.lost.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Waits until a submission is done; without one, all that was submitted.
    pub(crate) fn wait(&self, what: &str, submission_index: Option<wgpu::SubmissionIndex>) -> Result<()> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index, timeout: None });
        self.check(what)?;
        waited
            .map(drop)
            .map_err(|why| Error::run(format!("{} does not answer at {what}", self.name)).got(why))
    }
}
