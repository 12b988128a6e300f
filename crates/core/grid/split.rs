//! Split of linear cells into tetrahedra, so that neighbours share the same triangles.
//!
//! The rule (docs/src/explanation/optics.md, section 2; J. Dompierre, P. Labbé, M.-G. Vallet, R. Camarero, "How to subdivide
//! pyramids, prisms and hexahedra into tetrahedra", 8th International Meshing Roundtable, 1999): every face is cut
//! from its corner of lowest point number, so that two cells which share it cut it alike whatever their own
//! orientation and vertex order; then the cell is split to match its cut faces:
//! - wedges, pyramids and prisms are joined to their corner of lowest number ([`star`]);
//! - a hexahedron has, besides, a choice inside. Its three faces that do not touch the lowest corner o meet in the
//!   opposite corner p. With n of their diagonals through p, Dompierre's tables 5 to 8 give
//!   n = 0: five tetrahedra, one of them cut off at p; n = 1: six around the corner in which the two diagonals that
//!   avoid p meet; n = 2 and 3: six around o.
//!
//! A tetrahedron that names a point twice (from a collapsed cell) has no volume and is not handed out.

/// Faces of a pyramid, in VTK's vertex order.
pub(super) const PYRAMID_FACES: &[&[usize]] =
    &[&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
pub(super) const WEDGE_FACES: &[&[usize]] =
    &[&[0, 1, 2], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
pub(super) const PENTAGONAL_PRISM_FACES: &[&[usize]] = &[
    &[0, 1, 2, 3, 4],
    &[5, 6, 7, 8, 9],
    &[0, 1, 6, 5],
    &[1, 2, 7, 6],
    &[2, 3, 8, 7],
    &[3, 4, 9, 8],
    &[4, 0, 5, 9],
];
pub(super) const HEXAGONAL_PRISM_FACES: &[&[usize]] = &[
    &[0, 1, 2, 3, 4, 5],
    &[6, 7, 8, 9, 10, 11],
    &[0, 1, 7, 6],
    &[1, 2, 8, 7],
    &[2, 3, 9, 8],
    &[3, 4, 10, 9],
    &[4, 5, 11, 10],
    &[5, 0, 6, 11],
];

/// Hands out a tetrahedron unless it names a point twice.
#[inline]
pub(super) fn emit_distinct<T: Copy + Eq>(t: [T; 4], emit: &mut impl FnMut([T; 4])) {
    let [a, b, c, d] = t;
    if a != b && a != c && a != d && b != c && b != d && c != d {
        emit(t);
    }
}

#[inline]
pub(super) fn lowest<T: Copy + Ord>(corners: &[T]) -> usize {
    let mut at = 0;
    for (i, &c) in corners.iter().enumerate() {
        if c < corners[at] {
            at = i;
        }
    }
    at
}

/// Joins the corner of lowest number to the triangles of every face that does not touch it; each face is a fan
/// from its own corner of lowest number.
pub(super) fn star<T: Copy + Ord>(corners: &[T], faces: &[&[usize]], emit: &mut impl FnMut([T; 4])) {
    let apex = corners[lowest(corners)];
    for face in faces {
        let mut first = 0;
        let mut touches = false;
        for (i, &c) in face.iter().enumerate() {
            touches |= corners[c] == apex;
            if corners[c] < corners[face[first]] {
                first = i;
            }
        }
        if touches {
            continue;
        }
        let n = face.len();
        let corner = |k: usize| corners[face[(first + k) % n]];
        for k in 1..n - 1 {
            emit_distinct([apex, corner(0), corner(k), corner(k + 1)], emit);
        }
    }
}

/// VTK's hexahedron in the order of a voxel (corner x + 2 y + 4 z).
#[inline]
pub(super) fn voxel_order(v: &[u32]) -> [u32; 8] {
    [v[0], v[1], v[3], v[2], v[4], v[5], v[7], v[6]]
}

/// Splits a hexahedron given in the order of a voxel into five or six tetrahedra.
#[inline]
pub(super) fn hexahedron(v: &[u32; 8], emit: &mut impl FnMut([u32; 4])) {
    let o_at = lowest(v);
    // In voxel order the corner across bit i is at index ^ (1 << i).
    let at = |mask: usize| v[o_at ^ mask];
    let o = at(0);
    let p = at(7);
    let near = [at(1), at(2), at(4)]; // joined to o by an edge
    let far = [at(6), at(5), at(3)]; // far[i] is opposite to near[i], joined to p by an edge
    // Face i holds near[i], p and the two far corners other than far[i].
    let through = |i: usize| near[i].min(p) < far[(i + 1) % 3].min(far[(i + 2) % 3]);
    let through = [through(0), through(1), through(2)];
    match through.iter().filter(|&&t| t).count() {
        0 => {
            for i in 0..3 {
                emit_distinct([o, near[i], far[(i + 1) % 3], far[(i + 2) % 3]], emit);
            }
            emit_distinct([o, far[0], far[1], far[2]], emit);
            emit_distinct([p, far[0], far[1], far[2]], emit);
        }
        1 => {
            let i = through.iter().position(|&t| t).unwrap_or(0);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let apex = far[i];
            emit_distinct([apex, near[i], p, far[j]], emit);
            emit_distinct([apex, near[i], p, far[k]], emit);
            emit_distinct([apex, o, far[j], near[i]], emit);
            emit_distinct([apex, o, far[j], near[k]], emit);
            emit_distinct([apex, o, far[k], near[i]], emit);
            emit_distinct([apex, o, far[k], near[j]], emit);
        }
        _ => {
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                let (a, b, c, d) =
                    if through[i] { (near[i], p, far[j], far[k]) } else { (far[j], far[k], near[i], p) };
                emit_distinct([o, a, b, c], emit);
                emit_distinct([o, a, b, d], emit);
            }
        }
    }
}
