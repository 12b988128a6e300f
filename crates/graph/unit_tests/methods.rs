//! Gradient filters that a node names: their parameters beside its own, what they read, and what is refused.

use super::*;
use voltet_core::SharedSlice;
use voltet_core::field::{Gradient, GradientFilter, Plugin};
use voltet_core::grid::Array;
use voltet_core::grid::generate::{box_of_tetrahedra, with_scalar};
use voltet_core::progress::Progress;

/// A unit cube with s = x, and the arrays that somebody asked for, each of ones.
const CUBE: Node = Node {
    name: "cube",
    summary: "Gives a cube.",
    outputs: &[port("grid", PortType::Grid)],
    demand: &|_| Ok(()),
    run: &|call| {
        count("cube");
        let mut grid =
            with_scalar(box_of_tetrahedra([2, 2, 2], [DVec3::ZERO, DVec3::ONE], 0.0), "s", |p| p.x);
        for name in &call.demand.arrays.named {
            let array = Array { component_count: 1, values: vec![1.0; grid.points.len()].into() };
            grid.point_arrays.insert(name.to_string(), Arc::new(array));
        }
        Ok(vec![Value::Grid(Arc::new(grid))])
    },
    ..Node::BLANK
};

const SLOPE: Node = Node {
    name: "slope",
    summary: "Gives a volume with g.",
    inputs: &[port("grid", PortType::Grid)],
    outputs: &[port("volume", PortType::Volume)],
    parameters: &[
        Parameter {
            parameter_type: ParameterType::GradientFilter,
            ..number("method", DefaultValue::Text("plain"))
        },
        number("limit", DefaultValue::Number(100.0)),
    ],
    demand: &|asking| {
        let arrays = asking.method()?.arrays()?.into_iter().collect();
        asking.ask("grid", &Demand { arrays, ..Demand::default() })
    },
    run: &|call| {
        count("slope");
        let mut volume = Volume::clone(&*call.volume("grid")?);
        let found = call.method()?.gradient(&volume.grid, &volume.scalar, call.progress())?;
        volume.gradient_magnitude =
            Some(SharedSlice::from(found.vectors.iter().map(|v| v.length()).collect::<Vec<_>>()));
        Ok(vec![Value::Volume(Arc::new(volume))])
    },
    ..Node::BLANK
};

thread_local! {
    /// g at the first point, as the last run found it.
    static FOUND: RefCell<f64> = const { RefCell::new(0.0) };
}

const SINK: Node = Node {
    name: "sink",
    summary: "Takes a volume.",
    inputs: &[port("volume", PortType::Volume)],
    run: &|call| {
        let volume = call.volume("volume")?;
        FOUND.with_borrow_mut(|found| *found = volume.gradient_magnitude.as_ref().map_or(0.0, |g| g[0]));
        Ok(Vec::new())
    },
    ..Node::BLANK
};

/// Gives (1, 0, 0) everywhere.
struct Plain;

impl GradientFilter for Plain {
    fn declaration(&self) -> VariantSchema {
        VariantSchema { name: "plain", summary: "One along x.", parameters: &[] }
    }

    fn gradient(&self, grid: &Grid, _: &[f64], _: &Parameters, _: &dyn Progress) -> Result<Gradient> {
        Ok(Gradient { vectors: vec![DVec3::X; grid.points.len()], fallbacks: Vec::new() })
    }
}

/// Declared as a plug-in does that is loaded at run time: its texts are made while the program runs.
struct Loaded {
    declaration: VariantSchema,
}

impl Loaded {
    fn new(name: &str, factor: &str) -> Self {
        let factor = number(factor.to_string().leak(), DefaultValue::Number(2.0));
        let weights = Parameter {
            parameter_type: ParameterType::Text,
            ..number("weights", DefaultValue::Unset("none"))
        };
        let parameters = vec![factor, weights].leak();
        Loaded {
            declaration: VariantSchema {
                name: name.to_string().leak(),
                summary: "A factor along x.",
                parameters,
            },
        }
    }
}

