//! The interface of `include/voltet_plugin.h` in a sandbox: WebAssembly modules of 32-bit addresses. They see
//! their inputs and the functions of the host, and nothing else: no files, no network, no clock. Each call starts a fresh module.

mod sandbox;

use crate::call::{CallOutput, GradientTask, Outcome, Rows64, Task};
use crate::declaration::{Declaration, Family};
use crate::ffi::{AddressSpace, CheckResult, GUARD_COUNT, Overrun, UNSET, ValidationError, remove_guard};
use crate::file::PluginFile;
use crate::host::{CallLabel, CallStatus, State};
use crate::interface::{self, GRADIENT_FILTERS};
use crate::item::{PluginItem, Runner};
use crate::library::{check_filter_count, file_name, load_error, read_entry, refuse_same_names};
use crate::values::ParameterValues;
use crate::{declaration, guard};
use sandbox::{Guest, GuestArgs, RunningModule, Sandbox, Stop, message};
use std::ffi::CString;
use std::mem::offset_of;
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::glam::DVec3;
use voltet_core::grid::Array;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use wasmtime::TypedFunc;

/// The gradient filters of a module.
///
/// Errors: no module, not of the interface, or what it declares is wrong.
pub(crate) fn load(file: &PluginFile) -> Result<Vec<PluginItem>> {
    let path = file.path();
    let nameless = Plugin { name: file_name(path), ..file.plugin() };
    let failed = |wrong: ValidationError| load_error(path, wrong);
    let sandbox = Arc::new(Sandbox::new(&file.bytes).map_err(failed)?);
    let (stop, start) = (sandbox.stop(), Instant::now());
    let work = {
        let (sandbox, stop) = (sandbox.clone(), stop.clone());
        move || declarations(&sandbox, &stop)
    };
    let is_over = || start.elapsed() > START_TIME_LIMIT;
    let may_go_on = || {
        if is_over() {
            stop.stop();
        }
        true
    };
    let described = guard::run(work, may_go_on).unwrap_or_else(|_| Err("there is no thread for it".into()));
    let ([name, version], declarations) = described.map_err(|wrong| match is_over() {
        true => failed(format!("it did not begin within {} s", START_TIME_LIMIT.as_secs())),
        false => failed(wrong),
    })?;
    let plugin = Plugin { name, version, ..nameless };
    let names = declarations.iter().map(|declaration| declaration.schema.name).collect();
    let runner = Arc::new(SandboxRunner { sandbox, plugin, names });
    Ok(PluginItem::list(runner, declarations))
}

/// Longest time to load and to describe itself.
const START_TIME_LIMIT: Duration = Duration::from_secs(20);

const CALL_TIME_LIMIT: Duration = Duration::from_secs(600);

const CHECK_TIME_LIMIT: Duration = Duration::from_secs(3);

/// Runner of a module; the filters by their indices.
pub(super) struct SandboxRunner {
    sandbox: Arc<Sandbox>,
    plugin: Plugin,
    names: Vec<&'static str>,
}

impl Runner for SandboxRunner {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(&self, declaration: &Declaration, task: Task, progress: &dyn Progress) -> Result<CallOutput> {
        let label = CallLabel::new(declaration, &self.plugin);
        let failed = |wrong: ValidationError| label.error("failed in its sandbox").got(wrong);
        let (state, start) = (Arc::<State>::default(), Instant::now());
        let is_check = matches!(task, Task::Check(_));
        let (time_limit, max_memory_bytes) =
            if is_check { (CHECK_TIME_LIMIT, None) } else { (CALL_TIME_LIMIT, progress.memory_left()) };
        let (sandbox, stop) = (self.sandbox.clone(), self.sandbox.stop());
        let name = declaration.schema.name;
        let index = self.names.iter().position(|known| *known == name).unwrap_or(0) as u32;
        let (family, call_state, call_stop) = (declaration.family, state.clone(), stop.clone());
        let work = move || {
            let mut running = sandbox.start(&call_state, &call_stop, max_memory_bytes)?;
            let module = initialize(&mut running, &call_state)?;
            let filter = module.filter(&mut running, index)?;
            call(&mut running, &task, family, filter, module.host, &call_state)
        };
        let is_over = || !is_check && progress.cancelled() || start.elapsed() > time_limit;
        let mut stopped = false;
        let may_go_on = || {
            if !is_check {
                progress.report("gradient", state.fraction());
                if progress.cancelled() {
                    state.cancel();
                }
            }
            stopped |= is_over();
            if stopped {
                stop.stop();
            }
            true
        };
        let outcome = guard::run(work, may_go_on)
            .map_err(|_| label.error("cannot be run: the system gives no thread for it"))?;
        outcome.map_err(|wrong| match is_over() {
            true if !is_check && progress.cancelled() => Error::cancelled(),
            true => {
                let expected = format!("an end within {} s", time_limit.as_secs());
                label.error("was stopped").got("no end").expected(expected)
            }
            false => failed(wrong),
        })
    }
}

