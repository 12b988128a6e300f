//! XDMF files as meshio writes them, and in the layouts of DOLFIN and DOLFINx, against the same grids in .vtu files and against
//! formulas.

use super::packed::{field, follow, grid, grid_at, path, request, same_files};
use super::refusals::{refused, says};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, files_beside, files_read_beside, inspect, read, steps};

#[test]
fn every_cell_type_is_that_of_the_xml_file() {
    for data in ["hdf", "xml", "binary"] {
        same_files(&format!("xdmf_{data}.xdmf"), "cgns_cells.vtu");
    }
    for cell in ["tetra", "quadratictetra", "quadratichexahedron", "triquadratichexahedron", "quadraticwedge"]
    {
        same_files(&format!("xdmf_{cell}.xdmf"), &format!("xdmf_{cell}.vtu"));
    }
    same_files("xdmf_polyhedra.xdmf", "polyhedra.vtu");
    assert_eq!(files_beside(&path("xdmf_hdf.xdmf")), [path("xdmf_hdf.h5")]);
    assert_eq!(files_beside(&path("xdmf_binary.xdmf")).len(), 5);
}

#[test]
fn a_step_has_its_own_values_on_the_mesh_that_it_includes() {
    for (name, times) in [("series", [0.0, 0.5]), ("dolfin", [0.0, 0.5]), ("dolfinx", [0.0, 1.0])] {
        let name = format!("xdmf_{name}.xdmf");
        assert_eq!(steps(&path(&name), &Request::default()).unwrap().0.len(), 2, "{name}");
        for (step, time) in times.into_iter().enumerate() {
            let own = grid_at(&name, "T", step);
            assert_eq!(
                (own.points.len(), own.tetrahedra.len(), own.origin.time),
                (12, 12, Some(time)),
                "{name}"
            );
            follow(&own, |point| field(point) + 100.0 * time, &name);
        }
    }
    // Functions on one mesh are arrays of one grid.
    follow(&grid_at("xdmf_dolfin.xdmf", "u:2", 1), |_| 0.5, "u");
    assert_eq!(inspect(&path("xdmf_dolfin.xdmf"), &Request::default(), &NoProgress).unwrap().cell_count, 2);
    let facets = inspect(&path("xdmf_dolfinx.xdmf"), &Request::default(), &NoProgress).unwrap();
    assert_eq!((facets.piece_count, facets.cell_count), (2, 4));
}

#[test]
fn blocks_of_a_tree_have_slabs_references_and_joined_vectors() {
    let own = grid("xdmf_blocks.xdmf", &request("s"));
    follow(&own, field, "blocks");
    assert_eq!((own.points.len(), own.tetrahedra.len()), (36, 36));
    assert_eq!(own.origin.blocks[..], ["all/curvilinear", "all/outer/rectilinear", "all/outer/image"]);
    for (component, axis) in ["place:0", "place:1", "place:2"].into_iter().zip(0..) {
        follow(&grid("xdmf_blocks.xdmf", &request(component)), |point| point[axis], component);
    }
    let image = Request { blocks: vec!["*/image".to_owned()], ..request("s") };
    let image = grid("xdmf_blocks.xdmf", &image);
    assert!(image.points.len() == 12 && image.points.iter().all(|point| point.x >= 20.0));
}

