//! What 32 bits on a device cannot hold, found before anything is drawn.

use crate::grid::Stored;
use std::sync::Arc;
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::{Profile, TransferFunction};
use voltet_core::{Error, Result};
use voltet_shaders::{Choices, Compositor, TileOrder};

/// Widths of a Gaussian that a cell may span: beyond, the twins' tests leave segments out.
const WIDTHS_MOST: f64 = 1e5;

/// Whether the device has shaders for the scene. What depends on the data is found when it is drawn.
pub fn can_serve(transfer_function: &TransferFunction, shading: &Shading) -> Result<()> {
    if shading.integrator == Integrator::Reference {
        return Err(Error::usage("the 64-bit reference does not run on a device")
            .accepted("another integrator, or engine = \"cpu\""));
    }
    Choices::new(transfer_function, shading, Compositor::Tiles(TileOrder::Exact)).map(drop)
}

/// `values`: s, g (that of s where g is not read), then the fields, as the transfer function numbers them.
pub(crate) fn check(transfer_function: &TransferFunction, values: &[Arc<Stored>], length: f64) -> Result<()> {
    let fields = transfer_function.fields();
    let normal = f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX) / 4.0;
    let scale = length / transfer_function.unit_distance;
    for (number, widget) in transfer_function.widgets.iter().enumerate() {
        let blame = |error: Error| error.at_item(format!("widgets[{number}]"));
        let rate = scale * widget.extinction.max(1.0);
        if !normal.contains(&rate) {
            return Err(blame(
                Error::run("lengths or extinctions leave the device's 32 bits")
                    .found(format!("{rate:e} over the grid's diagonal"))
                    .accepted("1e-38 to 8e37, or engine = \"cpu\""),
            ));
        }
        let span = |k: usize| values[k].span * values[k].cell_span;
        let norm = |rows: &mut dyn Iterator<Item = f64>| rows.map(|x| x * x).sum::<f64>().sqrt();
        let widths = match &widget.profile {
            Profile::Gaussian { matrix, .. } => {
                norm(&mut matrix.iter().map(|k| k[0].abs() * span(0) + k[1].abs() * span(1)))
            }
            Profile::GaussianNd { fields: names, matrix, .. } => {
                let place = |name: &String| 2 + fields.iter().position(|f| f == name).unwrap_or(0);
                let row = |row: &Vec<f64>| names.iter().zip(row).map(|(n, k)| k.abs() * span(place(n))).sum();
                norm(&mut matrix.iter().map(row))
            }
            _ => 0.0,
        };
        if widths > WIDTHS_MOST {
            return Err(blame(
                Error::run("a Gaussian is too narrow for the device's 32 bits")
                    .found(format!("a cell that spans {widths:.1e} of its widths"))
                    .accepted("at most 1e5, or engine = \"cpu\""),
            ));
        }
    }
    Ok(())
}
