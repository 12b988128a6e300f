//! What is asked of a test of gradient filters.

/// What is measured, and what the filter is held to.
#[derive(Debug, Clone)]
pub struct Wish {
    /// Boxes along a side of each grid, coarse to fine, two at least.
    pub levels: Vec<usize>,
    /// Boxes along a side of the grid that is timed.
    pub timed: usize,
    /// How often each filter is timed, after once that warms up.
    pub rounds: usize,
    /// What the filter is held to.
    pub hold_to: Vec<Hold>,
    /// The least order of convergence inside.
    pub order: f64,
    /// The largest error on linear fields, by the largest gradient.
    pub linear_error: f64,
}

/// Something that a filter can be held to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// A finite vector at every point, on every grid.
    Finite,
    /// Exact on linear fields, on every grid.
    Linear,
    /// Its order of convergence inside, on every family of grids.
    Order,
    /// The same gradient wherever the grid stands and however it is numbered.
    Invariance,
}

impl Default for Wish {
    fn default() -> Wish {
        Wish {
            levels: vec![4, 8, 16, 24],
            timed: 40,
            rounds: 5,
            hold_to: vec![Hold::Finite, Hold::Linear, Hold::Order, Hold::Invariance],
            order: 0.8,
            linear_error: 1e-9,
        }
    }
}
