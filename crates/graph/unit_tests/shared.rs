//! Sessions of several threads, and graphs to come.

use super::*;
use std::cell::Cell;
use std::path::Path;
use std::time::UNIX_EPOCH;

#[test]
fn sessions_that_share_outputs_make_each_once() {
    let first = session();
    let mut all: BTreeMap<&'static str, usize> = BTreeMap::new();
    let of_thread = |number: usize| {
        let mut own = first.beside();
        let text = SCENE.replace("path = \"a\"", &format!("path = \"{number}\""));
        own.run(&graph(&text).unwrap(), &NoObserver).unwrap();
        runs()
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|number| scope.spawn(move || of_thread(number))).collect();
        for (name, count) in threads.into_iter().flat_map(|thread| thread.join().unwrap()) {
            *all.entry(name).or_default() += count;
        }
    });
    let expected = [("draw", 1), ("gradient", 1), ("grid", 1), ("kept", 1), ("look", 1), ("write", 4)];
    assert_eq!(all.into_iter().collect::<Vec<_>>(), expected);
}

/// Leaves no memory for what is not used now.
struct NoMemory;

impl Observer for NoMemory {
    fn memory_left(&self) -> Option<u64> {
        Some(0)
    }
}

#[test]
fn grids_and_volumes_wait_for_graphs_to_come_while_there_is_memory() {
    let graphs = [3, 4, 3].map(|size| graph(&SCENE.replace("size = 3", &format!("size = {size}"))).unwrap());
    let run = |expected: &[Graph], observer: &dyn Observer| {
        let mut session = session();
        session.expect(expected.iter());
        graphs.iter().for_each(|graph| drop(session.run(graph, observer).unwrap()));
        let made = runs().into_iter().filter(|(name, _)| ["gradient", "grid", "kept"].contains(name));
        (made.map(|(_, count)| count).collect::<Vec<_>>(), session.held_counts())
    };
    let (made, held) = run(&[], &NoObserver);
    assert_eq!(made, [3, 3, 3], "nobody said that the first is used again");
    // Nothing waits any more when the last has run.
    assert_eq!(run(&graphs, &NoObserver), (vec![2, 2, 2], held));
    assert_eq!(run(&graphs, &NoMemory), (vec![3, 3, 3], held));
}

thread_local! {
    /// State of the only file.
    static LENGTH: Cell<u64> = const { Cell::new(0) };
}

/// Reads a file that somebody writes meanwhile.
const READS: Node = Node {
    name: "reads",
    parameters: &[Parameter {
        name: "path",
        parameter_type: ParameterType::InputPath,
        unit: "",
        default: DefaultValue::Required,
        help: "help",
    }],
    run: &|_| {
        count("reads");
        if LENGTH.get() < 8 {
            LENGTH.set(LENGTH.get() + 1);
        }
        Ok(vec![Value::Grid(Arc::new(Grid {
            scalar: Some(SharedSlice::from(vec![1.0])),
            ..Grid::default()
        }))])
    },
    ..GRID
};

#[test]
fn a_file_that_is_written_while_it_is_read_is_as_it_was_before_and_is_read_again() {
    let mut registry = registry();
    registry.add(&READS).unwrap();
    let text = SCENE.replace("type = \"grid\"\nsize = 3", "type = \"reads\"\npath = \"data\"");
    let graph = Pipeline::parse(&text).unwrap().graph(&registry, PathBuf::from("folder")).unwrap();
    let mut session = Session::new(|path: &Path| path.ends_with("data").then(|| (LENGTH.get(), UNIX_EPOCH)));
    let mut read = || {
        let origins = session.run(&graph, &NoObserver).unwrap().origins;
        (origins.files[0].stamp.unwrap().0, runs().iter().any(|(name, _)| *name == "reads"))
    };
    LENGTH.set(6);
    assert_eq!(read(), (6, true));
    assert_eq!(read(), (7, true));
    assert_eq!(read(), (8, true), "it is read once more, and stays");
    assert_eq!(read(), (8, false));
}

/// The run uses what was read for it, as its own: no report says that work was spared.
#[test]
fn what_is_read_ahead_is_read_once_and_counts_as_read_by_the_run() {
    let mut session = session();
    let mut ahead = session.beside();
    // The transfer function is another one for each, as the camera of a film is.
    let scene = |size: usize| {
        SCENE.replace("size = 3", &format!("size = {size}")).replace("2.0", &format!("{size}.0"))
    };
    let graphs = [3, 4].map(|size| graph(&scene(size)).unwrap());
    session.run(&graphs[0], &NoObserver).unwrap();
    runs();
    ahead.read_ahead(&graphs[1], &NoObserver).unwrap();
    assert_eq!(runs(), [("grid", 1), ("look", 1)]);
    assert_eq!(session.held_counts()[0], 7, "the grids of two steps");
    let report = session.run(&graphs[1], &NoObserver).unwrap();
    assert_eq!(runs(), [("draw", 1), ("gradient", 1), ("kept", 1), ("write", 1)]);
    assert!(report.nodes.iter().all(|node| !node.reused), "{:?}", report.nodes);
    assert_eq!(session.held_counts()[0], 5, "nothing of the first");
    let again = session.run(&graphs[1], &NoObserver).unwrap();
    assert!(again.nodes.iter().all(|node| node.reused));
}