/// Calls the function of a filter. A module declares gradient filters alone, so that other tasks give no output.
fn call(
    running: &mut RunningModule,
    task: &Task,
    family: Family,
    filter: u32,
    host: u32,
    state: &State,
) -> CheckResult<CallOutput> {
    let mut arguments = GuestArgs::behind(running.memory, &running.store);
    let [check, gradient] = functions(running, filter)?;
    let (name, function, inputs, output) = match (task, family) {
        (Task::Check(values), _) => ("check", check, put_values(values, &mut arguments), None),
        (Task::Gradient(task), Family::GradientFilter { needs }) => {
            let (inputs, vectors) = put_call(task, needs, &mut arguments);
            ("gradient", gradient, inputs, Some((vectors, task.grid.points.len())))
        }
        _ => return Ok(Default::default()),
    };
    let function = function.ok_or_else(|| format!("its function '{name}' is gone"))?;
    let constant = arguments.write_to(running.memory, &mut running.store);
    let constant = constant.ok_or("there is no memory for its inputs: a module has 4 GiB at most")?;
    let code = function.call(&mut running.store, (inputs, host)).map_err(|error| message(&error))?;
    constant.refuse_changes(running.guest(), state);
    let status = CallStatus::new(code, state);
    let Some((vectors, count)) = output else { return Ok((status, Outcome::Nothing)) };
    let mut vectors: Vec<DVec3> = running.guest().values(vectors, count + GUARD_COUNT)?;
    let overrun = remove_guard::<_, f64>(&mut vectors, count).then(|| Overrun::gradient(count));
    Ok((CallStatus { overrun, ..status }, Outcome::Vectors(vectors)))
}

/// Appends `voltet_values`; returns its address.
fn put_values(values: &ParameterValues, arguments: &mut GuestArgs) -> u32 {
    let ParameterValues { integers, numbers, texts, vectors } = values;
    let lengths: Vec<u32> = vectors.iter().map(|v| v.as_ref().map_or(0, |v| v.len() as u32)).collect();
    let count = integers.len() as u32;
    const NAME: &str = "the values of its parameters";
    let (integers, numbers) = (arguments.input(NAME, integers), arguments.input(NAME, numbers));
    let text = |text: &Option<CString>| {
        text.as_ref().map_or(0, |text| arguments.input(NAME, text.as_bytes_with_nul()))
    };
    let texts: Vec<u32> = texts.iter().map(text).collect();
    let texts = arguments.put(&texts);
    let vector =
        |vector: &Option<Vec<f64>>| vector.as_ref().map_or(0, |vector| arguments.input(NAME, vector));
    let vectors: Vec<u32> = vectors.iter().map(vector).collect();
    let (vectors, lengths) = (arguments.put(&vectors), arguments.put(&lengths));
    arguments.put(&[28, count, integers, numbers, texts, vectors, lengths])
}

/// Size of `voltet_call` in a module (bytes): behind its head pointers of 4 bytes, up to a multiple of its largest number.
const CALL_BYTES: usize = {
    let head = offset_of!(interface::GradientCall, points);
    let pointers = (size_of::<interface::GradientCall>() - head) / size_of::<usize>();
    (head + 4 * pointers).next_multiple_of(size_of::<u64>())
};

/// Appends `voltet_call`; returns its address and that of the gradient.
fn put_call(task: &GradientTask, needs: u32, arguments: &mut GuestArgs) -> (u32, u32) {
    let mut put = |name, table: Option<Rows64>| match table {
        Some((starts, items)) => [arguments.input(name, &starts), arguments.input(name, &items)],
        None => [0; 2],
    };
    let tables = task.tables(needs);
    let neighbours = put("the neighbours of points", tables.neighbours);
    let cells_of_points = put("the cells of points", tables.cells_of_points);
    let second_rings = put("the second rings of points", tables.second_rings);
    let at_boundary =
        tables.at_boundary.map_or(0, |flags| arguments.input("the flags of the boundary", &flags));
    let points = arguments.input("the points", &task.grid.points);
    let cells = arguments.input("the cells", &task.grid.tetrahedra);
    let scalar = arguments.input("the values of the scalar", &task.scalar);
    let array = |array: &Option<Arc<Array>>| {
        let values = array.as_ref().map(|array| &array.values);
        values.map_or(0, |values| arguments.input("the arrays that its parameters name", values))
    };
    let arrays: Vec<u32> = task.arrays.iter().map(array).collect();
    let arrays = arguments.put(&arrays);
    let values = put_values(&task.values, arguments);
    let out = arguments.put(&vec![DVec3::splat(UNSET); task.grid.points.len() + GUARD_COUNT]);
    let [points_low, points_high] = halves(task.grid.points.len());
    let [cells_low, cells_high] = halves(task.grid.tetrahedra.len());
    let [[starts, items], [cell_starts, cell_items]] = [neighbours, cells_of_points];
    let mut call = vec![CALL_BYTES as u32, 0, points_low, points_high, cells_low, cells_high, points, cells];
    call.extend([starts, items, cell_starts, cell_items, scalar, arrays, values, out, at_boundary]);
    call.extend(second_rings);
    call.resize(CALL_BYTES / 4, 0);
    (arguments.put(&call), out)
}

