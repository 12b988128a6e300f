//! An open device: its limits, errors and buffers, the pipelines compiled for it, and the seconds of its passes.

use crate::device::adapter::{Adapters, describe, kind};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use voltet_core::error::Remedy;
use voltet_core::{Error, Result};
use voltet_optics::engine::{Stage, StageTiming};
use wgpu::{BufferUsages, SubmissionIndex};

pub(crate) mod adapter;
pub(crate) mod pipelines;

/// An open device. Pipelines that were compiled for it stay.
pub struct Device {
    /// Name and kind of the adapter, for people.
    pub name: String,
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
    pub(crate) passes: PipelineCache<wgpu::ComputePipeline>,
    pub(crate) drawings: PipelineCache<wgpu::RenderPipeline>,
    work: Mutex<WorkCounts>,
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

/// Storage buffers of a stage that are enough: those that every device of WebGPU has.
const STORAGE_BUFFERS: u32 = 8;

impl Device {
    /// Opens the fastest adapter, or the one that `wish` names (a kind, or a part of its name). With `hardware`,
    /// software devices are passed over unless they are wished for.
    pub fn open(wish: Option<&str>, hardware: bool) -> Result<Device> {
        Device::open_within(wish, hardware, None)
    }

    /// Like [`Device::open`], with no more than every device of WebGPU has: bindings of 128 MiB, 8 storage buffers of a stage, workgroups of
    /// 256 invocations and 16 KiB. What needs more is an error, as it would be there.
    pub fn open_as_webgpu(wish: Option<&str>) -> Result<Device> {
        Device::open_within(wish, false, Some(wgpu::Limits::defaults()))
    }

    /// `limits`: `None` for those of the adapter.
    fn open_within(wish: Option<&str>, hardware: bool, limits: Option<wgpu::Limits>) -> Result<Device> {
        let adapters = Adapters::find();
        let (adapter, reason) = adapters.choose(wish, hardware)?;
        let info = adapter.get_info();
        let limits = limits.unwrap_or_else(|| adapter.limits());
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
            *locked(&note) = Some(format!("{why:?}: {message}"));
        });
        // Without a handler an error outside of `guarded` would end the program.
        let note = lost.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            *locked(&note) = Some(error.to_string());
        }));
        let is_software = kind(info.device_type).1 == "software";
        Ok(Device {
            name: describe(&info),
            reason,
            is_software,
            tick: features.contains(wgpu::Features::TIMESTAMP_QUERY).then(|| queue.get_timestamp_period()),
            device,
            queue,
            limits,
            downlevel: adapter.get_downlevel_capabilities().flags,
            blends_32_bits: features.contains(wgpu::Features::FLOAT32_BLENDABLE),
            passes: Mutex::default(),
            drawings: Mutex::default(),
            work: Mutex::default(),
            lost,
        })
    }

    /// Lowers limits, as if the device had no more.
    pub fn with_limits(mut self, lower: impl FnOnce(&mut wgpu::Limits)) -> Device {
        lower(&mut self.limits);
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
            return Err(Error::run(format!("{} has no memory left for {what}", self.name))
                .expected("a smaller grid or picture, another adapter, or engine = \"cpu\"")
                .with_remedy(Remedy::FewerPixels));
        }
        self.check(what)?;
        match internal.or(validation) {
            None => Ok(done),
            Some(error) => Err(Error::run(format!("{} fails at {what}", self.name)).got(error)),
        }
    }

    /// Submits what `encode` records; see [`Device::guarded`].
    pub(crate) fn submit(
        &self,
        what: &str,
        encode: impl FnOnce(&mut wgpu::CommandEncoder),
    ) -> Result<SubmissionIndex> {
        self.guarded(what, || {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encode(&mut encoder);
            self.queue.submit([encoder.finish()])
        })
    }

    /// An error if the device is lost.
    pub(crate) fn check(&self, what: &str) -> Result<()> {
        match &*locked(&self.lost) {
            None => Ok(()),
            Some(why) => Err(Error::run(format!("{} was lost at {what}", self.name))
                .got(why)
                .expected("a smaller picture or fewer samples, another adapter, or engine = \"cpu\"")
                .with_remedy(Remedy::FewerPixels)),
        }
    }

    /// Counts of the work done so far.
    pub fn work(&self) -> WorkCounts {
        *locked(&self.work)
    }

    /// Adds to the counts of the work done.
    pub(crate) fn count(&self, add: impl FnOnce(&mut WorkCounts)) {
        add(&mut locked(&self.work));
    }

    /// True if the device has been lost: nothing can be done with it any more.
    pub fn is_lost(&self) -> bool {
        locked(&self.lost).is_some()
    }

    /// Waits until a submission is done; without one, all that was submitted.
    pub(crate) fn wait(&self, what: &str, submission_index: Option<SubmissionIndex>) -> Result<()> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index, timeout: None });
        self.check(what)?;
        waited
            .map(drop)
            .map_err(|why| Error::run(format!("{} does not answer at {what}", self.name)).got(why))
    }
}

