//! The files that parameters name.

use super::check::Parameters;
use super::declaration::ParameterType;
use super::setting::SourceSpan;
use crate::Result;
use std::path::{Path, PathBuf};

/// A file that a parameter names.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPath {
    /// The parameter's name.
    pub parameter: String,
    /// The path, as it was written.
    pub path: String,
    /// True if the file is written; it is read otherwise.
    pub written: bool,
    /// Location of the path in the file.
    pub origin: SourceSpan,
}

impl NamedPath {
    /// True if it depends on the folder of what states it; "-" as an output does not.
    pub fn is_relative(&self) -> bool {
        !(self.written && self.path == "-") && Path::new(&self.path).is_relative()
    }

    /// The path from where the program runs, if it was written for something in this folder.
    pub fn from(&self, folder: &Path) -> PathBuf {
        resolved(&self.path, self.written, folder)
    }
}

/// "-" as an output is the standard output, which is in no folder.
fn resolved(path: &str, written: bool, folder: &Path) -> PathBuf {
    if written && path == "-" { path.into() } else { folder.join(path) }
}

impl Parameters {
    /// The path that a parameter gives, from where the program runs; `folder`: what it is relative to.
    pub fn path(&self, name: &str, folder: &Path) -> Result<PathBuf> {
        let written = matches!(self.parameter_type(name), Some(ParameterType::OutputPath));
        Ok(resolved(self.text(name)?, written, folder))
    }

    /// The files that these name, also within tables and lists of tables.
    pub fn paths(&self) -> Vec<NamedPath> {
        let mut paths = Vec::new();
        for (parameter, setting, _) in self.iter() {
            match (parameter.parameter_type, setting) {
                (
                    file @ (ParameterType::InputPath
                    | ParameterType::OutputPath
                    | ParameterType::ChoiceOrPath(..)),
                    Some(setting),
                ) => {
                    let written = matches!(file, ParameterType::OutputPath);
                    let path = setting.text().filter(|text| written || file.is_input_path(text));
                    paths.extend(path.map(|path| NamedPath {
                        parameter: parameter.name.to_string(),
                        path: path.to_string(),
                        written,
                        origin: setting.origin.clone(),
                    }));
                }
                (ParameterType::Table(_), Some(_)) => {
                    let table = self.table(parameter.name).unwrap_or_default();
                    paths.extend(table.iter().flat_map(Parameters::paths));
                }
                (ParameterType::Kinds(_), Some(_)) => {
                    let entries = self.kinds(parameter.name).unwrap_or_default();
                    paths.extend(entries.iter().flat_map(|(_, entry)| entry.paths()));
                }
                _ => {}
            }
        }
        paths
    }
}
