//! A simulation of several processes, which are threads here: one picture, and failures that all of them see.

use crate::drawn::temperature;
use crate::library::{PIPELINE, assert_same, folder, picture, start, step};
use crate::steps::two_grids;
use crate::tree::Tree;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_graph::ranks::{OneRank, Ranks};
use voltet_testing::thread_ranks::on_ranks;

/// Largest difference of any channel: rounding of sums of some hundred layers.
pub const SAME: f32 = 1e-6;

/// Cells along the longest side of the box of the tests.
const SIDE: usize = 8;

/// The part of a box of cubes between two layers along x, as a domain of its own.
fn slab(tree: Tree, [from, to]: [usize; 2]) -> Tree {
    let at = |i: usize| i as f64 / 4.0;
    let layers: Vec<f64> = (from..=to).map(at).collect();
    let side: Vec<f64> = (0..=SIDE / 2).map(at).collect();
    let rows = side.iter().flat_map(|z| side.iter().map(move |y| [*y, *z]));
    let values: Vec<f64> = rows
        .flat_map(|[y, z]| layers.iter().map(move |x| temperature([*x, y, z]) + 0.1 * (3.0 * x * y).sin()))
        .collect();
    let tree = tree.text("coordsets/coords/type", "rectilinear").array("coordsets/coords/values/x", layers);
    let tree = tree.array("coordsets/coords/values/y", side.clone()).array("coordsets/coords/values/z", side);
    let tree = tree.text("topologies/mesh/type", "rectilinear").text("topologies/mesh/coordset", "coords");
    let tree = tree.text("fields/T/association", "vertex").text("fields/T/topology", "mesh");
    tree.array("fields/T/values", values)
}

/// Layers of a rank's domains: two of each, and nothing on a rank after the first three.
fn domains(rank: usize, count: usize) -> Vec<[usize; 2]> {
    let busy = count.min(3);
    if rank >= busy {
        return vec![[0, 0]];
    }
    let (from, to) = (SIDE * rank / busy, SIDE * (rank + 1) / busy);
    let middle = (from + to) / 2;
    vec![[from, middle], [middle, to]]
}

fn describe(tree: Tree, domains: &[[usize; 2]]) -> Tree {
    let data = "catalyst/channels/grid/data";
    domains.iter().filter(|own| own[0] < own[1]).fold(tree.within("").fetch(data), |tree, own| {
        slab(tree.within(&format!("{data}/domain_{}", own[0])), *own)
    })
}

#[test]
fn several_processes_draw_the_picture_of_one() {
    // The picture's numbers are those of the whole mesh.
    let pipeline =
        PIPELINE.replace("[0.5, 1.0]", "[\"60%\", \"30%\"]").replace("[0.3, 1.5]", "[\"15%\", \"40%\"]");
    for count in [1, 2, 3, 5] {
        let alone = folder(&pipeline);
        let mut simulation = start(alone.path()).simulation(Arc::new(OneRank)).unwrap();
        let all: Vec<[usize; 2]> = (0..count).flat_map(|rank| domains(rank, count)).collect();
        step(0, |tree| describe(tree, &all)).execute(&mut simulation).unwrap();
        let expected = picture(&alone.path().join("000.exr"));
        assert!(expected.rgba.iter().any(|pixel| pixel[3] > 0.1), "something is seen");
        let folder = folder(&pipeline);
        let outcomes = on_ranks(count, |ranks| {
            let rank = ranks.rank();
            let mut simulation = start(folder.path()).simulation(ranks)?;
            (0..2).try_for_each(|number| {
                step(number, |tree| describe(tree, &domains(rank, count))).execute(&mut simulation)
            })
        });
        let failures: Vec<String> =
            outcomes.into_iter().filter_map(|outcome| Some(outcome.err()?.to_string())).collect();
        assert!(failures.is_empty(), "{failures:#?}");
        let found = picture(&folder.path().join("000.exr"));
        if count == 1 {
            assert_same(&found, &expected);
        }
        let largest = largest_difference(&found, &expected);
        println!("{count} processes: largest difference {largest:e}");
        assert!(largest <= SAME, "{count} processes: {largest}");
        assert_same(&picture(&folder.path().join("001.exr")), &found);
    }
}

