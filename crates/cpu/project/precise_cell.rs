//! Cells that 32 bits cannot hold, crossed in 64: cells that reach behind the eye or very near it, and extreme
//! slivers.
//!
//! The ray is held against the four face planes in eye space. A face whose plane contains the ray exactly (a ray
//! in a shared face, the eye on a face) lets the ray into the cell on the positive side of its normal only, the
//! normal being taken from the face's points in ascending order: one of two neighbours gets the ray.
//!
//! The neighbour may be a projected cell, for which a face seen edge-on is a line on the screen, and one side of it gets the ray by
//! [`crate::fragments::spans`]. So such a face is that line here, too.

use crate::project::edge_on::EdgeOnFace;
use crate::tolerances::{EYE_CUT, FLAT_VOLUME};
use crate::view::View;
use glam::DVec3;

/// A tetrahedron in eye space.
#[derive(Debug, Clone)]
pub(crate) struct PreciseCell {
    /// Number of the tetrahedron.
    pub id: u32,
    /// Pixels it may cover: x0, y0, x1, y1 (exclusive).
    pub bounds: [usize; 4],
    faces: [Face; 4],
    near: f64,
}

#[derive(Debug, Clone, Copy)]
struct Face {
    normal: DVec3,
    /// A point of the plane.
    on: DVec3,
    /// +1 if the cell lies on the normal's side, −1 if not.
    side: f64,
    /// normal · (opposite corner − on).
    height: f64,
    /// The face as a line on the screen, where it is seen edge-on.
    outline: Option<EdgeOnFace>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct PreciseCrossing {
    /// Depth of entry and exit, scene lengths.
    pub depth: [f64; 2],
    /// Barycentric coordinates at entry and exit.
    pub weights: [[f64; 4]; 2],
}

impl PreciseCell {
    /// `None` if no ray of the picture can cross the cell over a positive length.
    pub fn new(view: &View, id: u32, corners: [DVec3; 4]) -> Option<PreciseCell> {
        if flat(corners) {
            return None;
        }
        let e = corners.map(|p| view.eye_from_world(p));
        let bounds = bounds(view, &e)?;
        let mut faces = Vec::with_capacity(4);
        for opposite in 0..4 {
            let mut on = (0..4).filter(|&k| k != opposite).map(|k| DVec3::from(e[k]));
            let (Some(a), Some(b), Some(c)) = (on.next(), on.next(), on.next()) else { continue };
            let normal = (b - a).cross(c - a);
            let height = normal.dot(DVec3::from(e[opposite]) - a);
            if height == 0.0 || !height.is_finite() {
                return None;
            }
            let side = height.signum();
            let outline = EdgeOnFace::of(view, [a, b, c].map(Into::into), [side * normal.x, side * normal.y]);
            faces.push(Face { normal, on: a, side, height, outline });
        }
        let faces = faces.try_into().ok()?;
        Some(PreciseCell { id, bounds, faces, near: view.near })
    }

