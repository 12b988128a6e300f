//! What composites on a device: the parameter, and which one `auto` takes.

use super::Scene;
use super::needs::needs_order;
use super::remembered::{Key, remembered};
use crate::files::cache_folder;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::graph::{Asking, Call, Parameters};
use voltet_core::shading::Order;
use voltet_gpu::{Compositing, Device, How, Times, measure, no_exact_order};

/// Times by what they hold for, measured or read once a session.
#[derive(Default)]
struct Known(Mutex<HashMap<Key, (Times, bool)>>);

/// Refuses, before any data are read, the raster compositor where each pixel needs its exact order.
pub fn refuse_exact_raster(asking: &Asking, needed: bool) -> Result<()> {
    let p = asking.parameters;
    let known = asking.look("transfer_function").is_some();
    if known && needed && !super::has_order(p.text("compositor")?, super::order(p, needed)?) {
        return Err(blamed(p));
    }
    Ok(())
}

/// The same for a transfer function that was made from the data.
pub fn refuse_exact(p: &Parameters, scene: &Scene) -> Result<()> {
    let needed = needs_order(&scene.transfer_function, &scene.shading);
    if needed && !super::has_order(p.text("compositor")?, scene.order) {
        return Err(blamed(p));
    }
    Ok(())
}

fn blamed(p: &Parameters) -> voltet_core::Error {
    p.blame(if p.given("compositor") { "compositor" } else { "order" }, no_exact_order())
}

/// What the compositor of that name does.
pub fn how(scene: &Scene, compositor: &str) -> How {
    if compositor != "raster" {
        return How::from(scene.order);
    }
    // Where no order is needed, none is made.
    let needed = needs_order(&scene.transfer_function, &scene.shading);
    How { order: if needed { scene.order } else { Order::None }, compositing: Compositing::Raster }
}

/// What composites the scene, its name, and why it is taken.
pub fn choose(call: &mut Call, scene: &Scene, device: &Arc<Device>) -> Result<(How, &'static str, String)> {
    let tiles = |why: &str| (How::from(scene.order), "tiles", why.to_string());
    let needed = needs_order(&scene.transfer_function, &scene.shading);
    let raster = how(scene, "raster");
    match call.parameters.text("compositor")? {
        "tiles" => return Ok(tiles("the pipeline asks for it")),
        "raster" => return Ok((raster, "raster", "the pipeline asks for it".into())),
        _ => {}
    }
    if needed && !super::has_order("raster", scene.order) {
        return Ok(tiles("each pixel needs its exact order"));
    }
    if !device.blends_32_bits() {
        return Ok(tiles("the device blends no 32-bit floats"));
    }
    if let Err(error) = device.check_raster(scene.volume.grid.tetrahedra.len() as u64) {
        return Ok(tiles(&error.to_string()));
    }
    let key = Key { adapter: device.name.clone(), driver: device.driver.clone(), needs_order: needed };
    let measured = call.keep_for_session(|| Ok(Known::default()))?;
    let mut known = measured.0.lock().unwrap_or_else(PoisonError::into_inner);
    let found = match known.get(&key) {
        Some(found) => Ok(*found),
        None => call.stage("measure compositors", |progress| {
            let measure = || measure(device, needed, progress);
            remembered(&cache_folder().join("compositors"), &key, measure)
        }),
    };
    let (times, from_before) = match found {
        Ok(found) => found,
        Err(error) if error.kind == voltet_core::error::ErrorKind::Cancelled => return Err(error),
        Err(error) => return Ok(tiles(&format!("the other one cannot be measured: {error}"))),
    };
    known.insert(key, (times, from_before));
    let why = format!(
        "the faster one here: on a small grid{} tiles take {:.3} ms, raster {:.3} ms{}",
        if needed { " in the order of centroids" } else { " that needs no order" },
        1e3 * times.tiles,
        1e3 * times.raster,
        if from_before { " (remembered)" } else { "" }
    );
    Ok(match times.faster() {
        Compositing::Tiles => tiles(&why),
        Compositing::Raster => (raster, "raster", why),
    })
}
