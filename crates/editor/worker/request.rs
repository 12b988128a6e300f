//! Requests for pictures, of nodes as a document states them, as a screen shows them. A node that takes every output and does nothing lets a
//! run be made for a picture and nothing else, and gives what runs through the wires.

use eframe::egui::{Color32, ColorImage};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use voltet_core::grid::Grid;
use voltet_core::grid::extent::range;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result, counted, noun_of, with_commas};
use voltet_document::Series;
use voltet_document::links::{self, upstream};
use voltet_graph::{
    DefaultValue, Demand, Graph, NoObserver, Node, NodeEntry, Parameter, ParameterType, ParameterValue, Port,
    PortType, Registry, RunReport, Session, Value,
};
use voltet_io::encode::srgb_from_linear;

/// The node type that says where a picture is seen from, and its parameters that coarse pictures change.
const CAMERA: &str = "camera";
const SIZE: &str = "size";
const SAMPLES: &str = "samples";

/// A picture that is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderRequest {
    /// The nodes of the document; those that do not feed the picture are of no account, even broken.
    pub nodes: Vec<NodeEntry>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// The node whose picture it is.
    pub node: String,
    /// The full picture's width and height; `None`: as the camera says.
    pub size: Option<[u32; 2]>,
    /// Linear RGB behind it.
    pub background: [f64; 3],
    /// True if a picture of fewer pixels is shown while the full one is drawn.
    pub coarse_first: bool,
    /// True while a hand moves a grip in the picture: settings that differ are its movement.
    pub grip_moves: bool,
}

impl RenderRequest {
    /// The full picture of the node `picture`, over black.
    #[cfg(test)]
    pub fn of_picture(nodes: Vec<NodeEntry>) -> RenderRequest {
        let (folder, node) = (PathBuf::new(), "picture".into());
        let (size, background, coarse_first, grip_moves) = (None, [0.0; 3], false, false);
        RenderRequest { nodes, folder, node, size, background, coarse_first, grip_moves }
    }

    /// The names of the nodes that feed the picture, and its own.
    pub fn upstream(&self) -> BTreeSet<String> {
        upstream(&self.nodes, &self.node)
    }

    pub(super) fn cameras(&self) -> Vec<NodeEntry> {
        let names = self.upstream();
        self.nodes.iter().filter(|node| is_camera(node) && names.contains(&node.name)).cloned().collect()
    }

    /// Pixels of the full picture, as far as the document says.
    pub(super) fn pixels(&self) -> f64 {
        let size = self.size.or_else(|| self.cameras().iter().find_map(size_of));
        size.map_or(786_432.0, |[width, height]| f64::from(width) * f64::from(height))
    }

    /// By how much the sides of the picture are divided where so many pixels are enough.
    pub(super) fn divisor_for(&self, enough: f64) -> u32 {
        (self.pixels() / enough).sqrt().ceil().max(1.0) as u32
    }

    /// True if the node takes negligible time: the rest of a run is drawing.
    pub(super) fn is_cheap(&self, name: &str) -> bool {
        const QUICK: [&str; 10] = [
            CAMERA,
            "transfer-function",
            "cull",
            "sort",
            "project",
            "composite",
            "renderer",
            "gpu-renderer",
            "slice-image",
            "annotation",
        ];
        let node = self.nodes.iter().find(|node| node.name == name);
        node.is_none_or(|node| node.node_type.text().is_some_and(|text| QUICK.contains(&text)))
    }

    /// The graph that makes the picture and nothing else; `divisor`: by how much its sides are divided.
    pub(super) fn graph(&self, registry: &Registry, divisor: u32) -> Result<Graph> {
        let mut nodes = feeding(&self.nodes, &self.node)?;
        let mut outputs = Vec::new();
        for node in &mut nodes {
            if is_camera(node) {
                resize(node, self.size, divisor)?;
            }
            if let Some(node_type) = registry.node_type(node).filter(|_| !node.name.contains('.')) {
                // Each with the input of its type.
                outputs.extend(
                    node_type
                        .outputs
                        .iter()
                        .map(|port| (port.port_type.name(), format!("{}.{}", node.name, port.name))),
                );
            }
        }
        nodes.push(NodeEntry::of_program(&WIRES, Vec::new(), outputs));
        Graph::build(&nodes, registry, self.folder.clone())
    }

