use super::*;
use voltet_document::Recovery;

fn place(kept: &tempfile::TempDir) -> Recovery {
    Recovery::in_folder(kept.path().to_path_buf())
}

/// Leaves the draft of a window that ends without a word while its work is not saved: the text, and the folder of its file.
fn crashed(kept: &tempfile::TempDir) -> (String, tempfile::TempDir) {
    let mut hand = Hand::new(TEXT);
    hand.editor.keep_in(place(kept));
    hand.key(Key::X, Modifiers::NONE);
    hand.frames(3);
    // Its lock goes with it.
    (hand.text(), hand.folder)
}

#[test]
fn unsaved_work_outlives_a_crash() {
    let kept = tempfile::tempdir().unwrap();
    let (text, folder) = crashed(&kept);
    let left = place(&kept).left_behind();
    assert_eq!(left.len(), 1);
    assert_eq!(left[0].text, text);
    let own = folder.path().canonicalize().unwrap().join("scene.toml");
    assert_eq!(left[0].path.as_deref(), Some(own.as_path()));
}

#[test]
fn work_that_was_left_behind_is_offered_and_taken_up() {
    let kept = tempfile::tempdir().unwrap();
    let (text, _folder) = crashed(&kept);
    let mut next = Hand::new("[pipeline]\nformat = 1\n");
    next.editor.keep_in(place(&kept));
    next.frames(2);
    assert_ne!(next.text(), text, "it is offered, not taken");
    let said = next.shown_beginning("A window ended without saving what was done in");
    assert_eq!(said.len(), 1);
    assert_eq!(next.shown(&|text| text.ends_with("scene.toml, just now.")), said, "and when it was");
    next.click_on("Open it");
    assert_eq!(next.text(), text);
    assert!(!next.editor.document().is_saved());
    assert!(next.shown_beginning("A window ended").is_empty(), "the offer is gone");
    // It is kept anew until it is saved; then nothing is left.
    assert_eq!(std::fs::read_dir(kept.path()).unwrap().count(), 2, "a text and its lock");
    next.key(Key::S, Modifiers::COMMAND);
    next.frames(2);
    drop(next);
    assert_eq!(place(&kept).left_behind().len(), 0);
}

/// Opens data that are none, for which a pipeline is made.
fn open_data(hand: &mut Hand) {
    hand.editor.start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Ok(TEXT.into()));
    let (ctx, data) = (hand.ctx.clone(), hand.folder.path().join("data.vtu"));
    std::fs::write(&data, "").unwrap();
    hand.editor.open_any(&ctx, &data);
    until(hand, "no pipeline is made", |hand| hand.text() == TEXT);
    hand.frames(4);
}

