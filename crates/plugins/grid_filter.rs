//! A grid filter of a plug-in: its call, and the node that it is.

use crate::describe::{Declared, Family};
use crate::foreign::{Wrong, sized};
use crate::grids::{Buffers, Head};
use crate::host::State;
use crate::interface::{
    ERROR, FilterGrid, GivenArray, GridBuffers, GridCall, GridHead, OK, SAME_CELLS, SAME_POINTS,
};
use crate::node;
use crate::outcome::Said;
use crate::resulting::resulting;
use crate::runner::Offered;
use crate::task::{Outcome, Task};
use crate::values::{Owned, array_names, array_pointers, arrays};
use std::ffi::CString;
use std::mem::size_of;
use std::ptr::{from_ref, null};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::{Array, Grid};
use voltet_core::{Error, Result};
use voltet_graph::{DemandContext, Node, Outputs, Port, PortType, RunContext, Value};

/// What a grid filter is given.
pub(crate) struct GivenGrid {
    /// Points and tetrahedra.
    pub grid: Grid,
    /// The arrays that the grid carries, the scalar first.
    pub carried: Vec<(CString, Array)>,
    /// Whether the first of them is the scalar that is drawn.
    pub has_scalar: bool,
    /// For each parameter the array that it names.
    pub arrays: Vec<Option<Arc<Array>>>,
    pub values: Owned,
    /// Bytes that it may take, where somebody knows.
    pub memory_left: Option<u64>,
}

/// The host's side of a call.
struct Inside<'a> {
    state: &'a State,
    given: &'a GivenGrid,
    begun: Mutex<Option<Begun>>,
}

/// What was handed out.
struct Begun {
    head: Head,
    buffers: Buffers,
    /// Where the arrays go, for the plug-in to read.
    places: Vec<*mut f64>,
}

unsafe extern "C-unwind" fn begin(
    call: *const GridCall,
    head: *const GridHead,
    buffers: *mut GridBuffers,
) -> i32 {
    // SAFETY: the plug-in hands over the call that it was given, while it lasts.
    let inside = unsafe { call.as_ref().and_then(|call| call.context.cast::<Inside>().as_ref()) };
    let Some(inside) = inside else { return ERROR };
    let mut known = inside.begun.lock().unwrap_or_else(PoisonError::into_inner);
    let begun = match &*known {
        Some(_) => Err("it began its grid twice".to_string()),
        None => inside.given.begun(head).and_then(|begun| sized(buffers.cast_const()).map(|_| begun)),
    };
    match begun {
        Ok(begun) => {
            let begun = known.insert(begun);
            begun.places = begun.buffers.places();
            let shown = begun.buffers.interface(&begun.head, &begun.places);
            // SAFETY: the struct is there and as large, as was just looked at; the filter handed it over to be filled.
            unsafe { buffers.write(shown) };
            OK
        }
        Err(wrong) => {
            inside.state.complain(wrong);
            ERROR
        }
    }
}

impl GivenGrid {
    /// Errors: an array that is not there.
    fn new(declared: &Declared, grid: &Grid, call: &RunContext) -> Result<GivenGrid> {
        let text = |name: &str| {
            CString::new(name).map_err(|_| Error::run("the name of an array has a character 0").got(name))
        };
        let mut carried = Vec::new();
        if let Some(scalar) = &grid.scalar {
            carried.push((text(&grid.scalar_name)?, Array { component_count: 1, values: scalar.clone() }));
        }
        let has_scalar = !carried.is_empty();
        for (name, array) in
            grid.point_arrays.iter().filter(|(name, _)| !has_scalar || **name != grid.scalar_name)
        {
            carried.push((text(name)?, Array::clone(array)));
        }
        Ok(GivenGrid {
            grid: Grid {
                points: grid.points.clone(),
                tetrahedra: grid.tetrahedra.clone(),
                ..Grid::default()
            },
            carried,
            has_scalar,
            arrays: arrays(declared, call.parameters, grid)?,
            values: Owned::new(declared, call.parameters)?,
            memory_left: call.progress().memory_left(),
        })
    }

