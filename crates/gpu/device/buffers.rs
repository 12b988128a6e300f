//! Buffers: made within the device's limits, kept while they are large enough, read back.

use crate::device::device_handle::Device;
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use voltet_core::{Error, Result};
use wgpu::{BufferUsages, SubmissionIndex};

/// Bytes in a mebibyte.
const MEBIBYTE: f64 = (1u64 << 20) as f64;

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

    /// A uniform buffer.
    pub(crate) fn uniform(&self, what: &str, size: u64) -> Result<wgpu::Buffer> {
        self.buffer(what, size, BufferUsages::UNIFORM | BufferUsages::COPY_DST)
    }

    /// Sends bytes to a buffer, and counts them.
    pub(crate) fn write(&self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        self.work.bytes_uploaded.fetch_add(bytes.len() as u64, Ordering::Relaxed);
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
pub(crate) struct GrowingBuffer {
    buffer: Option<wgpu::Buffer>,
}

impl GrowingBuffer {
    /// The buffer, made anew if it is too small.
    pub fn at_least(
        &mut self,
        size: u64,
        make: impl FnOnce(u64) -> Result<wgpu::Buffer>,
    ) -> Result<wgpu::Buffer> {
        match &self.buffer {
            Some(buffer) if size <= buffer.size() => Ok(buffer.clone()),
            _ => {
                // The old one goes first: there may not be room for both.
                self.buffer = None;
                let made = make(size)?;
                self.buffer = Some(made.clone());
                Ok(made)
            }
        }
    }
}
