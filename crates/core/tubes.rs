//! Lines as tubes and points as spheres: closed triangles with normals, at one distance from the line or the point.
//!
//! A tube is a ring of points around each point of its line, and half a sphere at each end. A ring lies in the plane that halves the
//! bend there, so that the tube keeps its radius on both sides; the reflection in this plane carries the frame from one piece of the
//! line to the next without a twist (Wang et al. 2008, Computation of rotation minimizing frames, ACM Transactions on Graphics 27(1),
//! whose first reflection it is). Where the bend is larger than that allows, one tube ends and another one begins: half a sphere each.

use crate::arithmetic::unit_vector;
use crate::progress::{Progress, refuse_beyond_memory};
use crate::{Error, Result};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Cosine of the largest bend whose ring is shared by both pieces, 60°: its outer side is 15 % farther from the line than the radius.
const MIN_SHARED_COSINE: f64 = 0.5;

/// Radius and fineness of tubes and spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubeShape {
    /// Radius, world units, above 0.
    pub radius: f64,
    /// Sides of a tube and of a sphere's equator, at least 3.
    pub sides: usize,
}

/// Triangles of tubes and spheres, counter-clockwise from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tubes {
    /// Positions.
    pub points: Vec<DVec3>,
    /// Unit normals of the points, outward.
    pub normals: Vec<DVec3>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// For each point that of the line or sphere that it lies around.
    pub origins: Vec<u32>,
    /// Number of lines that have no length.
    pub lines_without_length: u64,
    /// Number of places in lines and spheres that are not finite: a line breaks there.
    pub points_not_finite: u64,
}

/// Tubes around lines and spheres around `vertices`, all by numbers of points.
///
/// # Errors
/// - a radius or a number of sides out of range; more points than 32 bits count; memory ends; a stopped run.
pub fn tubes(
    points: &[DVec3],
    lines: &[impl AsRef<[u32]>],
    vertices: &[u32],
    shape: TubeShape,
    progress: &dyn Progress,
) -> Result<Tubes> {
    let TubeShape { radius, sides } = shape;
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(Error::run("a tube's radius is out of range").got(radius).expected("a number above 0"));
    }
    if sides < 3 {
        return Err(Error::run("a tube has too few sides").got(sides).expected("at least 3"));
    }
    let mut builder = Builder::new(points, shape);
    let mut pieces = Vec::new();
    for line in lines {
        builder.add_pieces(line.as_ref(), &mut pieces);
    }
    let spheres: Vec<u32> = vertices.iter().copied().filter(|&p| builder.is_finite(p)).collect();
    let ring_count = pieces.iter().map(Vec::len).sum::<usize>() + spheres.len();
    let part_count = pieces.len() + spheres.len();
    builder.reserve(ring_count, part_count, progress)?;
    for (number, piece) in pieces.iter().enumerate() {
        if number % 4096 == 0 {
            progress.check_cancelled()?;
        }
        builder.add_tube(piece);
    }
    spheres.into_iter().for_each(|p| builder.add_sphere(p));
    Ok(builder.tubes)
}

/// Makes tubes and spheres one after another.
struct Builder<'a> {
    places: &'a [DVec3],
    shape: TubeShape,
    /// Cosine and sine of each side's corner.
    turns: Vec<[f64; 2]>,
    /// Cosine and sine of the rings of half a sphere above its equator, from the equator on, without the pole.
    latitudes: Vec<[f64; 2]>,
    /// First point of the last ring; none: a pole is the last point.
    last: Option<u32>,
    tubes: Tubes,
}

/// Two unit vectors across a piece of a line and the one along it, right-handed.
#[derive(Clone, Copy)]
struct Axes {
    u: DVec3,
    v: DVec3,
    along: DVec3,
}

impl Axes {
    fn new(along: DVec3, near: DVec3) -> Axes {
        let across = unit_vector(near.reject_from_normalized(along));
        let u = if across == DVec3::ZERO { along.any_orthonormal_vector() } else { across };
        Axes { u, v: along.cross(u), along }
    }

    /// The unit vector across the line at a turn.
    fn across(&self, [cosine, sine]: [f64; 2]) -> DVec3 {
        self.u * cosine + self.v * sine
    }
}

