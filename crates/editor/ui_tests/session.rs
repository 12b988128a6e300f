use super::*;
use crate::scene::Command;
use voltet_document::Edit;
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
    assert!(
        document.is_unwritten() && !hand.folder.path().join("data.toml").exists(),
        "nothing is written yet"
    );
    assert_eq!(document.path(), Some(hand.folder.path().join("data.toml").as_path()));
    hand.frames(2);
    assert!(hand.sees("data.toml • not saved"));
    // There is nothing before it.
    hand.key(Key::Z, Modifiers::COMMAND);
    assert!(hand.text().contains("A data file") && hand.said() == "nothing to undo", "{}", hand.said());
    hand.key(Key::S, Modifiers::COMMAND);
    hand.frames(2);
    assert!(hand.folder.path().join("data.toml").exists(), "{}", hand.said());
    assert!(hand.sees("data.toml"));
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
    assert!(hand.sees("Open another file …") && !hand.shown_beginning("Mend the text at line").is_empty());
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

#[test]
fn a_text_that_is_no_toml_is_mended_in_the_window_where_it_is_wrong() {
    let mut hand = Hand::new(&TEXT.replace("type = \"camera\"", "type = camera\""));
    let line = hand.editor.scene().faults[0].location.line_column.unwrap().0;
    hand.click_on(&format!("Mend the text at line {line} …"));
    hand.frames(3);
    (0..7).for_each(|_| hand.key(Key::ArrowRight, Modifiers::NONE));
    hand.typed("\"");
    hand.click_on("Take over");
    hand.frames(2);
    assert_eq!((hand.text(), hand.steps()), (TEXT.into(), 1));
    assert!(hand.sees("node view") && !hand.sees("Take over"));
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.click_on(&format!("Mend the text at line {line} …"));
    hand.key(Key::Escape, Modifiers::NONE);
    hand.key(Key::Escape, Modifiers::NONE);
    hand.frames(2);
    assert!(!hand.sees("Take over"), "the field is left, then the sheet is closed");
}

/// Typed text stays while the sheet is closed, and does not replace a newer one unseen.
#[test]
fn a_text_that_is_typed_is_neither_lost_nor_put_over_another() {
    let broken = TEXT.replace("type = \"camera\"", "type = camera\"");
    let mut hand = Hand::new(&broken);
    let line = hand.editor.scene().faults[0].location.line_column.unwrap().0;
    let mend = format!("Mend the text at line {line} …");
    hand.click_on(&mend);
    hand.frames(3);
    hand.typed("typed");
    for _ in 0..2 {
        hand.key(Key::Escape, Modifiers::NONE);
    }
    hand.frames(2);
    assert!(!hand.sees("Take over"));
    hand.click_on(&mend);
    hand.frames(2);
    assert!(hand.editor.panels.text.typed().contains("typed") && !hand.sees("Show the new text"));
    let newer = broken.replace("160, 120", "80, 60");
    hand.editor.edit("newer".into(), &[Edit::Text(newer.clone())]);
    hand.frames(2);
    assert!(hand.sees("Show the new text") && hand.editor.panels.text.typed().contains("typed"));
    hand.click_on("Show the new text");
    hand.frames(2);
    assert!(hand.editor.panels.text.typed() == newer && !hand.sees("Show the new text"));
    // Where nothing is typed, the sheet shows what there is.
    hand.editor.edit("older".into(), &[Edit::Text(broken.clone())]);
    hand.frames(2);
    assert!(hand.editor.panels.text.typed() == broken && !hand.sees("Show the new text"));
}

#[test]
fn a_file_that_cannot_be_opened_leads_to_the_choice_of_another() {
    let mut hand = Hand::new(TEXT);
    let ctx = hand.ctx.clone();
    for name in ["no TOML at all.png", "missing.toml", "unknown.dat"] {
        let path = hand.folder.path().join(name);
        if name != "missing.toml" {
            std::fs::write(&path, b"\x89PNG\r\n\x1a\n").unwrap();
        }
        hand.editor.open_any(&ctx, &path);
        until(&mut hand, "no choice of a file", |hand| hand.sees("name of the file"));
        assert!(!hand.said().contains("os error"), "{}", hand.said());
        hand.key(Key::Escape, Modifiers::NONE);
        hand.frames(2);
        assert_eq!(hand.text(), TEXT);
    }
}

/// A file that a parameter names, of whatever node, is chosen anew where it is not there.
#[test]
fn a_missing_file_of_any_node_has_a_button_for_another() {
    let widget = &TEXT[TEXT.find("kind = \"gaussian\"").unwrap()..TEXT.find("\n\n[nodes.view]").unwrap()];
    let map = TEXT.replace(widget, "kind = \"colormap\"\ncolormap = \"missing.json\"");
    let map = map.replace("-function\"\n", "-function\"\ninputs = { volume = \"gradient\" }\n");
    let surface = TEXT.replace(
        "[nodes.picture]",
        "[nodes.part]\ntype = \"surface-reader\"\npath = \"missing.stl\"\n\n[nodes.picture]",
    );
    let surface = surface.replace("camera = \"view\" }", "camera = \"view\", surfaces = \"part\" }");
    for (text, chosen) in [(map, "look.widgets.0.colormap"), (surface, "part.path")] {
        let mut hand = Hand::new(&text);
        assert!(hand.editor.scene().failure.is_some(), "{text}");
        hand.click_on("Choose a file …");
        hand.frames(2);
        assert!(hand.sees(&format!("A file to read: {chosen}")), "{chosen}");
    }
}
