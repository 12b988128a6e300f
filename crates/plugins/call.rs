//! One call of a plug-in with its inputs, and its outputs: alike in this process, in one of its own, and in a sandbox. Functions of
//! loaded libraries are called here.

use crate::declaration::{EntryPoint, Family, LibraryItem};
use crate::ffi::{AddressSpace, CheckResult, Overrun, Process, guarded_vec, remove_guard};
use crate::grids::{Buffers, Head, refuse_flags};
use crate::host::{CallStatus, State};
use crate::inputs::Inputs;
use crate::interface::{
    ERROR, FilterGrid, FilterImage, GivenArray, Gradient, GradientCall, GridBuffers, GridCall, GridHead,
    ImageCall, NEEDS_BOUNDARY, NEEDS_CELLS_OF_POINTS, NEEDS_NEIGHBOURS, NEEDS_SECOND_RINGS, OK, Read,
    Reading, SAME_CELLS, SAME_POINTS, TETRAHEDRA, Values,
};
use crate::values::{NamedArrays, ParameterValues, add_arrays, array_pointers};
use crate::wire::wire;
use std::ffi::CString;
use std::mem::size_of;
use std::ptr::{from_ref, null, null_mut};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::counted;
use voltet_core::glam::DVec3;
use voltet_core::grid::{Array, Csr, Grid, cells_of_faces, cells_of_points, points_of_points, second_rings};
use voltet_core::picture::Picture;

/// One call with its inputs. These are owned or shared, so that a call that never returns harms nothing.
pub(crate) enum Task {
    Check(ParameterValues),
    /// Computation of the gradient at every point.
    Gradient(GradientTask),
    Inspect(FileStep),
    Read(ReadTask),
    Grid(GridTask),
    Image(ImageTask),
}

wire!(variants of Task {
    0 = Check(values),
    1 = Gradient(task),
    2 = Inspect(file),
    3 = Read(task),
    4 = Grid(task),
    5 = Image(task)
});

/// Output of a call.
#[derive(Default)]
pub(crate) enum Outcome {
    /// Only the status.
    #[default]
    Nothing,
    Vectors(Vec<DVec3>),
    /// Contents of a file.
    Head(Head),
    /// A grid, or parts of it. The counts of a grid filter are those of the whole grid, whatever it shares with the input.
    Grid(Head, Buffers),
    Pixels(Vec<[f32; 4]>),
}

wire!(variants of Outcome { 0 = Nothing, 1 = Vectors(vectors), 2 = Head(head), 3 = Grid(head, buffers), 4 = Pixels(pixels) });

pub(crate) type CallOutput = (CallStatus, Outcome);

impl Outcome {
    /// True if the counts of a grid are within their limits, and its arrays as long as they say: a damaged process may send any.
    pub fn is_consistent(&self) -> bool {
        match self {
            Outcome::Head(head) => head.is_within_limits(),
            Outcome::Grid(head, buffers) => head.is_within_limits() && buffers.fit(head),
            Outcome::Nothing | Outcome::Vectors(_) | Outcome::Pixels(_) => true,
        }
    }
}

impl Task {
    pub fn stage(&self) -> &'static str {
        match self {
            Task::Check(_) => "check",
            Task::Gradient(_) => "gradient",
            Task::Inspect(_) | Task::Read(_) => "reading",
            Task::Grid(_) | Task::Image(_) => "filter",
        }
    }

    /// Calls the function of a loaded library. An item of another family gives no output.
    pub fn run(self, item: &LibraryItem, state: &State) -> CallOutput {
        let called = match (self, item.function, item.declaration.family) {
            (Task::Check(values), ..) => {
                let Some(check) = item.check else { return Default::default() };
                let (pointers, inputs) = (values.pointers(), values.inputs());
                // SAFETY: the plug-in's own function; all that it is given lives through the call.
                let code = unsafe { check(&values.header_values(&pointers), &state.host()) };
                inputs.refuse_changes(state);
                Ok((code, None, Outcome::Nothing))
            }
            (
                Task::Gradient(task),
                EntryPoint::Gradient(Some(function)),
                Family::GradientFilter { needs },
            ) => task.run(function, needs, state),
            (Task::Inspect(file), EntryPoint::Reader { inspect: Some(inspect), .. }, _) => {
                file.inspect(inspect, state)
            }
            (Task::Read(task), EntryPoint::Reader { read: Some(read), .. }, _) => task.run(read, state),
            (Task::Grid(task), EntryPoint::GridFilter(Some(function)), _) => task.run(function, state),
            (Task::Image(task), EntryPoint::ImageFilter(Some(function)), _) => task.run(function, state),
            _ => return Default::default(),
        };
        let (code, overrun, outcome) = called.unwrap_or_else(|refusal| {
            state.refuse(refusal);
            (ERROR, None, Outcome::Nothing)
        });
        (CallStatus { overrun, ..CallStatus::new(code, state) }, outcome)
    }
}

