//! Gradient filters that are Python functions, and the registry of these and of readers.

use crate::memory::{Lent, array};
use glam::DVec3;
use pyo3::exceptions::{PyKeyboardInterrupt, PyTypeError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ffi::c_long;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::field::{Gradient, GradientFilter, Plugin};
use voltet_core::grid::Grid;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Parameters, Range, VariantSchema};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_graph::{Node, ParameterValue, Registry};

/// The filters and the nodes of readers that were registered, and how often that was done: one in place of another counts.
static FILTERS: Mutex<Vec<Arc<Function>>> = Mutex::new(Vec::new());
static NODES: Mutex<Vec<&'static Node>> = Mutex::new(Vec::new());
static REGISTERED: AtomicU64 = AtomicU64::new(0);

thread_local! {
    /// Exception of the last function on this thread.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
    /// The run that this thread does.
    static RUN: Cell<Option<Run>> = const { Cell::new(None) };
}

/// Python's numbers of the threads that are in a function, by the run that called it.
static CALLED: Mutex<BTreeMap<Run, c_long>> = Mutex::new(BTreeMap::new());

/// A run whose functions can be interrupted.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Run(u64);

impl Run {
    /// One like no other.
    pub fn new() -> Run {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Run(LAST.fetch_add(1, Ordering::Relaxed))
    }

    /// Says that this thread does it.
    pub fn is_here(self) {
        RUN.set(Some(self));
    }

    /// Raises KeyboardInterrupt in the function that it has called, if it is in one: where the function next does a step in Python.
    pub fn interrupt(self, py: Python<'_>) {
        if let Some(&thread) = CALLED.lock().unwrap_or_else(PoisonError::into_inner).get(&self) {
            let interrupt = py.get_type::<PyKeyboardInterrupt>();
            // SAFETY: this thread is attached to the interpreter, and the type lives; a number of no thread does nothing.
            unsafe { ffi::PyThreadState_SetAsyncExc(thread, interrupt.as_ptr()) };
        }
    }
}

/// Says while it lives which thread is in a function.
pub struct Called(Option<Run>);

impl Called {
    pub fn new(py: Python<'_>) -> PyResult<Called> {
        let (run, thread) = (RUN.get(), py.import("_thread")?.call_method0("get_ident")?.extract::<u64>()?);
        if let Some(run) = run {
            CALLED.lock().unwrap_or_else(PoisonError::into_inner).insert(run, thread as c_long);
        }
        Ok(Called(run))
    }
}

impl Drop for Called {
    fn drop(&mut self) {
        if let Some(run) = self.0 {
            CALLED.lock().unwrap_or_else(PoisonError::into_inner).remove(&run);
        }
    }
}

/// A Python function that computes ∇s.
struct Function {
    kind: VariantSchema,
    plugin: Plugin,
    /// Names of point arrays that it reads.
    arrays: Vec<String>,
    /// `voltet._filters.Filter`: called with numpy arrays, gives one.
    call: Py<PyAny>,
}

/// The node types and filters that ship, and those of Python.
pub fn registry() -> Result<Registry> {
    let mut registry = own_registry()?;
    for filter in FILTERS.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        registry.add_filter(filter.clone())?;
    }
    // Of two readers of one kind of file the newer one is asked first.
    for node in NODES.lock().unwrap_or_else(PoisonError::into_inner).iter().rev() {
        registry.add(node)?;
    }
    Ok(registry)
}

/// Changes when a function is registered.
pub fn epoch() -> u64 {
    REGISTERED.load(Ordering::Acquire)
}

/// Exception of the last function on this thread, once.
pub fn raised() -> Option<PyErr> {
    RAISED.take()
}

/// Registers a function, in place of a former one of this name.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn register_filter(
    py: Python<'_>,
    name: String,
    summary: String,
    parameters: Vec<Bound<'_, PyDict>>,
    file: PathBuf,
    source: String,
    arrays: Vec<String>,
    call: Py<PyAny>,
) -> PyResult<()> {
    let kind = schema(name, summary, &parameters)?;
    let filter = Arc::new(Function { kind, plugin: plugin(file, &source), arrays, call });
    crate::error::guarded(py, || {
        // What contradicts itself, or has the name of one that ships, is refused here.
        let mut registry = own_registry()?;
        registry.add_filter(filter.clone())?;
        let mut filters = FILTERS.lock().unwrap_or_else(PoisonError::into_inner);
        let (former, mut kept): (Vec<_>, Vec<_>) =
            filters.drain(..).partition(|known| known.kind.name == filter.kind.name);
        kept.push(filter);
        *filters = kept;
        drop(filters);
        REGISTERED.fetch_add(1, Ordering::AcqRel);
        // Freed without the lock, and once it is no longer in use: what it leads to may be code in Python, which other threads wait for.
        drop(former);
        Ok(())
    })
}

