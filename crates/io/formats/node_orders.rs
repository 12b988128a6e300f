//! Nodes of elements in the order of VTK's cells, by the places that they have in files: as in the file, or where nodes on upright edges
//! stand before those of the upper face (CGNS, Exodus, Nastran), in VTK after them.
//!
//! Source: CGNS/SIDS 4.4, "Unstructured Grid ElementType Numbering Conventions"; Exodus II (SAND92-2137), figures of node orders; MSC
//! Nastran's Quick Reference Guide, CHEXA and CPENTA; the file formats of VTK, figures of quadratic cells.

/// The order of VTK itself, of which an element takes as many as it has.
pub(super) const IN_ORDER: &[u8; 14] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13];
/// Quadratic wedge, with the centres of its quadrilaterals; without them it is the first 15.
pub(super) const WEDGE: &[u8; 18] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11, 15, 16, 17];
/// Quadratic hexahedron, with the centres of faces and its own as CGNS has them; without them it is the first 20.
pub(super) const HEXAHEDRON: &[u8; 27] =
    &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 24, 22, 21, 23, 20, 25, 26];