    /// Memory for the grid of that head, with the counts of what it shares with the input.
    fn begun(&self, head: *const GridHead) -> std::result::Result<Begun, Wrong> {
        let mut head = Head::read(head)?;
        let (points, cells) = (self.grid.points.len(), self.grid.tetrahedra.len());
        if head.is(SAME_POINTS) {
            head.point_count = points;
        }
        if head.is(SAME_CELLS) {
            head.cell_count = cells;
            if head.point_count != points {
                let given = head.point_count;
                return Err(format!(
                    "its cells are those of the input, but it has {given} points and the input {points}"
                ));
            }
        }
        let wanted = vec![true; head.arrays.len()];
        let buffers = Buffers::new(&head, true, &wanted, self.memory_left)?;
        Ok(Begun { head, buffers, places: Vec::new() })
    }

    /// Calls the function that filters.
    pub fn filter(&self, function: FilterGrid, state: &State) -> (Said, Outcome) {
        let given = |(name, array): &(CString, Array)| GivenArray {
            size: size_of::<GivenArray>() as u32,
            component_count: array.component_count as u32,
            name: name.as_ptr(),
            values: array.values.as_ptr(),
        };
        let carried: Vec<GivenArray> = self.carried.iter().map(given).collect();
        let arrays = array_pointers(&self.arrays);
        let pointers = self.values.pointers();
        let values = self.values.by(&pointers);
        let inside = Inside { state, given: self, begun: Mutex::new(None) };
        let call = GridCall {
            size: size_of::<GridCall>() as u32,
            array_count: carried.len() as u32,
            point_count: self.grid.points.len() as u64,
            cell_count: self.grid.tetrahedra.len() as u64,
            // Three doubles a point and four numbers a cell, side by side.
            points: self.grid.points.as_ptr().cast(),
            tetrahedra: self.grid.tetrahedra.as_ptr().cast(),
            carried: carried.as_ptr(),
            scalar: self
                .carried
                .first()
                .filter(|_| self.has_scalar)
                .map_or(null(), |(name, _)| name.as_ptr()),
            arrays: arrays.as_ptr(),
            values: &values,
            begin,
            context: from_ref(&inside).cast_mut().cast(),
        };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&call, &state.host()) };
        match inside.begun.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(Begun { head, mut buffers, .. }) => {
                let beyond = buffers.close(&head);
                (Said { beyond, ..Said::new(code, state) }, Outcome::Grid(head, buffers))
            }
            None => {
                if code == OK {
                    state.complain("it did not begin one (call->begin)".into());
                }
                (Said::new(code, state), Outcome::Nothing)
            }
        }
    }
}

/// The node.
pub(crate) fn node(offered: Offered) -> &'static Node {
    let grid = |summary| Port { name: "grid", port_type: PortType::Grid, summary };
    let [inputs, outputs] =
        [grid("points, cells, arrays"), grid("what it makes of them")].map(|port| [port].to_vec().leak());
    let example =
        node::example(offered.declared.kind, "grid", "grid", "grid = \"filtered\", volume = \"filtered\"");
    let (of_run, of_demand) = (offered.clone(), offered.clone());
    node::leaked(&offered, |node| Node {
        inputs,
        outputs,
        example,
        demand: node::leak(move |asking: &mut DemandContext| demand(&of_demand, asking)),
        run: node::leak(move |call: &mut RunContext| run(&of_run, call)),
        ..node
    })
}

/// What is asked of its output but for what it makes itself, and the arrays that its parameters name.
fn demand(offered: &Offered, asking: &mut DemandContext) -> Result<()> {
    let mut ask = asking.asked.clone();
    made(offered).iter().for_each(|name| ask.arrays.remove(name));
    ask.arrays.extend(array_names(&offered.declared, asking.parameters));
    asking.ask("grid", &ask)
}

fn made(offered: &Offered) -> &'static [&'static str] {
    match offered.declared.family {
        Family::GridFilter { made } => made,
        Family::GradientFilter { .. } | Family::Reader { .. } | Family::ImageFilter => &[],
    }
}

fn run(offered: &Offered, call: &mut RunContext) -> Result<Outputs> {
    let input = call.grid("grid")?;
    let given = GivenGrid::new(&offered.declared, &input, call)?;
    let (said, (head, buffers)) = offered.run(Task::Grid(Box::new(given)), call.progress(), Outcome::grid)?;
    let made = buffers.judged(&head, head.point_count, offered.whose())?;
    let grid = resulting(&input, head, made, call.demand, offered.whose(), call.progress())?;
    if !Arc::ptr_eq(&grid.origin, &input.origin) {
        call.notes.warnings.extend(grid.origin.warnings.iter().cloned());
    }
    call.notes.warnings.extend(offered.whose().warnings(&said));
    Ok(vec![Value::Grid(Arc::new(grid))])
}
