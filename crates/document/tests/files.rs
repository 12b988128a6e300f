//! Files of documents: saved whole, changed by others, unsaved work that outlives its program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use voltet_document::{Document, Edit, Recovery};

const TEXT: &str = "[pipeline]\r\nformat = 1 # so\r\n\r\n[nodes.a]\r\ntype = \"reader\"\r\n";

fn title(text: &str) -> Edit {
    Edit::Title(Some(text.into()))
}

#[test]
fn a_saved_document_is_its_file_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.toml");
    fs::write(&path, TEXT).unwrap();
    let mut document = Document::open(&path).unwrap();
    assert!(document.is_saved() && !document.changed_on_disk());
    document.edit(&title("é")).unwrap();
    assert!(!document.is_saved());
    document.save().unwrap();
    let wanted = TEXT.replace("# so\r\n", "# so\r\ntitle = \"é\"\r\n");
    assert_eq!(fs::read(&path).unwrap(), wanted.as_bytes());
    assert!(document.is_saved() && !document.changed_on_disk());
    document.undo();
    assert!(!document.is_saved(), "the file has what was undone");
    document.redo();
    assert!(document.is_saved());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing stands beside it");
}

#[test]
fn what_somebody_else_wrote_is_not_written_over_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.toml");
    fs::write(&path, TEXT).unwrap();
    let mut document = Document::open(&path).unwrap();
    document.edit(&title("mine")).unwrap();
    let theirs = TEXT.replace("reader", "wavelet");
    fs::write(&path, &theirs).unwrap();
    assert!(document.changed_on_disk());
    let error = document.save().unwrap_err().to_string();
    assert!(error.contains("changed by another program") && error.contains("a.toml"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), theirs);

    document.reload().unwrap();
    assert_eq!(document.text(), theirs);
    assert!(document.is_saved() && !document.changed_on_disk());
    document.undo();
    assert!(document.text().contains("mine"), "taking it over can be undone");
    document.save_over().unwrap();
    assert!(fs::read_to_string(&path).unwrap().contains("mine"));
    fs::remove_file(&path).unwrap();
    assert!(document.changed_on_disk(), "a file that is gone is another one, too");
}

#[test]
fn a_document_without_a_file_is_saved_where_one_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::new();
    assert!(document.save().unwrap_err().to_string().contains("no file yet"));
    assert!(document.save_as(&folder.path().join("not/there.toml")).is_err());
    assert!(document.path().is_none());
    let path = folder.path().join("b.toml");
    document.save_as(&path).unwrap();
    assert_eq!((document.path(), document.folder().as_path()), (Some(path.as_path()), folder.path()));
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("a.toml"), folder.path().join("link.toml"));
    fs::write(&path, TEXT).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("a.toml", &link).unwrap();
    let mut document = Document::open(&link).unwrap();
    document.edit(&title("t")).unwrap();
    document.save().unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(fs::read_to_string(&path).unwrap().contains("title"));
}

#[test]
fn pictures_and_other_bytes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    for (bytes, wanted) in
        [(&b"\x89PNG\r\n\x1a\n..."[..], "is a picture"), (b"a = \"\xff\"", "byte 5 is no UTF-8")]
    {
        fs::write(&path, bytes).unwrap();
        let error = Document::open(&path).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    assert!(Document::open(&folder.path().join("none.toml")).is_err());
}

#[test]
fn unsaved_work_is_kept_until_it_is_saved_or_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let recovery = Recovery::in_folder(folder.path().join("state"));
    let path = folder.path().join("a \"é\".toml");
    fs::write(&path, TEXT).unwrap();
    let mut document = Document::open(&path).unwrap();
    let mut keeper = recovery.keeper(&document).unwrap();
    keeper.follow(&document).unwrap();
    assert!(recovery.left_behind().is_empty(), "nothing is unsaved");
    document.edit(&title("kept")).unwrap();
    keeper.follow(&document).unwrap();
    assert!(recovery.left_behind().is_empty(), "its window lives");
    // Another window of the same file keeps its own.
    let mut other = recovery.keeper(&document).unwrap();
    other.follow(&document).unwrap();
    drop(other);
    let left = recovery.left_behind();
    assert_eq!(left.len(), 1);
    assert_eq!(left[0].path.as_deref(), Some(fs::canonicalize(&path).unwrap().as_path()));
    let taken_up = left[0].document();
    assert_eq!(taken_up.text(), document.text());
    assert!(!taken_up.is_saved() && taken_up.history().undo_label() == Some("take up unsaved work"));
    assert!(recovery.left_behind().is_empty(), "who looks at it holds it");
    left.into_iter().for_each(|one| one.give_up().unwrap());
    document.save().unwrap();
    keeper.follow(&document).unwrap();
    drop(keeper);
    assert!(recovery.left_behind().is_empty());
    assert_eq!(fs::read_dir(folder.path().join("state")).unwrap().count(), 0, "nothing stays");
}

