//! Values of fields on the patches of a mesh, where the files state them: means of cell values at the points there are the means of
//! these, as readers of VTK and OpenFOAM's own interpolation to points have it.
//!
//! A patch has the entry of its name, of a group that it is in, or of the last pattern that fits its name. Patches where parts of the
//! mesh meet (of processors, cyclic ones) and those of flat cases (empty, wedge) are no boundary.

use super::cells::{FaceCells, MeshPaths};
use super::entries::PatchValues;
use super::file::{FoamFile, misfit};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::BoundaryValues;
use voltet_core::{Error, Result};

/// Kinds of patches that are no boundary, by the beginning of their names.
const INNER: [&str; 5] = ["processor", "cyclic", "nonConformal", "empty", "wedge"];

struct BoundaryFaces {
    /// Number of the first in the mesh.
    first: usize,
    points: Vec<u32>,
    ends: Vec<u32>,
    owners: Vec<u32>,
}

/// The boundary of a mesh, whose faces are kept once the cells were read.
pub(super) struct MeshBoundary {
    path: PathBuf,
    faces: Mutex<Option<Arc<BoundaryFaces>>>,
}

impl MeshBoundary {
    /// The boundary of a mesh; `None` where it has no file about patches.
    pub fn of_mesh(mesh: &MeshPaths) -> Option<Arc<MeshBoundary>> {
        let path = mesh.boundary.clone()?;
        Some(Arc::new(MeshBoundary { path, faces: Mutex::default() }))
    }

    pub fn keep(&self, faces: &FaceCells) {
        let (first, points, ends, owners) = faces.at_boundary();
        let own = BoundaryFaces { first, points, ends, owners };
        *self.faces.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(own));
    }

    fn faces(&self, mesh: &MeshPaths) -> Result<Arc<BoundaryFaces>> {
        let kept = || self.faces.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if kept().is_none() {
            self.keep(&FaceCells::read(mesh)?);
        }
        kept().ok_or_else(|| misfit("faces at the boundary", 0, "some", &mesh.faces))
    }

    /// Values of a field on the faces of selected cells, `component_count` numbers each, with warnings about those that are not read.
    pub fn values(
        &self,
        mesh: &MeshPaths,
        field: &Path,
        component_count: usize,
        is_selected: impl Fn(usize) -> bool,
    ) -> Result<(BoundaryValues, Vec<String>)> {
        let (mut all, mut warnings) = (BoundaryValues::default(), Vec::new());
        let mut file = FoamFile::open(field, mesh.part.as_ref(), false)?;
        let entries = match file.patch_entries(component_count) {
            Ok(entries) => entries,
            Err(error) => {
                let error = error.in_file(field);
                warnings
                    .push(format!("Values on patches are not read, means of cells stand for them: {error}"));
                return Ok((all, warnings));
            }
        };
        if entries.iter().all(|entry| entry.values.is_none()) {
            return Ok((all, warnings));
        }
        let faces = self.faces(mesh)?;
        let mut end_before = 0;
        for patch in FoamFile::read(&self.path, mesh.part.as_ref(), FoamFile::patches)? {
            if patch.face_count == 0 {
                continue;
            }
            let begin = patch.first_face.checked_sub(faces.first).filter(|&begin| begin >= end_before);
            let end = begin.and_then(|begin| begin.checked_add(patch.face_count));
            let Some((begin, end)) = begin.zip(end).filter(|range| range.1 <= faces.ends.len()) else {
                let what = format!("faces of the patch '{}'", patch.name);
                let found = format!("{} from face {} on", patch.face_count, patch.first_face);
                let first = faces.first + end_before;
                let last = faces.first + faces.ends.len();
                return Err(Error::run(format!("the {what} are wrong"))
                    .got(found)
                    .expected(format!("patches that follow each other, of faces {first} to {last}"))
                    .in_file(&self.path));
            };
            end_before = end;
            let is_inner = INNER.iter().any(|kind| patch.kind.starts_with(kind));
            let Some(values) = patch.values(&entries).filter(|_| !is_inner) else { continue };
            if let PatchValues::Unread(word) = values {
                let (patch, file) = (&patch.name, field.display());
                warnings.push(format!(
                    "Values on the patch '{patch}' are not read, means of cells stand for them: {word} is not evaluated ({file})."
                ));
                continue;
            }
            if let PatchValues::List(list) = values
                && list.len() != patch.face_count * component_count
            {
                let what = format!("values of the field on the patch '{}'", patch.name);
                return Err(misfit(&what, list.len(), patch.face_count * component_count, field));
            }
            for face in (begin..end).filter(|&face| is_selected(faces.owners[face] as usize)) {
                let first = if face == 0 { 0 } else { faces.ends[face - 1] as usize };
                all.points.extend(&faces.points[first..faces.ends[face] as usize]);
                all.ends.push(all.points.len());
                let place = (face - begin) * component_count;
                all.values.extend(match values {
                    PatchValues::Uniform(tuple) => &tuple[..],
                    PatchValues::List(list) => &list[place..place + component_count],
                    PatchValues::Unread(_) => &[],
                });
            }
        }
        Ok((all, warnings))
    }
}
