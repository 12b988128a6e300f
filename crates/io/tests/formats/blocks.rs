//! Files of blocks: trees of data sets, parts of series, grids of PLOT3D; which blocks are read, and what is said of the others.

use voltet_core::grid::Grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{BLOCK, Request, files_beside, files_read_beside, inspect, read, unread};
use voltet_testing::files::samples::{file, unstructured};
use voltet_testing::files::xml::encodings;
use voltet_testing::files::{legacy, plot3d};

fn request(scalar: &str, blocks: &[&str]) -> Request {
    let blocks = blocks.iter().map(|name| name.to_string()).collect();
    let cell_arrays = vec![BLOCK.to_owned()];
    Request { scalar: Some(scalar.to_owned()), blocks, cell_arrays, ..Request::default() }
}

/// Files of rows of cubes, the first ones without the array `Int8`; surfaces.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    for cubes in 1..=4 {
        let text = String::from_utf8(unstructured(encodings()[0], cubes, false)).unwrap();
        let text = if cubes == 1 { text.replace("Name=\"Int8\"", "Name=\"other\"") } else { text };
        file(&folder, &format!("parts/{cubes}.vtu"), text.as_bytes());
    }
    file(&folder, "parts/wall.vtp", b"<VTKFile type=\"PolyData\"><PolyData/></VTKFile>");
    let flat = "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\">\
        <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points>\
        <Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>\
        <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>\
        <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
    file(&folder, "parts/flat.vtu", flat.as_bytes());
    folder
}

/// Six tetrahedra a cube: cubes of each block.
fn cubes(grid: &Grid) -> Vec<(String, usize)> {
    let numbers = &grid.cell_arrays[BLOCK].values;
    let of = |block: usize| {
        let is_own = |&i: &usize| numbers[grid.source_cell(i)] == block as f64;
        (0..grid.tetrahedra.len()).filter(is_own).count() / 6
    };
    let names = grid.origin.blocks.iter().enumerate();
    names.map(|(block, name)| (name.clone(), of(block))).filter(|entry| entry.1 > 0).collect()
}

fn named(blocks: &[(&str, usize)]) -> Vec<(String, usize)> {
    blocks.iter().map(|&(name, count)| (name.to_owned(), count)).collect()
}

const TREE: &str = "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet>\
    <Block index=\"0\" name=\"fluid\"><DataSet index=\"0\" name=\"rotor\" file=\"parts/2.vtu\"/>\
    <DataSet index=\"1\" name=\"stator\" file=\"parts/3.vtu\"/><DataSet index=\"2\"/></Block>\
    <Block index=\"1\"><Piece index=\"0\" name=\"shaft\"><DataSet index=\"0\" file=\"parts/4.vtu\"/>\
    <DataSet index=\"1\" file=\"parts/4.vtu\"/></Piece></Block>\
    <DataSet index=\"2\" name=\"wall\" file=\"parts/wall.vtp\"/><DataSet index=\"3\" name=\"flat\" file=\"parts/flat.vtu\"/>\
    </vtkMultiBlockDataSet></VTKFile>";

#[test]
fn trees_are_read_by_the_names_of_their_blocks() {
    let folder = folder();
    let path = file(&folder, "a.vtm", TREE.as_bytes());
    let of = |blocks: &[&str]| read(&path, &request("Int8", blocks), &NoProgress).unwrap();
    let all = of(&[]);
    let expected = named(&[("fluid/rotor", 2), ("fluid/stator", 3), ("block 1/shaft", 8)]);
    assert_eq!(cubes(&all), expected);
    assert_eq!(all.origin.blocks[2..], ["fluid/block 2", "block 1/shaft", "wall", "flat"]);
    // Points of different blocks stay apart, those of pieces of one do not.
    assert_eq!((all.points.len(), all.origin.points_joined), (12 + 16 + 20, 20));
    let [surface, flat, ..] = &all.origin.warnings[..] else { panic!("{:?}", all.origin.warnings) };
    assert!(surface.contains("surfaces") && surface.contains("'wall'"), "{surface}");
    assert!(flat.contains("three dimensions") && flat.contains("'flat'"), "{flat}");

    assert_eq!(cubes(&of(&["fluid"])), expected[..2]);
    assert_eq!(cubes(&of(&["*tor"])), expected[..2]);
    assert_eq!(cubes(&of(&["fluid/stator", "*shaft"])), expected[1..]);
    assert!(!of(&["fluid"]).origin.warnings.iter().any(|warning| warning.contains("left out")));
    // Files of other blocks are not opened.
    let chosen = request("Int8", &["fluid/rotor"]);
    assert_eq!(files_read_beside(&path, &chosen), [folder.path().join("parts/2.vtu")]);
    assert_eq!(files_beside(&path).len(), 6);
    std::fs::remove_file(folder.path().join("parts/4.vtu")).unwrap();
    assert_eq!(cubes(&of(&["fluid"])), expected[..2]);
    let missing = read(&path, &request("Int8", &[]), &NoProgress).unwrap_err().to_string();
    assert!(missing.contains("a.vtm' names") && missing.contains("no such file"), "{missing}");
    let unknown = read(&path, &request("Int8", &["fluid/roter"]), &NoProgress).unwrap_err().to_string();
    assert!(unknown.contains("'fluid/rotor', the nearest") && unknown.contains("a.vtm"), "{unknown}");
    let walls = read(&path, &request("Int8", &["wall"]), &NoProgress).unwrap_err().to_string();
    assert!(walls.contains("no block holds a volume grid"), "{walls}");
}

