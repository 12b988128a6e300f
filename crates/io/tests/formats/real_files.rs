//! Real files against the figures that are known of them. The files do not ship: `VOLTET_TEST_DATA` names their folder,
//! or they lie in `../shared/data` beside the checkout.

use std::path::PathBuf;
use voltet_core::grid::code;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, Summary, inspect, read};

/// The folder of the files; `None`, and a loud word, where it is not there.
pub fn folder() -> Option<PathBuf> {
    let folder = match std::env::var_os("VOLTET_TEST_DATA") {
        Some(folder) => PathBuf::from(folder),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
    };
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: there is no folder {} (VOLTET_TEST_DATA names another)", folder.display());
    None
}

/// Known contents of a file: name; points; cells by type; arrays with components, type and range; bounds.
struct Known {
    file: &'static str,
    point_count: u64,
    cells: &'static [(u8, u64)],
    arrays: &'static [(&'static str, usize, &'static str, [f64; 2])],
    bounds: [[f64; 2]; 3],
}

const MIXED_CELLS: &[(u8, u64)] = &[
    (code::TETRA, 54),
    (code::VOXEL, 9),
    (code::HEXAHEDRON, 9),
    (code::WEDGE, 18),
    (code::PYRAMID, 54),
    (code::QUADRATIC_TETRA, 54),
];
const MIXED_ARRAYS: &[(&str, usize, &str, [f64; 2])] = &[
    ("linear", 1, "Float64", [0.0, 21.0]),
    ("gauss", 1, "Float32", [0.0011709, 0.8825]),
    ("layer", 1, "Int32", [0.0, 5.0]),
];
const MIXED_BOUNDS: [[f64; 2]; 3] = [[0.0, 6.0], [0.0, 3.0], [0.0, 3.0]];
const BLUNTFIN_ARRAYS: &[(&str, usize, &str, [f64; 2])] = &[
    ("density", 1, "Float32", [0.1926, 4.9775]),
    ("momentum", 3, "Float32", [0.0, 6.2557]),
    ("energy", 1, "Float32", [0.76896, 25.161]),
    ("pressure", 1, "Float32", [0.25955, 10.013]),
    ("mach", 1, "Float32", [0.0, 3.3854]),
];
const BLUNTFIN_BOUNDS: [[f64; 2]; 3] = [[-7.8157, 14.362], [0.0, 8.3276], [0.0, 5.7243]];
const PIPE_ARRAYS: &[(&str, usize, &str, [f64; 2])] =
    &[("velocity", 3, "Float64", [0.0, 1.0044]), ("vel_norm", 1, "Float64", [0.0, 1.0044])];
const PIPE_BOUNDS: [[f64; 2]; 3] = [[-0.01, 0.01], [-0.01, 0.01], [0.0, 0.1]];
const POST_ARRAYS: &[(&str, usize, &str, [f64; 2])] = &[
    ("iblank", 1, "Int32", [-1.0, 1.0]),
    ("density", 1, "Float32", [1.0, 1.0]),
    ("momentum", 3, "Float32", [0.0, 1.3914]),
    ("energy", 1, "Float32", [-0.54151, 4.3958]),
    ("pressure", 1, "Float32", [-0.21662, 1.7583]),
    ("speed", 1, "Float32", [0.0, 1.3914]),
];
const POST_BOUNDS: [[f64; 2]; 3] = [[-14.987, 15.0], [-14.997, 14.997], [0.0, 4.8205]];
const NOTCH_CELLS: &[(u8, u64)] = &[(code::HEXAHEDRON, 2188), (code::WEDGE, 4)];
const NOTCH_ARRAYS: &[(&str, usize, &str, [f64; 2])] = &[
    ("Nodal Stress-0", 1, "Float64", [-1.4536e5, 8.1078e6]),
    ("Nodal Stress", 6, "Float64", [3206.6, 8.1098e6]),
    ("Nodal Stress-normed", 1, "Float64", [3206.6, 8.1098e6]),
];
const NOTCH_BOUNDS: [[f64; 2]; 3] = [[0.0, 0.4], [0.0, 0.1], [0.0, 0.01]];
const CAN_BOUNDS: [[f64; 2]; 3] = [[-12.17, 6.0029], [-3.6004, 5.5622], [-18.335, -13.456]];
const CENTRE_ARRAYS: &[(&str, usize, &str, [f64; 2])] =
    &[("DistanceToCenter", 1, "Float32", [0.0, 1.7321]), ("Polynomial", 1, "Float32", [1.0, 7.0])];
