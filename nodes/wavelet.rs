//! `wavelet`: a grid and a field by formula, as large as one likes: for tests, timings and first tries. The field is VTK's, or the
//! distance from the middle.

use std::sync::Arc;
use voltet_core::grid::generate::{box_of_tetrahedra, with_scalar};
use voltet_core::{Error, Result};
use voltet_graph::{
    DefaultValue, Node, Outputs, Parameter, ParameterType, Port, PortType, Range, RunContext, Value,
};

/// Hexahedra along an axis, at most: a hundred million tetrahedra in all.
const MAX_POINTS_PER_AXIS: f64 = 256.0;

pub const NODE: Node = Node {
    name: "wavelet",
    summary: "Computes a grid of tetrahedra and a field on it, of any size: VTK's analytic source \"Wavelet\".",
    outputs: &[Port {
        name: "grid",
        port_type: PortType::Grid,
        summary: "points, tetrahedra, the scalar 'wavelet' or 'distance'",
    }],
    parameters: &[
        Parameter {
            name: "resolution",
            parameter_type: ParameterType::Integers(3, Range::within(1.0, MAX_POINTS_PER_AXIS)),
            unit: "hexahedra",
            default: DefaultValue::Integers(&[20, 20, 20]),
            help: "hexahedra along x, y and z, each cut into tetrahedra",
        },
        Parameter {
            name: "field",
            parameter_type: ParameterType::Choice(&[
                ("wavelet", "VTK's analytic source, 60 to 277"),
                ("distance", "the distance from the middle, 0 to 17.3"),
            ]),
            unit: "",
            default: DefaultValue::Text("wavelet"),
            help: "the scalar; the box reaches from -10 to 10 along each axis",
        },
        Parameter {
            name: "jitter",
            parameter_type: ParameterType::Number(Range::within(0.0, 0.25)),
            unit: "spacings",
            default: DefaultValue::Number(0.2),
            help: "how far points inside are moved at random, always alike, so that no two cells are alike",
        },
    ],
    example: include_str!("examples/wavelet.toml"),
    // A source has no inputs to ask.
    demand: &|_| Ok(()),
    run: &run,
    ..Node::BLANK
};

/// Half a side of the box, world units.
const HALF: f64 = 10.0;

/// Formula of `vtkRTAnalyticSource` (VTK 9), with its default parameters and x in sides of the box:
/// 255 e^(−x²/2σ²) + 10 sin 60 x + 18 sin 30 y + 5 cos 40 z, σ = ½.
fn field(p: glam::DVec3) -> f64 {
    let x = -p / (2.0 * HALF);
    let bell = 255.0 * libm::exp(-2.0 * x.length_squared());
    bell + 10.0 * libm::sin(60.0 * x.x) + 18.0 * libm::sin(30.0 * x.y) + 5.0 * libm::cos(40.0 * x.z)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let name = call.parameters.text("field")?;
    for (arrays, own) in [(&call.demand.arrays, Some(name)), (&call.demand.cell_arrays, None)] {
        if let Some(other) = arrays.named.iter().find(|&other| Some(other.as_str()) != own) {
            let error = Error::run("a wavelet has no array of this name").got(other);
            let accepted = format!("its scalar '{name}' alone, at the points, or a reader");
            return Err(arrays.locate(other, error.expected(accepted)));
        }
    }
    let counts: [f64; 3] = call.parameters.vector("resolution")?;
    let jitter = call.parameters.number("jitter")?;
    let field = if name == "distance" { glam::DVec3::length } else { field };
    let half = glam::DVec3::splat(HALF);
    // Within the declared range, so nothing is lost.
    let grid = box_of_tetrahedra(counts.map(|n| n as usize), [-half, half], jitter);
    let mut grid = with_scalar(grid, name, field);
    if call.demand.arrays.named.contains(name) {
        let scalar = grid.scalar.clone().unwrap_or_default();
        grid.point_arrays.insert(name.into(), Arc::new(scalar.into()));
    }
    Ok(vec![Value::Grid(Arc::new(grid))])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that VTK gives for its own grid of 20³ (`vtkRTAnalyticSource`, ranges −10 to 10).
    #[test]
    fn the_formula_is_that_of_vtk() {
        for (at, value) in VTK {
            let error = field(glam::DVec3::from(at)) - value;
            // It computes in 64 bits and stores 32.
            assert!(error.abs() <= 2e-5, "{at:?}: {error:e}");
        }
    }

    const VTK: [([f64; 3], f64); 4] = [
        ([-10.0, -10.0, -10.0], 60.763465881347656),
        ([0.0, 0.0, 0.0], 260.0),
        ([3.0, -7.0, 5.0], 144.23570251464844),
        ([10.0, 2.0, -4.0], 146.5596160888672),
    ];
}
