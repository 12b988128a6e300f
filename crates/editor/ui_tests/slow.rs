use super::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;
use voltet_core::picture::Picture;
use voltet_graph::{Node, Value};

/// Numbers of starts and ends of the node, and true once it may end.
static BEGUN: AtomicUsize = AtomicUsize::new(0);
static ENDED: AtomicUsize = AtomicUsize::new(0);
static MAY_END: AtomicBool = AtomicBool::new(false);

/// Time after which the node ends by itself, so that a window that waits for it fails and does not hang.
const LONGEST: Duration = Duration::from_secs(600);

static DEAF: Node = Node {
    name: "deaf",
    summary: "A picture that comes when it is released; it hears of no cancellation.",
    run: &|_| {
        BEGUN.fetch_add(1, Ordering::SeqCst);
        let start = Instant::now();
        while !MAY_END.load(Ordering::SeqCst) && start.elapsed() < LONGEST {
            std::thread::sleep(Duration::from_millis(2));
        }
        ENDED.fetch_add(1, Ordering::SeqCst);
        Ok(vec![Value::Image(Arc::new(Picture::transparent(2, 2)))])
    },
    ..DRAWING
};

/// Frames are counted while the node runs: edits, selections, undo and movements of the pointer need none of its answers. Each edit asks
/// for another picture in place of the one that it makes.
#[test]
fn the_window_is_drawn_and_edited_while_a_node_runs() {
    let mut registry = voltet_nodes::registry().unwrap();
    registry.add(&DEAF).unwrap();
    let text =
        format!("{TEXT}\n[nodes.late]\ntype = \"deaf\"\ninputs = {{ transfer_function = \"look\" }}\n");
    let mut hand = Hand::with_registry(&text, [1280.0, 720.0], &|_| {}, &registry);
    hand.frames(4);
    hand.editor.show_picture("late");
    until(&mut hand, "the node does not run", |_| BEGUN.load(Ordering::SeqCst) > 0);
    let drawn = 120;
    for i in 0..drawn {
        let node = ["look", "view", "grid"][i % 3];
        match i % 20 {
            0 => hand.editor.selection = [node.to_string()].into(),
            5 => {
                let value = voltet_graph::ParameterValue::Number(1.0 + i as f64);
                let path = ["widgets", "0", "extinction"].join(".");
                hand.editor.edit("edit".into(), &[voltet_document::Edit::set("look", path.as_str(), value)]);
            }
            10 => hand.key(Key::Z, Modifiers::COMMAND),
            _ => hand.move_to(pos2(20.0 + 10.0 * i as f32, 300.0 + i as f32), Modifiers::NONE),
        }
        hand.frames(1);
        assert_eq!(ENDED.load(Ordering::SeqCst), 0, "frame {i} waited for the node");
    }
    MAY_END.store(true, Ordering::SeqCst);
    hand.settle();
    assert!(ENDED.load(Ordering::SeqCst) > 0);
    assert_eq!(hand.text(), text, "each edit was undone");
}
