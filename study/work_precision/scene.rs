//! The scene of a pipeline: what its node that draws is given, and how it is asked to draw.

use super::{Engine, Setting};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::graph::{Graph, GraphNode, Observer, Parameters, Session, Value, diagonal};
use voltet_core::shading::{Order, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_nodes::drawing;

/// Which nodes draw, which decides what an engine can be written into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A `renderer`, on either engine.
    Renderer,
    /// A `gpu-renderer`.
    GpuRenderer,
    /// The stages one by one, which are the native engine's.
    Stages,
}

/// What the file says about engines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asked {
    /// Which nodes draw.
    pub form: Form,
    /// "auto", "cpu" or "gpu".
    pub engine: String,
    /// The adapter, where one is named.
    pub adapter: Option<String>,
    /// The compositor of the device, or "auto".
    pub compositor: String,
}

/// What is drawn, by which node, and how.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The name of the node that draws.
    pub node: String,
    /// The node whose parameter `order` counts; `None` where the pipeline has none that could be set.
    pub order_node: Option<String>,
    /// The cells and their values.
    pub volume: Arc<Volume>,
    /// What is drawn.
    pub transfer_function: TransferFunction,
    /// Where it is seen from.
    pub camera: Camera,
    /// The light, silhouettes and, as the file has them, integrator and overlap.
    pub shading: Shading,
    /// The order that the file asks for.
    pub order: Order,
    /// Whether the order of a pixel's segments changes the picture.
    pub needs_order: bool,
    /// What the file says about engines.
    pub asked: Asked,
    /// What the picture lies over where the pipeline writes it; linear RGB.
    pub background: [f64; 3],
}

impl Scene {
    /// Runs what feeds the node that draws. `name`: which one, where the pipeline has several.
    pub fn gather(
        graph: &Graph,
        name: Option<&str>,
        session: &mut Session,
        observer: &dyn Observer,
    ) -> Result<Scene> {
        let place = drawing_node(graph, name)?;
        let node = &graph.nodes[place];
        let blame = |error| node.blame(error);
        let inputs = session.inputs(graph, place, observer)?;
        let shading = drawing::shading(&node.parameters).map_err(blame)?;
        let background = background(graph, place);
        let asked = Asked::of(node.node.name, &node.parameters);
        let needs = |look: &TransferFunction| drawing::needs_order(look, &shading);
        let unknown = || node.blame(Error::run("the node that draws is fed by values of unknown types"));
        match inputs.as_slice() {
            [volume, Value::TransferFunction(look), Value::Camera(camera)] => {
                let volume = volume.volume().ok_or_else(unknown)?.map_err(blame)?;
                let diagonal = if look.auto_unit_distance { diagonal(&volume.grid.points) } else { 0.0 };
                let transfer_function = look.for_diagonal(diagonal);
                let needs_order = needs(&transfer_function);
                let order = drawing::order(&node.parameters, needs_order).map_err(blame)?;
                Ok(Scene {
                    node: node.name.clone(),
                    order_node: Some(node.name.clone()),
                    volume,
                    transfer_function,
                    camera: **camera,
                    shading,
                    order,
                    needs_order,
                    asked,
                    background,
                })
            }
            [Value::Projection(projected), Value::TransferFunction(_)] => {
                let projected = projected.clone().downcast::<drawing::Projected>().map_err(|_| unknown())?;
                let cells = projected.projection.cells();
                Ok(Scene {
                    node: node.name.clone(),
                    order_node: sorting_node(graph, place),
                    volume: cells.volume.clone(),
                    transfer_function: (*projected.transfer_function).clone(),
                    camera: *projected.projection.camera(),
                    shading,
                    order: cells.order,
                    needs_order: needs(&projected.transfer_function),
                    asked,
                    background,
                })
            }
            _ => Err(unknown()),
        }
    }

