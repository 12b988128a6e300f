//! `table`: a picture over the (s, g) plane (Song et al. 2009, section 3.3.2).

use super::keys::{COLOR, EXTINCTION, LoadImage, REGION};
use super::properties::{AxisOrigin, ColorSource, Properties, Table};
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Parameters, Range, RelativeNumberType, StatisticKind,
    VariantSchema,
};
use crate::transfer::region::Region;
use crate::{Error, Result};

/// The declaration.
pub(super) const KIND: VariantSchema = VariantSchema {
    name: "table",
    summary: "A picture over the (s, g) plane: its colour, and its alpha times the extinction.",
    parameters: &[
        Parameter {
            default: DefaultValue::Unset("the picture's own"),
            help: "not used: the picture has its own",
            ..COLOR
        },
        EXTINCTION,
        Parameter {
            name: "image",
            parameter_type: ParameterType::InputPath,
            unit: "",
            default: DefaultValue::Required,
            help: "PNG file, sRGB with alpha; its lowest row is the smallest g",
        },
        Parameter {
            name: "s",
            parameter_type: ParameterType::Measured(VALUES_OF_S),
            unit: "units of s",
            default: DefaultValue::Required,
            help: "range of the scalar across the picture, [left, right]",
        },
        Parameter {
            name: "g",
            parameter_type: ParameterType::Measured(VALUES_OF_G),
            unit: "units of g",
            default: DefaultValue::Required,
            help: "range of the gradient magnitude up the picture, [bottom, top]",
        },
        REGION,
    ],
};

const VALUES_OF_S: &RelativeNumberType = &RelativeNumberType {
    plain: ParameterType::Numbers(Some(2), Range::ANY),
    statistic: StatisticKind::Value,
    axis: AxisRef::Every("s"),
};
const VALUES_OF_G: &RelativeNumberType = &RelativeNumberType { axis: AxisRef::Every("g"), ..*VALUES_OF_S };

pub(super) fn read(p: &Parameters, load_image: LoadImage) -> Result<Table> {
    let (s, g): ([f64; 2], [f64; 2]) = (p.vector("s")?, p.vector("g")?);
    for (name, [low, high]) in [("s", s), ("g", g)] {
        if low >= high {
            let error = p.error(name, format!("the range '{name}' is empty")).got(format!("[{low}, {high}]"));
            return Err(error.expected("the smaller number first"));
        }
    }
    let (width, height, texels) = load_image(p.text("image")?)?;
    Ok(Table { width, height, texels, s, g })
}

pub(super) fn properties(table: &Table) -> Properties<'_> {
    Properties {
        name: KIND.name,
        color: ColorSource::Texels(&table.texels),
        own_peak: None,
        fields: Vec::new(),
        depends_on_g: true,
        axes: vec![AxisOrigin::Any; 2],
        bands: None,
        jumps: true,
        range: Some(Region::rectangle(table.s, table.g)),
        needs_region: false,
        has_elementary_mean: false,
    }
}

impl Table {
    /// Straight colour and alpha at a place, bilinear between the texels' centres; 0 outside of the ranges.
    pub fn at(&self, v: [f64; 2]) -> [f32; 4] {
        let ranges = [self.s, self.g];
        if (0..2).any(|k| !(ranges[k][0]..=ranges[k][1]).contains(&v[k])) {
            return [0.0; 4];
        }
        // The two texels around, and the share of the second.
        let around = |place: f64, count: usize| {
            let place = (place * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
            let first = place.floor() as usize;
            (first, (first + 1).min(count - 1), (place - first as f64) as f32)
        };
        let share = |k: usize| (v[k] - ranges[k][0]) / (ranges[k][1] - ranges[k][0]);
        let (i, next_i, x) = around(share(0), self.width);
        let (j, next_j, y) = around(1.0 - share(1), self.height);
        let texel = |i: usize, j: usize, k: usize| self.texels[j * self.width + i][k];
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        std::array::from_fn(|k| {
            let row = |j: usize| mix(texel(i, j, k), texel(next_i, j, k), x);
            mix(row(j), row(next_j), y)
        })
    }
}

pub(super) fn check(table: &Table) -> Result<()> {
    if table.width == 0 || table.height == 0 || table.texels.len() != table.width * table.height {
        return Err(Error::usage("a table's texels do not fit its size")
            .got(table.texels.len())
            .expected(format!("{} × {}", table.width, table.height)));
    }
    for (name, range) in [("s", table.s), ("g", table.g)] {
        if !(range[0] < range[1] && (range[1] - range[0]).is_finite()) {
            return Err(Error::usage(format!("a table's range of {name} is empty"))
                .got(format!("{range:?}"))
                .expected("[a, b] with a < b"));
        }
    }
    if table.texels.iter().flatten().any(|c| !(*c >= 0.0 && c.is_finite())) {
        return Err(Error::usage("a table holds a texel that is negative or not a number"));
    }
    Ok(())
}
