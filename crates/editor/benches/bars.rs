//! Times of the editor, printed: a frame of the interface with 200 and 400 nodes; the first coarse picture and the full one
//! after a widget's move; orbiting; the first picture of a larger file.
//!
//! `cargo bench -p voltet-editor -- [BLUNT_FIN.vtu [POST.vtu]]`: VTK's example data, with an array `density` the one and `energy`
//! the other; without files the wavelet stands in. A pipeline that `voltet start` wrote for data can stand for these.

use eframe::egui::{Context, Pos2, RawInput, Rect, vec2};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::Error;
use voltet_document::Document;
use voltet_editor::Editor;
use voltet_editor::view::View;
use voltet_editor::worker::{RenderRequest, Worker};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{LocatedValue, NodeEntry, ParameterValue};

fn main() {
    let files: Vec<PathBuf> =
        std::env::args().skip(1).filter(|a| !a.starts_with("--")).map(PathBuf::from).collect();
    println!("| what | measured | bar |\n| --- | --- | --- |");
    [200, 400].into_iter().for_each(interface);
    drawing(files.first().map(PathBuf::as_path));
    opening(files.get(1).map(PathBuf::as_path));
}

fn row(what: &str, milliseconds: f64, bar: f64) {
    println!("| {what} | {milliseconds:.1} ms | {bar:.0} ms |");
}

/// So many nodes in view, in rows of five wired pipelines.
fn interface(count: usize) {
    let chains = count / 4;
    let mut text = String::from("[pipeline]\nformat = 1\n");
    for i in 0..chains {
        text += &format!(
            "[nodes.grid_{i}]\ntype = \"wavelet\"\n[nodes.gradient_{i}]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid_{i}\" }}\n\
             [nodes.look_{i}]\ntype = \"transfer-function\"\ninputs = {{ volume = \"gradient_{i}\" }}\n[nodes.found_{i}]\ntype = \"histogram\"\ninputs = {{ volume = \"gradient_{i}\" }}\n\
             [editor.nodes]\n"
        );
        text = text.replace("[editor.nodes]\n", "");
    }
    text += "[editor.nodes]\n";
    for i in 0..chains {
        let (x, y) = ((i % 5) * 960, (i / 5) * 170);
        for (k, name) in ["grid", "gradient", "look", "found"].iter().enumerate() {
            text += &format!("{name}_{i} = [{}, {y}]\n", x + 230 * k);
        }
    }
    let document = Document::from_text(text, None);
    let registry = voltet_nodes::registry().unwrap_or_default();
    let start = Arc::new(|_: &Path, _: &Path| Err(Error::usage("no data here")));
    let Ok(mut editor) = Editor::new(document, &registry, start, Arc::new(|| {})) else { return };
    let ctx = Context::default();
    let mut time = 0.0;
    let mut frame = |editor: &mut Editor| {
        time += 1.0 / 60.0;
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(2560.0, 1440.0)));
        let begun = Instant::now();
        let output = ctx
            .run_ui(RawInput { screen_rect, time: Some(time), ..RawInput::default() }, |ui| editor.frame(ui));
        let meshes = ctx.tessellate(output.shapes, output.pixels_per_point);
        assert!(!meshes.is_empty());
        begun.elapsed().as_secs_f64() * 1e3
    };
    (0..10).for_each(|_| {
        frame(&mut editor);
    });
    let mut times: Vec<f64> = (0..60).map(|_| frame(&mut editor)).collect();
    times.sort_by(f64::total_cmp);
    row(&format!("a frame of the interface, {count} nodes in view (median of 60)"), times[30], 16.0);
}

/// A pipeline over an array of a file, or the wavelet.
fn pipeline(
    file: Option<(&Path, &str)>,
    centre: [f64; 2],
    sigma: [f64; 2],
    eye: [f64; 3],
    target: [f64; 3],
) -> Vec<NodeEntry> {
    let source = match file {
        Some((file, scalar)) => {
            format!("type = \"reader\"\nscalar = {scalar:?}\npath = {:?}", file.display().to_string())
        }
        None => "type = \"wavelet\"\nresolution = [32, 32, 32]".into(),
    };
    if let Some((file, _)) = file.filter(|(file, _)| file.extension().is_some_and(|end| end == "toml")) {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        return Pipeline::parse(&text).map(|pipeline| pipeline.nodes).unwrap_or_default();
    }
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\n{source}\n[nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid\" }}\n\
         [nodes.look]\ntype = \"transfer-function\"\n[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 0.5, 0.2]\nextinction = 4.0\n\
         centre = {centre:?}\nsigma = {sigma:?}\n[nodes.view]\ntype = \"camera\"\neye = {eye:?}\ntarget = {target:?}\nsize = [1024, 768]\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\ninputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}\n"
    );
    Pipeline::parse(&text).map(|pipeline| pipeline.nodes).unwrap_or_default()
}

fn blunt_fin(file: Option<&Path>) -> Vec<NodeEntry> {
    match file {
        Some(file) => {
            let of = Some((file, "density"));
            pipeline(of, [1.6, 0.8], [0.05, 0.3], [0.0, -12.0, 6.0], [3.0, 0.0, 1.5])
        }
        None => pipeline(None, [150.0, 20.0], [60.0, 40.0], [-28.0, -38.0, 24.0], [0.0; 3]),
    }
}

