//! Grids in parts: read one after the other for want of memory, or by several processes. Each gives the picture of the whole.

use super::graph;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::{NoObserver, Observer, RunReport, Session};
use voltet_nodes::session;
use voltet_testing::files::pieces::{SIDE, write_pieces};
use voltet_testing::thread_ranks::on_ranks;

/// Difference of any channel: rounding of sums of some hundred layers.
const SAME: f32 = 1e-6;

/// A pipeline whose numbers depend on the whole grid: its range, a percentile, its bounds, its diagonal; with light, two colours and g.
const PIPELINE: &str = r#"[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = "slabs.pvtu"
scalar = "t"

[nodes.gradient]
type = "gradient-magnitude"
inputs = { grid = "grid" }

[nodes.look]
type = "transfer-function"
inputs = { volume = "gradient" }

[[nodes.look.widgets]]
kind = "gaussian"
centre = ["p70", "p50"]
sigma = ["10%", "30%"]
extinction = 9.0
color = [1.0, 0.4, 0.1]

[[nodes.look.widgets]]
kind = "gaussian"
centre = ["20%", "40%"]
sigma = ["15%", "30%"]
extinction = 3.0
color = [0.1, 0.4, 1.0]

[nodes.view]
type = "camera"
view = "isometric"
inputs = { volume = "grid" }
size = [96, 80]

[nodes.picture]
type = "renderer"
engine = "cpu"
light = { direction = [1.0, 2.0, 3.0] }
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }

[nodes.out]
type = "image-writer"
path = "picture.exr"
inputs = { image = "picture" }
"#;

/// The same grid, whole and cut in three ways.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_pieces(path, "whole", 1, |_| 0);
    write_pieces(path, "slabs", 6, |[i, _, _]| (i * 6 / SIDE).min(5));
    // The last has no cells.
    write_pieces(path, "blocks", 9, |[i, j, k]| (i * 2 / SIDE) + 2 * (j * 2 / SIDE) + 4 * (k * 2 / SIDE));
    write_pieces(path, "random", 5, |[i, j, k]| (7 * i + 13 * j * j + 29 * k * i + k) % 5);
    folder
}

fn draw(folder: &Path, path: &str, scalar: &str, session: Session) -> Result<RunReport> {
    let text =
        PIPELINE.replace("slabs.pvtu", path).replace("scalar = \"t\"", &format!("scalar = \"{scalar}\""));
    let mut session = session;
    session.run(&graph(&text, folder)?, &NoObserver)
}

fn picture(report: &RunReport) -> &Picture {
    &report.pictures[0].1
}

/// Asserts that two pictures are the same but for rounding.
fn same(name: &str, one: &Picture, other: &Picture) {
    let pairs = one.rgba.as_flattened().iter().zip(other.rgba.as_flattened());
    let largest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    println!("{name}: {largest:e}");
    assert!(largest <= SAME, "{name}: {largest:e}");
}

#[test]
fn parts_make_the_picture_of_the_whole_grid() {
    let folder = folder();
    for scalar in ["t", "c"] {
        let whole = draw(folder.path(), "whole.pvtu", scalar, session()).unwrap();
        assert!(picture(&whole).rgba.iter().any(|pixel| pixel[3] > 0.1), "nothing is seen");
        for grid in ["slabs", "blocks", "random"] {
            // Each piece by itself; two or three at a time.
            for memory in [1, 300_000] {
                let session = session().with_memory(memory);
                let parts = draw(folder.path(), &format!("{grid}.pvtu"), scalar, session).unwrap();
                same(&format!("{grid}, {scalar}, {memory} bytes"), picture(&parts), picture(&whole));
                assert!(parts.counts["ray_stretches"] > 0);
                let [own, of_whole] =
                    [&parts, &whole].map(|report| report.origins.unit_distances[0].1.unwrap());
                assert!((own / of_whole - 1.0).abs() < 1e-12);
                assert_eq!(parts.counts["cells_total"], whole.counts["cells_total"]);
            }
        }
    }
}