impl<'a> Builder<'a> {
    fn new(places: &'a [DVec3], shape: TubeShape) -> Builder<'a> {
        let sides = shape.sides;
        let angle = |angle: f64| [angle.cos(), angle.sin()];
        // As many parts of half a meridian as a quarter of the equator has.
        let bands = sides.div_ceil(4);
        let turns = (0..sides).map(|k| angle(TAU * k as f64 / sides as f64)).collect();
        let latitudes = (1..bands).map(|k| angle(FRAC_PI_2 * k as f64 / bands as f64)).collect();
        Builder { places, shape, turns, latitudes, last: None, tubes: Tubes::default() }
    }

    fn at(&self, p: u32) -> DVec3 {
        self.places[p as usize]
    }

    fn is_finite(&mut self, p: u32) -> bool {
        let is_finite = self.places.get(p as usize).is_some_and(|at| at.is_finite());
        self.tubes.points_not_finite += u64::from(!is_finite);
        is_finite
    }

    /// Refuses what is too much for 32 bits or for memory, and makes room for the rest.
    fn reserve(&mut self, ring_count: usize, part_count: usize, progress: &dyn Progress) -> Result<()> {
        let rings = ring_count.saturating_add(part_count.saturating_mul(2 * self.latitudes.len()));
        let point_count = rings.saturating_mul(self.shape.sides).saturating_add(2 * part_count);
        if u32::try_from(point_count).is_err() {
            let error = Error::run("tubes and spheres have too many points").got(point_count);
            return Err(error.expected(format!("at most {}: fewer sides, lines or points", u32::MAX)));
        }
        let what = || format!("triangles of {part_count} tubes and spheres");
        // A point with its normal and origin, and two triangles for each.
        refuse_beyond_memory(progress, what, 76 * point_count as u64)?;
        self.tubes.points.reserve_exact(point_count);
        self.tubes.normals.reserve_exact(point_count);
        self.tubes.origins.reserve_exact(point_count);
        self.tubes.triangles.reserve_exact(2 * point_count);
        Ok(())
    }

    /// Adds the parts of a line that are one tube each: without places that are not finite, repeated points and sharp bends.
    fn add_pieces(&mut self, line: &[u32], pieces: &mut Vec<Vec<u32>>) {
        let mut runs = vec![Vec::new()];
        let mut is_whole = true;
        for &p in line {
            if !self.is_finite(p) {
                is_whole = false;
                runs.push(Vec::new());
            } else if let Some(run) = runs.last_mut()
                && run.last().is_none_or(|&last| self.places[last as usize] != self.places[p as usize])
            {
                run.push(p);
            }
        }
        let before = pieces.len();
        for run in runs.iter().filter(|run| run.len() > 1) {
            let mut start = 0;
            for k in 1..run.len() - 1 {
                if !self.is_shared([run[k - 1], run[k], run[k + 1]]) {
                    pieces.push(run[start..=k].to_vec());
                    start = k;
                }
            }
            pieces.push(run[start..].to_vec());
        }
        self.tubes.lines_without_length += u64::from(is_whole && pieces.len() == before);
    }

    /// True if one ring serves both sides of a bend: it is within the limit, and the ring reaches no farther than half of each side.
    fn is_shared(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|p| self.at(p));
        let (from, to) = (unit_vector(b - a), unit_vector(c - b));
        // Half the bend's tangent.
        let reach = self.shape.radius * (to - from).length() / (to + from).length();
        from.dot(to) >= MIN_SHARED_COSINE && reach <= 0.5 * (b - a).length().min((c - b).length())
    }

    fn add_tube(&mut self, line: &[u32]) {
        let direction = |pair: &[u32]| unit_vector(self.at(pair[1]) - self.at(pair[0]));
        let directions: Vec<DVec3> = line.windows(2).map(direction).collect();
        let (Some(&first), Some(&last), Some(&along)) = (line.first(), line.last(), directions.first())
        else {
            return;
        };
        let mut axes = Axes::new(along, DVec3::ZERO);
        self.begin(first, &axes);
        self.add_ring(first, |turn| [axes.across(turn); 2]);
        for (pair, &p) in directions.windows(2).zip(&line[1..]) {
            let middle = unit_vector(pair[0] + pair[1]);
            self.add_ring(p, |turn| {
                let across = axes.across(turn);
                let share = across.dot(middle) / axes.along.dot(middle);
                [across - axes.along * share, unit_vector(across.reject_from_normalized(middle))]
            });
            axes = Axes::new(pair[1], axes.u - middle * (2.0 * axes.u.dot(middle)));
        }
        self.add_ring(last, |turn| [axes.across(turn); 2]);
        self.end(last, &axes);
    }

    fn add_sphere(&mut self, p: u32) {
        let axes = Axes::new(DVec3::Z, DVec3::X);
        self.begin(p, &axes);
        self.add_ring(p, |turn| [axes.across(turn); 2]);
        self.end(p, &axes);
    }

    /// Begins with half a sphere but for its equator, whose pole points back.
    fn begin(&mut self, p: u32, axes: &Axes) {
        self.last = None;
        self.add_point(p, [-axes.along; 2]);
        for k in (0..self.latitudes.len()).rev() {
            let [cosine, sine] = self.latitudes[k];
            self.add_ring(p, |turn| [axes.across(turn) * cosine - axes.along * sine; 2]);
        }
    }

