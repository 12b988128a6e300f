//! Elements of surface files: polygons with the triangles that they become, lines, and vertices.

use glam::DVec3;
use std::collections::HashSet;
use voltet_core::color::linear_from_srgb;
use voltet_core::grid::{Association, triangles_of_polygon};
use voltet_core::{Error, Result, agreeing, counted};

/// Triangles, lines and vertices of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceFile {
    /// Positions.
    pub points: Vec<DVec3>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// Points of each line.
    pub lines: Vec<Vec<u32>>,
    /// Points that stand for themselves.
    pub vertices: Vec<u32>,
    /// Normals of the points, where the file has them.
    pub normals: Vec<DVec3>,
    /// Values of the array that was asked for, one a point.
    pub values: Option<Vec<f64>>,
    /// The file's own colours, linear RGB and opacity, one a point.
    pub colors: Option<Vec<[f64; 4]>>,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

/// Numbers of a surface file that give its colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceColors<'a> {
    /// None: one colour for all.
    Uniform,
    /// The file's own colours, where it has some.
    Own,
    /// The array of this name, or one of its components as `NAME:0` or `NAME:magnitude`.
    Array(&'a str),
}

impl<'a> SurfaceColors<'a> {
    pub(super) fn array(self) -> Option<&'a str> {
        if let SurfaceColors::Array(name) = self { Some(name) } else { None }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ElementKind {
    /// At least three corners.
    Polygon,
    /// Points in a row.
    Line,
    /// Points of which each stands for itself.
    Vertices,
}

#[derive(Default)]
pub(super) struct Elements {
    pub points: Vec<DVec3>,
    /// One a point, or none.
    pub normals: Vec<DVec3>,
    /// Points of all elements.
    pub corners: Vec<u32>,
    /// Kinds of the elements, and the ends of their parts of the corners.
    pub kinds: Vec<(ElementKind, usize)>,
    /// Values of the array that was asked for, one a point or element.
    pub values: Option<(Association, Vec<f64>)>,
    /// Colours, linear RGB and opacity, one a point or element.
    pub colors: Option<(Association, Vec<[f64; 4]>)>,
}

impl Elements {
    pub fn add(&mut self, kind: ElementKind, corners: impl IntoIterator<Item = u32>) {
        self.corners.extend(corners);
        self.kinds.push((kind, self.corners.len()));
    }

    pub fn add_polygon(&mut self, corners: impl IntoIterator<Item = u32>) {
        self.add(ElementKind::Polygon, corners);
    }

    /// Makes a vertex of each point, where a file has nothing but points.
    pub fn or_vertices(mut self) -> Result<Elements> {
        if self.kinds.is_empty() {
            let count = u32::try_from(self.points.len()).map_err(|_| too_many_points(self.points.len()))?;
            (0..count).for_each(|p| self.add(ElementKind::Vertices, [p]));
        }
        Ok(self)
    }

    /// The elements with polygons in triangles or, if `edges`, as lines: each edge once. Values of elements make points of each its own.
    pub fn into_surface(self, edges: bool) -> Result<SurfaceFile> {
        let Elements { points, normals, corners, kinds, values, colors } = self;
        if u32::try_from(points.len()).is_err() {
            return Err(too_many_points(points.len()));
        }
        let mut parts = Parts { points: &points, edges: edges.then(HashSet::new), ..Parts::default() };
        let mut start = 0;
        for (number, &(kind, end)) in kinds.iter().enumerate() {
            let element = corners.get(start..end).ok_or_else(|| {
                Error::run("the ends of elements do not rise").got(format!("{end} of element {number}"))
            })?;
            start = end;
            parts.add(number, kind, element)?;
        }
        let mut surface = SurfaceFile { warnings: parts.warnings(), ..SurfaceFile::default() };
        let Parts {
            triangles, lines, vertices, element_of_triangle, element_of_line, element_of_vertex, ..
        } = parts;
        let is_direction = |&p: &u32| normals[p as usize].is_finite() && normals[p as usize] != DVec3::ZERO;
        let has_directions = normals.is_empty() || triangles.as_flattened().iter().all(is_direction);
        if !has_directions {
            surface.warnings.push("some normals of the file are no directions, so that none is used".into());
        }
        let has_normals = has_directions && !triangles.is_empty();
        (surface.triangles, surface.lines, surface.vertices) = (triangles, lines, vertices);
        (surface.points, surface.normals) = (points, if has_normals { normals } else { Vec::new() });
        let is_by_element = |association: Option<Association>| association == Some(Association::Cell);
        let element_of_point = if is_by_element(values.as_ref().map(|own| own.0))
            || is_by_element(colors.as_ref().map(|own| own.0))
        {
            surface.separate(&[element_of_triangle, element_of_line, element_of_vertex])
        } else {
            Vec::new()
        };
        surface.values = values.map(|own| spread(own, &element_of_point));
        surface.colors = colors.map(|own| spread(own, &element_of_point));
        Ok(surface)
    }
}

/// Values of points as they are, and those of elements at the points of each.
fn spread<T: Copy>((association, values): (Association, Vec<T>), element_of_point: &[usize]) -> Vec<T> {
    match association {
        Association::Point => values,
        Association::Cell => element_of_point.iter().map(|&element| values[element]).collect(),
    }
}

pub(super) fn too_many_points(count: usize) -> Error {
    Error::run("the surface has too many points").got(count).expected(u32::MAX)
}

/// Triangles, lines and vertices, with the element that each is of.
#[derive(Default)]
struct Parts<'a> {
    points: &'a [DVec3],
    triangles: Vec<[u32; 3]>,
    lines: Vec<Vec<u32>>,
    vertices: Vec<u32>,
    element_of_triangle: Vec<usize>,
    element_of_line: Vec<usize>,
    element_of_vertex: Vec<usize>,
    /// Edges of polygons that are lines already, in place of triangles; none: triangles.
    edges: Option<HashSet<[u32; 2]>>,
    degenerate: u64,
    crossing: u64,
}

