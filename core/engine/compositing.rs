//! The ways in which a device composites, and the choice among them.

use crate::scene::Scene;
use crate::shading::Order;
use crate::{Error, Result};

/// What takes a device's cells to the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Compositing {
    /// Compute passes over tiles of pixels.
    Tiles,
    /// The cells' silhouettes, drawn farthest first and blended by the hardware: no exact order at every pixel.
    Raster,
}

impl Compositing {
    /// Each of them with its meaning, what serves every order first.
    pub const WORDS: [(&str, &str); 2] = [
        (
            "tiles",
            "compute passes over tiles of 8 × 8 pixels: every order, and pixels in disorder are counted",
        ),
        (
            "raster",
            "cells sorted by centroid, drawn and blended by the hardware: for scenes that need no order, or \
             order = \"centroid\" or \"none\"; what it gets wrong is not counted",
        ),
    ];

    /// Those of [`Compositing::WORDS`], in their order.
    pub const ALL: [Compositing; 2] = [Compositing::Tiles, Compositing::Raster];

    /// The name in pipeline files.
    pub fn name(self) -> &'static str {
        Compositing::WORDS[self as usize].0
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Compositing> {
        Compositing::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Whether it carries out an order where the scene needs one: blending hardware knows no pixel's own.
    pub fn has(self, order: Order) -> bool {
        self == Compositing::Tiles || !matches!(order, Order::Exact | Order::Auto)
    }

    /// Refuses an order that the scene needs and this way does not have.
    pub fn check(self, scene: &Scene) -> Result<()> {
        self.check_order(scene.order, scene.needs_order())
    }

    /// The same before the scene is known; `needed`: whether it will need an order.
    pub fn check_order(self, order: Order, needed: bool) -> Result<()> {
        if needed && !self.has(order) {
            return Err(Error::usage(
                "compositor = \"raster\" has no exact order at every pixel, and this scene needs one",
            )
            .found("order = \"exact\", or \"auto\", which is exact here")
            .accepted("order = \"centroid\", an approximation; or compositor = \"tiles\""));
        }
        Ok(())
    }
}

/// A way of compositing that an engine chose.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The way.
    pub compositing: Compositing,
    /// Why.
    pub why: String,
    /// Seconds that measuring took, where it was measured for this choice.
    pub measured_secs: Option<f64>,
}

/// Short texts that outlast the program, each under the text of its key.
pub trait Memory: Sync {
    /// What was kept under the key; `None` where there is nothing or it is damaged.
    fn recall(&self, key: &str) -> Option<String>;

    /// Keeps a text, if it can be kept.
    fn keep(&self, key: &str, text: &str);
}