    /// Ends with half a sphere but for its equator, whose pole points on.
    fn end(&mut self, p: u32, axes: &Axes) {
        for k in 0..self.latitudes.len() {
            let [cosine, sine] = self.latitudes[k];
            self.add_ring(p, |turn| [axes.across(turn) * cosine + axes.along * sine; 2]);
        }
        let (pole, sides) = (self.next(), self.shape.sides as u32);
        self.add_point(p, [axes.along; 2]);
        if let Some(ring) = self.last {
            self.tubes.triangles.extend((0..sides).map(|k| [ring + k, ring + (k + 1) % sides, pole]));
        }
    }

    fn next(&self) -> u32 {
        self.tubes.points.len() as u32
    }

    /// Adds a point around another one: its offset in radii, and its normal.
    fn add_point(&mut self, p: u32, [offset, normal]: [DVec3; 2]) {
        let at = self.at(p) + offset * self.shape.radius;
        self.tubes.points.push(at);
        self.tubes.normals.push(normal);
        self.tubes.origins.push(p);
    }

    /// Adds a ring, and the triangles between it and the ring or pole before. `place`: offset and normal at a turn.
    fn add_ring(&mut self, p: u32, place: impl Fn([f64; 2]) -> [DVec3; 2]) {
        let (ring, sides) = (self.next(), self.shape.sides as u32);
        for k in 0..self.turns.len() {
            self.add_point(p, place(self.turns[k]));
        }
        let side = |k: u32| [k, (k + 1) % sides];
        let triangles = &mut self.tubes.triangles;
        match self.last {
            Some(last) => triangles.extend((0..sides).map(side).flat_map(|[k, next]| {
                [[last + k, last + next, ring + k], [last + next, ring + next, ring + k]]
            })),
            None => triangles.extend((0..sides).map(side).map(|[k, next]| [ring - 1, ring + next, ring + k])),
        }
        self.last = Some(ring);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::NoProgress;
    use std::collections::HashMap;

    fn made(points: &[DVec3], lines: &[Vec<u32>], vertices: &[u32], radius: f64, sides: usize) -> Tubes {
        tubes(points, lines, vertices, TubeShape { radius, sides }, &NoProgress).unwrap()
    }

    /// Each edge is passed once in each direction.
    fn is_closed(tubes: &Tubes) {
        let mut passed: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in &tubes.triangles {
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                *passed.entry(edge).or_default() += 1;
            }
        }
        for (&[a, b], count) in &passed {
            assert_eq!((*count, passed.get(&[b, a])), (1, Some(&1)), "{a} {b}");
        }
    }