#[test]
fn a_failure_of_one_process_ends_the_step_of_all() {
    let apart = [0, 1, 2].map(|rank| {
        let own = folder(&PIPELINE.replace("{step:03}", "sub/{step:03}"));
        let sub = own.path().join("sub");
        // The first one has a file in the folder's place.
        if rank == 0 {
            std::fs::write(sub, "").unwrap()
        } else {
            std::fs::create_dir(sub).unwrap()
        };
        own
    });
    let folder = folder(PIPELINE);
    let errors = on_ranks(3, |ranks| {
        let rank = ranks.rank();
        let mut simulation = start(folder.path()).simulation(ranks.clone()).unwrap();
        let own = domains(rank, 3);
        // A mesh that is wrong on one process.
        let wrong = step(0, |tree| {
            let tree = describe(tree, &own);
            let path = format!("catalyst/channels/grid/data/domain_{}/fields/T/values", own[0][0]);
            if rank == 1 { tree.within("").array(&path, vec![0.0_f64]) } else { tree }
        });
        let first = wrong.execute(&mut simulation).unwrap_err().to_string();
        // A file that the first process alone cannot write, when the others draw already.
        let mut failing = start(apart[rank].path()).simulation(ranks.clone()).unwrap();
        let second = step(1, |tree| describe(tree, &own)).execute(&mut failing).unwrap_err().to_string();
        step(2, |tree| describe(tree, &own)).execute(&mut simulation).unwrap();
        [first, second]
    });
    for (rank, [first, second]) in errors.iter().enumerate() {
        let [other, missing] = ["another process failed: found rank", "fields/T/values has the wrong number"];
        assert!(first.contains(if rank == 1 { missing } else { other }), "{rank}: {first}");
        assert!(second.contains("another process failed: found rank 0") == (rank > 0), "{rank}: {second}");
    }
    assert!(folder.path().join("002.exr").is_file());
}

#[test]
fn a_mesh_without_cells_on_any_process_is_refused() {
    let folder = folder(PIPELINE);
    let errors = on_ranks(2, |ranks| {
        let mut simulation = start(folder.path()).simulation(ranks).unwrap();
        let nothing = step(0, |tree| tree).within("").fetch("catalyst/channels/grid/data");
        nothing.execute(&mut simulation).unwrap_err().to_string()
    });
    assert!(errors.iter().all(|error| error.contains("no process has a domain of the mesh")), "{errors:?}");
}

#[test]
fn a_pipeline_of_several_processes_takes_one_channel() {
    let folder = folder(&two_grids());
    let errors = on_ranks(2, |ranks| {
        let own = domains(ranks.rank(), 2);
        let mut simulation = start(folder.path()).simulation(ranks).unwrap();
        let both = step(0, |tree| describe(tree, &own)).text("catalyst/channels/rest/type", "mesh");
        both.execute(&mut simulation).unwrap_err().to_string()
    });
    assert!(errors.iter().all(|error| error.contains("several channels of several processes")), "{errors:?}");
}

