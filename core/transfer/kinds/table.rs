//! `table`: a picture over the (s, g) plane (Song et al. 2009, section 3.3.2).

use super::keys::{COLOR, Declared, EXTINCTION, LoadImage, REGION};
use super::profile::{AxisOrigin, ColorSource, Profile, Properties, Table};
use crate::parameters::{
    Along, Kind, Measure, Measured, Parameter, ParameterType, Parameters, Range, Standard,
};
use crate::transfer::region::Region;
use crate::{Error, Result};
use std::sync::Arc;

/// The declaration.
pub(super) const KIND: Declared = Declared {
    kind: Kind {
        name: "table",
        summary: "A picture over the (s, g) plane: its colour, and its alpha times the extinction.",
        parameters: &[
            Parameter {
                standard: Standard::Unset("the picture's own"),
                help: "not used: the picture has its own",
                ..COLOR
            },
            EXTINCTION,
            Parameter {
                name: "image",
                parameter_type: ParameterType::InputPath,
                unit: "",
                standard: Standard::Required,
                help: "PNG file, sRGB with alpha; its lowest row is the smallest g",
            },
            Parameter {
                name: "s",
                parameter_type: ParameterType::Measured(VALUES_OF_S),
                unit: "units of s",
                standard: Standard::Required,
                help: "range of the scalar across the picture, [left, right]",
            },
            Parameter {
                name: "g",
                parameter_type: ParameterType::Measured(VALUES_OF_G),
                unit: "units of g",
                standard: Standard::Required,
                help: "range of the gradient magnitude up the picture, [bottom, top]",
            },
            REGION,
        ],
    },
    read,
};

const VALUES_OF_S: &Measured = &Measured {
    plain: ParameterType::Numbers(Some(2), Range::ANY),
    is: Measure::Value,
    along: Along::Every("s"),
};
const VALUES_OF_G: &Measured = &Measured { along: Along::Every("g"), ..*VALUES_OF_S };

fn read(p: &Parameters, load_image: LoadImage) -> Result<Profile> {
    let (s, g): ([f64; 2], [f64; 2]) = (p.vector("s")?, p.vector("g")?);
    for (name, [low, high]) in [("s", s), ("g", g)] {
        if low >= high {
            let error =
                p.error(name, format!("the range '{name}' is empty")).found(format!("[{low}, {high}]"));
            return Err(error.accepted("the smaller number first"));
        }
    }
    let (width, height, texels) = load_image(p.text("image")?)?;
    Ok(Profile::Table(Arc::new(Table { width, height, texels, s, g })))
}

pub(super) fn properties(table: &Table) -> Properties<'_> {
    Properties {
        name: KIND.kind.name,
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

pub(super) fn check(table: &Table) -> Result<()> {
    if table.width == 0 || table.height == 0 || table.texels.len() != table.width * table.height {
        return Err(Error::usage("a table's texels do not fit its size")
            .found(table.texels.len())
            .accepted(format!("{} × {}", table.width, table.height)));
    }
    for (name, range) in [("s", table.s), ("g", table.g)] {
        if !(range[0] < range[1] && (range[1] - range[0]).is_finite()) {
            return Err(Error::usage(format!("a table's range of {name} is empty"))
                .found(format!("{range:?}"))
                .accepted("[a, b] with a < b"));
        }
    }
    if table.texels.iter().flatten().any(|c| !(*c >= 0.0 && c.is_finite())) {
        return Err(Error::usage("a table holds a texel that is negative or not a number"));
    }
    Ok(())
}
