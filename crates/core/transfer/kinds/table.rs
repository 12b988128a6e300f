//! `table`: a picture over the (s, g) plane (Song et al. 2009, section 3.3.2).

use super::properties::{COLOR, ColorSource, EXTINCTION, LoadFiles, NAME, Properties, REGION, Table};
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Parameters, Range, RelativeNumberType, StatisticKind,
    VariantSchema,
};
use crate::transfer::region::Region;
use crate::{Error, Result};

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
        NAME,
    ],
};

const VALUES_OF_S: &RelativeNumberType = &RelativeNumberType {
    plain: ParameterType::Numbers(Some(2), Range::ANY),
    statistic: StatisticKind::Value,
    axis: AxisRef::Every("s"),
};
const VALUES_OF_G: &RelativeNumberType = &RelativeNumberType { axis: AxisRef::Every("g"), ..*VALUES_OF_S };

pub(super) fn read(p: &Parameters, files: &dyn LoadFiles) -> Result<Table> {
    let (s, g): ([f64; 2], [f64; 2]) = (p.vector("s")?, p.vector("g")?);
    for (name, [low, high]) in [("s", s), ("g", g)] {
        if low >= high {
            let error = p.error(name, format!("the range '{name}' is empty")).got(format!("[{low}, {high}]"));
            return Err(error.expected("the smaller number first"));
        }
    }
    let (width, height, texels) = files.image(p.text("image")?)?;
    Ok(Table { width, height, texels, s, g })
}

pub(super) fn properties(table: &Table) -> Properties<'_> {
    Properties {
        name: KIND.name,
        color: ColorSource::Texels(&table.texels),
        depends_on_g: true,
        jumps: true,
        range: Some(Region::rectangle(table.s, table.g)),
        has_elementary_mean: false,
        ..Properties::PLAIN
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

/// Largest alpha over blocks of texels, halved in size from level to level, so that any box of the plane is
/// covered by at most nine blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct MaximumTable {
    s: [f64; 2],
    g: [f64; 2],
    levels: Vec<(usize, usize, Vec<f32>)>,
}

impl MaximumTable {
    /// Builds all levels.
    pub fn new(table: &Table) -> Self {
        let mut level = (table.width, table.height, table.texels.iter().map(|t| t[3]).collect::<Vec<_>>());
        let mut levels = vec![level.clone()];
        while level.0 > 1 || level.1 > 1 {
            let (width, height) = (level.0.div_ceil(2), level.1.div_ceil(2));
            let mut half = vec![0.0_f32; width * height];
            for j in 0..level.1 {
                for i in 0..level.0 {
                    let block = &mut half[j / 2 * width + i / 2];
                    *block = block.max(level.2[j * level.0 + i]);
                }
            }
            level = (width, height, half);
            levels.push(level.clone());
        }
        MaximumTable { s: table.s, g: table.g, levels }
    }

    /// The largest alpha that can occur for s and g in these ranges.
    pub fn bound(&self, s: (f64, f64), g: (f64, f64)) -> f64 {
        if s.1 < self.s[0] || s.0 > self.s[1] || g.1 < self.g[0] || g.0 > self.g[1] {
            return 0.0;
        }
        let (width, height, _) = self.levels[0];
        // Texels whose bilinear reach meets the box; the cast saturates.
        let span = |low: f64, high: f64, from: f64, to: f64, count: usize| {
            let texel = |x: f64| (x - from) / (to - from) * count as f64 - 0.5;
            let first = (texel(low) - 1e-9).floor().max(0.0) as usize;
            let last = (texel(high) + 1e-9).ceil().max(0.0) as usize;
            (first.min(count - 1), last.min(count - 1))
        };
        let (i0, i1) = span(s.0, s.1, self.s[0], self.s[1], width);
        // Row 0 is at the largest g.
        let (j0, j1) = span(g.1, g.0, self.g[1], self.g[0], height);
        let shift = (i1 - i0).max(j1 - j0).checked_ilog2().unwrap_or(0) as usize;
        let shift = shift.min(self.levels.len() - 1);
        let (width, _, blocks) = &self.levels[shift];
        let mut most = 0.0_f32;
        for j in j0 >> shift..=j1 >> shift {
            for i in i0 >> shift..=i1 >> shift {
                most = most.max(blocks[j * width + i]);
            }
        }
        f64::from(most)
    }
}