/// Largest difference of a channel of two pictures.
fn largest_difference(one: &Picture, other: &Picture) -> f32 {
    let both = one.rgba.as_flattened().iter().zip(other.rgba.as_flattened());
    both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The picture of a step whose ranks describe their meshes; in that of one process all meshes are there.
fn picture_of(
    pipeline: &str,
    count: usize,
    describe: impl Fn(Tree, std::ops::Range<usize>) -> Tree + Sync,
) -> [Picture; 2] {
    let [alone, together] = [folder(pipeline), folder(pipeline)];
    let mut simulation = start(alone.path()).simulation(Arc::new(OneRank)).unwrap();
    step(0, |tree| describe(tree, 0..count)).execute(&mut simulation).unwrap();
    on_ranks(count, |ranks| {
        let rank = ranks.rank();
        let mut simulation = start(together.path()).simulation(ranks).unwrap();
        step(0, |tree| describe(tree, rank..rank + 1)).execute(&mut simulation).unwrap();
    });
    let pictures = [alone, together].map(|folder| picture(&folder.path().join("000.exr")));
    assert!(pictures[0].rgba.iter().any(|pixel| pixel[3] > 0.1), "something is seen");
    pictures
}

#[test]
fn a_block_is_its_name_on_every_process() {
    // The numbers of the picture are stated: a part has no others.
    let data = "catalyst/channels/grid/data";
    let [alone, together] = picture_of(PIPELINE, 2, |tree, ranks| {
        let tree = tree.within("").text("catalyst/channels/grid/type", "multimesh");
        ranks.fold(tree, |tree, rank| match rank {
            0 => {
                let tree = slab(tree.within(&format!("{data}/fluid/domain_0")), [0, 3]);
                slab(tree.within(&format!("{data}/solid/domain_0")), [3, 5])
            }
            _ => slab(tree.within(&format!("{data}/solid/domain_1")), [5, 8]),
        })
    });
    let largest = largest_difference(&alone, &together);
    assert!(largest <= SAME, "{largest}");
}

#[test]
fn a_process_whose_domains_lack_the_field_has_no_part() {
    let [alone, together] = picture_of(PIPELINE, 2, |tree, ranks| {
        ranks.fold(tree.within(""), |tree, rank| {
            let at = format!("catalyst/channels/grid/data/domain_{rank}");
            let tree = slab(tree.within(&at), [4 * rank, 4 * rank + 4]);
            if rank == 1 { tree.text("fields/T/topology", "skin") } else { tree }
        })
    });
    let largest = largest_difference(&alone, &together);
    assert!(largest <= SAME, "{largest}");
}

#[test]
fn processes_that_state_different_things_are_refused_together() {
    let folder = folder(PIPELINE);
    let started = |ranks: Arc<dyn Ranks>, unit: usize| {
        let path = folder.path().join("scene.toml");
        let tree = Tree::new().text("catalyst/scripts/a/filename", path.to_str().unwrap());
        let tree = tree.append("catalyst/scripts/a/args", "every=10");
        tree.append("catalyst/scripts/a/args", &format!("look.unit_distance={unit}.5")).simulation(ranks)
    };
    let errors = on_ranks(2, |ranks| {
        let (rank, own) = (ranks.rank(), domains(ranks.rank(), 2));
        let first = started(ranks.clone(), 1 + rank).err().unwrap().to_string();
        let mut simulation = started(ranks, 1).unwrap();
        let at = |number: usize| step(number as i64, |tree| describe(tree, &own));
        let second = at(10 + rank).execute(&mut simulation).unwrap_err().to_string();
        at(20).execute(&mut simulation).unwrap();
        [first, second]
    });
    for [first, second] in errors {
        let what = "the processes state different steps, pipelines or channels";
        assert!(
            first.contains(what)
                && first.contains("rank 0: unit_distance = 1.5; rank 1: unit_distance = 2.5"),
            "{first}"
        );
        let steps = "rank 0: step 10, time 2.5; rank 1: step 11, time 2.75";
        assert!(second.contains(what) && second.contains(steps), "{second}");
    }
    assert!(folder.path().join("020.exr").exists());
}

/// Values of a field that is not drawn leave no cell out, in as many processes as it may be.
#[test]
fn a_field_that_another_pipeline_draws_leaves_nothing_out() {
    // All of the first process, and of the second where it meets none of it.
    let mask = |tree: Tree, [from, to]: [usize; 2], value: f64| {
        let row = (from..=to).map(|layer| if layer < 6 { value } else { 1.0 });
        let values = std::iter::repeat_n(row, (SIDE / 2 + 1).pow(2)).flatten().collect();
        let tree = tree.text("fields/mask/association", "vertex").text("fields/mask/topology", "mesh");
        tree.array::<f64>("fields/mask/values", values)
    };
    let other = PIPELINE.replace("{step:03}", "other{step:03}").replace("\"T\"", "\"mask\"");
    assert!(other.contains("\"mask\""), "a pipeline that draws the other field");
    let drawn = |value: f64| {
        let folder = folder(PIPELINE);
        std::fs::write(folder.path().join("other.toml"), &other).unwrap();
        on_ranks(2, |ranks| {
            let rank = ranks.rank();
            let path = folder.path().join("other.toml");
            let tree = start(folder.path()).text("catalyst/scripts/other/filename", path.to_str().unwrap());
            let mut simulation = tree.simulation(ranks).unwrap();
            let described = step(0, |tree| {
                domains(rank, 2).iter().fold(tree.within(""), |tree, own| {
                    let at = format!("catalyst/channels/grid/data/domain_{}", own[0]);
                    mask(slab(tree.within(&at), *own), *own, value)
                })
            });
            described.execute(&mut simulation).unwrap();
        });
        ["000.exr", "other000.exr"].map(|name| picture(&folder.path().join(name)))
    };
    let ([plain, _], [found, gaps]) = (drawn(1.0), drawn(f64::NAN));
    let largest = largest_difference(&found, &plain);
    assert!(largest <= SAME, "{largest}");
    assert!(gaps != plain, "the other pipeline draws another picture");
}
