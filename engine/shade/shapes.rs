//! Shapes of the widgets that a vector of segments meets: as many as there are, without a stack frame for the most.

use crate::fragments::batch::LANES_MOST;
use voltet_lanes::optics::smooth::DensityShape;
use voltet_lanes::{Float, Lanes};

/// The shapes, each with its widget's number.
#[derive(Default)]
pub(crate) struct Shapes {
    numbers: Vec<usize>,
    /// At least as many; written in place.
    rows: Vec<Rows>,
}

/// The numbers of a [`DensityShape`], lane by lane; each in its own cache line.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
struct Rows([[f32; LANES_MOST]; 5]);

impl Shapes {
    pub fn clear(&mut self) {
        self.numbers.clear();
    }

    #[inline(always)]
    pub fn push<L: Lanes>(&mut self, number: usize, shape: &DensityShape<L>) {
        let &DensityShape { depth, tilt, bend, change_squared, extent_squared } = shape;
        let place = self.numbers.len();
        self.numbers.push(number);
        if self.rows.len() == place {
            self.rows.push(Rows::default());
        }
        for (row, value) in
            self.rows[place].0.iter_mut().zip([depth, tilt, bend, change_squared, extent_squared])
        {
            value.store(row);
        }
    }

    #[inline(always)]
    pub fn iter<L: Lanes>(&self) -> impl Iterator<Item = (usize, DensityShape<L>)> {
        self.numbers.iter().zip(&self.rows).map(
            #[inline(always)]
            |(&number, rows)| {
                let [depth, tilt, bend, change_squared, extent_squared] = &rows.0;
                let load = L::F::load;
                let shape = DensityShape {
                    depth: load(depth),
                    tilt: load(tilt),
                    bend: load(bend),
                    change_squared: load(change_squared),
                    extent_squared: load(extent_squared),
                };
                (number, shape)
            },
        )
    }
}