/// A clip without numbers goes through the middle of the whole grid, or of what a node keeps of it, not of a part or of a process's share.
#[test]
fn a_clip_through_the_middle_is_that_of_all_parts() {
    let folder = folder();
    let threshold = "[nodes.kept]\ntype = \"threshold\"\narray = \"t\"\nrange = [0.9, 9.0]\ninputs = { volume = \"gradient\" }\n";
    for nodes in [PIPELINE.to_string(), with_nodes(threshold, "kept")] {
        let text = nodes.replace("engine = \"cpu\"\n", "engine = \"cpu\"\nclip = [{ kind = \"plane\" }]\n");
        let run = |text: &str, path: &str, mut session: Session| {
            let graph = graph(&text.replace("slabs.pvtu", path), folder.path()).unwrap();
            session.run(&graph, &NoObserver).unwrap()
        };
        let whole = run(&text, "whole.pvtu", session());
        assert!(picture(&whole).rgba.iter().any(|pixel| pixel[3] > 0.1), "nothing is seen");
        assert!(picture(&whole) != picture(&run(&nodes, "whole.pvtu", session())));
        same("slabs, clipped", picture(&run(&text, "slabs.pvtu", session().with_memory(1))), picture(&whole));
        let drawn = on_ranks(2, |ranks| run(&text, "slabs.pvtu", session().with_ranks(ranks)));
        same("two processes, clipped", picture(&drawn[0]), picture(&whole));
    }
}

/// Pieces out of view are not projected where rays are cast through the others: nothing is drawn again for them.
#[test]
fn pieces_out_of_view_are_drawn_once() {
    let folder = folder();
    let first_slab = "eye = [0.05, -3.0, 0.5]\ntarget = [0.05, 0.5, 0.5]\nup = [0.0, 0.0, 1.0]\nfov_y = 2.0";
    let view = "view = \"isometric\"\ninputs = { volume = \"grid\" }";
    let text = PIPELINE.replace(view, first_slab);
    assert_ne!(text, PIPELINE);
    let run = |path: &str, session: Session| {
        let mut session = session;
        let graph = graph(&text.replace("slabs.pvtu", path), folder.path()).unwrap();
        session.run(&graph, &NoObserver).unwrap()
    };
    let whole = run("whole.pvtu", session());
    assert!(picture(&whole).rgba.iter().any(|pixel| pixel[3] > 0.1), "nothing is seen");
    let parts = run("slabs.pvtu", session().with_memory(1));
    same("slabs", picture(&parts), picture(&whole));
    assert!(parts.counts["cells_cast"] > 0);
    let again = parts.findings.iter().find(|finding| finding.figures.get("rounds_drawn").is_some());
    assert!(again.is_none(), "{again:?}");
}

#[test]
fn processes_make_the_picture_of_one() {
    let folder = folder();
    for scalar in ["t", "c"] {
        let whole = draw(folder.path(), "whole.pvtu", scalar, session()).unwrap();
        for (grid, count) in [("slabs", 2), ("slabs", 7), ("blocks", 4), ("random", 3)] {
            let name = format!("{grid}, {scalar}, {count} processes");
            let path = format!("{grid}.pvtu");
            let drawn =
                on_ranks(count, |ranks| draw(folder.path(), &path, scalar, session().with_ranks(ranks)));
            let drawn: Vec<RunReport> = drawn.into_iter().map(|report| report.unwrap()).collect();
            // It is on the first of them.
            same(&name, picture(&drawn[0]), picture(&whole));
            assert!(drawn[1..].iter().all(|report| picture(report).rgba.iter().all(|p| *p == [0.0; 4])));
            // The first one's report is of all.
            assert_eq!(drawn[0].counts["cells_total"], whole.counts["cells_total"], "{name}");
            let [sent, least] = ["bytes_sent", "bytes_sent_least"].map(|name| drawn[0].counts[name]);
            assert!(0 < least && least < sent, "{name}: {sent} bytes, at least {least}");
            // Each piece once, by the process whose it is alone; these are no blocks.
            let pieces = match grid {
                "slabs" => 6,
                "blocks" => 8,
                _ => 5,
            };
            assert_eq!(drawn[0].counts["pieces_read"], pieces, "{name}");
            assert_eq!(drawn.iter().map(|report| report.files.len()).sum::<usize>(), drawn[0].files.len());
        }
    }
}

