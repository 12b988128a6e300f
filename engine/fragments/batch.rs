//! A batch of fragments: what the crossings find and the shader integrates.

/// Most lanes of any set.
pub(crate) const LANES_MOST: usize = 16;
/// Fragments evaluated at a time: their arrays stay in the first-level cache.
pub(crate) const BATCH: usize = 256;

/// What is known of a batch of fragments. Lengths in scene lengths; attributes scaled.
pub(crate) struct Batch {
    /// Pixel of the tile, row << 4 | column.
    pub pixel: Vec<u32>,
    /// Fragments that cross their cell over a positive length.
    pub hits: u32,
    /// D; 0 where the ray misses the cell.
    pub length: Vec<f32>,
    /// Depth of the entry from the distance origin (orders segments; × stretch = distance).
    pub entry: Vec<f32>,
    /// Depth of the exit.
    pub exit: Vec<f32>,
    /// Values at the entry, attribute by attribute.
    pub front: Vec<Vec<f32>>,
    /// Values at the exit.
    pub back: Vec<Vec<f32>>,
    /// Attributes that widgets look at; behind them comes the gradient.
    pub scalar_count: usize,
}

impl Batch {
    pub fn new(attribute_count: usize, scalar_count: usize) -> Self {
        let column = || vec![0f32; BATCH];
        Batch {
            pixel: vec![0; BATCH],
            hits: 0,
            length: column(),
            entry: column(),
            exit: column(),
            front: (0..attribute_count).map(|_| column()).collect(),
            back: (0..attribute_count).map(|_| column()).collect(),
            scalar_count,
        }
    }
}
