//! What a module declares: copied out of it as the header's structs of this program, which [`crate::describe`] reads and checks.

use super::guest::{Guest, Handed};
use super::layout::{entry, factory, filter, parameter, plugin};
use super::sandbox::{Running, Sandbox, said};
use crate::describe::{self, Declared, PARAMETERS_MOST};
use crate::foreign::Wrong;
use crate::host::State;
use crate::interface::{self, Call, Check, GRADIENT_FILTERS, Gradient, Host, Values};
use crate::library::{filter_count, refuse_same_names};
use crate::parameters::VECTOR_MOST;
use std::ffi::c_char;
use std::sync::Arc;

/// Name and version, and the filters in their order.
pub(super) fn read(sandbox: &Sandbox) -> Result<([String; 2], Vec<Declared>), Wrong> {
    let state = Arc::default();
    let (mut running, _) = sandbox.start(&state, None)?;
    let begun = begin(&mut running, &state)?;
    let mut own = Own::default();
    let named = own.plugin(&running, begun.plugin)?;
    let names = describe::plugin(&named)?;
    let mut filters: Vec<Declared> = Vec::new();
    for place in 0..begun.count {
        let at = |wrong: Wrong| format!("filter {place}: {wrong}");
        let address = begun.filter(&mut running, place).map_err(at)?;
        let described = own.filter(&mut running, address).map_err(at)?;
        let declared = describe::gradient_filter(&described).map_err(at)?.declared;
        filters.push(declared);
    }
    refuse_same_names(&filters)?;
    Ok((names, filters))
}

/// A module after init.
pub(super) struct Begun {
    plugin: u32,
    count: u32,
    filter: wasmtime::TypedFunc<u32, u32>,
    /// The address of the host's struct.
    pub host: u32,
}

impl Begun {
    /// The address of a filter's description.
    pub fn filter(&self, running: &mut Running, place: u32) -> Result<u32, Wrong> {
        self.filter.call(&mut running.store, place).map_err(|error| said(&error))
    }
}

/// Calls init and asks for the filters.
pub(super) fn begin(running: &mut Running, state: &State) -> Result<Begun, Wrong> {
    let missing = |name: &str| format!("the function '{name}' is a null pointer");
    let entry = running.entry()?;
    let init =
        running.function::<(u32, u32), u32>("init", entry + entry::INIT)?.ok_or_else(|| missing("init"))?;
    let get_factory = running.function::<u32, u32>("get_factory", entry + entry::GET_FACTORY)?;
    let get_factory = get_factory.ok_or_else(|| missing("get_factory"))?;
    let mut handed = Handed::behind(running.memory, &running.store);
    // Where its file lies is nobody's business in a sandbox.
    let path = handed.text(b"");
    let kind = handed.text(GRADIENT_FILTERS.to_bytes());
    let host = running.host(&mut handed);
    if !handed.give(running.memory, &mut running.store) {
        return Err("its memory cannot grow".into());
    }
    let plugin = init.call(&mut running.store, (path, host)).map_err(|error| said(&error))?;
    if plugin == 0 {
        return Err(match state.error() {
            Some(text) => format!("it says: {text}"),
            None => "its init gave nothing, and no reason".into(),
        });
    }
    let factory = get_factory.call(&mut running.store, kind).map_err(|error| said(&error))?;
    if factory == 0 {
        return Err("it has no gradient filters (get_factory gave nothing), and a sandbox runs these alone: readers, grid filters and image \
                    filters need a shared library".into());
    }
    running.sized(factory, "voltet_gradient_factory", factory::SIZE)?;
    let count = running.function::<(), u32>("filter_count", factory + factory::FILTER_COUNT)?;
    let count = count.ok_or_else(|| missing("filter_count"))?;
    let filter = running.function::<u32, u32>("filter", factory + factory::FILTER)?;
    let filter = filter.ok_or_else(|| missing("filter"))?;
    let count = count.call(&mut running.store, ()).map_err(|error| said(&error))?;
    Ok(Begun { plugin, count: filter_count(count)?, filter, host })
}

