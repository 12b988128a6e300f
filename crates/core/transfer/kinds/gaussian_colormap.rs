//! `gaussian-colormap`: a Gaussian over the (s, g) plane in the colours of a map along s, as a table fine enough for 32 bits.

use super::colormap::{CURVE_PARAMETERS, RANGE, color_curve, range};
use super::properties::{CENTRE, EXTINCTION, LoadFiles, NAME, REGION, SIGMA, Table};
use crate::Result;
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Parameters, Range, RelativeNumberType, StatisticKind,
    VariantSchema,
};

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "gaussian-colormap",
    summary: "A Gaussian over the scalar and its gradient magnitude, in the colours of a map along s.",
    parameters: &[
        EXTINCTION,
        CENTRE,
        Parameter {
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Numbers(Some(2), Range::above(0.0)),
                statistic: StatisticKind::Width,
                axis: AxisRef::Places(&["s", "g"]),
            }),
            unit: "(s, g)",
            default: DefaultValue::Required,
            help: "standard deviations along s and g",
            ..SIGMA
        },
        CURVE_PARAMETERS[0],
        RANGE,
        CURVE_PARAMETERS[1],
        CURVE_PARAMETERS[2],
        REGION,
        NAME,
    ],
};

/// Deviations from the centre to the table's rims, where the Gaussian is 4e-6.
const REACH: f64 = 5.0;

/// Texels along s and along g: straight between two, a Gaussian is met within 1e-4 of its peak.
const TEXELS: usize = 512;

pub(super) fn read(p: &Parameters, files: &dyn LoadFiles) -> Result<Table> {
    let curve = color_curve(p, files)?;
    let [low, high] = range(p)?;
    let (centre, sigma): ([f64; 2], [f64; 2]) = (p.vector("centre")?, p.vector("sigma")?);
    let around = |axis: usize| [-REACH, REACH].map(|reach| centre[axis] + reach * sigma[axis]);
    // A texel's distance from the centre, in deviations.
    let offset = |number: usize| REACH * ((2 * number + 1) as f64 / TEXELS as f64 - 1.0);
    let column = |i: usize| {
        let s = centre[0] + sigma[0] * offset(i);
        let level = if high > low { ((s - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        curve.at(level).map(|channel| channel as f32)
    };
    let colors: Vec<[f32; 3]> = (0..TEXELS).map(column).collect();
    let texel = |j: usize, i: usize| {
        // Row 0 is at the largest g.
        let square = offset(i).powi(2) + offset(TEXELS - 1 - j).powi(2);
        let [r, g, b] = colors[i];
        [r, g, b, (-0.5 * square).exp() as f32]
    };
    let texels =
        (0..TEXELS).flat_map(|j| (0..TEXELS).map(move |i| (j, i))).map(|(j, i)| texel(j, i)).collect();
    Ok(Table { width: TEXELS, height: TEXELS, texels, s: around(0), g: around(1) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Field, LocatedValue, ParameterValue, SourceSpan};
    use crate::transfer::kinds::UnreadFiles;

    #[test]
    fn texels_are_a_gaussian_in_the_colours_of_the_map() {
        let list = |numbers: &[f64]| {
            numbers.iter().map(|&x| LocatedValue::from(ParameterValue::Number(x))).collect()
        };
        let fields = [
            Field::new("extinction", 2.0),
            Field::new("centre", ParameterValue::List(list(&[3.0, 40.0]))),
            Field::new("sigma", ParameterValue::List(list(&[0.5, 8.0]))),
            Field::new("range", ParameterValue::List(list(&[2.0, 4.0]))),
        ];
        let p = Parameters::check(KIND.parameters, &fields, &SourceSpan::Nowhere, &["kind"]).unwrap();
        let table = read(&p, &UnreadFiles).unwrap();
        let curve = crate::colormap::Colormap::Viridis.curve();
        for place in [[3.0, 40.0], [3.31, 45.0], [2.2, 33.3], [4.9, 60.0], [0.6, 2.0]] {
            let [r, g, b, alpha] = table.at(place).map(f64::from);
            let exact = (-0.5 * (((place[0] - 3.0) / 0.5).powi(2) + ((place[1] - 40.0) / 8.0).powi(2))).exp();
            assert!((alpha - exact).abs() < 1e-4, "{place:?}: {alpha} {exact}");
            let color = curve.at(((place[0] - 2.0) / 2.0).clamp(0.0, 1.0));
            for (found, wanted) in [r, g, b].into_iter().zip(color) {
                // The map is straight between its knots, which lie between texels.
                assert!((found - wanted).abs() < 2e-3, "{place:?}: {found} {wanted}");
            }
        }
        assert_eq!(table.at([6.0, 40.0]), [0.0; 4]);
    }
}
