//! In place of `device` in builds without the device engine.

use super::measure::{Cost, Frames};
use super::{Scene, Setting};
use crate::devices;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;

/// There is none.
pub enum Bench {}

impl Bench {
    /// An error.
    pub fn open(adapter: Option<&str>) -> Result<Bench> {
        match devices::open(adapter)? {}
    }

    /// Its name.
    pub fn name(&self) -> &str {
        match *self {}
    }

    /// Whether it is a program on the CPU.
    pub fn is_software(&self) -> bool {
        match *self {}
    }

    /// 32-bit multiply-adds a second, measured. Errors: a lost device.
    pub fn multiply_adds_per_second(&self) -> Result<f64> {
        match *self {}
    }

    /// Never called.
    pub fn measure(
        &mut self,
        _scene: &Scene,
        _setting: &Setting,
        _frames: &Frames,
        _progress: &dyn Progress,
    ) -> Result<(Picture, Cost)> {
        match *self {}
    }
}
