use super::OpenEngines;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::generate::{box_of_tetrahedra, with_scalar};
use voltet_gpu::{Device, GpuEngine};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{NoObserver, Node, Outputs, Port, PortType, RunReport, Value};
use voltet_optics::engine::{AdapterRequest, Engine};

/// A grid of 384 cells; with it, the software driver is opened as if its bindings held 2 KiB, and 8 of them at a time.
const SOURCE: Node = Node {
    name: "grid-for-a-small-device",
    summary: "A grid, and a device that cannot bind it.",
    outputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "" }],
    demand: &|_| Ok(()),
    run: &|call| {
        let opened = call.keep_for_session(|| Ok(OpenEngines::default()))?;
        let small = |device: Device| {
            device.with_limits(|limits| {
                limits.max_storage_buffer_binding_size = 2048;
                limits.max_storage_buffers_per_shader_stage = 8;
            })
        };
        let engine = Device::open(Some("software"), true)
            .map(|device| Arc::new(GpuEngine::new(Arc::new(small(device)))) as Arc<dyn Engine>);
        for hardware in [true, false] {
            let wish = AdapterRequest { name: Some("software".into()), hardware };
            opened
                .0
                .lock()
                .expect("no test fails while it holds it")
                .insert((voltet_gpu::ENGINE.name, wish), engine.clone());
        }
        let grid = box_of_tetrahedra([4, 4, 4], [DVec3::ZERO, DVec3::ONE], 0.2);
        Ok(vec![Value::Grid(Arc::new(with_scalar(grid, "s", |p| p.x)))]) as Result<Outputs>
    },
    ..Node::BLANK
};

/// A pipeline ends somewhere.
const END: Node = Node {
    name: "end",
    summary: "Takes a picture.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    ..Node::BLANK
};

/// The same grid for any device.
const GRID: Node = Node {
    name: "grid-for-any-device",
    summary: "A grid.",
    run: &|_| {
        let grid = box_of_tetrahedra([4, 4, 4], [DVec3::ZERO, DVec3::ONE], 0.2);
        Ok(vec![Value::Grid(Arc::new(with_scalar(grid, "s", |p| p.x)))]) as Result<Outputs>
    },
    ..SOURCE
};

static NODES: [Node; 3] = [SOURCE, GRID, END];

const PIPELINE: &str = r#"
[pipeline]
format = 1

[nodes.grid]
type = "grid-for-a-small-device"

[nodes.look]
type = "transfer-function"

[[nodes.look.widgets]]
kind = "gaussian"
color = [0.9, 0.5, 0.1]
extinction = 5.0
centre = [0.5, 0.0]
sigma = [0.2, inf]

[nodes.view]
type = "camera"
eye = [0.3, -2.0, 0.7]
target = [0.5, 0.5, 0.5]
size = [24, 20]

[nodes.picture]
type = "renderer"
engine = "ENGINE"
inputs = { volume = "grid", transfer_function = "look", camera = "view" }

[nodes.end]
type = "end"
inputs = { image = "picture" }
"#;

fn run(engine: &str) -> Result<RunReport> {
    run_text(PIPELINE, engine)
}

fn run_text(text: &str, engine: &str) -> Result<RunReport> {
    let mut registry = crate::registry()?;
    NODES.iter().try_for_each(|node| registry.add(node))?;
    let text = text.replace("ENGINE", engine);
    let text = if engine == "cpu" {
        text
    } else {
        text.replace("inputs = { volume", "adapter = \"software\"\ninputs = { volume")
    };
    let graph = Pipeline::parse(&text)?.graph(&registry, ".".into())?;
    crate::session().run(&graph, &NoObserver)
}

/// A grid that the device cannot bind is the CPU's picture under `auto`, which says why; asked for, it is an error.
#[test]
fn a_grid_that_the_device_cannot_bind_is_drawn_by_the_cpu() {
    if let Err(why) = Device::open(Some("software"), true) {
        voltet_testing::skipped_without_device(why);
        return;
    }
    let drawn = run("auto").expect("draws");
    let (engine, why) = drawn.engine.expect("is named");
    assert_eq!(engine, "cpu");
    for word in ["more parts than", "the grid's cells of", "in 3 parts", "8 buffers", "such cells"] {
        assert!(why.contains(word), "'{word}' is not in: {why}");
    }
    let by_cpu = run("cpu").expect("draws");
    assert!(drawn.pictures[0].1.rgba.iter().any(|pixel| pixel[3] > 0.1));
    assert_eq!(drawn.pictures[0].1.rgba, by_cpu.pictures[0].1.rgba);
    let error = run("gpu").expect_err("refused").to_string();
    assert!(error.contains("more parts than"), "{error}");
}

/// Widgets too dense for 32 bits are the CPU's picture under `auto`, which says why; asked of the device, they are an error.
#[test]
fn a_scene_that_32_bits_do_not_hold_is_drawn_by_the_cpu() {
    if let Err(why) = Device::open(Some("software"), true) {
        voltet_testing::skipped_without_device(why);
        return;
    }
    let second = r#"[[nodes.look.widgets]]
kind = "gaussian"
color = [0.1, 0.5, 0.9]
extinction = 1e10
centre = [0.6, 0.0]
sigma = [0.2, inf]

[nodes.view]"#;
    let text = PIPELINE.replace(SOURCE.name, GRID.name).replace("[nodes.view]", second);
    let drawn = run_text(&text, "auto").expect("draws");
    let (engine, why) = drawn.engine.expect("is named");
    assert_eq!(engine, "cpu");
    for word in ["too dense for 32 bits", "widgets[1]", "at most 2e7"] {
        assert!(why.contains(word), "'{word}' is not in: {why}");
    }
    let by_cpu = run_text(&text, "cpu").expect("draws");
    assert!(drawn.pictures[0].1.rgba.iter().any(|pixel| pixel[3] > 0.9));
    assert_eq!(drawn.pictures[0].1.rgba, by_cpu.pictures[0].1.rgba);
    let error = run_text(&text, "gpu").expect_err("refused").to_string();
    assert!(error.contains("too dense for 32 bits"), "{error}");
    // The same grid with a lesser extinction is the device's.
    let held = run_text(&text.replace("1e10", "5.0"), "auto").expect("draws");
    assert_eq!(held.engine.expect("is named").0, "gpu");
}