/// Registers the node of a function, in place of a former one of this name.
pub fn register_node(node: &'static Node) -> Result<()> {
    own_registry()?.add(node)?;
    let mut nodes = NODES.lock().unwrap_or_else(PoisonError::into_inner);
    nodes.retain(|known| known.name != node.name);
    nodes.push(node);
    REGISTERED.fetch_add(1, Ordering::AcqRel);
    Ok(())
}

/// Declaration of a function; it lives as long as the program. `parameters`: what `voltet.Parameter.declared` gives.
pub fn schema(name: String, summary: String, parameters: &[Bound<'_, PyDict>]) -> PyResult<VariantSchema> {
    let parameters = parameters.iter().map(parameter).collect::<PyResult<Vec<Parameter>>>()?;
    Ok(VariantSchema { name: name.leak(), summary: summary.leak(), parameters: parameters.leak() })
}

/// Plug-in that stands for a function. `source` is its text, as far as there is one, by which pictures tell it from others.
pub fn plugin(file: PathBuf, source: &str) -> Plugin {
    let mut hash = voltet_nodes::files::Fnv::default();
    hash.text(source);
    Plugin {
        name: "Python".into(),
        version: Python::version_str().split(' ').next().unwrap_or_default().into(),
        path: file,
        bytes: source.len() as u64,
        fingerprint: hash.0 as u64,
        modified: None,
    }
}

/// The parameters of a function, as keyword arguments.
pub fn keywords<'py>(
    py: Python<'py>,
    kind: VariantSchema,
    parameters: &Parameters,
) -> PyResult<Bound<'py, PyDict>> {
    let set = PyDict::new(py);
    for parameter in kind.parameters {
        if let Some(setting) = parameters.optional(parameter.name) {
            set.set_item(parameter.name, crate::value::object(py, &setting.datum)?)?;
        }
    }
    Ok(set)
}

/// Calls Python for a function, attached to the interpreter; an exception becomes an error, and the cause of the one that the run
/// raises. `subject`: "the reader 'x'".
pub fn attached<T>(subject: &str, work: impl FnOnce(Python<'_>) -> PyResult<T>) -> Result<T> {
    Python::attach(|py| {
        work(py).map_err(|raised| {
            let error = own_error(subject, raised.value(py)).unwrap_or_else(|_| {
                Error::run(format!("{subject} raised an exception")).got(raised.to_string())
            });
            RAISED.set(Some(raised));
            error
        })
    })
}

/// Error of a `voltet.Error`: what is wrong with what a function gave.
///
/// Errors: it is another exception.
fn own_error(subject: &str, raised: &Bound<'_, PyAny>) -> PyResult<Error> {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    if !raised.is_instance(CLASS.import(raised.py(), "voltet._errors", "Error")?)? {
        return Err(PyTypeError::new_err("not of the package"));
    }
    let text = |name: &str| raised.getattr(name)?.extract::<Option<String>>();
    let mut error = Error::run(format!("{subject}: {}", text("what")?.unwrap_or_default()));
    (error.got, error.expected) = (text("found")?, text("expected")?);
    Ok(match text("item")? {
        Some(item) => error.at_item(item),
        None => error,
    })
}

