//! A module: compiled once, started anew for each use, stopped from outside.

use super::guest::{Guest, Handed};
use super::layout::entry;
use crate::foreign::Wrong;
use crate::host::State;
use crate::interface::{CANCELLED, ENTRY, ERROR, MAJOR, MINOR, OK, PATCH};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wasmtime::{
    Caller, Config, Engine, Extern, Func, Instance, Linker, Memory, Module, Ref, Store, StoreLimits,
    StoreLimitsBuilder, Table, Trap, TypedFunc, UpdateDeadline, WasmParams, WasmResults,
};

/// A compiled module.
pub(super) struct Sandbox {
    engine: Engine,
    module: Module,
}

/// What belongs to one use of it.
pub(super) struct Inside {
    state: Arc<State>,
    limits: StoreLimits,
}

/// A module that was started, with the functions of the host in its table.
pub(super) struct Running {
    pub store: Store<Inside>,
    pub memory: Memory,
    table: Table,
    instance: Instance,
    /// Places in the table: progress, cancelled, error, fallback, parallel_for.
    host: [u32; 5],
}

/// Stops a use of the module from outside.
#[derive(Clone)]
pub(super) struct Stop {
    engine: Engine,
    stopped: Arc<AtomicBool>,
}

impl Stop {
    /// At the next branch or call of the module.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
        self.engine.increment_epoch();
    }
}

/// Addresses have 32 bits.
const MEMORY_MOST: u64 = 1 << 32;
/// Most elements of the table: functions that something points to.
const TABLE_MOST: usize = 1 << 20;
/// What the module must be linked with.
const LINKED: &str = "--export-table --growable-table";

impl Sandbox {
    /// Compiles a module.
    pub fn new(bytes: &[u8]) -> Result<Sandbox, Wrong> {
        let mut config = Config::new();
        config.epoch_interruption(true);
        let engine = Engine::new(&config).map_err(|error| said(&error))?;
        let module = Module::new(&engine, bytes).map_err(|error| said(&error))?;
        Ok(Sandbox { engine, module })
    }

    /// Starts it with fresh memory, of which it may have `memory_most` bytes.
    pub fn start(&self, state: &Arc<State>, memory_most: Option<u64>) -> Result<(Running, Stop), Wrong> {
        let most = memory_most.unwrap_or(MEMORY_MOST).min(MEMORY_MOST);
        let limits = StoreLimitsBuilder::new()
            .memory_size(usize::try_from(most).unwrap_or(usize::MAX))
            .table_elements(TABLE_MOST)
            .build();
        let mut store = Store::new(&self.engine, Inside { state: state.clone(), limits });
        store.limiter(|inside| &mut inside.limits);
        let stop = Stop { engine: self.engine.clone(), stopped: Arc::default() };
        let stopped = stop.stopped.clone();
        store.set_epoch_deadline(1);
        store.epoch_deadline_callback(move |_| match stopped.load(Ordering::Relaxed) {
            true => Err(Trap::Interrupt.into()),
            // Somebody stopped another use of the module.
            false => Ok(UpdateDeadline::Continue(1)),
        });
        let mut linker = Linker::new(&self.engine);
        // A run-time library may bring functions that nobody calls: there is nothing behind them.
        linker.define_unknown_imports_as_traps(&self.module).map_err(|error| said(&error))?;
        let instance = linker.instantiate(&mut store, &self.module).map_err(|error| said(&error))?;
        let memory = instance.get_memory(&mut store, "memory").ok_or("it exports no memory 'memory'")?;
        let table = instance.get_table(&mut store, "__indirect_function_table");
        let table = table.ok_or_else(|| format!("it exports no table; link it with {LINKED}"))?;
        let host = functions(&mut store);
        let first = table.grow(&mut store, host.len() as u64, Ref::Func(None));
        let first = first.map_err(|_| format!("its table cannot grow; link it with {LINKED}"))? as u32;
        for (place, function) in host.iter().enumerate() {
            let at = u64::from(first) + place as u64;
            table.set(&mut store, at, Ref::Func(Some(*function))).map_err(|error| said(&error))?;
        }
        let host = std::array::from_fn(|place| first + place as u32);
        let mut running = Running { store, memory, table, instance, host };
        if let Ok(initialize) = running.instance.get_typed_func::<(), ()>(&mut running.store, "_initialize") {
            initialize.call(&mut running.store, ()).map_err(|error| said(&error))?;
        }
        Ok((running, stop))
    }
}

