//! Peak rate of a device, to compare times with.

use crate::device::bindings::{Bound, in_order};
use crate::device::device_handle::Device;
use crate::device::pipelines::Program;
use std::time::{Duration, Instant};
use voltet_core::Result;
use voltet_shaders::multiply_adds;

/// A measurement's shortest time: a thousand times what submitting and waiting take.
const LONG_ENOUGH: Duration = Duration::from_millis(50);

/// Number of tries of each measurement, of which the best counts: other work on the device only slows it down.
const TRIES: usize = 3;

impl Device {
    /// 32-bit multiply-adds a second, measured: chains in registers that wait for nothing but themselves.
    ///
    /// Errors: a lost device.
    pub fn multiply_adds_per_second(&self) -> Result<f64> {
        let (shader, of_workgroup) = multiply_adds();
        let pipeline = self.pipeline(&Program {
            shader: &shader,
            entry_point: "multiply_adds",
            constants: vec![],
            groups: [&[(0, Bound::Write)], &[], &[]],
        })?;
        let sums = self.storage("the sums", (2 + 64) * 16)?;
        // Sums stay near 1: no number that a device might treat apart.
        let start = [[0.5f32; 4], [0.5; 4]];
        self.guarded("the sums", || self.queue.write_buffer(&sums, 0, bytemuck::bytes_of(&start)))?;
        let group = self.bind(&pipeline, 0, &in_order(&[&sums]));
        let run = |workgroups: u32| -> Result<Duration> {
            let begin = Instant::now();
            self.guarded("the multiply-adds", || {
                let mut encoder = self.device.create_command_encoder(&Default::default());
                let mut compute = encoder.begin_compute_pass(&Default::default());
                compute.set_pipeline(&pipeline);
                compute.set_bind_group(0, &group, &[]);
                compute.dispatch_workgroups(workgroups, 1, 1);
                drop(compute);
                self.queue.submit([encoder.finish()]);
            })?;
            self.wait("the multiply-adds", None)?;
            Ok(begin.elapsed())
        };
        run(1)?;
        let most = self.limits.max_compute_workgroups_per_dimension;
        let mut workgroups = 64.min(most);
        while run(workgroups)? < LONG_ENOUGH && workgroups < most {
            workgroups = workgroups.saturating_mul(2).min(most);
        }
        let mut best = f64::INFINITY;
        for _ in 0..TRIES {
            best = best.min(run(workgroups)?.as_secs_f64());
        }
        Ok(workgroups as f64 * of_workgroup as f64 / best)
    }
}