    /// The time series of the readers that feed the picture. Errors: those of the nodes and their files.
    pub(crate) fn series(&self, registry: &Registry) -> Result<Series> {
        let mut registry = registry.clone();
        registry.add(&WIRES)?;
        Series::from_graph(&self.graph(&registry, 1)?)
    }

    pub(super) fn picture_of(&self, report: &RunReport) -> Result<Arc<Picture>> {
        let picture = report.pictures.iter().rev().find(|(node, _)| *node == self.node);
        picture.map(|(_, picture)| picture.clone()).ok_or_else(|| self.no_picture())
    }

    pub(super) fn no_picture(&self) -> Error {
        Error::run("the node gives no picture").at_node(&self.node)
    }
}

#[derive(Debug, Default, PartialEq)]
pub(super) struct Change {
    /// The nodes whose output is another, or is not needed any more.
    pub touched: BTreeSet<String>,
    /// True if a hand's movement makes all of them: settings of cameras and transfer functions, and of all nodes while it moves a grip.
    pub moves: bool,
}

impl Change {
    pub fn between(before: &RenderRequest, now: &RenderRequest) -> Change {
        let elsewhere = before.folder != now.folder;
        let needed = now.upstream();
        let is_other = |name: &String| elsewhere || find(&before.nodes, name) != find(&now.nodes, name);
        let touched = before
            .upstream()
            .into_iter()
            .filter(|name| !needed.contains(name) || upstream(&before.nodes, name).iter().any(is_other));
        let moves = !elsewhere
            && (&before.node, before.size, before.background) == (&now.node, now.size, now.background)
            && before.nodes.len() == now.nodes.len()
            && before.nodes.iter().zip(&now.nodes).all(|(a, b)| a == b || is_movement(a, b, now.grip_moves));
        Change { touched: touched.collect(), moves }
    }
}

fn find<'a>(nodes: &'a [NodeEntry], name: &str) -> Option<&'a NodeEntry> {
    nodes.iter().find(|node| node.name == name)
}

/// True if two states of a node differ in settings alone, and these are of a camera or a transfer function, or a grip is moved.
fn is_movement(before: &NodeEntry, now: &NodeEntry, grip_moves: bool) -> bool {
    let is_moved = ["camera", "transfer-function"].iter().any(|name| before.node_type.text() == Some(name));
    (is_moved || grip_moves) && NodeEntry { settings: now.settings.clone(), ..before.clone() } == *now
}

/// The nodes that feed one, and it; in the order of the document.
pub(super) fn feeding(nodes: &[NodeEntry], name: &str) -> Result<Vec<NodeEntry>> {
    match links::feeding(nodes, name) {
        none if none.is_empty() => {
            Err(Error::usage(format!("there is no node '{name}' to show the picture of")))
        }
        nodes => Ok(nodes),
    }
}

/// Leaves those widgets of a transfer function alone whose places `keeps` names.
pub(crate) fn retain_widgets(nodes: &mut [NodeEntry], look: &str, keeps: impl Fn(usize) -> bool) {
    let node = nodes.iter_mut().find(|node| node.name == look);
    let field = node.and_then(|node| node.settings.iter_mut().find(|field| field.name == "widgets"));
    if let Some(ParameterValue::List(list)) = field.map(|field| &mut field.setting.datum) {
        let mut place = 0..;
        list.retain(|_| place.next().is_some_and(&keeps));
    }
}

/// An output of a document's nodes that gives a volume.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VolumeSource {
    /// Nodes of the document, as of [`RenderRequest::nodes`].
    pub nodes: Vec<NodeEntry>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// `"node"` or `"node.port"`.
    pub output: String,
}

fn is_camera(node: &NodeEntry) -> bool {
    node.node_type.text() == Some(CAMERA)
}

/// Width and height that a camera node states.
pub(crate) fn size_of(node: &NodeEntry) -> Option<[u32; 2]> {
    let Some(stated) = node.setting(SIZE) else { return Some([1024, 768]) };
    match stated.array()? {
        [width, height] if width >= 1.0 && height >= 1.0 => Some([width as u32, height as u32]),
        _ => None,
    }
}

