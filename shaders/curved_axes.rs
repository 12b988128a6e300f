//! Logarithmic axes as shaders read them: the numbers behind those of the widgets (`wgsl/axes/curved.wgsl`), and what 32 bits hold.

use crate::parameters::Parameters;
use crate::writer::{Axis, all_finite, finite};
use voltet_core::transfer::AxisScale;
use voltet_core::{Error, Result};
use voltet_optics::curved_axes::CurvedAxes;
use voltet_simd::limits::MIN_DECADES;

/// Numbers of an axis: `AXIS_NUMBERS` of the shader.
const AXIS_NUMBERS: usize = 11;

/// In place of infinity: the step of an axis without cuts, values without a bound.
const ENDLESS: f32 = 3e38;

impl Parameters {
    /// Adds the numbers of curved axes behind those of the widgets. `values`, `positions`: storage of s and g; on a curved axis values are
    /// counted from 0.
    ///
    /// Errors: profiles too narrow for positions in 32 bits, a linear part too short for values there.
    pub fn add_curved_axes(
        &mut self,
        axes: &CurvedAxes,
        values: [Axis; 2],
        positions: [Axis; 2],
    ) -> Result<()> {
        let (mut heads, mut jumps) = (Vec::new(), Vec::new());
        for number in 0..2 {
            let first_jump = (2 * AXIS_NUMBERS + jumps.len()) as f32;
            let of_axis = axis(axes, number, values[number], positions[number]);
            let Head { numbers, step } = of_axis.map_err(|error| error.at_item(["s", "g"][number]))?;
            let [by_logarithm, whole, rest, per_linear] = numbers;
            let own: &[[f64; 2]] = if axes.scale(number).is_curved() { axes.jumps(number) } else { &[] };
            heads.extend([by_logarithm, whole, rest, step, first_jump, own.len() as f32, per_linear]);
            let endless = f64::from(ENDLESS);
            let bounds =
                |ends: [f64; 2], axis: Axis| ends.map(|x| axis.stored(x).clamp(-endless, endless) as f32);
            heads.extend(bounds(axes.drawn(number), values[number]));
            heads.extend(bounds(axes.changing(number), positions[number]));
            for [value, position] in own {
                let stored = [values[number].stored(*value), positions[number].stored(*position)];
                jumps.extend(all_finite("the position of an edge", stored)?);
            }
        }
        // No integrator that cuts along curved axes has entries of its own.
        self.head.first_entry += self.numbers.len() as u32;
        self.numbers.extend(heads);
        self.numbers.extend(jumps);
        Ok(())
    }
}

/// Numbers of an axis without its jumps.
struct Head {
    numbers: [f32; 4],
    step: f32,
}

fn axis(axes: &CurvedAxes, number: usize, values: Axis, positions: Axis) -> Result<Head> {
    let scale = axes.scale(number);
    if !scale.is_curved() {
        return Ok(Head { numbers: [0.0; 4], step: ENDLESS });
    }
    if axes.width(number) < MIN_DECADES {
        return Err(Error::run("a widget is too narrow on a logarithmic axis for the device's 32 bits")
            .got(format!("{:.1e} decades", axes.width(number)))
            .expected(format!("at least {MIN_DECADES:e}; engine = \"cpu\" holds it")));
    }
    // Positions are decades; log₁₀ of a value is log₁₀ 2 times log₂ of what is stored, and of the scale.
    let decades = std::f64::consts::LOG10_2;
    let (moved, per_linear) = match scale {
        AxisScale::SymLog { linear_below } => (0.0, values.scale / linear_below),
        _ => (values.scale.log2(), 0.0),
    };
    let origin = positions.offset / decades - moved;
    let whole = origin.round();
    let numbers = [decades / positions.scale, whole, origin - whole, per_linear];
    let step = finite("the step along a logarithmic axis", axes.step(number) / positions.scale)?;
    Ok(Head { numbers: all_finite("a logarithmic axis", numbers)?, step })
}
