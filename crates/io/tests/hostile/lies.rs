//! Files whose headers promise what is not there.

use crate::memory::peak_of;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, inspect, read};
use voltet_testing::files::samples::{file, unstructured};
use voltet_testing::files::xml::{Compressor, Encoding, Mode};

const RAW: Encoding = Encoding {
    mode: Mode::AppendedRaw,
    compressor: Compressor::None,
    big_endian: false,
    wide_headers: false,
    block: 64,
};

/// The message about a file, which must come without more memory than a small multiple of its size.
fn message(name: &str, bytes: &[u8], request: &Request) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, name, bytes);
    let (result, peak) = peak_of(|| read(&path, request, &NoProgress));
    // Buffers of the readers and of the threads that are there once.
    assert!(peak < 16 * bytes.len() + (4 << 20), "{peak} bytes for {name}");
    let message = result.expect_err(name).to_string();
    assert!(message.contains(name), "{message}");
    message
}

fn scalar(name: &str) -> Request {
    Request { scalar: Some(name.to_owned()), ..Request::default() }
}

/// Replaces the first occurrence of a text, keeping the file's length where both are as long.
fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect(from);
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

#[track_caller]
fn expect(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

#[test]
fn counts_beyond_the_file_are_errors() {
    let sound = unstructured(RAW, 3, false);
    let points = replaced(&sound, "NumberOfPoints=\"16\"", "NumberOfPoints=\"99999999999999\"");
    expect(&message("a.vtu", &points, &scalar("Float64")), &["wrong size", "Float64"]);
    let cells = replaced(&sound, "NumberOfCells=\"18\"", "NumberOfCells=\"1000000000000\"");
    expect(&message("a.vtu", &cells, &scalar("Float64")), &["types", "18 bytes"]);
    let overflow = replaced(&sound, "NumberOfPoints=\"16\"", "NumberOfPoints=\"18446744073709551615\"");
    expect(&message("a.vtu", &overflow, &scalar("Float64")), &["cannot be that large"]);
    let negative = replaced(&sound, "NumberOfPoints=\"16\"", "NumberOfPoints=\"-16\"");
    expect(&message("a.vtu", &negative, &scalar("Float64")), &["NumberOfPoints", "'-16'"]);
    let components = replaced(
        &sound,
        "vec &amp; tor\" NumberOfComponents=\"3\"",
        "vec &amp; tor\" NumberOfComponents=\"4000000000\"",
    );
    expect(&message("a.vtu", &components, &scalar("vec & tor:0")), &["vec & tor"]);
}

#[test]
fn a_block_table_cannot_promise_terabytes() {
    for name in ["vtkZLib", "vtkLZ4", "vtkLZMA"] {
        // One block of 1 TB from 16 bytes; the number of points agrees.
        let header = format!(
            "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"{name}DataCompressor\">\
             <ImageData WholeExtent=\"0 9999 0 9999 0 9999\"><Piece Extent=\"0 9999 0 9999 0 9999\"><PointData>\
             <DataArray type=\"UInt8\" Name=\"s\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>\
             <AppendedData encoding=\"raw\">_"
        );
        let mut bytes = header.into_bytes();
        for word in [1, 1_000_000_000_000_u64, 0, 16] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend([0; 16]);
        expect(&message("bomb.vti", &bytes, &scalar("s")), &["table of compressed blocks", "'s'"]);
    }
}

#[test]
fn a_uniform_grid_without_arrays_allocates_nothing() {
    let bytes = b"<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 9999 0 9999 0 9999\">\
        <Piece Extent=\"0 9999 0 9999 0 9999\"/></ImageData></VTKFile>";
    expect(&message("empty.vti", bytes, &Request::default()), &["no quantity to draw"]);
    let huge =
        b"<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 9223372036854775807 0 99999999 0 9999\">\
        <Piece Extent=\"0 9223372036854775807 0 9223372036854775807 0 9\"/></ImageData></VTKFile>";
    expect(&message("huge.vti", huge, &Request::default()), &["cannot be that large"]);
}

/// A folder of one patch of an image with these attributes and the message about it, which comes without more memory than a file.
fn message_of_patch(extent: &str, spacing: &str, array: &str) -> String {
    let image = format!(
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"{extent}\" Spacing=\"{spacing}\"><Piece Extent=\"{extent}\">\
         <CellData>{array}</CellData></Piece></ImageData></VTKFile>"
    );
    let tree = "<VTKFile type=\"vtkNonOverlappingAMR\"><vtkNonOverlappingAMR><Block level=\"0\"><DataSet index=\"0\" file=\"0.vti\"/>\
        </Block></vtkNonOverlappingAMR></VTKFile>";
    let folder = tempfile::tempdir().unwrap();
    file(&folder, "0.vti", image.as_bytes());
    let path = file(&folder, "a.vthb", tree.as_bytes());
    let (result, peak) = peak_of(|| read(&path, &scalar("c"), &NoProgress));
    assert!(peak < 8 << 20, "{peak} bytes");
    result.expect_err(extent).to_string()
}

#[test]
fn patches_and_trees_beyond_the_file_are_errors() {
    let array = "<DataArray type=\"UInt8\" Name=\"c\" format=\"ascii\">1 2 3</DataArray>";
    let max = i64::MAX;
    for (extent, parts) in [
        ("0 500 0 500 0 500".to_owned(), &["larger than the file", "0.vti", "'c'"][..]),
        (format!("0 {max} 0 1 0 1"), &["cannot be that large"]),
        (format!("0 {max} 0 {max} 0 {max}"), &["cannot be that large"]),
        (format!("-{max} {max} 0 1 0 1"), &["cannot be that large"]),
    ] {
        expect(&message_of_patch(&extent, "1 1 1", array), parts);
    }
    expect(&message_of_patch("0 500 0 500 0 500", "1 1 1", ""), &["holds no arrays", "0.vti", "level0/box0"]);
    for spacing in ["1 1 0", "1 1 nan", "1 inf 1"] {
        expect(&message_of_patch("0 1 0 1 0 3", spacing, array), &["size of the cells is damaged"]);
    }
}

#[test]
fn offsets_connectivity_and_types_are_checked() {
    let ascii = Encoding { mode: Mode::Ascii, ..RAW };
    let sound = unstructured(ascii, 3, false);
    let request = scalar("Float64");
    let offsets = replaced(&sound, "4 8 12 16 20", "4 8 11 16 20");
    expect(&message("a.vtu", &offsets, &request), &["cell 2, a tetrahedron", "found 3", "expected 4"]);
    let corner = replaced(&sound, "0 1 3 7", "0 1 3 77");
    expect(&message("a.vtu", &corner, &request), &["cell 3", "77", "below 16"]);
    let negative = replaced(&sound, "0 1 3 7", "0 1 -3 7");
    expect(&message("a.vtu", &negative, &request), &["'-3'", "connectivity"]);
    let kind = replaced(&sound, "10 10 10", "10 99 10");
    expect(&message("a.vtu", &kind, &request), &["cell 1", "unknown type", "99"]);
    let mixed = unstructured(ascii, 3, true);
    let descending = replaced(&mixed, "24 32 36", "24 22 36");
    expect(&message("a.vtu", &descending, &request), &["offset of cell 6", "22", "at least 24"]);
    expect(&message("a.vtu", &descending, &request), &["offsets"]);
    let long = replaced(&mixed, "52 56", "52 55");
    expect(
        &message("a.vtu", &long, &request),
        &["more point numbers", "found 56", "55", "offsets", "connectivity"],
    );
    let shifted = replaced(&mixed, "4 8 12", "4 4 8 12");
    expect(&message("a.vtu", &shifted, &request), &["do not begin at 0", "found 4", "offsets"]);
    let few = replaced(&sound, "10 10 10", "10 10");
    expect(&message("a.vtu", &few, &request), &["types", "found 17", "18"]);
    let word = replaced(&sound, "10 10 10", "10 1x 10");
    expect(&message("a.vtu", &word, &request), &["types", "'1x'"]);
}

#[test]
fn what_is_no_data_file_says_what_would_be() {
    expect(&message("a.vtu", b"hello, this is text", &Request::default()), &["format", "hello", ".vtu"]);
    expect(&message("a.vtu", b"<html><body/></html>", &Request::default()), &["not a VTK file", "<html>"]);
    expect(
        &message("a.vtu", b"<VTKFile type=\"PolyData\"><PolyData/></VTKFile>", &Request::default()),
        &["PolyData", "cells with a volume"],
    );
    expect(
        &message("a.vtu", b"<VTKFile type=\"UnstructuredGrid\">", &Request::default()),
        &["ends early", "VTKFile", "written to its end"],
    );
    expect(
        &message("a.vtu", b"<VTKFile>\n<a></b>", &Request::default()),
        &["XML is damaged", "a.vtu:2", "the first line declares"],
    );
    expect(&message("a.pvtu", b"<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><Piece Source=\"a.pvtu\"/></PUnstructuredGrid></VTKFile>", &Request::default()), &["cannot stand there", "in one part"]);
    let missing = read(std::path::Path::new("no/such.vtu"), &Request::default(), &NoProgress).unwrap_err();
    expect(&missing.to_string(), &["no such file", "no/such.vtu"]);
    let folder = tempfile::tempdir().unwrap();
    let of_folder = || read(folder.path(), &Request::default(), &NoProgress).unwrap_err().to_string();
    expect(&of_folder(), &["not a file"]);
    file(&folder, "md.idx", b"ADIOS-BP v2.10");
    expect(&of_folder(), &["data of ADIOS2", "ParaView"]);
    expect(&message("a.bp", b"\0\0", &Request::default()), &["data of ADIOS2", "ParaView"]);
    expect(&message("a.vtu", b"", &Request::default()), &["empty"]);
}

#[test]
fn unknown_arrays_list_the_nearest_first() {
    let sound = unstructured(RAW, 3, false);
    let error = message("a.vtu", &sound, &scalar("float6"));
    expect(&error, &["no array 'float6'", "'Float64', 'Float32'", "a.vtu"]);
    expect(&message("a.vtu", &sound, &Request::default()), &["several arrays", "'Int8'"]);
    expect(
        &message("a.vtu", &sound, &scalar("vec & tor")),
        &["not a scalar", "3 components", "'vec & tor:magnitude'", "'vec & tor:2'"],
    );
    expect(&message("a.vtu", &sound, &scalar("vec & tor:3")), &["no such component", "0 to 2"]);
    let twice = replaced(&sound, "Name=\"Int16\"", "Name=\"UInt8\"");
    expect(&message("a.vtu", &twice, &scalar("UInt8")), &["several arrays of the name 'UInt8'"]);
}

#[test]
fn cells_that_are_not_finite_are_left_out_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let ascii = Encoding { mode: Mode::Ascii, ..RAW };
    let sound = unstructured(ascii, 3, false);
    let at = String::from_utf8_lossy(&sound).find("Name=\"Points\"").unwrap();
    let points = replaced(&sound[at..], "3 1 1", "3 nan 1");
    let path = file(&folder, "a.vtu", &[&sound[..at], &points].concat());
    let grid = read(&path, &scalar("Float64"), &NoProgress).unwrap();
    assert_eq!((grid.origin.cells_not_finite, grid.tetrahedra.len()), (6, 12));
    assert!(
        grid.origin.warnings.iter().any(|warning| warning.contains("not finite")),
        "{:?}",
        grid.origin.warnings
    );
}