impl Parts<'_> {
    fn add(&mut self, number: usize, kind: ElementKind, corners: &[u32]) -> Result<()> {
        if let Some(&point) = corners.iter().find(|&&p| p as usize >= self.points.len()) {
            return Err(Error::run(format!("element {number} has a point that does not exist"))
                .got(point)
                .expected(format!("below {}", self.points.len())));
        }
        match kind {
            ElementKind::Polygon if corners.len() < 3 => self.degenerate += 1,
            ElementKind::Polygon if self.edges.is_some() => self.add_edges(number, corners),
            ElementKind::Polygon => self.add_triangles(number, corners),
            ElementKind::Line => {
                self.lines.push(corners.to_vec());
                self.element_of_line.push(number);
            }
            ElementKind::Vertices => {
                self.vertices.extend(corners);
                self.element_of_vertex.resize(self.vertices.len(), number);
            }
        }
        Ok(())
    }

    fn add_triangles(&mut self, number: usize, polygon: &[u32]) {
        let cut = match *polygon {
            [a, b, c] => vec![[a, b, c]],
            _ => triangles_of_polygon(polygon, self.points).unwrap_or_else(|| {
                self.crossing += 1;
                polygon[1..].windows(2).map(|pair| [polygon[0], pair[0], pair[1]]).collect()
            }),
        };
        self.triangles.extend(cut);
        self.element_of_triangle.resize(self.triangles.len(), number);
    }

    fn add_edges(&mut self, number: usize, polygon: &[u32]) {
        let Some(known) = &mut self.edges else { return };
        for (&a, &b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            if known.insert([a.min(b), a.max(b)]) {
                self.lines.push(vec![a, b]);
                self.element_of_line.push(number);
            }
        }
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.degenerate > 0 {
            let are = agreeing(&self.degenerate, "is", "are");
            let polygons = counted(self.degenerate, "polygon");
            warnings.push(format!("{polygons} of fewer than three points {are} not drawn"));
        }
        if self.crossing > 0 {
            let are = agreeing(&self.crossing, "is", "are");
            let polygons = counted(self.crossing, "polygon");
            warnings.push(format!("{polygons} that {are} crossed or of too many corners became plain fans"));
        }
        warnings
    }
}

impl SurfaceFile {
    /// Gives each triangle, line and vertex points of its own; the element of each point, from those of the three.
    fn separate(&mut self, [of_triangles, of_lines, of_vertices]: &[Vec<usize>; 3]) -> Vec<usize> {
        let (mut old, mut elements) = (Vec::new(), Vec::new());
        let mut renew = |p: &mut u32, element: usize| {
            old.push(*p as usize);
            elements.push(element);
            *p = (old.len() - 1) as u32;
        };
        for (corners, &element) in self.triangles.iter_mut().zip(of_triangles) {
            corners.iter_mut().for_each(|p| renew(p, element));
        }
        for (line, &element) in self.lines.iter_mut().zip(of_lines) {
            line.iter_mut().for_each(|p| renew(p, element));
        }
        self.vertices.iter_mut().zip(of_vertices).for_each(|(p, &element)| renew(p, element));
        let gathered = |all: &[DVec3]| match all {
            [] => Vec::new(),
            all => old.iter().map(|&p| all[p]).collect(),
        };
        (self.points, self.normals) = (gathered(&self.points), gathered(&self.normals));
        elements
    }
}

/// Linear colours and opacities from numbers of a file, red, green, blue and perhaps alpha, 0 to `full`: sRGB with straight alpha.
///
/// Errors: a number out of range, with its place in the list.
pub(super) fn linear_colors(values: &[f64], component_count: usize, full: f64) -> Result<Vec<[f64; 4]>> {
    if let Some(at) = values.iter().position(|value| !(0.0..=full).contains(value)) {
        return Err(Error::run(format!(
            "the colour of element or point {} is out of range",
            at / component_count
        ))
        .got(values[at])
        .expected(format!("0 to {full}, or color or color_by, which leave the file's colours out")));
    }
    let color = |color: &[f64]| {
        let [r, g, b] = [0, 1, 2].map(|k| linear_from_srgb(color[k] / full));
        [r, g, b, color.get(3).map_or(1.0, |alpha| alpha / full)]
    };
    Ok(values.chunks_exact(component_count).map(color).collect())
}
