//! Drawing of grids in parts: each part by itself, to a volumetric depth image; these together are the picture of the whole grid.

use super::engines::{AUTO, ENGINE, ENGINES, NATIVE};
use super::scene::{check_engine, clips_of_data, order, shading};
use super::{engines::OpenEngines, note};
use serde_json::json;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, counted};
use voltet_graph::{Outputs, RunContext, Value};
use voltet_optics::depth_image::{Supersegment, VolumetricDepthImage};
use voltet_optics::engine::{AdapterRequest, Engine, EngineInfo, PreparedPart, RenderOptions, SelectedPart};
use voltet_optics::ray_events::{RayEventSource, RayEvents};
use voltet_optics::scene::Scene;
use voltet_optics::scene_parts::{PartTally, SceneChoices, SceneExtent};
use voltet_optics::shading::{Shading, VisibilityOrder};

/// Memory of a stretch of a ray (bytes).
const STRETCH_BYTES: u64 = size_of::<Supersegment>() as u64;

/// Draws the grid at the input `volume`, of which parts are read one after the other.
pub fn draw_parts(call: &mut RunContext) -> Result<Outputs> {
    let camera = *call.camera("camera")?;
    let look = call.look("transfer_function")?;
    let shading = shading(call.parameters)?;
    refuse(call, &look.transfer_function, &shading)?;
    let whole = extent_of_parts(call, &look.transfer_function.fields(), &camera)?;
    let diagonal = voltet_graph::diagonal(whole.volume.bounds);
    if look.auto_unit_distance {
        call.set_diagonal(diagonal);
    }
    let transfer_function = Arc::new(look.for_diagonal(diagonal));
    let surfaces = call.surfaces("surfaces")?;
    let clips = clips_of_data(call, |_| Ok(whole.volume.bounds))?;
    let events = surface_events(RayEventSource::new(&surfaces, &[], &camera)?, &camera, call)?;
    let opened = call.keep_for_session(|| Ok(OpenEngines::default()))?;
    let engine = opened.open(NATIVE, &AdapterRequest::default())?;
    let scene_of = |volume: Arc<Volume>| Scene {
        volume,
        transfer_function: transfer_function.clone(),
        camera,
        shading,
        order: VisibilityOrder::Exact,
        surfaces: surfaces.clone(),
        clips: clips.clone(),
    };
    // Where no process has a further part, the cells are tallied first, so that none is drawn twice.
    let is_at_hand = call.gather(&[call.part_count() as f64])?.iter().flatten().all(|count| *count <= 1.0);
    let mut parts = EngineParts {
        engine: &*engine,
        whole: &whole,
        transfer_function: &transfer_function,
        scene_of: &scene_of,
        at_hand: None,
    };
    let mut sent = 0;
    let image = match is_at_hand {
        true => draw_tallied(call, &mut parts, &events, &mut sent)?,
        false => draw_in_rounds(call, &mut parts, &events, &mut sent)?,
    };
    call.notes.counts.insert("ray_stretches", image.stretch_count());
    call.notes.engine = Some((NATIVE.name.into(), "it draws grids in parts".into()));
    call.notes.adapter = Some(engine.adapter());
    let (picture, overlapping) = picture_of_all(call, &image, &events, sent)?;
    if overlapping > 0 && call.ranks().rank() == 0 {
        call.notes.warnings.push(format!(
            "parts of the grid overlap in {}: what is there twice is drawn twice as dense. Are ghost cells marked by vtkGhostType?",
            counted(overlapping, "pixel")
        ));
    }
    if call.ranks().rank() == 0 && picture.rgba.iter().all(|pixel| *pixel == [0.0; 4]) {
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

struct EngineParts<'a> {
    engine: &'a dyn Engine,
    whole: &'a SceneExtent,
    transfer_function: &'a TransferFunction,
    scene_of: &'a dyn Fn(Arc<Volume>) -> Scene,
    /// The only part of this process, once it is tallied.
    at_hand: Option<PartAtHand>,
}

/// A part that was tallied and is not drawn yet.
struct PartAtHand {
    scene: Scene,
    part: Arc<dyn PreparedPart>,
    /// Its cells, selected without choices.
    selected: Box<dyn SelectedPart>,
    /// As of [`PartTally::methods`].
    methods: [bool; 2],
}

impl EngineParts<'_> {
    /// The scene of the part at the input, and the part.
    fn prepare(&self, call: &RunContext) -> Result<(Scene, Arc<dyn PreparedPart>)> {
        let scene = (self.scene_of)(call.volume("volume")?);
        let part = self.engine.prepare_part(&scene.volume, self.whole)?;
        Ok((scene, part))
    }

    fn choices(&self, tally: &PartTally) -> Result<SceneChoices> {
        self.engine.choices(self.whole, self.transfer_function, tally)
    }
}