#[test]
fn blocks_without_the_scalar_are_left_out_and_named() {
    let folder = folder();
    let tree = TREE.replace("parts/2.vtu", "parts/1.vtu");
    let path = file(&folder, "a.vtm", tree.as_bytes());
    let of = |scalar: &str| read(&path, &request(scalar, &[]), &NoProgress).unwrap();
    let most = of("Int8");
    assert_eq!(cubes(&most), named(&[("fluid/stator", 3), ("block 1/shaft", 8)]));
    assert!(most.origin.warnings[2].contains("lacks the array 'Int8'"), "{:?}", most.origin.warnings);
    assert!(most.origin.warnings[2].contains("'fluid/rotor'"), "{:?}", most.origin.warnings);
    let one = of("other");
    assert_eq!(cubes(&one), named(&[("fluid/rotor", 1)]));
    assert!(one.origin.warnings[2].contains("Blocks lack"), "{:?}", one.origin.warnings);
    let none = read(&path, &request("Int8", &["fluid/rotor"]), &NoProgress).unwrap_err().to_string();
    assert!(none.contains("the file holds no array 'Int8'"), "{none}");
    // The numbers of blocks are no array of the file, and none that is drawn unless it is named.
    assert!(!unread(&path, &request("Int8", &[])).unwrap().arrays.contains(&BLOCK.to_owned()));
    let own = Request { scalar: Some(BLOCK.into()), ..Request::default() };
    assert_eq!(read(&path, &own, &NoProgress).unwrap().scalar.unwrap().first(), Some(&0.0));
}

#[test]
fn summaries_count_the_cells_of_each_block() {
    let folder = folder();
    let path = file(&folder, "a.vtm", TREE.as_bytes());
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let counts: Vec<(&str, u64)> =
        summary.blocks.iter().map(|block| (&*block.name, block.cell_count())).collect();
    let expected = [
        ("fluid/rotor", 12),
        ("fluid/stator", 18),
        ("fluid/block 2", 0),
        ("block 1/shaft", 48),
        ("wall", 0),
        ("flat", 1),
    ];
    assert_eq!(counts, expected);
    assert!(summary.arrays.iter().any(|array| array.head.name == BLOCK));
    assert!(summary.quantities().all(|array| array.head.name != BLOCK));
}

#[test]
fn parts_of_a_series_are_blocks() {
    let folder = folder();
    file(&folder, "a.vtm", TREE.as_bytes());
    let series = |parts: &str| {
        file(
            &folder,
            "a.pvd",
            format!("<VTKFile type=\"Collection\"><Collection>{parts}</Collection></VTKFile>").as_bytes(),
        )
    };
    let unnamed = "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"parts/2.vtu\"/>\
        <DataSet timestep=\"0\" part=\"1\" file=\"parts/2.vtu\"/>";
    let grid = read(&series(unnamed), &request("Int8", &[]), &NoProgress).unwrap();
    // Pieces of one grid, whose points are one.
    assert_eq!((cubes(&grid), grid.points.len()), (named(&[("part 0", 2), ("part 1", 2)]), 12));
    let grid = read(&series(unnamed), &request("Int8", &["part 1"]), &NoProgress).unwrap();
    assert_eq!(cubes(&grid), named(&[("part 1", 2)]));
    let names = unnamed.replace("part=\"1\"", "part=\"1\" name=\"hub\"");
    let grid = read(&series(&names), &request("Int8", &[]), &NoProgress).unwrap();
    assert_eq!((cubes(&grid), grid.points.len()), (named(&[("part 0", 2), ("hub", 2)]), 24));
    let trees = "<DataSet timestep=\"0\" name=\"turbine\" file=\"a.vtm\"/><DataSet timestep=\"0\" name=\"box\" file=\"parts/2.vtu\"/>";
    let grid = read(&series(trees), &request("Int8", &["turbine/fluid", "box"]), &NoProgress).unwrap();
    assert_eq!(cubes(&grid), named(&[("turbine/fluid/rotor", 2), ("turbine/fluid/stator", 3), ("box", 2)]));
    let tree = "<DataSet timestep=\"0\" file=\"a.vtm\"/>";
    let path = series(tree);
    let grid = read(&path, &request("Int8", &["fluid/rotor"]), &NoProgress).unwrap();
    assert_eq!(cubes(&grid), named(&[("fluid/rotor", 2)]));
    assert_eq!(files_read_beside(&path, &request("Int8", &["fluid/rotor"])).len(), 2);
    assert_eq!(files_beside(&path).len(), 7);
    // One file alone has no blocks.
    let single = series("<DataSet timestep=\"0\" file=\"parts/2.vtu\"/>");
    assert_eq!(inspect(&single, &Request::default(), &NoProgress).unwrap().blocks, []);
    let none = read(&single, &request("Int8", &["a"]), &NoProgress).unwrap_err().to_string();
    assert!(none.contains("have no blocks"), "{none}");
}

