//! Shading of a volume on any engine: integrator, light, order (docs/src/explanation/optics.md, sections 6 and 7).

use crate::WidgetBlend;
use std::fmt;
use std::str::FromStr;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};

pub use crate::integrators::Integrator;

/// Requested order of a pixel's segments. What an engine does for it is an [`Ordering`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VisibilityOrder {
    /// By entry distance at every pixel: exact for disjoint cells. None is made where the scene needs none.
    #[default]
    Exact,
    /// By the distance of the cells' centroids: an approximation.
    Centroid,
    /// As the cells are stored.
    Unsorted,
}

impl VisibilityOrder {
    /// Names in pipeline files, each with its meaning; the first three in the order of the variants. "auto" is another name of
    /// "exact".
    pub const NAMES: [(&str, &str); 4] = [
        ("exact", "by entry distance at every pixel"),
        ("centroid", "by the distance of the cells' centroids: an approximation"),
        ("none", "as the cells come"),
        ("auto", "exact where the scene needs an order, none otherwise"),
    ];

    /// The name in pipeline files.
    pub fn name(self) -> &'static str {
        VisibilityOrder::NAMES[self as usize].0
    }
}

impl fmt::Display for VisibilityOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for VisibilityOrder {
    type Err = Error;

    fn from_str(name: &str) -> Result<VisibilityOrder> {
        match name {
            "exact" | "auto" => Ok(VisibilityOrder::Exact),
            "centroid" => Ok(VisibilityOrder::Centroid),
            "none" => Ok(VisibilityOrder::Unsorted),
            _ => {
                let names = VisibilityOrder::NAMES.map(|(name, _)| name).join(", ");
                Err(Error::usage("there is no such visibility order").got(name).expected(names))
            }
        }
    }
}

/// Order of a pixel's segments as an engine makes it; decided once for a scene ([`crate::scene::Scene::ordering`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ordering {
    /// No order: the picture does not depend on it.
    Independent,
    /// By entry distance, at each pixel.
    PerPixel,
    /// By the distance of the cells' centroids.
    CellCentroid,
    /// As the cells are stored.
    Submission,
}

impl Ordering {
    /// The order that is made for a request. `needed`: true if the picture depends on it, or in exhaustive mode. An approximate
    /// order that is requested by name is made in any case.
    pub fn new(requested: VisibilityOrder, needed: bool) -> Ordering {
        match requested {
            VisibilityOrder::Exact if needed => Ordering::PerPixel,
            VisibilityOrder::Exact => Ordering::Independent,
            VisibilityOrder::Centroid => Ordering::CellCentroid,
            VisibilityOrder::Unsorted => Ordering::Submission,
        }
    }

    /// The request that it was made for.
    pub fn requested(self) -> VisibilityOrder {
        match self {
            Ordering::Independent | Ordering::PerPixel => VisibilityOrder::Exact,
            Ordering::CellCentroid => VisibilityOrder::Centroid,
            Ordering::Submission => VisibilityOrder::Unsorted,
        }
    }
}

impl fmt::Display for Ordering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Ordering::Independent => f.write_str("not needed"),
            ordering => ordering.requested().fmt(f),
        }
    }
}

/// Lighting of a segment: colour × (ambient + diffuse |ĝ·direction|).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Direction in world space; normalised on use.
    pub direction: glam::DVec3,
    /// k_a.
    pub ambient: f64,
    /// k_d.
    pub diffuse: f64,
}

/// Integrator, blending of widgets, silhouettes and light: closed forms without silhouettes and light unless stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shading {
    /// The integrator.
    pub integrator: Integrator,
    /// Several widgets on one stretch.
    pub overlap: WidgetBlend,
    /// Silhouette exponent p (Song et al. 2009, section 6.2).
    pub silhouette: Option<f64>,
    /// Diffuse lighting.
    pub light: Option<Light>,
}

impl Shading {
    /// Refuses what is said of segments as a whole where these are cut into pieces along logarithmic axes.
    pub fn check(&self, transfer_function: &TransferFunction) -> Result<()> {
        if !transfer_function.has_curved_axes() {
            return Ok(());
        }
        let refused = |what: &str, expected: &str| {
            Err(Error::usage(format!(
                "{what} along a logarithmic axis, where a cell's segment has many pieces"
            ))
            .expected(format!("{expected}, or linear axes")))
        };
        if self.silhouette.is_some_and(|exponent| exponent != 0.0) {
            return refused("silhouettes weight whole segments and mean nothing", "no silhouette");
        }
        if self.overlap == WidgetBlend::Mix && transfer_function.widgets.len() > 1 {
            return refused(
                "mixed widgets are averaged over whole segments, which mean nothing",
                "overlap = \"exact\"",
            );
        }
        if self.integrator.kind().scene_preparation().is_some() {
            let what = format!(
                "the integrator '{}' samples points of the grid, which mean nothing",
                self.integrator.name()
            );
            return refused(&what, "integrator = \"analytic\"");
        }
        Ok(())
    }

    /// The one colour of all that is seen, if there is one: then a pixel's colour is that times its opacity, and no order
    /// is needed. `None` under the constant-emitter, where several colours are drawn, and where light falls at an angle.
    pub fn one_color(&self, transfer_function: &TransferFunction) -> Option<[f64; 3]> {
        let light = match self.light {
            None => 1.0,
            Some(light) if light.diffuse == 0.0 => light.ambient,
            Some(_) => return None,
        };
        transfer_function.uniform_color().map(|color| color.map(|c| c * light))
    }
}