fn options(call: &RunContext) -> RenderOptions {
    RenderOptions { exhaustive: call.exhaustive(), ..RenderOptions::default() }
}

/// Draws the parts of all processes, none of which has more than one. The cells are tallied before, so that none is drawn twice.
fn draw_tallied(
    call: &mut RunContext,
    parts: &mut EngineParts,
    events: &[RayEvents],
    sent: &mut u64,
) -> Result<VolumetricDepthImage> {
    let mut own = PartTally::default();
    call.each_part(&mut |call| {
        let (scene, part) = parts.prepare(call)?;
        let (none, manner) = (SceneChoices::default(), options(call));
        let selected = call.stage("tally", |progress| {
            let selected = part.clone().select(&scene, &none, &manner, progress)?;
            own = selected.tally(false);
            Ok(selected)
        })?;
        parts.at_hand = Some(PartAtHand { scene, part, selected, methods: own.methods });
        check_boundary(call, &own)
    })?;
    let tally = tally_of_all(call, own, sent)?;
    let mut choices = parts.choices(&tally)?;
    // Processes agree on it: the tally is that of all.
    if tally.lacks_boundary && choices.casts_rays == Some(true) {
        let own = match &parts.at_hand {
            Some(known) => call.stage("tally", |_| Ok(known.selected.tally(true)))?,
            None => PartTally::default(),
        };
        check_boundary(call, &own)?;
        choices = parts.choices(&tally_of_all(call, own, sent)?)?;
    }
    Ok(draw_each(call, parts, &choices, events)?.0)
}

/// Draws the parts, and draws them again where their cells together decide otherwise than those of a part by itself.
fn draw_in_rounds(
    call: &mut RunContext,
    parts: &mut EngineParts,
    events: &[RayEvents],
    sent: &mut u64,
) -> Result<VolumetricDepthImage> {
    let (before, mut choices, mut rounds) = (call.notes.clone(), SceneChoices::default(), 1);
    let image = loop {
        let (image, tally) = draw_each(call, parts, &choices, events)?;
        let tally = tally_of_all(call, tally, sent)?;
        let decided = parts.choices(&tally)?;
        if choices.serves(&decided, tally.methods) {
            break image;
        }
        // The time that it took is spent.
        let stages = std::mem::take(&mut call.notes.stages);
        (choices, call.notes) = (decided, before.clone());
        call.notes.stages = stages;
        rounds += 1;
    };
    if rounds > 1 {
        let what = format!("the parts were drawn {rounds} times, at last by what serves the whole grid");
        call.notes.find(what, json!({ "rounds_drawn": rounds }));
    }
    Ok(image)
}

/// Refuses the boundary of parts whose keys do not fit into memory with those that are sent and those that come.
fn check_boundary(call: &RunContext, tally: &PartTally) -> Result<()> {
    let bytes = 3 * size_of_val(&tally.boundary[..]) as u64;
    refuse_beyond_memory(call.progress(), || "the boundaries of parts of the grid".into(), bytes)
}

/// Refuses stretches of rays that do not fit into memory. `bytes`: what they take in all their copies.
fn check_stretches(call: &RunContext, bytes: u64) -> Result<()> {
    refuse_beyond_memory(call.progress(), || "the stretches of rays in parts of the grid".into(), bytes)
}