    /// The device engine as the file has it. `None`: the compositor is left open, and more than one can serve.
    pub fn on_device(&self) -> Option<Engine> {
        let mut all = Engine::of_device();
        let exact = self.needs_order && matches!(self.order, Order::Exact | Order::Auto);
        match self.asked.compositor.as_str() {
            "auto" if exact => all.find(|engine| {
                engine.compositor().is_some_and(|name| drawing::has_order(name, Order::Exact))
            }),
            "auto" => all.next().filter(|_| all.next().is_none()),
            named => all.find(|engine| engine.compositor() == Some(named)),
        }
    }

    /// How the file draws it, were it on this engine.
    pub fn setting(&self, engine: Engine) -> Setting {
        let order = match self.order {
            Order::Auto => Order::Exact,
            order => order,
        };
        Setting { engine, integrator: self.shading.integrator, overlap: self.shading.overlap, order }
    }
}

impl Asked {
    fn of(node: &str, parameters: &Parameters) -> Asked {
        let form = match node {
            "renderer" => Form::Renderer,
            "gpu-renderer" => Form::GpuRenderer,
            _ => Form::Stages,
        };
        let text = |name: &str| parameters.optional(name).and_then(|setting| setting.text());
        let engine = match form {
            Form::Renderer => text("engine").unwrap_or("auto"),
            Form::GpuRenderer => "gpu",
            Form::Stages => "cpu",
        };
        Asked {
            form,
            engine: engine.into(),
            adapter: text("adapter").map(str::to_string),
            compositor: text("compositor").unwrap_or("auto").into(),
        }
    }
}

/// The names of the nodes that draw what the pipeline writes.
pub fn drawing_nodes(graph: &Graph) -> Vec<String> {
    let all = graph.order.iter().map(|&i| &graph.nodes[i]);
    all.filter(|node| draws(node)).map(|node| node.name.clone()).collect()
}

fn draws(node: &GraphNode) -> bool {
    matches!(node.node.name, "renderer" | "gpu-renderer" | "composite")
}

/// The node that draws: a renderer or a composite node that something written needs.
fn drawing_node(graph: &Graph, name: Option<&str>) -> Result<usize> {
    let found: Vec<usize> = graph.order.iter().copied().filter(|&i| draws(&graph.nodes[i])).collect();
    let names: Vec<&str> = found.iter().map(|&i| graph.nodes[i].name.as_str()).collect();
    match (name, found.as_slice()) {
        (Some(name), _) => names.iter().position(|known| *known == name).map(|i| found[i]).ok_or_else(|| {
            Error::usage("no node of this name draws what the pipeline writes")
                .found(name)
                .accepted(voltet_core::graph::suggest(name, names.iter().copied()))
        }),
        (None, [place]) => Ok(*place),
        (None, []) => Err(Error::usage("the pipeline draws no volume, so there is nothing to study")
            .accepted(
                "a node of type \"renderer\", \"gpu-renderer\" or \"composite\" that an image-writer needs",
            )),
        (None, _) => Err(Error::usage("several nodes of the pipeline draw")
            .found(names.join(", "))
            .accepted("--node with the name of one of them")),
    }
}

/// The sort node that the cells of a composite node run through.
fn sorting_node(graph: &Graph, place: usize) -> Option<String> {
    let mut node = &graph.nodes[place];
    // Its first input each time: projection, cells, cells.
    while let Some(edge) = node.inputs.first() {
        node = &graph.nodes[edge.node];
        if node.node.name == "sort" {
            return Some(node.name.clone());
        }
    }
    None
}

/// The background of the first PNG that shows the picture; black where there is none.
fn background(graph: &Graph, place: usize) -> [f64; 3] {
    let shows = |node: &&GraphNode| {
        node.node.name == "image-writer" && node.inputs.iter().any(|edge| edge.node == place)
    };
    let given = graph.nodes.iter().filter(shows).find(|node| node.parameters.given("background"));
    given.and_then(|node| node.parameters.vector("background").ok()).unwrap_or([0.0; 3])
}