impl Running {
    /// The memory as it is now.
    pub fn guest(&self) -> Guest<'_> {
        Guest::of(self.memory, &self.store)
    }

    /// The address of the entry, of a version that can be understood.
    pub fn entry(&mut self) -> Result<u32, Wrong> {
        let entry = self.instance.get_global(&mut self.store, ENTRY);
        let entry = entry.ok_or_else(|| format!("it does not export the symbol '{ENTRY}'"))?;
        let address =
            entry.get(&mut self.store).i32().ok_or_else(|| format!("'{ENTRY}' is no address"))? as u32;
        let wrong = |wrong: Wrong| format!("its entry {wrong}");
        let head: Vec<u32> = self.guest().list(address, 4).map_err(wrong)?;
        if head[1] != MAJOR {
            let [_, major, minor, patch] = head[..] else { return Err("its entry is too short".into()) };
            return Err(format!(
                "its interface is version {major}.{minor}.{patch}, and this program's {MAJOR}.x"
            ));
        }
        self.sized(address, "voltet_entry", entry::SIZE)?;
        Ok(address)
    }

    /// The size that a struct says it has; an error where it is smaller than in version 1.0.
    pub fn sized(&self, address: u32, name: &str, least: u32) -> Result<u32, Wrong> {
        let size = match address {
            0 => Err("is a null pointer".into()),
            _ => self.guest().read::<u32>(address),
        };
        let size = size.map_err(|wrong: Wrong| format!("{name} {wrong}"))?;
        match (least..=4096).contains(&size) && size % 4 == 0 {
            true => Ok(size),
            false => Err(format!("{name} says that its size is {size} bytes, in place of {least} (sizeof)")),
        }
    }

    /// The function whose address stands at a place; `None` for a null pointer.
    pub fn function<P: WasmParams, R: WasmResults>(
        &mut self,
        name: &str,
        at: u32,
    ) -> Result<Option<TypedFunc<P, R>>, Wrong> {
        let number =
            self.guest().read::<u32>(at).map_err(|wrong| format!("the function '{name}' {wrong}"))?;
        if number == 0 {
            return Ok(None);
        }
        let found = self.table.get(&mut self.store, u64::from(number));
        let Some(Ref::Func(Some(function))) = found else {
            return Err(format!("the function '{name}' is none"));
        };
        let typed = function.typed(&self.store);
        typed.map(Some).map_err(|_| format!("the function '{name}' takes or gives something else"))
    }

    /// The struct of the host, put among what is handed over; its address.
    pub fn host(&self, handed: &mut Handed) -> u32 {
        let program = handed.text(concat!("voltet ", env!("CARGO_PKG_VERSION")).as_bytes());
        let mut host = vec![0, MAJOR, MINOR, PATCH, 1, 0, program, 0];
        host.extend(self.host);
        host[0] = 4 * host.len() as u32;
        handed.put(&host)
    }
}

/// The functions of the host, in the order of the header.
fn functions(store: &mut Store<Inside>) -> [Func; 5] {
    [
        Func::wrap(&mut *store, |caller: Caller<'_, Inside>, _: u32, fraction: f64| {
            caller.data().state.set_fraction(fraction);
        }),
        Func::wrap(&mut *store, |caller: Caller<'_, Inside>, _: u32| {
            i32::from(caller.data().state.is_cancelled())
        }),
        Func::wrap(&mut *store, |mut caller: Caller<'_, Inside>, _: u32, text: u32| {
            let text = message(&mut caller, text);
            caller.data().state.set_error(text);
        }),
        Func::wrap(&mut *store, |mut caller: Caller<'_, Inside>, _: u32, what: u32, count: u64| {
            let what = message(&mut caller, what);
            caller.data().state.fall_back(what, count);
        }),
        Func::wrap(&mut *store, parallel_for),
    ]
}

fn message(caller: &mut Caller<'_, Inside>, text: u32) -> String {
    match caller.get_export("memory") {
        Some(Extern::Memory(memory)) => Guest::of(memory, &*caller).message(text),
        _ => "(a text in no memory)".into(),
    }
}

/// One part after the other: a module has one thread.
fn parallel_for(
    mut caller: Caller<'_, Inside>,
    _: u32,
    count: u64,
    chunk: u64,
    body: u32,
    user: u32,
) -> wasmtime::Result<i32> {
    let table = caller.get_export("__indirect_function_table").and_then(Extern::into_table);
    let body = match table.and_then(|table| table.get(&mut caller, u64::from(body))) {
        Some(Ref::Func(Some(body))) => body.typed::<(u32, u64, u64, u32), ()>(&caller)?,
        _ => {
            caller.data().state.set_error("parallel_for was called without a body".into());
            return Ok(ERROR);
        }
    };
    let chunk = if chunk == 0 { 4096 } else { chunk };
    for part in 0..count.div_ceil(chunk) {
        if caller.data().state.is_cancelled() {
            return Ok(CANCELLED);
        }
        let first = part * chunk;
        body.call(&mut caller, (user, first, first.saturating_add(chunk).min(count), 0))?;
    }
    Ok(OK)
}

/// What the engine says, in one line.
pub(super) fn said(error: &wasmtime::Error) -> String {
    match error.downcast_ref::<Trap>() {
        Some(trap) => trap.to_string(),
        None => error.root_cause().to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    }
}
