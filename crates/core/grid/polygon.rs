//! Triangles of a polygon by its own points and their numbers alone, so that the two cells of a face cut it alike.

use super::split::lowest;
use glam::DVec3;

/// A triangle by its points' numbers; of a surface, counter-clockwise from outside.
pub(super) type Triangle = [u32; 3];

/// Corners of a polygon at most for which a better cut than a plain fan is looked for: it takes up to their cube.
const MAX_CORNERS: usize = 256;

/// Triangles of a polygon: a fan that turns one way, else ears; `None` where it crosses itself, or has too many corners to tell.
pub fn triangles_of_polygon(corners: &[u32], points: &[DVec3]) -> Option<Vec<Triangle>> {
    if corners.len() > MAX_CORNERS {
        return None;
    }
    let Some(start) = fan_start(corners, points) else {
        return clip_ears(corners, |p| points[p as usize]);
    };
    let mut triangles = Vec::with_capacity(corners.len());
    fan(corners, start, |triangle| triangles.push(triangle));
    Some(triangles)
}

/// Hands out the triangles of a fan from a corner of a face, by its place.
pub(super) fn fan(face: &[u32], start: u16, mut f: impl FnMut(Triangle)) {
    let n = face.len();
    let corner = |k: usize| face[(usize::from(start) + k) % n];
    for k in 1..n.saturating_sub(1) {
        f([corner(0), corner(k), corner(k + 1)]);
    }
}

/// A face from its corner of lowest number toward the lower of the corners beside it, and true if that is the other way round: the neighbour may
/// list it from another corner and backward, and both must compute the same digits.
fn canonical(face: &[u32]) -> (Vec<u32>, bool) {
    let mut ring = face.to_vec();
    ring.rotate_left(lowest(face));
    let is_turned = ring.len() > 2 && ring[1] > ring[ring.len() - 1];
    if is_turned {
        ring[1..].reverse();
    }
    (ring, is_turned)
}

/// Area vector of a triangle, twice its size.
fn area([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// A triangle of a face has an area by more than this part of the face's; rounding could turn it, else.
const FOLD: f64 = 1e-9;

/// First corner of a face's fan: the one of lowest number whose fan has triangles that all turn as the face does; `None` where there is none.
pub(super) fn fan_start(face: &[u32], points: &[DVec3]) -> Option<u16> {
    let n = face.len();
    if n < 4 {
        return Some(lowest(face) as u16);
    }
    let (ring, is_turned) = canonical(face);
    let areas = |start: usize| {
        let mut areas = Vec::with_capacity(n - 2);
        fan(&ring, start as u16, |t| areas.push(area(t.map(|p| points[p as usize]))));
        areas
    };
    let total: DVec3 = areas(0).into_iter().sum();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_unstable_by_key(|&k| ring[k]);
    let tolerance = FOLD * total.length_squared();
    let start = order.into_iter().find(|&k| areas(k).into_iter().all(|area| area.dot(total) > tolerance))?;
    let position = if is_turned { lowest(face) + n - start } else { lowest(face) + start };
    Some((position % n) as u16)
}

/// Triangles of a face, cut off one by one at the corner of lowest number where nothing else of the face lies in the triangle; `None` where there is
/// no such corner, as in a face that crosses itself. `at`: a point's position.
pub(super) fn clip_ears(face: &[u32], at: impl Fn(u32) -> DVec3) -> Option<Vec<Triangle>> {
    let (mut ring, is_turned) = canonical(face);
    let area = |t: Triangle| area(t.map(&at));
    let mut total = DVec3::ZERO;
    fan(&ring, 0, |t| total += area(t));
    let tolerance = FOLD * total.length_squared();
    let is_ear = |ring: &[u32], k: usize| {
        let n = ring.len();
        let [a, b, c] = [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]];
        let turn = |t: Triangle| area(t).dot(total);
        let holds = |&&q: &&u32| [[a, b, q], [b, c, q], [c, a, q]].into_iter().all(|t| turn(t) >= -tolerance);
        turn([a, b, c]) > tolerance && !ring.iter().filter(|q| ![a, b, c].contains(q)).any(|q| holds(&q))
    };
    let mut triangles = Vec::with_capacity(ring.len());
    while ring.len() > 2 {
        let n = ring.len();
        let tip = (0..n).filter(|&k| is_ear(&ring, k)).min_by_key(|&k| ring[k])?;
        triangles.push([ring[(tip + n - 1) % n], ring[tip], ring[(tip + 1) % n]]);
        ring.remove(tip);
    }
    if is_turned {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Some(triangles)
}
