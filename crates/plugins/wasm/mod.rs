//! The interface of `include/voltet_plugin.h` in a sandbox: WebAssembly modules of 32-bit addresses. They see
//! their inputs and the functions of the host, and nothing else: no files, no network, no clock. Each call starts a fresh module.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `sandbox` | compiling, starting, stopping a module; bounded access to its memory |
//! | `declared` | its declarations |

mod declared;
mod sandbox;

use crate::declaration::{Declaration, Family};
use crate::ffi::{CheckResult, GUARD_COUNT, Overrun, UNSET, ValidationError, remove_guard};
use crate::gradient_filter::GradientTask;
use crate::host::State;
use crate::library::{file_name, load_error, read_file};
use crate::runner::{PluginItem, Runner};
use crate::status::{CallLabel, CallStatus};
use crate::task::{CheckTask, Outcome, Task};
use crate::values::ParameterValues;
use crate::watchdog::{self, CallFailure};
use declared::{filter, initialize};
use sandbox::{GuestArgs, RunningModule, Sandbox, message};
use std::any::Any;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::glam::DVec3;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// The gradient filters of a module.
///
/// Errors: no module, not of the interface, or what it declares is wrong.
pub(crate) fn load(path: &Path) -> Result<Vec<PluginItem>> {
    let (plugin, bytes) = read_file(path)?;
    let nameless = Plugin { name: file_name(path), ..plugin };
    let sandbox = Sandbox::new(&bytes).map_err(|wrong| load_error(path, wrong))?;
    let ([name, version], declarations) =
        declared::read(&sandbox).map_err(|wrong| load_error(path, wrong))?;
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

impl SandboxRunner {
    /// Runs `work` with a fresh module on a thread of its own, and stops it once `is_over` is true.
    fn use_module<T: Send + 'static>(
        &self,
        (label, name): (CallLabel, &str),
        state: &Arc<State>,
        max_memory_bytes: Option<u64>,
        work: impl FnOnce(&mut RunningModule, u32, u32) -> CheckResult<T> + Send + 'static,
        mut is_over: impl FnMut() -> bool,
    ) -> Result<T> {
        let failed = |wrong: ValidationError| label.error("failed in its sandbox").got(wrong);
        let (mut running, stop) = self.sandbox.start(state, max_memory_bytes).map_err(failed)?;
        let index = self.names.iter().position(|known| *known == name).unwrap_or(0) as u32;
        let work_state = state.clone();
        let work = move || {
            let module = initialize(&mut running, &work_state)?;
            let filter = module.filter(&mut running, index)?;
            work(&mut running, filter, module.host)
        };
        let mut stopped = false;
        let may_go_on = || {
            stopped |= is_over();
            if stopped {
                stop.stop();
            }
            true
        };
        match watchdog::run(work, may_go_on) {
            Ok(outcome) => outcome.map_err(failed),
            Err(CallFailure::GivenUp | CallFailure::Ended | CallFailure::NoThread) => {
                Err(label.error("cannot be run: the system gives no thread for it"))
            }
        }
    }
}

impl Runner for SandboxRunner {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(
        &self,
        declaration: &Declaration,
        task: Box<dyn Task>,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)> {
        let label = (CallLabel::new(declaration, &self.plugin), declaration.schema.name);
        let task: Box<dyn Any> = task;
        let task = match task.downcast::<CheckTask>() {
            Ok(check) => return self.check(label, check.values),
            Err(task) => task.downcast::<GradientTask>(),
        };
        match (task, declaration.family) {
            (Ok(task), Family::GradientFilter { needs }) => self.gradient(label, *task, needs, progress),
            // A module declares gradient filters alone.
            _ => Ok(Default::default()),
        }
    }
}

impl SandboxRunner {
    fn check(&self, label: (CallLabel, &str), values: ParameterValues) -> Result<(CallStatus, Outcome)> {
        let (state, start) = (Arc::<State>::default(), Instant::now());
        let call_state = state.clone();
        let work = move |running: &mut RunningModule, filter: u32, host: u32| {
            let check = running.function::<(u32, u32), i32>("check", filter + filter::CHECK)?;
            let check = check.ok_or("its function 'check' is gone")?;
            let mut arguments = GuestArgs::behind(running.memory, &running.store);
            let values = put_values(&values, &mut arguments);
            if !arguments.write_to(running.memory, &mut running.store) {
                return Err("there is no memory for the parameters".into());
            }
            let code = check.call(&mut running.store, (values, host)).map_err(|error| message(&error))?;
            Ok((CallStatus::new(code, &call_state), Outcome::Nothing))
        };
        self.use_module(label, &state, None, work, || start.elapsed() > CHECK_TIME_LIMIT)
    }