/// Draws each part by itself: their image, and figures of their cells, as far as these were not tallied before.
fn draw_each(
    call: &mut RunContext,
    parts: &mut EngineParts,
    choices: &SceneChoices,
    events: &[RayEvents],
) -> Result<(VolumetricDepthImage, PartTally)> {
    let camera = *call.camera("camera")?;
    let size = camera.size.map(|n| n as usize);
    let mut image: Option<VolumetricDepthImage> = None;
    let mut tally = PartTally::default();
    call.each_part(&mut |call| {
        let manner = options(call);
        let is_tallied = parts.at_hand.is_some();
        let (scene, drawn) = match parts.at_hand.take() {
            Some(known) if SceneChoices::default().serves(choices, known.methods) => {
                (known.scene, call.stage("draw", |progress| known.selected.draw(progress))?)
            }
            known => {
                // Cells that do not serve are dropped before others are selected.
                let (scene, part) = match known.map(|known| (known.scene, known.part)) {
                    Some(known) => known,
                    None => parts.prepare(call)?,
                };
                let drawn = call.stage("draw", |progress| {
                    let selected = part.select(&scene, choices, &manner, progress)?;
                    if !is_tallied {
                        tally.add(selected.tally(false));
                    }
                    selected.draw(progress)
                })?;
                (scene, drawn)
            }
        };
        call.notes.counts.insert("cells_total", scene.volume.grid.tetrahedra.len() as u64);
        call.notes.add(drawn.notes);
        note(call, &drawn.counts);
        let own = drawn.part.ok_or_else(|| Error::run("the engine drew no volumetric depth image"))?;
        image = Some(match image.take() {
            None => own,
            Some(image) => {
                // Both and what they become.
                check_stretches(call, 2 * (image.stretch_count() + own.stretch_count()) * STRETCH_BYTES)?;
                call.stage("merge", |_| image.merged(&own, events))?
            }
        });
        check_boundary(call, &tally)
    })?;
    let none = || VolumetricDepthImage::empty(size, camera.sample_offsets().len());
    Ok((image.unwrap_or_else(none), tally))
}

/// The extent of the scene's whole grid.
fn extent_of_parts(call: &mut RunContext, fields: &[&str], camera: &Camera) -> Result<SceneExtent> {
    let mut whole: Option<SceneExtent> = None;
    call.each_part(&mut |call| {
        let own = SceneExtent::of_part(&*call.volume("volume")?, fields, camera)?;
        whole = Some(whole.take().map_or_else(|| own.clone(), |whole| whole.joined(&own)));
        Ok(())
    })?;
    let own = whole.map_or(Vec::new(), |own| own.to_numbers());
    let mut of_all: Option<SceneExtent> = None;
    for numbers in call.gather(&own)? {
        let own = SceneExtent::from_numbers(&numbers)?;
        of_all = match (of_all, own) {
            (Some(all), Some(own)) => Some(all.joined(&own)),
            (all, own) => all.or(own),
        };
    }
    of_all.ok_or_else(|| Error::run("no process has a part of the grid"))
}

/// The figures of the cells of all processes. `sent`: takes in the bytes that this process has sent for it.
fn tally_of_all(call: &RunContext, mut own: PartTally, sent: &mut u64) -> Result<PartTally> {
    let count = call.ranks().count();
    if count == 1 {
        own.count_boundary();
        return Ok(own);
    }
    let mut to_each: Vec<Vec<u8>> = vec![Vec::new(); count];
    for key in std::mem::take(&mut own.boundary) {
        to_each[(key % count as u64) as usize].extend(key.to_le_bytes());
    }
    let to_others = to_each.iter().enumerate().filter(|(rank, _)| *rank != call.ranks().rank());
    *sent += to_others.map(|(_, keys)| keys.len() as u64).sum::<u64>();
    let keys = call.ranks().exchange(to_each)?;
    let keys = keys.iter().flat_map(|bytes| bytes.as_chunks::<8>().0).map(|key| u64::from_le_bytes(*key));
    own.boundary.extend(keys);
    own.count_boundary();
    let flags = own.methods.iter().chain([&own.lacks_boundary]).chain(&own.active_widgets);
    let flags = flags.map(|flag| f64::from(u8::from(*flag)));
    let numbers: Vec<f64> =
        [own.covered_pixels, own.cells, own.outer_faces].into_iter().chain(flags).collect();
    let mut all = PartTally::default();
    for numbers in call.gather(&numbers)? {
        let [covered_pixels, cells, outer_faces, cast, projected, lacks, ref active @ ..] = numbers[..]
        else {
            return Err(Error::run("another process sent broken figures").got(numbers.len()));
        };
        let active_widgets = active.iter().map(|flag| *flag > 0.0).collect();
        let methods = [cast > 0.0, projected > 0.0];
        all.add(PartTally {
            covered_pixels,
            cells,
            outer_faces,
            boundary: Vec::new(),
            lacks_boundary: lacks > 0.0,
            methods,
            active_widgets,
        });
    }
    Ok(all)
}

