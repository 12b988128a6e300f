//! A first picture by the library: of a data file, or of a small grid that is computed here.
//!
//! `cargo run --release --example first_picture -- [DATA [SCALAR]]` writes first_picture.png.

use voltet::prelude::*;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let grid = arguments.next().map_or_else(ball, Grid::read)?;
    let scalar = arguments.next().or(grid.array_names()?.into_iter().next()).unwrap_or_default();
    let volume = Volume::new(grid, &scalar)?;
    let [low, high] = volume.range();
    let (middle, width) = (0.5 * (low + high), 0.05 * (high - low));
    let transfer_function = TransferFunction::new()
        .with(Gaussian::at(middle, 0.0).sigma(width, f64::INFINITY).color([1.0, 0.48, 0.06]).extinction(4.0));
    let camera = Camera::framing(volume.bounds()).from([-0.45, -0.85, 0.4]).size(800, 600);
    let image = Renderer::new()?.render(&Scene::new(volume, transfer_function, camera))?;
    image.save("first_picture.png")?;
    println!("first_picture.png is written");
    Ok(())
}

/// Hexahedra of a cube, with a temperature that falls from its middle.
fn ball() -> Result<Grid> {
    const SIDE: u32 = 24;
    let numbers =
        |count: u32| (0..count.pow(3)).map(move |i| [i % count, i / count % count, i / count / count]);
    let points: Vec<[f64; 3]> =
        numbers(SIDE + 1).map(|p| p.map(|k| 2.0 * f64::from(k) / f64::from(SIDE) - 1.0)).collect();
    let temperature: Vec<f64> =
        points.iter().map(|[x, y, z]| 80.0 - 60.0 * (x * x + y * y + z * z).sqrt()).collect();
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let number = |[i, j, k]: [u32; 3]| i + (SIDE + 1) * (j + (SIDE + 1) * k);
    let connectivity: Vec<u32> =
        numbers(SIDE).flat_map(|[i, j, k]| corners.map(|[a, b, c]| number([i + a, j + b, k + c]))).collect();
    let offsets: Vec<usize> = (0..=connectivity.len() / 8).map(|cell| 8 * cell).collect();
    // VTK's type of a hexahedron.
    let types = vec![12; offsets.len() - 1];
    Grid::from_vtk_arrays(points, &types, &offsets, &connectivity)?.point_data("T", temperature)
}