#[test]
fn a_lattice_of_more_points_than_numbers_is_an_error() {
    let image = b"<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1048575 0 1048575 0 1048575\">\
        <Piece Extent=\"0 1048575 0 1048575 0 1048575\"/></ImageData></VTKFile>";
    let xdmf = b"<Xdmf><Domain><Grid><Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"1048576 1048576 1048576\"/>\
        <Geometry GeometryType=\"ORIGIN_DXDYDZ\"><DataItem Dimensions=\"3\">0 0 0</DataItem>\
        <DataItem Dimensions=\"3\">1 1 1</DataItem></Geometry></Grid></Domain></Xdmf>";
    for (name, bytes) in [("a.vti", &image[..]), ("a.xdmf", &xdmf[..])] {
        let folder = tempfile::tempdir().unwrap();
        let path = file(&folder, name, bytes);
        let error = inspect(&path, &Request::default(), &NoProgress).unwrap_err().to_string();
        expect(&error, &["too many points", "1152921504606846976"]);
    }
}

#[test]
fn grids_included_in_many_places_are_counted() {
    let includes: String = (0..20).map(|_| "<xi:include xpointer=\"element(/1/1/NEXT)\"/>").collect();
    let tree = |level: usize| {
        let next = (level + 1).to_string();
        format!("<Grid GridType=\"Tree\">{}</Grid>", includes.replace("NEXT", &next))
    };
    let trees: String = (1..12).map(tree).collect();
    let text = format!("<Xdmf><Domain>{trees}<Grid/></Domain></Xdmf>");
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.xdmf", text.as_bytes());
    expect(&read(&path, &scalar("s"), &NoProgress).unwrap_err().to_string(), &["too many grids", "500000"]);
}