const TWO_CUBE: [[f64; 2]; 3] = [[0.0, 2.0], [0.0, 2.0], [0.0, 2.0]];

#[rustfmt::skip]
const FILES: &[Known] = &[
    Known { file: "formats/mixed_cells_v51_ascii.vtk", point_count: 236, cells: MIXED_CELLS, arrays: MIXED_ARRAYS, bounds: MIXED_BOUNDS },
    Known { file: "formats/tetmesh_v42_ascii.vtk", point_count: 55, cells: &[(code::TETRA, 160)], arrays: &[("scalars", 1, "Int32", [0.0, 4.0])],
        bounds: [[-9.4657, 9.7803], [-9.0906, 9.9465], [-9.7711, 7.1407]] },
    Known { file: "formats/pipe_linear_v42_binary.vtk", point_count: 465, cells: &[(code::TETRA, 1_522)], arrays: PIPE_ARRAYS, bounds: PIPE_BOUNDS },
    Known { file: "formats/notch_stress_v51_binary.vtk", point_count: 3_537, cells: NOTCH_CELLS, arrays: NOTCH_ARRAYS, bounds: NOTCH_BOUNDS },
    Known { file: "bluntfin.vtu", point_count: 40_960, cells: &[(code::TETRA, 224_874)], arrays: BLUNTFIN_ARRAYS, bounds: BLUNTFIN_BOUNDS },
    Known { file: "bluntfin.vts", point_count: 40_960, cells: &[(code::HEXAHEDRON, 37_479)], arrays: BLUNTFIN_ARRAYS, bounds: BLUNTFIN_BOUNDS },
    Known { file: "post.vtu", point_count: 109_744, cells: &[(code::TETRA, 616_050)], arrays: POST_ARRAYS, bounds: POST_BOUNDS },
    Known { file: "post_merged.vtu", point_count: 108_300, cells: &[(code::TETRA, 616_050)], arrays: POST_ARRAYS, bounds: POST_BOUNDS },
    Known { file: "disk_out_ref.vtu", point_count: 8_499, cells: &[(code::HEXAHEDRON, 7_472)], arrays: &[
        ("Temp", 1, "Float64", [293.15, 913.15]), ("V", 3, "Float64", [0.0, 22.419]), ("Pres", 1, "Float64", [0.0067855, 0.028819]),
        ("AsH3", 1, "Float64", [0.080477, 0.18484]), ("GaMe3", 1, "Float64", [0.00022284, 0.0072139]),
        ("CH4", 1, "Float64", [0.0, 0.0011702]), ("H2", 1, "Float64", [0.80761, 0.91769])],
        bounds: [[-5.75, 5.75], [-5.75, 5.75], [-10.0, 10.16]] },
    Known { file: "pin_array.vtu", point_count: 27_936, cells: &[(code::HEXAHEDRON, 23_576)], arrays: &[
        ("Temperature", 1, "Float32", [321.33, 418.64]), ("Pressure", 1, "Float32", [-319.16, 315.16]),
        ("Velocity", 3, "Float32", [0.0, 0.75505]), ("Turb_Kin_Energy", 1, "Float32", [0.0, 0.02651]), ("zone", 1, "UInt8", [0.0, 1.0])],
        bounds: [[0.0, 0.011154], [-4.9676e-19, 0.00322], [-0.005, 0.01]] },
    Known { file: "cylinder3d.vtu", point_count: 5_696, cells: &[(code::TETRA, 27_591)], arrays: &[
        ("Density", 1, "Float64", [0.82153, 1.0519]), ("Momentum", 3, "Float64", [0.0073755, 0.61554]), ("Energy", 1, "Float64", [2.1699, 2.7045]),
        ("Pressure", 1, "Float64", [0.78691, 1.0816]), ("Temperature", 1, "Float64", [0.95201, 1.0283]), ("Mach", 1, "Float64", [0.0058443, 0.63296])],
        bounds: [[-6.25e-11, 1.0], [-5.9297e-11, 0.5], [-6.25e-11, 0.5]] },
    Known { file: "bracket.vtu", point_count: 102_578, cells: &[(code::QUADRATIC_TETRA, 56_786)], arrays: &[
        ("Equivalent (von-Mises) Stress (psi)", 1, "Float32", [0.014035, 23.269])], bounds: [[-2.0, 2.0], [-2.0, 2.0], [0.0, 3.25]] },
    Known { file: "formats/mixed_cells_base64.vtu", point_count: 236, cells: MIXED_CELLS, arrays: MIXED_ARRAYS, bounds: MIXED_BOUNDS },
    Known { file: "formats/pipe_linear_bigendian.vtu", point_count: 465, cells: &[(code::TETRA, 1_522)], arrays: PIPE_ARRAYS, bounds: PIPE_BOUNDS },
    Known { file: "formats/notch_stress_lzma_appended.vtu", point_count: 3_537, cells: NOTCH_CELLS, arrays: NOTCH_ARRAYS, bounds: NOTCH_BOUNDS },
    Known { file: "formats/can_zlib_base64.vtu", point_count: 6_724, cells: &[(code::HEXAHEDRON, 4_800)], arrays: &[
        ("DISPL", 3, "Float64", [2.4611, 18.594]), ("VEL", 3, "Float64", [2006.4, 5221.3]), ("ACCL", 3, "Float64", [2.4035e5, 2.0194e8]),
        ("GlobalNodeId", 1, "Int64", [1.0, 6724.0]), ("PedigreeNodeId", 1, "Int64", [1.0, 6724.0]), ("EQPS", 1, "Float64", [0.021583, 2.8939])], bounds: CAN_BOUNDS },
    Known { file: "formats/can_celldata_only.vtu", point_count: 6_724, cells: &[(code::HEXAHEDRON, 4_800)], arrays: &[
        ("EQPS", 1, "Float64", [0.021583, 2.8939])], bounds: CAN_BOUNDS },
    Known { file: "formats/can_pieces.pvtu", point_count: 13_448, cells: &[(code::HEXAHEDRON, 4_800)], arrays: &[
        ("DISPL", 3, "Float64", [2.4611, 18.594]), ("VEL", 3, "Float64", [2006.4, 5221.3]), ("ACCL", 3, "Float64", [2.4035e5, 2.0194e8]),
        ("PedigreeNodeId", 1, "Int64", [1.0, 6724.0]), ("EQPS", 1, "Float64", [0.021583, 2.8939])], bounds: CAN_BOUNDS },
    Known { file: "formats/hexa_lz4_appended.vtu", point_count: 12_167, cells: &[(code::HEXAHEDRON, 10_648)], arrays: &[
        ("scalars", 1, "Float32", [0.75306, 17.321])], bounds: [[0.0, 0.95652]; 3] },
    Known { file: "formats/quadratic_tetra_ascii.vtu", point_count: 189, cells: &[(code::QUADRATIC_TETRA, 96)], arrays: CENTRE_ARRAYS, bounds: TWO_CUBE },
    Known { file: "formats/wedge_appended_base64.vtu", point_count: 27, cells: &[(code::WEDGE, 16)], arrays: CENTRE_ARRAYS, bounds: TWO_CUBE },
    Known { file: "formats/multicomb_0_ascii.vts", point_count: 648, cells: &[(code::HEXAHEDRON, 440)], arrays: &[
        ("Density", 1, "Float32", [0.20301, 0.71042]), ("Momentum", 3, "Float32", [0.0, 382.35]), ("StagnationEnergy", 1, "Float32", [0.0, 0.0])],
        bounds: [[0.0, 6.3653], [-5.1445, 5.1445], [23.374, 32.895]] },
    Known { file: "formats/voxel_no_arrays.vtu", point_count: 8, cells: &[(code::VOXEL, 1)], arrays: &[], bounds: [[0.0, 1.0]; 3] },
    Known { file: "formats/shell_quads_only.vtu", point_count: 39, cells: &[(9, 17)], arrays: &[
        ("GlobalNodeId", 1, "Int64", [2.0, 160.0]), ("PedigreeNodeId", 1, "Int64", [2.0, 160.0]), ("DISPLACEMENT_", 3, "Float64", [5.0, 7.15]),
        ("THICKNESS", 1, "Float64", [0.90703, 0.90703]), ("GlobalElementId", 1, "Int64", [6.0, 118.0]), ("PedigreeElementId", 1, "Int64", [6.0, 118.0]),
        ("ObjectId", 1, "Int32", [9.0, 9.0]), ("vtkOriginalCellIds", 1, "Int64", [5.0, 117.0])], bounds: [[0.0, 7.0], [-2.0, 8.0], [-3.85, 6.3935]] },
];