#[test]
fn what_is_missing_or_circular_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(path("xdmf_dolfin.xdmf")).unwrap();
    std::fs::copy(path("xdmf_dolfin.h5"), folder.path().join("xdmf_dolfin.h5")).unwrap();
    let refused = |old: &str, new: &str, words: &[&str]| {
        assert!(text.contains(old), "{old}");
        let file = folder.path().join("a.xdmf");
        std::fs::write(&file, text.replace(old, new)).unwrap();
        let request = Request { time_step: Some(voltet_io::formats::TimeStep::Index(1)), ..request("T") };
        refused(&file, &request, words);
    };
    refused("xdmf_dolfin.h5:", "no.h5:", &["no.h5", "no such file"]);
    refused("VisualisationVector/T1", "no/T1", &["xdmf_dolfin.h5", "'/no'"]);
    refused("Mesh/0/mesh/topology", "Mesh/0/mesh/no", &["xdmf_dolfin.h5", "'/Mesh/0/mesh/no'"]);
    refused("TimeSeries_T&quot;", "no&quot;", &["not there", "@Name=\"no\""]);
    refused("xi:include xpointer", "xi:include href=\"b.xml\" xpointer", &["b.xml", "not followed"]);
    refused("/*[self::Topology", "/*[position() = 1 or self::Topology", &["not read", "[number]"]);
    let circle = "/Grid[2]/include".replace("include", "xi:include");
    refused("/Grid[1]/*[self::Topology or self::Geometry]", &circle, &["includes itself"]);
    let part = |more: &str| format!("VisualisationVector/T1|0 0:1 1:{more}");
    refused("VisualisationVector/T1", &part("12 1:12 1|b.h5:/x"), &["several datasets", "b.h5"]);
    refused("VisualisationVector/T1", &part("11 1:12 1"), &["other dimensions", "[12, 1]", "[11, 1]"]);
    refused("VisualisationVector/T1", &part("12"), &["part of a data item", "0 0:1 1:12"]);
    refused("Dimensions=\"12 1\"", "Dimensions=\"13 1\"", &["other dimensions", "[12, 1]"]);
}

/// A grid of one tetrahedron, whose numbers lie in a file of bytes from byte `seek` on.
fn tetrahedron(name: &str, file: &str, seek: usize) -> String {
    let item = |kind: &str, dimensions: &str, seek: usize| {
        format!(
            "<DataItem Format=\"Binary\" {kind} Dimensions=\"{dimensions}\" Seek=\"{seek}\">{file}</DataItem>"
        )
    };
    format!(
        "<Grid Name=\"{name}\"><Time Value=\"{seek}\"/><Topology TopologyType=\"Tetrahedron\">{}</Topology>\
         <Geometry>{}</Geometry><Attribute Name=\"s\">{}</Attribute></Grid>",
        item("NumberType=\"Int\"", "1 4", seek),
        item("NumberType=\"Float\"", "4 3", seek + 16),
        item("NumberType=\"Float\"", "4", seek + 64),
    )
}

/// The bytes of such a grid, moved along x.
fn bytes(x: f32) -> Vec<u8> {
    let numbers = [x, 0.0, 0.0, x + 1.0, 0.0, 0.0, x, 1.0, 0.0, x, 0.0, 1.0, x, x + 1.0, x, x];
    let connectivity = [0_i32, 1, 2, 3].into_iter().flat_map(i32::to_le_bytes);
    connectivity.chain(numbers.into_iter().flat_map(f32::to_le_bytes)).collect()
}

fn document(grids: &str) -> String {
    format!("\u{feff}<Xdmf><Domain>{grids}</Domain></Xdmf>")
}

#[test]
fn grids_of_one_file_at_other_bytes_are_others() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.xdmf");
    std::fs::write(folder.path().join("a.bin"), [bytes(0.0), bytes(5.0)].concat()).unwrap();
    std::fs::write(&file, document(&(tetrahedron("a", "a.bin", 0) + &tetrahedron("b", "a.bin", 80))))
        .unwrap();
    let own = read(&file, &request("s"), &NoProgress).unwrap();
    assert_eq!((own.points.len(), own.tetrahedra.len(), own.origin.blocks.len()), (8, 2, 2));
    follow(&own, |[x, ..]| x, "blocks");
}

