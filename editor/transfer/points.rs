//! Points of a curve and corners of a region, added and taken away.

use super::form::Drawn;
use super::handles::Handle;
use super::moved::is_convex;
use super::numbers::{Change, rows};
use super::scale::{Scale, extinction_at};
use super::shape::{Form, Region};
use super::strength::along;

impl Drawn {
    /// Whether points can be added.
    pub fn has_points(&self) -> bool {
        matches!(self.form, Form::Points(_)) || matches!(self.region, Region::Polygon(_))
    }

    /// With a point more at a place, and which one that is: of a curve in the colour that it has there; of a polygon on its nearest
    /// side, or there where that keeps it convex.
    pub fn with_point(&self, at: [f64; 2], scale: &Scale) -> Option<(Vec<Change>, Handle)> {
        if let Form::Points(points) = &self.form {
            if points.iter().any(|point| (point[0] - at[0]).abs() <= 1e-6 * scale.extent[0]) {
                return None;
            }
            let place = points.partition_point(|point| point[0] < at[0]);
            let mut point = along(points, at[0]);
            point[4] = extinction_at(at[1] / scale.top(), scale.peak);
            let mut points = points.clone();
            points.insert(place, point);
            return Some((vec![("points", Some(rows(&points)))], Handle::Point(place)));
        }
        let Region::Polygon(corners) = &self.region else { return None };
        let (place, on_side) = nearest_side(corners, at, scale.extent)?;
        let with = |corner: [f64; 2]| {
            let mut corners = corners.clone();
            corners.insert(place, corner);
            corners
        };
        let corners = if is_convex(&with(at)) { with(at) } else { with(on_side) };
        Some((vec![("region.polygon", Some(rows(&corners)))], Handle::Corner(place)))
    }

    /// Without the point of a handle; `None` where it is none, or is needed.
    pub fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        match (handle, &self.form, &self.region) {
            (Handle::Point(i), Form::Points(points), _) if points.len() > 1 && i < points.len() => {
                let mut points = points.clone();
                points.remove(i);
                Some(vec![("points", Some(rows(&points)))])
            }
            (Handle::Corner(i), _, Region::Polygon(corners)) if corners.len() > 3 && i < corners.len() => {
                let mut corners = corners.clone();
                corners.remove(i);
                Some(vec![("region.polygon", Some(rows(&corners)))])
            }
            _ => None,
        }
    }
}

/// The number that a corner on the nearest side would have, and its place there.
fn nearest_side(corners: &[[f64; 2]], at: [f64; 2], extent: [f64; 2]) -> Option<(usize, [f64; 2])> {
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let v = [0, 1].map(|k| (b[k] - a[k]) / extent[k]);
        let w = [0, 1].map(|k| (at[k] - a[k]) / extent[k]);
        let length = v[0] * v[0] + v[1] * v[1];
        let share = if length > 0.0 { ((v[0] * w[0] + v[1] * w[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
        let place = [0, 1].map(|k: usize| a[k] + share * (b[k] - a[k]));
        let apart = ((at[0] - place[0]) / extent[0]).hypot((at[1] - place[1]) / extent[1]);
        (i + 1, place, apart)
    };
    let nearest = (0..corners.len()).map(side).min_by(|a, b| a.2.total_cmp(&b.2))?;
    Some((nearest.0, nearest.1))
}
