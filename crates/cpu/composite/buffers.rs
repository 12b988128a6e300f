//! Buffer pool: recycles tile bins and fragment lists between frames, so that pages are not faulted in anew.

use crate::cache::FreeList;
use crate::composite::fragment_lists::FragmentLists;
use crate::project::tile_bins::TileBins;

/// Buffers that frames use again.
#[derive(Debug, Default)]
pub(crate) struct BufferPool {
    pub bins: FreeList<TileBins>,
    pub lists: FreeList<FragmentLists>,
}
