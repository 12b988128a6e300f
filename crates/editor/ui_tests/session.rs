use super::*;
use crate::scene::Command;
use voltet_graph::NoObserver;

#[test]
fn a_file_saved_here_runs_headless_to_the_picture_that_was_shown() {
    let mut hand = Hand::new(TEXT);
    let at = hand.named("picture picture");
    hand.drag(at, at + vec2(30.0, 45.0));
    hand.settle();
    hand.key(Key::S, Modifiers::COMMAND);
    assert!(hand.editor.document().is_saved(), "{}", hand.said());
    let shown = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap());
    assert_eq!(shown.divisor, 1);
    let text = std::fs::read_to_string(hand.path()).unwrap();
    let registry = voltet_nodes::registry().unwrap();
    let pipeline = voltet_graph::pipeline::Pipeline::parse(&text).unwrap();
    let graph = pipeline.graph(&registry, hand.folder.path().to_path_buf()).unwrap();
    let report = voltet_nodes::session().run(&graph, &NoObserver).unwrap();
    assert_eq!(report.pictures.last().unwrap().1, shown.picture);
}

#[test]
fn unsaved_work_is_asked_about_and_saved_work_is_not() {
    let mut hand = Hand::new(TEXT);
    let ctx = hand.ctx.clone();
    hand.editor.command(&ctx, Command::Quit);
    assert!(hand.editor.ends(), "nothing is unsaved");
    let mut hand = Hand::new(TEXT);
    hand.key(Key::X, Modifiers::NONE);
    let ctx = hand.ctx.clone();
    hand.editor.command(&ctx, Command::Quit);
    hand.frames(2);
    assert!(!hand.editor.ends() && hand.editor.unsaved.is_some());
}

#[test]
fn a_broken_file_opens_with_its_fault_at_the_node_and_the_rest_is_drawn() {
    let text = format!("{TEXT}\n[nodes.broken]\ntype = \"camera\"\neye = 3\n");
    let hand = Hand::new(&text);
    let scene = hand.editor.scene();
    assert!(
        scene.faults.iter().any(|fault| fault.location.node.as_deref() == Some("broken")),
        "{:?}",
        scene.faults
    );
    assert!(scene.pixels.is_some(), "{:?}", scene.failure);
}

#[test]
fn a_node_that_fails_shows_its_error_and_the_window_goes_on() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"none.vtu\"",
    );
    let mut hand = Hand::new(&text);
    assert!(hand.editor.scene().failure.is_some());
    hand.frames(3);
    hand.key(Key::F1, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.editor.panels.help);
}

#[test]
fn every_command_can_be_given_in_an_empty_window() {
    let mut hand = Hand::new("[pipeline]\nformat = 1\n");
    let ctx = hand.ctx.clone();
    use Command::{Add, Along, Copy, Cut, Delete, Duplicate, FitGraph, Frame, Help, Home, Note, Redo, Roll};
    use Command::{SelectAll, Theme, Tidy, Undo};
    for command in [
        Add,
        Command::Align(voltet_document::arrange::Align::Left),
        Command::Fold,
        Along(0, true),
        Along(2, false),
        Command::Isometric,
        Copy,
        Cut,
        Delete,
        Duplicate,
        FitGraph,
        Frame,
        Help,
        Home,
        Note,
        Redo,
        Roll(true),
        SelectAll,
        Theme,
        Tidy,
        Undo,
    ] {
        hand.editor.command(&ctx, command);
        hand.frames(2);
    }
    assert!(hand.editor.document().pipeline().nodes.is_empty());
}

#[test]
fn a_file_that_another_program_wrote_is_asked_about_and_never_written_over_unasked() {
    let mut hand = Hand::new(TEXT);
    let other = TEXT.replace("extinction = 4.0", "extinction = 40.0");
    std::fs::write(hand.path(), &other).unwrap();
    hand.key(Key::X, Modifiers::NONE);
    hand.key(Key::S, Modifiers::COMMAND);
    assert!(hand.editor.disk.is_changed);
    assert_eq!(std::fs::read_to_string(hand.path()).unwrap(), other);
    hand.editor.settle_with_disk(true);
    assert_eq!(hand.text(), other);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert!(hand.text().contains("extinction = 4.0"), "taking over can be undone");
}

