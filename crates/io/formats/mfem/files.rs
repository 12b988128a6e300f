//! Files of a result of MFEM: a mesh and a grid function of one process or of several, and data collections for VisIt, whose root file names
//! them.

use crate::formats::request::Request;
use crate::formats::source::Source;
use crate::formats::xml::beside;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};

/// Ending of root files.
const ROOT: &str = "mfem_root";

/// True for the name of a root file.
pub(super) fn is_root(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(ROOT))
}

/// Files of a result.
pub(super) struct MfemFiles {
    /// The mesh of each process.
    pub meshes: Vec<PathBuf>,
    /// Names of fields, and the file of each process.
    pub fields: Vec<(String, Vec<PathBuf>)>,
    pub time: Option<f64>,
}

#[derive(Deserialize)]
struct Root {
    dsets: DataSets,
}

#[derive(Deserialize)]
struct DataSets {
    main: Collection,
}

#[derive(Deserialize)]
struct Collection {
    domains: f64,
    time: Option<f64>,
    mesh: ProcessPattern,
    #[serde(default)]
    fields: BTreeMap<String, ProcessPattern>,
}

/// A path in which `%06d` stands for the number of the process.
#[derive(Deserialize)]
struct ProcessPattern {
    path: String,
}

impl ProcessPattern {
    fn of_process(&self, process: usize) -> String {
        let parts =
            self.path.split_once('%').and_then(|(before, rest)| Some((before, rest.split_once('d')?)));
        match parts {
            Some((before, (width, after))) => {
                // More digits than any number has would be a name of any length.
                let width = width.parse().unwrap_or(0).min(20);
                format!("{before}{process:0width$}{after}")
            }
            None => self.path.clone(),
        }
    }
}

impl MfemFiles {
    /// The files that a root file names, or a mesh with those beside it.
    pub fn of_source(source: &Source, request: &Request) -> Result<MfemFiles> {
        if is_root(source.path()) {
            return MfemFiles::of_root(source);
        }
        let meshes = of_processes(source.path());
        let own = source.path().with_extension("gf");
        let solution =
            request.solution.clone().or_else(|| (own != source.path() && own.is_file()).then_some(own));
        let fields = solution.map(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let files = if meshes.len() > 1 { of_processes(&path) } else { vec![path] };
            (name, files)
        });
        Ok(MfemFiles { meshes, fields: fields.into_iter().collect(), time: None })
    }

    fn of_root(source: &Source) -> Result<MfemFiles> {
        let bytes = source.read(0, source.len())?;
        let root: Root = serde_json::from_slice(&bytes).map_err(|error| {
            Error::run("the root file of the collection is damaged")
                .got(error)
                .expected("\"dsets\": { \"main\": { \"domains\": …, \"mesh\": { \"path\": … }, … } }")
        })?;
        let Collection { domains, time, mesh, fields } = root.dsets.main;
        if !(1.0..=f64::from(u32::MAX)).contains(&domains) {
            let error = Error::run("the number of domains of the collection is damaged").got(domains);
            return Err(error.expected("at least 1"));
        }
        let path = |pattern: &ProcessPattern, process| beside(source.path(), &pattern.of_process(process));
        let mut meshes = Vec::new();
        for process in 0..domains as usize {
            let own = path(&mesh, process);
            if !own.is_file() {
                let error = Error::run("a mesh of the collection is not there").got(own.display());
                return Err(error.expected(format_args!("{domains} meshes, as the root file says")));
            }
            meshes.push(own);
        }
        let all =
            |pattern: &ProcessPattern| (0..meshes.len()).map(|process| path(pattern, process)).collect();
        let fields = fields.iter().map(|(name, pattern)| (name.clone(), all(pattern))).collect();
        Ok(MfemFiles { meshes, fields, time })
    }
}

/// The files of all processes from 0 on, where a path ends in the number of one, as `mesh.000002`; else the path.
fn of_processes(path: &Path) -> Vec<PathBuf> {
    let number = path.extension().map(|ending| ending.to_string_lossy().into_owned()).unwrap_or_default();
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    let file = |process: usize| path.with_extension(format!("{process:0width$}", width = number.len()));
    let files: Vec<PathBuf> = (0..).map(file).take_while(|file| is_number && file.is_file()).collect();
    if files.iter().any(|file| file == path) { files } else { vec![path.to_owned()] }
}
