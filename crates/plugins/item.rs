//! An item that a plug-in offers: the runner of its functions (this process, one of its own, or a sandbox), its adapters to the
//! program's [`GradientFilter`] and [`GridReader`], and the node of an image filter.

use crate::call::{CallOutput, FileStep, GradientTask, ImageTask, Outcome, ReadTask, Task};
use crate::declaration::{Declaration, Family};
use crate::ffi::Sentinel;
use crate::grids::Head;
use crate::host::CallLabel;
use crate::values::{ParameterValues, array_names, named_arrays};
use rayon::prelude::*;
use std::ffi::CString;
use std::path::Path;
use std::sync::Arc;
use voltet_core::field::{Gradient, GradientFilter, Plugin, check_scalar};
use voltet_core::glam::DVec3;
use voltet_core::grid::Grid;
use voltet_core::parameters::{DefaultValue, Parameters, VariantSchema};
use voltet_core::picture::Picture;
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::reading::{GridHead, GridRead, GridReader, OpenGrid};
use voltet_core::{Error, Result, counted};
use voltet_graph::{Node, Outputs, Port, PortType, RunContext, Value};

/// Runner of the functions of one plug-in.
pub(crate) trait Runner: Send + Sync {
    fn plugin(&self) -> &Plugin;

    /// Runs a task of an item. A check of parameters is given up after seconds. The status is not judged.
    ///
    /// Errors: nothing came back.
    fn run(&self, declaration: &Declaration, task: Task, progress: &dyn Progress) -> Result<CallOutput>;
}

/// A filter or reader of a plug-in.
#[derive(Clone)]
pub(crate) struct PluginItem {
    pub runner: Arc<dyn Runner>,
    pub declaration: Declaration,
}

impl PluginItem {
    pub fn list(runner: Arc<dyn Runner>, declarations: Vec<Declaration>) -> Vec<PluginItem> {
        let item = |declaration| PluginItem { runner: runner.clone(), declaration };
        declarations.into_iter().map(item).collect()
    }

    /// Beginning of messages.
    pub fn label(&self) -> CallLabel<'_> {
        CallLabel::new(&self.declaration, self.runner.plugin())
    }

    /// Errors: the plug-in's own check, if it has one, refuses the parameters.
    pub fn check_parameters(&self, parameters: &Parameters) -> Result<()> {
        let values = ParameterValues::new(&self.declaration, parameters)?;
        if !self.declaration.checks {
            return Ok(());
        }
        let (status, _) = self.runner.run(&self.declaration, Task::Check(values), &NoProgress)?;
        self.label().check_parameters(status)
    }

    /// Runs a task.
    ///
    /// Errors: the call failed.
    pub fn run(&self, task: Task, progress: &dyn Progress) -> Result<CallOutput> {
        let (status, outcome) = self.runner.run(&self.declaration, task, progress)?;
        self.label().check_call(&status, progress.cancelled())?;
        Ok((status, outcome))
    }

    /// Error of a call that gave output of another kind.
    pub fn unexpected_output(&self) -> Error {
        self.label().error("answered what was not asked")
    }
}

/// A node with the shared fields, completed by `complete`; it lives as long as the program.
pub(crate) fn leaked_node(item: &PluginItem, complete: impl FnOnce(Node) -> Node) -> &'static Node {
    let check_item = item.clone();
    let VariantSchema { name, summary, parameters } = item.declaration.schema;
    leak(complete(Node {
        name,
        summary,
        parameters,
        plugin: Some(leak(item.runner.plugin().clone())),
        check: leak(move |parameters: &Parameters| check_item.check_parameters(parameters)),
        ..Node::BLANK
    }))
}

/// A value that lives as long as the program.
pub(crate) fn leak<T>(value: T) -> &'static T {
    Box::leak(Box::new(value))
}

/// Example in a pipeline file: behind the node `from` by the input `port`, and before nodes with the input `next`.
pub(crate) fn example_text(schema: VariantSchema, from: &str, port: &str, next: &str) -> &'static str {
    let required =
        schema.parameters.iter().filter(|parameter| matches!(parameter.default, DefaultValue::Required));
    let required: String = required.map(|parameter| format!("{} = …\n", parameter.name)).collect();
    format!(
        "# Between the node '{from}' and those that take what it gives ({next}):\n[nodes.filtered]\ntype = \"{}\"\n\
         {required}inputs = {{ {port} = \"{from}\" }}\n",
        schema.name
    )
    .leak()
}

impl GradientFilter for PluginItem {
    fn declaration(&self) -> VariantSchema {
        self.declaration.schema
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(self.runner.plugin())
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        self.check_parameters(parameters)
    }

    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(array_names(&self.declaration, parameters))
    }

    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient> {
        check_scalar(grid, scalar)?;
        let task = GradientTask {
            grid: grid.clone(),
            scalar: scalar.to_vec(),
            values: ParameterValues::new(&self.declaration, parameters)?,
            arrays: named_arrays(&self.declaration, parameters, grid)?,
        };
        let (status, Outcome::Vectors(vectors)) = self.run(Task::Gradient(task), progress)? else {
            return Err(self.unexpected_output());
        };
        let vectors = refuse_missing(grid, vectors, self.label())?;
        Ok(Gradient { vectors, fallbacks: status.reports.fallbacks })
    }
}

