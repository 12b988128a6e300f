//! The interface of `include/voltet_plugin.h` in a sandbox: WebAssembly modules of 32-bit addresses. They see
//! their inputs and the functions of the host, and nothing else: no files, no network, no clock. Each call starts a fresh module.
//! Declarations are copied to the header's structs of this program, which [`crate::declaration`] reads and checks.

mod sandbox;

use crate::call::{GradientTask, Outcome, Task};
use crate::declaration::{Declaration, Family, MAX_PARAMETERS, MAX_VECTOR_LENGTH};
use crate::ffi::{CheckResult, GUARD_COUNT, Overrun, UNSET, ValidationError, remove_guard};
use crate::host::{CallLabel, CallStatus, State};
use crate::interface::{self, Check, GRADIENT_FILTERS, Gradient, GradientCall, Host, Values};
use crate::item::{PluginItem, Runner};
use crate::library::{check_filter_count, file_name, load_error, read_file, refuse_same_names};
use crate::values::ParameterValues;
use crate::{declaration, guard};
use sandbox::{Guest, GuestArgs, RunningModule, Sandbox, entry, message};
use std::ffi::{CString, c_char};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::glam::DVec3;
use voltet_core::grid::Array;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// The gradient filters of a module.
///
/// Errors: no module, not of the interface, or what it declares is wrong.
pub(crate) fn load(path: &Path) -> Result<Vec<PluginItem>> {
    let (plugin, bytes) = read_file(path)?;
    let nameless = Plugin { name: file_name(path), ..plugin };
    let sandbox = Sandbox::new(&bytes).map_err(|wrong| load_error(path, wrong))?;
    let ([name, version], declarations) = declarations(&sandbox).map_err(|wrong| load_error(path, wrong))?;
    let plugin = Plugin { name, version, ..nameless };
    let names = declarations.iter().map(|declaration| declaration.schema.name).collect();
    let runner = Arc::new(SandboxRunner { sandbox, plugin, names });
    Ok(PluginItem::list(runner, declarations))
}

/// Longest call of a filter.
const CALL_TIME_LIMIT: Duration = Duration::from_secs(600);

/// Longest check of parameters.
const CHECK_TIME_LIMIT: Duration = Duration::from_secs(3);

/// Runner of a module; the filters by their indices.
pub(super) struct SandboxRunner {
    sandbox: Sandbox,
    plugin: Plugin,
    names: Vec<&'static str>,
}