#[test]
fn how_wrong_the_picture_is_can_be_asked() {
    let mut hand = Hand::new(TEXT);
    let ctx = hand.ctx.clone();
    hand.editor.apply(&ctx, crate::scene::Action::Estimate);
    for _ in 0..4000 {
        hand.frames(1);
        if let Some(found) = hand.editor.scene().estimate {
            let [most, rms] = found.unwrap();
            assert!(most < 2e-4 && rms <= most, "{most} {rms}");
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no answer comes");
}

#[test]
fn data_are_opened_with_a_pipeline_made_for_them() {
    let mut hand = Hand::new(TEXT);
    hand.editor.start =
        Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Ok(TEXT.replace("The wavelet", "A data file")));
    let data = hand.folder.path().join("data.vtu");
    std::fs::write(&data, "").unwrap();
    let ctx = hand.ctx.clone();
    hand.editor.open_any(&ctx, &data);
    for _ in 0..4000 {
        hand.frames(1);
        if hand.text().contains("A data file") {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let document = hand.editor.document();
    assert!(!document.is_saved() && !hand.folder.path().join("data.toml").exists(), "nothing is written yet");
    assert_eq!(document.path(), Some(hand.folder.path().join("data.toml").as_path()));
    hand.key(Key::S, Modifiers::COMMAND);
    assert!(hand.folder.path().join("data.toml").exists(), "{}", hand.said());
}

#[test]
fn work_that_is_done_while_a_pipeline_is_made_is_asked_about() {
    let mut hand = Hand::new(TEXT);
    let (go, wait) = std::sync::mpsc::channel::<()>();
    let wait = std::sync::Mutex::new(wait);
    hand.editor.start = Arc::new(move |_: &Path, _: &Path, _: &dyn Progress| {
        wait.lock().unwrap().recv().unwrap();
        Ok(TEXT.replace("The wavelet", "A data file"))
    });
    let data = hand.folder.path().join("data.vtu");
    std::fs::write(&data, "").unwrap();
    for (answer, is_taken) in [("Cancel", false), ("Discard", true)] {
        let ctx = hand.ctx.clone();
        hand.editor.open_any(&ctx, &data);
        hand.key(Key::X, Modifiers::NONE);
        hand.key(Key::X, Modifiers::SHIFT);
        let text = hand.text();
        go.send(()).unwrap();
        until(&mut hand, "nothing is asked", |hand| hand.editor.unsaved.is_some());
        hand.frames(2);
        assert_eq!(hand.text(), text);
        hand.click_on(answer);
        assert_eq!(hand.text().contains("A data file"), is_taken);
        assert!(is_taken || hand.text() == text);
    }
}

#[test]
fn what_is_made_for_data_says_how_far_it_is_and_can_be_stopped() {
    let mut hand = Hand::new(TEXT);
    let (go, wait) = std::sync::mpsc::channel::<()>();
    let wait = std::sync::Mutex::new(wait);
    // It has gone too far to be stopped, and gives a document all the same.
    hand.editor.start = Arc::new(move |_: &Path, _: &Path, progress: &dyn Progress| {
        progress.report("reading", 0.25);
        wait.lock().unwrap().recv().unwrap();
        Ok(TEXT.replace("The wavelet", "A data file"))
    });
    let data = hand.folder.path().join("data.vtu");
    std::fs::write(&data, vec![0; 20_000_000]).unwrap();
    hand.frames(2);
    let (ctx, places) = (hand.ctx.clone(), ["node grid", "node picture"].map(|name| hand.rect(name)));
    hand.editor.open_any(&ctx, &data);
    until(&mut hand, "no progress is said", |hand| hand.texts("reading").len() == 1);
    assert_eq!((hand.texts("25%").len(), hand.text()), (1, TEXT.to_string()));
    assert_eq!(hand.shown_beginning("making a pipeline for data.vtu of 20 MB …").len(), 1);
    // Nothing is pushed from under a hand.
    assert_eq!(["node grid", "node picture"].map(|name| hand.rect(name)), places);
    hand.click_on("Stop");
    assert_eq!((hand.texts("Stop").len(), hand.texts("stopping …").len()), (0, 1));
    go.send(()).unwrap();
    until(&mut hand, "it is not stopped", |hand| hand.editor.made.is_none());
    hand.frames(2);
    assert_eq!(
        (hand.said().as_str(), hand.text(), hand.texts("reading").len()),
        ("stopped; what was shown stays", TEXT.to_string(), 0)
    );
}

#[test]
fn faults_are_those_of_the_document_that_is_shown() {
    let mut hand = Hand::new(TEXT);
    let broken = hand.folder.path().join("broken.toml");
    std::fs::write(&broken, TEXT.replace("extinction = 4.0", "extinction = -4.0")).unwrap();
    let ctx = hand.ctx.clone();
    hand.editor.open_any(&ctx, &broken);
    hand.frames(2);
    assert_eq!(hand.editor.scene().faults.len(), 1, "{}", hand.text());
    assert_eq!(hand.steps(), 0, "to show a wrong number changes nothing");
    let own = hand.path();
    hand.editor.open_any(&ctx, &own);
    hand.frames(2);
    assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
}

#[test]
fn a_file_that_is_no_toml_says_where_and_is_taken_over_once_it_is_mended() {
    let mut hand = Hand::new(&TEXT.replace("type = \"camera\"", "type = camera\""));
    let said = hand.shown_beginning("Mend it in a text editor");
    assert_eq!(said.len(), 1);
    let fault = &hand.editor.scene().faults[0];
    assert!(fault.location.line_column.is_some(), "{fault}");
    std::fs::write(hand.path(), TEXT).unwrap();
    // The file is looked at once a second.
    std::thread::sleep(Duration::from_millis(1100));
    hand.frames(2);
    hand.click_on("Reload");
    assert_eq!(hand.text(), TEXT);
    assert!(hand.sees("node view"));
}
