//! A grid on a device: its arrays in parts, and the values that transfer functions look at.

pub(crate) mod axes;
pub(crate) mod device_grid;
pub(crate) mod double_single;
pub(crate) mod split_buffer;