impl GradientFilter for Loaded {
    fn declaration(&self) -> VariantSchema {
        self.declaration
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        match parameters.number(self.declaration.parameters[0].name)? {
            13.0 => Err(parameters.error("factor", "13 is unlucky")),
            _ => Ok(()),
        }
    }

    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(parameters.optional("weights").and_then(|s| s.text()).map(str::to_string).into_iter().collect())
    }

    fn gradient(&self, grid: &Grid, _: &[f64], p: &Parameters, _: &dyn Progress) -> Result<Gradient> {
        let factor = p.number("factor")?;
        let weight = |name: &str| grid.point_arrays[name].values[0];
        let weight = p.optional("weights").and_then(|s| s.text()).map_or(10.0, weight);
        Ok(Gradient { vectors: vec![DVec3::X * (factor * weight); grid.points.len()], fallbacks: Vec::new() })
    }
}

fn registry() -> Registry {
    let mut registry = Registry::new();
    [&CUBE, &SLOPE, &SINK].iter().try_for_each(|node| registry.add(node)).unwrap();
    registry.add_filter(Arc::new(Plain)).unwrap();
    registry.add_filter(Arc::new(Loaded::new("loaded", "factor"))).unwrap();
    registry
}

/// A pipeline with these keys of a slope node.
fn text(keys: &str) -> String {
    format!(
        "[pipeline]\nformat = 1\n[nodes.cube]\ntype = \"cube\"\n[nodes.slope]\ntype = \"slope\"\n\
         inputs = {{ grid = \"cube\" }}\n{keys}\n[nodes.sink]\ntype = \"sink\"\ninputs = {{ volume = \"slope\" }}\n"
    )
}

/// Its graph.
fn graph(keys: &str) -> Result<Graph> {
    let text = text(keys);
    let graph = Pipeline::parse(&text)?.graph(&registry(), PathBuf::new());
    graph.map_err(|error| pipeline::locate(error, &text, "f".as_ref()))
}