/// Gives a camera fewer pixels. A size that is wrong is left for the checker to find.
fn resize(node: &mut NodeEntry, size: Option<[u32; 2]>, divisor: u32) -> Result<()> {
    let Some(own) = size_of(node) else { return Ok(()) };
    let whole = size.unwrap_or(own);
    if whole == own && divisor == 1 {
        return Ok(());
    }
    let side = |side: u32| ParameterValue::Integer(i64::from(side.div_ceil(divisor).max(1)));
    node.set(SIZE, &[], whole.map(side).into_iter().collect::<ParameterValue>().into())?;
    if divisor > 1 && node.setting(SAMPLES).is_some() {
        node.set(SAMPLES, &[], ParameterValue::Integer(1).into())?;
    }
    Ok(())
}

const fn port(name: &'static str, port_type: PortType) -> Port {
    Port { name, port_type, summary: "what is looked at" }
}

/// The node, whose name no pipeline file can be meant to name. One input a type, each fed by any number of outputs. It asks for
/// nothing but arrays: what nobody else needs is not made for it.
pub(super) static WIRES: Node = Node {
    name: "(looks on)",
    summary: "Looks on.",
    optional_inputs: &[
        port("grid", PortType::Grid),
        port("volume", PortType::Volume),
        port("transfer-function", PortType::TransferFunction),
        port("camera", PortType::Camera),
        port("cells", PortType::Cells),
        port("projection", PortType::Projection),
        port("image", PortType::Image),
        port("report", PortType::Report),
        port("cell-values", PortType::CellValues),
        port("surface", PortType::Surface),
    ],
    parameters: &[Parameter {
        name: ARRAYS,
        parameter_type: ParameterType::Texts,
        unit: "",
        default: DefaultValue::Unset("no arrays"),
        help: "names of point arrays",
    }],
    demand: &|asking| {
        if !asking.parameters.is_set(ARRAYS) {
            return Ok(());
        }
        let arrays = asking.parameters.texts(ARRAYS)?.into_iter().collect();
        asking.ask("volume", &Demand { arrays, ..Demand::default() })
    },
    ..Node::BLANK
};

/// Parameter of the node: arrays that the volume is to have.
pub(super) const ARRAYS: &str = "arrays";

#[derive(Default)]
pub(super) struct Values {
    /// For each output, `"node.port"`, in words.
    pub words: BTreeMap<String, String>,
    /// Least and greatest coordinates of the data: of the first, and of each output.
    pub bounds: Option<[DVec3; 2]>,
    pub output_bounds: BTreeMap<String, [DVec3; 2]>,
}

/// Descriptions of the values on the wires, from the session's cache.
pub(super) fn wire_values(session: &mut Session, graph: &Graph) -> Option<Values> {
    let place = graph.nodes.iter().position(|node| node.node.name == WIRES.name)?;
    let (values, _) = session.feed(graph, place, &Demand::default(), &NoObserver).ok()?;
    let (mut seen, mut known) = (Values::default(), BTreeMap::new());
    for (edge, value) in graph.nodes[place].inputs.iter().zip(values) {
        let giving = &graph.nodes[edge.node];
        let output = format!("{}.{}", giving.name, giving.node.outputs[edge.output].name);
        seen.words.insert(output.clone(), describe(&value));
        let grid = match &value {
            Value::Grid(grid) => grid,
            Value::Volume(volume) => &volume.grid,
            _ => continue,
        };
        // Most outputs share their points; those of ghosts alone are not drawn.
        let points = (grid.points.as_ptr(), grid.drawn_points());
        let found = *known.entry(points).or_insert_with(|| grid.bounds());
        seen.bounds = seen.bounds.or(found);
        seen.output_bounds.extend(found.map(|found| (output, found)));
    }
    Some(seen)
}