fn wanted(nodes: &[NodeEntry]) -> RenderRequest {
    RenderRequest {
        nodes: nodes.to_vec(),
        folder: std::env::current_dir().unwrap_or_default(),
        node: "picture".into(),
        size: None,
        background: [0.0; 3],
        coarse_first: true,
        grip_moves: false,
    }
}

/// Milliseconds until the worker's picture is of this request, and until it is the full one.
fn until(worker: &Worker, number: u64, begun: Instant) -> [f64; 2] {
    let mut first = None;
    while begun.elapsed() < Duration::from_secs(120) {
        let (shown, failure) = worker.shown(|shown| {
            (
                shown.pixels.as_ref().map(|p| (p.number, p.is_full())),
                shown.failure.as_ref().map(Error::to_string),
            )
        });
        if let Some(failure) = failure {
            println!("{failure}");
            break;
        }
        let now = begun.elapsed().as_secs_f64() * 1e3;
        match shown {
            Some((of, true)) if of == number => return [first.unwrap_or(now), now],
            Some((of, _)) if of == number => first = first.or(Some(now)),
            _ => {}
        }
        // No oftener: both cores draw.
        std::thread::sleep(Duration::from_millis(1));
    }
    [f64::NAN; 2]
}

fn draw(worker: &Worker, nodes: &[NodeEntry]) -> [f64; 2] {
    let begun = Instant::now();
    let number = worker.draw(wanted(nodes));
    until(worker, number, begun)
}

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

fn drawing(file: Option<&Path>) {
    let Ok(worker) = voltet_nodes::registry().and_then(|registry| Worker::start(&registry, Arc::new(|| {})))
    else {
        return;
    };
    let mut nodes = blunt_fin(file);
    (0..3).for_each(|_| {
        turn(&mut nodes, 0.01);
        draw(&worker, &nodes);
    });
    let mut both: Vec<[f64; 2]> = Vec::new();
    for i in 0..15 {
        move_widget(&mut nodes, 1.0 + 1e-3 * f64::from(i));
        both.push(draw(&worker, &nodes));
    }
    row(
        "first coarse picture after a widget's move (1024×768)",
        median(both.iter().map(|b| b[0]).collect()),
        50.0,
    );
    row("the full one", median(both.iter().map(|b| b[1]).collect()), 250.0);
    // A hand that moves a widget, each time that there is a picture.
    let (mut seconds, mut pixels) = (Vec::new(), Vec::new());
    for i in 0..40 {
        move_widget(&mut nodes, 1.0 + 1e-3 * f64::from(i));
        let begun = Instant::now();
        let number = worker.draw(wanted(&nodes));
        let drawn = || worker.shown(|shown| shown.pixels.clone().filter(|pixels| pixels.number == number));
        while drawn().is_none() && begun.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_micros(500));
        }
        seconds.push(begun.elapsed().as_secs_f64() * 1e3);
        pixels.extend(drawn().map(|pixels| (pixels.size()[0] * pixels.size()[1]) as f64));
    }
    let (times, sizes) = (median(seconds.split_off(20)), median(pixels.split_off(20)));
    println!(
        "| while a hand moves a widget: a picture, of so many pixels | {times:.1} ms, {sizes:.0} | 50 ms |"
    );
    // A hand that moves 60 times a second.
    let (begun, mut seen, mut last) = (Instant::now(), 0, 0);
    while begun.elapsed() < Duration::from_secs(4) {
        turn(&mut nodes, 0.01);
        worker.draw(wanted(&nodes));
        let tick = Instant::now();
        while tick.elapsed() < Duration::from_micros(16_600) {
            let number = worker.shown(|shown| shown.pixels.as_ref().map_or(0, |pixels| pixels.number));
            seen += u32::from(number != last);
            last = number;
            std::thread::sleep(Duration::from_micros(500));
        }
    }
    println!(
        "| pictures a second while orbiting (coarse) | {:.1} | 20 or more |",
        f64::from(seen) / begun.elapsed().as_secs_f64()
    );
}

fn opening(file: Option<&Path>) {
    let nodes = match file {
        // The boundary that `voltet start` finds with the most area, seen from where it looks.
        Some(file) => {
            let of = Some((file, "energy"));
            pipeline(of, [2.5, 0.5], [0.05, 0.35], [-19.8, -32.0, 51.4], [-1.0, 0.4, 2.4])
        }
        None => pipeline(None, [150.0, 20.0], [60.0, 40.0], [-28.0, -38.0, 24.0], [0.0; 3]),
    };
    let begun = Instant::now();
    let Ok(worker) = voltet_nodes::registry().and_then(|registry| Worker::start(&registry, Arc::new(|| {})))
    else {
        return;
    };
    let number = worker.draw(wanted(&nodes));
    let [first, full] = until(&worker, number, begun);
    row("opening: first picture", first, 1500.0);
    println!("| opening: the full one | {full:.0} ms | |");
}

fn turn(nodes: &mut [NodeEntry], by: f64) {
    let Some(camera) = nodes.iter_mut().find(|node| node.name == "view") else { return };
    let Some(view) = View::from_camera(camera) else { return };
    for (key, datum) in view.orbited([by, 0.0]).settings() {
        if key != "fov_y" {
            let _ = camera.set(key, &[], LocatedValue::from(datum));
        }
    }
}

fn move_widget(nodes: &mut [NodeEntry], times: f64) {
    let Some(look) = nodes.iter_mut().find(|node| node.name == "look") else { return };
    let _ = look.set("widgets", &["0", "extinction"], ParameterValue::Number(4.0 * times).into());
}
