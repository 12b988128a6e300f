//! `voltet start`: from a data file to a picture in two commands.

use super::support::{Folder, cube};
use rayon::prelude::*;
use std::path::Path;
use voltet::core::grid::generate::Random;

/// The heat sink that ships.
fn heat_sink(folder: &Folder) -> String {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/heat_sink.vtu");
    std::fs::create_dir(folder.join("results")).unwrap();
    std::fs::copy(from, folder.join("results/heat_sink.vtu")).unwrap();
    "results/heat_sink.vtu".into()
}

fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn two_commands_give_a_picture_of_boundaries() {
    let folder = Folder::new();
    let data = heat_sink(&folder);
    folder.voltet(&["start", &data, "-o", "results/look.toml"]).ok();
    let text = read(&folder, "results/look.toml");
    // The data are named from where the pipeline file is.
    assert!(text.contains("path = \"heat_sink.vtu\"") && text.contains("scalar = \"Temperature\""), "{text}");
    assert_eq!(text.matches("kind = \"gaussian\"").count(), 5, "four boundaries and the haze: {text}");
    let plain = folder.voltet(&["start", &data, "-o", "-", "--plain"]).ok().stdout;
    assert!(text.contains("type = \"annotation\"") && !plain.contains("annotation"), "{text}\n{plain}");
    let small = ["run", "results/look.toml", "--set", "view.size=[160, 120]"];
    folder.voltet(&small).ok();
    let picture = image::open(folder.join("results/look.png")).unwrap().to_rgb8();
    let lit = picture.pixels().filter(|pixel| pixel.0.iter().any(|c| *c > 40)).count();
    let (least, most) = (picture.pixels().len() / 10, picture.pixels().len() * 9 / 10);
    assert!((least..most).contains(&lit), "{lit} of {} pixels are lit", picture.pixels().len());
}

/// Of a field whose volume spans decades the logarithm is looked at; of one that comes near 0 in a corner alone, the value.
#[test]
fn fields_over_decades_are_looked_at_by_their_logarithm() {
    let field = |value: &dyn Fn(f64) -> f64| {
        let points = (0..9).flat_map(|z| (0..9).flat_map(move |y| (0..9).map(move |x| (x, y, z))));
        let values: Vec<String> = points
            .map(|(x, y, z)| {
                value((f64::from(x) + 0.5 * f64::from(y) + 0.1 * f64::from(z)) / 12.8).to_string()
            })
            .collect();
        let head = "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 9 9 9\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 729\n";
        format!("{head}SCALARS k double 1\nLOOKUP_TABLE default\n{}\n", values.join(" "))
    };
    let folder = Folder::new();
    folder.write("decades.vtk", field(&|along| 10f64.powf(6.0 * along)));
    folder.write("corner.vtk", field(&|along| along.max(1e-9)));
    let said = folder.voltet(&["start", "decades.vtk"]).ok().stderr;
    assert!(said.contains("4 boundaries of 'k' found, on a logarithmic scale"), "{said}");
    let text = read(&folder, "decades.toml");
    assert!(text.contains("s_scale = \"log\"") && !text.contains("region"), "{text}");
    folder.voltet(&["run", "decades.toml", "--set", "view.size=[160, 120]"]).ok();
    let picture = image::open(folder.join("decades.png")).unwrap().to_rgb8();
    // Boundaries of the first decades and of the last are seen: blue and red.
    let is_seen = |of: usize, over: usize| {
        picture.pixels().any(|p| p.0[of] > 80 && u32::from(p.0[of]) > 2 * u32::from(p.0[over]))
    };
    assert!(is_seen(2, 0) && is_seen(0, 2), "not all decades are seen");
    let linear = folder.voltet(&["start", "corner.vtk", "-o", "-"]).ok().stdout;
    assert!(!linear.contains("s_scale"), "{linear}");
}

#[test]
fn a_file_that_is_there_is_kept_unless_forced() {
    let folder = Folder::new();
    folder.write("cube.vtu", cube(2));
    folder.write("cube.toml", "mine");
    folder.voltet(&["start", "cube.vtu"]).fails(2, &["is there already", "--force"]);
    assert_eq!(read(&folder, "cube.toml"), "mine");
    folder.voltet(&["start", "cube.vtu", "--force"]).ok();
    folder.voltet(&["check", "cube.toml"]).ok();
    let shown = folder.voltet(&["start", "cube.vtu", "-o", "-"]).ok().stdout;
    assert_eq!(shown, read(&folder, "cube.toml"));
}