#[test]
fn a_pipeline_as_it_was_made_for_data_is_no_work() {
    let kept = tempfile::tempdir().unwrap();
    let mut hand = Hand::new("[pipeline]\nformat = 1\n");
    hand.editor.keep_in(place(&kept));
    open_data(&mut hand);
    let copies = || std::fs::read_dir(kept.path()).map_or(0, Iterator::count);
    assert_eq!(copies(), 0);
    hand.key(Key::X, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(copies(), 2, "a text and its lock");
    let edited = hand.text();
    drop(hand.harness);
    // Taken up, it begins with what was done: before it there was no file.
    let mut next = Hand::new("[pipeline]\nformat = 1\n");
    next.editor.keep_in(place(&kept));
    open_data(&mut next);
    next.click_on("Open it");
    next.frames(2);
    assert!(!next.sees("Unsaved work") && next.text() == edited, "{}", next.text());
    assert_eq!((next.steps(), next.editor.document().is_saved()), (0, false));
    next.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(next.text(), edited);
    next.command(Command::Quit);
    next.frames(2);
    assert!(next.sees("Unsaved work"));
}

#[test]
fn work_that_nobody_wants_is_thrown_away_and_what_is_put_off_is_offered_again() {
    let kept = tempfile::tempdir().unwrap();
    let (_, _folder) = crashed(&kept);
    let mut later = Hand::new(TEXT);
    later.editor.keep_in(place(&kept));
    later.frames(2);
    later.click_on("Later");
    assert_eq!(later.text(), TEXT);
    drop(later);
    let mut next = Hand::new(TEXT);
    next.editor.keep_in(place(&kept));
    next.frames(2);
    next.click_on("Discard it");
    assert_eq!(next.text(), TEXT);
    drop(next);
    assert_eq!(place(&kept).left_behind().len(), 0);
}

#[test]
fn what_was_done_last_is_kept_however_soon_the_window_ends() {
    let kept = tempfile::tempdir().unwrap();
    let mut hand = Hand::new(TEXT);
    hand.editor.keep_in(place(&kept));
    for key in [Key::X, Key::Y] {
        hand.key(key, Modifiers::NONE);
    }
    let (text, _folder) = (hand.text(), hand.folder);
    drop(hand.harness);
    assert_eq!(place(&kept).left_behind()[0].text, text);
}

#[test]
fn what_is_done_after_it_was_saved_elsewhere_is_kept_as_of_the_new_file() {
    let kept = tempfile::tempdir().unwrap();
    let mut hand = Hand::new(TEXT);
    hand.editor.keep_in(place(&kept));
    hand.key(Key::X, Modifiers::NONE);
    let other = hand.folder.path().join("other.toml");
    hand.editor.save_as(&other);
    hand.key(Key::Y, Modifiers::NONE);
    drop(hand.harness);
    let left = place(&kept).left_behind();
    assert_eq!((left.len(), left[0].path.clone()), (1, other.canonicalize().ok()));
}

#[test]
fn work_that_cannot_be_kept_is_said_once_and_tried_again_later() {
    let kept = tempfile::tempdir().unwrap();
    let folder = kept.path().join("unsaved");
    let mut hand = Hand::new(TEXT);
    hand.editor.keep_in(Recovery::in_folder(folder.clone()));
    hand.key(Key::X, Modifiers::NONE);
    std::fs::remove_dir_all(&folder).unwrap();
    hand.key(Key::Y, Modifiers::NONE);
    let said = hand.said();
    assert!(said.contains("unsaved"), "{said}");
    hand.editor.say("another message");
    let tried = hand.editor.recover.kept.unwrap();
    hand.frames(3);
    assert!(hand.editor.recover.kept == Some(tried) || tried.elapsed() > Duration::from_secs(2));
    // It is tried again, and says no more of the same work.
    hand.editor.recover.kept = None;
    hand.frames(2);
    assert_eq!(hand.said(), "another message");
    std::fs::create_dir_all(&folder).unwrap();
    hand.editor.recover.kept = None;
    hand.frames(2);
    assert!(hand.editor.recover.failed.is_none());
    // Its lock went with the folder.
    assert_eq!(Recovery::in_folder(folder).left_behind()[0].text, hand.text());
}

/// The system takes a while to end a window that is killed.
#[test]
fn work_of_a_window_that_has_not_ended_yet_is_offered_a_little_later() {
    let kept = tempfile::tempdir().unwrap();
    let mut ending = Hand::new(TEXT);
    ending.editor.keep_in(place(&kept));
    ending.key(Key::X, Modifiers::NONE);
    ending.frames(2);
    let mut next = Hand::new("[pipeline]\nformat = 1\n");
    next.editor.keep_in(place(&kept));
    next.frames(3);
    assert!(!next.sees("Open it") && next.ctx.has_requested_repaint(), "it will look again");
    let Hand { harness, folder: _folder, .. } = ending;
    drop(harness);
    next.editor.recover.looks_again = Some(std::time::Instant::now());
    next.frames(1);
    assert!(next.ctx.has_requested_repaint(), "the window would show it when a hand moves");
    next.frames(1);
    assert!(next.sees("Open it"));
}

/// All places for copies of that file are taken.
#[test]
fn work_that_cannot_be_kept_anew_stays_where_it_was_left_behind() {
    let kept = tempfile::tempdir().unwrap();
    let (text, _folder) = crashed(&kept);
    let document = place(&kept).left_behind()[0].document();
    let mut keepers = (0..1000).map_while(|_| place(&kept).keeper(&document).ok());
    let held: Vec<_> = keepers.by_ref().map(|mut one| one.follow(&document).map(|()| one).unwrap()).collect();
    assert!(held.len() < 1000);
    let count = held.len() + 1;
    let mut next = Hand::new("[pipeline]\nformat = 1\n");
    next.editor.keep_in(place(&kept));
    next.frames(2);
    next.click_on("Open it");
    next.frames(2);
    assert_eq!(next.text(), text);
    assert!(next.sees("Later") && next.said().contains("cannot be kept"), "{}", next.said());
    drop((next, held));
    let left: Vec<String> = place(&kept).left_behind().into_iter().map(|one| one.text).collect();
    assert_eq!(left, vec![text; count]);
}

/// The offer takes a line of its own: what is below is seen, and works.
#[test]
fn the_offer_of_work_that_was_left_behind_covers_nothing_and_may_wait() {
    let kept = tempfile::tempdir().unwrap();
    let (text, _folder) = crashed(&kept);
    let mut next = Hand::new(TEXT);
    let before = next.editor.panels.picture.rect.unwrap();
    next.editor.keep_in(place(&kept));
    next.frames(4);
    let offer = next.rect("Later");
    let picture = next.editor.panels.picture.rect.unwrap();
    assert!(offer.bottom() <= picture.top() && picture.height() > 0.8 * before.height(), "{offer} {picture}");
    assert!(!next.editor.asks());
    next.key(Key::Y, Modifiers::NONE);
    assert_eq!(next.steps(), 1, "keys are for the pipeline");
    // Own work is asked about before it goes.
    next.click_on("Open it");
    next.frames(2);
    assert!(next.sees("Unsaved work") && next.text() != text);
    // What is asked about cannot be put off meanwhile.
    next.click_on("Later");
    next.frames(2);
    assert!(next.sees("Later"));
    next.click_on("Discard");
    next.frames(2);
    assert_eq!(next.text(), text);
    assert!(!next.sees("Later"));
}

#[test]
fn an_empty_window_offers_ways_to_begin_beside_work_that_was_left_behind() {
    let kept = tempfile::tempdir().unwrap();
    let (_, _folder) = crashed(&kept);
    let mut next = Hand::new("[pipeline]\nformat = 1\n");
    next.editor.keep_in(place(&kept));
    next.frames(4);
    let (offer, begin) = (next.rect("Later"), next.rect("Begin with an example"));
    assert!(!offer.intersects(begin) && begin.top() > offer.bottom(), "{offer} {begin}");
    next.click_on("Begin with an example");
    next.frames(2);
    assert!(!next.editor.document().pipeline().nodes.is_empty());
    assert!(next.sees("Open it"), "it is offered still");
}
