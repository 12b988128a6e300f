//! Drawing of grids in parts: each part by itself, to a volumetric depth image; these together are the picture of the whole grid.

use super::engines::{AUTO, ENGINE, ENGINES, NATIVE};
use super::scene::{check_engine, clips, order, shading};
use super::{engines::OpenEngines, note};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::VolumeExtent;
use voltet_core::{Error, Result, counted};
use voltet_graph::{Outputs, RunContext, Value};
use voltet_optics::depth_image::VolumetricDepthImage;
use voltet_optics::engine::{AdapterRequest, EngineInfo, RenderOptions};
use voltet_optics::ray_events::{RayEventSource, RayEvents};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};

/// Draws the grid at the input `volume`, of which parts are read one after the other.
pub fn draw_parts(call: &mut RunContext) -> Result<Outputs> {
    let camera = *call.camera("camera")?;
    let look = call.look("transfer_function")?;
    let shading = shading(call.parameters)?;
    refuse(call, &look.transfer_function, &shading)?;
    let whole = extent_of_parts(call)?;
    let diagonal = || voltet_graph::diagonal(&whole.bounds.map(Vec::from).unwrap_or_default());
    let diagonal = if look.auto_unit_distance { diagonal() } else { 0.0 };
    let transfer_function = Arc::new(look.for_diagonal(diagonal));
    let surfaces = call.surfaces("surfaces")?;
    let clips = clips(call.parameters)?;
    let events = surface_events(RayEventSource::new(&surfaces, &[], &camera)?, &camera, call)?;
    let size = camera.size.map(|n| n as usize);
    let mut image = VolumetricDepthImage::empty(size, camera.sample_offsets().len());
    let opened = call.keep_for_session(|| Ok(OpenEngines::default()))?;
    let engine = opened.open(NATIVE, &AdapterRequest::default())?;
    let mut overlapping = 0;
    call.each_part(&mut |call| {
        let scene = Scene {
            volume: call.volume("volume")?,
            transfer_function: transfer_function.clone(),
            camera,
            shading,
            order: VisibilityOrder::Exact,
            surfaces: surfaces.clone(),
            clips: clips.clone(),
        };
        let manner = RenderOptions { part: true, exhaustive: call.exhaustive(), ..RenderOptions::default() };
        let drawn = call.stage("draw", |progress| {
            engine.prepare_part(&scene.volume, &whole)?.draw(&scene, &manner, progress)
        })?;
        call.notes.counts.insert("cells_total", scene.volume.grid.tetrahedra.len() as u64);
        call.notes.add(drawn.notes);
        note(call, &drawn.counts);
        let own = drawn.depth_image.ok_or_else(|| Error::run("the engine drew no volumetric depth image"))?;
        image = call.stage("merge", |_| image.merged(&own, &events))?;
        overlapping = overlapping.max(image.overlapping_pixels());
        Ok(())
    })?;
    call.notes.counts.insert("ray_stretches", image.stretch_count());
    call.notes.engine = Some((NATIVE.name.into(), "it draws grids in parts".into()));
    call.notes.adapter = Some(engine.adapter());
    if overlapping > 0 {
        call.notes.warnings.push(format!(
            "parts of the grid overlap in {}: what is there twice is drawn twice as dense. Are ghost cells marked by vtkGhostType?",
            counted(overlapping, "pixel")
        ));
    }
    let picture = image.picture(&events);
    if picture.rgba.iter().all(|pixel| *pixel == [0.0; 4]) {
        call.notes.warnings.push("the picture is empty: no widget reaches a cell in view".into());
    }
    Ok(vec![Value::Image(Arc::new(picture))])
}

/// Refuses what is not drawn in parts.
fn refuse(call: &RunContext, transfer_function: &TransferFunction, shading: &Shading) -> Result<()> {
    let p = call.parameters;
    let in_parts = "a grid in parts (--memory)";
    let wanted = p.text(ENGINE.name)?;
    let draws = |name: &str| ENGINES.iter().any(|engine| engine.name == name && engine.draws_parts);
    if wanted != AUTO && !draws(wanted) {
        let error = p.error(ENGINE.name, format!("the engine \"{wanted}\" draws whole grids"));
        let able: Vec<&str> =
            ENGINES.iter().filter(|engine| engine.draws_parts).map(|engine| engine.name).collect();
        return Err(error
            .got(in_parts)
            .expected(format!("\"{}\", \"{AUTO}\", or a larger --memory", able.join("\", \""))));
    }
    let integrator = &shading.integrator;
    if integrator.has_table()
        || integrator.kind().scene_preparation().is_some()
        || integrator.extension::<EngineInfo>().is_some()
    {
        let what = format!(
            "the integrator \"{}\" prepares the whole grid, or a table of all its values",
            integrator.name()
        );
        let error = p.locate("integrator", Error::usage(what).got(in_parts));
        return Err(error.expected("\"analytic\", another integrator without a table, or a larger --memory"));
    }
    if order(p)? != VisibilityOrder::Exact {
        let error =
            p.error("order", "cells of several parts have the exact order alone").got(p.text("order")?);
        return Err(error.expected("order = \"exact\", or a larger --memory"));
    }
    if !call.demand.layers.is_empty() {
        let error = Error::usage("layers of a picture are found in whole grids").got(in_parts);
        return Err(error.expected("a picture without layers, or a larger --memory"));
    }
    check_engine(NATIVE, p, transfer_function, shading)
}

/// The extent of the whole grid.
fn extent_of_parts(call: &mut RunContext) -> Result<VolumeExtent> {
    let mut whole: Option<VolumeExtent> = None;
    call.each_part(&mut |call| {
        let own = VolumeExtent::of(&*call.volume("volume")?);
        whole = Some(whole.take().map_or(own, |whole| whole.joined(&own)));
        Ok(())
    })?;
    Ok(whole.unwrap_or_default())
}

/// The surfaces along the rays of each sample; none where there are no surfaces.
fn surface_events(
    source: Option<RayEventSource<'_>>,
    camera: &Camera,
    call: &RunContext,
) -> Result<Vec<RayEvents>> {
    let Some(source) = source else { return Ok(Vec::new()) };
    camera.sample_offsets().iter().map(|&offset| source.events(offset, call.progress())).collect()
}
