//! Sizes and arrays of a grid that a plug-in describes: copied and checked before anything is allocated.

use crate::ffi::{ValidationError, several, sized, values};
use crate::interface::{GridHead, SAME_CELLS, SAME_POINTS, TETRAHEDRA};
use crate::text::{line, required};
use crate::wire::wire;

/// Longest name of an array or a format (bytes).
const MAX_TEXT_BYTES: usize = 1024;

/// Largest numbers of arrays, components and steps.
const MAX_ARRAYS: u32 = 4096;
const MAX_COMPONENTS: u32 = 1024;
const MAX_STEPS: u32 = 1 << 20;

/// Largest number of point numbers of all cells.
const MAX_COUNT: u64 = 1 << 36;

/// `voltet_grid_head`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Head {
    pub flags: u32,
    pub point_count: usize,
    pub cell_count: usize,
    pub connectivity_count: usize,
    pub arrays: Vec<ArrayRecord>,
    pub scalar: Option<String>,
    pub times: Vec<f64>,
    pub format: Option<String>,
}

/// `voltet_array_head`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ArrayRecord {
    pub name: String,
    pub component_count: usize,
    pub on_cells: bool,
}

wire!(struct Head { flags, point_count, cell_count, connectivity_count, arrays, scalar, times, format });
wire!(struct ArrayRecord { name, component_count, on_cells });

/// Errors: flags beside these.
pub(crate) fn refuse_flags(flags: u32, known: u32) -> Result<(), ValidationError> {
    match flags & !known {
        0 => Ok(()),
        more => Err(format!("its head has flags that do not belong there: {more:#x}")),
    }
}

impl Head {
    /// The head at an address. Counts that a flag leaves out are 0.
    pub fn read(address: *const GridHead) -> Result<Head, ValidationError> {
        let (read, _) = sized(address)?;
        refuse_flags(read.flags, TETRAHEDRA | SAME_POINTS | SAME_CELLS)?;
        let [same_points, same_cells, tetrahedra] =
            [SAME_POINTS, SAME_CELLS, TETRAHEDRA].map(|flag| read.flags & flag != 0);
        let count = |what: &str, count: u64, max: u64, must_be_none: bool| match count {
            0 => Ok(0),
            count if must_be_none => {
                Err(format!("{what} is {count}, and its flags say that there are none to give"))
            }
            count if count > max => Err(format!("{what} is {count}, at most {max}")),
            count => Ok(count as usize),
        };
        let max_number = u64::from(u32::MAX);
        let point_count = count("point_count", read.point_count, max_number, same_points)?;
        let cell_count = count("cell_count", read.cell_count, max_number, same_cells)?;
        let connectivity_count = read.connectivity_count;
        let connectivity_count =
            count("connectivity_count", connectivity_count, MAX_COUNT, same_cells || tetrahedra)?;
        let head = Head {
            flags: read.flags,
            point_count,
            cell_count,
            connectivity_count,
            arrays: arrays(&read)?,
            scalar: line("the name of its scalar", read.scalar, MAX_TEXT_BYTES)?,
            times: times(&read)?,
            format: line("its format", read.format, MAX_TEXT_BYTES)?,
        };
        match &head.scalar {
            Some(name) if !head.arrays.iter().any(|array| array.name == *name) => {
                Err(format!("its scalar '{name}' is none of its arrays"))
            }
            _ => Ok(head),
        }
    }

    /// True if the flag is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Number of tuples of an array.
    pub fn tuples(&self, array: &ArrayRecord) -> usize {
        if array.on_cells { self.cell_count } else { self.point_count }
    }

    /// Number of values of an array.
    pub fn numbers(&self, array: &ArrayRecord) -> usize {
        self.tuples(array) * array.component_count
    }

    /// Memory of the cells (bytes).
    pub fn cell_bytes(&self) -> u64 {
        let cells = self.cell_count as u64;
        match self.has(TETRAHEDRA) {
            true => 16 * cells,
            false => 9 * cells + 4 * self.connectivity_count as u64,
        }
    }

    /// True if no count is beyond what [`Head::read`] accepts.
    pub fn is_within_limits(&self) -> bool {
        let counts = [self.point_count, self.cell_count, self.connectivity_count];
        counts.iter().all(|&count| count as u64 <= MAX_COUNT)
            && self.arrays.iter().all(|array| array.component_count <= MAX_COMPONENTS as usize)
    }
}

fn arrays(read: &GridHead) -> Result<Vec<ArrayRecord>, ValidationError> {
    if read.array_count > MAX_ARRAYS {
        return Err(format!("array_count is {}, at most {MAX_ARRAYS}", read.array_count));
    }
    let heads = several(read.arrays, read.array_count as usize).map_err(|wrong| format!("array {wrong}"))?;
    let mut arrays: Vec<ArrayRecord> = Vec::new();
    for (i, head) in heads.iter().enumerate() {
        let at = |wrong: ValidationError| format!("array {i}: {wrong}");
        let name =
            required("the name", line("the name", head.name, MAX_TEXT_BYTES).map_err(at)?).map_err(at)?;
        if !(1..=MAX_COMPONENTS).contains(&head.component_count) {
            return Err(at(format!(
                "'{name}' has {} components, 1 to {MAX_COMPONENTS} can be",
                head.component_count
            )));
        }
        let on_cells = match head.on_cells {
            0 => false,
            1 => true,
            other => return Err(at(format!("'on_cells' of '{name}' is {other}, neither 0 nor 1"))),
        };
        if arrays.iter().any(|known| known.name == name && known.on_cells == on_cells) {
            return Err(at(format!("there are two of the name '{name}'")));
        }
        let component_count = head.component_count as usize;
        arrays.push(ArrayRecord { name, component_count, on_cells });
    }
    Ok(arrays)
}

fn times(read: &GridHead) -> Result<Vec<f64>, ValidationError> {
    if read.step_count > MAX_STEPS {
        return Err(format!("step_count is {}, at most {MAX_STEPS}", read.step_count));
    }
    if read.step_count == 0 {
        return Ok(Vec::new());
    }
    let times = values(read.times, read.step_count as usize).map_err(|wrong| format!("'times' {wrong}"))?;
    match times.windows(2).position(|pair| pair[0] >= pair[1]) {
        _ if !times.iter().all(|time| time.is_finite()) => Err("a time is not finite".into()),
        Some(i) => Err(format!("times do not ascend: {} after {}", times[i + 1], times[i])),
        None => Ok(times),
    }
}
