//! A widget from the keys of a pipeline file (docs/src/explanation/optics.md, section 5).

use crate::parameters::Parameters;
use crate::transfer::convex::Convex;
use crate::transfer::kinds::{DECLARED, LoadImage, WIDGET_KINDS};
use crate::transfer::region::Region;
use crate::transfer::widget::Widget;
use crate::{Error, Result};

/// One widget of the given kind from its keys.
pub fn read(kind: &str, p: &Parameters, load_image: LoadImage) -> Result<Widget> {
    let Some(declared) = DECLARED.iter().find(|declared| declared.kind.name == kind) else {
        let names: Vec<&str> = WIDGET_KINDS.iter().map(|kind| kind.name).collect();
        return Err(Error::usage("unknown kind of widget").got(kind).expected(names.join(", ")));
    };
    let profile = (declared.read)(p, load_image)?;
    let extinction = match profile.properties().own_peak {
        Some(peak) => peak,
        None => p.number("extinction")?,
    };
    let color = if p.optional("color").is_some() { p.vector("color")? } else { [1.0; 3] };
    let region = p.table("region")?.map(|region| polygon(&region)).transpose()?;
    Ok(Widget { profile, color, extinction, region })
}

/// The region: a rectangle, whose missing limits are infinite, or a convex polygon.
fn polygon(p: &Parameters) -> Result<Region> {
    let limits = |name: &str| -> Result<[f64; 2]> {
        if p.optional(name).is_none() {
            return Ok([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let [low, high] = p.vector(name)?;
        if low > high {
            let error = p.error(name, format!("the range '{name}' of the region is empty"));
            return Err(error.got(format!("[{low}, {high}]")).expected("the smaller number first"));
        }
        Ok([low, high])
    };
    if p.optional("polygon").is_none() {
        if p.optional("s").is_none() && p.optional("g").is_none() {
            return Err(p
                .error("s", "the region has no limits")
                .expected("s = [low, high], g = [low, high] or polygon"));
        }
        return Ok(Region::rectangle(limits("s")?, limits("g")?));
    }
    if p.optional("s").is_some() || p.optional("g").is_some() {
        return Err(p.error("polygon", "'polygon' and the ranges 's' and 'g' exclude each other"));
    }
    let corners: Vec<[f64; 2]> = p.rows("polygon")?.iter().map(|row| [row[0], row[1]]).collect();
    let region = Region { corners };
    if Convex::new(&region).is_err() {
        let error = p.error("polygon", "the region is not a convex polygon with an area");
        return Err(error.expected("at least three corners in order around a convex polygon"));
    }
    Ok(region)
}
