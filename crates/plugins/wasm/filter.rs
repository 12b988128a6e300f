//! The filters of a module: each call starts the module anew, hands everything over, and takes the vectors out.

use super::declared::begin;
use super::guest::Handed;
use super::layout::filter;
use super::sandbox::{Running, Sandbox, said};
use crate::apart::{self, Lost};
use crate::describe::{Declared, Family};
use crate::foreign::Wrong;
use crate::grids::overran;
use crate::host::State;
use crate::outcome::{Beyond, Said, UNSET, Whose};
use crate::runner::Runner;
use crate::task::{Outcome, Task};
use crate::values::Owned;
use crate::work::{BEYOND, Given};
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::glam::DVec3;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Longest call of a filter.
const TIME_MOST: Duration = Duration::from_secs(600);

/// Longest check of parameters.
const CHECK_MOST: Duration = Duration::from_secs(3);

/// A module with its filters, by their places.
pub(super) struct Sandboxed {
    sandbox: Sandbox,
    plugin: Plugin,
    names: Vec<&'static str>,
}

impl Sandboxed {
    /// `filters`: in their order.
    pub fn new(sandbox: Sandbox, plugin: Plugin, filters: &[Declared]) -> Sandboxed {
        Sandboxed { sandbox, plugin, names: filters.iter().map(|declared| declared.kind.name).collect() }
    }

    /// Uses the module on a thread of its own; stopped where `ends` says so.
    fn used<T: Send + 'static>(
        &self,
        whose: Whose,
        state: &Arc<State>,
        memory_most: Option<u64>,
        work: impl FnOnce(&mut Running, u32, u32) -> std::result::Result<T, Wrong> + Send + 'static,
        mut ends: impl FnMut() -> bool,
    ) -> Result<T> {
        let failed = |wrong: Wrong| whose.error("failed in its sandbox").got(wrong);
        let (mut running, stop) = self.sandbox.start(state, memory_most).map_err(failed)?;
        let place = self.names.iter().position(|name| *name == whose.name()).unwrap_or(0) as u32;
        let of_use = state.clone();
        let work = move || {
            let begun = begin(&mut running, &of_use)?;
            let filter = begun.filter(&mut running, place)?;
            work(&mut running, filter, begun.host)
        };
        let mut stopped = false;
        let waits = || {
            stopped |= ends();
            if stopped {
                stop.stop();
            }
            true
        };
        match apart::run(work, waits) {
            Ok(outcome) => outcome.map_err(failed),
            Err(Lost::GivenUp | Lost::Ended | Lost::NoThread) => {
                Err(whose.error("cannot be run: the system gives no thread for it"))
            }
        }
    }
}

impl Runner for Sandboxed {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(&self, of: &Declared, task: Task, progress: &dyn Progress) -> Result<(Said, Outcome)> {
        let whose = Whose::new(of, &self.plugin);
        match (task, of.family) {
            (Task::Check(values), _) => self.check(whose, values),
            (Task::Gradient(given), Family::GradientFilter { needs }) => {
                self.gradient(whose, *given, needs, progress)
            }
            // Nothing else is described, so nothing else is asked.
            (
                Task::Gradient(_) | Task::Inspect(_) | Task::Read(..) | Task::Grid(_) | Task::Image(_),
                Family::GradientFilter { .. }
                | Family::Reader { .. }
                | Family::GridFilter { .. }
                | Family::ImageFilter,
            ) => Ok((Said::default(), Outcome::Nothing)),
        }
    }
}

impl Sandboxed {
    fn check(&self, whose: Whose, values: Owned) -> Result<(Said, Outcome)> {
        let (state, begun) = (Arc::<State>::default(), Instant::now());
        let of_call = state.clone();
        let work = move |running: &mut Running, filter: u32, host: u32| {
            let check = running.function::<(u32, u32), i32>("check", filter + filter::CHECK)?;
            let check = check.ok_or("its function 'check' is gone")?;
            let mut handed = Handed::behind(running.memory, &running.store);
            let values = put_values(&values, &mut handed);
            if !handed.give(running.memory, &mut running.store) {
                return Err("there is no memory for the parameters".into());
            }
            let code = check.call(&mut running.store, (values, host)).map_err(|error| said(&error))?;
            Ok((Said::new(code, &of_call), Outcome::Nothing))
        };
        self.used(whose, &state, None, work, || begun.elapsed() > CHECK_MOST)
    }

