//! Drawing of grids in parts: each part by itself, to a volumetric depth image; these together are the picture of the whole grid.

use super::engines::{AUTO, ENGINE, ENGINES, NATIVE};
use super::scene::{check_engine, clips, order, shading};
use super::{engines::OpenEngines, note};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::VolumeExtent;
use voltet_core::{Error, Result, counted};
use voltet_graph::{Outputs, RunContext, Value};
use voltet_optics::depth_image::{Supersegment, VolumetricDepthImage};
use voltet_optics::engine::{AdapterRequest, EngineInfo, RenderOptions};
use voltet_optics::ray_events::{RayEventSource, RayEvents};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};

/// Memory of a stretch of a ray (bytes).
const STRETCH_BYTES: u64 = size_of::<Supersegment>() as u64;

/// Draws the grid at the input `volume`, of which parts are read one after the other.
pub fn draw_parts(call: &mut RunContext) -> Result<Outputs> {
    let camera = *call.camera("camera")?;
    let look = call.look("transfer_function")?;
    let shading = shading(call.parameters)?;
    refuse(call, &look.transfer_function, &shading)?;
    let whole = extent_of_parts(call)?;
    let diagonal = voltet_graph::diagonal(whole.bounds);
    if look.auto_unit_distance {
        call.set_diagonal(diagonal);
    }
    let transfer_function = Arc::new(look.for_diagonal(diagonal));
    let surfaces = call.surfaces("surfaces")?;
    let clips = clips(call.parameters)?;
    let events = surface_events(RayEventSource::new(&surfaces, &[], &camera)?, &camera, call)?;
    let size = camera.size.map(|n| n as usize);
    let mut image = VolumetricDepthImage::empty(size, camera.sample_offsets().len());
    let opened = call.keep_for_session(|| Ok(OpenEngines::default()))?;
    let engine = opened.open(NATIVE, &AdapterRequest::default())?;
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
        // Both and what they become.
        let bytes = 2 * (image.stretch_count() + own.stretch_count()) * STRETCH_BYTES;
        refuse_beyond_memory(call.progress(), || "the stretches of rays in parts of the grid".into(), bytes)?;
        image = call.stage("merge", |_| image.merged(&own, &events))?;
        Ok(())
    })?;
    call.notes.counts.insert("ray_stretches", image.stretch_count());
    call.notes.engine = Some((NATIVE.name.into(), "it draws grids in parts".into()));
    call.notes.adapter = Some(engine.adapter());
    let (picture, overlapping) = picture_of_all(call, &image, &events)?;
    if overlapping > 0 && call.ranks().rank() == 0 {
        call.notes.warnings.push(format!(
            "parts of the grid overlap in {}: what is there twice is drawn twice as dense. Are ghost cells marked by vtkGhostType?",
            counted(overlapping, "pixel")
        ));
    }
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
    if integrator.has_table_of_lengths()
        || integrator.kind().scene_preparation().is_some()
        || integrator.extension::<EngineInfo>().is_some()
    {
        let what = format!(
            "the integrator \"{}\" prepares the whole grid, or a table for its longest cell",
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
        let own = VolumeExtent::from_volume(&*call.volume("volume")?);
        whole = Some(whole.take().map_or(own, |whole| whole.joined(&own)));
        Ok(())
    })?;
    let of_all = call.gather(&whole.map_or(Vec::new(), |own| to_numbers(&own)))?;
    let of_all = of_all.iter().filter_map(|own| from_numbers(own));
    Ok(of_all.reduce(|whole, own| whole.joined(&own)).unwrap_or_default())
}

/// An extent as numbers that other processes are sent.
fn to_numbers(extent: &VolumeExtent) -> Vec<f64> {
    let bounds =
        extent.bounds.map_or([f64::NAN; 6].to_vec(), |ends| ends.map(|place| place.to_array()).concat());
    [bounds, extent.ranges.concat(), vec![extent.max_gradient]].concat()
}

/// The extent that [`to_numbers`] made numbers of; `None` of a process without cells.
fn from_numbers(numbers: &[f64]) -> Option<VolumeExtent> {
    let &[a, b, c, d, e, f, s_low, s_high, g_low, g_high, max_gradient] = numbers else { return None };
    let bounds = (!a.is_nan()).then(|| [DVec3::new(a, b, c), DVec3::new(d, e, f)]);
    Some(VolumeExtent { bounds, ranges: [[s_low, s_high], [g_low, g_high]], max_gradient })
}

/// The picture of the parts of all processes, on each of them. Each puts together some of the rows, of which the others send it theirs
/// (direct send: Hsu 1993, "Segmented ray casting for data parallel volume rendering").
fn picture_of_all(
    call: &mut RunContext,
    image: &VolumetricDepthImage,
    events: &[RayEvents],
) -> Result<(Picture, u64)> {
    let [width, height] = image.size;
    let count = call.ranks().count();
    if count == 1 {
        return Ok((image.picture(events), image.overlapping_pixels()));
    }
    let rows = |rank: usize| height * rank / count..height * (rank + 1) / count;
    let own_rank = call.ranks().rank();
    let message = |rank: usize| match rank == own_rank {
        true => Ok(Vec::new()),
        false => Ok(image.rows(rows(rank))?.to_bytes()),
    };
    let to_each = (0..count).map(message).collect::<Result<Vec<_>>>()?;
    let bytes = |all: &[Vec<u8>]| {
        let sent = all.iter().enumerate().filter(|(rank, _)| *rank != own_rank);
        sent.map(|(_, bytes)| bytes.len() as u64).sum::<u64>()
    };
    let mut sent = bytes(&to_each);
    let mut own = image.rows(rows(own_rank))?;
    for (rank, bytes) in call.ranks().exchange(to_each)?.iter().enumerate() {
        if rank != own_rank {
            own = own.merged(&VolumetricDepthImage::from_bytes(bytes)?, events)?;
        }
    }
    let overlapping = call.gather(&[own.overlapping_pixels() as f64])?.iter().flatten().sum::<f64>() as u64;
    let pixels = own.picture(events).rgba;
    let own_bytes: Vec<u8> = pixels.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
    let to_each = vec![own_bytes; count];
    sent += bytes(&to_each);
    let mut picture = Picture { width, height, rgba: Vec::with_capacity(width * height) };
    for (rank, bytes) in call.ranks().exchange(to_each)?.iter().enumerate() {
        let (pixels, rest) = bytes.as_chunks::<16>();
        if pixels.len() != width * rows(rank).len() || !rest.is_empty() {
            return Err(Error::run("another process sent a broken part of the picture").got(bytes.len()));
        }
        let pixel = |bytes: &[u8; 16]| {
            let (values, _) = bytes.as_chunks::<4>();
            [0, 1, 2, 3].map(|k: usize| f32::from_le_bytes(values[k]))
        };
        picture.rgba.extend(pixels.iter().map(pixel));
    }
    call.notes.counts.insert("bytes_sent", sent);
    Ok((picture, overlapping))
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
