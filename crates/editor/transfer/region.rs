//! Regions of widgets as they lie in the plane: where a widget is not 0.

use super::geometry::{Change, Handle, Scale, array, corners, edges, list, rows};
use super::plane::WidgetPainter;
use eframe::egui::{Color32, Pos2, Shape, Stroke};
use voltet_graph::{Field, LocatedValue, find_setting};

/// Support of a widget, as its table states it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Region {
    Whole,
    /// Ranges of s and g; infinite ones are no limit.
    Box([[f64; 2]; 2]),
    Polygon(Vec<[f64; 2]>),
}

/// The keys of the ranges.
const RANGES: [&str; 2] = ["region.s", "region.g"];

impl Region {
    /// Region of a widget's table, without numbers relative to data.
    pub fn parse(fields: &[Field]) -> Region {
        let Some(region) = find_setting(fields, "region").and_then(LocatedValue::table) else {
            return Region::Whole;
        };
        let corners: Option<Vec<[f64; 2]>> = find_setting(region, "polygon")
            .and_then(LocatedValue::list)
            .and_then(|list| list.iter().map(|row| row.numbers()?.try_into().ok()).collect());
        let limits = |name: &str| array(region, name).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        corners.map_or_else(|| Region::Box([limits("s"), limits("g")]), Region::Polygon)
    }

    pub fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        match self {
            Region::Whole => Vec::new(),
            Region::Box(limits) => {
                let is_closed = limits.as_flattened().iter().all(|x| x.is_finite());
                let all = corners(*limits).into_iter().enumerate().filter(|_| is_closed);
                let sides = edges(*limits, scale).map(|(axis, upper, at)| (Handle::Side(axis, upper), at));
                all.map(|(i, at)| (Handle::Corner(i), at)).chain(sides).collect()
            }
            Region::Polygon(corners) => {
                corners.iter().enumerate().map(|(i, at)| (Handle::Corner(i), *at)).collect()
            }
        }
    }

    /// Changes of the numbers when a handle moves to a position; `None` if the handle is none of a region.
    pub fn moved(&self, handle: Handle, to: [f64; 2]) -> Option<Vec<Change>> {
        match (handle, self) {
            (Handle::Corner(i), Region::Box(limits)) => {
                let after = with_corner(*limits, i, to);
                Some((0..2).map(|k| (RANGES[k], Some(list(&after[k])))).collect())
            }
            (Handle::Corner(i), Region::Polygon(corners)) => {
                let mut corners = corners.clone();
                if let Some(corner) = corners.get_mut(i) {
                    *corner = to;
                }
                // A region is convex: a hand that would dent it waits at its bounds.
                let is_convex = is_convex(&corners);
                Some(if is_convex { stated(&corners) } else { Vec::new() })
            }
            (Handle::Side(axis, upper), Region::Box(limits)) => {
                let mut limits = limits[axis];
                limits[usize::from(upper)] = to[axis];
                let limits = [limits[0].min(limits[1]), limits[0].max(limits[1])];
                Some(vec![(RANGES[axis], Some(list(&limits)))])
            }
            _ => None,
        }
    }

    /// Changes of the numbers when the whole region is moved.
    pub fn shifted(&self, by: [f64; 2]) -> Vec<Change> {
        match self {
            Region::Whole => Vec::new(),
            Region::Box(limits) => {
                let moves = |k: &usize| limits[*k].iter().any(|x| x.is_finite()) && by[*k] != 0.0;
                let moved = |k: usize| (RANGES[k], Some(list(&limits[k].map(|x| x + by[k]))));
                (0..2).filter(moves).map(moved).collect()
            }
            Region::Polygon(corners) => {
                let moved: Vec<[f64; 2]> = corners.iter().map(|&[s, g]| [s + by[0], g + by[1]]).collect();
                stated(&moved)
            }
        }
    }

    /// With a corner more at a place, and which one that is: on the nearest side, or there where that keeps it convex.
    pub fn with_point(&self, at: [f64; 2], scale: &Scale) -> Option<(Vec<Change>, Handle)> {
        let Region::Polygon(corners) = self else { return None };
        let (place, on_side) = nearest_side(corners, at, scale.extent)?;
        let with = |corner: [f64; 2]| {
            let mut corners = corners.clone();
            corners.insert(place, corner);
            corners
        };
        let corners = if is_convex(&with(at)) { with(at) } else { with(on_side) };
        Some((stated(&corners), Handle::Corner(place)))
    }

    /// Without the corner of a handle; `None` where it is none, or is needed.
    pub fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        match (handle, self) {
            (Handle::Corner(i), Region::Polygon(corners)) if corners.len() > 3 && i < corners.len() => {
                let mut corners = corners.clone();
                corners.remove(i);
                Some(stated(&corners))
            }
            _ => None,
        }
    }

    /// `is_all`: of a widget that is its region.
    pub fn draw(&self, pen: &WidgetPainter, is_all: bool) {
        let thin = Stroke::new(pen.stroke.width * 0.6, pen.stroke.color);
        let fill = if is_all { pen.stroke.color.gamma_multiply(0.15) } else { Color32::TRANSPARENT };
        match self {
            Region::Whole => {}
            Region::Box(limits) => pen.rectangle(*limits, thin, fill),
            Region::Polygon(corners) => {
                let points: Vec<Pos2> = corners.iter().map(|at| pen.plane.to_window(*at)).collect();
                pen.painter.add(Shape::convex_polygon(points, fill, thin));
            }
        }
    }
}

fn stated(corners: &[[f64; 2]]) -> Vec<Change> {
    vec![("region.polygon", Some(rows(corners)))]
}

/// The ranges with a corner elsewhere; the lower end stays the lower one.
pub(super) fn with_corner([mut s, mut g]: [[f64; 2]; 2], corner: usize, to: [f64; 2]) -> [[f64; 2]; 2] {
    let (right, upper) = (corner == 1 || corner == 2, corner >= 2);
    s[usize::from(right)] = to[0];
    g[usize::from(upper)] = to[1];
    [s, g].map(|[a, b]| [a.min(b), a.max(b)])
}

/// True if a polygon turns one way at all of its corners.
fn is_convex(corners: &[[f64; 2]]) -> bool {
    let n = corners.len();
    let turn = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % n]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    n >= 3 && ((0..n).all(|i| turn(i) > 0.0) || (0..n).all(|i| turn(i) < 0.0))
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
