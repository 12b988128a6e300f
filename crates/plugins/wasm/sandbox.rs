//! A module: compiled once, started afresh for each use, stopped from outside.

use crate::ffi::{AddressSpace, CheckResult};
use crate::host::State;
use crate::interface::{CANCELLED, ENTRY, ERROR, MAJOR, MINOR, OK, PATCH};
use bytemuck::Pod;
use std::mem::MaybeUninit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::hash_of_bytes;
use wasmtime::{
    AsContext, AsContextMut, Caller, Config, Engine, Extern, Func, Instance, Linker, Memory, Module, Ref,
    Store, StoreLimits, StoreLimitsBuilder, Table, Trap, TypedFunc, UpdateDeadline, WasmParams, WasmResults,
};

pub(super) struct Sandbox {
    engine: Engine,
    module: Module,
}

pub(super) struct StoreData {
    state: Arc<State>,
    limits: StoreLimits,
}

/// A module that was started, with the functions of the host in its table.
pub(super) struct RunningModule {
    pub store: Store<StoreData>,
    pub memory: Memory,
    table: Table,
    instance: Instance,
    /// Indices in the table: progress, cancelled, error, fallback, parallel_for.
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
const MAX_MEMORY_BYTES: u64 = 1 << 32;
/// Largest number of elements of the table: functions that something points to.
const MAX_TABLE_ELEMENTS: usize = 1 << 20;
/// Options with which the module must be linked.
const LINK_OPTIONS: &str = "--export-table --growable-table";

impl Sandbox {
    pub fn new(bytes: &[u8]) -> CheckResult<Sandbox> {
        let mut config = Config::new();
        config.epoch_interruption(true);
        let engine = Engine::new(&config).map_err(|error| message(&error))?;
        let module = Module::new(&engine, bytes).map_err(|error| message(&error))?;
        Ok(Sandbox { engine, module })
    }

    /// A stop for one use of the module.
    pub fn stop(&self) -> Stop {
        Stop { engine: self.engine.clone(), stopped: Arc::default() }
    }

    /// Starts it with fresh memory of at most `max_memory_bytes`.
    pub fn start(
        &self,
        state: &Arc<State>,
        stop: &Stop,
        max_memory_bytes: Option<u64>,
    ) -> CheckResult<RunningModule> {
        let max_bytes = max_memory_bytes.unwrap_or(MAX_MEMORY_BYTES).min(MAX_MEMORY_BYTES);
        let limits = StoreLimitsBuilder::new()
            .memory_size(usize::try_from(max_bytes).unwrap_or(usize::MAX))
            .table_elements(MAX_TABLE_ELEMENTS)
            .build();
        let mut store = Store::new(&self.engine, StoreData { state: state.clone(), limits });
        store.limiter(|inside| &mut inside.limits);
        let stopped = stop.stopped.clone();
        store.set_epoch_deadline(1);
        store.epoch_deadline_callback(move |_| match stopped.load(Ordering::Relaxed) {
            true => Err(Trap::Interrupt.into()),
            // Another use of the module was stopped.
            false => Ok(UpdateDeadline::Continue(1)),
        });
        let mut linker = Linker::new(&self.engine);
        // A run-time library may import functions that are never called.
        linker.define_unknown_imports_as_traps(&self.module).map_err(|error| message(&error))?;
        let instance = linker.instantiate(&mut store, &self.module).map_err(|error| message(&error))?;
        let memory = instance.get_memory(&mut store, "memory").ok_or("it exports no memory 'memory'")?;
        let table = instance.get_table(&mut store, "__indirect_function_table");
        let table = table.ok_or_else(|| format!("it exports no table; link it with {LINK_OPTIONS}"))?;
        let host = functions(&mut store);
        let first = table.grow(&mut store, host.len() as u64, Ref::Func(None));
        let first = first.map_err(|_| format!("its table cannot grow; link it with {LINK_OPTIONS}"))? as u32;
        for (place, function) in host.iter().enumerate() {
            let at = u64::from(first) + place as u64;
            table.set(&mut store, at, Ref::Func(Some(*function))).map_err(|error| message(&error))?;
        }
        let host = std::array::from_fn(|place| first + place as u32);
        let mut running = RunningModule { store, memory, table, instance, host };
        if let Ok(initialize) = running.instance.get_typed_func::<(), ()>(&mut running.store, "_initialize") {
            initialize.call(&mut running.store, ()).map_err(|error| message(&error))?;
        }
        Ok(running)
    }
}

impl RunningModule {
    /// The current memory.
    pub fn guest(&self) -> Guest<'_> {
        Guest::new(self.memory, &self.store)
    }

    pub fn entry(&mut self) -> CheckResult<u32> {
        let entry = self.instance.get_global(&mut self.store, ENTRY);
        let entry = entry.ok_or_else(|| format!("it does not export the symbol '{ENTRY}'"))?;
        let address = entry.get(&mut self.store).i32().ok_or_else(|| format!("'{ENTRY}' is no address"))?;
        Ok(address as u32)
    }

    /// The function of that index in the table; `None` for a null pointer.
    pub fn function<P: WasmParams, R: WasmResults>(
        &mut self,
        name: &str,
        index: u32,
    ) -> CheckResult<Option<TypedFunc<P, R>>> {
        if index == 0 {
            return Ok(None);
        }
        let found = self.table.get(&mut self.store, u64::from(index));
        let Some(Ref::Func(Some(function))) = found else {
            return Err(format!("the function '{name}' is none"));
        };
        let typed = function.typed(&self.store);
        typed.map(Some).map_err(|_| format!("the function '{name}' takes or gives something else"))
    }

