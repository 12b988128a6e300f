//! Subject of a study: the scene of a pipeline's node that draws, and how the pipeline asks for it to be drawn.

use super::variant::RendererVariant;
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_graph::{Demand, Graph, GraphNode, Observer, Parameters, Session, Value, diagonal};
use voltet_nodes::drawing::{self, NATIVE};
use voltet_nodes::relative::placed;
use voltet_optics::engine::EngineInfo;
use voltet_optics::integrators::{INTEGRATOR, Integrator, kinds};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Ordering;
use voltet_reference::REFERENCE;

/// Kind of nodes that draw, which decides where an engine can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RendererNode {
    Renderer,
    GpuRenderer,
    /// The stages one by one, which are the native engine's.
    Stages,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SubjectRequest {
    /// Kind of nodes that draw.
    pub form: RendererNode,
    pub engine: String,
    /// The adapter, where one is named.
    pub adapter: Option<String>,
    /// The compositor of the device, or "auto".
    pub compositor: String,
}

/// Subject of a study: a scene, the node that draws it, and its options.
#[derive(Debug, Clone)]
pub struct Subject {
    pub node: String,
    /// The node whose parameter `order` counts; `None` where the pipeline has none that could be set.
    pub order_node: Option<String>,
    /// The scene; integrator, overlap and order are those of the file.
    pub scene: Scene,
    pub asked: SubjectRequest,
    /// One integrator of each kind that the pipeline may name, with default settings, in the order of registration.
    pub integrators: Vec<Integrator>,
    /// Background of the picture where the pipeline writes it (linear RGB).
    pub background: [f64; 3],
    /// Warnings of the nodes that feed it.
    pub warnings: Vec<String>,
}

impl Subject {
    /// Runs what feeds the node that draws. `name`: which one, where the pipeline has several; `gradient`: whether ∇s shall be
    /// there, by the pipeline's own filter, also where the scene does not look at it.
    pub fn gather(
        graph: &Graph,
        name: Option<&str>,
        gradient: bool,
        session: &mut Session,
        observer: &dyn Observer,
    ) -> Result<Subject> {
        let place = drawing_node(graph, name)?;
        let node = &graph.nodes[place];
        let blame = |error| node.locate(error);
        let (inputs, report) =
            session.feed(graph, place, &Demand { gradient, ..Demand::default() }, observer)?;
        let shading = drawing::shading(&node.parameters).map_err(blame)?;
        let unknown = || node.locate(Error::run("the node that draws is fed by values of unknown types"));
        let (scene, order_node) = match inputs.as_slice() {
            [volume, Value::TransferFunction(look), Value::Camera(camera), surfaces @ ..] => {
                let volume = volume.volume().ok_or_else(unknown)?.map_err(blame)?;
                let bounds = volume.grid.bounds();
                let diagonal = if look.auto_unit_distance { diagonal(bounds) } else { 0.0 };
                let transfer_function = Arc::new(look.for_diagonal(diagonal));
                let order = drawing::order(&node.parameters).map_err(blame)?;
                let mut scene = Scene::new(volume, transfer_function, **camera, shading, order);
                scene.clips =
                    placed(&node.parameters, bounds).and_then(|p| drawing::clips(&p)).map_err(blame)?;
                for surface in surfaces {
                    let Value::Surface(surface) = surface else { return Err(unknown()) };
                    scene.surfaces.push(surface.clone());
                }
                (scene, Some(node.name.clone()))
            }
            [Value::Projection(projected), Value::TransferFunction(_)] => {
                let projected = projected.clone().downcast::<drawing::Projected>().map_err(|_| unknown())?;
                let cells = projected.projection.cells();
                let scene = Scene::new(
                    cells.volume.clone(),
                    projected.transfer_function.clone(),
                    *projected.projection.camera(),
                    shading,
                    cells.ordering.requested(),
                );
                (scene, sorting_node(graph, place))
            }
            _ => return Err(unknown()),
        };
        Ok(Subject {
            node: node.name.clone(),
            order_node,
            integrators: kinds(node.parameters.variants(INTEGRATOR))
                .into_iter()
                .map(Integrator::new)
                .collect(),
            scene,
            asked: SubjectRequest::from_node(node.node.name, &node.parameters),
            background: background(graph, place),
            warnings: report.warnings,
        })
    }

    pub fn studied(&self) -> Vec<Integrator> {
        self.integrators.iter().copied().filter(is_studied).collect()
    }

