use super::*;
use crate::actions::Action;

#[test]
fn saved_in_another_folder_the_file_means_the_same_data_and_says_so() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"data.vtu\" # coarse",
    );
    let mut hand = Hand::new(&text);
    std::fs::write(hand.folder.path().join("data.vtu"), "").unwrap();
    let other = hand.folder.path().join("in");
    std::fs::create_dir(&other).unwrap();
    let ctx = hand.ctx.clone();
    hand.editor.carry_out(&ctx, Action::SaveAs(other.join("scene")));
    let saved = std::fs::read_to_string(other.join("scene.toml")).unwrap();
    assert_eq!(saved, text.replace("\"data.vtu\"", "\"../data.vtu\""));
    assert!(hand.said().contains("a path in it leads to the same file"), "{}", hand.said());
    assert!(hand.editor.document().is_saved());
    // Where the file cannot be written, nothing changes.
    hand.editor.carry_out(&ctx, Action::SaveAs(hand.folder.path().join("none/scene.toml")));
    assert!(hand.editor.document().is_saved() && hand.text() == saved, "{}", hand.said());
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), text, "it is a step that can be undone");
}

#[test]
fn the_file_of_a_parameter_is_chosen_in_a_list() {
    let mut hand = Hand::new(TEXT);
    std::fs::create_dir(hand.folder.path().join("pictures")).unwrap();
    std::fs::write(hand.folder.path().join("pictures/other.png"), "").unwrap();
    let title = hand.editor.graph.frame_of("file").unwrap().min + vec2(30.0, 8.0);
    hand.click(title);
    hand.frames(3);
    hand.click_on("…");
    hand.click_on("🗀  pictures");
    hand.click_on("      other.png");
    hand.click_on("Choose");
    assert!(hand.text().contains("path = \"pictures/other.png\""), "{}", hand.said());
    assert_eq!(hand.steps(), 1);
}