fn describe(value: &Value) -> String {
    let grid = |grid: &Grid, s: Option<&[f64]>, g: Option<&[f64]>| {
        let ranges =
            [("s", s), ("g", g)].into_iter().filter_map(|(name, of)| Some((name, of.and_then(range)?)));
        let ranges = ranges.map(|(name, [low, high])| {
            let number = |x: f64| short_by(x, 1e-2 * (high - low));
            format!("\n{name} from {} to {}", number(low), number(high))
        });
        let count = |count: usize, noun| format!("{} {}", with_commas(count), noun_of(&count, noun));
        let (cells, points) =
            (count(grid.tetrahedra.len(), "tetrahedron"), count(grid.points.len(), "point"));
        format!("{cells}, {points}{}", ranges.collect::<String>())
    };
    let size = |picture: &Picture| format!("{} × {} pixels", picture.width, picture.height);
    match value {
        Value::Grid(of) => grid(of, of.scalar.as_deref(), None),
        Value::Volume(of) => grid(&of.grid, Some(&of.scalar), of.gradient_magnitude.as_deref()),
        Value::TransferFunction(look) => widget_count(look.transfer_function.widgets.len()),
        Value::Camera(camera) => format!("{} × {} pixels", camera.size[0], camera.size[1]),
        Value::Cells(_) => "cells that can contribute".into(),
        Value::Projection(_) => "projected cells".into(),
        Value::Image(picture) => size(picture),
        Value::PictureParts(parts) => size(&parts.picture),
        Value::Report(report) => format!("{} characters of JSON", report.len()),
        Value::Surface(surface) => counted(surface.triangles.len(), "triangle"),
        Value::InParts(port_type) => format!("{} in parts", port_type.name()),
        Value::CellValues(values) => match values.arrays.keys().cloned().collect::<Vec<_>>().join(", ") {
            names if names.is_empty() => "no arrays asked for".into(),
            names => names,
        },
    }
}

pub fn widget_count(count: usize) -> String {
    counted(count, "widget")
}

/// Four digits, as a person reads them.
pub fn short(x: f64) -> String {
    short_by(x, f64::INFINITY)
}

/// Four digits, or as many as tell numbers apart that differ by a step.
pub fn short_by(x: f64, step: f64) -> String {
    if !x.is_finite() {
        return x.to_string();
    }
    let (size, power) = (x.abs(), |x: f64| x.log10().floor() as i32);
    let needed =
        if step > 0.0 && step.is_finite() && size > step { power(size) - power(step) + 1 } else { 0 };
    let digits = needed.clamp(4, 17);
    let decimals = if size >= 1.0 { digits - 1 - power(size) } else { digits }.max(0) as usize;
    let most = if digits > 4 { 1e9 } else { 1e5 };
    let is_plain = x == 0.0 || (1e-3..most).contains(&size);
    let text = if is_plain { format!("{x:.decimals$}") } else { format!("{x:.*e}", digits as usize - 1) };
    let (digits, power) = text.split_at(text.find('e').unwrap_or(text.len()));
    without_zeros(digits).to_string() + power
}

/// A number without the zeros at the end of its fraction.
pub fn without_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// Steps of the table from linear to sRGB: finer than the steepest of 256 levels (12.92 × 255) by a factor of five.
const STEPS: usize = 1 << 14;

static SRGB: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let level = |i: usize| (srgb_from_linear(i as f32 / STEPS as f32) * 255.0).round() as u8;
    (0..=STEPS).map(level).collect()
});

/// A drawn picture.
#[derive(Debug, Clone)]
pub struct Pixels {
    /// As the engine gave it.
    pub picture: Arc<Picture>,
    /// 8-bit sRGB over the background, opaque.
    pub image: Arc<ColorImage>,
    /// Side of a pixel in pixels of the full picture; 1 for the full picture.
    pub divisor: u32,
    /// True if it is a preview from the engine's cache, which differs from the full picture by rounding.
    pub is_preview: bool,
    /// The number of the request that it was drawn for.
    pub number: u64,
    /// The node whose picture it is.
    pub node: String,
}

impl Pixels {
    pub(super) fn new(picture: Arc<Picture>, wanted: &RenderRequest, divisor: u32, number: u64) -> Pixels {
        let behind = wanted.background.map(|channel| channel as f32);
        let levels = SRGB.as_slice();
        // By way of 32 bits: a cast to 64 without a sign takes several instructions.
        let srgb = |v: f32| levels[(v.clamp(0.0, 1.0) * STEPS as f32 + 0.5) as i32 as usize];
        let colors: Vec<Color32> = picture
            .rgba
            .par_iter()
            .with_min_len(4096)
            .map(|&[r, g, b, a]| {
                let channel = |v: f32, k: usize| srgb(v + (1.0 - a) * behind[k]);
                Color32::from_rgb(channel(r, 0), channel(g, 1), channel(b, 2))
            })
            .collect();
        let image = Arc::new(ColorImage::new([picture.width, picture.height], colors));
        Pixels { picture, image, divisor, is_preview: false, number, node: wanted.node.clone() }
    }