/// A far piece whose cells are small has not found its boundary when rays pay for all cells together; then all find theirs, and the choice
/// is that of one process. Where that of the whole grid is too large, cells are projected.
#[test]
fn processes_choose_with_the_whole_boundary() {
    let folder = folder();
    write_pieces(folder.path(), "halves", 2, |[i, _, _]| i * 2 / SIDE);
    let view = "view = \"isometric\"\ninputs = { volume = \"grid\" }\nsize = [96, 80]";
    let near_first = "eye = [-0.6, 0.5, 0.5]\ntarget = [0.5, 0.5, 0.5]\nup = [0.0, 0.0, 1.0]\nfov_y = 80.0\nsize = [24, 20]";
    let two_colors = PIPELINE.replace(view, near_first);
    assert_ne!(two_colors, PIPELINE);
    // Of one colour less pays.
    let one_color = two_colors.replace("[0.1, 0.4, 1.0]", "[1.0, 0.4, 0.1]");
    assert_ne!(one_color, two_colors);
    for (text, is_cast, rounds) in [(two_colors, true, 2.0), (one_color, false, 3.0)] {
        let mut has_revised = false;
        // Cells pay by their size in pixels: at some size those of the near half and all together.
        for width in (6..=24).step_by(2) {
            let text = text.replace("size = [24, 20]", &format!("size = [{width}, {width}]"));
            let run = |path: &str, session: Session| {
                let mut session = session;
                let graph = graph(&text.replace("slabs.pvtu", path), folder.path()).unwrap();
                session.run(&graph, &NoObserver).unwrap()
            };
            let name = format!("{width} pixels, {rounds} rounds");
            let whole = run("whole.pvtu", session());
            assert!(picture(&whole).rgba.iter().any(|pixel| pixel[3] > 0.1), "{name}: nothing is seen");
            let cast = whole.counts.get("cells_cast");
            let parts = run("halves.pvtu", session().with_memory(1));
            same(&format!("{name}, one after the other"), picture(&parts), picture(&whole));
            assert_eq!(parts.counts.get("cells_cast"), cast, "{name}, one after the other");
            let drawn = on_ranks(2, |ranks| run("halves.pvtu", session().with_ranks(ranks)));
            same(&format!("{name}, two processes"), picture(&drawn[0]), picture(&whole));
            assert_eq!(drawn[0].counts.get("cells_cast"), cast, "{name}, two processes");
            let drawn = parts.findings.iter().find_map(|finding| finding.figures.get("rounds_drawn"));
            let is_revised = drawn.and_then(|rounds| rounds.as_f64()) == Some(rounds);
            has_revised |= is_revised && cast.is_some_and(|cells| *cells > 0) == is_cast;
        }
        assert!(has_revised, "no size at which the choice was made in {rounds} rounds");
    }
}

/// Memory that ends once cells are composited.
#[derive(Default)]
struct EndingMemory(AtomicBool);

impl Observer for EndingMemory {
    fn progress(&self, _node: &str, stage: &str, _fraction: f64) {
        self.0.fetch_or(stage == "composite", Ordering::Relaxed);
    }

    fn memory_left(&self) -> Option<u64> {
        self.0.load(Ordering::Relaxed).then_some(1000)
    }
}

#[test]
fn stretches_beyond_memory_are_refused_before_they_are_sent() {
    let folder = folder();
    let drawn = on_ranks(2, |ranks| {
        let graph = graph(PIPELINE, folder.path()).unwrap();
        session().with_ranks(ranks).run(&graph, &EndingMemory::default())
    });
    let errors: Vec<String> = drawn.into_iter().map(|report| report.unwrap_err().to_string()).collect();
    assert!(errors.iter().any(|error| error.contains("the stretches of rays")), "{errors:?}");
}

/// The pipeline with nodes between the gradient and what looks at it.
fn with_nodes(nodes: &str, last: &str) -> String {
    let text = PIPELINE.replace("volume = \"gradient\"", &format!("volume = \"{last}\""));
    text.replace("[nodes.look]\n", &format!("{nodes}\n[nodes.look]\n"))
}

