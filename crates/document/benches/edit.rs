//! Times of an edit in a file of 200 nodes, part by part: `cargo bench -p voltet-document`.

#![allow(clippy::unwrap_used, reason = "a timing of what failed is none")]

use std::hint::black_box;
use std::time::Instant;
use voltet_document::{Document, Edit, Gesture};
use voltet_graph::ParameterValue;
use voltet_graph::pipeline::Pipeline;

const NODES: usize = 200;
const ROUNDS: usize = 200;

/// Seconds of the median round.
fn median(mut round: impl FnMut(usize)) -> f64 {
    let mut seconds: Vec<f64> = (0..ROUNDS)
        .map(|i| {
            let start = Instant::now();
            round(i);
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[ROUNDS / 2]
}

fn told(what: &str, seconds: f64) {
    println!("{what:<58} {:>8.3} ms", seconds * 1e3);
}

fn main() {
    let mut text = String::from("# Two hundred nodes.\n\n[pipeline]\nformat = 1\n");
    for i in 0..NODES / 4 {
        text += &format!(
            "\n# Number {i}.\n[nodes.look_{i}]\ntype = \"transfer-function\"\nunit_distance = 10.0 # mm\n\n\
             [[nodes.look_{i}.widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 0.48, 0.06]\nextinction = 60.0\n\
             centre = [60.8, 0.0]\nsigma = [0.35, 0.025]\n\n[nodes.view_{i}]\ntype = \"camera\"\neye = [1.0, 2.0, 3.0]\n\n\
             [nodes.grid_{i}]\ntype = \"reader\"\npath = \"a.vtu\"\n\n[nodes.picture_{i}]\ntype = \"renderer\"\n\
             inputs = {{ volume = \"grid_{i}\", transfer_function = \"look_{i}\", camera = \"view_{i}\" }}\n"
        );
    }
    text += "\n[editor.nodes]\n";
    for i in 0..NODES / 4 {
        for kind in ["look", "view", "grid", "picture"] {
            text += &format!("{kind}_{i} = [{i}, 2]\n");
        }
    }
    println!("{NODES} nodes, {} lines, {} bytes; medians of {ROUNDS}", text.lines().count(), text.len());
    let mut document = Document::from_text(text.clone(), None);
    assert_eq!(document.pipeline().nodes.len(), NODES);

    told(
        "reading what a text states (a run does the same)",
        median(|_| drop(black_box(Pipeline::survey(&text)))),
    );
    told(
        "all of a document made from a text",
        median(|_| drop(black_box(Document::from_text(text.clone(), None)))),
    );
    let widget =
        |i: usize| Edit::set("look_25", "widgets.0.centre.0", ParameterValue::Number(i as f64 / 7.0));
    told(
        "a widget dragged by one step, in all",
        median(|i| document.edit_all(String::new(), &[widget(i)], Some(Gesture(1))).unwrap()),
    );
    let all: Vec<(String, [f64; 2])> =
        document.pipeline().nodes.iter().map(|node| (node.name.clone(), [0.0; 2])).collect();
    let moved =
        |i: usize| Edit::MoveNodes(all.iter().map(|(name, _)| (name.clone(), [i as f64, 7.0])).collect());
    told(
        "all nodes dragged by one step, in all",
        median(|i| document.edit_all(String::new(), &[moved(i)], Some(Gesture(2))).unwrap()),
    );
    told(
        "undo, in all",
        median(|i| assert!(black_box(if i % 2 == 0 { document.undo() } else { document.redo() }))),
    );
    let rename = |i: usize| match i % 2 {
        0 => Edit::Rename { node: "grid_7".into(), to: "mesh".into() },
        _ => Edit::Rename { node: "mesh".into(), to: "grid_7".into() },
    };
    told("a rename, in all", median(|i| document.edit(&rename(i)).unwrap()));

    println!("kept by the history: {} steps", document.history().position().1);
}
