//! Nodes of elements in the order of VTK's cells, by the places that they have in files: as in the file, or where nodes on upright edges
//! stand before those of the upper face (CGNS, Exodus, Nastran), in VTK after them.
//!
//! Source: CGNS/SIDS 4.4, "Unstructured Grid ElementType Numbering Conventions"; the file formats of VTK, figures of quadratic cells.

pub(super) const IN_ORDER: &[u8; 14] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13];
pub(super) const WEDGE: &[u8; 18] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11, 15, 16, 17];
/// With the centres of faces as CGNS has them.
pub(super) const HEXAHEDRON: &[u8; 27] =
    &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 24, 22, 21, 23, 20, 25, 26];