#[test]
fn labels_and_constants_are_not_chosen() {
    let folder = Folder::new();
    let labelled = cube(2).replace("Name=\"layer\"", "Name=\"material_id\"");
    folder.write("cube.vtu", labelled);
    let text = folder.voltet(&["start", "cube.vtu", "-o", "-"]).ok().stdout;
    assert!(!text.contains("scalar = \"material_id\"") && !text.contains("scalar = \"ones\""), "{text}");
    folder
        .voltet(&["start", "cube.vtu", "-o", "-", "--scalar", "ones"])
        .fails(1, &["'ones' has no boundary"]);
}

#[test]
fn numbers_of_nodes_are_labels_and_a_command_that_is_shown_can_be_typed() {
    let folder = Folder::new();
    let labelled = tetrahedron("GlobalNodeId", 1.0, 1.0)
        .replace("</PointData>", "<DataArray type=\"Int32\" Name=\"count\">1 2 3 4</DataArray></PointData>")
        .replace("<DataArray type=\"Float64\" Name=\"Global", "<DataArray type=\"Int32\" Name=\"Global")
        .replace("0 0 1.0 1.0", "0 1 2 3");
    folder.write("my cube's.vtu", labelled);
    let said = folder.voltet(&["start", "my cube's.vtu"]).ok();
    assert!(said.stderr.contains(r"voltet run 'my cube'\''s.toml'"), "{}", said.stderr);
    let text = read(&folder, "my cube's.toml");
    assert!(text.contains("scalar = \"count\""), "{text}");
}

#[test]
fn of_a_scalar_that_is_named_nothing_else_is_decoded() {
    let folder = Folder::new();
    // One of the numbers of `y` is none.
    let whole = cube(2);
    let at = whole.find("Name=\"y\"").unwrap();
    let (head, tail) = whole.split_at(at + whole[at..].find('>').unwrap() + 1);
    folder.write("cube.vtu", format!("{head}broken {tail}"));
    folder.voltet(&["start", "cube.vtu", "-o", "-"]).fails(1, &["'y'"]);
    let text = folder.voltet(&["start", "cube.vtu", "-o", "-", "--scalar", "x"]).ok().stdout;
    assert!(text.contains("scalar = \"x\""), "{text}");
    let length = folder.voltet(&["start", "cube.vtu", "-o", "-", "--scalar", "gradient"]);
    length.fails(1, &["'gradient:magnitude' has no boundary"]);
}

/// A tetrahedron with two values, of a height.
fn tetrahedron(name: &str, height: f64, value: f64) -> String {
    format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\
             <PointData><DataArray type=\"Float64\" Name=\"{name}\">0 0 {value:?} {value:?}</DataArray></PointData>\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 {height}</DataArray></Points>\
             <Cells><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 3</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\">4</DataArray>\
             <DataArray type=\"UInt8\" Name=\"types\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
    )
}

#[test]
fn what_cannot_be_drawn_is_refused_and_a_name_of_two_lines_is_none() {
    let folder = Folder::new();
    folder.write("flat.vtu", tetrahedron("T", 0.0, 1.0));
    folder.voltet(&["start", "flat.vtu"]).fails(1, &["no cell has a volume", "not flat"]);
    folder.write("small.vtu", tetrahedron("T", 1.0, 1e-310));
    folder.voltet(&["start", "small.vtu"]).fails(1, &["'T' differ by less", "1e-310", "1e-300"]);
    folder.write("lines.vtu", tetrahedron("two&#10;lines", 1.0, 1.0));
    folder.voltet(&["start", "lines.vtu"]).ok();
    folder.voltet(&["check", "lines.toml"]).ok();
    let large = tetrahedron("T", 1.0, 1.0).replace("1 0 0 0 1 0 0 0", "1e150 0 0 0 1e150 0 0 0");
    folder.write("large.vtu", large);
    folder.voltet(&["start", "large.vtu"]).fails(1, &["extent", "1e90"]);
}

