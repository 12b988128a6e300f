//! Times of the editor, printed: with 200 and 400 nodes a frame of the interface, opening, tidying, the steps of a drag, undo; the first coarse
//! picture and the full one after a widget's move; orbiting, and the full picture after it; the first picture of a larger file, and where that
//! is a pipeline frames of the interface meanwhile.
//!
//! `cargo bench -p voltet-editor -- [BLUNT_FIN.vtu [POST.vtu]]`: VTK's example data, with an array `density` the one and `energy`
//! the other; without files the wavelet stands in. A pipeline that `voltet start` wrote for data can stand for these. `--opening`: what is
//! measured while a file is opened, alone.

use eframe::egui::accesskit::NodeId;
use eframe::egui::{Context, Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2, vec2};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::Error;
use voltet_core::progress::Progress;
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
    if !std::env::args().any(|argument| argument == "--opening") {
        [200, 400].into_iter().for_each(interface);
        drawing(files.first().map(PathBuf::as_path));
    }
    opening(files.get(1).map(PathBuf::as_path));
}

fn row(what: &str, milliseconds: f64, bar: f64) {
    println!("| {what} | {milliseconds:.1} ms | {bar:.0} ms |");
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
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
    let begun = Instant::now();
    let Some(mut window) = Window::open(Document::from_text(text, None)) else { return };
    window.frame(Vec::new());
    let opened = milliseconds(begun);
    (0..20).for_each(|_| _ = window.frame(Vec::new()));
    let of = format!("{count} nodes in view");
    row(&format!("opening, {of}"), opened, 50.0);
    for (size, bar) in [([1600.0, 1000.0], 16.0), ([2560.0, 1440.0], 16.0)] {
        window.size = size;
        (0..10).for_each(|_| _ = window.frame(Vec::new()));
        let times: Vec<f64> = (0..100).map(|_| window.frame(Vec::new())).collect();
        let [width, height] = size;
        row(&format!("a frame of {width} × {height}, {of} (median of 100)"), median(times.clone()), bar);
        row(&format!("a frame of {width} × {height}, {of} (99 %)"), at_share(times, 0.99), bar);
    }
    let Some(corner) = window.place_of("node grid_0") else { return };
    let at = corner + vec2(12.0, 6.0);
    window.frame(vec![Event::PointerMoved(at)]);
    let button = |pos, pressed| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        vec![Event::PointerMoved(pos), Event::PointerButton { pos, button, pressed, modifiers }]
    };
    window.frame(button(at, true));
    let way = |i: u8| at + f32::from(i) * vec2(0.5, 1.0);
    let steps: Vec<f64> = (1..60).map(|i| window.frame(vec![Event::PointerMoved(way(i))])).collect();
    window.frame(button(way(59), false));
    assert!(window.editor.document().history().position().0 == 1, "no node was dragged");
    row(&format!("a step of a node's drag, {of} (median of 59)"), median(steps.clone()), 16.0);
    row(&format!("a step of a node's drag, {of} (99 %)"), at_share(steps, 0.99), 50.0);
    window.frame(vec![Event::PointerMoved(pos2(5.0, 500.0))]);
    for (what, key, modifiers) in [
        ("undo", Key::Z, Modifiers::COMMAND),
        ("all nodes selected", Key::A, Modifiers::COMMAND),
        ("tidying", Key::L, Modifiers::NONE),
    ] {
        let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        let pressed = window.frame(vec![Event::ModifiersChanged(modifiers), event(true)]);
        let released = window.frame(vec![event(false), Event::ModifiersChanged(Modifiers::NONE)]);
        let time = pressed.max(released);
        row(&format!("{what}, {of}"), time, 50.0);
    }
}

/// The interface without a window.
struct Window {
    editor: Editor,
    ctx: Context,
    /// Width and height, points.
    size: [f32; 2],
    frames: u32,
    /// Places of what has a name, with it, in the last frame.
    named: Vec<(String, Pos2)>,
}

