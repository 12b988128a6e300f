//! Scenes that are hard to draw: small grids with hard cells, hard transfer functions and hard cameras.

mod cameras;
mod cells;
mod scene;
mod transfer_functions;

pub(super) use scene::Hard;

/// Every one.
pub(super) fn all() -> Vec<Hard> {
    cells::scenes().into_iter().chain(transfer_functions::scenes()).chain(cameras::scenes()).collect()
}