/// The picture of the parts of all processes, on the first of them, and the number of pixels in which parts overlap; on the others it is
/// transparent. Each puts together some of the rows, of which the others send it theirs (direct send: Hsu 1993, "Segmented ray casting for
/// data parallel volume rendering"). `sent`: bytes that this process has sent for the picture before.
fn picture_of_all(
    call: &mut RunContext,
    image: &VolumetricDepthImage,
    events: &[RayEvents],
    sent: u64,
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
    // All rows, as they are sent or kept.
    check_stretches(call, image.stretch_count() * STRETCH_BYTES)?;
    let to_each = (0..count).map(message).collect::<Result<Vec<_>>>()?;
    let mut own = image.rows(rows(own_rank))?;
    let lengths: Vec<f64> = to_each.iter().map(|bytes| bytes.len() as f64).collect();
    let coming =
        call.gather(&lengths)?.iter().filter_map(|of_rank| of_rank.get(own_rank)).sum::<f64>() as u64;
    let going = lengths.iter().sum::<f64>() as u64;
    // A copy of what goes, and two of what comes, on the way; then that with the own rows, and what they become.
    check_stretches(call, going + 2 * coming + 2 * (coming + own.stretch_count() * STRETCH_BYTES))?;
    let mut sent = sent.saturating_add(going);
    for (rank, bytes) in call.ranks().exchange(to_each)?.iter().enumerate() {
        if rank != own_rank {
            own = own.merged(&VolumetricDepthImage::from_bytes(bytes)?, events)?;
        }
    }
    let mut to_each = vec![Vec::new(); count];
    let pixels = own.picture(events).rgba;
    to_each[0] = bytemuck::cast_slice(&pixels).to_vec();
    // Colour and opacity of each pixel that a process touches must leave it somehow.
    let pixel_bytes = size_of::<[f32; 4]>() as u64;
    let mut least = 0;
    if own_rank > 0 {
        sent += to_each[0].len() as u64;
        least = image.covered_pixels() * pixel_bytes;
    }
    let figures = [own.overlapping_pixels(), sent, least].map(|count| count as f64);
    let figures = call.gather(&figures)?;
    let sum = |k: usize| figures.iter().filter_map(|own| own.get(k)).sum::<f64>();
    let mut picture = Picture::transparent(width, height);
    for (rank, bytes) in call.ranks().exchange(to_each)?.iter().enumerate().filter(|_| own_rank == 0) {
        let own = &mut picture.rgba[width * rows(rank).start..width * rows(rank).end];
        let own: &mut [u8] = bytemuck::cast_slice_mut(own);
        if bytes.len() != own.len() {
            return Err(Error::run("another process sent a broken part of the picture").got(bytes.len()));
        }
        own.copy_from_slice(bytes);
    }
    if own_rank == 0 {
        let a_pixel = [1, 2].map(|k| (sum(k) / (width * height) as f64 * 10.0).round() / 10.0);
        let what =
            format!("{} bytes sent a pixel, of which any method sends {} or more", a_pixel[0], a_pixel[1]);
        call.notes.find(what, json!({ "bytes_a_pixel": { "sent": a_pixel[0], "least": a_pixel[1] } }));
    }
    call.notes.counts.insert("bytes_sent", sent);
    call.notes.counts.insert("bytes_sent_least", least);
    Ok((picture, sum(0) as u64))
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
