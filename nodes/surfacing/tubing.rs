//! Tubes around lines and spheres around points: their parameters, and the shape that they are.

use super::{Shape, gathered};
use crate::relative::RADIUS;
use glam::DVec3;
use voltet_core::tubes::{TubeShape, Tubes, tubes};
use voltet_core::{Result, agreeing, counted};
use voltet_graph::{DefaultValue, Parameter, ParameterType, Parameters, Range, RunContext};

/// Parameters of tubes; `radius`: where the file sets none.
pub const fn tube_parameters(radius: &'static str) -> [Parameter; 2] {
    [
        Parameter {
            default: DefaultValue::Text(radius),
            help: "radius of tubes and spheres; a percentage: of the diagonal of the bounds",
            ..RADIUS
        },
        Parameter {
            name: "sides",
            parameter_type: ParameterType::Integer(Range::within(3.0, 256.0)),
            unit: "",
            default: DefaultValue::Integer(12),
            help: "sides of a tube, and of a sphere's equator",
        },
    ]
}

/// Tubes around lines and spheres around vertices, by numbers of points; what is left out is noted.
pub fn made(
    call: &mut RunContext,
    own: &Parameters,
    points: &[DVec3],
    lines: &[impl AsRef<[u32]> + Sync],
    vertices: &[u32],
) -> Result<Tubes> {
    let shape = TubeShape { radius: own.number("radius")?, sides: own.integer("sides")? as usize };
    let found = call.stage("tubes", |progress| tubes(points, lines, vertices, shape, progress))?;
    let notes = [
        (found.lines_without_length, "line", "without length"),
        (found.points_not_finite, "point", "not finite"),
    ];
    for (count, noun, why) in notes.into_iter().filter(|note| note.0 > 0) {
        let are = agreeing(&count, "is", "are");
        call.notes.warnings.push(format!("{} {are} left out: {why}", counted(count, noun)));
    }
    call.notes.counts.insert("lines", lines.len() as u64);
    Ok(found)
}

impl Shape {
    /// Tubes with the values and colours of the points that they lie around.
    pub fn of_tubes(tubes: Tubes, values: Option<&[f64]>, colors: Option<&[[f64; 4]]>) -> Shape {
        let Tubes { points, normals, triangles, origins, .. } = tubes;
        Shape {
            points,
            triangles,
            normals,
            values: values.map(|values| gathered(values, &origins)),
            colors: colors.map(|colors| gathered(colors, &origins)),
            bad: None,
        }
    }

    /// Both shapes in one.
    pub fn joined(self, other: Shape) -> Shape {
        if self.triangles.is_empty() {
            return other;
        }
        if other.triangles.is_empty() {
            return self;
        }
        let (mut all, other) = match (self.normals.is_empty(), other.normals.is_empty()) {
            (true, false) => (self.with_flat_normals(), other),
            (false, true) => (self, other.with_flat_normals()),
            _ => (self, other),
        };
        let before = all.points.len() as u32;
        all.points.extend(other.points);
        all.normals.extend(other.normals);
        all.triangles.extend(other.triangles.into_iter().map(|corners| corners.map(|p| before + p)));
        all.values = all.values.zip(other.values).map(|(own, more)| [own, more].concat());
        all.colors = all.colors.zip(other.colors).map(|(own, more)| [own, more].concat());
        all
    }

    /// The shape whose triangles have points of their own, with the triangle's normal.
    fn with_flat_normals(self) -> Shape {
        let corners = self.triangles.as_flattened();
        let normals = self.triangles.iter().flat_map(|corners| {
            let [a, b, c] = corners.map(|p| self.points[p as usize]);
            let normal = (b - a).cross(c - a);
            [if normal == DVec3::ZERO { DVec3::Z } else { normal }; 3]
        });
        Shape {
            points: gathered(&self.points, corners),
            normals: normals.collect(),
            triangles: (0..self.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
            values: self.values.as_deref().map(|values| gathered(values, corners)),
            colors: self.colors.as_deref().map(|colors| gathered(colors, corners)),
            bad: self.bad,
        }
    }
}