/// Return code, first overrun, and output of a function; or the reason to refuse what it did, or not to call it.
type Called = CheckResult<(i32, Option<Overrun>, Outcome)>;

/// Computation of the gradient at every point.
pub(crate) struct GradientTask {
    /// Points and tetrahedra.
    pub grid: Grid,
    pub scalar: Vec<f64>,
    pub values: ParameterValues,
    pub arrays: NamedArrays,
}

wire!(fields of GradientTask { grid, scalar, values, arrays });

/// Starts and items of the rows of a compressed table.
pub(crate) type Rows64 = (Vec<u64>, Vec<u32>);

fn rows_64(Csr { starts, items }: Csr) -> Rows64 {
    // The same memory where both are of 64 bits.
    let widened = |(_, starts): (_, Vec<usize>)| starts.into_iter().map(|start| start as u64).collect();
    (bytemuck::try_cast_vec(starts).unwrap_or_else(widened), items)
}

/// Tables of the grid that a filter may request; `None` for those that it does not.
#[derive(Default)]
pub(crate) struct Tables {
    pub neighbours: Option<Rows64>,
    pub cells_of_points: Option<Rows64>,
    /// 1 for points of faces that one cell alone has.
    pub at_boundary: Option<Vec<u8>>,
    /// Neighbours and their neighbours.
    pub second_rings: Option<Rows64>,
}

impl Tables {
    fn rows(&self) -> [(&'static str, &Option<Rows64>); 3] {
        [
            ("the neighbours of points", &self.neighbours),
            ("the cells of points", &self.cells_of_points),
            ("the second rings of points", &self.second_rings),
        ]
    }
}

/// Flags of the points of faces that one cell alone has.
fn at_boundary(grid: &Grid) -> Vec<u8> {
    let mut flags = vec![0; grid.points.len()];
    for (face, other) in cells_of_faces(grid).into_iter().enumerate() {
        if other == u32::MAX {
            let corners =
                grid.tetrahedra[face / 4].iter().enumerate().filter(|(corner, _)| *corner != face % 4);
            corners.for_each(|(_, &p)| flags[p as usize] = 1);
        }
    }
    flags
}

impl GradientTask {
    /// Tables of the grid that the flags `needs` request.
    pub fn tables(&self, needs: u32) -> Tables {
        let is_needed = |flag: u32| needs & flag != 0;
        let [needs_neighbours, needs_rings] = [NEEDS_NEIGHBOURS, NEEDS_SECOND_RINGS].map(is_needed);
        let needs_rows = needs_neighbours || needs_rings;
        let needs_cells = is_needed(NEEDS_CELLS_OF_POINTS);
        let cells = (needs_rows || needs_cells).then(|| cells_of_points(&self.grid));
        let neighbours = cells.as_ref().filter(|_| needs_rows);
        let neighbours = neighbours.map(|cells| points_of_points(&self.grid, cells));
        let rings = neighbours.as_ref().filter(|_| needs_rings).map(second_rings);
        Tables {
            neighbours: neighbours.filter(|_| needs_neighbours).map(rows_64),
            cells_of_points: cells.filter(|_| needs_cells).map(rows_64),
            at_boundary: is_needed(NEEDS_BOUNDARY).then(|| at_boundary(&self.grid)),
            second_rings: rings.map(rows_64),
        }
    }