/// The figures are known to five digits.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 6e-5 * b.abs().max(1e-6)
}

fn check(known: &Known, summary: &Summary) {
    let file = known.file;
    assert_eq!(summary.point_count, known.point_count, "{file}");
    assert_eq!(
        summary.cells_by_type.iter().map(|(&c, &n)| (c, n)).collect::<Vec<_>>(),
        known.cells,
        "{file}"
    );
    let names: Vec<_> = summary.arrays.iter().map(|a| a.head.name.as_str()).collect();
    assert_eq!(names, known.arrays.iter().map(|a| a.0).collect::<Vec<_>>(), "{file}");
    for (array, known) in summary.arrays.iter().zip(known.arrays) {
        assert_eq!((array.head.component_count, array.number_type), (known.1, known.2), "{file} {}", known.0);
        let range = array.range.unwrap();
        assert!(same(range[0], known.3[0]) && same(range[1], known.3[1]), "{file} {} {range:?}", known.0);
        assert_eq!(array.not_finite_count, 0, "{file} {}", known.0);
    }
    let [low, high] = summary.bounds.unwrap();
    for axis in 0..3 {
        assert!(
            same(low[axis], known.bounds[axis][0]) && same(high[axis], known.bounds[axis][1]),
            "{file} {low} {high}"
        );
    }
}

