//! Every WGSL formula against its 64-bit truth, on whatever adapter there is.

mod adaptive;
mod device;
mod formulas;
mod integrators;
mod pre_integrated;
mod scene;
mod tables;

use device::{Bound, Device};
use formulas::{Twin, twins};
use voltet_shaders::compose_pieces;
use voltet_testing::twin::{self, INPUTS};

/// Inputs of a twin.
const COUNT: usize = 4000;

/// A sequence of low discrepancy (Roberts 2018), rounded to what 32 bits hold; some segments are flat.
fn inputs(tried: &Twin) -> Vec<[f32; INPUTS]> {
    let row = |i: usize| {
        let mut row = twin::inputs(tried.inputs, i).map(|x| x as f32);
        if i.is_multiple_of(16) && tried.expression.contains("phase(") {
            row[1] = row[0];
        }
        row
    };
    (0..COUNT).map(row).collect()
}

#[test]
fn every_twin_keeps_its_tolerance() {
    let Some(device) = Device::open() else { return };
    let mut broken = Vec::new();
    for twin in twins() {
        let main = format!(
            "@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
             @group(0) @binding(1) var<storage, read_write> values: array<f32>;
             @compute @workgroup_size(64)
             fn evaluate(@builtin(global_invocation_id) id: vec3u) {{
                 if id.x < arrayLength(&values) {{
                     let x = rows[id.x];
                     values[id.x] = {};
                 }}
             }}
             {}",
            twin.expression, twin.generated
        );
        let mut pieces = vec![twin.piece];
        if twin.expression.contains("line_path") {
            pieces.push("gaussian/line");
        }
        if twin.expression.contains("plane_path") {
            pieces.push("gaussian/plane");
        }
        if twin.expression.contains("gaussian_fields_path") {
            pieces.push("gaussian_nd/path");
        }
        if twin.expression.contains("triangular_of_fields") {
            pieces.push("triangular_gaussian_nd/path");
        }
        if twin.expression.contains("wave_glow") {
            pieces.push("wave/glow");
        }
        let pass = device.compile(&compose_pieces(&main, &pieces), "evaluate", &[]);
        let rows = inputs(&twin);
        let bytes = bytemuck::cast_slice(&rows);
        let input = Bound { group: 0, binding: 0, buffer: device.storage(bytes) };
        let values = device.run(&pass, vec![input], (0, 1), COUNT, COUNT);
        let mut worst = (0.0, 0);
        for (i, (row, found)) in rows.iter().zip(&values).enumerate() {
            let x = row.map(f64::from);
            let ratio = twin::error_ratio(&twin.truth, &x, twin.inputs.len(), *found, twin.tolerance);
            if ratio > worst.0 {
                worst = (ratio, i);
            }
        }
        let (ratio, i) = worst;
        let line = format!(
            "{} on {}: {ratio:.2} of {} ε (4 + k) ({}) at {:?}: {} for {}",
            twin.name,
            device.name,
            twin.tolerance,
            twin.reason,
            &rows[i][..twin.inputs.len()],
            values[i],
            (twin.truth)(&rows[i].map(f64::from)),
        );
        println!("{line}");
        if ratio > 1.0 {
            broken.push(line);
        }
    }
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}