impl Runner for SandboxRunner {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(
        &self,
        declaration: &Declaration,
        task: Task,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)> {
        let label = CallLabel::new(declaration, &self.plugin);
        let failed = |wrong: ValidationError| label.error("failed in its sandbox").got(wrong);
        let (state, start) = (Arc::<State>::default(), Instant::now());
        let is_check = matches!(task, Task::Check(_));
        let (time_limit, max_memory_bytes) =
            if is_check { (CHECK_TIME_LIMIT, None) } else { (CALL_TIME_LIMIT, progress.memory_left()) };
        let (mut running, stop) = self.sandbox.start(&state, max_memory_bytes).map_err(failed)?;
        let name = declaration.schema.name;
        let index = self.names.iter().position(|known| *known == name).unwrap_or(0) as u32;
        let (family, call_state) = (declaration.family, state.clone());
        let work = move || {
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
) -> CheckResult<(CallStatus, Outcome)> {
    let mut arguments = GuestArgs::behind(running.memory, &running.store);
    let (name, offset, inputs, output) = match (task, family) {
        (Task::Check(values), _) => ("check", filter::CHECK, put_values(values, &mut arguments), None),
        (Task::Gradient(task), Family::GradientFilter { needs }) => {
            let (inputs, vectors) = put_call(task, needs, &mut arguments);
            ("gradient", filter::GRADIENT, inputs, Some((vectors, task.grid.points.len())))
        }
        _ => return Ok(Default::default()),
    };
    let function = running.function::<(u32, u32), i32>(name, filter + offset)?;
    let function = function.ok_or_else(|| format!("its function '{name}' is gone"))?;
    if !arguments.write_to(running.memory, &mut running.store) {
        return Err("there is no memory for its inputs: a module has 4 GiB at most".into());
    }
    let code = function.call(&mut running.store, (inputs, host)).map_err(|error| message(&error))?;
    let status = CallStatus::new(code, state);
    let Some((vectors, count)) = output else { return Ok((status, Outcome::Nothing)) };
    let mut vectors: Vec<DVec3> = running.guest().list(vectors, count + GUARD_COUNT)?;
    let overrun = remove_guard::<_, f64>(&mut vectors, count).then(|| Overrun::gradient(count));
    Ok((CallStatus { overrun, ..status }, Outcome::Vectors(vectors)))
}

/// Appends `voltet_values`; returns its address.
fn put_values(values: &ParameterValues, arguments: &mut GuestArgs) -> u32 {
    let ParameterValues { integers, numbers, texts, vectors } = values;
    let lengths: Vec<u32> = vectors.iter().map(|v| v.as_ref().map_or(0, |v| v.len() as u32)).collect();
    let count = integers.len() as u32;
    let (integers, numbers) = (arguments.put(integers), arguments.put(numbers));
    let text = |text: &Option<CString>| text.as_ref().map_or(0, |text| arguments.text(text.to_bytes()));
    let texts: Vec<u32> = texts.iter().map(text).collect();
    let texts = arguments.put(&texts);
    let vector = |vector: &Option<Vec<f64>>| vector.as_ref().map_or(0, |vector| arguments.put(vector));
    let vectors: Vec<u32> = vectors.iter().map(vector).collect();
    let (vectors, lengths) = (arguments.put(&vectors), arguments.put(&lengths));
    arguments.put(&[28, count, integers, numbers, texts, vectors, lengths])
}

/// Appends `voltet_call`; returns its address and that of the gradient.
fn put_call(task: &GradientTask, needs: u32, arguments: &mut GuestArgs) -> (u32, u32) {
    let [neighbours, cells_of_points] = task.tables(needs).map(|table| match table {
        Some(table) => [arguments.put(&table.starts), arguments.put(&table.items)],
        None => [0; 2],
    });
    let (points, cells) = (arguments.put(&task.grid.points), arguments.put(&task.grid.tetrahedra));
    let scalar = arguments.put(&task.scalar);
    let array = |array: &Option<Arc<Array>>| array.as_ref().map_or(0, |array| arguments.put(&array.values));
    let arrays: Vec<u32> = task.arrays.iter().map(array).collect();
    let arrays = arguments.put(&arrays);
    let values = put_values(&task.values, arguments);
    let out = arguments.put(&vec![DVec3::splat(UNSET); task.grid.points.len() + GUARD_COUNT]);
    let [points_low, points_high] = halves(task.grid.points.len());
    let [cells_low, cells_high] = halves(task.grid.tetrahedra.len());
    let [[starts, items], [cell_starts, cell_items]] = [neighbours, cells_of_points];
    let mut call = vec![64, 0, points_low, points_high, cells_low, cells_high, points, cells];
    call.extend([starts, items, cell_starts, cell_items, scalar, arrays, values, out]);
    (arguments.put(&call), out)
}

/// A number of 64 bits as two, the low one first.
fn halves(count: usize) -> [u32; 2] {
    [count as u32, (count as u64 >> 32) as u32]
}

/// Name and version, and the filters in their order.
fn declarations(sandbox: &Sandbox) -> CheckResult<([String; 2], Vec<Declaration>)> {
    let state = Arc::default();
    let (mut running, _) = sandbox.start(&state, None)?;
    let plugin_ = initialize(&mut running, &state)?;
    let mut copies = Copies::default();
    let named = copies.plugin(&running, plugin_.plugin)?;
    let names = declaration::plugin(&named)?;
    let mut filters: Vec<Declaration> = Vec::new();
    for place in 0..plugin_.count {
        let at = |wrong: ValidationError| format!("filter {place}: {wrong}");
        let address = plugin_.filter(&mut running, place).map_err(at)?;
        let described = copies.filter(&mut running, address).map_err(at)?;
        filters.push(declaration::gradient_filter(&described).map_err(at)?.declaration);
    }
    refuse_same_names(&filters)?;
    Ok((names, filters))
}

/// A module after init.
struct InitializedModule {
    plugin: u32,
    count: u32,
    filter: wasmtime::TypedFunc<u32, u32>,
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
    let entry = running.entry()?;
    let init =
        running.function::<(u32, u32), u32>("init", entry + entry::INIT)?.ok_or_else(|| missing("init"))?;
    let get_factory = running.function::<u32, u32>("get_factory", entry + entry::GET_FACTORY)?;
    let get_factory = get_factory.ok_or_else(|| missing("get_factory"))?;
    let mut arguments = GuestArgs::behind(running.memory, &running.store);
    // The path of the file is not disclosed to a sandbox.
    let path = arguments.text(b"");
    let kind = arguments.text(GRADIENT_FILTERS.to_bytes());
    let host = running.host(&mut arguments);
    if !arguments.write_to(running.memory, &mut running.store) {
        return Err("its memory cannot grow".into());
    }
    let plugin = init.call(&mut running.store, (path, host)).map_err(|error| message(&error))?;
    if plugin == 0 {
        return Err(state.init_failure());
    }
    let factory = get_factory.call(&mut running.store, kind).map_err(|error| message(&error))?;
    if factory == 0 {
        return Err("it has no gradient filters (get_factory gave nothing), and a sandbox runs these alone: readers, grid filters and image \
                    filters need a shared library".into());
    }
    running.sized(factory, "voltet_gradient_factory", factory::SIZE)?;
    let count = running.function::<(), u32>("filter_count", factory + factory::FILTER_COUNT)?;
    let count = count.ok_or_else(|| missing("filter_count"))?;
    let filter = running.function::<u32, u32>("filter", factory + factory::FILTER)?;
    let filter = filter.ok_or_else(|| missing("filter"))?;
    let count = count.call(&mut running.store, ()).map_err(|error| message(&error))?;
    Ok(InitializedModule { plugin, count: check_filter_count(count)?, filter, host })
}

/// Memory that the copied structs point to.
#[derive(Default)]
struct Copies {
    texts: Vec<Vec<u8>>,
    numbers: Vec<Vec<f64>>,
    lists: Vec<Vec<*const c_char>>,
    parameters: Vec<Vec<interface::Parameter>>,
}

impl Copies {
    fn text(&mut self, guest: Guest<'_>, address: u32) -> CheckResult<*const c_char> {
        let Some(mut text) = guest.text(address)? else { return Ok(std::ptr::null()) };
        text.push(0);
        let pointer = text.as_ptr().cast();
        self.texts.push(text);
        Ok(pointer)
    }

    fn plugin(&mut self, running: &RunningModule, address: u32) -> CheckResult<interface::Plugin> {
        running.sized(address, "voltet_plugin", plugin::SIZE)?;
        let guest = running.guest();
        let name = self.text(guest, guest.read(address + plugin::NAME)?)?;
        let version = self.text(guest, guest.read(address + plugin::VERSION)?)?;
        Ok(interface::Plugin { size: size_of::<interface::Plugin>() as u32, reserved: 0, name, version })
    }

    fn filter(
        &mut self,
        running: &mut RunningModule,
        address: u32,
    ) -> CheckResult<interface::GradientFilter> {
        running.sized(address, "voltet_gradient_filter", filter::SIZE)?;
        let guest = running.guest();
        let name = self.text(guest, guest.read(address + filter::NAME)?)?;
        let summary = self.text(guest, guest.read(address + filter::SUMMARY)?)?;
        let parameter_count = guest.read::<u32>(address + filter::PARAMETER_COUNT)?;
        let (needs, begin): (u32, u32) =
            (guest.read(address + filter::NEEDS)?, guest.read(address + filter::PARAMETERS)?);
        let mut parameters = Vec::new();
        let mut stride: u32 = 0;
        // More are refused unread.
        for i in 0..if parameter_count > MAX_PARAMETERS { 0u32 } else { parameter_count } {
            let address = begin.wrapping_add(i.wrapping_mul(stride));
            let size = running.sized(address, "voltet_parameter", parameter::SIZE)?;
            if i > 0 && size != stride {
                return Err(format!(
                    "parameter {i}: its size is {size} bytes, and that of the first {stride}"
                ));
            }
            stride = size;
            parameters.push(
                self.parameter(running.guest(), address)
                    .map_err(|wrong| format!("parameter {i}: {wrong}"))?,
            );
        }
        let [check, gradient] =
            [("check", filter::CHECK), ("gradient", filter::GRADIENT)].map(|(name, at)| {
                running.function::<(u32, u32), i32>(name, address + at).map(|found| found.is_some())
            });
        let pointer = parameters.as_ptr();
        self.parameters.push(parameters);
        Ok(interface::GradientFilter {
            size: size_of::<interface::GradientFilter>() as u32,
            needs,
            name,
            summary,
            parameter_count,
            reserved: 0,
            parameters: pointer,
            check: check?.then_some(no_check as Check),
            gradient: gradient?.then_some(no_gradient as Gradient),
        })
    }

    fn parameter(&mut self, guest: Guest<'_>, address: u32) -> CheckResult<interface::Parameter> {
        let number = |at: u32| guest.read::<u32>(address + at);
        let float = |at: u32| guest.read::<f64>(address + at);
        let mut text = |at: u32| self.text(guest, number(at)?);
        let [name, unit, help] = [text(parameter::NAME)?, text(parameter::UNIT)?, text(parameter::HELP)?];
        let [default, unset] = [text(parameter::TEXT)?, text(parameter::UNSET)?];
        let (length, word_count) = (number(parameter::LENGTH)?, number(parameter::WORD_COUNT)?);
        let numbers = match number(parameter::NUMBERS)? {
            0 => std::ptr::null(),
            // A longer one is refused unread.
            at => {
                let numbers = guest.list::<f64>(at, length.min(MAX_VECTOR_LENGTH) as usize)?;
                let pointer = numbers.as_ptr();
                self.numbers.push(numbers);
                pointer
            }
        };
        let mut words = |at: u32| -> CheckResult<*const *const c_char> {
            let list = number(at)?;
            if list == 0 {
                return Ok(std::ptr::null());
            }
            let words = guest.list::<u32>(list, word_count.min(MAX_PARAMETERS) as usize)?;
            let words =
                words.into_iter().map(|word| self.text(guest, word)).collect::<CheckResult<Vec<_>>>()?;
            let pointer = words.as_ptr();
            self.lists.push(words);
            Ok(pointer)
        };
        let (words, meanings) = (words(parameter::NAMES)?, words(parameter::MEANINGS)?);
        Ok(interface::Parameter {
            size: size_of::<interface::Parameter>() as u32,
            parameter_type: number(parameter::TYPE)?,
            name,
            unit,
            help,
            flags: number(parameter::FLAGS)?,
            length,
            min: float(parameter::MIN)?,
            max: float(parameter::MAX)?,
            number: float(parameter::NUMBER)?,
            text: default,
            numbers,
            unset,
            word_count,
            reserved: 0,
            words,
            meanings,
        })
    }
}

/// Placeholder of the module's check.
unsafe extern "C-unwind" fn no_check(_: *const Values, _: *const Host) -> i32 {
    interface::ERROR
}

/// Placeholder of the module's gradient function.
unsafe extern "C-unwind" fn no_gradient(_: *const GradientCall, _: *const Host) -> i32 {
    interface::ERROR
}

/// Size of a struct and offsets of its fields (bytes).
mod plugin {
    pub const SIZE: u32 = 16;
    pub const NAME: u32 = 8;
    pub const VERSION: u32 = 12;
}

mod factory {
    pub const SIZE: u32 = 16;
    pub const FILTER_COUNT: u32 = 8;
    pub const FILTER: u32 = 12;
}

mod filter {
    pub const SIZE: u32 = 36;
    pub const NEEDS: u32 = 4;
    pub const NAME: u32 = 8;
    pub const SUMMARY: u32 = 12;
    pub const PARAMETER_COUNT: u32 = 16;
    pub const PARAMETERS: u32 = 24;
    pub const CHECK: u32 = 28;
    pub const GRADIENT: u32 = 32;
}

mod parameter {
    pub const SIZE: u32 = 88;
    pub const TYPE: u32 = 4;
    pub const NAME: u32 = 8;
    pub const UNIT: u32 = 12;
    pub const HELP: u32 = 16;
    pub const FLAGS: u32 = 20;
    pub const LENGTH: u32 = 24;
    pub const MIN: u32 = 32;
    pub const MAX: u32 = 40;
    pub const NUMBER: u32 = 48;
    pub const TEXT: u32 = 56;
    pub const NUMBERS: u32 = 60;
    pub const UNSET: u32 = 64;
    pub const WORD_COUNT: u32 = 68;
    pub const NAMES: u32 = 76;
    pub const MEANINGS: u32 = 80;
}