/// The vectors, zero at points of no cell.
///
/// Errors: a point of a cell without a vector.
fn refuse_missing(grid: &Grid, mut vectors: Vec<DVec3>, label: CallLabel) -> Result<Vec<DVec3>> {
    let is_unset = |v: &DVec3| v.to_array().iter().any(Sentinel::is_unset);
    if !vectors.par_iter().with_min_len(1 << 14).any(is_unset) {
        return Ok(vectors);
    }
    let mut used = vec![false; vectors.len()];
    grid.tetrahedra.iter().flatten().for_each(|&p| used[p as usize] = true);
    let mut unset = (0..vectors.len()).filter(|&p| used[p] && is_unset(&vectors[p]));
    if let Some(first) = unset.next() {
        let found = format!("{} without, the first of them point {first}", 1 + unset.count());
        let expected = format!("one for each of the {}", counted(vectors.len(), "point"));
        return Err(label.error("did not give every point a vector").got(found).expected(expected));
    }
    vectors.iter_mut().filter(|v| is_unset(v)).for_each(|v| *v = DVec3::ZERO);
    Ok(vectors)
}

struct DescribedFile {
    item: PluginItem,
    file: FileStep,
    described: Head,
    head: GridHead,
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
        let file = FileStep { path, step: step as u64, values };
        let (_, Outcome::Head(described)) = self.run(Task::Inspect(file.clone()), progress)? else {
            return Err(self.unexpected_output());
        };
        let head = GridHead {
            format: described.format.clone().unwrap_or_else(|| self.declaration.schema.name.into()),
            point_count: described.point_count as u64,
            cell_count: described.cell_count as u64,
            cell_bytes: described.cell_bytes(),
            arrays: described.arrays.clone(),
            scalar: described.scalar.clone(),
            times: described.times.clone(),
        };
        Ok(Box::new(DescribedFile { item: self.clone(), file, described, head }))
    }
}

impl OpenGrid for DescribedFile {
    fn head(&self) -> &GridHead {
        &self.head
    }

    fn read(&self, geometry: bool, arrays: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        let (head, label) = (&self.described, self.item.label());
        let mut requested = vec![false; head.arrays.len()];
        arrays.iter().for_each(|&i| requested[i] = true);
        let (file, memory_left) = (self.file.clone(), progress.memory_left());
        let task =
            Task::Read(ReadTask { file, head: head.clone(), geometry, arrays: requested, memory_left });
        let (status, Outcome::Grid(_, buffers)) = self.item.run(task, progress)? else {
            return Err(self.item.unexpected_output());
        };
        let mut contents = buffers.validate(head, head.point_count, label)?;
        let missing = || self.item.unexpected_output();
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

pub(crate) fn image_node(item: PluginItem) -> &'static Node {
    let image = |summary| Port { name: "image", port_type: PortType::Image, summary };
    let [inputs, outputs] =
        [image("the picture"), image("the filtered picture")].map(|port| [port].to_vec().leak());
    let example = example_text(item.declaration.schema, "picture", "image", "image = \"filtered\"");
    let run_item = item.clone();
    leaked_node(&item, |node| Node {
        inputs,
        outputs,
        example,
        run: leak(move |call: &mut RunContext| run(&run_item, call)),
        ..node
    })
}

fn run(item: &PluginItem, call: &mut RunContext) -> Result<Outputs> {
    let picture = call.image("image")?;
    let values = ParameterValues::new(&item.declaration, call.parameters)?;
    let task = Task::Image(ImageTask { picture: picture.clone(), values });
    let (status, Outcome::Pixels(rgba)) = item.run(task, call.progress())? else {
        return Err(item.unexpected_output());
    };
    refuse_invalid(&picture, &rgba, item.label())?;
    call.notes.warnings.extend(item.label().warnings(&status));
    Ok(vec![Value::Image(Arc::new(Picture { rgba, ..*picture }))])
}

/// Errors: a pixel that was not written or is not a colour; another number of pixels.
fn refuse_invalid(picture: &Picture, rgba: &[[f32; 4]], label: CallLabel) -> Result<()> {
    let is_valid = |pixel: &[f32; 4]| pixel.iter().all(|x| x.is_finite()) && (0.0..=1.0).contains(&pixel[3]);
    let is_unset = |pixel: &[f32; 4]| pixel.iter().any(Sentinel::is_unset);
    let position = |i: usize| format!("at column {} of row {}", i % picture.width, i / picture.width);
    if let Some(first) = rgba.iter().position(is_unset) {
        let missing = rgba.iter().filter(|pixel| is_unset(pixel)).count();
        let found = format!("{missing} without, the first {}", position(first));
        let expected = format!("one for each of the {} x {} pixels", picture.width, picture.height);
        return Err(label.error("did not give every pixel a colour").got(found).expected(expected));
    }
    match rgba.iter().position(|pixel| !is_valid(pixel)) {
        None if rgba.len() == picture.rgba.len() => Ok(()),
        None => {
            Err(label.error("gave a picture of another size").got(rgba.len()).expected(picture.rgba.len()))
        }
        Some(i) => {
            let error =
                label.error("gave a pixel that is none").got(format!("{:?} {}", rgba[i], position(i)));
            Err(error.expected("finite numbers, the last (opacity) from 0 to 1"))
        }
    }
}
