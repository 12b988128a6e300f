//! In place of `device` in builds without the device engine.

use super::measure::{Cost, Frames};
use super::{Scene, Setting};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// There is none.
pub enum Bench {}

impl Bench {
    /// An error.
    pub fn open(_adapter: Option<&str>) -> Result<Bench> {
        Err(Error::run("this build has no device engine").accepted("one with the feature \"gpu\""))
    }

    /// Its name.
    pub fn name(&self) -> &str {
        match *self {}
    }

    /// Whether it is a program on the CPU.
    pub fn is_software(&self) -> bool {
        match *self {}
    }

    /// None.
    pub fn adapters() -> Vec<String> {
        Vec::new()
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