/// A grid drawn by lot: any scale, place, flatness, direction, type of numbers and association, with unused points and values that are none.
fn random_grid(random: &mut Random) -> String {
    let mut between = |low: f64, high: f64| low + (high - low) * random.next();
    let counts: [usize; 3] = std::array::from_fn(|_| between(2.0, 7.0) as usize);
    let scale = 10f64.powf(between(-9.0, 9.0));
    let aspect = if between(0.0, 1.0) < 0.5 { 0.5 } else { 2.0 };
    let sides: [f64; 3] = std::array::from_fn(|_| scale * 10f64.powf(between(-aspect, aspect)));
    let longest = sides.iter().copied().fold(0.0, f64::max);
    let far = if between(0.0, 1.0) < 0.5 { 0.0 } else { longest * 10f64.powf(between(0.0, 8.0)) };
    let offset: [f64; 3] = std::array::from_fn(|_| far * between(-1.0, 1.0));
    let direction: [f64; 3] = std::array::from_fn(|_| between(-1.0, 1.0));
    let angles: [f64; 2] = std::array::from_fn(|_| between(0.0, 6.3));
    let is_turned = between(0.0, 1.0) < 0.5;
    let turned = |[x, y, z]: [f64; 3]| {
        let [[s, c], [t, d]] = angles.map(|angle| [angle.sin(), angle.cos()]);
        let [x, y] = [c * x - s * y, s * x + c * y];
        [x, d * y - t * z, t * y + d * z]
    };
    let kind = between(0.0, 5.0) as usize;
    let (number_type, at_cells) = (between(0.0, 5.0) as usize, between(0.0, 1.0) < 0.3);
    let number_type = ["Float64", "Float32", "Int32", "UInt8", "Int64"][number_type];
    let (size, start) = (10f64.powf(between(-9.0, 9.0)), 10f64.powf(between(-4.0, 7.0)));
    let with_start = between(0.0, 1.0) < 0.5;
    let value = |x: [f64; 3], noise: f64| {
        let along: f64 = (0..3).map(|k| direction[k] * x[k]).sum();
        let f = match kind {
            0 => along,
            1 => (6.0 * along).sin(),
            2 => f64::from(along > 0.5 * direction.iter().sum::<f64>()),
            3 => (0..3).map(|k| (x[k] - 0.5).powi(2)).sum::<f64>().sqrt(),
            _ => noise,
        };
        match number_type {
            "Float64" if with_start => size * (f + start),
            "Float64" => size * f,
            "Float32" => size * f,
            _ => (100.0 + 60.0 * f).clamp(0.0, 255.0).round(),
        }
    };
    let n = counts.map(|n| n + 1);
    let mut points = Vec::new();
    let mut values = Vec::new();
    for point in 0..n[0] * n[1] * n[2] {
        let at = [point % n[0], point / n[0] % n[1], point / n[0] / n[1]];
        let x: [f64; 3] = std::array::from_fn(|k| at[k] as f64 / counts[k] as f64);
        let own: [f64; 3] = std::array::from_fn(|k| sides[k] * x[k]);
        let own = if is_turned { turned(own) } else { own };
        points.push(std::array::from_fn(|k| offset[k] + own[k]));
        values.push(value(x, between(-1.0, 1.0)));
    }
    // Points that no cell uses, as far away as the grid is long.
    for _ in 0..between(0.0, 3.0) as usize {
        points.push(offset.map(|x| x + 1000.0 * longest));
        values.push(1e30);
    }
    let mut cells = Vec::new();
    for cell in 0..counts[0] * counts[1] * counts[2] {
        let [i, j, k] = [cell % counts[0], cell / counts[0] % counts[1], cell / counts[0] / counts[1]];
        let corner = |[a, b, c]: [usize; 3]| (i + a) + n[0] * ((j + b) + n[1] * (k + c));
        cells.push(
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
                .map(corner),
        );
    }
    if at_cells {
        values = cells.iter().map(|corners| corners.iter().map(|&p| values[p]).sum::<f64>() / 8.0).collect();
        if !number_type.starts_with("Float") {
            values.iter_mut().for_each(|value| *value = value.round());
        }
    }
    if values.iter().all(|&value| value == values[0]) {
        values.iter_mut().zip(0..).for_each(|(value, i)| *value = f64::from(i % 200));
    }
    let bad = number_type.starts_with("Float") && between(0.0, 1.0) < 0.2;
    if bad {
        values[0] = f64::NAN;
    }
    let text =
        |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| format!("{x:?} ")).collect::<String>();
    let whole =
        |numbers: &mut dyn Iterator<Item = usize>| numbers.map(|x| format!("{x} ")).collect::<String>();
    let shown = match number_type.starts_with("Float") {
        true => text(&mut values.iter().copied()),
        false => whole(&mut values.iter().map(|&value| value.clamp(0.0, 255.0) as usize)),
    };
    let section = if at_cells { "CellData" } else { "PointData" };
    format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\
         <{section}><DataArray type=\"{number_type}\" Name=\"quantity\">{shown}</DataArray></{section}>\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">{}</DataArray></Points>\
         <Cells><DataArray type=\"Int64\" Name=\"connectivity\">{}</DataArray>\
         <DataArray type=\"Int64\" Name=\"offsets\">{}</DataArray>\
         <DataArray type=\"UInt8\" Name=\"types\">{}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
        points.len(),
        cells.len(),
        text(&mut points.iter().flatten().copied()),
        whole(&mut cells.iter().flatten().copied()),
        whole(&mut (1..=cells.len()).map(|cell| 8 * cell)),
        whole(&mut cells.iter().map(|_| 12)),
    )
}

