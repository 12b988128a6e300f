//! The functions that Catalyst calls, and the structure by which its loader finds them (`catalyst_impl.h`, version 1).
//!
//! # Safety
//! Addresses are null or of nodes of Conduit that stay as they are during a call.
#![allow(clippy::missing_safety_doc)]

use crate::conduit::Node;
use crate::simulation::Simulation;
use std::any::Any;
use std::ffi::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use voltet::launcher::launched_count;
use voltet_core::error::ErrorKind;
use voltet_core::{Error, Result};
use voltet_graph::ranks::{OneRank, Ranks};

/// `catalyst_status_ok`.
pub const DONE: c_int = 0;
/// A node or a pipeline is wrong. Catalyst leaves the numbers from 100 on to implementations.
pub const WRONG: c_int = 100;
/// A run failed: a file cannot be written, memory ends.
pub const FAILED: c_int = 101;
/// A mistake of voltet itself.
pub const PANIC: c_int = 102;

/// `struct catalyst_impl`.
#[repr(C)]
#[derive(Debug)]
pub struct Implementation {
    version: c_int,
    initialize: unsafe extern "C" fn(*const c_void) -> c_int,
    execute: unsafe extern "C" fn(*const c_void) -> c_int,
    finalize: unsafe extern "C" fn(*const c_void) -> c_int,
    about: unsafe extern "C" fn(*mut c_void) -> c_int,
    results: unsafe extern "C" fn(*mut c_void) -> c_int,
}

/// The symbol that Catalyst's loader looks for.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals)]
pub static catalyst_api_impl: Implementation = Implementation {
    version: 1,
    initialize: catalyst_initialize_voltet,
    execute: catalyst_execute_voltet,
    finalize: catalyst_finalize_voltet,
    about: catalyst_about_voltet,
    results: catalyst_results_voltet,
};

/// The simulation of this process, from its initialization to its end.
static SIMULATION: Mutex<Option<Simulation>> = Mutex::new(None);

/// Runs a call; its failure is printed, and the status tells its kind. After a panic the simulation has to be initialized again.
fn guarded(name: &str, work: impl FnOnce(&mut Option<Simulation>) -> Result<()>) -> c_int {
    let mut simulation = SIMULATION.lock().unwrap_or_else(PoisonError::into_inner);
    let outcome = catch_unwind(AssertUnwindSafe(|| work(&mut simulation)));
    let (status, text) = match outcome {
        Ok(Ok(())) => return DONE,
        // Its own process shows it.
        Ok(Err(error)) if error.kind == ErrorKind::OtherProcess => return FAILED,
        Ok(Err(error)) => (status_of(&error), error.to_string()),
        Err(panic) => {
            drop_after_panic(&mut simulation);
            (PANIC, voltet::panic_message(&*panic as &(dyn Any + Send)))
        }
    };
    let ranks = simulation.as_ref().map(Simulation::ranks).filter(|ranks| ranks.count() > 1);
    let place = ranks.map(|ranks| format!("rank {} of {}: ", ranks.rank(), ranks.count()));
    eprintln!("voltet: {}{name}: {text}", place.unwrap_or_default());
    status
}

fn status_of(error: &Error) -> c_int {
    match error.kind {
        ErrorKind::Panic => PANIC,
        ErrorKind::Usage => WRONG,
        _ => FAILED,
    }
}

/// Half-done work is dropped, if it can be.
fn drop_after_panic(simulation: &mut Option<Simulation>) {
    let half_done = simulation.take();
    let _ = catch_unwind(AssertUnwindSafe(|| drop(half_done)));
}

/// `catalyst_initialize`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn catalyst_initialize_voltet(parameters: *const c_void) -> c_int {
    guarded("catalyst_initialize", |simulation| {
        if simulation.is_some() {
            let error = Error::usage("the simulation is initialized already");
            return Err(error.expected("catalyst_finalize before another catalyst_initialize"));
        }
        // SAFETY: Catalyst's promise.
        let parameters = unsafe { Node::root(parameters) }?;
        *simulation = Some(Simulation::initialize(&parameters, processes(&parameters)?)?);
        Ok(())
    })
}

/// The processes of the communicator `catalyst/mpi_comm`, by its number in Fortran; without one those of MPI's world.
/// Errors: a communicator that is none; several processes, and MPI has not been started.
#[cfg(feature = "mpi")]
fn processes(parameters: &Node) -> Result<Arc<dyn Ranks>> {
    let number = |node: Node| {
        let number = node.number()?;
        let whole = Some(number as i32).filter(|whole| f64::from(*whole) == number);
        whole.ok_or_else(|| node.wrong("is no communicator", number, "MPI_Comm_c2f(communicator)"))
    };
    let number = parameters.get("catalyst/mpi_comm").map(number).transpose()?;
    if let Some(ranks) = voltet::mpi_ranks::MpiRanks::of_program(number)? {
        return Ok(Arc::new(ranks));
    }
    let found = match (number, launched_count()) {
        (Some(_), _) => "catalyst/mpi_comm".to_string(),
        (None, Some(count @ 2..)) => format!("{count} processes"),
        _ => return Ok(Arc::new(OneRank)),
    };
    let error = Error::usage("MPI has not been started").got(found);
    Err(error.expected("catalyst_initialize after MPI_Init"))
}

/// The only process: each of several would write the same files. Errors: several processes.
#[cfg(not(feature = "mpi"))]
fn processes(_parameters: &Node) -> Result<Arc<dyn Ranks>> {
    match launched_count() {
        Some(count @ 2..) => {
            let error =
                Error::usage("the library was built without MPI, and the simulation has several processes");
            let accepted = "one built by: scripts/install-catalyst.sh FOLDER --features mpi";
            Err(error.got(format!("{count} processes")).expected(accepted))
        }
        _ => Ok(Arc::new(OneRank)),
    }
}

/// `catalyst_execute`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn catalyst_execute_voltet(parameters: *const c_void) -> c_int {
    guarded("catalyst_execute", |simulation| {
        let simulation = simulation.as_mut().ok_or_else(uninitialized)?;
        // SAFETY: Catalyst's promise.
        simulation.execute(&unsafe { Node::root(parameters) }?)
    })
}

/// `catalyst_finalize`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn catalyst_finalize_voltet(_parameters: *const c_void) -> c_int {
    guarded("catalyst_finalize", |simulation| simulation.take().map(drop).ok_or_else(uninitialized))
}

/// `catalyst_about`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn catalyst_about_voltet(parameters: *mut c_void) -> c_int {
    guarded("catalyst_about", |_| {
        // SAFETY: Catalyst's promise.
        let node = unsafe { Node::root(parameters) }?;
        node.set_text("catalyst/implementation", "voltet");
        node.set_text("catalyst/abi_version", "2");
        node.set_integer("catalyst/use_mpi", i32::from(cfg!(feature = "mpi")));
        node.set_text("voltet/version", env!("CARGO_PKG_VERSION"));
        Ok(())
    })
}

/// `catalyst_results`: there are none; pictures are files.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn catalyst_results_voltet(_parameters: *mut c_void) -> c_int {
    DONE
}

fn uninitialized() -> Error {
    Error::usage("the simulation is not initialized").expected("catalyst_initialize before, which succeeds")
}