    fn run(self, function: Gradient, needs: u32, state: &State) -> Called {
        let point_count = self.grid.points.len();
        // The first touch of fresh memory takes its time, too.
        let (tables, vectors) = rayon::join(|| self.tables(needs), || guarded_vec::<DVec3, f64>(point_count));
        let starts = |rows: &Option<Rows64>| rows.as_ref().map_or(null(), |rows| rows.0.as_ptr());
        let items = |rows: &Option<Rows64>| rows.as_ref().map_or(null(), |rows| rows.1.as_ptr());
        let arrays = array_pointers(&self.arrays);
        let pointers = self.values.pointers();
        let values = self.values.header_values(&pointers);
        let mut vectors = vectors?;
        let mut inputs = self.values.inputs();
        inputs.add("the points", &self.grid.points);
        inputs.add("the cells", &self.grid.tetrahedra);
        inputs.add_own("the values of the scalar", &self.scalar);
        for (name, rows) in tables.rows() {
            let Some((starts, items)) = rows else { continue };
            inputs.add_own(name, starts);
            inputs.add_own(name, items);
        }
        if let Some(flags) = &tables.at_boundary {
            inputs.add_own("the flags of the boundary", flags);
        }
        add_arrays(&mut inputs, &self.arrays);
        let call = GradientCall {
            size: size_of::<GradientCall>() as u32,
            reserved: 0,
            point_count: point_count as u64,
            cell_count: self.grid.tetrahedra.len() as u64,
            // Three doubles a point and four numbers a cell, side by side.
            points: self.grid.points.as_ptr().cast(),
            cells: self.grid.tetrahedra.as_ptr().cast(),
            neighbour_starts: starts(&tables.neighbours),
            neighbours: items(&tables.neighbours),
            cell_starts: starts(&tables.cells_of_points),
            cells_of_points: items(&tables.cells_of_points),
            scalar: self.scalar.as_ptr(),
            arrays: arrays.as_ptr(),
            values: &values,
            gradient: vectors.as_mut_ptr().cast(),
            at_boundary: tables.at_boundary.as_ref().map_or(null(), |flags| flags.as_ptr()),
            second_ring_starts: starts(&tables.second_rings),
            second_rings: items(&tables.second_rings),
        };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&call, &state.host()) };
        inputs.refuse_changes(state);
        let overrun =
            remove_guard::<_, f64>(&mut vectors, point_count).then(|| Overrun::gradient(point_count));
        Ok((code, overrun, Outcome::Vectors(vectors)))
    }
}

#[derive(Clone)]
pub(crate) struct FileStep {
    pub path: CString,
    pub step: u64,
    pub values: ParameterValues,
}

pub(crate) struct ReadTask {
    pub file: FileStep,
    /// Contents of the file, as described.
    pub head: Head,
    /// True if points and cells are requested.
    pub geometry: bool,
    /// For each array of the head, true if it is requested.
    pub arrays: Vec<bool>,
    /// Memory that it may take (bytes), if known.
    pub memory_left: Option<u64>,
}

wire!(fields of FileStep { path, step, values });
wire!(fields of ReadTask { file, head, geometry, arrays, memory_left });

/// The host's side of a description.
struct DescriptionContext<'a> {
    state: &'a State,
    head: Mutex<Option<Head>>,
}

unsafe extern "C-unwind" fn describe(reading: *const Reading, head: *const GridHead) -> i32 {
    // SAFETY: the plug-in hands over the reading that it was given, during the call.
    let host =
        unsafe { reading.as_ref().and_then(|reading| reading.context.cast::<DescriptionContext>().as_ref()) };
    let Some(host) = host else { return ERROR };
    let read = Head::read(head).and_then(|head| refuse_flags(head.flags, TETRAHEDRA).map(|()| head));
    let mut known = host.head.lock().unwrap_or_else(PoisonError::into_inner);
    match read {
        Ok(_) if known.is_some() => host.state.refuse("it described its file twice".into()),
        Err(wrong) => host.state.refuse(wrong),
        Ok(head) => {
            *known = Some(head);
            return OK;
        }
    }
    ERROR
}