    /// Crosses the cell with the ray through a pixel.
    pub fn cross(&self, view: &View, i: usize, j: usize) -> Option<PreciseCrossing> {
        let (origin, direction) = view.ray(i as f64, j as f64);
        let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
        let (mut enter, mut leave) = (self.near, f64::INFINITY);
        for face in &self.faces {
            match face.outline.as_ref().and_then(|outline| outline.admits([i, j])) {
                Some(true) => continue,
                Some(false) => return None,
                None => {}
            }
            let at = face.normal.dot(origin - face.on);
            let slope = face.normal.dot(direction);
            if slope == 0.0 {
                // In a face: as if moved by (ε, ε²) to the right and down, which is the rule of the spans. The faces about an edge
                // then give the ray to one of their cells.
                let moved = if face.normal.x == 0.0 { face.normal.y } else { face.normal.x };
                let to = if at == 0.0 { moved } else { at };
                if to * face.side <= 0.0 {
                    return None;
                }
            } else if slope * face.side > 0.0 {
                enter = enter.max(-at / slope);
            } else {
                leave = leave.min(-at / slope);
            }
        }
        if enter >= leave {
            return None;
        }
        let weights = [enter, leave].map(|t| {
            let height = |face: Face| face.normal.dot(origin + t * direction - face.on);
            let mut w = self.faces.map(|face| (height(face) / face.height).clamp(0.0, 1.0));
            let sum: f64 = w.iter().sum();
            w.iter_mut().for_each(|w| *w /= sum);
            w
        });
        weights
            .iter()
            .flatten()
            .all(|w| w.is_finite())
            .then_some(PreciseCrossing { depth: [enter, leave], weights })
    }
}

/// True if the corners lie in a plane, as far as 64 bits can say: a ray's length in the cell is then under
/// 1e-14 of its size.
fn flat(corners: [DVec3; 4]) -> bool {
    let edges = [1, 2, 3].map(|k| corners[k] - corners[0]);
    let largest = edges.iter().fold(0.0f64, |largest, e| largest.max(e.abs().max_element()));
    if largest == 0.0 || !largest.is_finite() {
        return true;
    }
    let [a, b, c] = edges.map(|e| e / largest);
    let size = a.length() * b.length() * c.length();
    a.dot(b.cross(c)).abs() <= FLAT_VOLUME * size
}

/// Pixels that the cell may cover: its corners in front of a plane close to the eye, and its edges cut there.
fn bounds(view: &View, e: &[[f64; 3]; 4]) -> Option<[usize; 4]> {
    let [width, height] = view.size;
    let deepest = e.iter().fold(f64::NEG_INFINITY, |z, p| z.max(p[2]));
    if deepest <= view.near {
        return None;
    }
    // Parallel rays need no cut; with perspective nothing before `cut` is projected.
    let cut = if view.perspective { view.near.max(EYE_CUT * deepest) } else { f64::NEG_INFINITY };
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let mut take = |p: [f64; 3]| {
        let vertex = view.pixel_from_eye(p);
        for (k, x) in [vertex.x, vertex.y].into_iter().enumerate() {
            low[k] = low[k].min(x);
            high[k] = high[k].max(x);
        }
    };
    for p in e.iter().filter(|p| p[2] >= cut) {
        take(*p);
    }
    let mut nearer = false;
    for a in 0..4 {
        for b in 0..a {
            let (za, zb) = (e[a][2] - cut, e[b][2] - cut);
            if (za < 0.0) != (zb < 0.0) {
                let t = za / (za - zb);
                take(std::array::from_fn(|k| e[a][k] + t * (e[b][k] - e[a][k])));
            }
        }
        nearer |= e[a][2] < cut;
    }
    // What lies between the near plane and the cut is seen within a cone about the axis that is no wider than
    // the picture there; if the cell's box meets it, any pixel may be concerned.
    if nearer && cut > view.near {
        let reach = |axis: usize, n: usize| {
            let far = view.axis[axis].abs().max((n as f64 - view.axis[axis]).abs());
            cut * view.pixel * (far + 1.0)
        };
        let meets = (0..2).all(|k| {
            let r = reach(k, view.size[k]);
            e.iter().any(|p| p[k] <= r) && e.iter().any(|p| p[k] >= -r)
        });
        if meets {
            return Some([0, 0, width, height]);
        }
    }
    // One pixel of slack: rounding here must not cut what the exact test below admits.
    let from = |x: f64| (x - 1.0).max(0.0) as usize;
    let to = |x: f64, n: usize| ((x + 2.0).max(0.0) as usize).min(n);
    let rectangle =
        [from(low[0]).min(width), from(low[1]).min(height), to(high[0], width), to(high[1], height)];
    (rectangle[0] < rectangle[2] && rectangle[1] < rectangle[3]).then_some(rectangle)
}
