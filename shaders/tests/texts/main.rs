//! Every text that the crate makes, parsed and validated without a device; layouts of what it reads.

mod combinations;
mod module;
mod tiles;