/// Key of a pipeline: its text, its entry point (that for pixels, where it draws), and its constants or formats in words.
pub(crate) type PipelineKey = (String, &'static str, String);

/// Pipelines by what they were compiled from.
pub(crate) type PipelineCache<P> = Mutex<HashMap<PipelineKey, Arc<P>>>;

/// The content of a mutex, also where another thread failed with it.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) const MEBIBYTE: f64 = (1u64 << 20) as f64;

impl Device {
    /// Most bytes that a pass can be bound to in one buffer.
    pub(crate) fn most_bytes(&self) -> u64 {
        let binding = self.limits.max_storage_buffer_binding_size;
        self.limits.max_buffer_size.min(binding)
    }

    /// A storage buffer of at least `size` bytes. `what` names it in errors.
    pub(crate) fn storage(&self, what: &str, size: u64) -> Result<wgpu::Buffer> {
        let most = self.most_bytes();
        if size > most {
            return Err(Error::run(format!("{what} do not fit one binding of {}", self.name))
                .got(format!("{:.0} MiB", size as f64 / MEBIBYTE))
                .expected(format!(
                    "at most {:.0} MiB; engine = \"cpu\" has no such limit",
                    most as f64 / MEBIBYTE
                )));
        }
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer(what, size, usage)
    }

    pub(crate) fn buffer(&self, what: &str, size: u64, usage: BufferUsages) -> Result<wgpu::Buffer> {
        // No binding is smaller than an element, and copies take whole words.
        let size = size.max(32).next_multiple_of(16);
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
        let memory = format!("{what} ({:.1} MiB)", size as f64 / MEBIBYTE);
        self.guarded(&memory, || self.device.create_buffer(&descriptor))
    }

    pub(crate) fn uniform(&self, what: &str, bytes: &[u8]) -> Result<wgpu::Buffer> {
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let buffer = self.buffer(what, bytes.len() as u64, usage)?;
        self.write(&buffer, 0, bytes);
        Ok(buffer)
    }

    /// Sends bytes to a buffer, and counts them.
    pub(crate) fn write(&self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        self.count(|work| work.bytes_uploaded += bytes.len() as u64);
        self.queue.write_buffer(buffer, offset, bytes);
    }

    /// A storage buffer of `count` elements with content, written a piece at a time.
    pub(crate) fn upload<U: bytemuck::Pod + Send>(
        &self,
        what: &str,
        count: usize,
        element: impl Fn(usize) -> U + Sync,
    ) -> Result<wgpu::Buffer> {
        use rayon::prelude::*;
        const PIECE: usize = 1 << 20;
        let buffer = self.storage(what, (count * size_of::<U>()) as u64)?;
        for first in (0..count).step_by(PIECE) {
            let piece = first..count.min(first + PIECE);
            let converted: Vec<U> = piece.into_par_iter().with_min_len(1 << 14).map(&element).collect();
            let offset = (first * size_of::<U>()) as u64;
            self.guarded(what, || self.write(&buffer, offset, bytemuck::cast_slice(&converted)))?;
            // What was staged is sent, so that no second copy of a large grid waits in memory.
            self.queue.submit([]);
        }
        Ok(buffer)
    }

    /// The content of buffers that can be mapped, once all that was submitted is done.
    pub(crate) fn read<T>(
        &self,
        what: &'static str,
        buffer: &wgpu::Buffer,
        bytes: u64,
        take: impl FnOnce(&[u8]) -> T,
    ) -> Result<T> {
        self.send(what, buffer, bytes, None).take(self, take)
    }

    /// Asks for the content of a buffer that can be mapped, as it is when what was submitted before is done. Does not wait.
    /// `after`: the submission that writes it, so that none behind it is waited for.
    pub(crate) fn send(
        &self,
        what: &'static str,
        buffer: &wgpu::Buffer,
        bytes: u64,
        after: Option<SubmissionIndex>,
    ) -> PendingReadback {
        let (sender, outcome) = mpsc::channel();
        buffer.slice(..bytes).map_async(wgpu::MapMode::Read, move |outcome| {
            // Nobody waits for it where the frame is given up.
            let _ = sender.send(outcome);
        });
        PendingReadback { what, buffer: buffer.clone(), bytes, after, outcome }
    }
}

/// The content of a buffer on its way back.
pub(crate) struct PendingReadback {
    what: &'static str,
    buffer: wgpu::Buffer,
    bytes: u64,
    after: Option<SubmissionIndex>,
    outcome: mpsc::Receiver<std::result::Result<(), wgpu::BufferAsyncError>>,
}

impl PendingReadback {
    /// Takes the content, once it is there. Errors: a lost device.
    pub fn take<T>(self, device: &Device, take: impl FnOnce(&[u8]) -> T) -> Result<T> {
        let PendingReadback { what, buffer, bytes, after, outcome } = self;
        let failed = |why: &dyn std::fmt::Display| {
            Error::run(format!("{} does not give back {what}", device.name)).got(why)
        };
        // What has come needs no waiting for.
        let _ = device.device.poll(wgpu::PollType::Poll);
        let come = match outcome.try_recv() {
            Ok(come) => Ok(come),
            Err(_) => {
                device.wait(what, after)?;
                // Another thread that waits may be about to say so.
                outcome.recv()
            }
        };
        device.check(what)?;
        come.map_err(|why| failed(&why))?.map_err(|why| failed(&why))?;
        let taken = {
            let view = buffer.slice(..bytes).get_mapped_range().map_err(|why| failed(&why))?;
            take(&view)
        };
        buffer.unmap();
        Ok(taken)
    }
}

/// A buffer that grows with what is asked of it.
#[derive(Default)]
pub(crate) struct GrowingBuffer(Option<wgpu::Buffer>);

impl GrowingBuffer {
    /// The buffer, made anew if it is too small.
    pub fn at_least(
        &mut self,
        size: u64,
        make: impl FnOnce(u64) -> Result<wgpu::Buffer>,
    ) -> Result<wgpu::Buffer> {
        if let Some(buffer) = self.0.as_ref().filter(|buffer| size <= buffer.size()) {
            return Ok(buffer.clone());
        }
        // The old one goes first: there may not be room for both.
        self.0 = None;
        Ok(self.0.insert(make(size)?).clone())
    }
}

/// Passes of a frame that are timed; further ones are not.
const PASSES: u32 = 64;

/// By default of no pass.
#[derive(Default)]
pub(crate) struct Timing {
    clock: Option<Clock>,
    /// The passes of the submission in hand.
    begun: Vec<PassName>,
    /// The passes with their times, each once.
    pub sums: Vec<StageTiming>,
}

/// A pass by its entry point, and the stage that it is part of.
pub(crate) type PassName = (&'static str, Stage);

struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    returned: wgpu::Buffer,
    tick_secs: f64,
}

impl Timing {
    pub fn new(device: &Device) -> Result<Timing> {
        let bytes = u64::from(2 * PASSES) * 8;
        let buffer = |usage| device.buffer("the times", bytes, usage);
        let clock = match device.tick {
            None => None,
            Some(tick) => Some(Clock {
                queries: device.guarded("the clock", || {
                    device.device.create_query_set(&wgpu::QuerySetDescriptor {
                        label: Some("passes"),
                        ty: wgpu::QueryType::Timestamp,
                        count: 2 * PASSES,
                    })
                })?,
                resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC)?,
                returned: buffer(BufferUsages::MAP_READ | BufferUsages::COPY_DST)?,
                tick_secs: f64::from(tick) * 1e-9,
            }),
        };
        Ok(Timing { clock, ..Timing::default() })
    }

    pub fn next(&mut self, pass: PassName) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let query_set = &self.clock.as_ref()?.queries;
        let at = 2 * self.begun.len() as u32;
        if at == 2 * PASSES {
            return None;
        }
        self.begun.push(pass);
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(at),
            end_of_pass_write_index: Some(at + 1),
        })
    }

    /// Behind the passes of a submission.
    pub fn end(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(clock) = &self.clock {
            let count = 2 * self.begun.len() as u32;
            encoder.resolve_query_set(&clock.queries, 0..count, &clock.resolved, 0);
            encoder.copy_buffer_to_buffer(&clock.resolved, 0, &clock.returned, 0, clock.returned.size());
        }
    }

    /// Adds the times of a submission.
    pub fn take(&mut self, device: &Device) -> Result<()> {
        let Some(clock) = &self.clock else { return Ok(()) };
        let bytes = 16 * self.begun.len() as u64;
        let ticks: Vec<u64> =
            device.read("the times", &clock.returned, bytes, bytemuck::pod_collect_to_vec)?;
        for ((name, stage), pair) in self.begun.drain(..).zip(ticks.chunks_exact(2)) {
            let seconds = pair[1].saturating_sub(pair[0]) as f64 * clock.tick_secs;
            match self.sums.iter_mut().find(|known| known.pass == Some(name)) {
                Some(sum) => sum.seconds += seconds,
                None => self.sums.push(StageTiming { stage, pass: Some(name), seconds }),
            }
        }
        Ok(())
    }
}