/// g at the first point, and which nodes ran.
fn run(session: &mut Session, keys: &str) -> (f64, Vec<(&'static str, usize)>) {
    session.run(&graph(keys).unwrap(), &NoObserver).unwrap();
    (FOUND.with_borrow(|found| *found), runs())
}

#[test]
fn a_filter_s_parameters_stand_beside_the_node_s_and_a_change_runs_it_again() {
    let mut session = session();
    let slope = [("slope", 1)];
    assert_eq!(run(&mut session, "limit = 3").0, 1.0);
    assert_eq!(run(&mut session, "method = \"loaded\""), (20.0, slope.to_vec()));
    assert_eq!(run(&mut session, "method = \"loaded\"\nfactor = 3\nlimit = 3"), (30.0, slope.to_vec()));
    assert_eq!(run(&mut session, "limit = 3\nfactor = 3\nmethod = \"loaded\"").1, []);
    let built = graph("method = \"loaded\"\nfactor = 3").unwrap();
    let parameters = &built.node("slope").unwrap().parameters;
    let shown: Vec<(&str, bool)> = parameters.iter().map(|(p, _, given)| (p.name, given)).collect();
    assert_eq!(shown, [("method", true), ("limit", false), ("factor", true), ("weights", false)]);
}

/// A filter of a plug-in, of which there are several versions: gives (version, 0, 0) everywhere.
struct OfPlugin(Plugin);

impl GradientFilter for OfPlugin {
    fn declaration(&self) -> VariantSchema {
        VariantSchema { name: "foreign", summary: "Its version along x.", parameters: &[] }
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(&self.0)
    }

    fn gradient(&self, grid: &Grid, _: &[f64], _: &Parameters, _: &dyn Progress) -> Result<Gradient> {
        let version: f64 = self.0.version.parse().unwrap();
        Ok(Gradient { vectors: vec![DVec3::X * version; grid.points.len()], fallbacks: Vec::new() })
    }
}

#[test]
fn another_plugin_of_the_same_name_is_run_and_named() {
    let mut session = session();
    let mut found = |version: &str, bytes: u64| {
        let mut registry = registry();
        let (name, version, path) = ("plug-in".to_string(), version.to_string(), "filter.so".into());
        let plugin = Plugin { name, version, path, bytes, fingerprint: 0, modified: None };
        registry.add_filter(Arc::new(OfPlugin(plugin.clone()))).unwrap();
        let text = text("method = \"foreign\"");
        let graph = Pipeline::parse(&text).unwrap().graph(&registry, PathBuf::new()).unwrap();
        let report = session.run(&graph, &NoObserver).unwrap();
        assert_eq!(report.origins.plugins, [("slope".to_string(), plugin)]);
        (FOUND.with_borrow(|found| *found), runs())
    };
    assert_eq!(found("1", 10), (1.0, vec![("cube", 1), ("slope", 1)]));
    assert_eq!(found("1", 10).1, []);
    assert_eq!(found("2", 10), (2.0, vec![("slope", 1)]));
    assert_eq!(found("2", 11), (2.0, vec![("slope", 1)]));
}

#[test]
fn the_arrays_that_a_filter_reads_are_asked_for() {
    let mut session = session();
    assert_eq!(run(&mut session, "method = \"loaded\"\nweights = \"w\"").0, 2.0);
    assert_eq!(run(&mut session, "method = \"loaded\"\nweights = \"v\"").1, [("cube", 1), ("slope", 1)]);
}

#[test]
fn mistakes_in_a_filter_s_parameters_are_placed() {
    for (keys, wanted) in [
        ("method = 3", "'method' is of the wrong type: found 3; expected name of a gradient filter (f:8:10"),
        ("method = \"load\"", "unknown gradient filter 'load'; expected 'loaded', the nearest name"),
        (
            "method = \"plain\"\nfactor = 3",
            "the method \"plain\" has no parameter 'factor'; expected no parameter beside it; factor goes with \
             method = \"loaded\" (f:9:1",
        ),
        ("factor = 3", "the method \"plain\" has no parameter 'factor'"),
        (
            "method = \"loaded\"\nfaktor = 3",
            "has no parameter 'faktor'; expected 'factor', the nearest name, or one of factor, weights (f:9:1",
        ),
        ("method = \"loaded\"\nlimt = 3", "unknown parameter 'limt'; expected 'limit', the nearest name"),
        (
            "method = \"loaded\"\nfactor = -1",
            "'factor' is out of range: found -1; expected number 0 or more (m) (f:9:10",
        ),
        ("method = \"loaded\"\nfactor = 13", "13 is unlucky (f:9:10"),
    ] {
        let message = graph(keys).unwrap_err().to_string();
        assert!(message.contains(wanted), "{keys}: {message}");
    }
}

#[test]
fn the_registry_refuses_filters_that_contradict_others() {
    let mut registry = registry();
    let mut refused = |name: &str, factor: &str| {
        registry.add_filter(Arc::new(Loaded::new(name, factor))).unwrap_err().to_string()
    };
    assert!(refused("plain", "factor").contains("there is a gradient filter 'plain' already"));
    assert!(refused("twice", "weights").contains("declares 'weights' twice"));
    assert!(refused("typed", "type").contains("declares 'type' twice"));
    assert!(refused("", "factor").contains("needs a name"));
    let shared =
        "the gradient filter 'other' declares a parameter that the node type 'slope' has: found limit";
    assert!(refused("other", "limit").contains(shared));
    let mut turned = Registry::new();
    turned.add_filter(Arc::new(Loaded::new("other", "limit"))).unwrap();
    assert!(turned.add(&SLOPE).unwrap_err().to_string().contains(shared));
}
