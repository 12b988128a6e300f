//! Elements of a mesh of MFEM as its file lists them.

use super::shapes::{MfemShape, SHAPES};

#[derive(Default)]
pub(super) struct MfemElements {
    pub types: Vec<u8>,
    pub attributes: Vec<i32>,
    /// Vertices of all, from 0.
    pub vertices: Vec<u32>,
}

pub(super) struct MfemElement<'a> {
    /// Number of its type.
    pub number: usize,
    pub shape: &'static MfemShape,
    pub vertices: &'a [u32],
    /// End of its vertices among those of all.
    pub end: usize,
}

impl MfemElements {
    pub fn iter(&self) -> impl Iterator<Item = MfemElement<'_>> {
        self.types.iter().scan(0, |end, &own| {
            let (number, begin) = (usize::from(own), *end);
            let shape = &SHAPES[number];
            *end += shape.vertex_count;
            Some(MfemElement { number, shape, vertices: &self.vertices[begin..*end], end: *end })
        })
    }
}
