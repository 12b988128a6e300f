//! Arguments that several commands share: pipeline files, parameters that are set, plug-ins.

use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Default, Args)]
pub struct Plugins {
    /// Load gradient filters, readers and filters of grids and images from this shared library; may be given several times.
    ///
    /// Pipelines name them as what ships: gradient filters by `method`, the others by `type`; `voltet nodes --plugin PATH` lists
    /// them. The libraries that
    /// the user's own file plugins.toml names are loaded as well. No pipeline file can load any. See docs/src/how-to/plugins.md.
    #[arg(long = "plugin", value_name = "PATH")]
    pub plugin_files: Vec<PathBuf>,
    /// Load and run plug-ins in a process of their own, so that one that crashes does not end this program.
    ///
    /// Costs some hundredths of a second a gradient, and stops at once where a filter does not stop by itself.
    #[arg(long)]
    pub plugin_process: bool,
}

#[derive(Debug, Args)]
pub struct Set {
    /// Set a parameter in place of the file's value; may be given several times.
    ///
    /// The value is read as TOML, or taken as text where it is none; parts of lists and tables are reached by
    /// further points. Paths are relative to the pipeline file, as those within it.
    /// Examples: view.size=[512,512]  file.path=small.png  look.widgets.0.extinction=2
    #[allow(rustdoc::broken_intra_doc_links, reason = "help shows the brackets as they are")]
    #[arg(long = "set", value_name = "node.param=value", verbatim_doc_comment)]
    pub options: Vec<String>,
}

#[derive(Debug, Args)]
pub struct Files {
    /// Pipeline files.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    #[command(flatten)]
    pub plugins: Plugins,
}

#[derive(Debug, Args)]
pub struct File {
    /// A pipeline file, or a picture that carries one.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub set: Set,
    #[command(flatten)]
    pub plugins: Plugins,
}
