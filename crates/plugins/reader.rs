//! A reader of a plug-in: its calls, and what it is to the program.

use crate::describe::Family;
use crate::grids::{ArrayOf, Buffers, Head, refuse_flags};
use crate::host::State;
use crate::interface::{ERROR, GridHead, OK, Read, Reading, TETRAHEDRA};
use crate::outcome::Said;
use crate::runner::Offered;
use crate::task::{Outcome, Task};
use crate::values::Owned;
use std::ffi::CString;
use std::mem::size_of;
use std::path::Path;
use std::ptr::{from_ref, null};
use std::sync::{Mutex, PoisonError};
use voltet_core::field::Plugin;
use voltet_core::grid::Association;
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::Progress;
use voltet_core::reading::{FileArray, GridHead as HeadOfFile, GridRead, GridReader, OpenGrid};
use voltet_core::{Error, Result};

/// A file and a step of it.
#[derive(Clone)]
pub(crate) struct OfFile {
    pub path: CString,
    pub step: u64,
    pub values: Owned,
}

/// What is asked of it.
pub(crate) struct Wanted {
    /// What the file holds, as it was described.
    pub head: Head,
    /// Whether points and cells are asked for.
    pub geometry: bool,
    /// For each array of the head whether it is.
    pub arrays: Vec<bool>,
    /// Bytes that it may take, where somebody knows.
    pub memory_left: Option<u64>,
}

/// The host's side of a description.
struct Inside<'a> {
    state: &'a State,
    head: Mutex<Option<Head>>,
}

unsafe extern "C-unwind" fn describe(reading: *const Reading, head: *const GridHead) -> i32 {
    // SAFETY: the plug-in hands over the reading that it was given, during the call.
    let inside = unsafe { reading.as_ref().and_then(|reading| reading.context.cast::<Inside>().as_ref()) };
    let Some(inside) = inside else { return ERROR };
    let read = Head::read(head).and_then(|head| refuse_flags(head.flags, TETRAHEDRA).map(|()| head));
    let mut known = inside.head.lock().unwrap_or_else(PoisonError::into_inner);
    match read {
        Ok(_) if known.is_some() => inside.state.complain("it described its file twice".into()),
        Err(wrong) => inside.state.complain(wrong),
        Ok(head) => {
            *known = Some(head);
            return OK;
        }
    }
    ERROR
}

impl OfFile {
    fn reading(&self, values: &crate::interface::Values) -> Reading {
        Reading {
            size: size_of::<Reading>() as u32,
            reserved: 0,
            path: self.path.as_ptr(),
            step: self.step,
            values,
            describe: None,
            buffers: null(),
            context: std::ptr::null_mut(),
        }
    }

    /// Calls the function that says what the file holds.
    pub fn inspect(&self, function: Read, state: &State) -> (Said, Option<Head>) {
        let pointers = self.values.pointers();
        let values = self.values.by(&pointers);
        let inside = Inside { state, head: Mutex::new(None) };
        let context = from_ref(&inside).cast_mut().cast();
        let reading = Reading { describe: Some(describe), context, ..self.reading(&values) };
        // SAFETY: the plug-in's own function; what it is given lives through the call.
        let code = unsafe { function(&reading, &state.host()) };
        let head = inside.head.into_inner().unwrap_or_else(PoisonError::into_inner);
        if head.is_none() && code == OK {
            state.complain("it did not say what the file holds (reading->describe)".into());
        }
        (Said::new(code, state), head)
    }

    /// Calls the function that reads.
    pub fn read(&self, function: Read, wanted: &Wanted, state: &State) -> (Said, Buffers) {
        let Wanted { head, geometry, arrays, memory_left } = wanted;
        let mut buffers = match Buffers::new(head, *geometry, arrays, *memory_left) {
            Ok(buffers) => buffers,
            Err(wrong) => return (Said::not_called(wrong, state), Buffers::default()),
        };
        let pointers = self.values.pointers();
        let values = self.values.by(&pointers);
        let places = buffers.places();
        let shown = buffers.interface(head, &places);
        let reading = Reading { buffers: &shown, ..self.reading(&values) };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&reading, &state.host()) };
        let beyond = buffers.close(head);
        (Said { beyond, ..Said::new(code, state) }, buffers)
    }
}

/// A file that a plug-in described.
struct Described {
    offered: Offered,
    file: OfFile,
    described: Head,
    head: HeadOfFile,
}

impl GridReader for Offered {
    fn declaration(&self) -> VariantSchema {
        self.declared.kind
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(self.runner.plugin())
    }

    fn is_meant(&self, head: &[u8], path: &Path) -> bool {
        let Family::Reader { extensions, magic } = self.declared.family else { return false };
        if !magic.is_empty() {
            return head.starts_with(magic);
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        extensions.iter().any(|ending| name.strip_suffix(ending).is_some_and(|stem| stem.ends_with('.')))
    }

    fn files(&self) -> String {
        let Family::Reader { extensions, .. } = self.declared.family else { return String::new() };
        match extensions.is_empty() {
            true => format!("a file for the {}", self.whose().piece()),
            false => extensions.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" "),
        }
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        Offered::check(self, parameters)
    }

    fn open(
        &self,
        path: &Path,
        step: usize,
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Box<dyn OpenGrid>> {
        let text = path.to_str().and_then(|path| CString::new(path).ok());
        let path = text.ok_or_else(|| {
            Error::run("the file's path cannot be handed to a plug-in").expected("a path that is UTF-8")
        })?;
        let file = OfFile { path, step: step as u64, values: Owned::new(&self.declared, parameters)? };
        let task = Task::Inspect(Box::new(file.clone()));
        let (_, described) = self.run(task, progress, Outcome::head)?;
        let head = head_of_file(&described, self.declared.kind.name);
        Ok(Box::new(Described { offered: self.clone(), file, described, head }))
    }
}

fn head_of_file(head: &Head, name: &str) -> HeadOfFile {
    let array = |array: &ArrayOf| FileArray {
        name: array.name.clone(),
        association: if array.on_cells { Association::Cell } else { Association::Point },
        component_count: array.component_count,
    };
    HeadOfFile {
        format: head.format.clone().unwrap_or_else(|| name.into()),
        point_count: head.point_count as u64,
        cell_count: head.cell_count as u64,
        cell_bytes: head.cell_bytes(),
        arrays: head.arrays.iter().map(array).collect(),
        scalar: head.scalar.clone(),
        times: head.times.clone(),
    }
}

impl OpenGrid for Described {
    fn head(&self) -> &HeadOfFile {
        &self.head
    }

    fn read(&self, geometry: bool, arrays: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        let (head, whose) = (&self.described, self.offered.whose());
        let mut asked = vec![false; head.arrays.len()];
        arrays.iter().for_each(|&place| asked[place] = true);
        let memory_left = progress.memory_left();
        let wanted = Wanted { head: head.clone(), geometry, arrays: asked, memory_left };
        let task = Task::Read(Box::new(self.file.clone()), Box::new(wanted));
        let (said, (_, buffers)) = self.offered.run(task, progress, Outcome::grid)?;
        let mut made = buffers.judged(head, head.point_count, whose)?;
        let missing = || whose.error("answered what was not asked");
        let taken: Result<Vec<Vec<f64>>> = arrays
            .iter()
            .map(|&place| made.arrays.get_mut(place).and_then(Option::take).ok_or_else(missing))
            .collect();
        Ok(GridRead {
            points: made.points,
            cells: made.cells,
            arrays: taken?,
            warnings: whose.warnings(&said).collect(),
        })
    }
}