/// A parameter as `voltet.Parameter.declared` gives it.
fn parameter(declared: &Bound<'_, PyDict>) -> PyResult<Parameter> {
    let get = |key: &str| declared.get_item(key).map(|found| found.filter(|value| !value.is_none()));
    let text = |key: &str| -> PyResult<&'static str> {
        Ok(get(key)?.map(|value| value.extract::<String>()).transpose()?.unwrap_or_default().leak())
    };
    let mut range = Range::ANY;
    if let Some(limits) = get("range")? {
        let [low, high] = limits.extract::<[Option<f64>; 2]>()?;
        (range.min, range.max) = (low.unwrap_or(range.min), high.unwrap_or(range.max));
    }
    let parameter_type = match text("type")? {
        "boolean" => ParameterType::Boolean,
        "integer" => ParameterType::Integer(range),
        "choice" => {
            let words = get("choices")?.map(|words| words.extract::<Vec<String>>()).transpose()?;
            let words = words.unwrap_or_default().into_iter();
            let words: Vec<(&'static str, &'static str)> = words.map(|word| (&*word.leak(), "")).collect();
            ParameterType::Choice(words.leak())
        }
        "text" => ParameterType::Text,
        _ => ParameterType::Number(range),
    };
    let default = get("default")?.map(|value| crate::value::datum(&value)).transpose()?;
    let standard = match default {
        None => DefaultValue::Required,
        Some(ParameterValue::Boolean(flag)) => DefaultValue::Boolean(flag),
        Some(ParameterValue::Integer(n)) if matches!(parameter_type, ParameterType::Number(_)) => {
            DefaultValue::Number(n as f64)
        }
        Some(ParameterValue::Integer(n)) => DefaultValue::Integer(n),
        Some(ParameterValue::Number(x)) => DefaultValue::Number(x),
        Some(ParameterValue::Text(text)) => DefaultValue::Text(text.leak()),
        Some(ParameterValue::List(_) | ParameterValue::Table(_)) => {
            let error = Error::usage("the default of a filter's parameter is a list or a table");
            let error = error.expected("a bool, a number or a text");
            return Err(crate::error::exception(declared.py(), &error));
        }
    };
    Ok(Parameter {
        name: text("name")?,
        parameter_type,
        unit: text("unit")?,
        default: standard,
        help: text("help")?,
    })
}

impl Function {
    /// Calls the function with arrays of its own, and takes what it gives; the inner error is that of another array than a gradient.
    fn call(
        &self,
        py: Python<'_>,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
    ) -> PyResult<Result<Vec<DVec3>>> {
        let (points, tetrahedra) = (&grid.points, &grid.tetrahedra);
        let points = array(py, "f8", points, &[points.len(), 3])?;
        let tetrahedra = array(py, "u4", tetrahedra, &[tetrahedra.len(), 4])?;
        let values = array(py, "f8", scalar, &[scalar.len()])?;
        let arrays = PyDict::new(py);
        for name in &self.arrays {
            if let Some(found) = grid.point_arrays.get(name) {
                let shape = match found.component_count {
                    1 => vec![scalar.len()],
                    n => vec![scalar.len(), n],
                };
                arrays.set_item(name, array(py, "f8", &found.values, &shape)?)?;
            }
        }
        let set = keywords(py, self.kind, parameters)?;
        let given = {
            let _called = Called::new(py)?;
            self.call.call1(py, (points, tetrahedra, values, arrays, set))?
        };
        let given = given.bind(py);
        let (shape, dtype) = (given.getattr("shape")?, given.getattr("dtype")?.to_string());
        let count = scalar.len();
        if dtype != "float64" || shape.extract::<Vec<usize>>()? != [count, 3] {
            let error = Error::run(format!("the gradient filter '{}' gave no gradient", self.kind.name));
            let expected = format!("({count}, 3), real numbers: the gradient at every point");
            return Ok(Err(error.got(format!("shape {shape}, dtype {dtype}")).expected(expected)));
        }
        let given: Lent<f64> = Lent::borrow("the gradient", given)?;
        Ok(Ok(given.values().chunks_exact(3).map(DVec3::from_slice).collect()))
    }
}

impl GradientFilter for Function {
    fn declaration(&self) -> VariantSchema {
        self.kind
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(&self.plugin)
    }

    fn arrays(&self, _: &Parameters) -> Result<Vec<String>> {
        Ok(self.arrays.clone())
    }

    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient> {
        progress.report("gradient", 0.0);
        let subject = format!("the gradient filter '{}'", self.kind.name);
        let vectors = attached(&subject, |py| self.call(py, grid, scalar, parameters))??;
        Ok(Gradient { vectors, fallbacks: Vec::new() })
    }
}

/// Nodes, gradient filters and integrators that ship, the reference integrator and those for studies.
fn own_registry() -> Result<Registry> {
    let mut registry = voltet_nodes::registry()?;
    voltet_reference::register(&mut registry)?;
    voltet_integrators::register(&mut registry)?;
    Ok(registry)
}
