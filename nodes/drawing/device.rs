//! A scene on the device engine: devices are opened once a session, grids uploaded once a revision.

use super::Scene;
use super::stages::{leave_out_cells, note_tiles_stopped};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::graph::{Call, Saving};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_gpu::{Device, Drawn, How, Renderer, Work};

/// Open devices by what was wished for: the adapter, and whether software will do. Failures are kept too, since looking
/// for adapters takes a while.
#[derive(Default)]
struct Devices(Mutex<HashMap<Wish, Result<Arc<Device>>>>);

type Wish = (Option<String>, bool);

/// One volume's renderers, by device.
#[derive(Default)]
struct Renderers(Mutex<HashMap<String, Arc<Renderer>>>);

/// Draws on the adapter that the node's parameters name, or the fastest. `hardware`: software devices will not do unless
/// they are named.
pub fn draw(call: &mut Call, scene: &Scene, hardware: bool) -> Result<Picture> {
    voltet_gpu::can_serve(&scene.transfer_function, &scene.shading)
        .map_err(|error| call.parameters.blame("integrator", error))?;
    let wish = (call.parameters.optional("adapter").and_then(|s| s.text()).map(str::to_string), hardware);
    let devices = call.keep_for_session(|| Ok(Devices::default()))?;
    let device = call
        .stage("device", |_| open(&devices, &wish))
        .map_err(|error| if wish.0.is_some() { call.parameters.blame("adapter", error) } else { error })?;
    let (how, compositor, why) = super::compositor::choose(call, scene, &device)?;
    let before = device.work();
    let revision = call.revision("volume")?;
    let renderers = call.keep(revision, || Ok(Renderers::default()))?;
    let renderer = call.stage("upload", |_| {
        let mut renderers = renderers.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(renderer) = renderers.get(&device.name).filter(|renderer| !renderer.device().is_lost()) {
            return Ok(renderer.clone());
        }
        let renderer = Arc::new(Renderer::new(device.clone(), &scene.volume)?);
        renderers.insert(device.name.clone(), renderer.clone());
        Ok(renderer)
    })?;
    let drawn = call.stage("draw", |progress| draw_as(&renderer, scene, how, progress))?;
    call.notes.compositor = Some((compositor.into(), why));
    note(call, scene, &device, before, &drawn);
    Ok(drawn.picture)
}

/// Draws on the renderer's device with the compositor of that name.
pub fn draw_by(
    renderer: &Renderer,
    scene: &Scene,
    compositor: &str,
    progress: &dyn Progress,
) -> Result<Drawn> {
    draw_as(renderer, scene, super::compositor::how(scene, compositor), progress)
}

fn draw_as(renderer: &Renderer, scene: &Scene, how: How, progress: &dyn Progress) -> Result<Drawn> {
    let Scene { volume, transfer_function, camera, shading, .. } = scene;
    voltet_gpu::draw(renderer, volume, transfer_function, camera, shading, how, progress)
}

fn open(devices: &Devices, wish: &Wish) -> Result<Arc<Device>> {
    let mut devices = devices.0.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = devices.get(wish).filter(|known| !matches!(known, Ok(device) if device.is_lost())) {
        return known.clone();
    }
    let opened = Device::open(wish.0.as_deref(), wish.1).map(Arc::new);
    devices.insert(wish.clone(), opened.clone());
    opened
}

fn note(call: &mut Call, scene: &Scene, device: &Device, before: Work, drawn: &Drawn) {
    let Drawn { counts, seconds, .. } = drawn;
    let work = device.work();
    let notes = &mut call.notes;
    notes.engine = Some(("gpu".into(), device.reason.clone()));
    notes.adapter = Some(device.name.clone());
    if device.is_software {
        let slow = "is a program on the CPU, slower than engine = \"cpu\"";
        notes.warnings.push(format!("{} {slow}", device.name));
    }
    if drawn.blended_in_16_bits {
        let off = "what it draws may be off by some thousandths; compositor = \"tiles\" has 32 bits";
        notes.warnings.push(format!("{} blends no 32-bit floats: {off}", device.name));
    }
    notes.stages.extend(seconds.iter().map(|(pass, seconds)| (format!("device {pass}"), *seconds)));
    for (name, count) in [
        ("cells_total", scene.volume.grid.tetrahedra.len() as u64),
        ("cells_culled", counts.culled_by_transfer_function + counts.culled_by_frustum),
        ("cells_projected", counts.cells_projected),
        ("tile_entries", counts.tile_entries),
        ("segments_exact", 0),
        ("sweeps_further", counts.sweeps_further),
        ("shader_builds", work.shader_builds - before.shader_builds),
        ("uploads", work.uploads - before.uploads),
    ] {
        notes.counts.insert(name, count);
    }
    notes.counts.extend(counts.segments.map(|count| ("segments", count)));
    notes.counts.extend(counts.pixels_disordered.map(|count| ("pixels_disordered", count)));
    if let Some(count @ 1..) = counts.pixels_disordered {
        notes.warnings.push(format!("{count} pixels were composited in an order that is not exact"));
    }
    leave_out_cells(
        call,
        counts.culled_by_transfer_function,
        "that show nothing",
        "no widget touches their values",
    );
    leave_out_cells(call, counts.culled_by_frustum, "out of view", "they lie outside the view");
    leave_out_cells(call, counts.under_a_pixel, "under a pixel's reach", "they cover no pixel centre");
    note_tiles_stopped(call, counts.tiles_stopped, counts.cells_hidden);
    if !drawn.parts_left_out.is_empty() {
        let what = format!("shader parts {}", drawn.parts_left_out.join(", "));
        let saving = Saving::Bytes(drawn.part_bytes_left_out);
        call.notes.leave_out(what, "the scene asks for nothing of the kind", Some(saving));
    }
}

#[cfg(test)]
mod tests;
