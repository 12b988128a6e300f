//! The parameters of `probe`: the region, the fields, and how the widget is made.

use glam::DVec3;
use voltet_core::grid::{Grid, extent};
use voltet_core::probing::ProbeRegion;
use voltet_core::transfer::{DataStatistics, resolved, with_placeholders};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, AxisRef, DefaultValue, Field, LocatedValue, Parameter, ParameterType, ParameterValue,
    Parameters, Range, RelativeNumberType, SourceSpan, StatisticKind,
};

/// The parameters, for the declaration.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "box",
        parameter_type: ParameterType::Table(&[
            Parameter { name: "low", help: "lowest x, y, z", ..POSITION },
            Parameter { name: "high", help: "highest x, y, z", ..POSITION },
        ]),
        unit: "world units",
        default: DefaultValue::Unset("another region"),
        help: "the region: the parts of cells in a box, cut exactly",
    },
    Parameter {
        name: "sphere",
        parameter_type: ParameterType::Table(&[
            Parameter { name: "centre", help: "its centre", ..POSITION },
            Parameter {
                name: "radius",
                parameter_type: ParameterType::Measured(&RelativeNumberType {
                    plain: ParameterType::Number(Range::above(0.0)),
                    statistic: StatisticKind::Width,
                    axis: AxisRef::Every("diagonal"),
                }),
                help: "its radius; a percentage: of the diagonal of the bounds",
                ..POSITION
            },
        ]),
        unit: "world units",
        default: DefaultValue::Unset("another region"),
        help: "the region: the parts of cells in a ball, whose volume is met to 1e-6",
    },
    Parameter {
        name: "points",
        parameter_type: ParameterType::Measured(&RelativeNumberType {
            plain: ParameterType::Rows(Some(3)),
            statistic: StatisticKind::Place,
            axis: AxisRef::Places(&["x", "y", "z"]),
        }),
        unit: "world units",
        default: DefaultValue::Unset("another region"),
        help: "the region: the values at points [x, y, z], each counting the same",
    },
    Parameter {
        name: "mask",
        parameter_type: ParameterType::Table(&[
            Parameter {
                name: "array",
                parameter_type: ParameterType::Text,
                unit: "",
                help: "a cell array of one component; \"NAME:0\" and \"NAME:magnitude\" for vectors",
                ..POSITION
            },
            Parameter {
                name: "equals",
                parameter_type: ParameterType::Number(Range::ANY),
                unit: "as in the array",
                default: DefaultValue::Unset("any but 0"),
                help: "the value of the cells that count",
            },
        ]),
        unit: "",
        default: DefaultValue::Unset("all cells"),
        help: "the region, or what counts in it: cells by the value of a cell array",
    },
    Parameter {
        name: "fields",
        parameter_type: ParameterType::Texts,
        unit: "",
        default: DefaultValue::Unset("s and g, as a gaussian"),
        help: "one to eight point arrays to look at instead, as a gaussian-nd",
    },
    Parameter {
        name: "color",
        parameter_type: ParameterType::Numbers(Some(3), Range::at_least(0.0)),
        unit: "linear RGB",
        default: DefaultValue::Numbers(&[1.0, 1.0, 1.0]),
        help: "colour of the widget; components may exceed 1",
    },
    Parameter {
        name: "extinction",
        parameter_type: ParameterType::Number(Range::at_least(0.0)),
        unit: "per unit_distance",
        default: DefaultValue::Number(1.0),
        help: "peak of the extinction, per unit_distance of the transfer-function that it is wired into",
    },
    Parameter {
        name: "sigma_scale",
        parameter_type: ParameterType::Number(Range::above(0.0)),
        unit: "",
        default: DefaultValue::Number(1.0),
        help: "factor on the standard deviations: above 1 the widget reaches beyond what was probed",
    },
    Parameter {
        name: "least_sigma",
        parameter_type: ParameterType::Number(Range::within(1e-6, 1.0)),
        unit: "share of a field's range in the data",
        default: DefaultValue::Number(1e-3),
        help: "smallest deviation in any direction, before sigma_scale: where the data do not vary, or exactly together",
    },
    Parameter {
        name: "correlated",
        parameter_type: ParameterType::Boolean,
        unit: "",
        default: DefaultValue::Boolean(true),
        help: "true: a full matrix, tilted as the fields vary together; false: along the axes",
    },
];

const POSITION: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Measured(&RelativeNumberType {
        plain: ParameterType::Numbers(Some(3), Range::ANY),
        statistic: StatisticKind::Place,
        axis: AxisRef::Places(&["x", "y", "z"]),
    }),
    unit: "world units",
    default: DefaultValue::Required,
    help: "",
};