impl Window {
    fn open(document: Document) -> Option<Window> {
        let registry = voltet_nodes::registry().ok()?;
        let start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Err(Error::usage("no data here")));
        let editor = Editor::new(document, &registry, start, Arc::new(|| {})).ok()?;
        Some(Window { editor, ctx: Context::default(), size: [1600.0, 1000.0], frames: 0, named: Vec::new() })
    }

    /// Milliseconds that a frame with these events takes, with all that it waits for.
    fn frame(&mut self, events: Vec<Event>) -> f64 {
        self.frames += 1;
        let (screen_rect, time) =
            (Some(Rect::from_min_size(Pos2::ZERO, self.size.into())), Some(f64::from(self.frames) / 60.0));
        let begun = Instant::now();
        let input = RawInput { screen_rect, time, events, ..RawInput::default() };
        let output = self.ctx.run_ui(input, |ui| self.editor.frame(ui));
        let meshes = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        let spent = milliseconds(begun);
        assert!(!meshes.is_empty());
        if let Some(update) = output.platform_output.accesskit_update {
            let place = |node: &eframe::egui::accesskit::Node| {
                let bounds = node.bounds()?;
                Some((node.label()?.to_string(), pos2(bounds.x0 as f32, bounds.y0 as f32)))
            };
            let nodes: Vec<(NodeId, eframe::egui::accesskit::Node)> = update.nodes;
            self.named = nodes.iter().filter_map(|(_, node)| place(node)).collect();
        }
        spent
    }

    /// The upper left corner of what has a name.
    fn place_of(&mut self, name: &str) -> Option<Pos2> {
        self.ctx.enable_accesskit();
        (0..2).for_each(|_| _ = self.frame(Vec::new()));
        self.ctx.disable_accesskit();
        self.named.iter().find(|(known, _)| known == name).map(|(_, at)| *at)
    }
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
        let now = milliseconds(begun);
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

fn median(all: Vec<f64>) -> f64 {
    at_share(all, 0.5)
}

/// The number below which this share of them lies.
fn at_share(mut all: Vec<f64>, share: f64) -> f64 {
    all.sort_by(f64::total_cmp);
    all.get((share * all.len() as f64) as usize).copied().unwrap_or(f64::NAN)
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
        seconds.push(milliseconds(begun));
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
        "| pictures a second while orbiting (coarse) | {:.1} | 30 or more |",
        f64::from(seen) / begun.elapsed().as_secs_f64()
    );
    // It rests: the picture of its last place, while the one before is drawn.
    let after = (0..9).map(|_| {
        for _ in 0..20 {
            turn(&mut nodes, 0.01);
            worker.draw(wanted(&nodes));
            std::thread::sleep(Duration::from_micros(16_600));
        }
        turn(&mut nodes, 0.01);
        draw(&worker, &nodes)[1]
    });
    row("the full picture after orbiting (1024×768)", median(after.collect()), 150.0);
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
    drop(worker);
    if let Some(document) = file.filter(|file| file.extension().is_some_and(|end| end == "toml")) {
        Document::open(document).map(beside_work).unwrap_or_else(|error| println!("{error}"));
    }
}

/// Frames of the interface, sixty a second, while the data of a pipeline are read and drawn, the histogram is found, and the pointer moves.
fn beside_work(document: Document) {
    let Some(mut window) = Window::open(document) else { return };
    let (begun, mut times, mut gaps, mut longest) = (Instant::now(), Vec::new(), Vec::new(), (0.0, [0.0; 3]));
    let is_drawn = |window: &Window| {
        window
            .editor
            .worker()
            .shown(|shown| shown.failure.is_some() || shown.pixels.is_some() && !shown.is_busy)
    };
    // The histogram comes after the picture.
    let mut drawn_at: Option<Instant> = None;
    let mut last = Instant::now();
    while drawn_at.is_none_or(|at| at.elapsed() < HISTOGRAM_TIME)
        && begun.elapsed() < Duration::from_secs(240)
    {
        if drawn_at.is_none() && is_drawn(&window) {
            drawn_at = Some(Instant::now());
        }
        let at = pos2(20.0 + (times.len() % 60) as f32 * 10.0, 300.0);
        let before = scheduled();
        let time = window.frame(vec![Event::PointerMoved(at)]);
        let [own, waited] = [0, 1].map(|k| scheduled()[k] - before[k]);
        gaps.push(milliseconds(std::mem::replace(&mut last, Instant::now())));
        times.push(time);
        if time > longest.0 {
            longest = (time, [own, waited, time - own - waited]);
        }
        std::thread::sleep(Duration::from_micros(16_600));
    }
    row("a frame while data are read and drawn (median)", median(times.clone()), 16.0);
    row("a frame meanwhile (99 %)", at_share(times, 0.99), 50.0);
    row("from one frame to the next meanwhile (99 %)", at_share(gaps.clone(), 0.99), 50.0);
    row("the longest time from one frame to the next", at_share(gaps, 0.9999), 50.0);
    let (time, [own, waited, blocked]) = longest;
    row("the longest frame meanwhile", time, 50.0);
    println!(
        "| the longest frame meanwhile: own work {own:.1} ms, without a core {waited:.1} ms, blocked {blocked:.1} ms | | |"
    );
}

/// Time for which frames are measured after the picture, while the histogram is found.
const HISTOGRAM_TIME: Duration = Duration::from_secs(15);

/// Milliseconds that this thread has worked, and that it was ready and had no core; 0 where the system does not tell.
fn scheduled() -> [f64; 2] {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let mut numbers = text.split(' ').map(|number| number.trim().parse::<f64>().unwrap_or(0.0) * 1e-6);
    [(); 2].map(|()| numbers.next().unwrap_or(0.0))
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