impl FileStep {
    fn reading(&self, values: &Values) -> Reading {
        Reading {
            size: size_of::<Reading>() as u32,
            reserved: 0,
            path: self.path.as_ptr(),
            step: self.step,
            values,
            describe: None,
            buffers: null(),
            context: null_mut(),
        }
    }

    fn inputs(&self) -> Inputs {
        let mut inputs = self.values.inputs();
        inputs.add("the characters of the path", self.path.as_bytes_with_nul());
        inputs
    }

    fn inspect(self, inspect: Read, state: &State) -> Called {
        let (pointers, inputs) = (self.values.pointers(), self.inputs());
        let values = self.values.header_values(&pointers);
        let host = DescriptionContext { state, head: Mutex::new(None) };
        let context = from_ref(&host).cast_mut().cast();
        let reading = Reading { describe: Some(describe), context, ..self.reading(&values) };
        // SAFETY: the plug-in's own function; what it is given lives through the call.
        let code = unsafe { inspect(&reading, &state.host()) };
        inputs.refuse_changes(state);
        let head = host.head.into_inner().unwrap_or_else(PoisonError::into_inner);
        match head {
            None if code == OK => Err("it did not say what the file holds (reading->describe)".into()),
            head => Ok((code, None, head.map(Outcome::Head).unwrap_or_default())),
        }
    }
}

impl ReadTask {
    fn run(self, read: Read, state: &State) -> Called {
        let ReadTask { file, head, geometry, arrays, memory_left } = self;
        let mut buffers = Buffers::new(&head, geometry, &arrays, memory_left)?;
        let (pointers, inputs) = (file.values.pointers(), file.inputs());
        let values = file.values.header_values(&pointers);
        let addresses = buffers.array_addresses();
        let header_buffers = buffers.header_buffers(&head, &addresses);
        let reading = Reading { buffers: &header_buffers, ..file.reading(&values) };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { read(&reading, &state.host()) };
        inputs.refuse_changes(state);
        Ok((code, buffers.close(&head), Outcome::Grid(head, buffers)))
    }
}

pub(crate) struct GridTask {
    /// Points and tetrahedra.
    pub grid: Grid,
    /// Point arrays of the grid, the scalar first.
    pub carried: Vec<(CString, Array)>,
    /// True if the first of them is the scalar that is drawn.
    pub has_scalar: bool,
    pub arrays: NamedArrays,
    pub values: ParameterValues,
    /// Memory that it may take (bytes), if known.
    pub memory_left: Option<u64>,
}

wire!(fields of GridTask { grid, carried, has_scalar, arrays, values, memory_left });

/// The host's side of the call of a grid filter.
struct FilterContext<'a> {
    state: &'a State,
    task: &'a GridTask,
    output: Mutex<Option<OutputGrid>>,
}

/// Memory handed to the plug-in.
struct OutputGrid {
    head: Head,
    buffers: Buffers,
    /// Addresses of the arrays, which the plug-in reads.
    addresses: Vec<*mut f64>,
}

unsafe extern "C-unwind" fn begin(
    call: *const GridCall,
    head: *const GridHead,
    buffers: *mut GridBuffers,
) -> i32 {
    // SAFETY: the plug-in hands over the call that it was given, while it lasts.
    let host = unsafe { call.as_ref().and_then(|call| call.context.cast::<FilterContext>().as_ref()) };
    let Some(host) = host else { return ERROR };
    let mut known = host.output.lock().unwrap_or_else(PoisonError::into_inner);
    let output = match &*known {
        Some(_) => Err("it began its grid twice".to_string()),
        None => host
            .task
            .allocate(head)
            .and_then(|output| Process.sized::<GridBuffers>(buffers as usize).map(|_| output)),
    };
    match output {
        Ok(output) => {
            let output = known.insert(output);
            output.addresses = output.buffers.array_addresses();
            let header_buffers = output.buffers.header_buffers(&output.head, &output.addresses);
            // SAFETY: the struct is there and as large, as was just checked; the filter handed it over to be filled.
            unsafe { buffers.write(header_buffers) };
            OK
        }
        Err(wrong) => {
            host.state.refuse(wrong);
            ERROR
        }
    }
}

