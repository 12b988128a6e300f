//! Readers, grid filters and image filters damaged at random: no crash of the program, and no picture that is wrong without a word.
//!
//! The environment variable `VOLTET_FUZZ` gives the number of cases in place of the standard one.

use crate::plugin_node_scene::scene;
use voltet::Document;
use voltet::core::Result;
use voltet::core::picture::Picture;
use voltet::graph::{Observer, Registry};
use voltet::nodes::external_formats;
use voltet_testing::compilers;

/// Follows nothing; 64 MiB are left.
struct Small;

impl Observer for Small {
    fn memory_left(&self) -> Option<u64> {
        Some(64 << 20)
    }
}

/// The picture with these seeds, and whether something was said of it.
fn picture(folder: &std::path::Path, registry: &Registry, seeds: [u64; 3]) -> Result<(Picture, bool)> {
    let set = ["grid", "moved", "toned"].iter().zip(seeds).map(|(node, seed)| format!("{node}.seed={seed}"));
    let options: Vec<String> = set.collect();
    let document = Document::from_text(&folder.join("scene.toml"), scene("random", 8), &options, registry)?;
    let report = voltet::nodes::session().run(&document.graph, &Small)?;
    let (_, drawn) = report.pictures.iter().find(|(node, _)| node == "toned").unwrap();
    Ok((Picture::clone(drawn), !report.warnings.is_empty()))
}

#[test]
fn what_readers_and_filters_give_at_random_is_refused_or_right() {
    let folder = tempfile::tempdir().unwrap();
    let source = compilers::source("tests/plugins/random_nodes.c");
    let Some(library) = compilers::library(folder.path(), "random.so", &[source], &[]) else { return };
    std::fs::write(folder.path().join("any.random"), "whatever").unwrap();
    let contents = voltet_plugins::load(&library).unwrap();
    let mut registry = voltet::nodes::registry().unwrap();
    let readers = contents.readers.iter().map(|reader| external_formats::reader(*reader));
    readers.chain(contents.nodes.iter().copied()).for_each(|node| registry.add(node).unwrap());
    let (right, said) = picture(folder.path(), &registry, [0; 3]).unwrap();
    assert!(!said && right.rgba.iter().any(|pixel| pixel[3] > 0.2));
    let count = std::env::var("VOLTET_FUZZ").map_or(2000, |count| count.parse().unwrap());
    let [mut refused, mut warned, mut good] = [0; 3];
    for seed in 1..=count {
        let mut seeds = [0; 3];
        seeds[seed as usize % 3] = seed;
        match picture(folder.path(), &registry, seeds) {
            Ok((found, false)) => {
                assert_eq!(found, right, "seeds {seeds:?}");
                good += 1;
            }
            Ok((_, true)) => warned += 1,
            Err(error) => {
                let text = error.to_string();
                let named =
                    ["random.so", "no array 's'", "memory ends", "no quantity to draw", "not a scalar"];
                let geometry = ["holds no", "cannot be that large", "hexahedr", "the scalar is not named"];
                assert!(
                    named.iter().chain(&geometry).any(|word| text.contains(word)),
                    "seeds {seeds:?}: {text}"
                );
                refused += 1;
            }
        }
    }
    eprintln!("refused {refused}, said with a picture {warned}, right {good}");
    assert!(refused > count / 10 && good > count / 10);
}
