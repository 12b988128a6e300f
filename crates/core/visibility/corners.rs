//! Corners of a cell's faces.

/// The corners of the face opposite corner `k`, as the cell counts them.
#[inline]
pub(super) fn face_of([a, b, c, d]: [u32; 4], k: usize) -> [u32; 3] {
    match k {
        0 => [b, c, d],
        1 => [a, c, d],
        2 => [a, b, d],
        _ => [a, b, c],
    }
}