    /// True if it is the picture that a run of the document gives.
    pub fn is_full(&self) -> bool {
        self.divisor == 1 && !self.is_preview
    }

    /// Width and height.
    pub fn size(&self) -> [usize; 2] {
        self.image.size
    }

    pub(super) fn count(&self) -> f64 {
        self.image.pixels.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::grid::GhostCells;

    fn over(background: [f64; 3]) -> RenderRequest {
        RenderRequest { background, ..RenderRequest::of_picture(Vec::new()) }
    }

    /// Within one level of what a PNG file of the picture holds.
    #[test]
    fn pixels_are_those_of_a_png() {
        let rgba: Vec<[f32; 4]> = (0..=1000).map(|i| [i as f32 / 1000.0, 0.0, 0.0, 1.0]).collect();
        let picture = Arc::new(Picture { width: 1001, height: 1, rgba });
        for (i, pixel) in Pixels::new(picture, &over([0.0; 3]), 1, 1).image.pixels.iter().enumerate() {
            let exact = srgb_from_linear(i as f32 / 1000.0) * 255.0;
            assert!((f32::from(pixel.r()) - exact).abs() <= 0.7, "{i}: {} for {exact}", pixel.r());
        }
    }

    /// Four points of a cell, and one of a ghost cell beside it.
    static WITH_GHOSTS: Node = Node {
        name: "with-ghosts",
        summary: "A cell and a ghost.",
        outputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid" }],
        demand: &|_| Ok(()),
        run: &|_| {
            let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, 9.0 * DVec3::ONE];
            let ghosts = GhostCells { tetrahedra: vec![[1, 2, 3, 4]], drawn_points: 4 };
            let (points, tetrahedra) = (points.into(), vec![[0, 1, 2, 3]].into());
            let grid = Grid { points, tetrahedra, ghosts: Some(Arc::new(ghosts)), ..Grid::default() };
            Ok(vec![Value::Grid(Arc::new(grid))])
        },
        ..Node::BLANK
    };

    /// The bounds are those by which pictures are cut.
    #[test]
    fn bounds_on_wires_are_those_of_the_points_that_are_drawn() {
        let mut registry = voltet_nodes::registry().unwrap();
        registry.add(&WITH_GHOSTS).unwrap();
        registry.add(&WIRES).unwrap();
        let nodes = [
            NodeEntry::of_program(&WITH_GHOSTS, Vec::new(), []),
            NodeEntry::of_program(&WIRES, Vec::new(), [("grid", "with-ghosts".to_string())]),
        ];
        let graph = Graph::build(&nodes, &registry, PathBuf::new()).unwrap();
        let values = wire_values(&mut voltet_nodes::session(), &graph).unwrap();
        assert_eq!(values.output_bounds["with-ghosts.grid"], [DVec3::ZERO, DVec3::ONE]);
    }

    #[test]
    fn numbers_have_four_digits_or_as_many_as_tell_them_apart() {
        let four =
            [(0.0, "0"), (0.01234, "0.0123"), (1.23456, "1.235"), (12345.0, "12345"), (1.5e6, "1.5e6")];
        for (x, text) in four {
            assert_eq!(short(x), text);
        }
        assert_eq!([101_325.01, 101_325.02].map(|x| short_by(x, 0.005)), ["101325.01", "101325.02"]);
        assert_eq!(short_by(0.5, 0.1), "0.5");
        assert_eq!(short_by(0.500_002, 1e-6), "0.500002");
        assert_eq!(short_by(-5e12 - 2.0, 1.0), "-5.000000000002e12");
        assert_eq!([f64::NAN, f64::INFINITY].map(|x| short_by(x, 0.1)), ["NaN", "inf"]);
    }

    #[test]
    fn the_background_shows_where_nothing_is_drawn() {
        let picture = Arc::new(Picture { width: 1, height: 1, rgba: vec![[0.0; 4]] });
        let pixels = Pixels::new(picture, &over([1.0, 0.0, 0.5]), 1, 1);
        assert_eq!(pixels.image.pixels, [Color32::from_rgb(255, 0, 188)]);
    }
}