impl GridTask {
    /// Memory for the grid of that head, with the counts of the parts that it shares with the input.
    fn allocate(&self, head: *const GridHead) -> CheckResult<OutputGrid> {
        let mut head = Head::read(head)?;
        let (points, cells) = (self.grid.points.len(), self.grid.tetrahedra.len());
        if head.has(SAME_POINTS) {
            head.point_count = points;
        }
        if head.has(SAME_CELLS) {
            head.cell_count = cells;
            if head.point_count != points {
                let own = counted(head.point_count, "point");
                return Err(format!(
                    "its cells are those of the input, but it has {own} and the input {points}"
                ));
            }
        }
        let buffers = Buffers::new(&head, true, &vec![true; head.arrays.len()], self.memory_left)?;
        Ok(OutputGrid { head, buffers, addresses: Vec::new() })
    }

    fn run(self, function: FilterGrid, state: &State) -> Called {
        let header_array = |(name, array): &(CString, Array)| GivenArray {
            size: size_of::<GivenArray>() as u32,
            component_count: array.component_count as u32,
            name: name.as_ptr(),
            values: array.values.as_ptr(),
        };
        let carried: Vec<GivenArray> = self.carried.iter().map(header_array).collect();
        let scalar = self.carried.first().filter(|_| self.has_scalar);
        let arrays = array_pointers(&self.arrays);
        let pointers = self.values.pointers();
        let values = self.values.header_values(&pointers);
        let mut inputs = self.values.inputs();
        inputs.add("the points", &self.grid.points);
        inputs.add("the tetrahedra", &self.grid.tetrahedra);
        for (name, array) in &self.carried {
            inputs.add("the names of the arrays", name.as_bytes_with_nul());
            inputs.add("the values of the arrays", &array.values);
        }
        add_arrays(&mut inputs, &self.arrays);
        let host = FilterContext { state, task: &self, output: Mutex::new(None) };
        let call = GridCall {
            size: size_of::<GridCall>() as u32,
            array_count: carried.len() as u32,
            point_count: self.grid.points.len() as u64,
            cell_count: self.grid.tetrahedra.len() as u64,
            // Three doubles a point and four numbers a cell, side by side.
            points: self.grid.points.as_ptr().cast(),
            tetrahedra: self.grid.tetrahedra.as_ptr().cast(),
            carried: carried.as_ptr(),
            scalar: scalar.map_or(null(), |(name, _)| name.as_ptr()),
            arrays: arrays.as_ptr(),
            values: &values,
            begin,
            context: from_ref(&host).cast_mut().cast(),
        };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&call, &state.host()) };
        inputs.refuse_changes(state);
        match host.output.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(OutputGrid { head, mut buffers, .. }) => {
                Ok((code, buffers.close(&head), Outcome::Grid(head, buffers)))
            }
            None if code == OK => Err("it did not begin one (call->begin)".into()),
            None => Ok((code, None, Outcome::Nothing)),
        }
    }
}

pub(crate) struct ImageTask {
    pub picture: Arc<Picture>,
    pub values: ParameterValues,
}

wire!(fields of ImageTask { picture, values });
wire!(fields of Picture { width, height, rgba });

impl ImageTask {
    fn run(self, function: FilterImage, state: &State) -> Called {
        let Picture { width, height, rgba } = &*self.picture;
        let mut filtered = guarded_vec::<[f32; 4], f32>(rgba.len())?;
        let pointers = self.values.pointers();
        let values = self.values.header_values(&pointers);
        let mut inputs = self.values.inputs();
        inputs.add("the pixels", rgba);
        let call = ImageCall {
            size: size_of::<ImageCall>() as u32,
            reserved: 0,
            width: *width as u64,
            height: *height as u64,
            rgba: rgba.as_ptr().cast(),
            values: &values,
            filtered: filtered.as_mut_ptr().cast(),
        };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&call, &state.host()) };
        inputs.refuse_changes(state);
        let overrun = remove_guard::<_, f32>(&mut filtered, rgba.len()).then(|| Overrun {
            buffer: "the picture".into(),
            capacity: format!("4 numbers for each of the {width} x {height} pixels"),
        });
        Ok((code, overrun, Outcome::Pixels(filtered)))
    }
}