/// What the copied structs point to.
#[derive(Default)]
struct Own {
    texts: Vec<Vec<u8>>,
    numbers: Vec<Vec<f64>>,
    lists: Vec<Vec<*const c_char>>,
    parameters: Vec<Vec<interface::Parameter>>,
}

impl Own {
    fn text(&mut self, guest: Guest<'_>, address: u32) -> Result<*const c_char, Wrong> {
        let Some(mut text) = guest.text(address)? else { return Ok(std::ptr::null()) };
        text.push(0);
        let pointer = text.as_ptr().cast();
        self.texts.push(text);
        Ok(pointer)
    }

    fn plugin(&mut self, running: &Running, address: u32) -> Result<interface::Plugin, Wrong> {
        running.sized(address, "voltet_plugin", plugin::SIZE)?;
        let guest = running.guest();
        let name = self.text(guest, guest.read(address + plugin::NAME)?)?;
        let version = self.text(guest, guest.read(address + plugin::VERSION)?)?;
        Ok(interface::Plugin { size: size_of::<interface::Plugin>() as u32, reserved: 0, name, version })
    }

    fn filter(&mut self, running: &mut Running, address: u32) -> Result<interface::GradientFilter, Wrong> {
        running.sized(address, "voltet_gradient_filter", filter::SIZE)?;
        let guest = running.guest();
        let name = self.text(guest, guest.read(address + filter::NAME)?)?;
        let summary = self.text(guest, guest.read(address + filter::SUMMARY)?)?;
        let parameter_count = guest.read::<u32>(address + filter::PARAMETER_COUNT)?;
        let (needs, begin): (u32, u32) =
            (guest.read(address + filter::NEEDS)?, guest.read(address + filter::PARAMETERS)?);
        let mut parameters = Vec::new();
        let mut stride: u32 = 0;
        // More are refused without a look at them.
        for i in 0..if parameter_count > PARAMETERS_MOST { 0u32 } else { parameter_count } {
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

    fn parameter(&mut self, guest: Guest<'_>, address: u32) -> Result<interface::Parameter, Wrong> {
        let number = |at: u32| guest.read::<u32>(address + at);
        let float = |at: u32| guest.read::<f64>(address + at);
        let mut text = |at: u32| self.text(guest, number(at)?);
        let [name, unit, help] = [text(parameter::NAME)?, text(parameter::UNIT)?, text(parameter::HELP)?];
        let [default, unset] = [text(parameter::TEXT)?, text(parameter::UNSET)?];
        let (length, word_count) = (number(parameter::LENGTH)?, number(parameter::WORD_COUNT)?);
        let numbers = match number(parameter::NUMBERS)? {
            0 => std::ptr::null(),
            // A longer one is refused without a look at it.
            at => {
                let numbers = guest.list::<f64>(at, length.min(VECTOR_MOST) as usize)?;
                let pointer = numbers.as_ptr();
                self.numbers.push(numbers);
                pointer
            }
        };
        let mut words = |at: u32| -> Result<*const *const c_char, Wrong> {
            let list = number(at)?;
            if list == 0 {
                return Ok(std::ptr::null());
            }
            let words = guest.list::<u32>(list, word_count.min(PARAMETERS_MOST) as usize)?;
            let words =
                words.into_iter().map(|word| self.text(guest, word)).collect::<Result<Vec<_>, _>>()?;
            let pointer = words.as_ptr();
            self.lists.push(words);
            Ok(pointer)
        };
        let (words, meanings) = (words(parameter::WORDS)?, words(parameter::MEANINGS)?);
        Ok(interface::Parameter {
            size: size_of::<interface::Parameter>() as u32,
            parameter_type: number(parameter::TYPE)?,
            name,
            unit,
            help,
            flags: number(parameter::FLAGS)?,
            length,
            least: float(parameter::LEAST)?,
            most: float(parameter::MOST)?,
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

/// Stands for a function of the module: that there is one.
unsafe extern "C-unwind" fn no_check(_: *const Values, _: *const Host) -> i32 {
    interface::ERROR
}

/// The same.
unsafe extern "C-unwind" fn no_gradient(_: *const Call, _: *const Host) -> i32 {
    interface::ERROR
}
