//! Seconds of the passes, where the adapter has timestamps.

use crate::device::Device;
use voltet_core::Result;
use voltet_optics::engine::{Stage, StageTiming};
use wgpu::BufferUsages;

/// Passes of a frame that are timed; further ones are not.
const PASSES: u32 = 64;

pub(crate) struct Timing {
    clock: Option<Clock>,
    /// The passes of the submission in hand.
    begun: Vec<PassName>,
    sums: Vec<StageTiming>,
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
        Ok(Timing { clock, begun: Vec::new(), sums: Vec::new() })
    }

    /// None of any pass.
    pub fn none() -> Timing {
        Timing { clock: None, begun: Vec::new(), sums: Vec::new() }
    }

    /// Before the passes of a submission.
    pub fn begin(&mut self) {
        self.begun.clear();
    }

    /// Timestamp writes of the next compute pass.
    pub fn next(&mut self, pass: PassName) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, at) = self.place(pass)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(at),
            end_of_pass_write_index: Some(at + 1),
        })
    }

    /// Timestamp writes of the next render pass.
    pub fn next_drawing(&mut self, pass: PassName) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, at) = self.place(pass)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(at),
            end_of_pass_write_index: Some(at + 1),
        })
    }

    /// Index at which the next pass writes its begin, and behind it its end.
    fn place(&mut self, pass: PassName) -> Option<(&wgpu::QuerySet, u32)> {
        let clock = self.clock.as_ref()?;
        let at = self.begun.len() as u32;
        if at == PASSES {
            return None;
        }
        self.begun.push(pass);
        Some((&clock.queries, 2 * at))
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
        for (&(name, stage), pair) in self.begun.iter().zip(ticks.chunks_exact(2)) {
            let seconds = pair[1].saturating_sub(pair[0]) as f64 * clock.tick_secs;
            match self.sums.iter_mut().find(|known| known.pass == Some(name)) {
                Some(sum) => sum.seconds += seconds,
                None => self.sums.push(StageTiming { stage, pass: Some(name), seconds }),
            }
        }
        Ok(())
    }

    /// The passes with their times, each once.
    pub fn passes(self) -> Vec<StageTiming> {
        self.sums
    }
}
