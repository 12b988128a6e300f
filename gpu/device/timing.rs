//! Seconds of the passes, where the adapter has timestamps.

use crate::device::open::Device;
use voltet_core::Result;
use wgpu::BufferUsages;

/// Passes of a frame that are timed; further ones are not.
const PASSES: u32 = 64;

pub(crate) struct Timing {
    timed: Option<Timed>,
    names: Vec<&'static str>,
    sums: Vec<(&'static str, f64)>,
}

struct Timed {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    returned: wgpu::Buffer,
    tick_secs: f64,
}

impl Timing {
    pub fn new(device: &Device) -> Result<Timing> {
        let bytes = u64::from(2 * PASSES) * 8;
        let timed = match device.tick {
            None => None,
            Some(tick) => Some(Timed {
                queries: device.guarded("the clock", || {
                    device.device.create_query_set(&wgpu::QuerySetDescriptor {
                        label: Some("passes"),
                        ty: wgpu::QueryType::Timestamp,
                        count: 2 * PASSES,
                    })
                })?,
                resolved: device.buffer(
                    "the times",
                    bytes,
                    BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                )?,
                returned: device.buffer(
                    "the times",
                    bytes,
                    BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                )?,
                tick_secs: f64::from(tick) * 1e-9,
            }),
        };
        Ok(Timing { timed, names: Vec::new(), sums: Vec::new() })
    }

    /// Before the passes of a submission.
    pub fn begin(&mut self) {
        self.names.clear();
    }

    /// What times the next pass.
    pub fn next(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, at) = self.place(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(at),
            end_of_pass_write_index: Some(at + 1),
        })
    }

    /// The same for a pass that draws.
    pub fn next_drawing(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, at) = self.place(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(at),
            end_of_pass_write_index: Some(at + 1),
        })
    }

    /// Where the next pass writes its begin, and behind it its end.
    fn place(&mut self, name: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let timed = self.timed.as_ref()?;
        let at = self.names.len() as u32;
        if at == PASSES {
            return None;
        }
        self.names.push(name);
        Some((&timed.queries, 2 * at))
    }

    /// Behind the passes of a submission.
    pub fn end(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(timed) = &self.timed {
            let count = 2 * self.names.len() as u32;
            encoder.resolve_query_set(&timed.queries, 0..count, &timed.resolved, 0);
            encoder.copy_buffer_to_buffer(&timed.resolved, 0, &timed.returned, 0, timed.returned.size());
        }
    }

    /// Adds the times of a submission.
    pub fn take(&mut self, device: &Device) -> Result<()> {
        let Some(timed) = &self.timed else { return Ok(()) };
        let bytes = 16 * self.names.len() as u64;
        let ticks: Vec<u64> =
            device.read("the times", &timed.returned, bytes, bytemuck::pod_collect_to_vec)?;
        for (name, pair) in self.names.iter().zip(ticks.chunks_exact(2)) {
            let seconds = pair[1].saturating_sub(pair[0]) as f64 * timed.tick_secs;
            match self.sums.iter_mut().find(|(known, _)| known == name) {
                Some((_, sum)) => *sum += seconds,
                None => self.sums.push((name, seconds)),
            }
        }
        Ok(())
    }

    /// Seconds by the name of the pass.
    pub fn seconds(self) -> Vec<(&'static str, f64)> {
        self.sums
    }
}