/// A file of netCDF (version 5) with a dimension of so many numbers, and these variables of floats: name, dimensions, begin.
fn netcdf(record_count: u64, dimension: u64, variables: &[(&str, usize, u64)]) -> Vec<u8> {
    let mut bytes = b"CDF\x05".to_vec();
    let word = |bytes: &mut Vec<u8>, value: u64| bytes.extend(value.to_be_bytes());
    let tag = |bytes: &mut Vec<u8>, tag: u32, count: u64| {
        bytes.extend(tag.to_be_bytes());
        bytes.extend(count.to_be_bytes());
    };
    let name = |bytes: &mut Vec<u8>, name: &str| {
        bytes.extend((name.len() as u64).to_be_bytes());
        bytes.extend(name.bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    };
    word(&mut bytes, record_count);
    tag(&mut bytes, 10, 1);
    name(&mut bytes, "n");
    word(&mut bytes, dimension);
    tag(&mut bytes, 0, 0);
    tag(&mut bytes, 11, variables.len() as u64);
    for &(own, axis_count, begin) in variables {
        name(&mut bytes, own);
        word(&mut bytes, axis_count as u64);
        (0..axis_count).for_each(|_| word(&mut bytes, 0));
        tag(&mut bytes, 0, 0);
        bytes.extend(5_u32.to_be_bytes());
        word(&mut bytes, 4);
        word(&mut bytes, begin);
    }
    bytes.resize(bytes.len().next_multiple_of(4) + 64, 0);
    bytes
}

#[test]
fn variables_of_no_size_and_blocks_by_name_alone_are_errors() {
    let times = netcdf(1 << 60, 0, &[("coordx", 1, 64), ("time_whole", 2, 64)]);
    expect(&message("a.e", &times, &scalar("T")), &["axis of records", "time_whole"]);
    let records = netcdf(1 << 60, 0, &[("coordx", 1, 64), ("time_whole", 1, 64)]);
    expect(&message("a.e", &records, &scalar("T")), &["ends early"]);
    let block = netcdf(0, 1, &[("coordx", 1, 64), ("connect16777216", 1, 64)]);
    expect(&message("a.e", &block, &scalar("T")), &["connect16777216", "65536"]);
}

#[test]
fn a_header_of_netcdf_that_is_cut_ends_early() {
    let whole = netcdf(0, 1, &[("coordx", 1, 64), ("time_whole", 1, 64)]);
    for length in 4..whole.len() - 64 {
        let found = message("a.e", &whole[..length], &scalar("T"));
        expect(&found, &["the file ends early", "byte", "expected"]);
    }
}

#[test]
fn counts_of_meshes_of_mfem_beyond_the_file_are_errors() {
    let sound = "MFEM mesh v1.3\ndimension\n3\nelements\n1\n1 4 0 1 2 3\nattribute_sets\n1\n\"a\"\n1\n1\nboundary\n1\n1 2 0 1 2\n\
        bdr_attribute_sets\n0\nvertices\n4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nmfem_mesh_end\n";
    for (from, to, words) in [
        ("elements\n1", "elements\n4000000000", ["attribute_sets", "a.mesh:7"]),
        ("sets\n1", "sets\n18446744073709551615", ["number is damaged", "a.mesh"]),
        ("\"a\"\n1", "\"a\"\n4000000000", ["number is damaged", "a.mesh:12"]),
        ("boundary\n1", "boundary\n4000000000", ["bdr_attribute_sets", "a.mesh"]),
        ("vertices\n4", "vertices\n4000000000", ["ends early", "4000000000"]),
        ("vertices\n4", "vertices\n30", ["ends early", "a.mesh"]),
        ("0 1 2 3\n", "0 1 2 4000000000\n", ["does not exist", "below 4"]),
    ] {
        expect(&message("a.mesh", &replaced(sound.as_bytes(), from, to), &Request::default()), &words);
    }
}

#[test]
fn crossing_faces_of_a_polyhedron_end_the_search_for_its_split() {
    let mut bytes = crate::damage::packed("tecplot_single.plt");
    // Two coordinates in the other byte order: the search for crossings made new ones for hours.
    bytes[3672..3680].reverse();
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "tecplot_single.plt", &bytes);
    let grid = read(&path, &scalar("s"), &NoProgress).unwrap();
    let warnings = grid.origin.warnings.join(" ");
    expect(&warnings, &["1 polyhedron was left out", "do faces cross?"]);
}
