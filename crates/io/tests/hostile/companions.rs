//! Damaged files that belong to others: series, pieces, partitions, solutions, data beside a description.

use crate::damage::{case_count, corrupt_files, packed};
use voltet_testing::files::plot3d;
use voltet_testing::files::samples::{structured, unstructured};
use voltet_testing::files::xml::{Encoding, encodings};

fn text() -> Encoding {
    encodings()[0]
}

#[test]
fn damaged_pieces_and_partitions_are_errors_or_other_grids() {
    let pieces = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"1\"><Piece Source=\"0.vtu\"/>\
        <Piece Source=\"1.vtu\"/></PUnstructuredGrid></VTKFile>";
    let partitions = "<VTKFile type=\"vtkPartitionedDataSetCollection\"><vtkPartitionedDataSetCollection>\
        <Partitions index=\"0\" name=\"a\"><DataSet index=\"0\" file=\"0.vtu\"/><DataSet index=\"1\" file=\"1.vtu\"/></Partitions>\
        </vtkPartitionedDataSetCollection></VTKFile>";
    for (name, content) in [("a.pvtu", pieces), ("a.vtpc", partitions)] {
        let files = [
            (name, content.as_bytes().to_vec()),
            ("0.vtu", unstructured(text(), 2, false)),
            ("1.vtu", unstructured(text(), 3, true)),
        ];
        corrupt_files(&files, name, "Float64", case_count().max(300));
    }
    let extents = ["PStructuredGrid", "PRectilinearGrid", "PImageData"];
    for (kind, parallel) in ["StructuredGrid", "RectilinearGrid", "ImageData"].into_iter().zip(extents) {
        let piece = "<Piece Source=\"0.vtk\"/>";
        let content = format!(
            "<VTKFile type=\"{parallel}\"><{parallel} GhostLevel=\"0\">{piece}</{parallel}></VTKFile>"
        );
        let files = [("a.pvt", content.into_bytes()), ("0.vtk", structured(kind, text()))];
        corrupt_files(&files, "a.pvt", "s", case_count().max(200));
    }
}

#[test]
fn damaged_series_are_errors_or_other_grids() {
    let series = "{\"file-series-version\": \"1.0\", \"files\": [{\"name\": \"0.vtu\", \"time\": 0}, {\"name\": \"1.vtu\", \"time\": 1.5}]}";
    let files = [
        ("a.vtu.series", series.as_bytes().to_vec()),
        ("0.vtu", unstructured(text(), 2, false)),
        ("1.vtu", unstructured(text(), 3, true)),
    ];
    corrupt_files(&files, "a.vtu.series", "Float64", case_count().max(300));
}

#[test]
fn damaged_solutions_of_plot3d_are_errors_or_other_grids() {
    for layout in plot3d::layouts().step_by(5) {
        let files = [("a.xyz", plot3d::grid_file(layout)), ("a.q", plot3d::solution_file(layout))];
        corrupt_files(&files, "a.xyz", "density", case_count().max(120) / 2);
    }
}

#[test]
fn damaged_files_in_hdf5_that_lead_to_others_are_errors_or_other_grids() {
    let files = |names: &[&'static str]| -> Vec<(&'static str, Vec<u8>)> {
        names.iter().map(|name| (*name, packed(name))).collect()
    };
    let linked =
        files(&["vtkhdf_linked.vtkhdf", "vtkhdf_linked_casing.vtkhdf", "vtkhdf_linked_rotor.vtkhdf"]);
    corrupt_files(&linked, "vtkhdf_linked.vtkhdf", "s", case_count());
    let linked = files(&["cgns_linked.cgns", "cgns_cells.cgns"]);
    corrupt_files(&linked, "cgns_linked.cgns", "s", case_count());
    let binary = ["xdmf_binary.xdmf", "xdmf_binary0.bin", "xdmf_binary1.bin", "xdmf_binary2.bin"];
    let binary = [files(&binary), files(&["xdmf_binary3.bin", "xdmf_binary4.bin"])].concat();
    corrupt_files(&binary, "xdmf_binary.xdmf", "s", case_count());
}

#[test]
fn damaged_parts_of_exodus_are_errors_or_other_grids() {
    let names = ["exodus_row.e.2.0", "exodus_row.e.2.1"];
    let files: Vec<_> = names.into_iter().map(|name| (name, packed(name))).collect();
    corrupt_files(&files, names[0], "T", case_count());
}

#[test]
fn damaged_text_of_ensight_is_an_error_or_another_grid() {
    let geometry = "a\nb\nnode id off\nelement id given\npart\n         1\nbox\ncoordinates\n         5\n0\n1\n0\n0\n1\n0\n0\n1\n0\n1\n0\n0\n0\n1\n1\n\
        tetra4\n         2\n         7\n         8\n         1         2         3         4\n         2         3         4         5\n";
    let point = "f\npart\n         1\ncoordinates\n 1.0\n 2.0\n 3.0\n 4.0\n 5.0\n";
    let cell = "c\npart\n         1\ntetra4 undef\n-9.0\n 1.0\n-9.0\n";
    let case = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: f a.f\nscalar per element: c a.c\n";
    let files = [("a.case", case), ("a.geo", geometry), ("a.f", point), ("a.c", cell)];
    let files = files.map(|(name, text)| (name, text.as_bytes().to_vec()));
    for scalar in ["f", "c"] {
        corrupt_files(&files, "a.case", scalar, case_count().max(400));
    }
}