#[test]
fn nodes_give_for_parts_what_they_give_for_the_whole() {
    let folder = folder();
    let threshold = "[nodes.kept]\ntype = \"threshold\"\narray = \"t\"\nrange = [0.9, 9.0]\ninputs = { volume = \"gradient\" }\n";
    // It leaves nothing of the first slabs.
    let clipped = "[nodes.kept]\ntype = \"threshold\"\nclip = [{ kind = \"plane\", origin = [0.6, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }]\n\
                   inputs = { volume = \"gradient\" }\n";
    let scaled = "[nodes.twice]\ntype = \"calculator\"\nname = \"u\"\nexpression = \"2 * t + gradient_magnitude(t)\"\n\
                  inputs = { grid = \"grid\" }\n\n[nodes.kept]\ntype = \"gradient-magnitude\"\nmethod = \"quadratic-fit\"\n\
                  inputs = { grid = \"twice\" }\n";
    for nodes in [threshold, clipped, scaled] {
        let text = with_nodes(nodes, "kept");
        let run = |path: &str, session: Session| {
            let mut session = session;
            let graph = graph(&text.replace("slabs.pvtu", path), folder.path()).unwrap();
            session.run(&graph, &NoObserver).unwrap_or_else(|error| panic!("{path}: {error}\n{text}"))
        };
        let whole = run("whole.pvtu", session());
        assert!(picture(&whole).rgba.iter().any(|pixel| pixel[3] > 0.1), "nothing is seen");
        for grid in ["slabs", "blocks", "random"] {
            let parts = run(&format!("{grid}.pvtu"), session().with_memory(1));
            same(&format!("{grid}: {nodes}"), picture(&parts), picture(&whole));
        }
    }
}

#[test]
fn what_needs_the_whole_grid_is_refused_by_name() {
    let folder = folder();
    let fails = |from: &str, to: &str, wanted: &[&str]| {
        let text = PIPELINE.replace(from, to);
        assert_ne!(text, PIPELINE);
        let mut session = session().with_memory(1);
        let error = session.run(&graph(&text, folder.path()).unwrap(), &NoObserver).map(drop).unwrap_err();
        let error = error.to_string();
        wanted.iter().for_each(|part| assert!(error.contains(part), "{part}: {error}"));
    };
    fails("engine = \"cpu\"", "engine = \"cpu\"\norder = \"centroid\"", &["exact", "--memory"]);
    fails("engine = \"cpu\"", "engine = \"gpu\"", &["whole grids"]);
    fails(
        "[nodes.view]",
        "[nodes.copy]\ntype = \"grid-writer\"\npath = \"copy.vtu\"\ninputs = { volume = \"gradient\" }\n\n[nodes.view]",
        &["grid-writer", "whole grids"],
    );
    fails(
        "inputs = { volume = \"gradient\" }",
        "inputs = { volume = \"gradient\" }\nrelative_to = \"series\"",
        &["steps of a series"],
    );
    let threshold = |further: &str| {
        with_nodes(
            &format!(
                "[nodes.kept]\ntype = \"threshold\"\narray = \"t\"\n{further}\ninputs = {{ volume = \"gradient\" }}\n"
            ),
            "kept",
        )
    };
    let multi = "range = [0.9, 9.0]\ninputs = { volume = \"gradient\" }\n\n[nodes.again]\ntype = \"multi-gradient\"\nfields = [\"t\"]";
    for (text, wanted) in [
        (threshold("range = [\"p50\", \"100%\"]"), "relative to the whole: found \"p50\""),
        (
            threshold("clip = [{ kind = \"plane\" }]").replace("array = \"t\"\nclip", "clip"),
            "relative to the whole: found \"50 %\"",
        ),
        (threshold("range = [\"p50\", \"100%\"]\nrelative_to = \"series\""), "relative to the whole"),
        (
            threshold(multi)
                .replace("volume = \"gradient\" }\n\n[nodes.look]", "volume = \"kept\" }\n\n[nodes.look]")
                .replace("volume = \"kept\", transfer", "volume = \"again\", transfer"),
            "gradients after cells were dropped",
        ),
    ] {
        let built = graph(&text, folder.path()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let error = session().with_memory(1).run(&built, &NoObserver).map(drop).unwrap_err().to_string();
        assert!(error.contains(wanted), "{wanted}: {error}");
    }
}
