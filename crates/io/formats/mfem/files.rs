//! Files of a result of MFEM: a mesh and a grid function of one process or of several, and data collections for VisIt, whose root file names
//! them.

use crate::formats::request::Request;
use crate::formats::source::Source;
use crate::formats::xml::beside;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result, counted};

const ROOT: &str = "mfem_root";

pub(super) fn is_root(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(ROOT))
}

/// The reason why the files of fields are read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldReason {
    /// A root file names them.
    OfRoot,
    /// The request names one.
    Requested,
    /// One has the name of the mesh.
    BesideMesh,
}

pub(super) struct MfemFiles {
    pub meshes: Vec<PathBuf>,
    /// Names of fields, and the file of each process.
    pub fields: Vec<(String, Vec<PathBuf>)>,
    pub reason: FieldReason,
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

    /// The files of so many processes, which are all there, each another.
    fn of_processes(&self, root: &Path, count: usize, what: &str) -> Result<Vec<PathBuf>> {
        if count > 1 && self.of_process(0) == self.of_process(1) {
            let error = Error::run(format!("{what} has one path for all processes")).got(&self.path);
            return Err(error.expected("a path with the number of the process, as %06d"));
        }
        let mut files = Vec::new();
        for process in 0..count {
            let own = beside(root, &self.of_process(process));
            if !own.is_file() {
                let error = Error::run(format!("a file of {what} is not there")).got(own.display());
                let accepted = counted(count, "file");
                return Err(error.expected(format_args!("{accepted}, as the root file says")));
            }
            files.push(own);
        }
        Ok(files)
    }
}

impl MfemFiles {
    /// The files that a root file names, or a mesh with those beside it.
    pub fn of_source(source: &Source, request: &Request) -> Result<MfemFiles> {
        if is_root(source.path()) {
            if let Some(solution) = &request.solution {
                let error = Error::run("a root file names its fields itself, and takes no solution");
                return Err(error
                    .got(solution.display())
                    .expected("the mesh of a process with the solution, or the root file alone"));
            }
            return MfemFiles::of_root(source);
        }
        let meshes = of_processes(source.path());
        // A file of that name beside the meshes of several processes is of another mesh, of all of them.
        let beside = Some(source.path().with_extension("gf"));
        let beside = beside.filter(|own| meshes.len() == 1 && own != source.path() && own.is_file());
        let (reason, solution) = match request.solution.clone() {
            Some(path) => (FieldReason::Requested, Some(path)),
            None => (FieldReason::BesideMesh, beside),
        };
        let fields = solution.map(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let files = if meshes.len() > 1 { of_processes(&path) } else { vec![path] };
            (name, files)
        });
        Ok(MfemFiles { meshes, fields: fields.into_iter().collect(), reason, time: None })
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
        let domains = domains as usize;
        let meshes = mesh.of_processes(source.path(), domains, "the mesh")?;
        let of_field = |(name, pattern): (String, ProcessPattern)| {
            let files = pattern.of_processes(source.path(), domains, &format!("the field '{name}'"))?;
            Ok((name, files))
        };
        let fields = fields.into_iter().map(of_field).collect::<Result<_>>()?;
        Ok(MfemFiles { meshes, fields, reason: FieldReason::OfRoot, time })
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