#[test]
fn an_entity_stands_for_the_text_that_the_document_declares() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.xdmf");
    std::fs::write(folder.path().join("a.bin"), bytes(0.0)).unwrap();
    let head = "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" [\n<!ENTITY Heavy \"a\">\n<!ENTITY End '.bin'>\n]>\n";
    let text = |name: &str| format!("{head}<Xdmf><Domain>{}</Domain></Xdmf>", tetrahedron("a", name, 0));
    std::fs::write(&file, text("\n &Heavy;&End;\n")).unwrap();
    follow(&read(&file, &request("s"), &NoProgress).unwrap(), |[x, ..]| x, "entities");
    // The first declaration holds, one in a comment does not; space between entities is of the name.
    std::fs::write(folder.path().join("a b.bin"), bytes(0.0)).unwrap();
    let more =
        "<!-- <!ENTITY First 'c'> -->\n<!ENTITY First 'a'>\n<!ENTITY First 'c'>\n<!ENTITY Last 'b.bin'>\n]>";
    std::fs::write(&file, text("&First; &Last;").replacen("]>", more, 1)).unwrap();
    follow(&read(&file, &request("s"), &NoProgress).unwrap(), |[x, ..]| x, "entities");
    let error = |text: String| {
        std::fs::write(&file, text).unwrap();
        read(&file, &request("s"), &NoProgress).unwrap_err().to_string()
    };
    let within = |value: &str| text("&New;.bin").replacen("]>", &format!("<!ENTITY New {value}>\n]>"), 1);
    let numbers = "<DataItem Dimensions=\"4 3\">0 0 0 1 0 0 0 1 0 0 0 &Heavy;</DataItem>";
    let (path, repeated) = ("<DataItem>a&Heavy;</DataItem>", "&Long;".repeat(1000));
    let long = text(&repeated).replacen("]>", &format!("<!ENTITY Long '{}'>]>", "a".repeat(2000)), 1);
    let items = |item: &str| {
        let whole = text("a.bin");
        let (begin, end) = (whole.find("<DataItem").unwrap(), whole.find("</DataItem>").unwrap());
        format!("{}{item}{}", &whole[..begin], &whole[end + "</DataItem>".len()..])
    };
    for (text, words) in [
        (text("&Heavy;&Other;"), ["not plain text", "a.xdmf:6"]),
        (within("'&Heavy;'"), ["not plain text", "a.xdmf:7"]),
        (within("SYSTEM 'a'"), ["not plain text", "a.xdmf:7"]),
        (within("'a"), ["a.xdmf", ":"]),
        (items(numbers), ["not plain text", "a.xdmf:6"]),
        (items(path), ["not plain text", "a.xdmf:6"]),
        (long, ["stand for too much text", "a.xdmf:6"]),
    ] {
        let found = error(text);
        says(&found, &words);
    }
}

#[test]
fn files_of_all_steps_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.xdmf");
    std::fs::write(folder.path().join("0.bin"), bytes(0.0)).unwrap();
    std::fs::write(folder.path().join("1.bin"), [bytes(0.0), bytes(5.0)].concat()).unwrap();
    let steps = tetrahedron("a", "0.bin", 0) + &tetrahedron("a", "1.bin", 80);
    let series = format!("<Grid GridType=\"Collection\" CollectionType=\"Temporal\">{steps}</Grid>");
    std::fs::write(&file, document(&series)).unwrap();
    let both = ["0.bin", "1.bin"].map(|name| folder.path().join(name));
    assert_eq!(files_beside(&file), both);
    assert_eq!(files_read_beside(&file, &Request::default()), both[..1]);
}

#[test]
fn lines_and_vertices_of_one_number_of_nodes_stand_beside_a_volume() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.xdmf");
    std::fs::write(folder.path().join("a.bin"), bytes(0.0)).unwrap();
    let flat = |kind: &str, nodes: &str, numbers: &str| {
        let count = numbers.split(' ').count();
        format!(
            "<Grid Name=\"{kind}\"><Topology TopologyType=\"{kind}\" NumberOfElements=\"2\" {nodes}>\
             <DataItem NumberType=\"Int\" Dimensions=\"{count}\">{numbers}</DataItem></Topology>\
             <Geometry><DataItem Dimensions=\"3 3\">0 0 0 1 0 0 2 0 0</DataItem></Geometry></Grid>"
        )
    };
    let grids = tetrahedron("a", "a.bin", 0)
        + &flat("Polyline", "NodesPerElement=\"2\"", "0 1 1 2")
        + &flat("Polyvertex", "", "0 2")
        + &flat("Polygon", "", "3 0 1 2 3 2 1 0");
    std::fs::write(&file, document(&grids)).unwrap();
    let found = inspect(&file, &Request::default(), &NoProgress).unwrap().cells_by_type;
    assert_eq!(found.into_iter().collect::<Vec<_>>(), [(2, 2), (4, 2), (7, 2), (10, 1)]);
    assert_eq!(read(&file, &request("s"), &NoProgress).unwrap().tetrahedra.len(), 1);
}