    fn gradient(
        &self,
        label: (CallLabel, &str),
        task: GradientTask,
        needs: u32,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)> {
        let (state, start) = (Arc::<State>::default(), Instant::now());
        let call_state = state.clone();
        let work = move |running: &mut RunningModule, filter: u32, host: u32| {
            let gradient = running.function::<(u32, u32), i32>("gradient", filter + filter::GRADIENT)?;
            let gradient = gradient.ok_or("its function 'gradient' is gone")?;
            let mut arguments = GuestArgs::behind(running.memory, &running.store);
            let (call, out) = put_call(&task, needs, &mut arguments);
            if !arguments.write_to(running.memory, &mut running.store) {
                return Err("there is no memory for the grid: a module has 4 GiB at most".into());
            }
            let code = gradient.call(&mut running.store, (call, host)).map_err(|error| message(&error))?;
            let count = task.grid.points.len();
            let mut vectors: Vec<DVec3> = running.guest().list(out, count + GUARD_COUNT)?;
            let overrun = remove_guard::<_, f64>(&mut vectors, count).then(|| Overrun::gradient(count));
            Ok((CallStatus { overrun, ..CallStatus::new(code, &call_state) }, Outcome::Vectors(vectors)))
        };
        let is_over = || {
            progress.report("gradient", state.fraction());
            if progress.cancelled() {
                state.cancel();
            }
            progress.cancelled() || start.elapsed() > CALL_TIME_LIMIT
        };
        match self.use_module(label, &state, progress.memory_left(), work, is_over) {
            Ok(done) => Ok(done),
            Err(_) if progress.cancelled() => Err(Error::cancelled()),
            Err(_) if start.elapsed() > CALL_TIME_LIMIT => {
                let error = label.0.error("was stopped");
                Err(error.got("no end").expected(format!("an end within {} s", CALL_TIME_LIMIT.as_secs())))
            }
            Err(error) => Err(error),
        }
    }
}

/// Appends `voltet_values`; returns its address.
fn put_values(values: &ParameterValues, arguments: &mut GuestArgs) -> u32 {
    let parts = values.parts();
    let integers = arguments.put(parts.integers);
    let numbers = arguments.put(parts.numbers);
    let texts: Vec<u32> = parts
        .texts
        .iter()
        .map(|text| text.as_ref().map_or(0, |text| arguments.text(text.to_bytes())))
        .collect();
    let texts = arguments.put(&texts);
    let vectors: Vec<u32> = parts
        .vectors
        .iter()
        .map(|vector| vector.as_ref().map_or(0, |vector| arguments.put(vector)))
        .collect();
    let vectors = arguments.put(&vectors);
    let lengths: Vec<u32> =
        parts.vectors.iter().map(|vector| vector.as_ref().map_or(0, |vector| vector.len() as u32)).collect();
    let lengths = arguments.put(&lengths);
    arguments.put(&[28, parts.integers.len() as u32, integers, numbers, texts, vectors, lengths])
}

/// Appends `voltet_call`; returns its address and that of the gradient.
fn put_call(task: &GradientTask, needs: u32, arguments: &mut GuestArgs) -> (u32, u32) {
    let [neighbours, cells_of_points] = task.tables(needs).map(|table| match table {
        Some(table) => [arguments.put(&table.starts), arguments.put(&table.items)],
        None => [0; 2],
    });
    let (points, cells) = (arguments.put(&task.grid.points), arguments.put(&task.grid.tetrahedra));
    let scalar = arguments.put(&task.scalar);
    let arrays: Vec<u32> = task
        .arrays
        .iter()
        .map(|array| array.as_ref().map_or(0, |array| arguments.put(&array.values)))
        .collect();
    let arrays = arguments.put(&arrays);
    let values = put_values(&task.values, arguments);
    let out = arguments.put(&vec![DVec3::splat(UNSET); task.grid.points.len() + GUARD_COUNT]);
    let [points_low, points_high] = halves(task.grid.points.len());
    let [cells_low, cells_high] = halves(task.grid.tetrahedra.len());
    let [starts, items] = neighbours;
    let [cell_starts, cell_items] = cells_of_points;
    let call = arguments.put(&[
        64,
        0,
        points_low,
        points_high,
        cells_low,
        cells_high,
        points,
        cells,
        starts,
        items,
        cell_starts,
        cell_items,
        scalar,
        arrays,
        values,
        out,
    ]);
    (call, out)
}

/// A number of 64 bits as two, the low one first.
fn halves(count: usize) -> [u32; 2] {
    [count as u32, (count as u64 >> 32) as u32]
}
