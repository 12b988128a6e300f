//! Which engine draws: parameters, choice, and what is said about it.

use voltet_core::Result;
#[cfg(feature = "gpu")]
use voltet_core::error::ErrorKind;
use voltet_core::graph::{Asking, Call, Parameter, ParameterType, Parameters, Standard};
use voltet_core::picture::Picture;
use voltet_core::shading::Order;

use super::stages;
use super::{Scene, order::leave_out_order};

/// The engine that a pipeline asks for.
pub const ENGINE: Parameter = Parameter {
    name: "engine",
    parameter_type: ParameterType::Choice(&[
        ("auto", "the GPU where this machine has one that holds the scene, the CPU otherwise"),
        ("cpu", "native code on all cores"),
        ("gpu", "the graphics device, or an error"),
    ]),
    unit: "",
    standard: Standard::Text("auto"),
    help: "what draws",
};

/// The adapter that a pipeline asks for.
pub const ADAPTER: Parameter = Parameter {
    name: "adapter",
    parameter_type: ParameterType::Text,
    unit: "",
    standard: Standard::Unset("the fastest kind"),
    help: "gpu: a part of its name, or discrete, integrated, virtual, software",
};

/// The compositor of the device.
pub const COMPOSITOR: Parameter = Parameter {
    name: "compositor",
    parameter_type: ParameterType::Choice(&[
        (
            "auto",
            "tiles where each pixel needs its exact order, else what a short measurement finds faster there",
        ),
        (
            "tiles",
            "compute passes over tiles of 8 × 8 pixels: every order, and pixels in disorder are counted",
        ),
        (
            "raster",
            "cells sorted by centroid, drawn and blended by the hardware: for scenes that need no order, or \
             order = \"centroid\" or \"none\"; what it gets wrong is not counted",
        ),
    ]),
    unit: "",
    standard: Standard::Text("auto"),
    help: "gpu: how pixels are composited; the CPU always works in tiles",
};

/// The compositors of the device by name, what `auto` takes first.
pub fn compositors() -> impl Iterator<Item = &'static str> {
    let choices = match COMPOSITOR.parameter_type {
        ParameterType::Choice(choices) => choices,
        _ => &[],
    };
    choices.iter().map(|(name, _)| *name).filter(|name| *name != "auto")
}

/// Whether the compositor of that name carries out the order where the scene needs one: blending hardware knows no pixel's
/// own order.
pub fn has_order(compositor: &str, order: Order) -> bool {
    compositor != "raster" || !matches!(order, Order::Exact | Order::Auto)
}

/// Why a build without the device engine takes the CPU.
#[cfg(not(feature = "gpu"))]
const NO_ENGINE: &str = "this build has no GPU engine";

/// Refuses the device where the build has none.
fn check_engine(p: &Parameters, wanted: &str) -> Result<()> {
    #[cfg(not(feature = "gpu"))]
    if wanted == "gpu" {
        let item = if p.given("engine") { "engine" } else { "adapter" };
        let error = p.error(item, NO_ENGINE);
        return Err(error.found("gpu").accepted("\"cpu\", or \"auto\", which takes the CPU"));
    }
    let _ = (p, wanted);
    Ok(())
}

/// Notes the engine, as far as it is known before the run, and asks for what the scene needs.
pub fn ask_engine(asking: &mut Asking, wanted: &str) -> Result<()> {
    check_engine(asking.parameters, wanted)?;
    let (name, why) = planned(asking, wanted)?;
    asking.notes.engine = Some((name.into(), why));
    let needed = super::ask(asking, "volume", "transfer_function")?;
    #[cfg(feature = "gpu")]
    if wanted != "cpu" {
        super::compositor::refuse_exact_raster(asking, needed.order)?;
    }
    if !needed.order && !asking.thorough {
        leave_out_order(asking.notes, None);
    }
    Ok(())
}

fn planned(asking: &Asking, wanted: &str) -> Result<(&'static str, String)> {
    let shading = super::shading(asking.parameters)?;
    let reference = shading.integrator == voltet_core::shading::Integrator::Reference;
    Ok(match wanted {
        "cpu" | "auto" if reference => ("reference", "the integrator is the 64-bit reference".into()),
        "cpu" => ("cpu", "the pipeline asks for it".into()),
        "gpu" => ("gpu", "the pipeline asks for it".into()),
        #[cfg(not(feature = "gpu"))]
        _ => ("cpu", NO_ENGINE.into()),
        #[cfg(feature = "gpu")]
        _ => {
            let look = asking.look("transfer_function");
            let refused =
                look.and_then(|look| voltet_gpu::can_serve(&look.transfer_function, &shading).err());
            match refused {
                Some(error) => ("cpu", error.to_string()),
                None => (
                    "auto",
                    "the run takes the GPU if a hardware adapter holds the scene, else the CPU".into(),
                ),
            }
        }
    })
}

/// Draws on the engine that is wanted.
pub fn draw(call: &mut Call, scene: &Scene, wanted: &str) -> Result<Picture> {
    #[cfg(feature = "gpu")]
    {
        let reference = scene.shading.integrator == voltet_core::shading::Integrator::Reference;
        if wanted != "cpu" {
            super::compositor::refuse_exact(call.parameters, scene)?;
        }
        if wanted == "gpu" {
            return super::device::draw(call, scene, false);
        }
        if wanted == "auto" && !reference {
            let why = if call.thorough {
                "what is compared with everything done is the native engine's work".to_string()
            } else {
                match super::device::draw(call, scene, true) {
                    Err(error) if error.kind != ErrorKind::Cancelled => error.to_string(),
                    done => return done,
                }
            };
            call.notes.engine = Some(("cpu".into(), why));
        }
    }
    let _ = wanted;
    stages::all(call, scene)
}