/// Two commands draw any grid: all of it, in the middle of the picture, and something of it is seen.
#[test]
fn any_grid_is_seen_whole() {
    let folder = Folder::new();
    let count = if voltet_testing::whole_series() { 300 } else { 50 };
    let drawn = |number: u64| {
        let mut random = Random(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        for _ in 0..8 {
            let _ = random.next();
        }
        let [data, scene, picture] = ["vtu", "toml", "png"].map(|ending| format!("{number}.{ending}"));
        folder.write(&data, random_grid(&mut random));
        // With what is written over it, and the picture alone.
        for (options, [width, height]) in
            [(&["--force"][..], [240, 180]), (&["--force", "--plain"], [96, 72])]
        {
            folder.voltet(&[&["start", &data, "-o", &scene], options].concat()).ok();
            let size = format!("view.size=[{width}, {height}]");
            folder.voltet(&["run", &scene, "--set", &size, "--set", "picture.engine=cpu"]).ok();
            let seen = image::open(folder.join(&picture)).unwrap().to_rgb8();
            let is_lit = |pixel: &image::Rgb<u8>| pixel.0.iter().any(|&channel| channel > 0);
            let lit = seen.pixels().filter(|pixel| is_lit(pixel)).count() as f64 / f64::from(width * height);
            let text = || read(&folder, &scene);
            assert!((0.1..0.98).contains(&lit), "{data}: {lit} of the picture is lit\n{}", text());
            let at_border = |x: u32, y: u32| x == 0 || y == 0 || x == width - 1 || y == height - 1;
            let cut =
                seen.enumerate_pixels().filter(|(x, y, pixel)| at_border(*x, *y) && is_lit(pixel)).count();
            assert_eq!(cut, 0, "{data}: pixels at the border are lit\n{}", text());
        }
        for name in [data, scene, picture] {
            std::fs::remove_file(folder.join(&name)).unwrap();
        }
    };
    (0..count).into_par_iter().for_each(drawn);
}

/// One rule chooses the array of `start` and of `info`, what the editor has a reader name, and what that then reads.
#[test]
fn one_array_is_the_first_for_all() {
    use voltet::core::progress::NoProgress;
    use voltet::io::formats::{Association, Request, inspect, read};
    let data = |kept: &[&str], marks: &str| {
        let text = cube(3).replace("<PointData>", &format!("<PointData {marks}>"));
        let (head, arrays) = text.split_once("<PointData").unwrap();
        let (arrays, rest) = arrays.split_once("</CellData>").unwrap();
        let is_kept = |line: &&str| {
            !line.contains("<DataArray") || kept.iter().any(|name| line.contains(&format!("Name=\"{name}\"")))
        };
        let arrays: Vec<&str> = arrays.lines().filter(is_kept).collect();
        format!("{head}<PointData{}\n</CellData>{rest}", arrays.join("\n"))
    };
    let folder = Folder::new();
    for (kept, marks, wanted, is_named) in [
        (&["ones", "y"][..], "", "y", true),
        (&["x", "y"], "Scalars=\"y\"", "y", false),
        (&["x", "y"], "Scalars=\"gone\"", "x", true),
        (&["ones", "y"], "Scalars=\"ones\"", "y", true),
        (&["y", "layer"], "Scalars=\"layer\"", "layer", false),
        (&["layer", "ones", "gradient"], "", "layer", true),
        (&["y"], "", "y", false),
    ] {
        let case = format!("{kept:?} {marks}");
        let text = data(kept, marks);
        folder.write("data.vtu", &text);
        let path = folder.join("data.vtu");
        let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
        assert_eq!(summary.first_quantity().unwrap().scalar, wanted, "{case}");
        let named = summary.to_be_named(None);
        assert_eq!(named.as_ref().map(|named| named.scalar.as_str()), is_named.then_some(wanted), "{case}");
        let of = |scalar: Option<String>| {
            let request = Request { scalar, ..Request::default() };
            read(&path, &request, &NoProgress).unwrap().scalar.unwrap().to_vec()
        };
        assert_eq!(of(named.map(|named| named.scalar)), of(Some(wanted.into())), "{case}");
        let key = format!("scalar = \"{wanted}\"");
        let started = folder.voltet(&["start", "data.vtu", "-o", "-"]).ok().stdout;
        let suggested = folder.voltet(&["info", "data.vtu"]).ok().stdout;
        assert!(started.contains(&key) && suggested.contains(&key), "{case}\n{started}\n{suggested}");
    }
    folder.write("data.vtu", data(&["x", "y", "layer"], ""));
    let of_cells = Request { association: Some(Association::Cell), ..Request::default() };
    let summary = inspect(&folder.join("data.vtu"), &of_cells, &NoProgress).unwrap();
    assert_eq!(summary.to_be_named(of_cells.association), None, "the only array of the cells");
    let of_points = summary.to_be_named(Some(Association::Point)).unwrap();
    assert_eq!(of_points.scalar, "x");
}
