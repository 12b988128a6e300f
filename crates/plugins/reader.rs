//! A reader of a plug-in: its calls, and its adapter to the program's [`GridReader`].

use crate::declaration::{EntryPoint, Family, LibraryItem};
use crate::grids::{ArrayRecord, Buffers, Head, refuse_flags};
use crate::host::State;
use crate::interface::{ERROR, GridHead, OK, Reading, TETRAHEDRA, Values};
use crate::runner::PluginItem;
use crate::status::CallStatus;
use crate::task::{Outcome, Task, TaskKind};
use crate::values::ParameterValues;
use crate::wire::wire;
use std::ffi::CString;
use std::mem::size_of;
use std::path::Path;
use std::ptr::{from_ref, null};
use std::sync::{Mutex, PoisonError};
use voltet_core::field::Plugin;
use voltet_core::grid::Association;
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::Progress;
use voltet_core::reading::{FileArray, GridHead as FileHead, GridRead, GridReader, OpenGrid};
use voltet_core::{Error, Result};

/// Description of a file: a step of it.
#[derive(Clone)]
pub(crate) struct InspectTask {
    path: CString,
    step: u64,
    values: ParameterValues,
}

/// Reading of a file.
pub(crate) struct ReadTask {
    file: InspectTask,
    /// Contents of the file, as described.
    head: Head,
    /// True if points and cells are requested.
    geometry: bool,
    /// For each array of the head, true if it is requested.
    arrays: Vec<bool>,
    /// Memory that it may take (bytes), if known.
    memory_left: Option<u64>,
}

wire!(fields of InspectTask { path, step, values });
wire!(fields of ReadTask { file, head, geometry, arrays, memory_left });

/// The host's side of a description.
struct HostContext<'a> {
    state: &'a State,
    head: Mutex<Option<Head>>,
}

unsafe extern "C-unwind" fn describe(reading: *const Reading, head: *const GridHead) -> i32 {
    // SAFETY: the plug-in hands over the reading that it was given, during the call.
    let host = unsafe { reading.as_ref().and_then(|reading| reading.context.cast::<HostContext>().as_ref()) };
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

impl InspectTask {
    pub const KIND: TaskKind = TaskKind::new::<InspectTask>(2, "reading");

    fn reading(&self, values: &Values) -> Reading {
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
}

impl Task for InspectTask {
    fn kind(&self) -> &'static TaskKind {
        &InspectTask::KIND
    }

    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome) {
        let EntryPoint::Reader { inspect, .. } = item.function else { return Default::default() };
        let pointers = self.values.pointers();
        let values = self.values.header_values(&pointers);
        let host = HostContext { state, head: Mutex::new(None) };
        let context = from_ref(&host).cast_mut().cast();
        let reading = Reading { describe: Some(describe), context, ..self.reading(&values) };
        // SAFETY: the plug-in's own function; what it is given lives through the call.
        let code = unsafe { inspect(&reading, &state.host()) };
        let head = host.head.into_inner().unwrap_or_else(PoisonError::into_inner);
        if head.is_none() && code == OK {
            state.refuse("it did not say what the file holds (reading->describe)".into());
        }
        (CallStatus::new(code, state), head.map(Outcome::Head).unwrap_or_default())
    }
}

impl ReadTask {
    pub const KIND: TaskKind = TaskKind::new::<ReadTask>(3, "reading");
}

impl Task for ReadTask {
    fn kind(&self) -> &'static TaskKind {
        &ReadTask::KIND
    }

    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome) {
        let EntryPoint::Reader { read, .. } = item.function else { return Default::default() };
        let ReadTask { file, head, geometry, arrays, memory_left } = *self;
        let mut buffers = match Buffers::new(&head, geometry, &arrays, memory_left) {
            Ok(buffers) => buffers,
            Err(wrong) => {
                return (CallStatus::not_called(wrong, state), Outcome::Grid(head, Buffers::default()));
            }
        };
        let pointers = file.values.pointers();
        let values = file.values.header_values(&pointers);
        let addresses = buffers.array_addresses();
        let header_buffers = buffers.header_buffers(&head, &addresses);
        let reading = Reading { buffers: &header_buffers, ..file.reading(&values) };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { read(&reading, &state.host()) };
        let overrun = buffers.close(&head);
        (CallStatus { overrun, ..CallStatus::new(code, state) }, Outcome::Grid(head, buffers))
    }
}

/// A file with its description.
struct DescribedFile {
    item: PluginItem,
    file: InspectTask,
    described: Head,
    head: FileHead,
}

impl GridReader for PluginItem {
    fn declaration(&self) -> VariantSchema {
        self.declaration.schema
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(self.runner.plugin())
    }

    fn matches(&self, head: &[u8], path: &Path) -> bool {
        let Family::Reader { extensions, magic } = self.declaration.family else { return false };
        if !magic.is_empty() {
            return head.starts_with(magic);
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        extensions.iter().any(|ending| name.strip_suffix(ending).is_some_and(|stem| stem.ends_with('.')))
    }

    fn files(&self) -> String {
        let Family::Reader { extensions, .. } = self.declaration.family else { return String::new() };
        match extensions.is_empty() {
            true => format!("a file for the {}", self.label().item()),
            false => extensions.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" "),
        }
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        self.check_parameters(parameters)
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
        let values = ParameterValues::new(&self.declaration, parameters)?;
        let file = InspectTask { path, step: step as u64, values };
        let (_, described) = self.run(Box::new(file.clone()), progress, Outcome::head)?;
        let head = file_head(&described, self.declaration.schema.name);
        Ok(Box::new(DescribedFile { item: self.clone(), file, described, head }))
    }
}

fn file_head(head: &Head, name: &str) -> FileHead {
    let array = |array: &ArrayRecord| FileArray {
        name: array.name.clone(),
        association: if array.on_cells { Association::Cell } else { Association::Point },
        component_count: array.component_count,
    };
    FileHead {
        format: head.format.clone().unwrap_or_else(|| name.into()),
        point_count: head.point_count as u64,
        cell_count: head.cell_count as u64,
        cell_bytes: head.cell_bytes(),
        arrays: head.arrays.iter().map(array).collect(),
        scalar: head.scalar.clone(),
        times: head.times.clone(),
    }
}

impl OpenGrid for DescribedFile {
    fn head(&self) -> &FileHead {
        &self.head
    }

    fn read(&self, geometry: bool, arrays: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        let (head, label) = (&self.described, self.item.label());
        let mut requested = vec![false; head.arrays.len()];
        arrays.iter().for_each(|&i| requested[i] = true);
        let memory_left = progress.memory_left();
        let task = ReadTask {
            file: self.file.clone(),
            head: head.clone(),
            geometry,
            arrays: requested,
            memory_left,
        };
        let (status, (_, buffers)) = self.item.run(Box::new(task), progress, Outcome::grid)?;
        let mut contents = buffers.validate(head, head.point_count, label)?;
        let missing = || label.error("answered what was not asked");
        let values = |&i: &usize| contents.arrays.get_mut(i).and_then(Option::take).ok_or_else(missing);
        let arrays = arrays.iter().map(values).collect::<Result<Vec<Vec<f64>>>>()?;
        Ok(GridRead {
            points: contents.points,
            cells: contents.cells,
            arrays,
            warnings: label.warnings(&status).collect(),
        })
    }
}