#[test]
fn partitioned_collections_are_blocks_of_pieces() {
    let folder = folder();
    let text = "<VTKFile type=\"vtkPartitionedDataSetCollection\"><vtkPartitionedDataSetCollection>\
        <Partitions index=\"0\" name=\"a\"><DataSet index=\"0\" file=\"parts/2.vtu\"/><DataSet index=\"1\" file=\"parts/2.vtu\"/></Partitions>\
        <Partitions index=\"1\" name=\"b\"><DataSet index=\"0\" file=\"parts/3.vtu\"/></Partitions>\
        </vtkPartitionedDataSetCollection></VTKFile>";
    let grid = read(&file(&folder, "a.vtpc", text.as_bytes()), &request("Int8", &[]), &NoProgress).unwrap();
    assert_eq!((cubes(&grid), grid.points.len()), (named(&[("a", 4), ("b", 3)]), 12 + 16));
}

#[test]
fn more_files_than_a_program_may_open_are_read() {
    let folder = folder();
    let leaf = |i: usize| format!("<DataSet index=\"{i}\" file=\"parts/{}.vtu\"/>", 2 + i % 3);
    let leaves: String = (0..1500).map(leaf).collect();
    let text = format!(
        "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet>{leaves}</vtkMultiBlockDataSet></VTKFile>"
    );
    let grid = read(&file(&folder, "a.vtm", text.as_bytes()), &request("Int8", &[]), &NoProgress).unwrap();
    assert_eq!(grid.tetrahedra.len(), 1500 * 3 * 6);
}

#[test]
fn grids_of_plot3d_are_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let layout = plot3d::layouts().find(|layout| plot3d::grids(*layout).len() > 1).unwrap();
    let path = file(&folder, "a.xyz", &plot3d::grid_file(layout));
    file(&folder, "a.q", &plot3d::solution_file(layout));
    let of = |blocks: &[&str]| read(&path, &request("density", blocks), &NoProgress).unwrap();
    let (all, second) = (of(&[]), of(&["grid 2"]));
    assert!(second.tetrahedra.len() < all.tetrahedra.len());
    assert!(second.cell_arrays[BLOCK].values.iter().all(|&block| block == 1.0));
}

#[test]
fn a_cell_array_of_that_name_is_kept_and_files_without_blocks_have_none() {
    let folder = folder();
    let text = String::from_utf8(unstructured(encodings()[0], 2, false)).unwrap();
    file(&folder, "parts/2.vtu", text.replace("Name=\"cell\"", "Name=\"block\"").as_bytes());
    let path = file(&folder, "a.vtm", TREE.as_bytes());
    let grid = read(&path, &request("Int8", &["fluid/rotor"]), &NoProgress).unwrap();
    assert_eq!(cubes(&grid), named(&[("fluid/rotor", 2)]));
    assert!(grid.origin.warnings[0].contains("'block (of the file)'"), "{:?}", grid.origin.warnings);
    let alone = folder.path().join("parts/2.vtu");
    assert_eq!(read(&alone, &request("Int8", &[]), &NoProgress).unwrap().cell_arrays[BLOCK].values[5], 5.0);
    let old = file(&folder, "a.vtk", &legacy::unstructured("4.2", false));
    let error = read(&old, &request("double", &["a"]), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("have no blocks") && error.contains("a.vtk"), "{error}");
}
