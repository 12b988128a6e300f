//! How large a grid is, and what it holds, as a plug-in says it: copied and checked before anything is allocated.

use crate::describe::{line, required};
use crate::foreign::{Wrong, several, sized, values};
use crate::interface::{GridHead, SAME_CELLS, SAME_POINTS, TETRAHEDRA};
use crate::process::wire::{Reader, Writer};

/// Longest name of an array, format: bytes.
const TEXT_MOST: usize = 1024;

/// Most arrays, components and steps.
const ARRAYS_MOST: u32 = 4096;
const COMPONENTS_MOST: u32 = 1024;
const STEPS_MOST: u32 = 1 << 20;

/// `voltet_grid_head`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Head {
    pub flags: u32,
    pub point_count: usize,
    pub cell_count: usize,
    pub connectivity_count: usize,
    pub arrays: Vec<ArrayOf>,
    pub scalar: Option<String>,
    pub times: Vec<f64>,
    pub format: Option<String>,
}

/// `voltet_array_head`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ArrayOf {
    pub name: String,
    pub component_count: usize,
    pub on_cells: bool,
}

/// Errors: flags beside these.
pub(crate) fn refuse_flags(flags: u32, known: u32) -> Result<(), Wrong> {
    match flags & !known {
        0 => Ok(()),
        more => Err(format!("its head has flags that do not belong there: {more:#x}")),
    }
}

impl Head {
    /// The head at an address. Counts that a flag leaves out are 0.
    pub fn read(address: *const GridHead) -> Result<Head, Wrong> {
        let (read, _) = sized(address)?;
        refuse_flags(read.flags, TETRAHEDRA | SAME_POINTS | SAME_CELLS)?;
        let [same_points, same_cells, tetrahedra] =
            [SAME_POINTS, SAME_CELLS, TETRAHEDRA].map(|flag| read.flags & flag != 0);
        let count = |what: &str, count: u64, most: u64, must_be_none: bool| match count {
            0 => Ok(0),
            count if must_be_none => {
                Err(format!("{what} is {count}, and its flags say that there are none to give"))
            }
            count if count > most => Err(format!("{what} is {count}, at most {most}")),
            count => Ok(count as usize),
        };
        let many = u64::from(u32::MAX);
        let point_count = count("point_count", read.point_count, many, same_points)?;
        let cell_count = count("cell_count", read.cell_count, many, same_cells)?;
        let connectivity_count = read.connectivity_count;
        let connectivity_count =
            count("connectivity_count", connectivity_count, 1 << 36, same_cells || tetrahedra)?;
        let head = Head {
            flags: read.flags,
            point_count,
            cell_count,
            connectivity_count,
            arrays: arrays(&read)?,
            scalar: line("the name of its scalar", read.scalar, TEXT_MOST)?,
            times: times(&read)?,
            format: line("its format", read.format, TEXT_MOST)?,
        };
        match &head.scalar {
            Some(name) if !head.arrays.iter().any(|array| array.name == *name) => {
                Err(format!("its scalar '{name}' is none of its arrays"))
            }
            _ => Ok(head),
        }
    }

    /// Whether the flag is set.
    pub fn is(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Tuples of an array.
    pub fn tuples(&self, array: &ArrayOf) -> usize {
        if array.on_cells { self.cell_count } else { self.point_count }
    }

    /// Numbers of an array.
    pub fn numbers(&self, array: &ArrayOf) -> usize {
        self.tuples(array) * array.component_count
    }

    /// Bytes of the cells in memory.
    pub fn cell_bytes(&self) -> u64 {
        let cells = self.cell_count as u64;
        match self.is(TETRAHEDRA) {
            true => 16 * cells,
            false => 9 * cells + 4 * self.connectivity_count as u64,
        }
    }

    /// Into a message.
    pub fn write(&self, to: &mut Writer) {
        to.number(u64::from(self.flags));
        [self.point_count, self.cell_count, self.connectivity_count]
            .into_iter()
            .for_each(|count| to.number(count as u64));
        to.number(self.arrays.len() as u64);
        for array in &self.arrays {
            to.text(&array.name);
            to.number(array.component_count as u64);
            to.number(u64::from(array.on_cells));
        }
        [&self.scalar, &self.format]
            .into_iter()
            .for_each(|text| to.optional(text.as_ref(), |to, text| to.text(text)));
        to.floats(&self.times);
    }

    /// From a message; `None` where it is none.
    pub fn read_message(from: &mut Reader) -> Option<Head> {
        let flags = u32::try_from(from.number()?).ok()?;
        let mut count = || usize::try_from(from.number()?).ok().filter(|&count| count <= 1 << 36);
        let [point_count, cell_count, connectivity_count] = [count()?, count()?, count()?];
        let arrays = from.list(|from| {
            let (name, components) = (from.text()?, from.number()?);
            let component_count =
                usize::try_from(components).ok().filter(|&n| n <= COMPONENTS_MOST as usize)?;
            Some(ArrayOf { name, component_count, on_cells: from.number()? == 1 })
        })?;
        let (scalar, format) = (from.optional(Reader::text)?, from.optional(Reader::text)?);
        let times = from.floats()?;
        Some(Head { flags, point_count, cell_count, connectivity_count, arrays, scalar, times, format })
    }
}

fn arrays(read: &GridHead) -> Result<Vec<ArrayOf>, Wrong> {
    if read.array_count > ARRAYS_MOST {
        return Err(format!("array_count is {}, at most {ARRAYS_MOST}", read.array_count));
    }
    let heads = several(read.arrays, read.array_count as usize).map_err(|wrong| format!("array {wrong}"))?;
    let mut arrays: Vec<ArrayOf> = Vec::new();
    for (i, head) in heads.iter().enumerate() {
        let at = |wrong: Wrong| format!("array {i}: {wrong}");
        let name = required("the name", line("the name", head.name, TEXT_MOST).map_err(at)?).map_err(at)?;
        if !(1..=COMPONENTS_MOST).contains(&head.component_count) {
            return Err(at(format!(
                "'{name}' has {} components, 1 to {COMPONENTS_MOST} can be",
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
        arrays.push(ArrayOf { name, component_count, on_cells });
    }
    Ok(arrays)
}

fn times(read: &GridHead) -> Result<Vec<f64>, Wrong> {
    if read.step_count > STEPS_MOST {
        return Err(format!("step_count is {}, at most {STEPS_MOST}", read.step_count));
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
