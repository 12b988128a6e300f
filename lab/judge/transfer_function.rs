//! Reads the transfer function of a case.

use super::json::{array, fixed, member, number, numbers, text, wrong};
use serde_json::Value;
use std::sync::Arc;
use voltet_core::parameters::{Field, LocatedValue, ParameterValue, Parameters, SourceSpan};
use voltet_core::transfer::{
    self, ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, WIDGET_KINDS, Wave, Widget,
};
use voltet_core::{Error, Result};

/// The transfer function of a case.
pub(super) fn transfer_function(value: &Value) -> Result<TransferFunction> {
    let model = match text(value, "model")? {
        "density" => OpticalModel::DensityEmitter,
        "constant" => OpticalModel::ConstantEmitter {
            cutoff: value.get("cutoff").map_or(Ok(1.0 / 255.0), |_| number(value, "cutoff"))?,
        },
        other => {
            return Err(Error::usage("a case has an unknown model").got(other).expected("density, constant"));
        }
    };
    let widgets = array(value, "widgets")?.iter().map(widget).collect::<Result<_>>()?;
    Ok(TransferFunction { model, unit_distance: number(value, "unit_distance")?, widgets })
}

fn widget(value: &Value) -> Result<Widget> {
    let or = |key: &str, default: f64| value.get(key).map_or(Ok(default), |_| number(value, key));
    let wave = || -> Result<Wave> {
        Ok(Wave {
            origin: [or("s0", 0.0)?, or("g0", 0.0)?],
            angle: or("theta", 0.0)?,
            scale: [or("w_s", 1.0)?, or("w_g", 1.0)?],
            period: number(value, "period")?,
            band_width: or("band_width", 1.0)?,
        })
    };
    let profile = match text(value, "type")? {
        "uniform" => Profile::Uniform,
        "gaussian" => {
            let rows = array(value, "K")?;
            let [a, b]: [Value; 2] = rows.clone().try_into().map_err(|_| wrong("K"))?;
            Profile::Gaussian { centre: fixed(member(value, "center")?)?, matrix: [fixed(&a)?, fixed(&b)?] }
        }
        "gaussian-nd" => {
            let (fields, centre, matrix) = over_fields(value)?;
            Profile::GaussianNd { fields, centre, matrix }
        }
        "triangular-gaussian" => {
            Profile::TriangularGaussian { centre: number(value, "center")?, sigma: number(value, "sigma")? }
        }
        "triangular-gaussian-nd" => {
            let (fields, centre, matrix) = over_fields(value)?;
            // Behind the fields in the case's values, as in the order of names.
            Profile::TriangularGaussianNd { fields, magnitude: "magnitude".into(), centre, matrix }
        }
        "triangle-wave" => Profile::TriangleWave(wave()?),
        "sine-wave" => Profile::SineWave(wave()?),
        "piecewise-linear" => {
            let points = array(value, "points")?
                .iter()
                .map(|row| {
                    let [s, extinction, r, g, b] = fixed(row)?;
                    Ok(ControlPoint { s, color: [r, g, b], extinction })
                })
                .collect::<Result<_>>()?;
            Profile::PiecewiseLinear { points }
        }
        "table" => {
            let texels = array(value, "texels")?.iter().map(fixed::<4>).collect::<Result<Vec<_>>>()?;
            // Texels are stated in 32 bits.
            let texels = texels.into_iter().map(|texel| texel.map(|x| x as f32)).collect();
            let size = |key: &str| Ok(number(value, key)? as usize);
            let range = |key: &str| fixed(member(value, key)?);
            Profile::Table(Arc::new(Table {
                width: size("width")?,
                height: size("height")?,
                texels,
                s: range("s")?,
                g: range("g")?,
            }))
        }
        // Kinds without keys of their own here have those of a pipeline file.
        kind => return with_pipeline_keys(kind, value),
    };
    // Control points hold extinctions and colours of their own.
    let own = profile.properties().own_peak.is_some();
    let region = match value.get("region") {
        None | Some(Value::Null) => None,
        Some(_) => {
            let corners = array(value, "region")?.iter().map(fixed).collect::<Result<_>>()?;
            Some(Region { corners })
        }
    };
    Ok(Widget {
        profile,
        color: if own { [0.0; 3] } else { fixed(member(value, "color")?)? },
        extinction: if own { 0.0 } else { number(value, "extinction")? },
        region,
    })
}

/// A widget that is stated with the keys of a pipeline file.
fn with_pipeline_keys(kind: &str, value: &Value) -> Result<Widget> {
    let Some(known) = WIDGET_KINDS.iter().find(|known| known.name == kind) else {
        return Err(Error::usage("a case has an unknown widget").got(kind));
    };
    let parameters = Parameters::check(known.parameters, &fields(value), &SourceSpan::Nowhere, &["type"])?;
    let refused = |_: &str| Err(Error::usage("a case names an image"));
    transfer::read(kind, &parameters, &refused)
}

/// The keys of an object.
fn fields(value: &Value) -> Vec<Field> {
    let field = |(name, value): (&String, &Value)| Field {
        name: name.clone(),
        origin: SourceSpan::Nowhere,
        setting: setting(value),
    };
    value.as_object().into_iter().flatten().map(field).collect()
}

fn setting(value: &Value) -> LocatedValue {
    LocatedValue::from(match value {
        Value::Null => ParameterValue::Text(String::new()),
        Value::Bool(flag) => ParameterValue::Boolean(*flag),
        Value::Number(number) => ParameterValue::Number(number.as_f64().unwrap_or(f64::NAN)),
        Value::String(text) => ParameterValue::Text(text.clone()),
        Value::Array(list) => ParameterValue::List(list.iter().map(setting).collect()),
        Value::Object(_) => ParameterValue::Table(fields(value)),
    })
}

/// Fields, centre and K.
type OverFields = (Vec<String>, Vec<f64>, Vec<Vec<f64>>);

/// Fields, centre and matrix of a widget over fields, whose order is that of the case's values.
fn over_fields(value: &Value) -> Result<OverFields> {
    let centre = numbers(member(value, "center")?)?;
    let rows = array(value, "K")?;
    let matrix = if rows.iter().all(Value::is_number) {
        let diagonal = numbers(member(value, "K")?)?;
        let row = |i: usize| (0..diagonal.len()).map(|j| if i == j { diagonal[i] } else { 0.0 }).collect();
        (0..diagonal.len()).map(row).collect()
    } else {
        rows.iter().map(numbers).collect::<Result<Vec<_>>>()?
    };
    Ok(((0..centre.len()).map(|i| format!("field{i}")).collect(), centre, matrix))
}
