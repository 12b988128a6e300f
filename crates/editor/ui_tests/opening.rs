//! Data files that are opened: memory, and stops in each stage.

use super::*;
use crate::files::FileDialog;
use crate::scene::FilePurpose;
use std::io::{Seek, SeekFrom, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use voltet_core::picture::Picture;
use voltet_graph::{Node, Value};

/// A uniform grid of `cells`³ hexahedra. Its values are a hole in the file: nothing of them is stored or read.
fn uniform_grid(folder: &Path, cells: u64) -> PathBuf {
    let (path, points) = (folder.join("large.vti"), (cells + 1).pow(3));
    let extent = format!("0 {cells} 0 {cells} 0 {cells}");
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n<Piece Extent=\"{extent}\"><PointData>\
         <DataArray type=\"Float32\" Name=\"s\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>\n\
         <AppendedData encoding=\"raw\">_"
    );
    let mut file = std::fs::File::create(&path).unwrap();
    file.write_all(head.as_bytes()).unwrap();
    file.write_all(&(4 * points).to_le_bytes()).unwrap();
    file.seek(SeekFrom::Current(4 * points as i64)).unwrap();
    file.write_all(b"</AppendedData></VTKFile>").unwrap();
    path
}

#[test]
fn the_memory_that_opening_takes_is_said_before_anything_is_read() {
    let mut hand = Hand::new(TEXT);
    hand.editor.free_memory = || Some(8_000_000_000);
    let (go, wait) = channel::<()>();
    let wait = Mutex::new(wait);
    hand.editor.start = Arc::new(move |_: &Path, _: &Path, _: &dyn Progress| {
        wait.lock().unwrap().recv().unwrap();
        Ok(TEXT.replace("The wavelet", "A data file"))
    });
    let (ctx, data) = (hand.ctx.clone(), uniform_grid(hand.folder.path(), 60));
    hand.editor.open_any(&ctx, &data);
    let is_said = |hand: &Hand| {
        let said = hand.said();
        // Of 1.3 million tetrahedra.
        let rest = said.split_once("making a pipeline for large.vti …; needs about ");
        rest.and_then(|(_, rest)| rest.split_once(" MB; ")).is_some_and(|(megabytes, rest)| {
            let needed: f64 = megabytes.parse().unwrap();
            (50.0..1000.0).contains(&needed) && rest == "8.0 GB of memory are free"
        })
    };
    until(&mut hand, "no memory is said", is_said);
    go.send(()).unwrap();
    until(&mut hand, "it is not opened", |hand| hand.text().contains("A data file"));
}

#[test]
fn data_that_need_more_memory_than_is_free_are_read_only_where_a_hand_says_so() {
    let mut hand = Hand::new(TEXT);
    hand.editor.free_memory = || Some(2_000_000);
    let (calls, data) = (Arc::new(AtomicUsize::new(0)), uniform_grid(hand.folder.path(), 60));
    let counted = calls.clone();
    hand.editor.start = Arc::new(move |_: &Path, _: &Path, _: &dyn Progress| {
        counted.fetch_add(1, Ordering::SeqCst);
        Ok(TEXT.replace("The wavelet", "A data file"))
    });
    let ctx = hand.ctx.clone();
    for (answer, is_read) in [("Cancel", false), ("Open anyway", true)] {
        hand.editor.open_any(&ctx, &data);
        until(&mut hand, "nothing is asked", |hand| hand.sees(answer));
        hand.frames(2);
        let asked = hand.shown_beginning(&format!("Opening {} needs about ", data.display()));
        assert_eq!((asked.len(), calls.load(Ordering::SeqCst)), (1, 0));
        assert!(hand.editor.asks(), "the keys are for the question");
        // A file that is being chosen is another question.
        hand.editor.file_dialog = Some(FileDialog::new(FilePurpose::SaveAs, None));
        hand.frames(2);
        assert!(!hand.sees("Open anyway"), "two questions at once");
        hand.editor.file_dialog = None;
        hand.frames(2);
        hand.click_on(answer);
        until(&mut hand, "nothing comes of the answer", |hand| hand.editor.made.is_none());
        hand.frames(2);
        assert_eq!(calls.load(Ordering::SeqCst) == 1, is_read);
        assert_eq!(hand.text().contains("A data file"), is_read);
        assert!(is_read || hand.said() == "large.vti was not read", "{}", hand.said());
    }
}

#[test]
fn another_message_stays_where_memory_is_asked_about() {
    let mut hand = Hand::new(TEXT);
    hand.editor.free_memory = || Some(2_000_000);
    let (ctx, data) = (hand.ctx.clone(), uniform_grid(hand.folder.path(), 60));
    hand.editor.open_any(&ctx, &data);
    hand.editor.say("of another kind");
    until(&mut hand, "nothing is asked", |hand| hand.sees("Open anyway"));
    assert_eq!(hand.said(), "of another kind");
}