/// A number of 64 bits as two, the low one first.
fn halves(count: usize) -> [u32; 2] {
    [count as u32, (count as u64 >> 32) as u32]
}

/// Name and version, and the filters in their order.
fn declarations(sandbox: &Sandbox, stop: &Stop) -> CheckResult<([String; 2], Vec<Declaration>)> {
    let state = Arc::default();
    let mut running = sandbox.start(&state, stop, None)?;
    let module = initialize(&mut running, &state)?;
    let names = declaration::plugin(running.guest(), module.plugin)?;
    let mut filters: Vec<Declaration> = Vec::new();
    for place in 0..module.count {
        let at = |wrong: ValidationError| format!("filter {place}: {wrong}");
        let address = module.filter(&mut running, place).map_err(at)?;
        filters.push(declaration::gradient_filter(running.guest(), address).map_err(at)?.0);
        functions(&mut running, address).map_err(at)?;
    }
    refuse_same_names(&filters)?;
    Ok((names, filters))
}

/// A function of a filter: of values or a call, and the host.
type FilterFunction = TypedFunc<(u32, u32), i32>;

/// The functions of the filter at an address: its check, and its gradient.
fn functions(running: &mut RunningModule, address: u32) -> CheckResult<[Option<FilterFunction>; 2]> {
    let (read, _) = running.guest().sized::<interface::GradientFilter<Guest>>(address)?;
    let (check, gradient) = (read.item.check, read.gradient);
    Ok([running.function("check", check)?, running.function("gradient", gradient)?])
}

/// A module after init.
struct InitializedModule {
    plugin: u32,
    count: u32,
    filter: TypedFunc<u32, u32>,
    /// Address of the host's struct.
    pub host: u32,
}

impl InitializedModule {
    /// Address of a filter's description.
    pub fn filter(&self, running: &mut RunningModule, place: u32) -> CheckResult<u32> {
        self.filter.call(&mut running.store, place).map_err(|error| message(&error))
    }
}

/// Calls init, and requests the factory of filters.
fn initialize(running: &mut RunningModule, state: &State) -> CheckResult<InitializedModule> {
    let missing = |name: &str| format!("the function '{name}' is a null pointer");
    let address = running.entry()?;
    let entry = read_entry(running.guest(), address)?;
    let (init, get_factory) = (entry.init, entry.get_factory);
    let init = running.function::<(u32, u32), u32>("init", init)?.ok_or_else(|| missing("init"))?;
    let get_factory = running.function::<u32, u32>("get_factory", get_factory)?;
    let get_factory = get_factory.ok_or_else(|| missing("get_factory"))?;
    let mut arguments = GuestArgs::behind(running.memory, &running.store);
    // The path of the file is not disclosed to a sandbox.
    let path = arguments.text(b"");
    let kind = arguments.text(GRADIENT_FILTERS.to_bytes());
    let host = running.host(&mut arguments);
    arguments.write_to(running.memory, &mut running.store).ok_or("its memory cannot grow")?;
    let plugin = init.call(&mut running.store, (path, host)).map_err(|error| message(&error))?;
    if plugin == 0 {
        return Err(state.init_failure());
    }
    let factory = get_factory.call(&mut running.store, kind).map_err(|error| message(&error))?;
    if factory == 0 {
        return Err("it has no gradient filters (get_factory gave nothing), and a sandbox runs these alone: readers, grid filters and image \
                    filters need a shared library".into());
    }
    let (factory, _) = running.guest().sized::<interface::Factory<Guest>>(factory)?;
    let (count, filter) = (factory.count, factory.at);
    let count = running.function::<(), u32>("filter_count", count)?;
    let count = count.ok_or_else(|| missing("filter_count"))?;
    let filter = running.function::<u32, u32>("filter", filter)?;
    let filter = filter.ok_or_else(|| missing("filter"))?;
    let count = count.call(&mut running.store, ()).map_err(|error| message(&error))?;
    Ok(InitializedModule { plugin, count: check_filter_count(count)?, filter, host })
}