#[test]
fn files_hold_what_is_known_of_them() {
    let Some(folder) = folder() else { return };
    for known in FILES {
        let summary = inspect(&folder.join(known.file), &Request::default(), &NoProgress)
            .unwrap_or_else(|error| panic!("{error}"));
        check(known, &summary);
    }
}

#[test]
fn every_array_of_every_file_is_read() {
    let Some(folder) = folder() else { return };
    for known in FILES
        .iter()
        .filter(|k| !k.arrays.is_empty() && (code::TETRA..=code::HEXAGONAL_PRISM).contains(&k.cells[0].0))
    {
        for &(name, component_count, _, range) in known.arrays {
            let scalar = if component_count > 1 { format!("{name}:magnitude") } else { name.to_owned() };
            let request = Request { scalar: Some(scalar.clone()), ..Request::default() };
            let grid = read(&folder.join(known.file), &request, &NoProgress)
                .unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(grid.scalar_name, scalar);
            let values = grid.scalar.as_ref().unwrap();
            assert_eq!(values.len(), grid.points.len());
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let margin = 6e-5 * range[1].abs().max(range[0].abs());
            assert!(
                low >= range[0] - margin && high <= range[1] + margin,
                "{} {name} {low} {high}",
                known.file
            );
            assert_eq!(grid.origin.arrays_unread.len(), known.arrays.len() - 1, "{}", known.file);
        }
    }
}

#[test]
fn files_without_volume_or_arrays_say_so() {
    let Some(folder) = folder() else { return };
    let message =
        |file: &str| read(&folder.join(file), &Request::default(), &NoProgress).unwrap_err().to_string();
    let shell = message("formats/shell_quads_only.vtu");
    assert!(shell.contains("no three-dimensional cells") && shell.contains("17 quads"), "{shell}");
    let voxel = message("formats/voxel_no_arrays.vtu");
    assert!(voxel.contains("no quantity to draw") && voxel.contains("voxel_no_arrays.vtu"), "{voxel}");
}
