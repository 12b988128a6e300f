//! Faces seen edge-on: lines on the screen. Which of the two cells beside one gets a ray is decided by the rounded pixel coordinates,
//! by one rule for records and cells in 64 bits, whichever of them lie beside it. A line that is all but level and crosses a row of
//! pixels is beyond that rule: its corners' rounding alone says where it crosses. Both cells are drawn in 64 bits then, by the plane.

use crate::fragments::spans::crossing_of_row;
use crate::view::{PIXEL_STEP, Seen, View};

/// Projected areas of faces up to this, times the face's extent on the screen, may be the rounding of pixel coordinates alone.
pub(crate) const AREA_NOISE: f64 = 4.0 * PIXEL_STEP;

/// A line is level where it is this many times as long as it falls: [`crate::fragments::spans`] would find its crossings of a row
/// to more than a pixel only.
pub(crate) const LEVEL: f64 = 65536.0;

/// A row this near to a level line, pixels, is on it as far as rounding goes.
const NEAR: f64 = 1.0 / LEVEL;

/// A face seen edge-on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outline {
    corners: [Seen; 3],
    /// Whether its cell lies to the right of the line, and whether below it.
    right: bool,
    below: bool,
    /// It is level, and lies between these two rows of pixels.
    level: Option<[f64; 2]>,
}

impl Outline {
    /// `corners`: of the face, in eye space, by ascending number. `inward`: where its cell lies, on the screen. `None` where the
    /// face is not seen edge-on, or reaches behind the eye.
    pub fn of(view: &View, corners: [[f64; 3]; 3], inward: [f64; 2]) -> Option<Outline> {
        if view.perspective && corners.iter().any(|corner| corner[2] <= 0.0) {
            return None;
        }
        let corners = corners.map(|corner| view.pixel_from_eye(corner));
        let [x, y] = [corners.map(|corner| corner.x), corners.map(|corner| corner.y)];
        let area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
        let least = |c: [f64; 3]| c[0].min(c[1]).min(c[2]);
        let most = |c: [f64; 3]| c[0].max(c[1]).max(c[2]);
        let (reach_x, reach_y) = (most(x) - least(x), most(y) - least(y));
        let level = LEVEL * reach_y < reach_x;
        if AREA_NOISE * (reach_x + reach_y) < area.abs() || level && least(y).ceil() < most(y).ceil() {
            return None;
        }
        // The longest edge gives the direction, the 64-bit plane the side.
        let along = [[0, 1], [0, 2], [1, 2]].map(|[a, b]| [x[b] - x[a], y[b] - y[a]]);
        let long = |d: &[f64; 2]| d[0] * d[0] + d[1] * d[1];
        let [dx, dy] = along.into_iter().max_by(|a, b| long(a).total_cmp(&long(b)))?;
        let turned = if dx * inward[1] - dy * inward[0] < 0.0 { [dy, -dx] } else { [-dy, dx] };
        let level = level.then_some([least(y), most(y)]);
        Some(Outline { corners, right: turned[0] > 0.0, below: turned[1] > 0.0, level })
    }

    /// Whether the line leaves a pixel to its cell; `None` where it does not come by there.
    pub fn admits(&self, [i, j]: [usize; 2]) -> Option<bool> {
        let edges = [[0, 1], [0, 2], [1, 2]].map(|ends| ends.map(|k| &self.corners[k]));
        let crossings = edges.into_iter().filter_map(|ends| crossing_of_row(ends, [i, j]));
        let range = crossings.fold(None, |range: Option<[f32; 2]>, x| {
            let [least, most] = range.unwrap_or([x, x]);
            Some([least.min(x), most.max(x)])
        });
        let column = (i % crate::project::record::TILE) as f32;
        match (range, self.level) {
            (Some([least, _]), _) if self.right => Some(least.ceil() <= column),
            (Some([_, most]), _) => Some(column < most.ceil()),
            (None, Some([top, bottom])) => {
                let row = j as f64;
                (top - NEAR..=bottom + NEAR).contains(&row).then_some(self.below == (bottom <= row))
            }
            (None, None) => None,
        }
    }
}
