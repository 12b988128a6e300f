//! Compiled passes with what is bound to them: the view and what is a pass's own in group 1, the grid's arrays in group
//! 2.

use crate::device::Device;
use crate::device::pipelines::{Bound, Program, in_order, own_kinds};
use crate::device::timing::{PassName, Timing};
use crate::grid::{DeviceArray, DeviceGrid, SplitBuffer};
use std::sync::Arc;
use voltet_core::Result;
use voltet_optics::engine::Stage;
use voltet_shaders::{Access, FramePass, GRID_GROUP, GridArray, Layout};
use wgpu::{Buffer, CommandEncoder, ComputePipeline};

/// A compiled pass and what is bound to it.
pub(crate) struct BoundPass {
    pub name: PassName,
    pub pipeline: Arc<ComputePipeline>,
    pub groups: Vec<(u32, wgpu::BindGroup)>,
    pub workgroups: [u32; 2],
}

/// The stage that a pass is part of.
fn stage(pass: FramePass) -> Stage {
    match pass {
        FramePass::Points | FramePass::Attribute => Stage::Project,
        FramePass::Cells => Stage::Cull,
        FramePass::Starts | FramePass::Lists | FramePass::Sort => Stage::Sort,
        FramePass::CountDigits | FramePass::PlaceDigits | FramePass::MoveDigits | FramePass::Runs => {
            Stage::Sort
        }
        FramePass::Split => Stage::Project,
    }
}

/// The grid's arrays, and those that the first passes make of them.
pub(crate) struct GridArrays<'a> {
    pub grid: &'a DeviceGrid,
    pub seen: SplitBuffer,
    pub attributes: SplitBuffer,
    pub bounds: SplitBuffer,
}

impl GridArrays<'_> {
    /// Buffers bound to the group of the grid, in order. `quantity`: the array that [`GridArray::Quantity`] stands for.
    pub fn buffers<'b>(
        &'b self,
        arrays: &[(GridArray, Access)],
        quantity: &'b DeviceArray,
    ) -> Vec<(Bound, &'b Buffer)> {
        let parts = |(array, access): &(GridArray, Access)| {
            let parted = match array {
                GridArray::Positions => &self.grid.positions,
                GridArray::Quantity => &quantity.values,
                GridArray::Seen => &self.seen,
                GridArray::Attributes => &self.attributes,
                GridArray::Tetrahedra => &self.grid.tetrahedra,
                GridArray::Bounds => &self.bounds,
            };
            let kind = if *access == Access::Read { Bound::Read } else { Bound::Write };
            parted.iter().map(move |buffer| (kind, buffer))
        };
        arrays.iter().flat_map(parts).collect()
    }
}

/// The kinds of group 0: the scene, and behind it what is only read.
pub(crate) fn scene_kinds(scene: &[(u32, &Buffer)]) -> Vec<(u32, Bound)> {
    let kind = |binding| if binding == 0 { Bound::Uniform } else { Bound::Read };
    scene.iter().map(|(binding, _)| (*binding, kind(*binding))).collect()
}

/// Bound buffers, by binding.
pub(crate) fn kinds(bound: &[(Bound, &Buffer)]) -> Vec<(u32, Bound)> {
    in_order(&bound.iter().map(|b| b.0).collect::<Vec<_>>())
}

/// The buffers, by binding.
pub(crate) fn buffers<'b>(bound: &[(Bound, &'b Buffer)]) -> Vec<(u32, &'b Buffer)> {
    in_order(&bound.iter().map(|b| b.1).collect::<Vec<_>>())
}

/// Compiles passes over one grid and binds them.
pub(crate) struct Binder<'a> {
    pub device: &'a Device,
    pub view: &'a Buffer,
    pub arrays: &'a GridArrays<'a>,
    pub layout: &'a Layout,
}

impl Binder<'_> {
    /// A pass that is the same for every scene. `bindings`: those behind the view; `quantity`: see [`GridArrays::buffers`].
    pub fn step(
        &self,
        pass: FramePass,
        workgroups: [u32; 2],
        constants: Vec<(&'static str, f64)>,
        bindings: &[&Buffer],
        quantity: &DeviceArray,
    ) -> Result<BoundPass> {
        let in_grid = self.arrays.buffers(pass.grid_arrays(), quantity);
        let program = Program {
            shader: &pass.shader(self.layout),
            entry_point: pass.entry_point(),
            constants,
            groups: [&[], &own_kinds(Some(pass)), &kinds(&in_grid)],
        };
        let pipeline = self.device.pipeline(&program)?;
        let groups = self.groups(&pipeline, bindings, &in_grid);
        Ok(BoundPass { name: (pass.entry_point(), stage(pass)), pipeline, groups, workgroups })
    }

    /// Groups 1 and 2 of a pipeline.
    pub fn groups(
        &self,
        pipeline: &ComputePipeline,
        bindings: &[&Buffer],
        in_grid: &[(Bound, &Buffer)],
    ) -> Vec<(u32, wgpu::BindGroup)> {
        let own = in_order(&[&[self.view], bindings].concat());
        let mut groups = vec![(1, self.device.bind(pipeline, 1, &own))];
        if !in_grid.is_empty() {
            groups.push((GRID_GROUP, self.device.bind(pipeline, GRID_GROUP, &buffers(in_grid))));
        }
        groups
    }
}

/// Runs a pass.
pub(crate) fn run(encoder: &mut CommandEncoder, step: &BoundPass, timing: &mut Timing) {
    let descriptor =
        wgpu::ComputePassDescriptor { label: Some(step.name.0), timestamp_writes: timing.next(step.name) };
    let mut compute = encoder.begin_compute_pass(&descriptor);
    compute.set_pipeline(&step.pipeline);
    for (number, group) in &step.groups {
        compute.set_bind_group(*number, group, &[]);
    }
    compute.dispatch_workgroups(step.workgroups[0], step.workgroups[1], 1);
}

/// Workgroups for so many invocations, folded into rows where one row does not hold them.
pub(crate) fn folded(count: u32, most: u32) -> [u32; 2] {
    in_rows(count.div_ceil(64), most)
}

/// This number of workgroups, or a few more, folded likewise.
pub(crate) fn in_rows(groups: u32, most: u32) -> [u32; 2] {
    let groups = groups.max(1);
    let rows = groups.div_ceil(most);
    [groups.div_ceil(rows), rows]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folded_rows_hold_every_invocation() {
        for (count, most) in [(0, 65535), (1, 65535), (64, 65535), (16_000_000, 65535), (u32::MAX, 65535)] {
            let [columns, rows] = folded(count, most);
            assert!(columns <= most && rows <= most);
            assert!(u64::from(columns) * u64::from(rows) * 64 >= u64::from(count), "{count}");
        }
    }
}
