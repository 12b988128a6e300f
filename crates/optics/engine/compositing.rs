//! Compositors of a device, and the choice among them.

use voltet_core::{Error, Result};

/// Way from a device's cells to the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Compositor {
    /// Compute passes over tiles of pixels.
    Tiles,
    /// The cells' silhouettes, drawn farthest first and blended by the hardware: in exact order where the cells have one along
    /// their faces ([`voltet_core::visibility::Faces`]); else tiles are taken.
    Raster,
    /// Each cell as three or four triangles round its thick vertex (Shirley and Tuchman 1990), drawn and blended likewise:
    /// what the hardware interpolates between corners is a little off.
    Triangles,
}

impl Compositor {
    /// Each of them with its meaning, what serves every order first.
    pub const NAMES: &[(&str, &str)] = &[
        (
            "tiles",
            "compute passes over tiles of 8 × 8 pixels: every order, and pixels in disorder are counted",
        ),
        (
            "raster",
            "cells in order, drawn and blended by the hardware: for scenes that need no order, in exact order where the cells \
             have one along their faces, else by tiles; what order = \"centroid\" or \"none\" gets wrong is not counted",
        ),
        #[cfg(feature = "triangles")]
        (
            "triangles",
            "cells as triangles round their thick vertex (Shirley and Tuchman 1990), in perspective, else as raster: \
             to see what the classic method costs and how far it is off; auto never takes it",
        ),
    ];

    /// Compositors of [`Compositor::NAMES`], in their order.
    pub const ALL: &[Compositor] = &[
        Compositor::Tiles,
        Compositor::Raster,
        #[cfg(feature = "triangles")]
        Compositor::Triangles,
    ];

    /// The name in pipeline files.
    pub fn name(self) -> &'static str {
        match self {
            Compositor::Tiles => "tiles",
            Compositor::Raster => "raster",
            Compositor::Triangles => "triangles",
        }
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Compositor> {
        Compositor::ALL.iter().copied().find(|one| one.name() == name)
    }
}

/// Check of the exact order of cells that are blended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum OrderCheck {
    /// Not at all.
    #[default]
    None,
    /// Some pixels are held against those of tiles.
    Sample,
    /// That, and at every pixel it is counted whether cells come out of their order.
    Count,
}

impl OrderCheck {
    /// Each of them with its meaning, the usual one first.
    pub const NAMES: [(&str, &str); 3] = [
        ("sample", "256 pixels are held against those of tiles"),
        ("count", "that, and every pixel at which cells are out of order is counted, in 64 bits on the CPU"),
        ("none", "not at all"),
    ];

    /// The one of that name.
    pub fn named(name: &str) -> Option<OrderCheck> {
        let all = [OrderCheck::Sample, OrderCheck::Count, OrderCheck::None];
        OrderCheck::NAMES.iter().zip(all).find(|(word, _)| word.0 == name).map(|(_, check)| check)
    }
}

/// Number format that blending hardware accumulates in. Tiles always have 32-bit floats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Accumulation {
    /// Floats.
    #[default]
    Float,
    /// 8 bits a channel, 0 to 1, as a display has them.
    Bits8,
    /// 12 bits a channel.
    Bits12,
    /// 16 bits a channel.
    Bits16,
}

impl Accumulation {
    /// Each of them with its meaning.
    pub const NAMES: [(&str, &str); 4] = [
        ("float", "32-bit floats, or 16-bit ones with a warning where the device blends no others"),
        ("8-bit", "rounded to 8 bits a channel after each cell, by a texture of these"),
        ("12-bit", "rounded to multiples of 1/4096 after each cell"),
        ("16-bit", "rounded to multiples of 1/65536 after each cell"),
    ];

    /// Formats of [`Accumulation::NAMES`], in their order.
    pub const ALL: [Accumulation; 4] =
        [Accumulation::Float, Accumulation::Bits8, Accumulation::Bits12, Accumulation::Bits16];

    /// The name in pipeline files.
    pub fn name(self) -> &'static str {
        Accumulation::NAMES[self as usize].0
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Accumulation> {
        Accumulation::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Refuses rounding where nothing is blended by the hardware.
    pub fn check(self, compositing: Compositor) -> Result<()> {
        if self != Accumulation::Float && compositing == Compositor::Tiles {
            return Err(Error::usage("compositor = \"tiles\" accumulates in 32-bit floats alone")
                .got(format!("accumulation = \"{}\"", self.name()))
                .expected("accumulation = \"float\"; or compositor = \"raster\" or \"triangles\""));
        }
        Ok(())
    }
}

/// A way of compositing that an engine chose.
#[derive(Debug, Clone, PartialEq)]
pub struct CompositorChoice {
    /// The way.
    pub compositing: Compositor,
    /// Why.
    pub why: String,
    /// Seconds that measuring took, where it was measured for this choice.
    pub measured_secs: Option<f64>,
}

/// Short texts that outlast the program, each under the text of its key.
pub trait KeyValueStore: Sync {
    /// Value stored under the key; `None` where there is nothing or it is damaged.
    fn recall(&self, key: &str) -> Option<String>;

    /// Keeps a text, if it can be kept.
    fn keep(&self, key: &str, text: &str);
}

/// Keeps nothing.
pub struct NoStore;

impl KeyValueStore for NoStore {
    fn recall(&self, _key: &str) -> Option<String> {
        None
    }

    fn keep(&self, _key: &str, _text: &str) {}
}