    /// Triangles and normals point away from the line.
    fn is_outward(tubes: &Tubes) {
        for corners in &tubes.triangles {
            let [a, b, c] = corners.map(|p| tubes.points[p as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.length() > 0.0, "{corners:?}");
            for p in corners {
                let own = tubes.normals[*p as usize];
                assert!((own.length() - 1.0).abs() < 1e-14, "{own}");
                assert!(own.dot(normal) > 0.0, "{corners:?}: {own} {normal}");
            }
        }
    }

    fn distance(at: DVec3, points: &[DVec3], line: &[u32]) -> f64 {
        let to_piece = |pair: &[u32]| {
            let [a, b] = [pair[0], pair[1]].map(|p| points[p as usize]);
            let share = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            at.distance(a + (b - a) * share)
        };
        line.windows(2).map(to_piece).fold(f64::INFINITY, f64::min)
    }

    /// Volume that the triangles enclose.
    fn volume(tubes: &Tubes) -> f64 {
        let part = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|p| tubes.points[p as usize]);
            a.dot(b.cross(c)) / 6.0
        };
        tubes.triangles.iter().map(part).sum()
    }

    #[test]
    fn a_straight_tube_is_closed_and_has_its_radius() {
        let points = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 4.0, 5.0), DVec3::new(3.0, 6.0, 7.0)];
        for sides in [3, 4, 7, 16, 33] {
            let tube = made(&points, &[vec![0, 1, 2]], &[], 0.25, sides);
            is_closed(&tube);
            is_outward(&tube);
            for at in &tube.points {
                // Rounding of coordinates below 8.
                assert!((distance(*at, &points, &[0, 2]) - 0.25).abs() < 4e-15, "{at}");
            }
            // The middle of a side and the middle between two rings of the ends are the nearest places.
            let nearest = 0.25 * (TAU / 2.0 / sides as f64).cos();
            let in_ends = (FRAC_PI_2 / 2.0 / sides.div_ceil(4) as f64).cos();
            for corners in &tube.triangles {
                let middle = corners.map(|p| tube.points[p as usize]).iter().sum::<DVec3>() / 3.0;
                let found = distance(middle, &points, &[0, 2]);
                assert!(found >= nearest * in_ends && found < 0.25, "{found} of {sides} sides");
            }
        }
    }

    #[test]
    fn a_sphere_is_closed_and_its_volume_converges() {
        let points = [DVec3::new(1.0, -1.0, 0.5)];
        let mut before = 1.0;
        for sides in [3, 8, 16, 32, 64] {
            let ball = made(&points, &[], &[0], 2.0, sides);
            is_closed(&ball);
            is_outward(&ball);
            assert!(ball.points.iter().all(|at| (at.distance(points[0]) - 2.0).abs() < 1e-15 * 4.0));
            let lacking = 1.0 - volume(&ball) / (4.0 / 3.0 * std::f64::consts::PI * 8.0);
            // By the square of the sides' length, once they are small.
            assert!(lacking > 0.0 && lacking < before * if sides > 16 { 0.27 } else { 1.0 }, "{lacking}");
            before = lacking;
        }
    }

    #[test]
    fn bends_keep_the_radius_and_do_not_twist() {
        // A helix of radius 2 whose steps are bends of 11°; a zigzag of sharp ones; one that turns back.
        let helix: Vec<DVec3> = (0..100)
            .map(|k| f64::from(k) * 0.2)
            .map(|t| DVec3::new(2.0 * t.cos(), 2.0 * t.sin(), 0.3 * t))
            .collect();
        let zigzag: Vec<DVec3> =
            (0..6).map(|k| DVec3::new(f64::from(k), f64::from(k % 2) * 2.0, 0.0)).collect();
        let back = vec![DVec3::ZERO, DVec3::X, DVec3::ZERO, DVec3::Y];
        for (points, tube_count, outside) in [(helix, 1, 1.01), (zigzag, 5, 1.0), (back, 3, 1.0)] {
            let line: Vec<u32> = (0..points.len() as u32).collect();
            let tube = made(&points, std::slice::from_ref(&line), &[], 0.1, 12);
            is_closed(&tube);
            is_outward(&tube);
            let rings = if tube_count == 1 { points.len() } else { 2 * tube_count };
            assert_eq!(tube.points.len(), 12 * (rings + 4 * tube_count) + 2 * tube_count);
            for at in &tube.points {
                let found = distance(*at, &points, &line) / 0.1;
                // Within half a sphere at a bend that another piece covers a point may be nearer.
                assert!(found < outside + 1e-14 && (tube_count > 1 || found > 1.0 - 1e-14), "{found}");
            }
        }
        // As many steps as the radius allows: where rings would cross, each piece is a tube of its own.
        let tight: Vec<DVec3> = (0..20)
            .map(|k| f64::from(k) * 0.1)
            .map(|t| DVec3::new(0.05 * t.cos(), 0.05 * t.sin(), 0.0))
            .collect();
        let line: Vec<u32> = (0..20).collect();
        let tube = made(&tight, &[line], &[], 0.1, 8);
        is_closed(&tube);
        is_outward(&tube);
        assert_eq!(tube.points.len(), 19 * (8 * (2 + 2) + 2));
    }

    #[test]
    fn degenerate_lines_are_passed_over_and_counted() {
        let nan = DVec3::new(0.0, f64::NAN, 0.0);
        let points = [DVec3::ZERO, DVec3::ZERO, DVec3::X, nan, DVec3::Y, DVec3::Z];
        let lines = [vec![], vec![0], vec![0, 1, 0], vec![0, 1, 2, 2], vec![0, 2, 3, 4, 5], vec![3, 0]];
        let found = made(&points, &lines, &[3, 5, 99], 0.1, 6);
        is_closed(&found);
        is_outward(&found);
        assert_eq!((found.lines_without_length, found.points_not_finite), (3, 4));
        // Two lines' ends of two rings and one of two, and a sphere.
        assert_eq!(found.points.len(), 3 * (6 * (2 + 2) + 2) + (6 * 3 + 2));
        assert_eq!(made(&points, &[], &[], 1.0, 3), Tubes::default());
        for (radius, sides) in [(0.0, 8), (-1.0, 8), (f64::NAN, 8), (f64::INFINITY, 8), (1.0, 2)] {
            assert!(tubes(&points, &lines, &[], TubeShape { radius, sides }, &NoProgress).is_err());
        }
    }

    #[test]
    fn each_point_knows_the_one_it_lies_around() {
        let points = [DVec3::ZERO, DVec3::X * 3.0, DVec3::X * 6.0, DVec3::Y * 5.0];
        let found = made(&points, &[vec![2, 1, 0]], &[3], 0.5, 9);
        for (at, &origin) in found.points.iter().zip(&found.origins) {
            assert!((at.distance(points[origin as usize]) - 0.5).abs() < 1e-14);
        }
        assert!((0..4).all(|p| found.origins.contains(&p)));
    }
}
