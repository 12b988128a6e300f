//! Bindings of the passes.

use voltet_optics::engine::Compositor;
use voltet_shaders::FramePass;

/// Kind of a binding, in the order of the bindings of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Bound {
    Uniform,
    Read,
    Write,
    /// A texture that is read texel by texel.
    Texels,
}

/// Things bound at 0, 1, …
pub(crate) fn in_order<T: Copy>(things: &[T]) -> Vec<(u32, T)> {
    things.iter().enumerate().map(|(binding, thing)| (binding as u32, *thing)).collect()
}

/// Bindings of a pass, or without one of the tiles' compositor, in group 1 behind the view.
fn bound(pass: Option<FramePass>) -> &'static [Bound] {
    use Bound::{Read, Uniform, Write};
    match pass {
        Some(FramePass::Points) => &[],
        Some(FramePass::Attribute) => &[Uniform],
        Some(FramePass::Cells) => &[Read, Write],
        Some(FramePass::Starts) => &[Write],
        Some(FramePass::Lists) => &[Write, Write],
        Some(FramePass::Sort) => &[Read, Write],
        Some(FramePass::CountDigits | FramePass::PlaceDigits) => &[Uniform, Read, Write],
        Some(FramePass::MoveDigits) => &[Uniform, Read, Write, Write],
        Some(FramePass::Runs) => &[Write, Read],
        Some(FramePass::Split) => &[Uniform, Read, Read, Write],
        None => &[Write, Read, Write],
    }
}

/// Storage buffers of a pass beside those of the grid.
pub(crate) fn fixed_buffers(pass: FramePass) -> u32 {
    storage_buffers(Some(pass))
}

/// Storage buffers of a compositor of pixels, beside those of the grid and of the scene.
pub(crate) fn compositor_buffers(compositing: Compositor) -> u32 {
    match compositing {
        Compositor::Tiles => storage_buffers(None),
        // The list of cells, or their corners; then the picture alone.
        Compositor::Raster | Compositor::Triangles => 1,
    }
}

fn storage_buffers(pass: Option<FramePass>) -> u32 {
    bound(pass).iter().filter(|bound| **bound != Bound::Uniform).count() as u32
}

/// Bindings of group 1 of a pass, or of the tiles' compositor.
pub(crate) fn own_kinds(pass: Option<FramePass>) -> Vec<(u32, Bound)> {
    in_order(&[&[Bound::Uniform], bound(pass)].concat())
}
