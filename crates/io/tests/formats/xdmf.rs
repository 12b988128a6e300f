//! XDMF files as meshio writes them, and in the layouts of DOLFIN and DOLFINx, against the same grids in .vtu files and against
//! formulas.

use super::packed::{field, follow, grid, grid_at, path, request, same_files};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, files_beside, inspect, read, steps};

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
        assert_eq!(steps(&path(&name), &Request::default()).unwrap(), (2, 0), "{name}");
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
        let error = read(&file, &request, &NoProgress).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    refused("xdmf_dolfin.h5:", "no.h5:", &["no.h5", "no such file"]);
    refused("VisualisationVector/T1", "no/T1", &["xdmf_dolfin.h5", "'/no'"]);
    refused("Mesh/0/mesh/topology", "Mesh/0/mesh/no", &["xdmf_dolfin.h5", "'/Mesh/0/mesh/no'"]);
    refused("TimeSeries_T&quot;", "no&quot;", &["not there", "@Name=\"no\""]);
    refused("xi:include xpointer", "xi:include href=\"b.xml\" xpointer", &["b.xml", "not followed"]);
    refused("/*[self::Topology", "/*[position() = 1 or self::Topology", &["not read", "[number]"]);
    let circle = "/Grid[2]/include".replace("include", "xi:include");
    refused("/Grid[1]/*[self::Topology or self::Geometry]", &circle, &["includes itself"]);
    refused("Dimensions=\"12 1\"", "Dimensions=\"13 1\"", &["other dimensions", "[12, 1]"]);
}