#[test]
fn opening_that_is_stopped_while_headers_are_read_goes_no_further() {
    static MAY_TELL: AtomicBool = AtomicBool::new(false);
    let mut hand = Hand::new(TEXT);
    hand.editor.free_memory = || {
        while !MAY_TELL.load(Ordering::SeqCst) {
            std::thread::sleep(Duration::from_millis(1));
        }
        None
    };
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = calls.clone();
    hand.editor.start = Arc::new(move |_: &Path, _: &Path, _: &dyn Progress| {
        counted.fetch_add(1, Ordering::SeqCst);
        Ok(TEXT.into())
    });
    let (ctx, data) = (hand.ctx.clone(), uniform_grid(hand.folder.path(), 60));
    hand.editor.open_any(&ctx, &data);
    until(&mut hand, "no button", |hand| hand.sees("Stop"));
    hand.click_on("Stop");
    MAY_TELL.store(true, Ordering::SeqCst);
    until(&mut hand, "it is not stopped", |hand| hand.editor.made.is_none());
    assert_eq!((hand.said().as_str(), calls.load(Ordering::SeqCst)), ("stopped; what was shown stays", 0));
}

/// The stages themselves are tested with `voltet start`.
#[test]
fn opening_is_stopped_and_leaves_what_was_shown() {
    const STAGE: &str = "gradient of the file";
    let mut hand = Hand::new(TEXT);
    let data = hand.folder.path().join("data.vtu");
    std::fs::write(&data, "").unwrap();
    let is_over = Arc::new(AtomicBool::new(false));
    let ends = is_over.clone();
    hand.editor.start = Arc::new(move |_: &Path, _: &Path, progress: &dyn Progress| {
        while !progress.cancelled() {
            progress.report(STAGE, 0.5);
            std::thread::sleep(Duration::from_millis(1));
        }
        ends.store(true, Ordering::SeqCst);
        progress.check_cancelled().map(|()| TEXT.replace("The wavelet", "A data file"))
    });
    let picture = hand.editor.worker().shown(|shown| shown.pixels.as_ref().unwrap().number);
    let ctx = hand.ctx.clone();
    hand.editor.open_any(&ctx, &data);
    until(&mut hand, "no stage is shown", |hand| hand.texts(STAGE).len() == 1);
    hand.click_on("Stop");
    until(&mut hand, "it is not stopped", |hand| hand.editor.made.is_none());
    assert!(is_over.load(Ordering::SeqCst), "its thread goes on");
    assert_eq!(
        (hand.said().as_str(), hand.text(), hand.steps()),
        ("stopped; what was shown stays", TEXT.into(), 0)
    );
    hand.settle();
    let now = hand.editor.worker().shown(|shown| shown.pixels.as_ref().unwrap().number);
    assert_eq!(now, picture, "another picture is shown");
}

/// Numbers of starts of the node, and of its ends by a stop.
static BEGUN: AtomicUsize = AtomicUsize::new(0);
static STOPPED: AtomicUsize = AtomicUsize::new(0);

static ENDLESS: Node = Node {
    name: "endless",
    summary: "A picture that never comes; it is stopped.",
    run: &|call| {
        BEGUN.fetch_add(1, Ordering::SeqCst);
        while !call.progress().cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        STOPPED.fetch_add(1, Ordering::SeqCst);
        call.progress().check_cancelled()?;
        Ok(vec![Value::Image(Arc::new(Picture::transparent(2, 2)))])
    },
    ..DRAWING
};

#[test]
fn the_first_picture_of_opened_data_is_stopped_by_another_document() {
    let mut registry = voltet_nodes::registry().unwrap();
    registry.add(&ENDLESS).unwrap();
    let mut hand = Hand::with_registry(TEXT, [1280.0, 720.0], &|_| {}, &registry);
    hand.settle();
    hand.editor.start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| {
        let late = "\n[nodes.picture]\ntype = \"endless\"\ninputs = { transfer_function = \"look\" }\n";
        let (before, _) = TEXT.split_once("[nodes.picture]").unwrap();
        Ok(before.to_string() + late)
    });
    let (ctx, own) = (hand.ctx.clone(), hand.path());
    let data = hand.folder.path().join("data.vtu");
    std::fs::write(&data, "").unwrap();
    hand.editor.open_any(&ctx, &data);
    until(&mut hand, "the picture is not begun", |_| BEGUN.load(Ordering::SeqCst) > 0);
    assert!(hand.editor.worker().shown(|shown| shown.pixels.is_none()), "that of the document before");
    hand.editor.open_any(&ctx, &own);
    assert_eq!(hand.text(), TEXT);
    hand.settle();
    assert_eq!(STOPPED.load(Ordering::SeqCst), BEGUN.load(Ordering::SeqCst), "nothing is left running");
    let shown = hand.editor.worker().shown(|shown| shown.pixels.as_ref().map(|pixels| pixels.size()));
    assert!(shown.is_some_and(|size| size != [2, 2]), "{shown:?}");
}