    fn gradient(
        &self,
        whose: Whose,
        given: Given,
        needs: u32,
        progress: &dyn Progress,
    ) -> Result<(Said, Outcome)> {
        let (state, begun) = (Arc::<State>::default(), Instant::now());
        let of_call = state.clone();
        let work = move |running: &mut Running, filter: u32, host: u32| {
            let gradient = running.function::<(u32, u32), i32>("gradient", filter + filter::GRADIENT)?;
            let gradient = gradient.ok_or("its function 'gradient' is gone")?;
            let mut handed = Handed::behind(running.memory, &running.store);
            let (call, out) = put_call(&given, needs, &mut handed);
            if !handed.give(running.memory, &mut running.store) {
                return Err("there is no memory for the grid: a module has 4 GiB at most".into());
            }
            let code = gradient.call(&mut running.store, (call, host)).map_err(|error| said(&error))?;
            let count = given.grid.points.len();
            let mut vectors: Vec<DVec3> = running.guest().list(out, count + BEYOND)?;
            let beyond = overran::<_, f64>(&mut vectors, count).then(|| Beyond::gradient(count));
            Ok((Said { beyond, ..Said::new(code, &of_call) }, Outcome::Vectors(vectors)))
        };
        let ends = || {
            progress.report("gradient", state.fraction());
            if progress.cancelled() {
                state.cancel();
            }
            progress.cancelled() || begun.elapsed() > TIME_MOST
        };
        match self.used(whose, &state, progress.memory_left(), work, ends) {
            Ok(done) => Ok(done),
            Err(_) if progress.cancelled() => Err(Error::cancelled()),
            Err(_) if begun.elapsed() > TIME_MOST => {
                let error = whose.error("was stopped");
                Err(error.got("no end").expected(format!("an end within {} s", TIME_MOST.as_secs())))
            }
            Err(error) => Err(error),
        }
    }
}

/// voltet_values.
fn put_values(values: &Owned, handed: &mut Handed) -> u32 {
    let parts = values.parts();
    let integers = handed.put(parts.integers);
    let numbers = handed.put(parts.numbers);
    let texts: Vec<u32> =
        parts.texts.iter().map(|text| text.as_ref().map_or(0, |text| handed.text(text.to_bytes()))).collect();
    let texts = handed.put(&texts);
    let vectors: Vec<u32> =
        parts.vectors.iter().map(|vector| vector.as_ref().map_or(0, |vector| handed.put(vector))).collect();
    let vectors = handed.put(&vectors);
    let lengths: Vec<u32> =
        parts.vectors.iter().map(|vector| vector.as_ref().map_or(0, |vector| vector.len() as u32)).collect();
    let lengths = handed.put(&lengths);
    handed.put(&[28, parts.integers.len() as u32, integers, numbers, texts, vectors, lengths])
}

/// voltet_call, and where the gradient goes.
fn put_call(given: &Given, needs: u32, handed: &mut Handed) -> (u32, u32) {
    let [neighbours, cells_of_points] = given.tables(needs).map(|table| match table {
        Some(table) => [handed.put(&table.starts), handed.put(&table.items)],
        None => [0; 2],
    });
    let (points, cells) = (handed.put(&given.grid.points), handed.put(&given.grid.tetrahedra));
    let scalar = handed.put(&given.scalar);
    let arrays: Vec<u32> = given
        .arrays
        .iter()
        .map(|array| array.as_ref().map_or(0, |array| handed.put(&array.values)))
        .collect();
    let arrays = handed.put(&arrays);
    let values = put_values(&given.values, handed);
    let out = handed.put(&vec![DVec3::splat(UNSET); given.grid.points.len() + BEYOND]);
    let [points_low, points_high] = halves(given.grid.points.len());
    let [cells_low, cells_high] = halves(given.grid.tetrahedra.len());
    let [starts, items] = neighbours;
    let [cell_starts, cell_items] = cells_of_points;
    let call = handed.put(&[
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