    /// Appends the struct of the host to the arguments; returns its address.
    pub fn host(&self, arguments: &mut GuestArgs) -> u32 {
        let program = arguments.text(concat!("voltet ", env!("CARGO_PKG_VERSION")).as_bytes());
        let mut host = vec![0, MAJOR, MINOR, PATCH, 1, 0, program, 0];
        host.extend(self.host);
        host[0] = 4 * host.len() as u32;
        arguments.put(&host)
    }
}

/// The functions of the host, in the order of the header.
fn functions(store: &mut Store<StoreData>) -> [Func; 5] {
    [
        Func::wrap(&mut *store, |caller: Caller<'_, StoreData>, _: u32, fraction: f64| {
            caller.data().state.set_fraction(fraction);
        }),
        Func::wrap(&mut *store, |caller: Caller<'_, StoreData>, _: u32| {
            i32::from(caller.data().state.is_cancelled())
        }),
        Func::wrap(&mut *store, |mut caller: Caller<'_, StoreData>, _: u32, text: u32| {
            let text = guest_text(&mut caller, text);
            caller.data().state.set_error(text);
        }),
        Func::wrap(&mut *store, |mut caller: Caller<'_, StoreData>, _: u32, what: u32, count: u64| {
            let what = guest_text(&mut caller, what);
            caller.data().state.add_fallback(what, count);
        }),
        Func::wrap(&mut *store, parallel_for),
    ]
}

fn guest_text(caller: &mut Caller<'_, StoreData>, text: u32) -> String {
    match caller.get_export("memory") {
        Some(Extern::Memory(memory)) => Guest::new(memory, &*caller).message(text),
        _ => "(a text in no memory)".into(),
    }
}

/// Runs one part after the other: a module has one thread.
fn parallel_for(
    mut caller: Caller<'_, StoreData>,
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

/// Message of an error of the engine, in one line.
pub(super) fn message(error: &wasmtime::Error) -> String {
    match error.downcast_ref::<Trap>() {
        Some(trap) => trap.to_string(),
        None => error.root_cause().to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

/// Page of WebAssembly (bytes).
const PAGE: u64 = 1 << 16;

/// Current memory of a module.
#[derive(Clone, Copy)]
pub(super) struct Guest<'a> {
    bytes: &'a [u8],
}

impl<'a> Guest<'a> {
    pub fn new<T: 'static>(memory: Memory, store: &'a impl AsContext<Data = T>) -> Guest<'a> {
        Guest { bytes: memory.data(store) }
    }
}

impl AddressSpace for Guest<'_> {
    type Address = u32;
    type Function<F: Copy> = u32;

    fn is_null<F: Copy>(function: u32) -> bool {
        function == 0
    }

    fn copy(self, address: usize, into: &mut [MaybeUninit<u8>]) -> Option<()> {
        let bytes = self.bytes.get(address..address.checked_add(into.len())?)?;
        into.iter_mut().zip(bytes).for_each(|(to, byte)| _ = to.write(*byte));
        Some(())
    }
}

/// Arguments of a call, collected before the module's memory grows by them: their addresses are known meanwhile.
pub(super) struct GuestArgs {
    begin: u64,
    bytes: Vec<u8>,
    inputs: GuestInputs,
}

/// Inputs of a call in the module's memory: a module that writes there differs from the same source as a library, where that is refused.
#[derive(Default)]
pub(super) struct GuestInputs(Vec<GuestInput>);

struct GuestInput {
    name: &'static str,
    address: usize,
    byte_count: usize,
    hash: u64,
}

impl GuestInputs {
    /// Makes the call fail if one of its inputs has changed.
    pub fn refuse_changes(&self, guest: Guest, state: &State) {
        for GuestInput { name, address, byte_count, hash } in &self.0 {
            if guest.bytes.get(*address..address + byte_count).map(hash_of_bytes) != Some(*hash) {
                state.refuse(format!("it wrote into {name}, which it must leave as they are"));
            }
        }
    }
}

impl GuestArgs {
    /// Arguments behind the module's memory.
    pub fn behind<T: 'static>(memory: Memory, store: &impl AsContext<Data = T>) -> GuestArgs {
        GuestArgs { begin: memory.size(store) * PAGE, bytes: Vec::new(), inputs: GuestInputs::default() }
    }

    /// Appends numbers at a multiple of 16; returns their address.
    pub fn put<T: Pod>(&mut self, values: &[T]) -> u32 {
        self.bytes.resize(self.bytes.len().next_multiple_of(16), 0);
        let address = self.begin + self.bytes.len() as u64;
        self.bytes.extend_from_slice(bytemuck::cast_slice(values));
        // Overrun 32 bits the memory cannot grow, which is found then.
        address as u32
    }

    /// Appends numbers that the module must leave as they are; returns their address.
    pub fn input<T: Pod>(&mut self, name: &'static str, values: &[T]) -> u32 {
        let (address, bytes) = (self.put(values), bytemuck::cast_slice(values));
        let hash = hash_of_bytes(bytes);
        self.inputs.0.push(GuestInput { name, address: address as usize, byte_count: bytes.len(), hash });
        address
    }

    /// Appends a text with a final 0; returns its address.
    pub fn text(&mut self, text: &[u8]) -> u32 {
        let address = self.put(text);
        self.bytes.push(0);
        address
    }

    /// Grows the memory and copies everything there; the inputs, or `None` if there is no room.
    pub fn write_to<T: 'static>(
        self,
        memory: Memory,
        store: &mut impl AsContextMut<Data = T>,
    ) -> Option<GuestInputs> {
        let pages = (self.bytes.len() as u64).div_ceil(PAGE);
        let has_room = memory.grow(&mut *store, pages).is_ok_and(|old| old * PAGE == self.begin)
            && memory.write(store, self.begin as usize, &self.bytes).is_ok();
        has_room.then_some(self.inputs)
    }
}
