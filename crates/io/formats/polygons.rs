//! Polygons of surface files, and the triangles that they become.

use glam::DVec3;
use voltet_core::grid::{Association, triangles_of_polygon};
use voltet_core::{Error, Result, agreeing, counted};

/// Triangles of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceFile {
    /// Positions.
    pub points: Vec<DVec3>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// Normals of the points, where the file has them.
    pub normals: Vec<DVec3>,
    /// Values of the array that was asked for, one a point.
    pub values: Option<Vec<f64>>,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

/// Polygons as a file has them.
#[derive(Default)]
pub(super) struct Polygons {
    pub points: Vec<DVec3>,
    /// One a point, or none.
    pub normals: Vec<DVec3>,
    /// Points of all polygons.
    pub corners: Vec<u32>,
    /// Ends of each polygon's part of them.
    pub ends: Vec<usize>,
    /// Values of the array that was asked for, one a point or polygon.
    pub values: Option<(Association, Vec<f64>)>,
    /// Lines and vertices, which are not drawn.
    pub left_out: u64,
}

impl Polygons {
    /// Adds a polygon.
    pub fn add(&mut self, corners: impl IntoIterator<Item = u32>) {
        self.corners.extend(corners);
        self.ends.push(self.corners.len());
    }
}

impl Polygons {
    /// The polygons in triangles. Values of polygons make points of each triangle its own.
    pub fn triangulated(self) -> Result<SurfaceFile> {
        let Polygons { points, normals, corners, ends, values, left_out } = self;
        if u32::try_from(points.len()).is_err() {
            return Err(Error::run("the surface has too many points").got(points.len()).expected(u32::MAX));
        }
        let (mut triangles, mut polygon_of_each) = (Vec::new(), Vec::new());
        let (mut degenerate, mut crossing, mut start) = (left_out, 0_u64, 0);
        for (number, &end) in ends.iter().enumerate() {
            let polygon = corners.get(start..end).ok_or_else(|| {
                Error::run("the ends of polygons do not rise").got(format!("{end} of polygon {number}"))
            })?;
            start = end;
            if let Some(&point) = polygon.iter().find(|&&p| p as usize >= points.len()) {
                return Err(Error::run(format!("polygon {number} has a point that does not exist"))
                    .got(point)
                    .expected(format!("below {}", points.len())));
            }
            let cut = match *polygon {
                [] | [_] | [_, _] => {
                    degenerate += 1;
                    continue;
                }
                [a, b, c] => vec![[a, b, c]],
                [first, ..] => triangles_of_polygon(polygon, &points).unwrap_or_else(|| {
                    crossing += 1;
                    polygon[1..].windows(2).map(|pair| [first, pair[0], pair[1]]).collect()
                }),
            };
            polygon_of_each.resize(triangles.len() + cut.len(), number);
            triangles.extend(cut);
        }
        let mut warnings = Vec::new();
        if degenerate > 0 {
            let are = agreeing(&degenerate, "is", "are");
            warnings.push(format!(
                "{} of fewer than three points {are} not drawn",
                counted(degenerate, "element")
            ));
        }
        if crossing > 0 {
            let are = agreeing(&crossing, "is", "are");
            warnings.push(format!(
                "{} that {are} crossed or of too many corners became plain fans",
                counted(crossing, "polygon")
            ));
        }
        let is_direction = |&p: &u32| normals[p as usize].is_finite() && normals[p as usize] != DVec3::ZERO;
        let has_directions = normals.is_empty() || triangles.as_flattened().iter().all(is_direction);
        if !has_directions {
            warnings.push("some normals of the file are no directions, so that none is used".into());
        }
        let normals = if has_directions { normals } else { Vec::new() };
        let surface = SurfaceFile { points, triangles, normals, values: None, warnings };
        Ok(match values {
            None => surface,
            Some((Association::Point, values)) => SurfaceFile { values: Some(values), ..surface },
            Some((Association::Cell, values)) => surface.with_values_of(&polygon_of_each, &values),
        })
    }
}

impl SurfaceFile {
    /// Triangles with points of their own, which have the values of their polygons.
    fn with_values_of(self, polygons: &[usize], values: &[f64]) -> SurfaceFile {
        let of_corners = |all: &[DVec3]| -> Vec<DVec3> {
            if all.is_empty() {
                return Vec::new();
            }
            self.triangles.as_flattened().iter().map(|&p| all[p as usize]).collect()
        };
        let number = |k: usize| [0, 1, 2].map(|corner| (3 * k + corner) as u32);
        SurfaceFile {
            points: of_corners(&self.points),
            normals: of_corners(&self.normals),
            triangles: (0..self.triangles.len()).map(number).collect(),
            values: Some(polygons.iter().flat_map(|&polygon| [values[polygon]; 3]).collect()),
            warnings: self.warnings,
        }
    }
}