    /// An engine as the file has it. `None`: the compositor is left open, and more than one can serve.
    pub fn painter_on(&self, engine: &'static EngineInfo) -> Option<RendererVariant> {
        let mut all = RendererVariant::all_of_engine(engine);
        let exact = self.scene.ordering(false) == Ordering::PerPixel;
        match self.asked.compositor.as_str() {
            _ if engine.compositing.is_empty() => all.next(),
            // Tiles alone have it, and are the first.
            _ if exact => all.next(),
            "auto" => all.next().filter(|_| all.next().is_none()),
            named => all.find(|variant| variant.compositor() == Some(named)),
        }
    }
}

impl SubjectRequest {
    pub fn is_auto(&self) -> bool {
        self.engine == drawing::AUTO
    }

    fn from_node(node: &str, parameters: &Parameters) -> SubjectRequest {
        let form = match node {
            "renderer" => RendererNode::Renderer,
            "gpu-renderer" => RendererNode::GpuRenderer,
            _ => RendererNode::Stages,
        };
        let text = |name: &str| parameters.optional(name).and_then(|setting| setting.text());
        let engine = match form {
            RendererNode::Renderer => text("engine").unwrap_or(drawing::AUTO),
            RendererNode::GpuRenderer => drawing::DEVICE.name,
            RendererNode::Stages => NATIVE.name,
        };
        SubjectRequest {
            form,
            engine: engine.into(),
            adapter: text("adapter").map(str::to_string),
            compositor: text("compositor").unwrap_or(drawing::AUTO).into(),
        }
    }
}

pub fn drawing_nodes(graph: &Graph) -> Vec<String> {
    let all = graph.order.iter().map(|&i| &graph.nodes[i]);
    all.filter(|node| draws(node)).map(|node| node.name.clone()).collect()
}

fn draws(node: &GraphNode) -> bool {
    matches!(node.node.name, "renderer" | "gpu-renderer" | "composite")
}

/// The node that draws: a renderer or a composite node that something written needs; the one of a name, or the nearest behind it, as behind an
/// annotation.
fn drawing_node(graph: &Graph, name: Option<&str>) -> Result<usize> {
    let found: Vec<usize> = graph.order.iter().copied().filter(|&i| draws(&graph.nodes[i])).collect();
    let names: Vec<&str> = found.iter().map(|&i| graph.nodes[i].name.as_str()).collect();
    match (name, found.as_slice()) {
        (Some(name), _) => drawing_behind(graph, name).ok_or_else(|| {
            Error::usage("no node of this name draws what the pipeline writes")
                .got(name)
                .not_among(name, names.iter().copied())
        }),
        (None, [place]) => Ok(*place),
        (None, []) => Err(Error::usage("the pipeline draws no volume").expected(
            "a node of type \"renderer\", \"gpu-renderer\" or \"composite\" that an image-writer needs",
        )),
        (None, _) => Err(Error::usage("several nodes of the pipeline draw")
            .got(names.join(", "))
            .expected("--node with the name of one of them")),
    }
}

fn drawing_behind(graph: &Graph, name: &str) -> Option<usize> {
    let mut met: Vec<usize> = graph.order.iter().copied().filter(|&i| graph.nodes[i].name == name).collect();
    let mut next = 0;
    while let Some(&i) = met.get(next) {
        if draws(&graph.nodes[i]) {
            return Some(i);
        }
        let feeding = graph.nodes[i].inputs.iter().map(|edge| edge.node);
        let new: Vec<usize> = feeding.filter(|node| !met.contains(node)).collect();
        met.extend(new);
        next += 1;
    }
    None
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
    let writers = graph.nodes.iter().filter(|node| node.node.name == "image-writer");
    let given =
        writers.filter(|node| shows(graph, node, place)).find(|node| node.parameters.is_set("background"));
    given.and_then(|node| node.parameters.color("background").ok()).unwrap_or([0.0; 3])
}

/// True if a node takes the picture of another, or what a third made of it.
fn shows(graph: &Graph, node: &GraphNode, place: usize) -> bool {
    let mut pictures = node.inputs.iter().filter(|edge| edge.name == "image");
    pictures.any(|edge| edge.node == place || shows(graph, &graph.nodes[edge.node], place))
}

/// True for all integrators but the reference, with which the others are compared.
pub(super) fn is_studied(integrator: &Integrator) -> bool {
    *integrator != REFERENCE
}