#[test]
fn another_document_of_as_many_edits_is_kept_too() {
    let folder = tempfile::tempdir().unwrap();
    let recovery = Recovery::in_folder(folder.path().to_path_buf());
    let mut documents = [Document::new(), Document::new()];
    let mut keeper = recovery.keeper(&documents[0]).unwrap();
    for (document, text) in documents.iter_mut().zip(["one", "other"]) {
        document.edit(&title(text)).unwrap();
        keeper.follow(document).unwrap();
    }
    drop(keeper);
    assert_eq!(recovery.left_behind()[0].document().text(), documents[1].text());
}

/// Folder of the program that is to be killed.
const KILLED: &str = "VOLTET_TEST_KILLED";

#[test]
fn work_outlives_a_program_that_is_killed() {
    if let Some(folder) = std::env::var_os(KILLED) {
        // The program that is killed: this very test, run once more.
        let mut document = Document::new();
        let mut keeper = Recovery::in_folder(folder.into()).keeper(&document).unwrap();
        for i in 0.. {
            document.edit(&title(&format!("{i} {}", "x".repeat(10_000)))).unwrap();
            keeper.follow(&document).unwrap();
            println!("\nkept {i}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["work_outlives_a_program_that_is_killed", "--nocapture", "--exact"])
        .env(KILLED, folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.ends_with("kept 20")));
    let recovery = Recovery::in_folder(folder.path().to_path_buf());
    assert!(recovery.left_behind().is_empty(), "it lives");
    child.kill().unwrap();
    child.wait().unwrap();
    let left = recovery.left_behind();
    assert_eq!(left.len(), 1);
    assert_eq!(left[0].path, None);
    let document = left[0].document();
    // Whole, whatever was being written when it ended.
    let title = document.pipeline().title.clone().unwrap();
    let (number, filling) = title.split_once(' ').unwrap();
    assert!(number.parse::<usize>().unwrap() >= 20 && filling.len() == 10_000);
    left.into_iter().for_each(|one| one.give_up().unwrap());
    assert!(recovery.left_behind().is_empty());
}

#[test]
fn saved_in_another_folder_a_document_means_the_same_data() {
    let registry = voltet_nodes::registry().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("one/data")).unwrap();
    fs::create_dir_all(at("two")).unwrap();
    for name in ["one/data/a.vtu", "one/look.png"] {
        fs::write(at(name), "").unwrap();
    }
    let text = "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"data/a.vtu\" # here\n\
                [nodes.gone]\ntype = \"reader\"\npath = \"gone.vtu\"\n\
                [nodes.look]\ntype = \"transfer-function\"\n[[nodes.look.widgets]]\nkind = \"table\"\nimage = \"look.png\"\n\
                [nodes.file]\ntype = \"image-writer\"\npath = \"picture.png\"\n";
    fs::write(at("one/a.toml"), text).unwrap();
    let mut document = Document::open(&at("one/a.toml")).unwrap();
    assert!(document.following_to(&registry, &at("one/data/..")).is_empty());
    let edits = document.following_to(&registry, &at("two"));
    document.edit_all("follow".into(), &edits, None).unwrap();
    let wanted = text
        .replace("\"data/a.vtu\" # here", "\"../one/data/a.vtu\" # here")
        .replace("\"look.png\"", "\"../one/look.png\"");
    assert_eq!(document.text(), wanted, "the picture is written beside the file");
}