/// The point arrays that the parameters name; `None`: s and g.
pub fn fields(p: &Parameters) -> Result<Option<Vec<String>>> {
    let Some(_) = p.optional("fields") else { return Ok(None) };
    let names = p.texts("fields")?;
    let distinct = (1..names.len()).all(|i| !names[..i].contains(&names[i]));
    match (1..=8).contains(&names.len()) && distinct && !names.iter().any(String::is_empty) {
        true => Ok(Some(names)),
        false => {
            let error = p.error("fields", "'fields' cannot be probed").got(format!("{names:?}"));
            Err(error.expected("1 to 8 different names of point arrays"))
        }
    }
}

/// The parameters with places for percentages of the grid's bounds, and a radius for one of their diagonal.
pub fn placed(p: &Parameters, grid: &Grid) -> Result<Parameters> {
    let none = || Error::run("the grid has no points, so nothing can be relative to its bounds");
    resolved(p, &SpatialRegion(grid.bounds().ok_or_else(none)?))
}

/// Checks the region as far as it can be before the grid is known: whether a box that mixes percentages and numbers is empty
/// is not.
pub fn check_region(p: &Parameters) -> Result<()> {
    let of_box = p.table("box")?.map_or(0, |table| table.relative_numbers().len());
    let corner = |name: &str, at: f64| {
        let numbers = vec![LocatedValue::from(ParameterValue::Number(at)); 3];
        Field {
            name: name.into(),
            origin: SourceSpan::Nowhere,
            setting: ParameterValue::List(numbers).into(),
        }
    };
    let any_box = || ParameterValue::Table(vec![corner("low", 0.0), corner("high", 1.0)]);
    let p = if matches!(of_box, 1..=5) { p.with("box", Some(any_box())) } else { p.clone() };
    region(&with_placeholders(&p)?).map(drop)
}

/// The bounds of a grid.
struct SpatialRegion([DVec3; 2]);

impl DataStatistics for SpatialRegion {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        let [low, high] = self.0;
        match quantity {
            ArrayRef::Named("x") => Ok([low.x, high.x]),
            ArrayRef::Named("y") => Ok([low.y, high.y]),
            ArrayRef::Named("z") => Ok([low.z, high.z]),
            _ => Ok([0.0, extent::diagonal(self.0)]),
        }
    }

    fn percentile(&self, quantity: &ArrayRef, _: f64) -> Result<f64> {
        Err(Error::usage(format!("{quantity} is a place, and a percentile is a value of a field")))
    }
}

/// The region that the parameters name.
pub fn region(p: &Parameters) -> Result<ProbeRegion> {
    let mut regions = Vec::new();
    if let Some(table) = p.table("box")? {
        let (low, high): (DVec3, DVec3) = (table.vector("low")?.into(), table.vector("high")?.into());
        if low.cmpge(high).any() {
            let error = table.error("high", "the box is empty").got(format!("from {low} to {high}"));
            return Err(error.expected("'low' below 'high' along every axis"));
        }
        regions.push(ProbeRegion::Box { low, high });
    }
    if let Some(table) = p.table("sphere")? {
        let (centre, radius) = (table.vector("centre")?.into(), table.number("radius")?);
        regions.push(ProbeRegion::Sphere { centre, radius });
    }
    if p.optional("points").is_some() {
        let points = p.rows("points")?;
        regions.push(ProbeRegion::Points(points.iter().map(|row| DVec3::from_slice(row)).collect()));
    }
    let accepted = "one of box, sphere and points, or a mask, which may also go with one of them";
    match (regions.pop(), regions.is_empty(), p.optional("mask").is_some()) {
        (Some(region), true, _) => Ok(region),
        (None, _, true) => Ok(ProbeRegion::Everywhere),
        (None, _, false) => Err(Error::usage("the probe has no region").expected(accepted)),
        (Some(_), false, _) => Err(Error::usage("the probe has several regions").expected(accepted)),
    }
}

/// True if a tetrahedron counts.
pub type Holds<'a> = Box<dyn Fn(usize) -> bool + Sync + 'a>;

/// Selection of tetrahedra by the parameters.
pub fn mask<'a>(p: &Parameters, volume: &'a Volume) -> Result<Option<Holds<'a>>> {
    let Some(table) = p.table("mask")? else { return Ok(None) };
    let name = table.text("array")?;
    let grid = &volume.grid;
    let Some(array) = grid.cell_arrays.get(name).filter(|array| array.component_count == 1) else {
        let error = table.error("array", format!("the mask '{name}' is not an array with one number a cell"));
        return Err(error.expected("a cell array of one component, or \"NAME:0\" for a component"));
    };
    let equals = table.optional_number("equals");
    let counts = move |value: f64| equals.map_or(value != 0.0 && !value.is_nan(), |wanted| value == wanted);
    Ok(Some(Box::new(move |i| counts(array.values[grid.source_cell(i)]))))
}
